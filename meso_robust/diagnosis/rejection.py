"""Why a set of effects is rejected: a reason with its data. One table holds the words."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np


class Ground(enum.StrEnum):
    """Why a set is rejected; the value is that in `diagnosis.json`."""

    NO_GAIN = "no-gain"
    """It is no likelier than the plain model."""
    MISMATCH_LEFT = "mismatch-left"
    """The detector still sees something; ``names`` is the largest local test."""
    SAME_MOTION = "same-motion"
    """``names`` make the same motion with fewer numbers."""
    OUTSCORED = "outscored"
    """``names`` are ``amount`` nats likelier and still not enough: it fits by chance."""
    SLIGHT_MEMBER = "slight-member"
    """One of its effects explains only ``amount`` nats."""
    SUBSET_SUFFICES = "subset-suffices"
    """``names``, a part of it, are enough."""
    HELD_OUT_WORSE = "held-out-worse"
    """Held-out recordings are ``amount`` nats likelier without it."""
    IDLE_MEMBER = "idle-member"
    """On held-out recordings ``names``, a part of it, do as well."""
    ABOVE_FLOOR = "above-floor"
    """It leaves ``amount`` σ of most recordings, where any law could leave ``limit`` σ."""
    IMPROBABLE = "improbable"
    """Likelier sets hold all but ``amount`` % of the probability."""
    FAR_BEHIND = "far-behind"
    """``names`` are ``amount`` nats likelier: too far to ask whether it leaves a mismatch."""
    INVARIANCE = "invariance"
    """It does not break ``invariance`` as the recordings ``names`` do."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rejection:
    """A ground and what it speaks of; see `Ground` for which fields each one has."""

    ground: Ground
    names: tuple[str, ...] = ()
    amount: float = np.nan
    limit: float = np.nan
    invariance: str = ""

    @property
    def words(self) -> str:
        """For people."""
        joined = (" and " if self.ground is Ground.INVARIANCE else " + ").join(self.names)
        return _WORDS[self.ground].format(
            names=joined, amount=self.amount, limit=self.limit, invariance=self.invariance
        )


_WORDS: Mapping[Ground, str] = {
    Ground.NO_GAIN: "no better than the plain model",
    Ground.MISMATCH_LEFT: "leaves a mismatch ({names})",
    Ground.SAME_MOTION: "the same motion as {names}",
    Ground.OUTSCORED: "{names} is {amount:.0f} nats likelier, and not enough",
    Ground.SLIGHT_MEMBER: "one of them explains only {amount:.0f} nats, as another law might",
    Ground.SUBSET_SUFFICES: "{names} is enough",
    Ground.HELD_OUT_WORSE: "held-out recordings are {amount:.1f} nats likelier without it",
    Ground.IDLE_MEMBER: "held-out recordings are as likely with {names} alone",
    Ground.ABOVE_FLOOR: "leaves {amount:.2f} σ of most recordings, where any law could leave "
    "{limit:.2f} σ",
    Ground.IMPROBABLE: "likelier sets hold all but {amount:g} % of what is probable",
    Ground.FAR_BEHIND: "{amount:.0f} nats behind {names}, too far to ask whether it leaves a mismatch",
    Ground.INVARIANCE: "does not break the invariance {invariance!r} as {names} do",
}
