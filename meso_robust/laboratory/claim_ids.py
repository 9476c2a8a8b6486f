"""Names of what is claimed of a run, and their sentences.

Nothing here imports compiled code, so that a bad file that names one is refused at once.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum


class ClaimId(StrEnum):
    """What is claimed: compared, never reworded; its sentence is rendered from ``_SENTENCES``."""

    CARRIED_OUT = "carried_out"
    STARTS_FREE = "starts_free"
    CONTACTS = "contacts"
    RETRACTS = "retracts"
    ENDS_IN_BOX = "ends_in_box"
    STAYS_IN_TUBE = "stays_in_tube"
    FORCES_BELOW_CAP = "forces_below_cap"
    REACHES_GOAL = "reaches_goal"


_SENTENCES: Mapping[ClaimId, str] = {
    ClaimId.CARRIED_OUT: "every move can be carried out",
    ClaimId.STARTS_FREE: "starts free of contact",
    ClaimId.CONTACTS: "contacts are as claimed",
    ClaimId.RETRACTS: "probes withdraw clear of the part",
    ClaimId.ENDS_IN_BOX: "ends in its box",
    ClaimId.STAYS_IN_TUBE: "stays in its tube",
    ClaimId.FORCES_BELOW_CAP: "no tip presses harder than the task allows",
    ClaimId.REACHES_GOAL: "the last pose lies in the goal",
}


@dataclass(frozen=True, slots=True)
class Claim:
    """Something that is claimed of every run."""

    id: ClaimId
    move: int | None = None
    """From 1; None if it is claimed of the run as a whole."""

    @property
    def key(self) -> str:
        """Both as one text, such as ``move_2/ends_in_box``, to sort by."""
        return self.id if self.move is None else f"move_{self.move}/{self.id}"

    @property
    def words(self) -> str:
        """As files and pages state it, such as ``move 2: ends in its box``."""
        sentence = _SENTENCES[self.id]
        return sentence if self.move is None else f"move {self.move}: {sentence}"


CARRIED_OUT, REACHES_GOAL = Claim(ClaimId.CARRIED_OUT), Claim(ClaimId.REACHES_GOAL)
OUTCOME = (CARRIED_OUT, REACHES_GOAL)
"""What counts even where nothing is certified."""
