"""Step (2a) of Lemma 1's search: whether a push sticks under the nominal condition.

Plain numbers, no proof: it only saves certifying what cannot be certified. What does not stick at one corner of
the task's ranges is not certified for all of them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from meso_robust.bounds import HALF_PI
from meso_robust.conditions import condition
from meso_robust.conditions.arrays import values
from meso_robust.primitives.setup import PoseBox, Setup

SLACK = 0.03
"""Of the film's ratio, by which a margin may fall short: that contacts roll on round tips is not counted."""
_MARGIN = values("one_point_sticking", "friction_margin")


def may_stick(angles: Sequence[float], offset: float, depth: float, setup: Setup) -> bool:
    """Whether a contact sticks with the least friction and wherever the centre of drag is.

    Parameters
    ----------
    angles
        Of the edge, rad.
    offset
        Of the contact along the edge (d2), m.
    depth
        Distance of the edge from the centre (d1), m.
    setup
        The task.

    Returns
    -------
    bool
        No proof; see the module's text.
    """
    u = setup.uncertainty
    sides = ([side.lo, side.hi] for side in (u.drag_centre, u.drag_centre, u.film_ratio))
    theta, along, out, rho = np.ix_(angles, *sides)
    margins = _MARGIN(theta=theta, d1=depth - out, d2=offset - along, rho=rho, mu=u.friction.lo)
    return bool(np.min(margins) > -SLACK * u.film_ratio.mid)


def sticks(start: float, end: float, offset: float, depth: float, setup: Setup) -> bool:
    """Whether a contact sticks at both ends of a turn, at the middle of all ranges.

    Parameters
    ----------
    start, end
        Angles of the edge, rad.
    offset
        Of the contact along the edge (d2), m.
    depth
        Distance of the edge from the centre (d1), m.
    setup
        The task.

    Returns
    -------
    bool
        No proof; see the module's text.
    """
    u = setup.uncertainty
    margin = condition("one_point_sticking", "friction_margin").function
    values = [
        margin([angle, depth, offset, u.film_ratio.mid, u.friction.mid]) for angle in (start, end)
    ]
    return bool(np.min(values) > 0.0)


def straightens(middle: float, pre: PoseBox, setup: Setup, *, slipping: bool = False) -> bool:
    """Whether a t^2 push would work, at the middle of all ranges.

    Parameters
    ----------
    middle
        Height of the pair's middle above the centre, m.
    pre, setup
        All poses before the push, and the task, in its axes.
    slipping
        Whether the first tip may slip.

    Returns
    -------
    bool
        No proof; see the module's text.
    """
    edge = setup.edge(pre.theta.mid)
    depth = edge.depth.mid
    start, end = edge.angle(pre.theta).mid, HALF_PI.mid + setup.uncertainty.misalignment.mid
    side = 1.0 if start < end else -1.0
    if slipping and not _slips(middle, pre, setup):
        return False
    rise = middle + 0.5 * side * setup.spacing.mid
    touch = condition("sticking_motion", "contact_offset").function
    first = float(touch([start, depth + setup.uncertainty.tip_radius.mid, rise]))
    second = first - side * setup.spacing.mid
    turning = condition("one_point_sticking", "turning").function
    away = -side * second - setup.uncertainty.friction.mid * depth > 0.0  # it turns back any way
    return (
        edge.first.mid < min(first, second)
        and max(first, second) < edge.last.mid
        and float(turning([start, depth, first, side])) > 0.0
        and (slipping or sticks(start, end, first, depth, setup))
        and (
            away
            or (
                float(turning([end, depth, second, -side])) > 0.0
                and sticks(end, end, second, depth, setup)
            )
        )
    )


def _slips(middle: float, pre: PoseBox, setup: Setup) -> bool:
    """Whether the first tip touches the edge wherever it is, and lifts it."""
    edge, end = setup.edge(pre.theta.mid), HALF_PI.mid + setup.uncertainty.misalignment.mid
    angles = edge.angle(pre.theta)
    side = 1.0 if angles.mid < end else -1.0
    rise = side * middle + 0.5 * setup.spacing.mid
    touch = condition("sticking_motion", "contact_offset").function
    out = edge.depth.mid + setup.uncertainty.tip_radius.mid
    firsts = [float(touch([a, out, side * rise])) for a in (angles.lo, angles.hi)]
    within = all(edge.first.mid < first < edge.last.mid for first in firsts)
    return within and rise > setup.uncertainty.drag_centre.hi
