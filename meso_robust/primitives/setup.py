"""The task in SI intervals: the part, pose boxes and the uncertainties."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from fractions import Fraction

import numpy as np

from meso_robust import units
from meso_robust.bounds import HALF_PI, Interval
from meso_robust.errors import InputError
from meso_robust.primitives.outline import Edge, Outline, Rectangle, outline_of
from meso_robust.task import Slot, Task
from meso_robust.types import Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class PoseBox:
    """A box of poses of the part's centre, world frame."""

    x: Interval
    """m"""
    y: Interval
    """m"""
    theta: Interval
    """rad"""

    def hull(self, other: PoseBox) -> PoseBox:
        """The smallest box that holds both."""
        return PoseBox(
            x=self.x.hull(other.x), y=self.y.hull(other.y), theta=self.theta.hull(other.theta)
        )

    def within(self, other: PoseBox) -> bool:
        """Whether every pose of this box lies in ``other``."""
        return self.x.within(other.x) and self.y.within(other.y) and self.theta.within(other.theta)

    @property
    def mid(self) -> tuple[float, float, float]:
        """A pose near the middle."""
        return self.x.mid, self.y.mid, self.theta.mid

    @property
    def ends(self) -> Floats:
        """(2, 3) lower and upper ends, m, m, rad."""
        sides = (self.x, self.y, self.theta)
        return np.array([[side.lo for side in sides], [side.hi for side in sides]])


@dataclass(frozen=True, slots=True, kw_only=True)
class Uncertainty:
    """Everything that is not known exactly, each bounded at every instant."""

    sensed_position: Interval
    """Sensed minus true x or y, m."""
    sensed_orientation: Interval
    """Sensed minus true theta, rad."""
    probe_position: Interval
    """True minus commanded x or y of a probe, m."""
    friction: Interval
    """Coefficient of friction between tip and part."""
    film_ratio: Interval
    """rho = e_theta/e_x, m^2."""
    misalignment: Interval
    """beta, rad; positive: the tip on the right, seen along the push, is ahead."""

    def scaled(self, factor: float, only: str | None = None) -> Uncertainty:
        """Widen all ranges (or ``only`` one) about their middle by ``factor``."""
        if factor == 1.0:
            return self
        names = [field.name for field in fields(self)] if only is None else [only]
        return replace(self, **{name: _widened(getattr(self, name), factor) for name in names})


def _widened(range_: Interval, factor: float) -> Interval:
    middle = Interval.point(range_.mid)
    return middle + (range_ - middle) * Interval.point(factor)


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """A solid rectangle at rest, sides along the world's axes."""

    x: Interval
    """m"""
    y: Interval
    """m"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Setup:
    """A task, converted once."""

    outline: Outline
    """The part's, in its own frame."""
    spacing: Interval
    """Distance of the two tips across the push (d4), m."""
    uncertainty: Uncertainty
    start: PoseBox
    """True poses at the start."""
    goal: PoseBox
    blocks: tuple[Block, ...] = ()
    """The walls of the slot, always in the world's axes."""
    slot: Slot | None = None
    """The same as stated, for the simulator."""

    def edge(self, theta: float) -> Edge:
        """The edge that faces the probe at orientation ``theta``."""
        return self.outline.edge(theta)

    @property
    def rectangle(self) -> Rectangle:
        """The outline of a part that must be a rectangle.

        Raises
        ------
        InputError
            It is a polygon.
        """
        if isinstance(self.outline, Rectangle):
            return self.outline
        raise InputError("key part.polygon_um: this is for rectangles only; give another task")

    @property
    def half_length(self) -> Interval:
        """Half the long side of a rectangle, m."""
        return self.rectangle.half_length

    @property
    def half_width(self) -> Interval:
        """Half the short side of a rectangle, m."""
        return self.rectangle.half_width


def setup_of(task: Task, scale: float = 1.0, only: str | None = None) -> Setup:
    """Convert a task to SI intervals.

    Parameters
    ----------
    task
        As read from its file: every decimal means the number that it spells.
    scale
        Factor by which uncertainties are widened about their middle.
    only
        The one that is widened; None: all of them.

    Returns
    -------
    Setup
        Everything that is promised against rounded outward, the goal inward.

    Raises
    ------
    InputError
        A tolerance of the goal is so small that rounding leaves nothing of it.
    """
    u = task.uncertainty
    ratio = units.square_metres(u.film_ratio_um2)
    share = units.plain(u.film_ratio_percent) / Interval.point(100.0)
    bounds = Uncertainty(
        sensed_position=_both_sides(units.metres(u.sensed_position_um)),
        sensed_orientation=_both_sides(units.radians(u.sensed_orientation_deg)),
        probe_position=_both_sides(units.metres(u.probe_position_um)),
        friction=units.plain(u.friction[0]).hull(units.plain(u.friction[1])),
        film_ratio=ratio + ratio * _both_sides(share),
        misalignment=units.radians(u.tip_misalignment_deg[0]).hull(
            units.radians(u.tip_misalignment_deg[1])
        ),
    ).scaled(scale, only)
    start, goal = task.start, task.goal
    at_most = units.metres(goal.position_tolerance_um)
    turn = units.radians(goal.orientation_tolerance_deg)
    return Setup(
        outline=outline_of(task.part),
        spacing=units.metres(task.probe.tip_spacing_um),
        uncertainty=bounds,
        start=PoseBox(
            x=units.metres(start.x_um) - bounds.sensed_position,
            y=units.metres(start.y_um) - bounds.sensed_position,
            theta=_unwrapped(start.theta_deg, goal.theta_deg) - bounds.sensed_orientation,
        ),
        goal=PoseBox(
            x=_inside(units.metres(goal.x_um), at_most),
            y=_inside(units.metres(goal.y_um), at_most),
            theta=_inside(units.radians(goal.theta_deg), turn),
        ),
        blocks=() if task.slot is None else _blocks(task.slot),
        slot=task.slot,
    )


def _blocks(slot: Slot) -> tuple[Block, ...]:
    """The walls, rounded outward."""

    def side(low: Fraction, high: Fraction) -> Interval:
        return Interval.exactly(low / 1_000_000).hull(Interval.exactly(high / 1_000_000))

    return tuple(Block(x=side(*sides[:2]), y=side(*sides[2:])) for sides in slot.blocks_um)


def _unwrapped(start_deg: float, goal_deg: float) -> Interval:
    """The start's orientation, rad, by whole turns as close to the goal's as it can be."""
    turns = round((goal_deg - start_deg) / 360.0)
    start = units.radians(start_deg)
    return start if turns == 0 else start + HALF_PI * Interval.point(4.0 * turns)


def _both_sides(largest: Interval) -> Interval:
    return Interval(-largest.hi, largest.hi)


def _inside(middle: Interval, reach: Interval) -> Interval:
    """The goal rounded inward: what lies in it lies in the exact goal."""
    low, high = (middle - reach).hi, (middle + reach).lo
    if not low <= high:
        raise InputError("goal: a tolerance is so small that rounding leaves nothing; widen it")
    return Interval(low, high)
