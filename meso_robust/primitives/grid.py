"""Boxes on a decimal grid: what is proved is stated in numbers that someone else can meet.

Two careful enclosures of one set differ by a little. A box that is widened to the next decimals
leaves room for the other one, and can be written down in full.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from meso_robust import units
from meso_robust.bounds import Interval
from meso_robust.primitives.setup import PoseBox

PER_UM = 1000
PER_DEG = 10000
ROOM = 0.25
"""Least widening of an end, in steps of the grid."""


WIDENING = Interval.point(0.01)
"""Share of its width by which a box is widened on either side: what another enclosure may differ by."""


def roomy(box: PoseBox) -> PoseBox:
    """The box with room for another careful enclosure of the same poses, on the grid.

    Parameters
    ----------
    box
        What was proved.

    Returns
    -------
    PoseBox
        What is stated.
    """
    return on_grid(PoseBox(x=_with_room(box.x), y=_with_room(box.y), theta=_with_room(box.theta)))


def _with_room(side: Interval) -> Interval:
    return side.hull(side + WIDENING * (side - side))


def on_grid(box: PoseBox) -> PoseBox:
    """The box widened to multiples of 0.001 um and 0.0001 deg."""
    return PoseBox(
        x=_widened(box.x, PER_UM, units.to_um, units.metres),
        y=_widened(box.y, PER_UM, units.to_um, units.metres),
        theta=_widened(box.theta, PER_DEG, units.to_deg, units.radians),
    )


def _widened(
    side: Interval,
    per_unit: int,
    told: Callable[[float], float],
    meant: Callable[[float], Interval],
) -> Interval:
    low = meant(math.floor(told(side.lo) * per_unit - ROOM) / per_unit)
    high = meant(math.ceil(told(side.hi) * per_unit + ROOM) / per_unit)
    return side.hull(low).hull(high)  # holds the side whatever the conversion rounded
