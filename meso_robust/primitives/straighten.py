"""Straighten (t^2): one-point sticking until both tips touch, then translation with the probe.

Paper, Section IX-E and Fig. 12. Whichever tip touches first turns the edge until both touch; from
then on the part travels with the probe.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import replace

from meso_robust.bounds import HALF_PI, Interval, Verdict
from meso_robust.bounds.implicit import Ends, bound
from meso_robust.bounds.interval import arcsin, cos
from meso_robust.motion import one_tip
from meso_robust.primitives.base import (
    Wanted,
    base_box,
    free_at_start,
    holds,
    pose_of,
    positive,
)
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.names import (
    SIDES,
    TURNS,
    Inequality,
    ObligationId,
    Property,
    Which,
    about,
)
from meso_robust.primitives.obligation import Knot, Step
from meso_robust.primitives.outline import Edge
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.tilt import Turn
from meso_robust.primitives.tube import turn_tube


def certify_straighten(
    rule: MoveRule, pre: PoseBox, setup: Setup, tilt: Turn | None = None, *, whole: bool = True
) -> Step:
    """Certify a t^2 motion from every pose in ``pre``.

    Parameters
    ----------
    rule, pre, setup
        The move, all poses before it, the task; all in the move's axes.
    tilt
        The tilt that came just before, if any: y before the straightening hangs together with the
        angle then, which is used if it is the same edge that is pushed.
    whole
        False: nothing but the verdict and the box of poses after a proved move is wanted.

    Returns
    -------
    Step
        In the move's axes; without a ``post`` where a tip is not proved to hold.
    """
    edge = setup.edge(pre.theta.mid)
    tilt = tilt if tilt is not None and tilt.edge == edge else None
    box, aligned = base_box(rule, pre, setup, edge), _aligned(setup)
    zero = one_tip.zeros(box)
    obligations = [*free_at_start((1, -1), box, edge)]
    alike = len(obligations)
    posts: list[PoseBox | None] = []
    knots = [Knot(stage="at rest", box=pre)]
    for side, theta in _first_contacts(pre.theta, edge.orientation(aligned) - box["kappa"]):
        of, part = one_tip.straighten(side, zero), {**box, "theta": theta}
        ends = bound(
            of,
            part,
            aligned.mid,
            both=one_tip.POSE,
            lower=[name for name in of.outputs if name not in (*one_tip.POSE, *_EITHER)],
            spare=_EITHER,
            proofs_only=not whole,
        )
        lighter = ends is not None and any(not ends.lower[name] > 0.0 for name in _STICKS)
        wanted = _wanted(side, edge, lighter)[0 if len(obligations) == alike else 1 :]
        # that one of two inequalities fails, of which either is enough, refutes nothing
        guess = aligned.mid if whole else None
        proofs = [
            positive(one, of, part, ends, None if one[2][0] in _EITHER else guess) for one in wanted
        ]
        obligations += proofs
        if ends is None or any(one.proof.verdict is not Verdict.PROVED for one in proofs):
            posts.append(None)
            continue
        post = pose_of(ends)
        if tilt is not None:
            post = replace(post, y=_nearer(post.y, _height(side, part, tilt, aligned.mid)))
        passage = _passage(side, part, ends, post) if whole else []
        posts.append(post if passage or not whole else None)
        knots += passage
    return Step(
        rule=rule,
        claim=about(Property.STRAIGHTENS),
        pre=pre,
        post=functools.reduce(_hull, posts),
        obligations=tuple(obligations),
        tube=tuple(knots),
    )


def _hull(one: PoseBox | None, other: PoseBox | None) -> PoseBox | None:
    return None if one is None or other is None else one.hull(other)


def _aligned(setup: Setup) -> Interval:
    """All directions of the edge at which both tips touch."""
    u = setup.uncertainty
    if u.tip_radius.lo == u.tip_radius.hi:
        return HALF_PI + u.misalignment
    apart = setup.spacing / cos(u.misalignment)
    return HALF_PI + u.misalignment + arcsin((u.tip_radius - u.tip_radius) / apart)


def _first_contacts(theta: Interval, aligned: Interval) -> list[tuple[int, Interval]]:
    """Which tip can touch first (+1: upper, turning counter-clockwise), and from which orientations."""
    cases = []
    if theta.lo < aligned.hi:
        cases.append((1, Interval(theta.lo, min(theta.hi, aligned.hi))))
    if theta.hi > aligned.lo:
        cases.append((-1, Interval(max(theta.lo, aligned.lo), theta.hi)))
    return cases or [(1, theta)]


_STICKS = tuple(f"second_{name}" for name in one_tip.MARGINS)
_EITHER = (*_STICKS, "second_turns_any_way")
"""Of the second tip alone it is enough that it would stick and turn the part back, or that it would
turn it back however it slips."""


def _wanted(side: int, edge: Edge, lighter: bool) -> list[Wanted]:
    """What must hold if the upper tip (``side`` = 1) or the lower one (-1) touches first.

    Two tips on one edge stick, and no other motion is possible: one along the edge is excluded by
    `PAIR_FRICTION`; one of a single contact turns the part towards the tip that it would leave. Of the
    second tip that is proved for a contact that sticks, or (``lighter``) for any.
    """
    on_edge, *sticks = holds(SIDES[-side], -side, "second", edge)
    if lighter:
        turns = about(ObligationId.TIP_TURNS_PART, tip=SIDES[-side], turn=TURNS[-side])
        sticks = [(turns, Inequality.TURNS_ANY_WAY, ["second_turns_any_way"])]
    pair = (
        (ObligationId.PAIR_STICKS, Inequality.PAIR_FRICTION, "pair_sticks"),
        (ObligationId.PAIR_PUSHES, Inequality.PAIR_FORCES, "pair_pushes"),
    )
    outputs = one_tip.straighten(side).outputs
    return [
        # the same for either tip
        (about(ObligationId.WITHDRAWS_FREE, tips=Which.PAIR), Inequality.FACES_BACK, ["withdraws"]),
        *holds(SIDES[side], side, "first", edge),
        on_edge,
        *(
            (about(id_), inequality, [name for name in outputs if name.startswith(start)])
            for id_, inequality, start in pair
        ),
        *sticks,
        (about(ObligationId.SECOND_TIP_TOUCHES), Inequality.TRAVEL_TO_SPARE, ["spare"]),
    ]


def _height(side: int, box: Mapping[str, Interval], tilt: Turn, guess: float) -> Interval | None:
    """Height after the straightening, put together with the tilt before it."""
    before = {f"tilt_{name}": tilt.box[name] for name in (*one_tip.BEFORE, *one_tip.BEFORE_AIM)}
    both = {**box, **before}
    of = one_tip.straighten_height(side, tilt.side, one_tip.zeros(both))
    ends = bound(of, both, guess, both=("y",))
    return None if ends is None else Interval(ends.lower["y"], ends.upper["y"])


def _nearer(one: Interval, other: Interval | None) -> Interval:
    """What lies in both of two enclosures."""
    return one if other is None else Interval(max(one.lo, other.lo), min(one.hi, other.hi))


def _passage(side: int, box: Mapping[str, Interval], ends: Ends, post: PoseBox) -> list[Knot]:
    of = one_tip.straighten_tube(side, one_tip.zeros(box))
    *turning, met = turn_tube(of, box, ends.end.mid) or (None,)
    if met is None:
        return []
    # the pair's way is straight but for what it strays, which the end of the turn has room for
    together = replace(post, x=post.x.hull(met.box.x), y=post.y.hull(met.box.y))
    return [*turning, Knot(stage="both tips push", box=together)]
