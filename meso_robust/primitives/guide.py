"""Guided by the walls: a part whose front is in the slot is pushed in, and may touch the slot's walls.

Whatever the walls do, the part never leans more than it, or the line through both tips, did at the start:
where it leans more than that line only one tip pushes, and then the slot's edge, or the wall across, turns
it back; and between tips and one wall it cannot jam (``derivations/slot_walls.py``). So where it ends is
plain geometry: the tips say how deep, the walls how far aside. No motion is followed, and the film only
must be even.
"""

from __future__ import annotations

from dataclasses import dataclass

from meso_robust.bounds import HALF_PI, Interval
from meso_robust.bounds.interval import cos, sin
from meso_robust.primitives.base import base_box, bend_of, free_at_start
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.names import SIDES, Inequality, ObligationId, Property, Which, about
from meso_robust.primitives.obligation import Knot, Obligation, Step, require, require_order
from meso_robust.primitives.outline import Edge, Rectangle
from meso_robust.primitives.setup import ZERO, PoseBox, Setup
from meso_robust.primitives.slot import Channel, channel
from meso_robust.primitives.tips import HALF, ONE, aligned, astray, comes_free

TWO = ONE + ONE
MOST_LEAN = 0.5
"""rad; more is not looked at."""


def certify_guide(rule: MoveRule, pre: PoseBox, setup: Setup) -> Step:
    """Certify a push into the slot, from every pose in ``pre``, in which the part may touch its side walls.

    Parameters
    ----------
    rule, pre, setup
        The move, all poses before it, the task; all in the move's axes, along whose -x the slot runs.

    Returns
    -------
    Step
        In the move's axes; without a ``post`` where it is not covered: a part that is no sharp rectangle of right
        angles, an uneven film, a cap on forces, no slot along the push.
    """
    into = channel(rule.frame, setup)
    u = setup.uncertainty
    uneven = (u.drag_anisotropy, u.drag_centre, u.squareness, setup.corner_radius) != (ZERO,) * 4
    if into is None or uneven or not isinstance(setup.outline, Rectangle) or setup.largest_force:
        return _undecided(rule, pre)
    push = _push(rule, pre, setup, into)
    if push is None:
        return _undecided(rule, pre)
    edge = push.edge
    obligations = [
        *free_at_start((1, -1), base_box(rule, pre, setup, edge), edge),
        *push.obligations(),
        comes_free(Which.PAIR, HALF_PI + both(push.lean) + both(push.veer)),
    ]
    x = into.mouth_x - push.deep_end
    y = into.mouth_y + both(push.aside)
    post = PoseBox(x=x, y=y, theta=edge.orientation(HALF_PI + both(push.lean)))
    way = PoseBox(x=into.mouth_x - push.deep, y=y, theta=post.theta)
    return Step(
        rule=rule,
        claim=about(Property.GUIDED_BY_WALLS),
        pre=pre,
        post=post,
        obligations=tuple(obligations),
        tube=(
            Knot(stage="at rest", box=pre),
            Knot(stage="guided by the walls", box=pre.hull(way)),
        ),
    )


def both(size: Interval) -> Interval:
    """All values of either sign up to a size."""
    return (-size).hull(size)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Push:
    """A guided push, SI; *deep* is how far the part's centre is within the mouth, *aside* how far off the axis."""

    setup: Setup
    into: Channel
    edge: Edge
    front: Interval
    """Distance of the front from the centre."""
    beside: Interval
    """Distance of the sides from the centre, each its own."""
    lean: Interval
    """From none to the most, rad."""
    high: dict[int, Interval]
    """How far each tip's centre is off the axis, on its own side."""
    deep: Interval
    """At any time."""
    deep_end: Interval
    off: Interval
    """Of the centre off the slot's axis before the move."""
    spare: Interval
    """By how much the upper tip would be within the rear edge at the end if the part had not moved."""

    @property
    def out(self) -> Interval:
        """Distance of a tip's centre behind the part's centre while it touches."""
        return self.edge.depth + self.setup.uncertainty.tip_radius

    @property
    def veer(self) -> Interval:
        """The most by which a tip's path is off the slot's axis, rad."""
        u = self.setup.uncertainty
        return _largest(u.travel_direction) + _largest(bend_of(u))

    @property
    def edge_at(self) -> Interval:
        """How far ahead of the part's centre the slot's edge is, along the side that bears on it."""
        c, s = cos(self.lean), sin(self.lean)
        return -((self.deep + self.beside * s) / c)

    @property
    def aside(self) -> Interval:
        """Off the slot's axis at most: a front corner is within one wall, a side beside the other one's edge."""
        c, s = cos(self.lean), sin(self.lean)
        most = self.into.half - self.beside * c + self.edge_at.hull(ZERO) * s
        return Interval(0.0, most.hi)

    def offset(self, side: int) -> Interval:
        """Of a tip's contact along the rear edge from its middle."""
        y = Interval.point(float(side)) * self.high[side]
        return (y + both(self.aside) + both(self.out * sin(self.lean))) / cos(self.lean)

    def obligations(self) -> list[Obligation]:
        """What must hold, but for what holds of any push."""
        into, edge, u = self.into, self.edge, self.setup.uncertainty
        c, s = cos(self.lean), sin(self.lean)
        walls = {"b": self.beside, "mu_w": into.friction}
        within = {
            "front": self.deep + self.front * c - self.beside * s,
            "rear": edge.depth * c - self.deep - self.beside * s,
            "end": into.depth - self.deep - self.front - self.beside * s,
            "aside": into.half - self.off - self.front * s,
        }
        found = [
            require_order(
                about(ObligationId.TIP_REACHES_PART),
                Inequality.TRAVEL,
                self.spare,
                {"travel": self.spare},
            ),
            require_order(
                about(ObligationId.PART_IN_SLOT), Inequality.IN_SLOT, _least(within), within
            ),
            require(
                about(ObligationId.ONE_WALL_AT_A_TIME),
                Inequality.ONE_WALL,
                {
                    **walls,
                    "room": into.half * TWO,
                    "engaged": self.front - self.edge_at,
                    "phi": self.lean,
                },
            ),
            require(
                about(ObligationId.NO_JAM),
                Inequality.NO_JAM_IN_SLOT,
                {**walls, "mu": u.friction, "phi": self.lean},
            ),
            require(
                about(ObligationId.WALL_TURNS_BACK),
                Inequality.CORNER_TURNS,
                {**walls, "d1": edge.depth.hull(self.front), "phi": self.lean},
            ),
            require(
                about(ObligationId.FILM_TURNS_WITH),
                Inequality.STIFF,
                {**walls, "rho": u.film_ratio},
            ),
        ]
        for side in (1, -1):
            tip, high, offset = SIDES[side], self.high[side], self.offset(side)
            on_edge = {"d2": offset, "first": edge.first, "last": edge.last}
            found += [
                require_order(
                    about(ObligationId.TIP_ON_EDGE, tip=tip),
                    Inequality.WITHIN_EDGE,
                    _least({"first": offset - edge.first, "last": edge.last - offset}),
                    on_edge,
                ),
                require(
                    about(ObligationId.EDGE_TURNS_BACK, tip=tip),
                    Inequality.BEARS,
                    {
                        **walls,
                        "d1": edge.depth,
                        # a part that bears on the slot's edge is as far to that side as it can be
                        "d2": high + into.half - self.beside,
                        "p": self.edge_at,
                        "mu": u.friction,
                    },
                ),
                require(
                    about(ObligationId.TIP_STEERS, tip=tip),
                    Inequality.STEERS,
                    {
                        "d1": edge.depth,
                        "d2": (high - into.half) / c + self.beside,
                        "psi": self.lean + both(self.veer),
                    },
                ),
            ]
        return found


def _push(rule: MoveRule, pre: PoseBox, setup: Setup, into: Channel) -> _Push | None:
    """The push in numbers; None: it leans too much for anything to be said."""
    u, theta = setup.uncertainty, pre.theta.mid
    edge, (far, _) = setup.edge(theta), setup.opposite(setup.edge(theta))
    sides = setup.edge(theta + HALF_PI.mid), setup.edge(theta - HALF_PI.mid)
    most = max(_largest(HALF_PI - one).hi for one in (edge.angle(pre.theta), aligned(setup)))
    if not most < MOST_LEAN:
        return None
    lean = Interval(0.0, most)
    c, s = cos(lean), sin(lean)
    sensed, off = u.sensed_position, u.probe_position + u.probe_wander
    short_x, astray_y = astray(rule, pre, setup)
    y = rule.dual.y.place(pre.y, sensed, off) - into.mouth_y
    y = y.hull(y + astray_y)
    half = setup.spacing * HALF
    lag = half * sin(u.misalignment) / cos(u.misalignment)
    x_end = rule.dual_end.place(pre.x, sensed, off) + short_x
    out, reach = edge.depth + u.tip_radius, _largest(edge.first.hull(edge.last))
    rocks = reach * s
    before = into.mouth_x - pre.x
    ends = [into.mouth_x - (x_end - lag * Interval.point(side)) for side in (1.0, -1.0)]
    deep_end = (ends[0].hull(ends[1]) + out * c) + both(rocks)
    # from the touch on the rear edge never is behind where a tip was at the touch
    slack = (
        _largest(lag) * TWO
        + _largest(u.probe_wander) * TWO
        + out * (ONE - c)
        + _largest(u.tip_radius - u.tip_radius)
        + rocks * TWO
    )
    deep = Interval(
        (Interval.point(before.lo) - Interval.point(slack.hi)).lo, max(before.hi, deep_end.hi)
    )
    return _Push(
        setup=setup,
        into=into,
        edge=edge,
        front=far.depth,
        beside=sides[0].depth.hull(sides[1].depth),
        lean=lean,
        high={1: y + half, -1: half - y},
        deep=deep,
        deep_end=deep_end,
        off=_largest(pre.y - into.mouth_y),
        spare=ends[0] + out * c - rocks - before,
    )


def _largest(side: Interval) -> Interval:
    """The largest size in a range, as a number."""
    return Interval.point(max(abs(side.lo), abs(side.hi)))


def _least(of: dict[str, Interval]) -> Interval:
    """The smallest of several."""
    return Interval(min(one.lo for one in of.values()), min(one.hi for one in of.values()))


def _undecided(rule: MoveRule, pre: PoseBox) -> Step:
    name = about(ObligationId.GUIDE_COVERED)
    return Step(
        rule=rule,
        claim=about(Property.GUIDED_BY_WALLS),
        pre=pre,
        post=None,
        obligations=(require_order(name, Inequality.NONE, Interval(float("-inf"), 0.0), {}),),
        tube=(Knot(stage="at rest", box=pre),),
    )
