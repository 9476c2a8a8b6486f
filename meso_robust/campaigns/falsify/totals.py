"""What comes of draws in bulk, of one chunk or of many added up."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from meso_robust.laboratory.claims import Claims, slips
from meso_robust.laboratory.judging import Judged
from meso_robust.types import Floats

STICKS = ("tilt", "straighten")
"""Motions of which it is claimed that the first contact sticks."""
Ends = list[list[float]]
"""(2, 3) least and largest pose (m, m, rad)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Totals:
    """The outcome of draws; M moves, D columns."""

    runs: int = 0
    failed: int = 0
    """Runs that break any claim."""
    unfinished: int = 0
    """Runs that the engine could not finish."""
    repeated: int = 0
    """Runs of the stepper that were repeated at smaller steps."""
    broken: dict[str, int] = field(default_factory=dict)
    """Runs that break a claim, by its words; zero too."""
    after: list[Ends | None] = field(default_factory=list)
    """(M,) extremes of the poses after each move; None if no run came to its end."""
    during: list[Ends | None] = field(default_factory=list)
    """(M,) the same of all poses seen during each move."""
    slip: list[float] = field(default_factory=list)
    """(M,) largest slip of the first contact of each move of `STICKS`, m."""
    covered: list[list[int]] = field(default_factory=list)
    """(D, BINS) see ``campaigns.coverage``."""
    corners: int = 0
    """Bit k: the corner k of the run-level columns was met."""

    def plus(self, other: Totals) -> Totals:
        """Both together."""
        if not self.runs or not other.runs:
            return self if self.runs else other
        both = np.array(self.covered) + np.array(other.covered)
        return Totals(
            runs=self.runs + other.runs,
            failed=self.failed + other.failed,
            unfinished=self.unfinished + other.unfinished,
            repeated=self.repeated + other.repeated,
            broken=added(self.broken, other.broken),
            after=[_wider(*pair) for pair in zip(self.after, other.after, strict=True)],
            during=[_wider(*pair) for pair in zip(self.during, other.during, strict=True)],
            slip=[max(pair) for pair in zip(self.slip, other.slip, strict=True)],
            covered=both.tolist(),
            corners=self.corners | other.corners,
        )


def added(one: Mapping[str, int], other: Mapping[str, int]) -> dict[str, int]:
    """Counts by name, added up."""
    names = {**one, **other}
    return {name: one.get(name, 0) + other.get(name, 0) for name in names}


def _wider(one: Ends | None, other: Ends | None) -> Ends | None:
    if one is None or other is None:
        return one or other
    low, high = np.minimum(one[0], other[0]), np.maximum(one[1], other[1])
    return [low.tolist(), high.tolist()]


def totals(judged: Judged, claims: Claims, covered: list[list[int]], leading: Floats) -> Totals:
    """Counts and extremes of runs; a run that ended early counts up to the move before.

    Parameters
    ----------
    judged, claims
        The runs, and what they were held against.
    covered
        Histogram of their rows.
    leading
        (N, C) the run-level columns of their rows, as shares of each range.
    """
    runs = judged.runs
    after, during, slip = [], [], []
    for k, (rule, move) in enumerate(zip(claims.rules, runs.moves, strict=True)):
        done = runs.failed_in > k
        after.append(_ends(move.after[done]))
        during.append(_ends(move.path[done].reshape(-1, 3)))
        drift = slips(move)[done] if rule.action in STICKS else np.zeros(0)
        slip.append(float(drift[np.isfinite(drift)].max(initial=0.0)))
    return Totals(
        runs=len(leading),
        failed=int(judged.any_broken.sum()),
        unfinished=int(judged.unfinished.sum()),
        repeated=judged.repeated,
        broken=counts(judged),
        after=after,
        during=during,
        slip=slip,
        covered=covered,
        corners=_corners(leading),
    )


def counts(judged: Judged) -> dict[str, int]:
    """Runs that break each claim, by its words: this is what files hold."""
    return {claim.words: int(flags.sum()) for claim, flags in judged.broken.items()}


def _ends(poses: Floats) -> Ends | None:
    if not len(poses):
        return None
    return [poses.min(axis=0).tolist(), poses.max(axis=0).tolist()]


def _corners(shares: Floats) -> int:
    """Bits of the corners of the unit cube that are among the points."""
    at = shares[((shares == 0.0) | (shares == 1.0)).all(axis=1)].astype(int)
    return sum(1 << int(k) for k in np.unique(at @ (1 << np.arange(shares.shape[1]))))
