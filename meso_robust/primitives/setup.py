"""The task in SI intervals: the part, pose boxes and the uncertainties."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from fractions import Fraction

import numpy as np

from meso_robust import units
from meso_robust.bounds import HALF_PI, Interval
from meso_robust.bounds.interval import cos, sin
from meso_robust.errors import InputError
from meso_robust.primitives.outline import (
    Edge,
    Line,
    Outline,
    Polygon,
    Rectangle,
    Tolerance,
    outline_of,
)
from meso_robust.task import POINT_TIPS, Slot, Task
from meso_robust.types import Floats

ZERO = Interval.point(0.0)
EXACT = (0.0, 0.0)
HALF = Interval.point(0.5)
HUNDRED = Interval.point(100.0)


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


LEANS = 0.005
"""rad; the lean of an edge on two unequal tips, about as much as orientations are sensed to, below which
plans are found whose tips stick."""

ALWAYS_STATED = (
    "sensed_position",
    "sensed_orientation",
    "probe_position",
    "friction",
    "film_ratio",
    "misalignment",
)
"""The uncertainties that a task of any schema states."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Uncertainty:
    """Everything that is not known exactly; what is left out is exact (a tip without radius a point)."""

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
    tip_radius: Interval = ZERO
    """Of each tip of the active probe, which may differ, m."""
    passive_tip_radius: Interval = ZERO
    """Of the passive tip, m."""
    tip_spacing: Interval = ZERO
    """True minus stated distance of the centres of the two tips, m."""
    size: Interval = ZERO
    """How much farther out an edge lies than stated, each edge by its own amount, m."""
    squareness: Interval = ZERO
    """By how much an edge is turned from its direction as stated, each by its own angle, rad."""
    travel_direction: Interval = ZERO
    """By how much the true travel of a probe is turned counter-clockwise from the commanded one, rad."""
    travel_scale: Interval = ZERO
    """Relative error of the length of a travel."""
    drag_centre: Interval = ZERO
    """Coordinates of the centre of drag from the reference point along any direction, m."""
    drag_anisotropy: Interval = ZERO
    """Drag along an edge over the mean of all directions, minus 1; and the shear over that mean."""
    probe_wander: Interval = ZERO
    """How far a moving probe strays from its straight path in x and in y, m."""

    @property
    def stated(self) -> dict[str, Interval]:
        """By name what every task states, and of the rest what is not exactly zero."""
        ranges = {field.name: getattr(self, field.name) for field in fields(self)}
        return {
            name: range_
            for name, range_ in ranges.items()
            if name in ALWAYS_STATED or range_ != ZERO
        }

    def mirrored(self) -> Uncertainty:
        """As axes see it whose y is mirrored: angles change their sign."""
        return replace(
            self, misalignment=-self.misalignment, travel_direction=-self.travel_direction
        )

    def scaled(self, factor: float, only: str | None = None) -> Uncertainty:
        """Widen all ranges (or ``only`` one) about their middle by ``factor``; no radius below zero."""
        if factor == 1.0:
            return self
        names = [field.name for field in fields(self)] if only is None else [only]
        wide = {name: _widened(getattr(self, name), factor) for name in names}
        for name in ("tip_radius", "passive_tip_radius"):
            if name in wide:
                wide[name] = Interval(max(wide[name].lo, 0.0), wide[name].hi)
        return replace(self, **wide)


def _widened(range_: Interval, factor: float) -> Interval:
    if range_.lo == range_.hi:  # what is exact stays so: a product is rounded outward
        return range_
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
    """The part's as stated, in its own frame."""
    stated_spacing: Interval
    """Distance of the centres of the two tips across the push as stated, m."""
    uncertainty: Uncertainty
    start: PoseBox
    """True poses at the start."""
    goal: PoseBox
    blocks: tuple[Block, ...] = ()
    """The walls of the slot, always in the world's axes."""
    slot: Slot | None = None
    """The same as stated, for the simulator."""
    friction_common: bool = True
    """Whether both tips have the same friction coefficient at every instant."""
    drag_centre_moves: bool = False
    """Whether the centre of drag may be at another place of its range at every instant."""
    corner_radius: Interval = ZERO
    """Largest rounding of a corner of the part, m."""
    largest_force: Interval | None = None
    """What no contact force may exceed, N; None: nothing is asked."""
    drag: Interval | None = None
    """Largest translational drag of the film (e_x), N s/m."""
    speed: Interval | None = None
    """Of the probe, m/s; None where it is not asked for."""

    @property
    def spacing(self) -> Interval:
        """Distance of the centres of the two tips across the push (d4), m."""
        return self.stated_spacing + self.uncertainty.tip_spacing

    @property
    def fixed_centre(self) -> Interval:
        """A coordinate of the centre of drag, where it is fixed in the part, m."""
        return ZERO if self.drag_centre_moves else self.uncertainty.drag_centre

    @property
    def moving_centre(self) -> Interval:
        """The same where it may move, at an instant."""
        return self.uncertainty.drag_centre if self.drag_centre_moves else ZERO

    @property
    def may_slip(self) -> bool:
        """Whether a straightening may begin with a tip that slips.

        Forces are not bounded closely then, so no cap may be there; and it is looked for only where tips
        may differ so much that an edge on both leans.
        """
        leans = self.uncertainty.tip_radius.width > LEANS * self.spacing.mid
        return leans and self.largest_force is None

    @property
    def tolerance(self) -> Tolerance:
        """How far the part may be from its outline as stated."""
        u = self.uncertainty
        return Tolerance(size=u.size, squareness=u.squareness, rounding=self.corner_radius)

    @property
    def body(self) -> Outline:
        """An outline that holds the part whatever its tolerances."""
        return _body(self.outline, self.tolerance)

    def edge(self, theta: float) -> Edge:
        """The edge that faces the probe at orientation ``theta``: its depth and its certain ends.

        Its own error of direction (squareness) is not in its turn.
        """
        return _edge(self.outline, self.tolerance, theta)

    def opposite(self, edge: Edge) -> tuple[Edge, Interval]:
        """The edge that faces away from a probe where ``edge`` faces it.

        Parameters
        ----------
        edge
            One that can be pushed.

        Returns
        -------
        tuple[Edge, Interval]
            It, and its direction, run the other way, less that of ``edge`` as stated, rad: exactly zero if
            they are parallel.
        """
        far = self.edge(edge.turn.mid + 3.0 * HALF_PI.mid)
        lean = ZERO if far.name in edge.parallel else edge.turn + HALF_PI + HALF_PI - far.turn
        return far, lean

    def reach_along(self, edge: Edge) -> Interval:
        """How far the whole part reaches along an edge, run as it is, from the foot of the centre, m."""
        turn = edge.turn + self.uncertainty.squareness
        c, s = cos(turn), sin(turn)
        places = [c * x - s * y for x, y in self.body.corners]
        return Interval(max(one.lo for one in places), max(one.hi for one in places))

    def sides(self, theta: float) -> tuple[Line, ...]:
        """The sides of the convex hull, the one that faces the probe at orientation ``theta`` first.

        Their errors of direction are in their turns.
        """
        body = self.body if isinstance(self.outline, Polygon) else self.outline
        sides = body.sides(theta)
        if isinstance(body, Polygon):
            return (replace(sides[0], turn=sides[0].turn + self.uncertainty.squareness), *sides[1:])
        return tuple(map(self.tolerance.line, sides))

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


@functools.lru_cache(maxsize=64)  # every move of a search asks for the same ones
def _body(outline: Outline, tolerance: Tolerance) -> Outline:
    return outline if tolerance.exact else outline.within(tolerance)


@functools.lru_cache(maxsize=1024)
def _edge(outline: Outline, tolerance: Tolerance, theta: float) -> Edge:
    edge = outline.edge(theta)
    if tolerance.exact:
        return edge
    if isinstance(outline, Polygon):
        return _body(outline, tolerance).edge(theta)
    return tolerance.edge(edge)


def setup_of(
    task: Task,
    scale: float = 1.0,
    only: str | None = None,
    *,
    apart: Mapping[str, float] | None = None,
) -> Setup:
    """Convert a task to SI intervals.

    Parameters
    ----------
    task
        As read from its file: every decimal means the number that it spells.
    scale
        Factor by which uncertainties are widened about their middle.
    only
        The one that is widened; None: all of them.
    apart
        Factors of single ones, in place of that.

    Returns
    -------
    Setup
        Everything that is promised against rounded outward, the goal inward.

    Raises
    ------
    InputError
        A tolerance of the goal is so small that rounding leaves nothing of it.
    """
    stated = _uncertainty(task)
    bounds = stated.scaled(scale, only)
    for name, factor in (apart or {}).items():
        bounds = replace(bounds, **{name: getattr(stated.scaled(factor, name), name)})
    start, goal = task.start, task.goal
    at_most = units.metres(goal.position_tolerance_um)
    turn = units.radians(goal.orientation_tolerance_deg)
    return Setup(
        outline=outline_of(task.part),
        stated_spacing=units.metres(task.probe.tip_spacing_um),
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
        friction_common=task.schema_ == POINT_TIPS or bool(task.uncertainty.friction_common),
        drag_centre_moves=bool(task.uncertainty.drag_centre_moves),
        corner_radius=units.metres(task.part.corner_radius_um or 0.0),
        largest_force=_newtons(task.probe.max_force_un),
        drag=None if task.film is None else units.plain(task.film.drag_un_s_per_um),
        speed=units.metres(task.probe.speed_um_s),
    )


def _newtons(force_un: float | None) -> Interval | None:
    return None if force_un is None else units.plain(force_un) / Interval.point(1e6)


def _uncertainty(task: Task) -> Uncertainty:
    """What is stated of each quantity; what schema 1 leaves out is exact."""
    u, probe, part = task.uncertainty, task.probe, task.part
    ratio = units.square_metres(u.film_ratio_um2)
    radius = probe.tip_radius_um or EXACT
    return Uncertainty(
        sensed_position=_both_sides(units.metres(u.sensed_position_um)),
        sensed_orientation=_both_sides(units.radians(u.sensed_orientation_deg)),
        probe_position=_both_sides(units.metres(u.probe_position_um)),
        friction=_range(units.plain, u.friction),
        film_ratio=ratio + ratio * _both_sides(_share(u.film_ratio_percent)),
        misalignment=_range(units.radians, u.tip_misalignment_deg),
        tip_radius=_range(units.metres, radius),
        passive_tip_radius=_range(units.metres, probe.passive_tip_radius_um or radius),
        tip_spacing=_error(probe.tip_spacing_tolerance_um, units.metres),
        size=_error(part.size_tolerance_um, lambda um: units.metres(um) * HALF),
        squareness=_error(part.squareness_deg, units.radians),
        travel_direction=_range(units.radians, u.travel_direction_deg or EXACT),
        travel_scale=_error(u.travel_scale_percent, _share),
        drag_centre=_error(u.drag_centre_um, units.metres),
        drag_anisotropy=_error(u.drag_anisotropy_percent, lambda percent: _share(percent) * HALF),
        probe_wander=_error(u.probe_wander_um, units.metres),
    )


def _share(percent: float) -> Interval:
    return units.plain(percent) / HUNDRED


def _error(largest: float | None, convert: Callable[[float], Interval]) -> Interval:
    """From minus the largest error to it; exactly zero where none is stated, unrounded."""
    return _both_sides(convert(largest)) if largest else ZERO


def _range(convert: Callable[[float], Interval], ends: tuple[float, float]) -> Interval:
    return ZERO if tuple(ends) == EXACT else convert(ends[0]).hull(convert(ends[1]))


def _blocks(slot: Slot) -> tuple[Block, ...]:
    """The walls, rounded outward."""

    def side(low: Fraction, high: Fraction) -> Interval:
        return Interval.exactly(low / 1_000_000).hull(Interval.exactly(high / 1_000_000))

    return tuple(Block(x=side(*sides[:2]), y=side(*sides[2:])) for sides in slot.blocks_um)


def _unwrapped(start_deg: float, goal_deg: float) -> Interval:
    """The start's orientation, rad, by whole turns as close to the goal's as it can be."""
    return units.radians(start_deg, round((goal_deg - start_deg) / 360.0))


def _both_sides(largest: Interval) -> Interval:
    return Interval(-largest.hi, largest.hi)


def _inside(middle: Interval, reach: Interval) -> Interval:
    """The goal rounded inward: what lies in it lies in the exact goal."""
    low, high = (middle - reach).hi, (middle + reach).lo
    if not low <= high:
        raise InputError("goal: a tolerance is so small that rounding leaves nothing; widen it")
    return Interval(low, high)
