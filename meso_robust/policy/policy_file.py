"""The form of ``policy.json``, apart from what proves it.

Nothing here imports compiled code, so that a bad file is refused at once.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, ValidationError

from meso_robust.errors import InputError
from meso_robust.planning.plan_file import BoxDocument, Document, ExactBox, RuleDocument
from meso_robust.planning.reading import first_of, read_text
from meso_robust.reading import Count, Deg, MoveNumber, Percent
from meso_robust.task import Task

SCHEMA: Literal["meso-robust/policy/1"] = "meso-robust/policy/1"


class CellDocument(Document):
    """One move for all sensed poses of a box."""

    moves: MoveNumber
    """Bound of the moves to the goal, this one included."""
    rule: Count
    """Index into ``rules``."""
    sensed: BoxDocument
    """Sensed poses for which the move is made, for reading."""
    sensed_exact: ExactBox
    """The same box, exactly."""
    post: BoxDocument
    """All true poses after the move, rounded outward."""
    post_exact: ExactBox
    """The box after the move, exactly."""
    ends: bool
    """Whether the move ends in the goal from all of the cell."""


class RegionDocument(Document):
    """How far the certified starts reach near one orientation of the part."""

    near_deg: Deg
    """The orientation, deg."""
    cells: Count
    """Number of its cells."""
    moves: MoveNumber
    """Bound of the moves from here."""
    extent: BoxDocument
    """Hull of the cells; not every pose of it is certified."""
    certified_percent: Percent
    """Share of the hull that the cells fill (rounded down)."""


class PolicyClaim(Document):
    """What is proved."""

    words: str
    """The claim in words."""
    assumptions: tuple[str, ...]
    """What the proof assumes, a sentence each."""


class PolicyDocument(Document):
    """A certified feedback policy."""

    schema_: Annotated[Literal["meso-robust/policy/1"], Field(alias="schema")] = SCHEMA
    """Name and version of the format."""
    task: str
    """Name of the task."""
    task_hash: str
    """SHA-256 of the task's values, independent of the layout of its file."""
    claim: PolicyClaim
    """What is proved."""
    most_moves: Count
    """N."""
    region: tuple[RegionDocument, ...]
    """Extent of the certified starts, an entry for each orientation."""
    rest: BoxDocument | None
    """Sensed poses that prove that the part is in the goal; the policy is done there."""
    rest_exact: ExactBox | None
    """The same box, exactly; null if sensing cannot prove the goal."""
    rules: tuple[RuleDocument, ...]
    """All moves that cells name."""
    cells: tuple[CellDocument, ...]
    """Fewest moves first; the first one that holds the sensed pose decides."""


def read_document(path: Path, task: Task) -> PolicyDocument:
    """Read a policy that was made for ``task``; nothing of it is proved here.

    Parameters
    ----------
    path
        A ``policy.json``.
    task
        What it must have been made for.

    Returns
    -------
    PolicyDocument
        Every value within its rule.

    Raises
    ------
    InputError
        The file cannot be read, breaks a rule, or was made for another task.
    """
    try:
        document = PolicyDocument.model_validate_json(read_text(path), strict=True)
    except ValidationError as error:
        raise InputError(f"{path}: {first_of(error, PolicyDocument, 'policy')}") from error
    if document.task_hash != task.hash:
        raise InputError(
            f"{path}: key task_hash = {document.task_hash!r}: must be the hash {task.hash!r} of the "
            f"task; the policy was made for another task ({document.task!r}), regenerate it"
        )
    return document
