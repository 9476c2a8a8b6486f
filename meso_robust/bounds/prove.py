"""Proofs over boxes by branch and bound, and tight enclosures of ranges."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Literal, cast

import numpy as np

from meso_robust.bounds import branch
from meso_robust.bounds.bulk import Bounded, enclose_many, enclose_ranges
from meso_robust.bounds.interval import Interval
from meso_robust.types import Floats

Box = Mapping[str, Interval]

POINTS = (128, 2048)  # of a box, at which a proof is seen to be in vain; drawn once and for all
MOST_BOXES = 4096  # a proof that needs more is given up as UNKNOWN
REASONS = {
    branch.INDIVISIBLE: "no side can be divided further: zero to within rounding",
    branch.UNDEFINED: "a bound is infinite: the left side may be undefined here",
}


VerdictWord = Literal["PROVED", "REFUTED", "UNKNOWN"]


class Verdict(Enum):
    """Outcome of a proof attempt."""

    PROVED = "holds at every point of the box"
    REFUTED = "fails at the witness"
    UNKNOWN = "undecided on the box that is given with it"

    @property
    def word(self) -> VerdictWord:
        """The verdict as documents write it."""
        return cast(VerdictWord, self.name)


@dataclass(frozen=True, slots=True, kw_only=True)
class Proof:
    """What was found out about one inequality over one box."""

    verdict: Verdict
    lower: float
    """PROVED: the smallest proved lower bound of the inequality's left side, in its own unit."""
    boxes: int
    """How many boxes were bounded."""
    box: Box
    """PROVED: the whole box; REFUTED: the witness; UNKNOWN: an undecided box, none wider than it."""
    reason: str = ""
    """UNKNOWN: why ``box`` stayed open."""


def prove_positive(
    of: Bounded, box: Box, *, any_output: bool = False, most: int = MOST_BOXES
) -> Proof:
    """Decide whether the outputs of ``of`` are positive over ``box``.

    Parameters
    ----------
    of
        Prepared function.
    box
        An interval for each input.
    any_output
        False: all outputs must be positive at every point. True: at every point at least one.
    most
        How many boxes may be made before the proof is given up.

    Returns
    -------
    Proof
        REFUTED only with a point at which the inequality is proved to fail.

    Raises
    ------
    ValueError
        The box lacks an input.
    """
    lo, hi = _ends(of, box)
    if not np.isfinite(lo).all() or not np.isfinite(hi).all():
        return Proof(
            verdict=Verdict.UNKNOWN, lower=-np.inf, boxes=0, box=box, reason="a side is infinite"
        )
    outcome, least, boxes, at_lo, at_hi = branch.decide(of, lo, hi, any_output, most)
    if outcome == branch.PROVED:
        return Proof(verdict=Verdict.PROVED, lower=least, boxes=boxes, box=box)
    at = _named(of, at_lo, at_hi)
    if outcome == branch.REFUTED:
        return Proof(verdict=Verdict.REFUTED, lower=-np.inf, boxes=boxes, box=at)
    reason = REASONS.get(outcome, f"{most} boxes did not suffice")
    return Proof(verdict=Verdict.UNKNOWN, lower=-np.inf, boxes=boxes, box=at, reason=reason)


def fails_somewhere(of: Bounded, box: Box) -> bool:
    """Whether an output of ``of`` is not positive at one of some points of ``box``, most at its corners.

    It costs far less than a proof that is given up, where many are tried.

    Parameters
    ----------
    of, box
        As for `prove_positive`.

    Returns
    -------
    bool
        False says nothing.
    """
    lo, hi = _ends(of, box)
    for count in POINTS:  # few will do, as a rule
        share = np.clip(np.random.default_rng(0).uniform(-2.0, 3.0, (count, lo.size)), 0.0, 1.0)
        at = np.clip(lo + share * (hi - lo), lo, hi)
        if np.any(enclose_many(of, at, at, natural=True)[1] <= 0.0):
            return True
    return False


def enclose(of: Bounded, box: Box, *, boxes: int = 64, slack: float = 0.02) -> tuple[Interval, ...]:
    """Enclose the range of every output over ``box``.

    Parameters
    ----------
    of, box
        Prepared function, and an interval for each input.
    boxes
        Bisection stops when so many boxes were bounded ...
    slack
        ... or when no bound is further from the true range than about this share of its width (plus
        a thousandth of this share of its size). Only how tight the result is depends on it.

    Returns
    -------
    tuple[Interval, ...]
        One an output; the whole line where a side of the box is infinite.

    Raises
    ------
    ValueError
        The box lacks an input.
    """
    lo, hi = _sides(of, box)
    if not all(map(math.isfinite, (*lo, *hi))):
        return (Interval(-math.inf, math.inf),) * of.values.outputs
    lower, upper = enclose_ranges(of, np.array([lo]), np.array([hi]), boxes, slack)
    return tuple(map(Interval, lower[0].tolist(), upper[0].tolist()))


def enclose_rows(
    of: Bounded, box: Box, rows: Sequence[Box], *, boxes: int = 64, slack: float = 0.02
) -> list[tuple[Interval, ...]]:
    """Enclose the ranges of every output over boxes that differ in a few sides, as `enclose` does each.

    Parameters
    ----------
    of, box, boxes, slack
        As for `enclose`.
    rows
        What is different in each box; all of the same names.

    Returns
    -------
    list[tuple[Interval, ...]]
        One a row.

    Raises
    ------
    ValueError
        The boxes lack an input.
    """
    ends = np.empty((2, len(rows), len(of.inputs)))
    ends[0], ends[1] = _ends(of, {**box, **rows[0]})
    if len(rows) > 1:
        for k in (k for k, name in enumerate(of.inputs) if name in rows[0]):
            sides = [row[of.inputs[k]] for row in rows]
            ends[0, :, k], ends[1, :, k] = [side.lo for side in sides], [side.hi for side in sides]
    finite = np.isfinite(ends)
    if finite.all():
        lower, upper = enclose_ranges(of, ends[0], ends[1], boxes, slack)
    else:
        some = finite.all(axis=(0, 2))
        lower, upper = np.full((2, len(rows), of.values.outputs), [[[-np.inf]], [[np.inf]]])
        lower[some], upper[some] = enclose_ranges(of, ends[0, some], ends[1, some], boxes, slack)
    pairs = zip(lower.tolist(), upper.tolist(), strict=True)
    return [tuple(map(Interval, *pair)) for pair in pairs]


def _ends(of: Bounded, box: Box) -> tuple[Floats, Floats]:
    lo, hi = _sides(of, box)
    return np.array(lo), np.array(hi)


def _sides(of: Bounded, box: Box) -> tuple[list[float], list[float]]:
    try:
        sides = [box[name] for name in of.inputs]
    except KeyError:
        missing = ", ".join(name for name in of.inputs if name not in box)
        raise ValueError(f"box for {of.name} lacks {missing}; it has {', '.join(box)}") from None
    return [side.lo for side in sides], [side.hi for side in sides]


def _named(of: Bounded, lo: Floats, hi: Floats) -> Box:
    return {
        name: Interval(float(a), float(b)) for name, a, b in zip(of.inputs, lo, hi, strict=True)
    }
