"""Rules to build a policy of: pushes that straighten a leaning part, and two-sided rotations.

All are found once, in axes in which the push goes along -x. A push is measured from the sensed part,
so it serves wherever the part lies; a rotation stands in the world across the push, and is shifted
to where it is wanted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

from meso_robust import units
from meso_robust.bounds import Interval, Verdict
from meso_robust.planning.rotation import rotate_and_insert, turn
from meso_robust.planning.x_translation import upright
from meso_robust.primitives.move import Aim, MoveRule, from_part
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.rotation import certify_rotation
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.straighten import certify_straighten

NARROW_DEG, WIDE_DEG = (1.0, 0.5, 2.0, 3.0), (3.0, 1.5, 0.75)
"""Widths of a slice of leaning angles, the widest that can be proved: a narrow one says better where
the part goes, a wide one needs fewer cells. Wide ones come last where the way of narrow ones is long: no tip
sticks in all of a wide slice, and one that slips may turn the part sooner."""
LARGEST_LEAN_DEG = 15.0
LONG = 3.0  # over the reach of the part: a push that goes farther leaves what is looked at
OVERLAP_DEG = 0.02  # of neighbouring slices
STRIP_UM = 36.0  # width of the sensed heights that one rotation serves, neighbours overlap by 1 um
LOWEST_UM, HIGHEST_UM = -60.0, 220.0  # heights above the goal at which rotations are tried
SHORTER_UM = (15.0, 30.0, 45.0, 60.0, 80.0)  # than the longest push from the strip's middle
NARROW_LEAN = 0.0035  # rad, for that middle
FAR_UM = 4000.0  # from the goal along the push, where a rotation is tried


@dataclass(frozen=True, slots=True, kw_only=True)
class Push:
    """A push that straightens a part, for all leans of a slice."""

    lean: Interval
    """Sensed orientation minus that of the edge upright to the push, rad."""
    rule: MoveRule
    """Ends as soon as the part is straight, whatever the errors."""

    @property
    def way_um(self) -> float:
        """Travel of the pair."""
        return self.rule.dual.x.offset_um - self.rule.dual_end.offset_um


@dataclass(frozen=True, slots=True, kw_only=True)
class Turn:
    """A two-sided rotation, counter-clockwise, for all heights of a strip."""

    height: Interval
    """Sensed y of the part minus ``origin``, m."""
    origin: float
    """y that the rule's heights are measured from, m."""
    rule: MoveRule


def straight_lean(setup: Setup) -> float:
    """Largest lean that can be sensed after a straightening push, rad (with a little room)."""
    beta, error = setup.uncertainty.misalignment, setup.uncertainty.sensed_orientation
    return max(abs(beta.lo), abs(beta.hi)) + max(abs(error.lo), abs(error.hi)) + 2e-4


def pushes(setup: Setup, angle: float, widths_deg: tuple[float, ...]) -> list[Push]:
    """Pushes for leans of both signs.

    Parameters
    ----------
    setup
        The task in the push's axes.
    angle
        Orientation at which an edge stands upright to the push, rad.
    widths_deg
        Of the slices of leans, the first one that can be proved.
    """
    straight = straight_lean(setup)
    found = [_push(setup, angle, Interval(-straight, straight), slipping=setup.may_slip)]
    low = straight - units.DEG * OVERLAP_DEG
    while low < units.DEG * LARGEST_LEAN_DEG:
        slices = [Interval(low, low + units.DEG * width) for width in widths_deg]
        push = _soonest(setup, angle, slices)
        if push is None:
            break
        found += [push, _mirrored(push)]
        low = push.lean.hi - units.DEG * OVERLAP_DEG
    return [push for push in found if push is not None]


def _soonest(setup: Setup, angle: float, slices: Sequence[Interval]) -> Push | None:
    """The push for the widest slice that does not take a long way, or else the one with the shortest.

    Close to the lean at which a tip no longer sticks for certain it may hardly turn the part; one that slips
    turns it sooner.
    """
    shortest: Push | None = None
    for lean, slipping in product(slices, (False, True) if setup.may_slip else (False,)):
        push = _push(setup, angle, lean, slipping=slipping)
        if push is not None and (shortest is None or push.way_um < shortest.way_um):
            shortest = push
        if shortest is not None and shortest.way_um < LONG * units.to_um(setup.outline.reach):
            break
    return shortest


def _push(setup: Setup, angle: float, lean: Interval, *, slipping: bool) -> Push | None:
    at = Interval.point(0.0)
    theta = Interval.point(angle) + lean - setup.uncertainty.sensed_orientation
    pre = PoseBox(x=at, y=at, theta=theta)
    step = upright(pre, setup, step=3, primitive="x_translation", slipping=slipping)
    # all poses on the way are wanted of a cell, and those of a tip that slips are not always bounded
    if step is None or certify_straighten(step.rule, pre, setup).verdict is not Verdict.PROVED:
        return None
    return Push(lean=lean, rule=step.rule)


def _mirrored(push: Push) -> Push:
    """The same for the opposite lean; whether it is proved is seen when it is used."""
    rule = push.rule
    dual = replace(rule.dual, y=from_part(-rule.dual.y.offset_um))
    return Push(lean=-push.lean, rule=replace(rule, dual=dual))


def turns(setup: Setup, angle: float) -> list[Turn]:
    """Rotations that lead to the goal's height with one push after them, strip by strip.

    Parameters
    ----------
    setup
        The task in the push's axes.
    angle
        Orientation before the rotation, at which a long edge stands upright to the push, rad.
    """
    found = []
    low = LOWEST_UM
    while low < HIGHEST_UM:
        strip = Interval(units.UM * low, units.UM * (low + STRIP_UM))
        turn = _turn(setup, angle, strip)
        if turn is not None:
            found.append(turn)
        low += STRIP_UM - 1.0
    return found


def _turn(setup: Setup, angle: float, strip: Interval) -> Turn | None:
    """The planner's rotation from the middle of the strip, shortened until it holds on all of it."""
    u, origin = setup.uncertainty, Interval.point(setup.goal.y.mid)
    far = Interval.point(setup.goal.x.mid + units.UM * FAR_UM)
    upright = Interval.point(angle)
    narrow = PoseBox(
        x=far,
        y=origin + Interval.point(strip.mid) + u.sensed_position + u.sensed_position,
        theta=upright + u.sensed_orientation + Interval(-NARROW_LEAN, NARROW_LEAN),
    )
    # where tips differ, poses after it are too many for one push: others bring the part to the goal
    found = turn(narrow, setup) if setup.may_slip else _first(rotate_and_insert(narrow, setup))
    if found is None:
        return None
    lean = Interval(-straight_lean(setup), straight_lean(setup))
    wide = PoseBox(
        x=far, y=origin + strip - u.sensed_position, theta=upright + lean - u.sensed_orientation
    )
    clear = units.to_um(setup.half_length.hi * lean.hi)
    for shorter in SHORTER_UM:
        rule = _roomier(found.rule, clear, shorter)
        if certify_rotation(rule, wide, setup, rough=True).verdict is Verdict.PROVED:
            return Turn(height=strip, origin=setup.goal.y.mid, rule=rule)
    return None


def _first(moves: tuple[Step, Step] | None) -> Step | None:
    return None if moves is None else moves[0]


def _roomier(rule: MoveRule, clear_um: float, shorter_um: float) -> MoveRule:
    """All tips start ``clear_um`` further from the part, and the push ends earlier."""
    if rule.single is None:
        raise ValueError(f"rotation rule needs a passive tip, got {rule}")
    return replace(
        rule,
        dual=replace(rule.dual, x=_raised(rule.dual.x, clear_um)),
        single=replace(rule.single, x=_raised(rule.single.x, -clear_um)),
        dual_end=_raised(rule.dual_end, shorter_um - clear_um),
    )


def shifted(rule: MoveRule, rise: float) -> MoveRule:
    """The same rotation ``rise`` (m) higher, in its own axes."""
    up = units.to_um(rise)
    single = rule.single
    return replace(
        rule,
        dual=replace(rule.dual, y=_raised(rule.dual.y, up)),
        single=None if single is None else replace(single, y=_raised(single.y, up)),
    )


def _raised(aim: Aim, up_um: float) -> Aim:
    """An aim moved by so much, rounded to the manipulator's 0.1 um."""
    return replace(aim, offset_um=round(aim.offset_um + up_um, 1))
