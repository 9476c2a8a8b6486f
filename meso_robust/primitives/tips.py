"""Where the two tips of the active probe are, and what must hold wherever one of them sticks."""

from __future__ import annotations

from dataclasses import dataclass

from meso_robust.bounds import HALF_PI, Box, Interval
from meso_robust.bounds.interval import arcsin, cos, sin
from meso_robust.motion import sticking
from meso_robust.primitives.move import Anchor, MoveRule
from meso_robust.primitives.names import (
    Inequality,
    ObligationId,
    Which,
    about,
)
from meso_robust.primitives.obligation import Obligation, require_order
from meso_robust.primitives.outline import Edge
from meso_robust.primitives.setup import PoseBox, Setup

ZERO, HALF, ONE = Interval.point(0.0), Interval.point(0.5), Interval.point(1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tip:
    """One tip of the dual-tip probe relative to the part's centre, and its path in the world."""

    side: int
    """+1: upper, -1: lower."""
    ahead: Interval
    """x of the tip minus x of the part before the move, m."""
    rise: Interval
    """y of the tip minus y of the part before the move, m."""
    ahead_end: Interval
    """x of the tip at the end of its travel minus x of the part before the move, m."""
    rise_end: Interval
    """y of the tip at the end of its travel minus y of the part before the move, m."""
    radius: Interval
    """m; all places are those of the tip's centre."""


def tip_of(rule: MoveRule, side: int, pre: PoseBox, setup: Setup) -> Tip:
    """Enclose where the upper (1) or lower (-1) tip is.

    Parameters
    ----------
    rule, side, pre, setup
        The move, which tip, all poses before the move, the task; all in the move's axes, where a
        positive misalignment puts the upper tip ahead, that is towards -x.

    Returns
    -------
    Tip
        Its places, with all errors of sensing and of the probe in them.
    """
    u = setup.uncertainty
    lag = _up(side, setup) * sin(u.misalignment) / cos(u.misalignment)
    sensed, off = u.sensed_position, u.probe_position + u.probe_wander
    short_x, astray_y = astray(rule, pre, setup)
    rise = _rise(rule, side, pre, setup)
    return Tip(
        side=side,
        ahead=rule.dual.x.ahead_of(pre.x, sensed, off) - lag,
        rise=rise,
        ahead_end=rule.dual_end.ahead_of(pre.x, sensed, off) - lag + short_x,
        rise_end=rise + astray_y,
        radius=u.tip_radius,
    )


def _up(side: int, setup: Setup) -> Interval:
    """How far above the middle of the pair a tip is, m."""
    return Interval.point(float(side)) * HALF * setup.spacing


def _rise(rule: MoveRule, side: int, pre: PoseBox, setup: Setup) -> Interval:
    """See ``Tip.rise``."""
    u = setup.uncertainty
    off = u.probe_position + u.probe_wander
    return rule.dual.y.ahead_of(pre.y, u.sensed_position, off) + _up(side, setup)


def astray(rule: MoveRule, pre: PoseBox, setup: Setup) -> tuple[Interval, Interval]:
    """How far from where it is commanded a travel ends, by its direction and scale, m."""
    u = setup.uncertainty
    if u.travel_direction == ZERO == u.travel_scale:
        return ZERO, ZERO
    base = ZERO
    if rule.dual.x.anchor is not rule.dual_end.anchor:
        sensed = pre.x + u.sensed_position
        base = sensed if rule.dual.x.anchor is Anchor.PART else -sensed
    travel = base + rule.dual.x.offset - rule.dual_end.offset
    longer = ONE + u.travel_scale
    # a length that is known no better than the pose before is short by little of itself
    short = travel * (ONE - longer * cos(u.travel_direction))
    return short, -(travel * longer * sin(u.travel_direction))


def aligned(setup: Setup) -> Interval:
    """All directions of an edge at which both tips of the active probe touch it, in the axes of ``setup``, rad."""
    u = setup.uncertainty
    if u.tip_radius.lo == u.tip_radius.hi:
        return HALF_PI + u.misalignment
    apart = setup.spacing / cos(u.misalignment)
    return HALF_PI + u.misalignment + arcsin((u.tip_radius - u.tip_radius) / apart)


def second_tip(side: int, setup: Setup) -> tuple[Interval, Interval]:
    """Vector from the tip on ``side`` to the other one.

    Parameters
    ----------
    side
        +1: from the upper tip to the lower one; -1: back.
    setup
        The task, for the spacing and the misalignment of the pair.

    Returns
    -------
    tuple[Interval, Interval]
        x and y, in the axes of ``setup``, m.
    """
    beta = setup.uncertainty.misalignment
    down = Interval.point(-float(side)) * setup.spacing
    return -(down * sin(beta) / cos(beta)), down


def comes_free(which: Which, end: Interval) -> Obligation:
    """A tip in contact leaves the part at once when it backs off, along +x from the edge that faces it.

    A distance s of the way back takes it s sin(theta) off the line of its edge; the passive tip
    backs off along -x from the opposite edge.
    """
    return require_order(
        about(ObligationId.WITHDRAWS_FREE, tips=which),
        Inequality.FACES_BACK,
        sin(end),
        {"theta": end},
    )


def one_contact(path: Interval, offset: Interval, side: int, edge: Edge, setup: Setup) -> Box:
    """What eq. (5) depends on while one contact turns the part to ``side`` along ``path``, SI.

    Parameters
    ----------
    path
        Directions of the edge on the way, rad.
    offset
        Of the contact along the edge from the foot of the centre (d2), m.
    side
        1 if the part turns counter-clockwise, -1 if clockwise.
    edge, setup
        The pushed edge, and the task.

    Returns
    -------
    dict
        An interval for each argument of the formulas of one-point sticking, SI.
    """
    return {
        "theta": path,
        "d1": edge.depth,
        "d2": offset,
        "rho": setup.uncertainty.film_ratio,
        "mu": setup.uncertainty.friction,
        "side": Interval.point(float(side)),
    }


def touch(tip: Tip, angle: Interval, edge: Edge) -> tuple[Interval, Interval]:
    """Where the tip touches.

    Parameters
    ----------
    tip, angle, edge
        The tip, all directions of the edge at the touch (rad), the edge.

    Returns
    -------
    offset
        d2 of the contact, m.
    reach
        x of the tip's centre minus x of the part's centre, m.
    """
    rise, off = tip.rise.hull(tip.rise_end), edge.depth + tip.radius
    return sticking.contact_offset(angle, off, rise), sticking.contact_reach(angle, off, rise)


def touching(
    rule: MoveRule, side: int, pre: PoseBox, angle: Interval, edge: Edge, setup: Setup
) -> Box:
    """What says where along the edge a tip touches, for ``sticking.contact_offsets``.

    Parameters
    ----------
    rule, side, pre, setup
        As of `tip_of`, without the rest of it.
    angle, edge
        As of `touch`.

    Returns
    -------
    dict
        An interval for each argument, SI.
    """
    rise = _rise(rule, side, pre, setup)
    rise = rise.hull(rise + astray(rule, pre, setup)[1])
    return {"theta": angle, "d1": edge.depth + setup.uncertainty.tip_radius, "rise": rise}
