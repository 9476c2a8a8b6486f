"""A feedback policy: for every sensed pose of a region one move, until the part is in the goal."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from meso_robust.bounds import Interval
from meso_robust.policy.cover import meet
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.task import Task

READING = 1e-12
"""m or rad: what a sensed number may lose when it is converted; far above the rounding of doubles
below 1 m and 20 rad, far below anything that matters."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """One move for all sensed poses of a box."""

    sensed: PoseBox
    rule: MoveRule
    moves: int
    """Bound of the moves to the goal from here, this one included."""
    post: PoseBox
    """All true poses after the move."""
    ends: bool
    """Whether every pose of ``post`` lies in the goal, and none is sensed in this cell again."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Policy:
    """Cells in the order in which they are tried: fewest moves first."""

    task: Task
    cells: tuple[Cell, ...]
    rest: PoseBox | None
    """Sensed poses that prove that the part is in the goal; None if the goal is too small for it."""

    @property
    def moves(self) -> int:
        """N: bound of the moves from anywhere in the region."""
        return max((cell.moves for cell in self.cells), default=0)


def widened(box: PoseBox, position: Interval, angle: Interval) -> PoseBox:
    """All poses that differ from one in ``box`` by errors in these ranges."""
    return PoseBox(x=box.x + position, y=box.y + position, theta=box.theta + angle)


def reads(box: PoseBox, sensed: PoseBox) -> bool:
    """Whether a sensed pose counts as one of ``box``."""
    slack = Interval(-READING, READING)
    return sensed.within(widened(box, slack, slack))


def true_poses(sensed: PoseBox, setup: Setup) -> PoseBox:
    """All true poses that can be sensed in a box."""
    u, slack = setup.uncertainty, Interval(-READING, READING)
    return widened(sensed, slack - u.sensed_position, slack - u.sensed_orientation)


def sensed_poses(true: PoseBox, setup: Setup) -> PoseBox:
    """All poses that can be sensed while the true one lies in a box."""
    u = setup.uncertainty
    return widened(true, u.sensed_position, u.sensed_orientation)


def common(one: PoseBox, other: PoseBox) -> PoseBox:
    """The poses of both boxes.

    Raises
    ------
    ValueError
        If there are none.
    """
    return PoseBox(
        x=_common(one.x, other.x), y=_common(one.y, other.y), theta=_common(one.theta, other.theta)
    )


def _common(one: Interval, other: Interval) -> Interval:
    return Interval(max(one.lo, other.lo), min(one.hi, other.hi))


def resting(setup: Setup) -> PoseBox | None:
    """The largest box of sensed poses whose true poses all lie in the goal, if there is one."""
    u, goal = setup.uncertainty, setup.goal
    sides = (
        _shrunk(goal.x, u.sensed_position),
        _shrunk(goal.y, u.sensed_position),
        _shrunk(goal.theta, u.sensed_orientation),
    )
    x, y, theta = sides
    if x is None or y is None or theta is None:
        return None
    return PoseBox(x=x, y=y, theta=theta)


def _shrunk(side: Interval, error: Interval) -> Interval | None:
    """Numbers that stay in ``side`` after any ``error`` (of either sign) and the reading."""
    slack = Interval(-READING, READING)
    reach = error.hull(-error) + slack
    low, high = (Interval.point(side.lo) + reach).hi, (Interval.point(side.hi) - reach).lo
    low, high = math.nextafter(low, math.inf), math.nextafter(high, -math.inf)
    return Interval(low, high) if low <= high else None


def ends_in_goal(sensed: PoseBox, post: PoseBox, setup: Setup) -> bool:
    """Whether a move from ``sensed`` ends the task, and its end cannot be mistaken for its start."""
    unmoved = sensed_poses(true_poses(sensed, setup), setup)
    again = meet(sensed_poses(post, setup), unmoved)
    return post.within(setup.goal) and not again


def in_order(cells: Sequence[Cell]) -> tuple[Cell, ...]:
    """Fewest moves first; the order of equals is kept."""
    return tuple(sorted(cells, key=lambda cell: cell.moves))
