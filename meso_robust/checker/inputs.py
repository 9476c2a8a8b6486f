"""The task in exact numbers: every decimal is the rational number that it spells."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from flint import arb, fmpq

from meso_robust.checker.outline import Outline, outline
from meso_robust.checker.ranges import Side
from meso_robust.task import Slot, Task

SCALED = (
    "sensed_position",
    "sensed_orientation",
    "probe_position",
    "friction",
    "film_ratio",
    "misalignment",
)
"""The uncertainties that a margin scales."""
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
class Given:
    """A task: the part, the probe, all errors, where it starts and where it must end."""

    outline: Outline
    """The part's, in its own axes."""
    spacing: arb
    """Distance of the two tips across the push, m."""
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
    start: PoseBox
    goal: PoseBox
    blocks: tuple[Block, ...] = ()
    """The slot's walls, world axes."""


def uncertainties(known: Given) -> dict[str, Side]:
    """What the claim holds for all of, by the names of a certificate."""
    return {
        "sensed_position": known.sensed,
        "sensed_orientation": known.turned,
        "probe_position": known.probe,
        "friction": known.friction,
        "film_ratio": known.film_ratio,
        "misalignment": known.misalignment,
    }


def given(task: Task, factor: Fraction = Fraction(1), only: str | None = None) -> Given:
    """Convert a task, its uncertainties (or ``only`` one of them) scaled about their middle."""
    u = task.uncertainty
    share, ratio = exact(u.film_ratio_percent) / 100, exact(u.film_ratio_um2) / 10**12
    bounds: dict[str, Range] = {
        "sensed_position": _around(metres(u.sensed_position_um)),
        "sensed_orientation": _around(quarters(u.sensed_orientation_deg)),
        "probe_position": _around(metres(u.probe_position_um)),
        "friction": (exact(u.friction[0]), exact(u.friction[1])),
        "film_ratio": (ratio - ratio * share, ratio + ratio * share),
        "misalignment": (
            quarters(u.tip_misalignment_deg[0]),
            quarters(u.tip_misalignment_deg[1]),
        ),
    }
    for name in SCALED if only is None else (only,):
        bounds[name] = _scaled(bounds[name], factor)
    start, goal, turned = task.start, task.goal, bounds["sensed_orientation"]
    x, y, theta = metres(start.x_um), metres(start.y_um), quarters(start.theta_deg)
    off = metres(goal.position_tolerance_um)
    turn, to = quarters(goal.orientation_tolerance_deg), quarters(goal.theta_deg)
    theta += 4 * round((to - theta) / 4)  # the same pose, at most half a turn from the goal
    shift = bounds["sensed_position"]
    return Given(
        outline=outline(task.part),
        spacing=ball(metres(task.probe.tip_spacing_um)),
        sensed=_side(shift),
        turned=_angles(turned),
        probe=_side(bounds["probe_position"]),
        friction=_side(bounds["friction"]),
        film_ratio=_side(bounds["film_ratio"]),
        misalignment=_angles(bounds["misalignment"]),
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
    )


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


def _around(reach: Fraction) -> Range:
    return -reach, reach


def _scaled(ends: Range, factor: Fraction) -> Range:
    middle = (ends[0] + ends[1]) / 2
    return middle + (ends[0] - middle) * factor, middle + (ends[1] - middle) * factor


def _side(ends: Range) -> Side:
    return ball(ends[0]), ball(ends[1])


def _angles(ends: Range) -> Side:
    return angle(ends[0]), angle(ends[1])
