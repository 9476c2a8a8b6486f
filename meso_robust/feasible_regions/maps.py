"""Where a primitive may push, and from which start: its admissible set, the inverse of a certificate.

Every map keeps one move (or Y-translation) of the certified plan and frees its two most telling
choices; all else stays as planned, and the whole box of uncertainties is covered. Coordinates are
those of the move's own axes. Walls are not considered.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Literal, get_args

from meso_robust import units
from meso_robust.bounds import HALF_PI, Interval, Verdict
from meso_robust.errors import NotApplicableError
from meso_robust.feasible_regions.cells import Corner, at_height, corners, extreme, same_run, span
from meso_robust.feasible_regions.impossible import (
    POINTS_TO_THE_END,
    straighten_fails,
    tilt_end,
    tilt_fails,
)
from meso_robust.feasible_regions.paving import (
    Axis,
    Judge,
    Paving,
    Region,
    pave,
    pave_line,
    paving_of,
)
from meso_robust.feasible_regions.turning import Turning, turning_regions
from meso_robust.motion import sticking
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.outline import Edge
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.straighten import is_proved
from meso_robust.primitives.tilt import certify_tilt

Primitive = Literal["tilt", "straighten", "y_translation", "rotation"]
PRIMITIVES: tuple[Primitive, ...] = get_args(Primitive)

LEAN = 15.0  # deg to either side of upright that the maps of one push show
WINDOW = 80.0  # um to either side of the plan that the map of a Y-translation shows
HALF = Interval.point(0.5)


@dataclass(frozen=True, slots=True, kw_only=True)
class Map:
    """A paving, and where the plan is on it."""

    primitive: Primitive
    paving: Paving
    plan: tuple[Interval, Interval]
    """What the plan does: a range of each choice, m or rad."""
    step: int
    """Number of the move in the plan, from 1."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Move:
    """One move of the plan in its own axes."""

    rule: MoveRule
    pre: PoseBox
    setup: Setup

    @property
    def edge(self) -> Edge:
        """The edge that is pushed."""
        return self.setup.edge(self.pre.theta.mid)


def own(step: Step, setup: Setup) -> _Move:
    """A certified step in its own axes."""
    frame = step.rule.frame
    return _Move(rule=step.rule, pre=frame.from_world(step.pre), setup=frame.setup(setup))


def _verdict(fails: bool, proved: Callable[[], bool]) -> Region:
    """What a cell is; a push that fails is seen to in a tenth of the time that its proof takes in vain."""
    if fails:
        return Region.IMPOSSIBLE
    return Region.CERTIFIED if proved() else Region.UNDECIDED


def _proved(step: Step) -> bool:
    return step.verdict is Verdict.PROVED


def _clear(move: _Move, poses: PoseBox) -> Interval:
    """X of the pair at which its tips are free of contact for all heights and ``poses``, m."""
    edge, u = move.edge, move.setup.uncertainty
    half = Interval.point(edge.half.hi)
    rises = (half + move.setup.spacing).hull(-(half + move.setup.spacing))
    reach = sticking.contact_reach(edge.angle(poses.theta), edge.depth, rises)
    farthest = reach - u.sensed_position - u.probe_position + Interval.point(20 * units.UM)
    return Interval.point(max(farthest.hi, move.rule.dual.x.offset.hi))


def tilt_judge(move: _Move) -> Judge:
    """Of (height of the pushing tip over the sensed centre, true angle of the edge before)."""
    raise_ = Interval.point(float(move.rule.side)) * HALF * move.setup.spacing
    points = tuple(corners(move.setup))
    ahead = _clear(move, _leaning(move))

    def judge(height: Interval, angle: Interval) -> Region:
        rule = at_height(move.rule, height + raise_, ahead)
        pre = replace(move.pre, theta=move.edge.orientation(angle))
        fails = tilt_fails(rule, pre, points)
        return _verdict(fails, lambda: _proved(certify_tilt(rule, pre, move.setup, whole=False)))

    return judge


def straighten_judge(move: _Move) -> Judge:
    """Of (height of the pair's middle over the sensed centre, true angle of the edge before)."""
    points = tuple(corners(move.setup))[::2]  # the length of the push does not matter
    ahead = _clear(move, _leaning(move))

    def judge(height: Interval, angle: Interval) -> Region:
        rule = at_height(move.rule, height, ahead)
        pre = replace(move.pre, theta=move.edge.orientation(angle))
        fails = straighten_fails(rule, [(pre, at) for at in points])
        return _verdict(fails, lambda: is_proved(rule, pre, move.setup))

    return judge


def y_translation_judge(tilt: _Move, straight: _Move) -> Judge:
    """Of (height of the tip that tilts, height of the middle that straightens).

    The second push is made longer than planned, so that its length is never what is missing.
    """
    raise_ = Interval.point(float(tilt.rule.side)) * HALF * tilt.setup.spacing
    points = tuple(corners(tilt.setup))
    first, second = _clear(tilt, _leaning(tilt)), _clear(straight, _leaning(straight))
    end = straight.rule.dual_end
    ample = replace(straight.rule, dual_end=span(end, end.offset - straight.edge.depth))
    leans = [extreme(tilt.pre.theta, upper) for upper in (False, True)]

    def rule_of(height: Interval) -> MoveRule:
        return at_height(tilt.rule, height + raise_, first)

    tilted = cache(lambda height: certify_tilt(rule_of(height), tilt.pre, tilt.setup, whole=False))

    @cache
    def broken(height: Interval) -> bool:
        starts = [replace(tilt.pre, theta=lean) for lean in leans]
        return any(tilt_fails(rule_of(height), pre, points) for pre in starts)

    @cache
    def after(height: Interval) -> tuple[tuple[PoseBox, Corner], ...]:
        """Poses that the tilt can leave, each with one of what the next move may meet there."""
        found = []
        for at in points[::POINTS_TO_THE_END]:
            for lean in leans:
                turned = tilt_end(rule_of(height), replace(tilt.pre, theta=lean), at)
                if turned is not None:
                    pose = replace(tilt.pre, theta=tilt.edge.orientation(turned))
                    found += [(pose, next_) for next_ in points[::2] if same_run(at, next_)]
        return tuple(found)

    def judge(height: Interval, middle: Interval) -> Region:
        rule = at_height(ample, middle, second)

        def proved() -> bool:
            step = tilted(height)
            if not _proved(step) or step.post is None:
                return False
            return is_proved(rule, step.post, straight.setup)

        fails = broken(height) or straighten_fails(rule, after(height))
        return _verdict(fails, proved)

    return judge


def _leaning(move: _Move) -> PoseBox:
    """The poses of a map whose second axis is the angle."""
    lean = units.radians(LEAN)
    around = HALF_PI + lean.hull(-lean)
    return replace(move.pre, theta=move.edge.orientation(around))


def _offsets(move: _Move, name: str) -> Axis:
    half = move.edge.half.hi
    return Axis(name=name, unit="um", low=-half, high=half)


def _around(plan: Interval, name: str) -> Axis:
    reach = WINDOW * units.UM
    return Axis(name=name, unit="um", low=plan.mid - reach, high=plan.mid + reach)


def _angles() -> Axis:
    lean = units.radians(LEAN).hi
    name = "orientation of the pushed edge at the start"
    return Axis(name=name, unit="deg", low=HALF_PI.lo - lean, high=HALF_PI.hi + lean)


def map_of(primitive: Primitive, moves: list[_Move], number: int, count: int = 128) -> Map:
    """The map of one primitive of a plan.

    Parameters
    ----------
    primitive
        Which.
    moves
        Its moves: two for a Y-translation, else one.
    number
        Of the first of them in the plan.
    count
        The finest cells are 1/count of either side.

    Returns
    -------
    Map
        Cells in which the primitive is certified, impossible, or neither; and where the plan lies.
    """
    move = moves[0]
    at = move.rule.dual.y.offset
    angle = move.edge.angle(move.pre.theta)
    tip = at - Interval.point(float(move.rule.side)) * HALF * move.setup.spacing
    if primitive == "tilt":
        sides = _offsets(move, "height of the pushing tip over the centre"), _angles()
        judge, plan = tilt_judge(move), (tip, angle)
    elif primitive == "straighten":
        sides = _offsets(move, "height of the pair's middle over the centre"), _angles()
        judge, plan = straighten_judge(move), (at, angle)
    elif primitive == "y_translation":
        then = moves[1].rule.dual.y.offset
        sides = (
            _around(tip, "tilt: height of the pushing tip over the centre"),
            _around(then, "straightening: height of the pair's middle"),
        )
        judge, plan = y_translation_judge(*moves), (tip, then)
    else:
        paving, plan = _rotation(move, count)
        return Map(primitive=primitive, paving=paving, plan=plan, step=number)
    paving = pave(judge, *sides, count=count)
    return Map(primitive=primitive, paving=paving, plan=plan, step=number)


def _rotation(move: _Move, count: int) -> tuple[Paving, tuple[Interval, Interval]]:
    width, single = 2.0 * move.setup.half_width.mid, move.rule.single
    if single is None:
        raise ValueError(f"a rotation needs a passive tip, got {move.rule}")
    apart = "distance of the two tips across the push"
    end = "end of the push: active minus passive tip in x"
    plan = (
        move.rule.dual.y.offset - HALF * move.setup.spacing - single.y.offset,
        move.rule.dual_end.offset - single.x.offset,
    )
    across = Axis(name=apart, unit="um", low=width, high=1.25 * width)
    up = Axis(name=end, unit="um", low=-width, high=1.15 * width)
    turning = Turning(
        rule=move.rule,
        pre=move.pre,
        setup=move.setup,
        across=across.edges(count),
        up=up.edges(count),
    )
    regions, tried = turning_regions(turning)
    return paving_of(regions, across, up, tried), plan


def moves_of(
    steps: tuple[Step, ...], setup: Setup, primitive: Primitive
) -> tuple[list[_Move], int]:
    """The moves of a certified plan that make up a primitive.

    Parameters
    ----------
    steps, setup
        The plan's certified steps, and its task.
    primitive
        Which; of several the first one, of straightening pushes the last.

    Returns
    -------
    tuple
        The moves, and the number of the first of them, from 1.

    Raises
    ------
    NotApplicableError
        The plan has none.
    """
    actions = [step.rule.action for step in steps]
    wanted: tuple[str, ...] = {
        "tilt": ("tilt",),
        "straighten": ("straighten",),
        "y_translation": ("tilt", "straighten"),
        "rotation": ("rotate",),
    }[primitive]
    last_first = range(len(actions) - 1, -1, -1)
    order = last_first if primitive == "straighten" else range(len(actions))
    for k in order:
        if tuple(actions[k : k + len(wanted)]) == wanted:
            return [own(step, setup) for step in steps[k : k + len(wanted)]], k + 1
    raise NotApplicableError(
        f"the plan has no {primitive.replace('_', ' ')}: its moves are {', '.join(actions)}; ask for "
        "the map of one of them"
    )


def admissible_offsets(
    step: Step, setup: Setup, pre: PoseBox, *, resolution: float = 1e-7
) -> list[tuple[Interval, Region]]:
    """Where a tilt or a t^2 push may touch when the part can be anywhere in ``pre``.

    Parameters
    ----------
    step
        The move as planned; all of it but the height of the push and the poses is kept.
    setup
        The task.
    pre
        All true poses before the move, world frame.
    resolution
        Length of the pieces that may stay undecided, m.

    Returns
    -------
    list[tuple[Interval, Region]]
        Pieces of the edge from end to end, m: heights of the pushing tip (tilt) or of the pair's
        middle (t^2) over the sensed centre, in the move's own axes. Heights of a CERTIFIED piece
        work from every pose; a piece is IMPOSSIBLE if each of its heights fails from some pose.

    Raises
    ------
    NotApplicableError
        The move is neither a tilt nor a t^2 push.
    """
    if step.rule.action not in ("tilt", "straighten"):
        raise NotApplicableError(
            f"offsets are for a tilt or a t^2 push, not for {step.rule.action}; give one of those"
        )
    move = own(replace(step, pre=pre), setup)
    make = tilt_judge if step.rule.action == "tilt" else straighten_judge
    judge = make(move)
    angle = move.edge.angle(move.pre.theta)

    def at_all_poses(height: Interval) -> Region:
        if judge(height, angle) is Region.CERTIFIED:
            return Region.CERTIFIED
        ends = (extreme(angle, False), extreme(angle, True))
        if any(judge(height, end) is Region.IMPOSSIBLE for end in ends):
            return Region.IMPOSSIBLE
        return Region.UNDECIDED

    half = move.edge.half.hi
    return pave_line(at_all_poses, -half, half, resolution)
