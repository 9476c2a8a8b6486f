"""Proofs over boxes by branch and bound, and tight enclosures of ranges."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Literal, cast

import numpy as np

from meso_robust.bounds.bulk import Bounded, enclose_many, enclose_range, split
from meso_robust.bounds.interval import Interval
from meso_robust.bounds.tape import Floats

Box = Mapping[str, Interval]

MOST_BOXES = 4096


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
    """PROVED: the whole box; REFUTED: the witness; UNKNOWN: the widest undecided box."""


def prove_positive(of: Bounded, box: Box, *, any_output: bool = False) -> Proof:
    """Decide whether the outputs of ``of`` are positive over ``box``.

    Parameters
    ----------
    of
        Prepared function.
    box
        An interval for each input.
    any_output
        False: all outputs must be positive at every point. True: at every point at least one.
    """
    lo, hi = _ends(of, box)
    if not np.isfinite(lo).all() or not np.isfinite(hi).all():
        return Proof(verdict=Verdict.UNKNOWN, lower=-np.inf, boxes=0, box=box)
    spent, least = 0, np.inf
    join = np.max if any_output else np.min
    while True:
        lower, _, smear = enclose_many(of, lo, hi)
        spent += lo.shape[0]
        score = join(lower, axis=1)
        open_ = ~(score > 0.0)
        least = min(least, float(np.min(score[~open_], initial=np.inf)))
        if not open_.any():
            return Proof(verdict=Verdict.PROVED, lower=least, boxes=spent, box=box)
        lo, hi, smear = lo[open_], hi[open_], smear[open_]
        witness = _witness(of, lo, hi, any_output)
        if witness is not None:
            return Proof(verdict=Verdict.REFUTED, lower=-np.inf, boxes=spent, box=witness)
        if spent + 2 * lo.shape[0] > MOST_BOXES or not np.all((hi > lo).any(axis=1)):
            widest = int(np.argmax(np.prod(1.0 + hi - lo, axis=1)))
            undecided = _named(of, lo[widest], hi[widest])
            return Proof(verdict=Verdict.UNKNOWN, lower=-np.inf, boxes=spent, box=undecided)
        lo, hi = split(lo, hi, smear)


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
    """
    lo, hi = _ends(of, box)
    if not np.isfinite(lo).all() or not np.isfinite(hi).all():
        return (Interval(-np.inf, np.inf),) * of.values.outputs
    lower, upper = enclose_range(of, lo[0], hi[0], boxes, slack)
    return tuple(map(Interval, lower.tolist(), upper.tolist()))


def _ends(of: Bounded, box: Box) -> tuple[Floats, Floats]:
    missing = [name for name in of.inputs if name not in box]
    if missing:
        raise ValueError(f"box for {of.name} lacks {', '.join(missing)}; it has {', '.join(box)}")
    lo = np.array([[box[name].lo for name in of.inputs]])
    hi = np.array([[box[name].hi for name in of.inputs]])
    return lo, hi


def _named(of: Bounded, lo: Floats, hi: Floats) -> Box:
    return {
        name: Interval(float(a), float(b)) for name, a, b in zip(of.inputs, lo, hi, strict=True)
    }


def _witness(of: Bounded, lo: Floats, hi: Floats, any_output: bool) -> Box | None:
    """The middle of an open box at which the inequality is proved to fail, if there is one."""
    middle = 0.5 * (lo + hi)
    _, upper, _ = enclose_many(of, middle, middle)
    fails = (np.max(upper, axis=1) if any_output else np.min(upper, axis=1)) <= 0.0
    where = np.flatnonzero(fails)
    return _named(of, middle[where[0]], middle[where[0]]) if where.size else None
