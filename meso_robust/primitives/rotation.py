"""Two-sided rotation: from an upright part to a nearly horizontal one (paper, Fig. 11 left).

The lower tip of the active probe pushes the right-hand edge above the middle, the passive tip holds
the left-hand one below it. First the active tip alone pushes until the part rests on the passive
one; then both touch, the orientation is kinematic and the slide is enclosed although the motion
need not be unique (``meso_robust.motion.two_sided``).
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from meso_robust.bounds import HALF_PI, Interval, Verdict, enclose
from meso_robust.bounds.interval import arcsin, cos, sin
from meso_robust.conditions import condition
from meso_robust.motion import sticking
from meso_robust.motion.two_sided import Grip, SlideTube, TubeStatus, enclose_slide
from meso_robust.primitives.approach import MODULE, Pair, Touch, approach
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.names import (
    Inequality,
    Named,
    ObligationId,
    Property,
    When,
    Which,
    about,
)
from meso_robust.primitives.obligation import Knot, Obligation, Step, require, require_order
from meso_robust.primitives.outline import Edge
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.tips import (
    HALF,
    Tip,
    comes_free,
    free_at_start,
    in_flight,
    on_edge,
    passes,
    tip_of,
    way_back,
)

PI = HALF_PI + HALF_PI
SLICES = 24  # of the tube that is told: a slice then turns by about 4 deg, so boxes stay narrow


def certify_rotation(rule: MoveRule, pre: PoseBox, setup: Setup) -> Step:
    """Certify a counter-clockwise two-sided rotation from every pose in ``pre``.

    Parameters
    ----------
    rule, pre, setup
        The move (``side`` = 1, with a passive tip), all poses before it, the task; all in the
        move's axes.

    Returns
    -------
    Step
        In the move's axes; without a ``post`` where the motion could not be enclosed.

    Raises
    ------
    ValueError
        If the rule is not a counter-clockwise rotation with a passive tip.
    """
    if rule.single is None or rule.side != 1:
        raise ValueError(f"rotation rule needs side = 1 and a passive tip, got {rule}")
    edge, u = setup.edge(pre.theta.mid), setup.uncertainty
    if edge.beyond:
        return _step(rule, pre, None, [_undecided(ObligationId.IS_RECTANGLE)])
    start = edge.angle(pre.theta)
    active, idle = tip_of(rule, -1, pre, setup), tip_of(rule, 1, pre, setup)
    pair = _pair(rule, active, pre, setup)
    obligations = [
        *free_at_start((active, idle), start, edge),
        _passive_free(pair, start, edge),
        require(
            about(ObligationId.NO_JAM),
            Inequality.NO_JAM,
            {"V": pair.separation, "d1": edge.depth, "mu": u.friction},
        ),
    ]
    if not pair.separation.lo > 0.0:  # what the conditions are derived for; they square it
        return _step(rule, pre, None, [*obligations, _undecided(ObligationId.ACTIVE_ABOVE_PASSIVE)])
    touch = approach(pair, start, pre, edge, setup)
    if touch is None:
        return _step(rule, pre, None, [*obligations, _undecided(ObligationId.COMES_TO_REST)])
    obligations += [*touch.obligations, on_edge(Which.ACTIVE, touch.active_offset, edge)]
    (h_start,) = enclose(
        condition(MODULE, "pair_position"),
        {"theta": touch.theta, "V": pair.separation, "d1": edge.depth},
    )
    rests = require_order(
        about(ObligationId.RESTS_BEFORE_END),
        Inequality.TOUCH_BEFORE_END,
        h_start - pair.h_end,
        {"h_start": h_start, "h_end": pair.h_end},
    )
    obligations.append(rests)
    if rests.proof.verdict is not Verdict.PROVED:
        return _step(rule, pre, None, obligations)
    tube = _slide(pair, touch, h_start, edge, setup)
    obligations += _tube_obligations(tube, pair)
    if tube.status is not TubeStatus.COMPLETE:
        return _step(rule, pre, None, obligations)
    post = _pose(pair, tube, pair.h_end, edge)
    if post is None:
        return _step(rule, pre, None, [*obligations, _undecided(ObligationId.END_ENCLOSED)])
    obligations += _idle_tip_clear(start, touch, post, tube, pair, edge, setup)
    obligations.append(comes_free(Which.BOTH, edge.angle(post.theta)))
    knots = (*touch.tube, *_knots(pair, tube, edge))
    return _step(rule, pre, post, obligations, knots)


def _pair(rule: MoveRule, active: Tip, pre: PoseBox, setup: Setup) -> Pair:
    u, single = setup.uncertainty, rule.single
    if single is None:
        raise ValueError(f"rotation rule needs a passive tip, got {rule}")
    sensed, off = u.sensed_position, u.probe_position
    active_y = rule.dual.y.place(pre.y, sensed, off) - HALF * setup.spacing
    passive_y = single.y.place(pre.y, sensed, off)
    # both x are commanded from the same sensed x, so only the probes' own errors are left
    behind = HALF * setup.spacing * sin(u.misalignment) / cos(u.misalignment)
    if rule.dual_end.anchor is not single.x.anchor:
        raise ValueError("the end of the push and the passive tip need the same anchor in x")
    between = rule.dual_end.offset - single.x.offset
    return Pair(
        active=active,
        active_y=active_y,
        passive_x=single.x.place(pre.x, sensed, off),
        passive_y=passive_y,
        passive_ahead=single.x.ahead_of(pre.x, sensed, off),
        passive_rise=single.y.ahead_of(pre.y, sensed, off),
        separation=active_y - passive_y,
        middle_y=HALF * (active_y + passive_y),
        h_end=between + off - off + behind,
    )


def _passive_free(pair: Pair, start: Interval, edge: Edge) -> Obligation:
    return require(
        about(ObligationId.TIP_FREE_AT_START, tip=Which.PASSIVE),
        Inequality.CLEARANCE,
        {"theta": start, "d1": edge.depth, "dx": -pair.passive_ahead, "dy": -pair.passive_rise},
    )


def _slide(pair: Pair, touch: Touch, h_start: Interval, edge: Edge, setup: Setup) -> SlideTube:
    u = setup.uncertainty
    grip = Grip(
        separation=pair.separation,
        depth=edge.depth,
        half=edge.half,
        ratio=u.film_ratio,
        friction=u.friction,
    )
    sigma = (touch.y - pair.middle_y) / sin(touch.theta)
    return enclose_slide(grip, h_start, pair.h_end.lo, sigma)


def _tube_obligations(tube: SlideTube, pair: Pair) -> list[Obligation]:
    box = {"h": Interval(float(tube.h[-1]), float(tube.h[0])), "V": pair.separation}
    done = tube.status is TubeStatus.COMPLETE
    # how far the tube came tells two failures apart; a proved obligation has nothing to tell
    why = {} if done else {"status": tube.status.name.lower()}
    wanted = (
        (ObligationId.BOTH_TIPS_TOUCH, Inequality.PASSIVE_FORCE, tube.force_margin),
        (ObligationId.BOTH_TIPS_ON_EDGES, Inequality.ENDS_OF_EDGES, tube.edge_margin),
    )
    return [
        require_order(
            Named(id_, why),
            inequality,
            Interval(margin, math.inf) if done else Interval(-math.inf, 0.0),
            box,
        )
        for id_, inequality, margin in wanted
    ]


def _idle_tip_clear(
    start: Interval,
    touch: Touch,
    post: PoseBox,
    tube: SlideTube,
    pair: Pair,
    edge: Edge,
    setup: Setup,
) -> tuple[Obligation, ...]:
    """The upper tip passes the end of the edge at first, and is off the edge's line later.

    The turn is cut where the part is safely past upright.
    """
    first, last = float(tube.h[0]), float(tube.h[-1])
    cut = first - 0.15 * (first - last)
    (at_cut, _) = enclose(
        condition(MODULE, "orientation"),
        {"h": Interval.point(cut), "V": pair.separation, "d1": edge.depth},
    )
    turned = HALF_PI - arcsin(at_cut)  # theta only grows: its rate is sin(theta)/T
    early, late = Interval(cut, first), Interval(last, cut)
    offset = _active_offset(tube, early, pair, edge).hull(touch.active_offset)
    flight = in_flight(pair.active, sticking.contact_reach(start, edge.depth, pair.active.rise))
    upright = start.hull(touch.path).hull(touch.theta).hull(turned)
    end = edge.angle(post.theta)
    leaning = turned.hull(end)
    later = _active_offset(tube, late, pair, edge)
    at_rest = Interval.point(0.0)
    return (
        passes(start, flight, touch.active_offset, 1, edge, setup, When.BEFORE_TOUCH),
        passes(upright, at_rest, offset, 1, edge, setup, When.EARLY_IN_TURN),
        passes(leaning, at_rest, later, 1, edge, setup, When.LATE_IN_TURN),
        passes(end, way_back(pair.active), later, 1, edge, setup, When.ON_WITHDRAWAL),
    )


def _active_offset(tube: SlideTube, h: Interval, pair: Pair, edge: Edge) -> Interval:
    """Where on its edge the active tip can be while the tips are ``h`` apart in x, m."""
    (reach,) = enclose(condition(MODULE, "pair"), {"h": h, "V": pair.separation, "d1": edge.depth})
    return HALF * reach - _slide_at(tube, h)


def _pose(pair: Pair, tube: SlideTube, h: Interval, edge: Edge) -> PoseBox | None:
    """All poses while the tips are ``h`` apart in x."""
    c, s = enclose(
        condition(MODULE, "orientation"), {"h": h, "V": pair.separation, "d1": edge.depth}
    )
    # sin(theta) > 0 throughout; the inverse is taken of the coordinate that is far from +-1
    angle = PI - arcsin(s) if c.hi < -0.7 else HALF_PI - arcsin(c)
    if not angle.width < math.inf:
        return None
    sigma = _slide_at(tube, h)
    return PoseBox(
        x=pair.passive_x + HALF * h + sigma * c,
        y=pair.middle_y + sigma * s,
        theta=edge.orientation(angle),
    )


def _slide_at(tube: SlideTube, h: Interval) -> Interval:
    """The slide at any ``h`` of a range: the hull of all slices that it touches."""
    first = max(int(np.searchsorted(-tube.h, -h.hi, side="right")) - 1, 0)
    last = int(np.searchsorted(-tube.h, -h.lo, side="left"))
    used = slice(first, last + 1)
    return Interval(float(tube.lower[used].min()), float(tube.upper[used].max()))


def _knots(pair: Pair, tube: SlideTube, edge: Edge) -> tuple[Knot, ...]:
    ends = [float(end) for end in np.linspace(float(tube.h[0]), float(tube.h[-1]), SLICES + 1)]
    ends[0], ends[-1] = float(tube.h[0]), float(tube.h[-1])
    found = []
    for high, low in itertools.pairwise(ends):
        box = _pose(pair, tube, Interval(low, high), edge)
        everywhere = Interval(-math.inf, math.inf)
        found.append(
            Knot(
                stage=f"tips {1e6 * 0.5 * (low + high):.0f} um apart in x",
                box=box or PoseBox(x=everywhere, y=everywhere, theta=everywhere),
            )
        )
    return tuple(found)


def _undecided(id_: ObligationId) -> Obligation:
    return require_order(about(id_), Inequality.NONE, Interval(-math.inf, 0.0), {})


def _step(
    rule: MoveRule,
    pre: PoseBox,
    post: PoseBox | None,
    obligations: list[Obligation],
    tube: tuple[Knot, ...] = (),
) -> Step:
    return Step(
        rule=rule,
        claim=about(Property.TURNS_BETWEEN_TIPS),
        pre=pre,
        post=post,
        obligations=tuple(obligations),
        tube=(Knot(stage="at rest", box=pre), *tube),
    )
