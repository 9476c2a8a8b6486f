"""Choosing a two-sided rotation: separation of the tips, length of the push, height of the pair.

A larger separation is further from the jam but leaves a larger tilt; a longer push leaves a smaller
one until a tip runs off its edge. The height of the pair decides where the part ends in y once the
tilt is straightened, so it is chosen last, such that this is the goal.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol, TypeVar

from meso_robust import units
from meso_robust.bounds import Interval, Verdict
from meso_robust.planning.clearance import fine, passive_behind_um, rise_of, start_ahead_um
from meso_robust.planning.effort import spend
from meso_robust.planning.x_translation import to_goal, upright
from meso_robust.primitives.approach import MOST_STAGES, STAGE
from meso_robust.primitives.frame import HEADINGS, Frame, Heading
from meso_robust.primitives.move import MoveRule, Point, from_part, in_world
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.rotation import certify_rotation, reach
from meso_robust.primitives.setup import PoseBox, Setup

SEPARATION_STEPS_UM = (2.0, 10.0, 20.0, 40.0)  # beyond the smallest separation without jam
SCOUT = 2.0  # how much coarser than the certificate the scouting tube is
FINE_SCOUT = 1.0  # the same where what is left of the tilt decides whether a push can follow
LONGEST = 0.6  # widths of the part by which the active tip may pass the passive one
SHORTER_UM = 15.0  # from one push that is tried to the next
SHARES = (0.5, 0.3, 0.7)  # of where both tips are on their edges: heights of the pair to begin with
HEIGHTS = (-0.05, -0.025, 0.0, 0.025)  # of half the length: the pair over the part, where it may be
CLOSER_UM = (
    6.0,
    3.0,
    0.0,
)  # than the estimate of the smallest separation, which is on the safe side
EASED_UM = (24.0, 12.0)  # by how much shorter than the longest a push is that will do
CLOSE_ENOUGH_UM = 3.0  # of the goal in y
MOST_TRIALS = 6  # ends of the push; effort of the search, no proof rests on it


@dataclass(frozen=True, slots=True, kw_only=True)
class _Choice:
    """A two-sided rotation by its three free numbers, um."""

    separation: float
    h_end: float
    middle: float


class Ended(Protocol):
    """What follows a rotation."""

    @property
    def post(self) -> PoseBox | None:
        """All poses at its end, in the axes of the rotation."""


E = TypeVar("E", bound=Ended)
Finish = Callable[[PoseBox], E | None]
"""From all poses after a rotation to the goal, if there is a robust way."""


def rotate_and_insert(pre: PoseBox, setup: Setup) -> tuple[Step, Step] | None:
    """The robust rotation and the push to the goal after it.

    Parameters
    ----------
    pre, setup
        All poses before the rotation, and the task, in its axes.

    Returns
    -------
    tuple or None
        Both moves, certified; None if none is found.
    """
    own = (Frame().heading,)
    return rotate_and_finish(pre, setup, lambda state: to_goal(state, setup), headings=own)


def rotate_and_finish(
    pre: PoseBox,
    setup: Setup,
    finish: Finish[E],
    close_um: float = CLOSE_ENOUGH_UM,
    *,
    headings: Sequence[Heading] = HEADINGS,
    slipping: bool = False,
) -> tuple[Step, E] | None:
    """The robust rotation after which ``finish`` leads to the goal, and what that is.

    Parameters
    ----------
    pre, setup
        All poses before the rotation, and the task, in its axes.
    finish
        What follows the rotation.
    close_um
        How close to the goal in y the middle of what is left must be, for a part of full size.
    headings
        Of the pushes that ``finish`` knows, in the axes of the rotation.
    slipping
        Whether the first tip may slip in them.
    """
    for extra in SEPARATION_STEPS_UM:
        spend()
        separation = _least_separation_um(pre, setup) + fine(setup) * extra
        # a larger separation leaves a larger tilt, so what fails now would fail with it too
        if not _straightens(_at_best(separation, pre, setup), setup, headings, slipping=slipping):
            return None
        turned = _turn(separation, pre, setup)
        if turned is not None:
            reached = _finish(*turned, pre, setup, finish, fine(setup) * close_um)
            return _eased(reached, setup, finish) if reached and setup.may_slip else reached
    return None


def turn(pre: PoseBox, setup: Setup) -> Step | None:
    """A robust rotation, whatever may follow it.

    Parameters
    ----------
    pre, setup
        All poses before it, and the task, in its axes.

    Returns
    -------
    Step or None
        Certified; None if none is found.
    """
    least, unit = _least_separation_um(pre, setup), fine(setup)
    found = (_turn(least + unit * extra, pre, setup) for extra in SEPARATION_STEPS_UM)
    return next((one[0] for one in found if one is not None), None)


def beside_um(pre: PoseBox, setup: Setup) -> tuple[float, float]:
    """Over what length two opposite edges lie beside each other, and how much a rotation needs of it, um.

    Parameters
    ----------
    pre, setup
        All poses before the rotation, and the task, in its axes.

    Returns
    -------
    tuple[float, float]
        The latter at best: soon after the start, when both tips touch, with tips that just cannot jam.
    """
    edge = setup.edge(pre.theta.mid)
    over = units.to_um(edge.last.mid + setup.opposite(edge)[0].last.mid)
    apart, width = _least_separation_um(pre, setup), _width(pre, setup)
    soon, late = edge.angle(pre.theta).lo, edge.angle(pre.theta).hi + float(STAGE * MOST_STAGES)
    best = math.acos(max(-width / apart, -1.0))  # where it is least
    angle = min(max(best, soon), late)
    return over, (apart + width * math.cos(angle)) / math.sin(angle)


def _straightens(
    state: PoseBox, setup: Setup, headings: Sequence[Heading], *, slipping: bool
) -> bool:
    """Whether a push in one of these headings straightens the part, wherever it is."""
    frames = (Frame(heading=heading) for heading in headings)
    pushes = (
        upright(
            frame.from_world(state),
            frame.setup(setup),
            step=3,
            primitive="x_translation",
            slipping=slipping,
        )
        for frame in frames
    )
    return any(push is not None for push in pushes)


def _at_best(separation: float, pre: PoseBox, setup: Setup) -> PoseBox:
    """Poses after the longest push of a part that slid well: a push after it must straighten these.

    A guess; the orientations are those that the errors of the separation and of the width leave.
    """
    u, edge = setup.uncertainty, setup.edge(pre.theta.mid)
    far, _ = setup.opposite(edge)
    off = 2.0 * units.to_um(u.probe_position.hi)
    tilts = []
    for side in (-1.0, 1.0):
        radii = u.tip_radius + u.passive_tip_radius
        wide = edge.depth + far.depth + radii
        width = units.to_um(wide.hi if side < 0.0 else wide.lo)
        h = _longest(separation, width, pre, setup)
        sine, cosine = _direction(h, separation + side * off, width)
        tilts.append(math.atan2(sine, cosine))
    x, y = (
        Interval(middle - units.UM, middle + units.UM) for middle in (pre.x.mid, setup.goal.y.mid)
    )
    angle = Interval(min(tilts), max(tilts))
    return PoseBox(x=x, y=y, theta=edge.orientation(angle))


def _longest(separation: float, width: float, pre: PoseBox, setup: Setup) -> float:
    """How far the active tip may pass the passive one (negative), um: no farther than the goal's turn asks."""
    edge = setup.edge(pre.theta.mid)
    angle = edge.angle(setup.goal.theta).mid
    sine, cosine = math.sin(angle), math.cos(angle)
    turned = (separation * cosine + width) / sine if sine > 0.0 else -math.inf
    return max(-LONGEST * width, turned)


def _half(pre: PoseBox, setup: Setup) -> float:
    """Half the length of the pushed edge as stated, m."""
    edge = setup.outline.edge(pre.theta.mid)
    return 0.5 * (edge.last.hi - edge.first.lo)


def _least_separation_um(pre: PoseBox, setup: Setup) -> float:
    """Nominal separation above which no admissible one can jam, um."""
    u, edge = setup.uncertainty, setup.edge(pre.theta.mid)
    far, lean = setup.opposite(edge)
    wide = edge.depth.hi + far.depth.hi
    root = math.sqrt(1.0 + u.friction.hi**2)
    radii = u.tip_radius.hi + u.passive_tip_radius.hi
    least = wide * root + radii / root
    # the grip is shorter by what the edges are out of parallel, over their length
    apart = u.squareness.width + max(-lean.lo, lean.hi)
    least += 2.0 * apart * _half(pre, setup)
    # the direction of the travel turns the distance along it into the separation
    turned = u.travel_direction.width * 0.5 * wide
    unit, errors = fine(setup), u.probe_position.width + u.probe_wander.width + turned
    return unit * math.ceil(units.to_um(least + errors) / unit)


def _turn(separation: float, pre: PoseBox, setup: Setup) -> tuple[Step, _Choice] | None:
    """The robust rotation with the longest push at this separation, if any."""
    choice = _scout(separation, pre, setup)
    if choice is None and setup.may_slip:  # a later push sets the height
        choice = _farthest(separation, pre, setup)
    for _ in range(MOST_TRIALS):
        if choice is None:
            return None
        spend()
        turned = certify_rotation(_rule(choice, pre, setup), pre, setup, rough=True)
        if turned.verdict is Verdict.PROVED:
            return turned, choice
        choice = replace(choice, h_end=choice.h_end + fine(setup) * SHORTER_UM)
    return None


def _finish(
    turned: Step, choice: _Choice, pre: PoseBox, setup: Setup, finish: Finish[E], close_um: float
) -> tuple[Step, E] | None:
    """Add what leads to the goal, and shift the pair until the part ends at the goal's height.

    If it cannot be shifted that far, an end elsewhere in the goal will do.
    """
    reached: tuple[Step, E] | None = None
    for _ in range(MOST_TRIALS):
        if turned.verdict is not Verdict.PROVED or turned.post is None:
            # as long as it could be where the pair was; there it was not tried yet
            choice = replace(choice, h_end=choice.h_end + fine(setup) * SHORTER_UM)
        else:
            finished = finish(turned.post)
            if finished is None or finished.post is None:
                break
            off = units.to_um(finished.post.y.mid - setup.goal.y.mid)
            if finished.post.within(setup.goal):
                reached = turned, finished
                if abs(off) < close_um:
                    break
            choice = replace(choice, middle=choice.middle - off)
        spend()
        turned = certify_rotation(_rule(choice, pre, setup), pre, setup, rough=True)
    return reached


def _eased(reached: tuple[Step, E], setup: Setup, finish: Finish[E]) -> tuple[Step, E]:
    """The same with a shorter push, if that will do: a tip that slides has more of its edge left then."""
    longest, pre = reached[0].rule, reached[0].pre
    for shorter in EASED_UM:
        end = from_part(longest.dual_end.offset_um + fine(setup) * shorter)
        turned = certify_rotation(replace(longest, dual_end=end), pre, setup, rough=True)
        if turned.verdict is Verdict.PROVED and turned.post is not None:
            finished = finish(turned.post)
            if (
                finished is not None
                and finished.post is not None
                and finished.post.within(setup.goal)
            ):
                return turned, finished
    return reached


def _scout(separation: float, pre: PoseBox, setup: Setup) -> _Choice | None:
    """Where the longest push ends and which height of the pair leads to the goal (coarse)."""
    found = (_led(one, pre, setup) for one in _guesses(separation, pre, setup))
    return next((one for one in found if one is not None), None)


def _guesses(separation: float, pre: PoseBox, setup: Setup) -> Iterator[_Choice]:
    """Pairs from which it is looked for the one that leads to the goal."""
    h_end = _longest(separation, _width(pre, setup), pre, setup)
    if not setup.edge(pre.theta.mid).beyond:
        middle = units.to_um(setup.goal.y.mid) + 0.1 * units.to_um(_half(pre, setup))
        yield _Choice(separation=separation, h_end=h_end, middle=middle)
        return
    low, high = _middles(separation, pre, setup)
    for share in SHARES:
        middle = units.to_um(pre.y.mid) + low + share * (high - low)
        yield _Choice(separation=separation, h_end=h_end, middle=middle)


def _middles(separation: float, pre: PoseBox, setup: Setup) -> tuple[float, float]:
    """The least and greatest height of the pair's middle with both tips on their edges upright, um."""
    edge = setup.edge(pre.theta.mid)
    far, _ = setup.opposite(edge)
    low = max(
        units.to_um(edge.first.mid) - 0.5 * separation, 0.5 * separation - units.to_um(far.last.mid)
    )
    high = min(
        units.to_um(edge.last.mid) - 0.5 * separation, 0.5 * separation - units.to_um(far.first.mid)
    )
    return low, high


def _width(pre: PoseBox, setup: Setup) -> float:
    """Distance of the tips' centres across the edges, um."""
    u, edge = setup.uncertainty, setup.edge(pre.theta.mid)
    depths = (edge.depth, setup.opposite(edge)[0].depth, u.passive_tip_radius, u.tip_radius)
    return sum(units.to_um(one.mid) for one in depths)


def _led(choice: _Choice, pre: PoseBox, setup: Setup) -> _Choice | None:
    """The same pair at the height that leads to the goal."""
    u, goal, separation = setup.uncertainty, setup.goal, choice.separation
    edge, width = setup.edge(pre.theta.mid), _width(pre, setup)
    out = units.to_um(setup.opposite(edge)[0].depth.mid) + units.to_um(u.passive_tip_radius.mid)
    # about the first contact of the push that straightens it the part goes across it by its lever
    lever = units.to_um(setup.outline.edge(goal.theta.mid).depth.mid)
    for _ in range(2):
        ends = reach(_rule(choice, pre, setup), pre, setup, SCOUT)
        if ends is None:
            return None
        h_end = units.to_um(ends.h)
        # the part's centre lies its length along the edge and its depth off it from the passive tip
        sine, cosine = _direction(h_end, separation, width)
        left = edge.angle(goal.theta).mid - math.atan2(sine, cosine)
        ahead = units.to_um(ends.slide) * sine - out * cosine
        end_y = (
            choice.middle
            - 0.5 * separation
            + ahead
            + width * 0.5 * (1.0 - math.cos(left))
            - lever * math.sin(left)
        )
        middle = choice.middle + units.to_um(goal.y.mid) - end_y
        found = replace(choice, h_end=h_end, middle=middle)
        choice = replace(choice, middle=middle)
    return found


def _farthest(separation: float, pre: PoseBox, setup: Setup) -> _Choice | None:
    """The pair with which the push can be longest, the closest one, wherever the part ends."""
    edge, half = setup.outline.edge(pre.theta.mid), units.to_um(_half(pre, setup))
    wide = units.to_um(edge.depth.mid) + units.to_um(setup.opposite(edge)[0].depth.mid)
    over = 0.5 * sum(_middles(separation, pre, setup))
    for closer in CLOSER_UM:
        found: list[_Choice] = []
        for share in HEIGHTS:
            spend()
            tried = _Choice(
                separation=separation - fine(setup) * closer,
                h_end=_longest(separation, wide, pre, setup),
                # the passive tip comes closer, the active one stays
                middle=units.to_um(pre.y.mid) + over + share * half + 0.5 * fine(setup) * closer,
            )
            ends = reach(_rule(tried, pre, setup), pre, setup, FINE_SCOUT)
            if ends is not None:
                found.append(replace(tried, h_end=units.to_um(ends.h)))
        if found:
            return min(found, key=lambda one: one.h_end)
    return None


def _direction(h: float, separation: float, width: float) -> tuple[float, float]:
    """Sine and cosine of the direction of the edges."""
    apart, reach = math.sqrt(h * h + separation**2 - width * width), h * h + separation**2
    return (width * h + apart * separation) / reach, (h * apart - width * separation) / reach


def _rule(choice: _Choice, pre: PoseBox, setup: Setup) -> MoveRule:
    spacing = units.to_um(setup.spacing.mid)
    u = setup.uncertainty
    active_y = in_world(choice.middle + 0.5 * (choice.separation + spacing))
    passive_y = in_world(choice.middle - 0.5 * choice.separation)
    dual_around = active_y.ahead_of(pre.y, u.sensed_position, u.probe_position)
    single_around = passive_y.ahead_of(pre.y, u.sensed_position, u.probe_position)
    rises = tuple((side, rise_of(dual_around, side, setup)) for side in (1, -1))
    passive_x = -passive_behind_um(single_around, pre, setup)
    return MoveRule(
        step=2,
        primitive="rotation",
        action="rotate",
        side=1,
        dual=Point(x=from_part(start_ahead_um(rises, pre, setup)), y=active_y),
        dual_end=from_part(passive_x + choice.h_end),
        single=Point(x=from_part(passive_x), y=passive_y),
    )
