"""Straighten (t^2): one-point sticking until both tips touch, then translation with the probe.

Paper, Section IX-E and Fig. 12. Whichever tip touches first turns the edge towards the line through
both tips; from then on the part travels with the probe at angle pi/2 + beta.
"""

from __future__ import annotations

import functools
import math
from dataclasses import replace

from meso_robust.bounds import HALF_PI, Interval, Verdict, enclose
from meso_robust.bounds.interval import cos
from meso_robust.conditions import condition
from meso_robust.motion import sticking
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.names import SIDES, Inequality, ObligationId, Property, Which, about
from meso_robust.primitives.obligation import Knot, Obligation, Step, require, require_order
from meso_robust.primitives.outline import Edge
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.tilt import Turn
from meso_robust.primitives.tips import (
    Tip,
    comes_free,
    free_at_start,
    on_edge,
    sticks,
    tip_of,
    touch,
)
from meso_robust.primitives.tube import turn_tube


def certify_straighten(
    rule: MoveRule, pre: PoseBox, setup: Setup, tilt: Turn | None = None
) -> Step:
    """Certify a t^2 motion from every pose in ``pre``.

    Parameters
    ----------
    rule, pre, setup
        The move, all poses before it, the task; all in the move's axes.
    tilt
        The tilt that came just before, if any. The centre's height before the straightening hangs
        together with the angle then; using the tilt's own start (``lift`` twice) keeps that, if it
        is the same edge that is pushed.

    Returns
    -------
    Step
        In the move's axes; without a ``post`` where a tip is not proved to hold.
    """
    edge = setup.edge(pre.theta.mid)
    tilt = tilt if tilt is not None and tilt.edge == edge else None
    start = edge.angle(pre.theta)
    aligned = HALF_PI + setup.uncertainty.misalignment
    tips = {side: tip_of(rule, side, pre, setup) for side in (1, -1)}
    obligations = [*free_at_start((tips[1], tips[-1]), start, edge)]
    obligations.append(comes_free(Which.PAIR, aligned))
    posts, tube = [], [Knot(stage="at rest", box=pre)]
    for side, part in _first_contacts(start, aligned):
        proofs, post, knots = _one_side(side, part, aligned, tips, edge, pre, setup, tilt)
        obligations += proofs
        posts.append(post)
        tube += knots
    post = functools.reduce(_hull, posts)
    return Step(
        rule=rule,
        claim=about(Property.STRAIGHTENS),
        pre=pre,
        post=post,
        obligations=tuple(obligations),
        tube=tuple(tube),
    )


def _hull(one: PoseBox | None, other: PoseBox | None) -> PoseBox | None:
    return None if one is None or other is None else one.hull(other)


def _first_contacts(start: Interval, aligned: Interval) -> list[tuple[int, Interval]]:
    """Which tip can touch first (+1: upper, turning counter-clockwise), and from which angles."""
    cases = []
    if start.lo < aligned.hi:
        cases.append((1, Interval(start.lo, min(start.hi, aligned.hi))))
    if start.hi > aligned.lo:
        cases.append((-1, Interval(max(start.lo, aligned.lo), start.hi)))
    return cases or [(1, start)]


def _one_side(
    side: int,
    start: Interval,
    aligned: Interval,
    tips: dict[int, Tip],
    edge: Edge,
    pre: PoseBox,
    setup: Setup,
    tilt: Turn | None,
) -> tuple[list[Obligation], PoseBox | None, tuple[Knot, ...]]:
    first = SIDES[side]
    offset, reach = touch(tips[side], start, edge)
    path = start.hull(aligned)
    obligations = [
        on_edge(first, offset, edge),
        *sticks(first, path, offset, side, edge, setup),
        *_pair_holds(side, offset, aligned, edge, setup),
        _arrives(side, start, aligned, offset, reach - tips[side].ahead_end, edge, setup),
    ]
    if any(obligation.proof.verdict is not Verdict.PROVED for obligation in obligations):
        return obligations, None, ()
    if tilt is None:
        y = pre.y + sticking.lift(start, aligned, edge.depth, offset)
    else:
        # y before the tilt = y now - lift of the tilt: put together, the cosine of the tilted
        # angle cancels (derivations/y_translation.py)
        y = tilt.y + _gain(tilt, aligned, offset, edge)
    x_end = tips[side].x_end - sticking.arm(aligned, edge.depth, offset)[0]
    post = PoseBox(x=x_end, y=y, theta=edge.orientation(aligned))
    ratio = setup.uncertainty.film_ratio
    turning = turn_tube(start, aligned, side, offset, reach, edge, ratio, pre)
    met = [k.box.x for k in turning if k.box.theta.meets(post.theta)]
    together = replace(post, x=functools.reduce(Interval.hull, met, post.x))
    return obligations, post, (*turning, Knot(stage="both tips push", box=together))


def _gain(tilt: Turn, aligned: Interval, offset: Interval, edge: Edge) -> Interval:
    box = {
        "theta_0": tilt.start,
        "theta_1": tilt.end,
        "theta_2": aligned,
        "d1": edge.depth,
        "d2": tilt.offset,
        "d2_back": offset,
    }
    return enclose(condition("y_translation", "gain"), box)[0]


def _pair_holds(
    side: int, offset: Interval, aligned: Interval, edge: Edge, setup: Setup
) -> tuple[Obligation, ...]:
    """Both tips on the edge stick, and no motion but the translation is possible.

    A second motion would keep both tips on the edge (excluded by the friction margin of the pair:
    the normal forces of both motions have the same sum) or lift one off; the latter is a motion of
    one contact, which is proved to stick and to turn the part towards the lifted tip.
    """
    u = setup.uncertainty
    apart = setup.spacing / cos(u.misalignment)
    other = offset - Interval.point(float(side)) * apart
    upper = offset if side > 0 else other
    box = {
        "beta": u.misalignment,
        "mu": u.friction,
        "d1": edge.depth,
        "d2": upper,
        "d4": setup.spacing,
    }
    second = SIDES[-side]
    return (
        on_edge(second, other, edge),
        require(about(ObligationId.PAIR_STICKS), Inequality.PAIR_FRICTION, box),
        require(about(ObligationId.PAIR_PUSHES), Inequality.PAIR_FORCES, box),
        *sticks(second, aligned, other, -side, edge, setup),
    )


def _arrives(
    side: int,
    start: Interval,
    aligned: Interval,
    offset: Interval,
    travel: Interval,
    edge: Edge,
    setup: Setup,
) -> Obligation:
    """The probe travels far enough for the second tip to touch."""
    ratio = setup.uncertainty.film_ratio
    path = start.hull(aligned)
    if sticking.travel_monotone(path, side, edge.depth, offset, ratio):
        longest = sticking.longest_travel(start, aligned, side, edge.depth, offset, ratio)
    else:
        longest = math.inf
    margin = travel - Interval.point(longest) if longest < math.inf else Interval(-math.inf, 0.0)
    return require_order(
        about(ObligationId.SECOND_TIP_TOUCHES),
        Inequality.TRAVEL_TO_SPARE,
        margin,
        {"travel": travel, "theta": path, "d2": offset},
    )
