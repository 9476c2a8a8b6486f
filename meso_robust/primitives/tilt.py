"""Tilt: one tip pushes in sticking contact and turns the part a little (paper, Fig. 13)."""

from __future__ import annotations

import math
from dataclasses import dataclass

from meso_robust.bounds import Interval
from meso_robust.motion import sticking
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.names import (
    TURNS,
    Inequality,
    ObligationId,
    Property,
    When,
    Which,
    about,
)
from meso_robust.primitives.obligation import Knot, Obligation, Step, require_order
from meso_robust.primitives.outline import Edge
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.tips import (
    comes_free,
    free_at_start,
    in_flight,
    on_edge,
    passes,
    sticks,
    tip_of,
    touch,
    way_back,
)
from meso_robust.primitives.tube import turn_tube


@dataclass(frozen=True, slots=True, kw_only=True)
class Turn:
    """What a tilt leaves behind for the straightening that follows it."""

    y: Interval
    """y of the centre before, m."""
    start: Interval
    """Angle of the edge before, rad."""
    end: Interval
    """Angle of the edge after, rad."""
    offset: Interval
    """Contact offset d2, m."""
    edge: Edge
    """The edge that was pushed: after a large tilt another one may face the pair."""


def certify_tilt(rule: MoveRule, pre: PoseBox, setup: Setup) -> tuple[Step, Turn | None]:
    """Certify a tilt from every pose in ``pre``.

    The lower tip pushes above the middle (``rule.side`` = 1) or the upper one below it (-1), while
    the other tip passes the end of the edge.

    Parameters
    ----------
    rule, pre, setup
        The move, all poses before it, the task; all in the move's axes.

    Returns
    -------
    tuple[Step, Turn | None]
        The step, without a ``post`` where the turn could not be enclosed, and what a straightening
        that follows may use of it.
    """
    side, edge = rule.side, setup.edge(pre.theta.mid)
    u = setup.uncertainty
    pusher, idle = tip_of(rule, -side, pre, setup), tip_of(rule, side, pre, setup)
    start = edge.angle(pre.theta)
    offset, reach = touch(pusher, start, edge)
    travel = reach - pusher.ahead_end
    monotone = sticking.travel_monotone(_wide(start, side), side, edge.depth, offset, u.film_ratio)
    obligations = [
        *free_at_start((pusher, idle), start, edge),
        require_order(
            about(ObligationId.TIP_REACHES_PART), Inequality.TRAVEL, travel, {"travel": travel}
        ),
        on_edge(Which.PUSHING, offset, edge),
    ]
    if not monotone:
        return _step(rule, pre, None, obligations), None
    end = sticking.turned(start, travel, side, edge.depth, offset, u.film_ratio)
    if not end.width < math.inf:
        return _step(rule, pre, None, obligations), None
    path = start.hull(end)
    obligations += sticks(Which.PUSHING, path, offset, side, edge, setup)
    obligations += [
        passes(start, in_flight(pusher, reach), offset, side, edge, setup, When.BEFORE_TOUCH),
        passes(path, Interval.point(0.0), offset, side, edge, setup, When.WHILE_TURNING),
        passes(end, way_back(pusher), offset, side, edge, setup, When.ON_WITHDRAWAL),
        comes_free(Which.PUSHING, end),
    ]
    post = PoseBox(
        x=pusher.x_end - sticking.arm(end, edge.depth, offset)[0],
        y=pre.y + sticking.lift(start, end, edge.depth, offset),
        theta=edge.orientation(end),
    )
    tube = turn_tube(start, end, side, offset, reach, edge, u.film_ratio, pre)
    return _step(rule, pre, post, obligations, tube), Turn(
        y=pre.y, start=start, end=end, offset=offset, edge=edge
    )


def _wide(start: Interval, side: int) -> Interval:
    """All angles that the candidates of the enclosure can visit."""
    return start.hull(start + Interval.point(side * sticking.LARGEST_TURN))


def _step(
    rule: MoveRule,
    pre: PoseBox,
    post: PoseBox | None,
    obligations: list[Obligation],
    tube: tuple[Knot, ...] = (),
) -> Step:
    return Step(
        rule=rule,
        claim=about(Property.TURNS_PART, turn=TURNS[rule.side]),
        pre=pre,
        post=post,
        obligations=tuple(obligations),
        tube=(Knot(stage="at rest", box=pre), *tube),
    )
