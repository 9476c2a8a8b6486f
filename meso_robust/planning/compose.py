"""Steps 1 to 4 of Section IX-E, composed from certified primitives."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from enum import Enum
from fractions import Fraction
from functools import cache, partial

from meso_robust.bounds import HALF_PI, Verdict
from meso_robust.errors import NotApplicableError
from meso_robust.planning.arrival import Arrival, across, arrive
from meso_robust.planning.effort import EffortSpentError, each, limited
from meso_robust.planning.guided import guided
from meso_robust.planning.last_push import leaves_goal, narrowed_first
from meso_robust.planning.remedy import Remedy
from meso_robust.planning.rotation import (
    CLOSE_ENOUGH_UM,
    E,
    Finish,
    beside_um,
    rotate_and_finish,
)
from meso_robust.planning.stated import widened
from meso_robust.planning.unplanned import Stuck, settling, where
from meso_robust.planning.x_translation import to_goal, upright
from meso_robust.planning.y_translation import y_translation
from meso_robust.primitives.certify import certify_move
from meso_robust.primitives.frame import HEADINGS, Frame, Heading
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.names import Inequality, Named, about
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.rotation import opposite
from meso_robust.primitives.setup import PoseBox, Setup, setup_of
from meso_robust.task import Task
from meso_robust.wording import up

SHARES = (1.0, 0.8, 0.6, 0.4, 0.2)  # of the wanted gain: a smaller one costs less room in x
SMALL_FIRST = SHARES[::-1]  # where the gain is not what leads to the goal
LARGEST_GAIN = 11e-6  # m, of one Y-translation (Table III)
SMALLEST_GAIN = 2e-6  # m; effort of the search, no proof rests on it
LEAST_SHARES = (0.05, 0.06, 0.08, 0.1)  # of the wanted gain: where room in x is scarce
PER_SHARE = 10e-6  # m; a small share may be of a gain smaller than that
MOST_Y_TRANSLATIONS = 2  # each needs room in x that the start must have
IN_HAND = (1.2, 1.1, 1.0)  # a plan that bears more than the task's uncertainties is preferred
AT_ONCE_S = 6.0  # s of computing: what is preferred and not found by then waits until there is a plan at all
NOTHING_S = (
    2.5  # s of computing: whether there is a plan for the least uncertainties, asked meanwhile
)
STUCK_S = 3.0  # s of computing: what no plan gets past
ROOM = 1.01  # on top, where boxes of a certificate leave room for another enclosure and little is to spare
NARROWED = 0.1  # one uncertainty alone, to find the one that stands in the way
REDUCED = (0.5, 0.25, 0.1, 0.03)  # all of them
ALONE = (1.0, 0.3, 0.1)  # of one uncertainty, the others as the last of these
FINELY = 5  # hundredths: how closely it is told up to which factor a plan is proved
SETTLING = 1.0 / 3.0  # of a limited search: to find out what would settle a task without a plan
COMING_BACK_UM = 10.0  # of the goal in y is close enough after several pushes
_HALF_TURN = (
    "make it two tasks of a quarter turn each, the second from the goal of the first: its long edges "
    "then face probes on the other axis ([probe] headings)"
)
LEAST_TURN, MOST_TURN = 45.0, 135.0  # deg; of a polygon between two tips
UPRIGHT = math.radians(1.5)  # an edge closer than this to upright needs no straightening


_NARROWER = (Remedy.NARROW_ONE, Remedy.NARROW_ALL)
_LONGER = (Remedy.SEARCH_LONGER_OR_NARROW, Remedy.SEARCH_LONGER)


class Walls(Enum):
    """What the walls of a slot may be to a plan; the first is preferred."""

    CLEAR = "clear"
    """Touched by nothing."""
    GUIDE = "guide"
    """Touched by the part, which they guide, at the end."""
    OPEN = "open"
    """Left aside: the plan shows what they are in the way of."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """A plan, and under which uncertainties it was found to be robust."""

    rules: tuple[MoveRule, ...]
    scale: float
    """Factor on the uncertainties; at least 1 means that the plan holds for the task."""
    only: str | None = None
    """The one uncertainty that was scaled, None for all."""
    range: str | None = None
    """What that leaves of it, in the words of the task's file."""

    remedy: Remedy = Remedy.LEAVE_SLOT
    """What to do if the plan is robust where it was searched and still not certified."""
    searched_s: float | None = None
    """Computing time after which the search for one that holds for the task gave up; None if it did not."""
    force_n: float | None = None
    """Bound of all contact forces, N, where that is all that a cap does not allow."""

    @property
    def settled_by(self) -> Named:
        """What a user can do if the plan is not certified for the task."""
        if self.force_n is not None:
            return about(self.remedy, force_un=up(Fraction(self.force_n) * 10**6, 1))
        if self.scale >= 1.0:
            return about(self.remedy)
        known = {"scale": str(self.scale)}
        if self.only is not None:
            known |= {"uncertainty": self.only, "range": self.range or ""}
        if self.searched_s is not None:
            known["seconds"] = f"{self.searched_s:g}"
            return about(_LONGER[self.only is None], **known)
        return about(_NARROWER[self.only is None], **known)


def compose(task: Task, search_s: float | None = None) -> Found:
    """Find a plan for a task.

    Parameters
    ----------
    task
        What is wanted.
    search_s
        Computing time after which the search gives up, s, about, to say in a third of that what would
        settle the task; None: as long as it takes.

    Returns
    -------
    Found
        A plan for the task's uncertainties; if there is none, one for smaller ones, to be certified as
        far as it goes and to say what would settle the rest.

    Raises
    ------
    NotApplicableError
        No primitive can handle the start pose, or no plan was found however small the uncertainties.
    """
    if task.probe.max_force_un is None:
        return _composed(task, search_s, asked=search_s is not None)
    found, refused = None, NotApplicableError("")
    try:
        found = _composed(task, search_s, asked=False)
    except NotApplicableError as error:
        refused = error
    if found is not None and found.scale >= 1.0:
        return found
    settling = None if search_s is None else SETTLING * search_s
    probe = task.probe.model_copy(update={"max_force_un": None})
    with suppress(NotApplicableError):
        free = _composed(task.model_copy(update={"probe": probe}), settling, asked=False)
        force = _largest_force(free.rules, setup_of(task)) if free.scale >= 1.0 else None
        if force is not None:
            return replace(free, remedy=Remedy.RAISE_CAP, force_n=force)
    if found is None:
        asked = search_s is not None
        raise _no_plan(task, asked=asked) if isinstance(refused, _NoPlanError) else refused
    return found


def _composed(task: Task, search_s: float | None, *, asked: bool) -> Found:
    """As `compose`; a cap on the forces is asked of every move, as all else is."""
    ways, choices = _ways(task), _choices(task)
    last = cache(partial(_rules, task, ways, choices[-1], REDUCED[-1]))
    settling = None if search_s is None else SETTLING * search_s
    ended = None
    try:
        with limited(search_s):
            found = _for_task(task, ways, choices, last, asked=asked)
    except EffortSpentError:
        found, ended = None, search_s
    if found is not None:
        return found
    closest: Found | None = None
    within = ended
    try:
        with limited(settling):
            for closest in _narrowed(task, ways, choices[-1], last):
                if closest.scale > REDUCED[-1]:
                    break
    except EffortSpentError:
        within = search_s
    if closest is not None:
        return replace(closest, searched_s=ended)
    if within is not None:
        raise NotApplicableError(
            f"no robust plan was found within {within:g} s of computing, nor one with all uncertainties scaled by "
            f"{REDUCED[-1]}: look longer (--search-s), or start further from the goal, or widen the goal"
        )
    raise _no_plan(task, asked=asked)


class _NoPlanError(NotApplicableError):
    """None was found, though primitives can handle the start."""


def _no_plan(task: Task, *, asked: bool) -> _NoPlanError:
    """Of a task for which none is found however small its uncertainties; ``asked``: whether a person waits for it."""
    found = f"no robust plan was found, even with all uncertainties scaled by {REDUCED[-1]}"
    ways, choices = _ways(task), _choices(task)
    setup, headings = setup_of(task, REDUCED[-1]), _last_headings(ways, choices[-1])
    stated = task.probe.headings
    sides = ", or state probes on more sides ([probe] headings)" if stated and len(stated) < len(HEADINGS) else ""  # fmt: skip
    advice = f"start further from the goal, or widen the goal{sides}"
    if not asked:
        return _NoPlanError(f"{found}: {advice}")
    try:
        with limited(STUCK_S):
            turning = [way.frame for way in ways if way.turns]
            stuck = (
                Stuck.ARRIVING if leaves_goal(setup, headings) else where(setup, turning, headings)
            )
    except EffortSpentError:
        return _NoPlanError(f"{found}: {advice}")
    return _NoPlanError(f"{found}: {stuck.value}; {settling(task, stuck, _bearable)}")


def _bearable(task: Task) -> bool:
    """Whether a plan is found for the least uncertainties that are tried."""
    try:
        return _rules(task, _ways(task), _choices(task)[-1], REDUCED[-1]) is not None
    except NotApplicableError:
        return False


_LastResort = Callable[[], tuple[MoveRule, ...] | None]
"""The plan for the least uncertainties, None if none is found; looked for once."""


def _for_task(
    task: Task,
    ways: Sequence[_Way],
    choices: Sequence[Sequence[Heading]],
    last: _LastResort,
    *,
    asked: bool,
) -> Found | None:
    """The first plan that bears the task's uncertainties."""
    hopeless = cache(partial(_none_at_all, task, last, asked=asked))
    # with a slot, one that is robust in the open shows what the walls are in the way of
    for walls in (Walls.CLEAR,) if task.slot is None else Walls:
        for choice, headings in enumerate(choices):
            rules_at = partial(_rules, task, ways, headings, walls=walls, alone=choice == 0)
            found = _with_most_in_hand(task, rules_at, hopeless)
            if found is not None:
                return found
    return None


def _narrowed(
    task: Task, ways: Sequence[_Way], headings: Sequence[Heading], last_resort: _LastResort
) -> Iterator[Found]:
    """Plans for smaller uncertainties: first the last resort, if there is one, then any that is closer.

    An uncertainty that the last resort does not bear alone is suspected to stand in the way of others.
    """
    last = last_resort()
    if last is None:
        return
    yield Found(rules=last, scale=REDUCED[-1])
    named = narrowed_first(task, NARROWED, _last_headings(ways, headings))
    suspected = _suspected(task, last, named)
    attempts: list[tuple[float, str | None]] = [
        *((NARROWED, name) for name in suspected),
        *((scale, None) for scale in REDUCED[:-1]),
        *((NARROWED, name) for name in named if name not in suspected),
    ]
    for scale, only in attempts:
        rules = _rules(task, ways, headings, scale, only)
        if rules is not None:
            most = _borne(task, rules, scale, only)
            range_ = None if only is None else widened(task, only, most)
            yield Found(rules=rules, scale=most, only=only, range=range_)


def _suspected(task: Task, rules: Sequence[MoveRule], names: Sequence[str]) -> list[str]:
    """Uncertainties that a plan for smaller ones does not bear alone, the one that it bears least of first."""
    borne = dict.fromkeys(names, 0.0)
    left = list(names)
    for share in ALONE:
        setups = (setup_of(task, REDUCED[-1], apart={name: share}) for name in left)
        proved = each(partial(_proved, rules), map(_in_the_open, setups))
        left = [name for name, fine in zip(left, proved, strict=True) if not fine]
        borne |= dict.fromkeys(left, -share)
    return sorted((name for name in names if borne[name] < 0.0), key=lambda name: -borne[name])


def _borne(task: Task, rules: Sequence[MoveRule], scale: float, only: str | None) -> float:
    """The largest factor at which a plan that is proved at ``scale`` is seen to be, in hundredths."""
    good, bad = round(100 * scale), 100
    while bad - good > FINELY:
        trial = (good + bad) // 2
        if _proved(rules, _in_the_open(setup_of(task, trial / 100, only))):
            good = trial
        else:
            bad = trial
    return good / 100


def robust_at(task: Task, scale: float) -> tuple[MoveRule, ...] | None:
    """Find a plan that is robust when all uncertainties are scaled.

    Parameters
    ----------
    task, scale
        What is wanted, and the factor on its uncertainties.

    Returns
    -------
    tuple or None
        Its moves; None if none is found.

    Raises
    ------
    NotApplicableError
        No primitive can handle the start pose.
    """
    ways = _ways(task)
    found = (_rules(task, ways, headings, scale, walls=Walls.CLEAR) for headings in _choices(task))
    return next((rules for rules in found if rules is not None), None)


def _with_most_in_hand(
    task: Task,
    rules_at: Callable[[float], tuple[MoveRule, ...] | None],
    hopeless: Callable[[], None],
) -> Found | None:
    """The plan that bears the most; where none bears the task's uncertainties none bears more."""
    room = ROOM if setup_of(task).may_slip else 1.0
    most, more, least = (scale * room if scale > 1.0 else scale for scale in IN_HAND)
    try:
        with limited(AT_ONCE_S):
            rules = rules_at(most)
        further = [more]
    except EffortSpentError:
        rules, further = None, [more, most]  # the likelier one first
    if rules is not None:
        return Found(rules=rules, scale=most)
    hopeless()
    rules = rules_at(least)
    if rules is None:
        return None
    found = Found(rules=rules, scale=least)
    with suppress(EffortSpentError):
        for scale in further:
            better = rules_at(scale)
            if better is None:
                break
            found = Found(rules=better, scale=scale)
    return found


def _none_at_all(task: Task, last: _LastResort, *, asked: bool) -> None:
    """Refuse a task for which it is soon seen that no plan is found however small the uncertainties."""
    try:
        with limited(NOTHING_S):
            if last() is not None:
                return
    except EffortSpentError:
        return
    raise _no_plan(task, asked=asked)


def _choices(task: Task) -> list[Sequence[Heading]]:
    """Headings that the moves of a plan may have, one choice after the other; none: all the same one.

    If the task states none, one probe is taken where one is enough, and else as many as it needs: a
    task is never harder because nothing was said.
    """
    stated = task.probe.headings
    return [(), HEADINGS] if stated is None else [stated]


def _rules(
    task: Task,
    ways: Sequence[_Way],
    headings: Sequence[Heading],
    scale: float,
    only: str | None = None,
    *,
    walls: Walls | None = None,
    alone: bool = True,
) -> tuple[MoveRule, ...] | None:
    """The first plan that is proved with all its ways; without ``walls`` in the open."""
    setup = setup_of(task, scale, only)
    if leaves_goal(setup, _last_headings(ways, headings)):
        return None
    if walls in (None, Walls.OPEN):
        # proposed without a slot, or pushes that a wall is in the way of were left out
        setup = _in_the_open(setup)
    guide = walls is Walls.GUIDE
    for rules in _proposed(task, setup, ways, headings, guide=guide, alone=alone):
        if _proved(rules, setup):
            return rules
        cut = guided(rules, setup) if guide else None
        if cut is not None:
            return cut
    return None


def _in_the_open(setup: Setup) -> Setup:
    """Without a slot."""
    return replace(setup, blocks=())


def _last_headings(ways: Sequence[_Way], headings: Sequence[Heading]) -> Sequence[Heading]:
    """Those that a plan can end with."""
    return headings or tuple(dict.fromkeys(way.frame.heading for way in ways))


def _proposed(
    task: Task,
    setup: Setup,
    ways: Sequence[_Way],
    headings: Sequence[Heading],
    *,
    guide: bool,
    alone: bool,
) -> Iterator[tuple[MoveRule, ...]]:
    """Plans of which every move is proved to end where it should, in the open."""
    if len(headings) > 1:
        yield from _in_any(task, setup, ways, headings, guide=guide)
    for way in _forward(ways) if alone else ():
        steps = _compose(task, way.frame.setup(setup), way.turns)
        if steps is not None:
            yield _placed(steps, way.frame)


def _in_any(
    task: Task, setup: Setup, ways: Sequence[_Way], headings: Sequence[Heading], *, guide: bool
) -> Iterator[tuple[MoveRule, ...]]:
    """Plans of moves with headings of their own, the shortest first."""
    if ways[0].turns == 0:
        straight = arrive(setup.start, setup, headings, guide=guide)
        yield from () if straight is None else (straight.rules,)
        return
    for first, state in _starts(setup, headings):
        here = replace(setup, start=state)
        turned = partial(_turned, task, here, headings=headings, guide=guide)
        found = [(*first, *rules) for rules in each(turned, (way.frame for way in ways)) if rules]
        yield from sorted(found, key=len)
        if found:
            return


def _starts(
    setup: Setup, headings: Sequence[Heading]
) -> Iterator[tuple[tuple[MoveRule, ...], PoseBox]]:
    """Where a rotation can start: where the part is, or after a push that brings it in line."""
    yield (), setup.start
    pushes = (across(setup.start, setup, Frame(heading=heading)) for heading in headings)
    yield from ((push.rules, push.post) for push in pushes if push is not None)


def _turned(
    task: Task, setup: Setup, frame: Frame, headings: Sequence[Heading], *, guide: bool
) -> tuple[MoveRule, ...] | None:
    """Steps 1 and 2 in one frame, and pushes to the goal in any headings."""

    def finish(own: PoseBox) -> Arrival | None:
        state = frame.box_to_world(own)
        found = arrive(state, setup, headings, mirrored=frame.mirrored, guide=guide)
        return None if found is None else replace(found, post=frame.from_world(found.post))

    plan = _turn(frame.setup(setup), finish, (task.plan.least_y_translations,), COMING_BACK_UM)
    return None if plan is None else (*_placed(plan[0], frame), *plan[1].rules)


def _placed(steps: Sequence[Step], frame: Frame) -> tuple[MoveRule, ...]:
    return tuple(replace(step.rule, frame=frame) for step in steps)


def _proved(rules: Sequence[MoveRule], setup: Setup) -> bool:
    """Whether a plan is proved to the goal, with the ways between the poses, which searches leave out, and the slot."""
    state: PoseBox | None = setup.start
    step: Step | None = None
    for rule in rules:
        if state is None:
            return False
        step = certify_move(rule, state, setup, step)
        if step.verdict is not Verdict.PROVED:
            return False
        state = step.post
    return state is not None and state.within(setup.goal)


def _largest_force(rules: Sequence[MoveRule], setup: Setup) -> float | None:
    """Bound of all contact forces of a plan, N; None if more than the cap is in its way, or no force is bounded."""
    state: PoseBox | None = setup.start
    step: Step | None = None
    most = 0.0
    for rule in rules:
        if state is None:
            return None
        step = certify_move(rule, state, setup, step)
        for one in step.obligations:
            if one.inequality is Inequality.FORCE:
                most = max(most, one.proof.box["force"].hi)
            elif one.proof.verdict is not Verdict.PROVED:
                return None
        state = step.post
    ends = state is not None and state.within(setup.goal)
    return most if ends and most < math.inf else None


@dataclass(frozen=True, slots=True, kw_only=True)
class _Way:
    """Axes that a plan can be composed in, and the quarter turns that it must make there."""

    frame: Frame
    turns: int
    ahead: float
    """How far the goal lies ahead of the start, m."""


def _ways(task: Task) -> list[_Way]:
    """The headings in which the part can be turned or pushed, the longest way to the goal first.

    Raises
    ------
    NotApplicableError
        There is none; the reason is that of the first heading.
    """
    setup = setup_of(task)
    found, refused = [], []
    for heading, mirrored in itertools.product(task.probe.headings or HEADINGS, (False, True)):
        frame = Frame(heading=heading, mirrored=mirrored)
        there = frame.setup(setup)
        try:
            turns = _quarter_turns(there)
        except NotApplicableError as error:
            refused.append(error)
            continue
        ahead = there.start.x.mid - there.goal.x.mid
        if turns != 0 or not mirrored:  # a mirrored push without a turn is the same push
            found.append(_Way(frame=frame, turns=turns, ahead=ahead))
    if not found:
        raise refused[0]
    return sorted(found, key=lambda way: -way.ahead)


def _forward(ways: Sequence[_Way]) -> Sequence[_Way]:
    """Those that lead towards the goal, if there is one."""
    return [way for way in ways if way.ahead > 0.0] or ways


def _quarter_turns(setup: Setup) -> int:
    """How many counter-clockwise quarter turns lead to the goal.

    Raises
    ------
    NotApplicableError
        The turn is not one that a primitive makes, or the start is too far from upright.
    """
    start, goal = setup.start.theta.mid, setup.goal.theta.mid
    if setup.edge(start).beyond:
        return _turns_of_polygon(setup)
    turns = round((goal - start) / HALF_PI.mid)
    degrees = math.degrees(goal - start)
    if turns not in (0, 1):
        raise NotApplicableError(
            f"the goal is {degrees:.1f} deg from the start, and a rotation turns the part by one "
            f"quarter; {_HALF_TURN if abs(turns) == 2 else 'give a start within a quarter turn'}"
        )
    if turns == 1 and setup.edge(start).name != "long":
        raise NotApplicableError(
            "the rotation primitive pushes on the long edge, but the short one faces the probe"
        )
    _check_facing(start, setup)
    _check_flat(setup)
    return turns


def _turns_of_polygon(setup: Setup) -> int:
    """Of a polygon: none to the same edge, one to another one about a quarter turn away.

    Raises
    ------
    NotApplicableError
        The turn is not one that a rotation makes, or an edge is too far from upright.
    """
    start, goal = setup.start.theta.mid, setup.goal.theta.mid
    _check_facing(start, setup)
    edge = setup.edge(start)
    if edge == setup.edge(goal):
        _check_flat(setup)
        return 0
    if not math.radians(LEAST_TURN) < goal - start < math.radians(MOST_TURN):
        raise NotApplicableError(
            f"the goal is {math.degrees(goal - start):.1f} deg from the start, and another edge "
            f"faces the probe there; a rotation turns a part by {LEAST_TURN:g} to {MOST_TURN:g} deg: "
            "give a goal within that, or with the same edge facing the probe"
        )
    if not opposite(setup.opposite(edge)[1], setup):
        raise NotApplicableError(
            f"the goal is {math.degrees(goal - start):.1f} deg from the start, and a rotation, which "
            "turns a part that far, needs an edge about parallel to the pushed one on the other side of the "
            "part: start with one of two such edges facing the probe"
        )
    over, least = beside_um(setup.start, setup)
    if over < least:
        raise NotApplicableError(
            f"the goal is {math.degrees(goal - start):.1f} deg from the start, and the edges that a "
            f"rotation would hold lie opposite each other over {over:.0f} um only: tips that cannot jam "
            f"are {least:.0f} um apart along them at its start; give a part with longer edges, or start "
            "and goal with the same edge facing the probe"
        )
    _check_facing(goal, setup)
    return 1


def _check_facing(theta: float, setup: Setup) -> None:
    """Refuse an orientation at which no edge faces the probe."""
    off = theta - setup.edge(theta).turn.mid - HALF_PI.mid
    if abs(off) > math.radians(20.0):
        raise NotApplicableError(
            f"the part stands {math.degrees(off):.1f} deg from upright to the probe, and no "
            "primitive is certified beyond 20 deg; start with an edge facing the probe"
        )


def _check_flat(setup: Setup) -> None:
    """Refuse a goal in which no edge lies flat on the tips, as it does after every plan."""
    goal, tips = setup.goal.theta, setup.uncertainty.misalignment
    off = goal.mid - setup.edge(goal.mid).turn.mid - HALF_PI.mid
    reach = 0.5 * (goal.hi - goal.lo)
    if abs(off) > reach + max(-tips.lo, tips.hi):
        raise NotApplicableError(
            f"the goal stands {math.degrees(off):.1f} deg from upright to the probe, with a tolerance of "
            f"{math.degrees(reach):.1f} deg, and every plan ends with an edge flat on both tips: give a goal in which "
            "an edge faces a heading ([probe] headings), or a wider tolerance"
        )


def _compose(task: Task, setup: Setup, turns: int) -> list[Step] | None:
    if turns == 0:
        return _insert(setup.start, setup)
    least = task.plan.least_y_translations
    counts = range(least, max(least, MOST_Y_TRANSLATIONS) + 1)
    plan = _turn(setup, lambda state: to_goal(state, setup), counts, onward=True)
    return None if plan is None else [*plan[0], plan[1]]


def _turn(
    setup: Setup,
    finish: Finish[E],
    counts: Iterable[int],
    close_um: float = CLOSE_ENOUGH_UM,
    *,
    onward: bool = False,
) -> tuple[list[Step], E] | None:
    """Steps 1 and 2, with one of these counts of Y-translations, and what leads to the goal then.

    With ``onward`` no push that follows comes back.
    """
    tried = set()
    # an edge on two unequal tips leans, so that to straighten it takes a long way after any tilt
    shares = (*LEAST_SHARES, *SMALL_FIRST) if setup.may_slip else SMALL_FIRST
    for count in counts:
        for share in shares if count else (0.0,):
            first = _step_1(setup, count, share)
            if first is None:
                continue
            pre = _post(first[-1]) if first else setup.start
            if pre in tried or (onward and not _is_ahead(pre, setup)):
                continue
            tried.add(pre)
            found = rotate_and_finish(
                pre,
                setup,
                finish,
                close_um,
                headings=(Frame().heading,) if onward else HEADINGS,
                slipping=not onward and setup.may_slip,
            )
            if found is not None:
                return [*first, found[0]], found[1]
    return None


def _step_1(setup: Setup, count: int, share: float) -> list[Step] | None:
    """Y-translations before the rotation, each by ``share`` of what is missing.

    The paper asks for y within half the goal's tolerance here. That is not needed, because the
    height of the pair of tips in the rotation decides where the part ends; each Y-translation only
    moves the start of the rotation closer to that height, and costs room in x.
    """
    steps: list[Step] = []
    state = setup.start
    for _ in range(count):
        moved = _closer(state, setup, share, step=1)
        if moved is None:
            return None
        steps += moved
        state = _post(moved[-1])
    return steps


def _is_ahead(state: PoseBox, setup: Setup) -> bool:
    """Whether the part has still to be pushed to reach the goal's x."""
    return state.x.lo > setup.goal.x.mid


def _insert(start: PoseBox, setup: Setup) -> list[Step] | None:
    """Step 3, if necessary, and Step 4."""
    for share in SHARES:
        steps: list[Step] = []
        state = start
        for _ in range(MOST_Y_TRANSLATIONS + 2):
            last = to_goal(state, setup)
            if last is not None and _post(last).within(setup.goal):
                return [*steps, last]
            moved = _step_3(state, setup, share)
            if moved is None:
                break
            steps += moved
            state = _post(moved[-1])
            if not _is_ahead(state, setup):
                break
    return None


def _step_3(state: PoseBox, setup: Setup, share: float) -> list[Step] | None:
    """Straighten a leaning part, or move an upright one closer to the goal's y."""
    edge = setup.edge(state.theta.mid)
    if abs(edge.angle(state.theta).mid - HALF_PI.mid) <= UPRIGHT:
        return _closer(state, setup, share, step=3)
    straight = upright(state, setup, step=3, primitive="x_translation")
    return None if straight is None else [straight]


def _closer(state: PoseBox, setup: Setup, share: float, step: int) -> list[Step] | None:
    """One Y-translation towards the goal's y."""
    away = setup.goal.y.mid - state.y.mid
    smallest = min(SMALLEST_GAIN, share * PER_SHARE)
    gain = math.copysign(max(share * min(abs(away), LARGEST_GAIN), smallest), away)
    found = y_translation(state, setup, gain, step)
    return None if found is None else list(found)


def _post(step: Step) -> PoseBox:
    if step.post is None or step.verdict is not Verdict.PROVED:
        raise ValueError(f"step {step.rule} was taken into a plan without being proved")
    return step.post
