"""Pushes that identify a part: the paper's eight tests of Fig. 3, and the same rule on any polygon.

Every push is along −x of the world, as the paper's are horizontal: the part is laid down with the
pushed edge facing +x, and the tip starts in front of it, free of contact.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from meso_robust.errors import InputError
from meso_robust.recordings import Polygon, Rectangle
from meso_robust.recordings.rules import DEG, UM
from meso_robust.types import Floats

Part = Rectangle | Polygon

_PLACES = {"A": 0.5, "B": 0.25, "C": 0.0, "D": -0.25, "E": -0.5, "F": 0.5, "G": 0.0, "H": -0.5}
_LONG, _SHORT = "ABCDE", "FGH"
_LONG_SIDE, _SHORT_SIDE = 0, 3  # sides of `Rectangle.outline` that face +x at 90 and at 180 deg


@dataclass(frozen=True, slots=True, kw_only=True)
class Bench:
    """What the laboratory brings to every push; SI.

    Attributes
    ----------
    tip_radius
        Radius of the round tip, m; 0 for a point. The default is half the paper's 25 um side.
    speed
        Of the probe, m/s; one of the paper's three.
    rates
        Speeds over that one, of one push after the other: where there are two, what depends on the speed
        shows.
    length
        Of a push from first contact on, m.
    gap
        Between tip and edge at the start, along the push, m: the start is free of contact.
    corner_margin
        Least distance of a pushed place from a corner, m. A tip exactly at a corner may as well
        miss the edge; the default is five times the paper's error of a seen position.
    rest
        Time for which the camera runs with the tip at rest, before and after a push, s. The frames before
        it tell the noise; those after it tell a camera that is late from a tip that is elsewhere.
    back
        By how much the tip is drawn back after the push, m: what clings to it follows.
    field
        Width and height of the field of view about the world's origin, m.
    trials
        Times that each push is made.

    Raises
    ------
    InputError
        If a value breaks its rule.
    """

    tip_radius: float = 12.5e-6
    speed: float = 75e-6
    rates: tuple[float, ...] = (1.0,)
    length: float = 700e-6
    gap: float = 50e-6
    corner_margin: float = 25e-6
    rest: float = 1.0
    back: float = 60e-6
    field: tuple[float, float] = (3370e-6, 2520e-6)
    trials: int = 3

    def __post_init__(self) -> None:
        """Check the values."""
        for name in ("speed", "length", "gap"):
            _check(name, getattr(self, name), getattr(self, name) > 0.0, "must be positive")
        for name in ("tip_radius", "corner_margin", "rest", "back"):
            value = getattr(self, name)
            _check(name, value, value >= 0.0, "must not be negative")
        _check("rates", len(self.rates), len(self.rates) > 0, "must be one or more")
        for rate in self.rates:
            _check("rates", rate, rate > 0.0, "must be positive")
        for side in self.field:
            _check("field", side, side > 0.0, "must be positive")
        _check("trials", self.trials, self.trials >= 1, "must be at least 1")

    def speed_of(self, index: int) -> float:
        """Speed of the tip in a push, m/s.

        Parameters
        ----------
        index
            Of the push in its experiment, from 0.
        """
        return self.speed * self.rates[index % len(self.rates)]


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedPush:
    """One straight push of a part at rest; SI, world frame.

    Attributes
    ----------
    name
        Of the push.
    edge
        Index of the pushed edge: that after corner ``edge`` of the outline.
    asked, place
        Signed distance of the pushed place from the middle of the edge, counter-clockwise, m: as
        the rule asks, and as used. They differ where the rule asks for a corner.
    start
        x, y in m and θ in rad of the part.
    tip
        Centre of the tip at its start, m.
    travel
        Displacement of the tip, m.
    """

    name: str
    edge: int
    asked: float
    place: float
    start: tuple[float, float, float]
    tip: tuple[float, float]
    travel: tuple[float, float]

    @property
    def moved_from_corner(self) -> float:
        """How far the place was moved away from what the rule asks, m."""
        return abs(self.asked - self.place)


@dataclass(frozen=True, slots=True, kw_only=True)
class Experiment:
    """A plan of pushes.

    Attributes
    ----------
    part, bench
        What is pushed, and with what.
    pushes
        The pushes, each to be made ``bench.trials`` times.
    left_out
        Name of every push of the rule that cannot be made, and why.
    """

    part: Part
    bench: Bench
    pushes: tuple[PlannedPush, ...]
    left_out: tuple[tuple[str, str], ...] = ()


def edge_push(
    part: Part, bench: Bench, *, name: str, edge: int, place: float, angle: float = 0.0
) -> PlannedPush:
    """Lay the part down for a push along −x at a place of an edge.

    Parameters
    ----------
    part, bench
        What is pushed, and with what.
    name
        Of the push.
    edge
        Index of the edge.
    place
        From its middle, counter-clockwise, m.
    angle
        Of the edge's outward normal against +x, rad; 0 for a push straight into the edge.
        At most a right angle, without it.

    Returns
    -------
    PlannedPush
        The part's reference point goes about from ``(length / 2, 0)`` to ``(−length / 2, 0)``.

    Raises
    ------
    InputError
        If the edge does not exist, the place lies beyond its ends or the tip comes from behind.
    """
    corners = part.outline
    rule = f"must be 0 to {len(corners) - 1}, as there are {len(corners)} edges"
    _check("edge", edge, 0 <= edge < len(corners), rule)
    along, half = _side(corners, edge)
    _check("place", place, abs(place) <= half, f"must lie on the edge, within {half:g} m")
    _check("angle", angle, abs(angle) < 0.5 * np.pi, "must be less than a right angle")
    # the outward normal is the direction along the edge turned by −90°
    theta = _wrapped(angle + 0.5 * np.pi - np.arctan2(along[1], along[0]))
    centre = np.array([0.5 * bench.length, 0.0])
    pushed = turned(theta) @ (corners[edge] + (half + place) * along)
    normal = np.array([np.cos(angle), np.sin(angle)])
    tip = centre + pushed + bench.tip_radius * normal + np.array([bench.gap, 0.0])
    return PlannedPush(
        name=name,
        edge=edge,
        asked=place,
        place=place,
        start=(float(centre[0]), 0.0, theta),
        tip=(float(tip[0]), float(tip[1])),
        travel=(-(bench.gap + bench.length), 0.0),
    )


def standard_tests(part: Part, bench: Bench) -> Experiment:
    """The eight tests of Fig. 3 of the paper, or the same rule on every edge of a polygon.

    On the long side the tip meets the middle (C), a quarter (B, D) and half (A, E) of the side from
    it; on the short side the middle (G) and the two ends (F, H). A rectangle is laid at 90° for the
    long side and at 180° for the short one; its other two sides would repeat these tests. In a
    polygon an edge counts as long if it is not shorter than the mean; its tests are named after it,
    ``edge0_A`` and so on. A place at a corner is moved inwards by the bench's margin.

    Parameters
    ----------
    part, bench
        What is pushed, and with what.

    Returns
    -------
    Experiment
        The pushes; what cannot be made is left out by name.

    Raises
    ------
    InputError
        If no push can be made, or one would leave the field of view.
    """
    pushes: list[PlannedPush] = []
    left_out: list[tuple[str, str]] = []
    for edge, letters, prefix in _sides(part):
        for letter in letters:
            found = _standard(part, bench, edge, letter, prefix + letter)
            if isinstance(found, str):
                left_out.append((prefix + letter, found))
            else:
                pushes.append(found)
    if not pushes:
        reasons = "; ".join(f"{name}: {why}" for name, why in left_out)
        raise InputError(f"part: no push can be made ({reasons}); take a thinner tip")
    for push in pushes:
        check_field(part, bench, push)
    return Experiment(part=part, bench=bench, pushes=tuple(pushes), left_out=tuple(left_out))


def check_field(part: Part, bench: Bench, push: PlannedPush) -> None:
    """Refuse a push that may leave the field of view, however the part turns on its way.

    Raises
    ------
    InputError
        If the circle about the part, carried along the push, or the tip leaves the field.
    """
    around = float(np.hypot(*part.outline.T).max())
    here = np.array(push.start[:2])
    there = here + np.array(push.travel)
    reach = np.maximum(np.abs(here), np.abs(there)) + around
    reach = np.maximum(reach, np.abs(np.array(push.tip)) + bench.tip_radius)
    if np.any(reach > 0.5 * np.array(bench.field)):
        wide, high = 2.0 * reach / UM
        raise InputError(
            f"field: {bench.field[0] / UM:g} x {bench.field[1] / UM:g} um; push {push.name} may need "
            f"{wide:.0f} x {high:.0f} um; give a larger field or a shorter push"
        )


def blocked(part: Part, bench: Bench, push: PlannedPush) -> bool:
    """Whether another edge is in the way of the tip before it meets its own."""
    corners = part.outline
    x, y, theta = push.start
    world = np.array([x, y]) + corners @ turned(theta).T
    first = np.array(push.tip)
    last = first - np.array([bench.gap, 0.0])
    others = [k for k in range(len(corners)) if k != push.edge]
    return any(
        _distance(first, last, world[k], world[(k + 1) % len(world)]) < bench.tip_radius
        for k in others
    )


def turned(theta: float) -> Floats:
    """(2, 2) rotation by an angle in rad."""
    cos, sin = np.cos(theta), np.sin(theta)
    return np.array([[cos, -sin], [sin, cos]])


def _sides(part: Part) -> Iterator[tuple[int, str, str]]:
    """Every edge to be pushed, with the letters of its tests and the prefix of their names."""
    if isinstance(part, Rectangle):
        yield _LONG_SIDE, _LONG, ""
        yield _SHORT_SIDE, _SHORT, ""
        return
    corners = part.outline
    lengths = np.hypot(*(np.roll(corners, -1, axis=0) - corners).T)
    for edge, length in enumerate(lengths):
        yield edge, _LONG if length >= lengths.mean() * (1.0 - 1e-9) else _SHORT, f"edge{edge}_"


def _standard(part: Part, bench: Bench, edge: int, letter: str, name: str) -> PlannedPush | str:
    """A test of the rule, or why it cannot be made."""
    _, half = _side(part.outline, edge)
    asked = 2.0 * half * _PLACES[letter]
    most = half - bench.corner_margin
    at_corner = abs(_PLACES[letter]) == 0.5
    if asked != 0.0 and (most <= 0.0 or (abs(asked) > most and not at_corner)):
        return f"nearer to a corner than the margin of {bench.corner_margin / UM:g} um allows"
    place = float(np.copysign(most, asked)) if at_corner else asked
    push = replace(edge_push(part, bench, name=name, edge=edge, place=place), asked=asked)
    return "another edge is in the way of the tip" if blocked(part, bench, push) else push


def _side(corners: Floats, edge: int) -> tuple[Floats, float]:
    """Direction along an edge, and half its length."""
    way = corners[(edge + 1) % len(corners)] - corners[edge]
    length = float(np.hypot(*way))
    return way / length, 0.5 * length


def _wrapped(theta: float) -> float:
    """The same angle in (−π, π]; within 1e-9 deg of −π counts as π."""
    theta = float(np.remainder(theta, 2.0 * np.pi))
    return theta - 2.0 * np.pi if theta > np.pi * (1.0 + 1e-12) else theta


def _distance(a: Floats, b: Floats, c: Floats, d: Floats) -> float:
    """Distance of two segments that do not cross, m; 0 if they do."""
    if _turn(a, b, c) * _turn(a, b, d) < 0.0 and _turn(c, d, a) * _turn(c, d, b) < 0.0:
        return 0.0
    return min(_off(a, c, d), _off(b, c, d), _off(c, a, b), _off(d, a, b))


def _turn(a: Floats, b: Floats, c: Floats) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def _off(point: Floats, a: Floats, b: Floats) -> float:
    """Distance of a point from a segment."""
    way = b - a
    share = float(np.clip((point - a) @ way / (way @ way), 0.0, 1.0))
    return float(np.hypot(*(point - a - share * way)))


def _check(name: str, value: float, kept: bool, rule: str) -> None:
    if not (kept and np.isfinite(value)):
        shown = f"{value / DEG:g} deg" if name == "angle" else f"{value:g}"
        raise InputError(f"{name}: {shown}; {rule}; change it")
