"""Straighten (t^2): one-point sticking until both tips touch, then translation with the probe.

Paper, Section IX-E and Fig. 12. Whichever tip touches first turns the edge until both touch; from
then on the part travels with the probe. Where the first tip is not proved to stick it may slip as long
as it turns the part back in any case: how far it has slipped is a parameter then, and adds to where
the part ends.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from meso_robust.bounds import Interval, Proof, Verdict, enclose, prove_positive
from meso_robust.bounds.implicit import Ends, Implicit, Signs, bound, refuted_along
from meso_robust.bounds.prove import fails_somewhere
from meso_robust.motion import one_tip
from meso_robust.primitives import tips
from meso_robust.primitives.base import (
    Wanted,
    base_box,
    free_at_start,
    holds,
    pose_of,
    positive,
    stated,
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
from meso_robust.primitives.obligation import Knot, Leaves, Obligation, Step
from meso_robust.primitives.outline import Edge
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.tilt import Turn
from meso_robust.primitives.tube import turn_tube
from meso_robust.types import Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pushed(Leaves):
    """What a straightening leaves behind for one across it that follows."""

    cases: tuple[tuple[int, Mapping[str, Interval]], ...]
    """Which tip may have touched first, and the base parameters then."""
    guess: float

    def ahead(self, lever: Interval) -> Interval | None:
        """Range of x less ``lever`` (m per rad, a number) times the orientation, m; None: it is not bounded."""
        found: Interval | None = None
        for side, box in self.cases:
            there = {**box, one_tip.LEVER: lever}
            of = one_tip.left_ahead(side, one_tip.zeros(there))
            ends = bound(of, there, self.guess, both=(one_tip.ACROSS,))
            if ends is None:
                return None
            one = Interval(ends.lower[one_tip.ACROSS], ends.upper[one_tip.ACROSS])
            found = one if found is None else found.hull(one)
        return found


@dataclass(frozen=True, slots=True, kw_only=True)
class Across(Leaves):
    """What is known of y before a straightening, in its own axes, after one across it."""

    lever: Interval
    """A number, m per rad."""
    range: Interval
    """Of y less ``lever`` times the orientation, m."""


def certify_straighten(
    rule: MoveRule,
    pre: PoseBox,
    setup: Setup,
    before: Leaves | None = None,
    *,
    whole: bool = True,
    slipping: bool = True,
) -> Step:
    """Certify a t^2 motion from every pose in ``pre``.

    Parameters
    ----------
    rule, pre, setup
        The move, all poses before it, the task; all in the move's axes.
    before
        How y before the straightening hangs on the orientation after the move just before it, if that
        is known; of a tilt it is used if it pushed the same edge.
    whole
        False: nothing but the verdict and the box of poses after a proved move is wanted.
    slipping
        Where the first tip is not proved to stick, try whether the part is turned back however it slips.

    Returns
    -------
    Step
        In the move's axes; without a ``post`` where a tip is not proved to hold.
    """
    edge = setup.edge(pre.theta.mid)
    box, aligned = base_box(rule, pre, setup, edge), tips.aligned(setup)
    obligations = [*free_at_start((1, -1), box, edge)]
    alike = len(obligations)
    posts: list[PoseBox | None] = []
    left: list[tuple[int, Mapping[str, Interval]]] = []
    knots = [Knot(stage="at rest", box=pre)]
    for side, theta in _first_contacts(pre.theta, edge.orientation(aligned) - box["kappa"]):
        there = {**box, "theta": theta}
        case = _case(side, there, edge, aligned, both=one_tip.POSE, whole=whole)
        if slipping and setup.may_slip and not case.proved:
            case = _slipping(side, there, edge, aligned, both=one_tip.POSE, whole=whole) or case
        obligations += case.obligations[0 if len(obligations) == alike else 1 :]
        part, ends = case.box, case.ends
        if ends is None or not case.proved:
            posts.append(None)
            continue
        post = pose_of(ends)
        post = replace(post, y=_nearer(post.y, _height(side, part, edge, before, aligned.mid)))
        left.append((side, part))
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
        leaves=Pushed(cases=tuple(left), guess=aligned.mid) if len(left) == len(posts) else None,
    )


def is_proved(rule: MoveRule, pre: PoseBox, setup: Setup) -> bool:
    """Whether `certify_straighten` proves a t^2 motion, without the box of poses after it.

    Parameters
    ----------
    rule, pre, setup
        As of `certify_straighten`.

    Returns
    -------
    bool
        True only if all is proved. It bounds less than `certify_straighten`, for maps, which ask often.
    """
    edge = setup.edge(pre.theta.mid)
    box, aligned = base_box(rule, pre, setup, edge), tips.aligned(setup)
    if any(one.proof.verdict is not Verdict.PROVED for one in free_at_start((1, -1), box, edge)):
        return False
    for side, theta in _first_contacts(pre.theta, edge.orientation(aligned) - box["kappa"]):
        there = {**box, "theta": theta}
        case = _case(side, there, edge, aligned, whole=False)
        if setup.may_slip and not case.proved:
            case = _slipping(side, there, edge, aligned, whole=False) or case
        if case.ends is None or not case.proved:
            return False
    return True


def _hull(one: PoseBox | None, other: PoseBox | None) -> PoseBox | None:
    return None if one is None or other is None else one.hull(other)


def _first_contacts(theta: Interval, aligned: Interval) -> list[tuple[int, Interval]]:
    """Which tip can touch first (+1: upper, turning counter-clockwise), and from which orientations."""
    cases = []
    if theta.lo < aligned.hi:
        cases.append((1, Interval(theta.lo, min(theta.hi, aligned.hi))))
    if theta.hi > aligned.lo:
        cases.append((-1, Interval(max(theta.lo, aligned.lo), theta.hi)))
    return cases or [(1, theta)]


SMALLEST, LARGER, MOST_TRIALS, CLOSE = 0.5, 1.25, 20, 1.07
"""Bounds of the creep that are tried: depths of the edge, growing by a factor, and how closely the least
is looked for. Effort only."""
FOR_OTHERS, SLIP_BOXES = 1.05, 512
"""By which the least one found is enlarged, and how many boxes its proof may take: a checker whose enclosures
differ, and which cuts a few hundred boxes, must stay below it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Slip:
    """That the first contact slips little."""

    box: Mapping[str, Interval]
    """The base parameters, those of the slip among them."""
    bounded: Obligation
    spare: float
    """Travel left when both tips touch, m."""


def _slip(side: int, box: Mapping[str, Interval], edge: Edge, aligned: Interval) -> _Slip | None:
    """A bound of how far the first contact slips, about the least that is proved."""
    there = _creeping(box, _turn(side, box, aligned), LARGER)  # of any size, for what is zero
    zero = one_tip.zeros(there)
    names = [name for name in one_tip.creeping(side, zero).inputs if name != one_tip.CREEP_MOST]
    known = tuple((name, there[name]) for name in names)
    found = _least_creep(side, zero, known, edge.depth.hi)
    if found is None:
        return None
    most, bounded = found
    there = _creeping(box, there[one_tip.TURNED], most)
    return _Slip(
        box=there,
        spare=_spare(side, there, aligned),
        bounded=Obligation(
            name=about(ObligationId.SLIP_BOUNDED, tip=SIDES[side]),
            inequality=Inequality.CREEPS_LESS,
            proof=replace(bounded, box=stated(bounded.box)),
        ),
    )


def _creeping(box: Mapping[str, Interval], turned: Interval, most: float) -> dict[str, Interval]:
    """The base parameters with those of a slip up to ``most``, m."""
    return {
        **box,
        one_tip.CREEP: Interval(0.0, most),
        one_tip.CREEP_MOST: Interval.point(most),
        one_tip.TURNED: turned,
    }


@functools.lru_cache(maxsize=4096)  # pushes that differ in how far they go slip alike
def _least_creep(
    side: int, zero: frozenset[str], known: tuple[tuple[str, Interval], ...], depth: float
) -> tuple[float, Proof] | None:
    """About the least bound of the slip that is proved, m, a little enlarged, and its proof."""
    of = one_tip.creeping(side, zero)

    def proof(most: float) -> Proof | None:
        inputs = {**dict(known), one_tip.CREEP_MOST: Interval.point(most)}
        return None if fails_somewhere(of, inputs) else prove_positive(of, inputs, most=SLIP_BOXES)

    def proved(found: Proof | None) -> bool:
        return found is not None and found.verdict is Verdict.PROVED

    trial, ahead, less = 0, 1, SMALLEST * depth / LARGER
    while trial < MOST_TRIALS:
        most = SMALLEST * LARGER**trial * depth
        found = proof(most)
        if proved(found):
            break
        # to give up a proof takes long: of several in a row some are left out
        ahead = 1 if found is None else ahead + 1
        trial, less = trial + ahead, most
    else:
        return None
    while most > CLOSE * less:
        middle = math.sqrt(less * most)
        less, most = (less, middle) if proved(proof(middle)) else (middle, most)
    most *= FOR_OTHERS
    bounded = proof(most)
    return (most, bounded) if bounded is not None and proved(bounded) else None


PIECE, STAGE, BOXES = 0.02, 0.02, 64
"""rad of the orientation before and of the turn, and boxes, of each of which travel is bounded: effort."""


def _turn(side: int, box: Mapping[str, Interval], aligned: Interval) -> Interval:
    """From no turn at all to the longest one."""
    turn = Interval.point(float(side)) * (aligned - (box["theta"] - box["turn"] + box["kappa"]))
    return Interval(0.0, max(turn.hi, 0.0))


def _spare(side: int, box: Mapping[str, Interval], aligned: Interval) -> float:
    """A lower bound of the travel that is left when both tips touch."""
    of = one_tip.slowness(side, one_tip.zeros(box))
    least = math.inf
    for theta in _parts(box["theta"], PIECE):
        part, needed = {**box, "theta": theta}, Interval.point(0.0)
        for turned in _parts(_turn(side, part, aligned), STAGE):
            rate, left = enclose(of, {**part, one_tip.TURNED: turned}, boxes=BOXES)
            length = Interval.point(turned.hi) - Interval.point(turned.lo)
            needed = needed + length * Interval.point(rate.hi)
        least = min(least, (left - needed).lo)
    return least


def _parts(side: Interval, length: float) -> list[Interval]:
    """A range in parts of about this length, which together hold it."""
    count = max(1, round((side.hi - side.lo) / length))
    cuts = [side.lo + (side.hi - side.lo) * k / count for k in range(count)]
    return [Interval(*ends) for ends in itertools.pairwise((*cuts, side.hi))]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Case:
    """What was proved if one tip touches first."""

    box: Mapping[str, Interval]
    """The base parameters, and how far that tip may slip."""
    ends: Ends | None
    obligations: tuple[Obligation, ...]

    @property
    def proved(self) -> bool:
        """Whether all of them are."""
        return all(one.proof.verdict is Verdict.PROVED for one in self.obligations)


def _case(
    side: int,
    box: Mapping[str, Interval],
    edge: Edge,
    aligned: Interval,
    slip: _Slip | None = None,
    *,
    both: Sequence[str] = (),
    whole: bool,
) -> _Case:
    """Prove what must hold if the upper tip (``side`` = 1) or the lower one (-1) touches first.

    Of the outputs ``both`` the range is bounded beside that.
    """
    box = box if slip is None else slip.box
    of = one_tip.straighten(side, one_tip.zeros(box))
    left_out = (*_BACK["first"], *_SLIPS) if slip is None else (*_STICKS["first"], _SPARE)
    ends = bound(
        of,
        box,
        aligned.mid,
        both=both,
        lower=_needed(of, left_out),
        spare=_EITHER,
        proofs_only=not whole,
    )
    wanted = _wanted(side, edge, slips=slip is not None, second=_second(ends, slip is not None))
    if slip is not None and ends is not None:
        ends = replace(ends, lower={**ends.lower, _SPARE: slip.spare})
    # that one of two inequalities fails, of which either is enough, refutes nothing
    guess = aligned.mid if whole and slip is None else None
    proofs = [
        positive(one, of, box, ends, None if one[2][0] in _EITHER else guess) for one in wanted
    ]
    if slip is not None:
        after = next(
            k for k, one in enumerate(proofs) if one.inequality is Inequality.SLIPS_ONE_WAY
        )
        proofs.insert(after + 1, slip.bounded)
    return _Case(box=box, ends=ends, obligations=tuple(proofs))


def _slipping(
    side: int,
    box: Mapping[str, Interval],
    edge: Edge,
    aligned: Interval,
    *,
    both: Sequence[str] = (),
    whole: bool,
) -> _Case | None:
    """The same if the first tip may slip; None if it is not proved."""
    slip = _slip(side, box, edge, aligned)
    if slip is None:
        return None
    case = _case(side, slip.box, edge, aligned, slip, both=both, whole=whole)
    return case if case.proved else None


def _needed(of: Implicit, left_out: Sequence[str]) -> list[str]:
    """Outputs that must be positive; of ``_EITHER`` not all must."""
    return [name for name in of.outputs if name not in (*one_tip.POSE, *left_out, *_EITHER)]


def refuted(rule: MoveRule, pre: PoseBox, setup: Setup, across: Floats) -> Signs:
    """Whether t^2 motions whose tips stick are bound not to be proved, for pairs that start elsewhere.

    Parameters
    ----------
    rule, pre, setup
        As of `certify_straighten`.
    across
        (N,) how much farther to y each pair starts, m.

    Returns
    -------
    Signs
        (N,) In plain numbers, for searches: many at once take a small part of the time.
    """
    edge = setup.edge(pre.theta.mid)
    box, aligned = base_box(rule, pre, setup, edge), tips.aligned(setup)
    found = np.zeros(len(across), dtype=bool)
    zero = one_tip.zeros(box)
    if "probe_y" in zero:
        return found
    for side, theta in _first_contacts(pre.theta, edge.orientation(aligned) - box["kappa"]):
        of, there = one_tip.straighten(side, zero), {**box, "theta": theta}
        lower = _needed(of, (*_BACK["first"], *_SLIPS))
        found |= refuted_along(of, there, aligned.mid, lower, "probe_y", across)
    return found


_STICKS, _BACK = (
    {which: tuple(f"{which}_{name}" for name in names) for which in ("first", "second")}
    for names in (one_tip.MARGINS, one_tip.TURNS_BACK)
)
_SLIPS, _SPARE = one_tip.SLIPS_ONE_WAY, "spare"
_ANY_WAY = ("second_turns_any_way",)
_EITHER = (*_STICKS["second"], *_ANY_WAY, *_BACK["second"])
"""Of the second tip alone it is enough that it would stick and turn the part back, or that it would
turn it back however it slips."""


def _second(ends: Ends | None, slips: bool) -> Inequality | None:
    """What is proved of the second tip alone; None: that it sticks, or nothing."""
    tried: dict[Inequality | None, Sequence[str]] = {
        None: _STICKS["second"],
        Inequality.TURNS_ANY_WAY: _ANY_WAY,
    }
    if slips:
        tried[Inequality.TURNS_BACK] = _BACK["second"]
    if ends is None:
        return None
    proved = (key for key, names in tried.items() if all(ends.lower[n] > 0.0 for n in names))
    return next(proved, Inequality.TURNS_ANY_WAY)


def _wanted(
    side: int, edge: Edge, *, slips: bool = False, second: Inequality | None = None
) -> list[Wanted]:
    """What must hold if the upper tip (``side`` = 1) or the lower one (-1) touches first.

    The first tip sticks, or (``slips``) turns the part back however it slips. Two tips on one edge
    stick, and no other motion is possible: one along the edge is excluded by `PAIR_FRICTION`; one of a
    single contact turns the part towards the tip that it would leave. Of the second tip that is proved
    for a contact that sticks, or by the inequality ``second`` for any.
    """
    first_on_edge, *first_alone = holds(SIDES[side], side, "first", edge)
    second_on_edge, *second_alone = holds(SIDES[-side], -side, "second", edge)
    if slips:
        pushes = about(ObligationId.TIP_PUSHES, tip=SIDES[side])
        first_alone = [
            (pushes, Inequality.SLIPS_ONE_WAY, [*_SLIPS]),
            _turns(side, Inequality.TURNS_BACK, _BACK["first"]),
        ]
    if second is not None:
        names = _BACK["second"] if second is Inequality.TURNS_BACK else _ANY_WAY
        second_alone = [_turns(-side, second, names)]
    pair = (
        (ObligationId.PAIR_STICKS, Inequality.PAIR_FRICTION, "pair_sticks"),
        (ObligationId.PAIR_PUSHES, Inequality.PAIR_FORCES, "pair_pushes"),
    )
    outputs = one_tip.straighten(side).outputs
    return [
        # the same for either tip
        (about(ObligationId.WITHDRAWS_FREE, tips=Which.PAIR), Inequality.FACES_BACK, ["withdraws"]),
        first_on_edge,
        *first_alone,
        second_on_edge,
        *(
            (about(id_), inequality, [name for name in outputs if name.startswith(start)])
            for id_, inequality, start in pair
        ),
        *second_alone,
        (about(ObligationId.SECOND_TIP_TOUCHES), Inequality.TRAVEL_TO_SPARE, [_SPARE]),
    ]


def _turns(side: int, inequality: Inequality, outputs: Sequence[str]) -> Wanted:
    name = about(ObligationId.TIP_TURNS_PART, tip=SIDES[side], turn=TURNS[side])
    return name, inequality, [*outputs]


def _height(
    side: int,
    box: Mapping[str, Interval],
    edge: Edge,
    before: Leaves | None,
    guess: float,
) -> Interval | None:
    """Height after the straightening, put together with the move before it."""
    if isinstance(before, Across):
        both = {**box, one_tip.LEVER: before.lever, one_tip.ACROSS: before.range}
        of = one_tip.straighten_across(side, one_tip.zeros(both))
    elif isinstance(before, Turn) and before.edge == edge:
        names = (*one_tip.BEFORE, *one_tip.BEFORE_AIM)
        both = {**box, **{f"tilt_{name}": before.box[name] for name in names}}
        of = one_tip.straighten_height(side, before.side, one_tip.zeros(both))
    else:
        return None
    ends = bound(of, both, guess, both=("y",))
    return None if ends is None else Interval(ends.lower["y"], ends.upper["y"])


def _nearer(one: Interval, other: Interval | None) -> Interval:
    """What lies in both of two enclosures."""
    return one if other is None else Interval(max(one.lo, other.lo), min(one.hi, other.hi))


def _passage(side: int, box: Mapping[str, Interval], ends: Ends, post: PoseBox) -> list[Knot]:
    slips = box[one_tip.CREEP_MOST].hi > 0.0
    of = one_tip.straighten_tube(side, one_tip.zeros(box), slips=slips)
    *turning, met = turn_tube(of, box, ends.end.mid) or (None,)
    if met is None:
        return []
    # the pair's way is straight but for what it strays, which the end of the turn has room for
    together = replace(post, x=post.x.hull(met.box.x), y=post.y.hull(met.box.y))
    return [*turning, Knot(stage="both tips push", box=together)]
