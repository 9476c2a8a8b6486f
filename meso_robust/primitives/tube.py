"""Tubes: every pose that the part can have during a move, as slices one after the other."""

from __future__ import annotations

import itertools

import numpy as np

from meso_robust.bounds import Interval
from meso_robust.motion import sticking
from meso_robust.primitives.obligation import Knot
from meso_robust.primitives.outline import Edge
from meso_robust.primitives.setup import PoseBox

SLICES = 8  # of a turn about one tip; more only make the boxes of a turn narrower


def turn_tube(
    start: Interval,
    end: Interval,
    side: int,
    offset: Interval,
    reach: Interval,
    edge: Edge,
    ratio: Interval,
    pre: PoseBox,
) -> tuple[Knot, ...]:
    """Slices of a turn about one sticking tip, from its touch on.

    Parameters
    ----------
    start, end
        Angles of the edge before and after, rad.
    side
        +1: counter-clockwise, -1: clockwise.
    offset, reach
        Where on the edge the tip touches (d2), and how far right of the centre it does, m.
    edge, ratio
        The edge, and rho in m^2.
    pre
        All poses before.
    """
    path = start.hull(end)
    cuts = [float(cut) for cut in np.linspace(path.lo, path.hi, SLICES + 1)]
    cuts[0], cuts[-1] = path.lo, path.hi  # linspace rounds; no angle may fall beside the slices
    slices = [Interval(low, high) for low, high in itertools.pairwise(cuts)]
    found = []
    for angles in slices if side > 0 else reversed(slices):
        travel = _travel(start, angles, side, offset, edge, ratio)
        centre = sticking.arm(angles, edge.depth, offset)[0]
        box = PoseBox(
            x=pre.x + reach - travel - centre,
            y=pre.y + sticking.lift(start, angles, edge.depth, offset),
            theta=edge.orientation(angles),
        )
        found.append(Knot(stage="one tip turns the part", box=box))
    return tuple(found)


def _travel(
    start: Interval, angles: Interval, side: int, offset: Interval, edge: Edge, ratio: Interval
) -> Interval:
    """Travel in contact of all motions that are at one of ``angles``, m."""
    begun = start.lo < angles.hi if side > 0 else start.hi > angles.lo
    most = sticking.longest_travel(start, angles, side, edge.depth, offset, ratio) if begun else 0.0
    least = sticking.shortest_travel(start, angles, side, edge.depth, offset, ratio)
    return Interval(least, max(most, least))
