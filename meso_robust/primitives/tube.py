"""Tubes: every pose that the part can have during a move, as slices one after the other."""

from __future__ import annotations

from collections.abc import Mapping

from meso_robust.bounds import Interval
from meso_robust.primitives.base import pose_of
from meso_robust.primitives.implicit import Implicit, bound
from meso_robust.primitives.obligation import Knot
from meso_robust.primitives.one_tip import POSE

SLICES = 8  # of a turn about one tip; more only make the boxes of a turn narrower


def turn_tube(of: Implicit, box: Mapping[str, Interval], guess: float) -> tuple[Knot, ...]:
    """Slices of a turn about one sticking tip, from its touch on.

    Parameters
    ----------
    of
        Where the part is when a share of the turn is done.
    box
        The base parameters of the move.
    guess
        About the direction of the edge at the end, rad.

    Returns
    -------
    tuple[Knot, ...]
        One for each share of the turn; none where one of them could not be enclosed.
    """
    knots = []
    for k in range(SLICES):  # a power of 2: the shares meet exactly
        share = Interval(k / SLICES, (k + 1) / SLICES)
        ends = bound(of, {**box, "share": share}, guess, both=POSE)
        if ends is None:
            return ()
        knots.append(Knot(stage="one tip turns the part", box=pose_of(ends)))
    return tuple(knots)
