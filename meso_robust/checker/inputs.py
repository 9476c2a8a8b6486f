"""The task in exact numbers: every decimal is the rational number that it spells."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, fmpq

from meso_robust.checker.outline import Outline, outline
from meso_robust.checker.ranges import Side
from meso_robust.task import POINT_TIPS, Slot, Task

ALWAYS_STATED = (
    "sensed_position",
    "sensed_orientation",
    "probe_position",
    "friction",
    "film_ratio",
    "misalignment",
)
"""The uncertainties that a task of any schema states."""
RADII = frozenset({"tip_radius", "passive_tip_radius"})
"""Never below zero, however far they are scaled."""
ANGLES = frozenset({"sensed_orientation", "misalignment", "squareness", "travel_direction"})
Range = tuple[Fraction, Fraction]
Block = tuple[Side, Side]
"""A wall: its x and y, m."""


def exact(value: float) -> Fraction:
    """The number that a decimal spells."""
    return Fraction(repr(float(value)))


def ball(value: Fraction) -> arb:
    """The narrowest ball around a rational number."""
    return arb(fmpq(value.numerator, value.denominator))


def metres(value_um: float) -> Fraction:
    """Convert um to m."""
    return exact(value_um) / 10**6


def quarters(value_deg: float) -> Fraction:
    """Convert deg to right angles; the factor pi/2 is left to :func:`angle`."""
    return exact(value_deg) / 90


def angle(right_angles: Fraction) -> arb:
    """Right angles to rad."""
    return ball(right_angles) * arb.pi() / 2


@dataclass(frozen=True, slots=True, kw_only=True)
class PoseBox:
    """A box of poses of the part's centre, world frame or that of a move."""

    x: Side
    """m"""
    y: Side
    """m"""
    theta: Side
    """rad"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Channel:
    """A slot along -x of axes turned by quarter turns from the world's, m."""

    quarters: int

    x: Side
    """Of its mouth."""
    y: Side
    """Of its axis."""
    half: arb
    """Half its width."""
    depth: arb
    friction: arb
    """Between wall and part."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Given:
    """A task: the part, the probe, all errors, where it starts and where it must end."""

    outline: Outline
    """The part's as stated, in its own axes."""
    apart: arb
    """Distance of the centres of the two tips across the push as stated, m."""
    sensed: Side
    """Sensed minus true x or y, m."""
    turned: Side
    """Sensed minus true orientation, rad."""
    probe: Side
    """True minus commanded x or y of a probe, m."""
    friction: Side
    film_ratio: Side
    """rho, m^2."""
    misalignment: Side
    """beta, rad; positive: the tip on the right, seen along the push, is ahead."""
    radius: Side
    """Of each tip of the active probe, m."""
    passive_radius: Side
    """Of the passive tip, m."""
    spacing: Side
    """True minus stated distance of the two tips, m."""
    size: Side
    """How much farther out an edge lies than stated, m."""
    squareness: Side
    """By how much an edge is turned from its stated direction, rad."""
    direction: Side
    """By how much a true travel is turned counter-clockwise from the commanded one, rad."""
    scale: Side
    """Relative error of the length of a travel."""
    drag_centre: Side
    """A coordinate of the centre of drag from the reference point, m."""
    centre_moves: bool
    """Whether that may be another at every instant; else it is fixed in the part."""
    anisotropy: Side
    """``stretch`` or ``shear`` of the film's drag."""
    wander: Side
    """How far a moving probe is from its straight path, in x or in y, m."""
    common_friction: bool
    """Whether mu is the same at all tips at every instant."""
    film_constant: bool
    """Whether rho is constant during a run; else it may change at every instant."""
    corner_radius: arb
    """Largest rounding of a corner, m."""
    largest_force: arb | None
    """What no contact force may exceed, N; None: nothing is asked."""
    drag: arb | None
    """Largest translational drag of the film, N s/m."""
    speed: arb
    """Of a push, m/s."""
    start: PoseBox
    goal: PoseBox
    blocks: tuple[Block, ...] = ()
    """The slot's walls, world axes."""
    channel: Channel | None = None
    """The free space between these, in axes along it."""


def uncertainties(known: Given) -> dict[str, Side]:
    """What the claim holds for all of, by the names of a certificate; a margin scales all of it.

    Of what a task may leave out only what is not exactly zero.
    """
    ranges = {
        "sensed_position": known.sensed,
        "sensed_orientation": known.turned,
        "probe_position": known.probe,
        "friction": known.friction,
        "film_ratio": known.film_ratio,
        "misalignment": known.misalignment,
        "tip_radius": known.radius,
        "passive_tip_radius": known.passive_radius,
        "tip_spacing": known.spacing,
        "size": known.size,
        "squareness": known.squareness,
        "travel_direction": known.direction,
        "travel_scale": known.scale,
        "drag_centre": known.drag_centre,
        "drag_anisotropy": known.anisotropy,
        "probe_wander": known.wander,
    }
    return {
        name: side
        for name, side in ranges.items()
        if name in ALWAYS_STATED or not (side[0] == 0 and side[1] == 0)
    }


def given(task: Task, factor: Fraction = Fraction(1), only: str | None = None) -> Given:
    """Convert a task, its uncertainties (or ``only`` one of them) scaled about their middle."""
    bounds = _bounds(task)
    for name in bounds if only is None else (only,):
        low, high = _scaled(bounds[name], factor)
        bounds[name] = (max(low, Fraction(0)) if name in RADII else low, high)
    sides = {
        name: _angles(ends) if name in ANGLES else _side(ends) for name, ends in bounds.items()
    }
    start, goal, force = task.start, task.goal, task.probe.max_force_un
    shift, turned = bounds["sensed_position"], bounds["sensed_orientation"]
    x, y, theta = metres(start.x_um), metres(start.y_um), quarters(start.theta_deg)
    off = metres(goal.position_tolerance_um)
    turn, to = quarters(goal.orientation_tolerance_deg), quarters(goal.theta_deg)
    theta += 4 * round((to - theta) / 4)  # the same pose, at most half a turn from the goal
    return Given(
        outline=outline(task.part),
        apart=ball(metres(task.probe.tip_spacing_um)),
        sensed=sides["sensed_position"],
        turned=sides["sensed_orientation"],
        probe=sides["probe_position"],
        friction=sides["friction"],
        film_ratio=sides["film_ratio"],
        misalignment=sides["misalignment"],
        radius=sides["tip_radius"],
        passive_radius=sides["passive_tip_radius"],
        spacing=sides["tip_spacing"],
        size=sides["size"],
        squareness=sides["squareness"],
        direction=sides["travel_direction"],
        scale=sides["travel_scale"],
        drag_centre=sides["drag_centre"],
        centre_moves=task.uncertainty.drag_centre_moves is True,
        anisotropy=sides["drag_anisotropy"],
        wander=sides["probe_wander"],
        common_friction=task.schema_ == POINT_TIPS or task.uncertainty.friction_common is True,
        film_constant=task.schema_ == POINT_TIPS,
        corner_radius=ball(metres(task.part.corner_radius_um or 0.0)),
        largest_force=None if force is None else ball(exact(force) / 10**6),
        drag=None if task.film is None else ball(exact(task.film.drag_un_s_per_um)),
        speed=ball(metres(task.probe.speed_um_s)),
        start=PoseBox(
            x=_side((x - shift[1], x - shift[0])),
            y=_side((y - shift[1], y - shift[0])),
            theta=_angles((theta - turned[1], theta - turned[0])),
        ),
        goal=PoseBox(
            x=_side((metres(goal.x_um) - off, metres(goal.x_um) + off)),
            y=_side((metres(goal.y_um) - off, metres(goal.y_um) + off)),
            theta=_angles((to - turn, to + turn)),
        ),
        blocks=() if task.slot is None else _walls(task.slot),
        channel=None if task.slot is None else _channel(task.slot),
    )


def _bounds(task: Task) -> dict[str, Range]:
    """What is stated of each quantity; what is left out is exact. Angles in right angles."""
    u, probe, part = task.uncertainty, task.probe, task.part
    share, ratio = exact(u.film_ratio_percent) / 100, exact(u.film_ratio_um2) / 10**12
    radius = probe.tip_radius_um or (0.0, 0.0)
    tilted = u.travel_direction_deg or (0.0, 0.0)
    return {
        "sensed_position": _around(metres(u.sensed_position_um)),
        "sensed_orientation": _around(quarters(u.sensed_orientation_deg)),
        "probe_position": _around(metres(u.probe_position_um)),
        "friction": (exact(u.friction[0]), exact(u.friction[1])),
        "film_ratio": (ratio - ratio * share, ratio + ratio * share),
        "misalignment": _both(quarters, u.tip_misalignment_deg),
        "tip_radius": _both(metres, radius),
        "passive_tip_radius": _both(metres, probe.passive_tip_radius_um or radius),
        "tip_spacing": _around(metres(probe.tip_spacing_tolerance_um or 0.0)),
        "size": _around(metres(part.size_tolerance_um or 0.0) / 2),
        "squareness": _around(quarters(part.squareness_deg or 0.0)),
        "travel_direction": _both(quarters, tilted),
        "travel_scale": _around(exact(u.travel_scale_percent or 0.0) / 100),
        "drag_centre": _around(metres(u.drag_centre_um or 0.0)),
        # the principal drags differ by this share of their mean: each by half of it from the mean,
        # so much do the entries of the matrix at most in whatever axes
        "drag_anisotropy": _around(exact(u.drag_anisotropy_percent or 0.0) / 200),
        "probe_wander": _around(metres(u.probe_wander_um or 0.0)),
    }


def _walls(slot: Slot) -> tuple[Block, ...]:
    """Two walls beside the axis of a slot and one across its end, each a rectangle."""
    half, end = metres(slot.width_um) / 2, metres(slot.depth_um)
    out, back = half + metres(slot.wall_um), end + metres(slot.wall_um)
    zero = Fraction(0)
    solids = (
        ((zero, back), (half, out)),
        ((zero, back), (-out, -half)),
        ((end, back), (-out, out)),
    )
    inward = -1 if slot.opens.startswith("+") else 1
    mouth = metres(slot.mouth_x_um), metres(slot.mouth_y_um)
    deep = "xy".index(slot.opens[1])

    def block(depths: Range, beside: Range) -> Block:
        along = sorted(mouth[deep] + inward * depth for depth in depths)
        across = [mouth[1 - deep] + off for off in beside]
        first, second = _side((along[0], along[1])), _side((across[0], across[1]))
        return (first, second) if deep == 0 else (second, first)

    return tuple(block(depths, beside) for depths, beside in solids)


def _channel(slot: Slot) -> Channel:
    quarters = ("+x", "+y", "-x", "-y").index(slot.opens)
    x, y = metres(slot.mouth_x_um), metres(slot.mouth_y_um)
    for _ in range(quarters):
        x, y = y, -x
    return Channel(
        quarters=quarters,
        x=_side((x, x)),
        y=_side((y, y)),
        half=ball(metres(slot.width_um) / 2),
        depth=ball(metres(slot.depth_um)),
        friction=ball(exact(slot.friction)),
    )


def _around(reach: Fraction) -> Range:
    return -reach, reach


def _scaled(ends: Range, factor: Fraction) -> Range:
    middle = (ends[0] + ends[1]) / 2
    return middle + (ends[0] - middle) * factor, middle + (ends[1] - middle) * factor


def _both(convert: Callable[[float], Fraction], ends: tuple[float, float]) -> Range:
    return convert(ends[0]), convert(ends[1])


def _side(ends: Range) -> Side:
    return _ends(ball, ends)


def _angles(ends: Range) -> Side:
    return _ends(angle, ends)


def _ends(convert: Callable[[Fraction], arb], ends: Range) -> Side:
    """Both ends; of an exact number one and the same ball, by which it is known to be exact."""
    low = convert(ends[0])
    return low, low if ends[0] == ends[1] else convert(ends[1])
