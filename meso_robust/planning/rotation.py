"""Choosing a two-sided rotation: separation of the tips, length of the push, height of the pair.

A larger separation is further from the jam but leaves a larger tilt; a longer push leaves a smaller
one until a tip runs off its edge. The height of the pair decides where the part ends in y once the
tilt is straightened, so it is chosen last, such that this is the goal.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol, TypeVar

import numpy as np

from meso_robust import units
from meso_robust.bounds import HALF_PI, Interval, Verdict
from meso_robust.motion.two_sided import Grip, Start, enclose_slide, rate_at
from meso_robust.planning.clearance import fine, passive_behind_um, rise_of, start_ahead_um
from meso_robust.planning.x_translation import to_goal
from meso_robust.primitives.move import MoveRule, Point, from_part, in_world
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.rotation import certify_rotation
from meso_robust.primitives.setup import ZERO, PoseBox, Setup

SEPARATION_STEPS_UM = (2.0, 10.0, 20.0, 40.0)  # beyond the smallest separation without jam
SCOUT = 2.0  # how much coarser than the certificate the scouting tube is
APPROACH_UM = 60.0  # what the push by the active tip alone may take
SHORTER_UM = 15.0  # from one push that is tried to the next
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
    return rotate_and_finish(pre, setup, lambda state: to_goal(state, setup))


def rotate_and_finish(
    pre: PoseBox, setup: Setup, finish: Finish[E], close_um: float = CLOSE_ENOUGH_UM
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
    """
    for extra in SEPARATION_STEPS_UM:
        turned = _turn(_least_separation_um(setup) + fine(setup) * extra, pre, setup)
        if turned is not None:
            # a larger separation leaves a larger tilt, so what fails now would fail with it too
            return _finish(*turned, pre, setup, finish, fine(setup) * close_um)
    return None


def _least_separation_um(setup: Setup) -> float:
    """Nominal separation above which no admissible one can jam, um."""
    u, depth = setup.uncertainty, setup.edge(HALF_PI.mid).depth
    root = math.sqrt(1.0 + u.friction.hi**2)
    radii = u.tip_radius.hi + u.passive_tip_radius.hi
    least = 2.0 * depth.hi * root + radii / root
    # the grip is shorter by what the edges are out of parallel, over their length
    least += 2.0 * u.squareness.width * setup.half_length.hi
    # the direction of the travel turns the distance along it into the separation
    turned = u.travel_direction.width * depth.hi
    unit, errors = fine(setup), u.probe_position.width + u.probe_wander.width + turned
    return unit * math.ceil(units.to_um(least + errors) / unit)


def _turn(separation: float, pre: PoseBox, setup: Setup) -> tuple[Step, _Choice] | None:
    """The robust rotation with the longest push at this separation, if any."""
    choice = _scout(separation, pre, setup)
    for _ in range(MOST_TRIALS):
        if choice is None:
            return None
        turned = certify_rotation(_rule(choice, pre, setup), pre, setup)
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
        turned = certify_rotation(_rule(choice, pre, setup), pre, setup)
    return reached


def _scout(separation: float, pre: PoseBox, setup: Setup) -> _Choice | None:
    """Where the longest push ends and which height of the pair leads to the goal (coarse)."""
    u, goal = setup.uncertainty, units.to_um(setup.goal.y.mid)
    depth, reach = setup.edge(HALF_PI.mid).depth, setup.half_length.mid
    radii = u.tip_radius + u.passive_tip_radius
    width = 2.0 * depth.mid + radii.mid
    middle, h_end = goal + 0.1 * units.to_um(reach), 0.0
    for _ in range(4):
        off = u.probe_position + u.probe_position
        V = Interval.point(separation * units.UM) + off
        grip = _grip(V - depth - depth - radii, setup)
        passive = middle - 0.5 * separation
        label = pre.y - Interval.point(passive * units.UM) + u.probe_position
        tube = enclose_slide(grip, _start(grip, label, setup), -width, coarse=SCOUT).cells[0]
        last = int(np.isfinite(tube.upper).sum()) - 2
        if last < 1 or tube.h[last] > 0.0:
            return None
        h_end = units.to_um(tube.h[last - 1] + off.hi)
        q = float(tube.centre[last] + 0.5 * (tube.lower[last] + tube.upper[last]))
        # the part's centre lies its length along the edge and its depth off it from the passive tip
        sine, cosine = _direction(h_end, separation, units.to_um(width))
        ahead = units.to_um(q) * sine - units.to_um(depth.mid + u.passive_tip_radius.mid) * cosine
        end_y = (
            passive + ahead + units.to_um(width) * 0.5 * (cosine + 1.0) - units.to_um(reach) * sine
        )
        middle += goal - end_y
    return _Choice(separation=separation, h_end=h_end, middle=middle)


def _grip(room: Interval, setup: Setup) -> Grip:
    u, edge = setup.uncertainty, setup.edge(HALF_PI.mid)
    return Grip(
        room=room,
        depth=edge.depth,
        depth_far=edge.depth,
        ends=(edge.first, edge.last),
        ends_far=(edge.first, edge.last),
        rho=u.film_ratio,
        mu=u.friction,
        common=setup.friction_common,
        radius=u.tip_radius,
        radius_far=u.passive_tip_radius,
        kappa=u.squareness - u.squareness if u.squareness != ZERO else ZERO,
        drag_a=u.drag_centre,
        drag_n=u.drag_centre,
        stretch=u.drag_anisotropy,
        shear=u.drag_anisotropy,
    )


def _start(grip: Grip, label: Interval, setup: Setup) -> Start:
    """Where a part that has hardly turned touches the passive tip, roughly."""
    width = grip.depth.mid + grip.depth_far.mid + grip.radius.mid + grip.radius_far.mid
    h = Interval(width - fine(setup) * APPROACH_UM * units.UM, width)
    return Start(
        h=h,
        labels={"label": label},
        value=label.mid,
        rate=rate_at(grip, h.hi, label.mid),
        spread={"label": 1.0},
        rest=Interval.point(0.0),
    )


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
