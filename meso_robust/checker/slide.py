"""The turn between both tips: barriers that no motion crosses.

While both tips touch the part has one freedom left, the slide ``sigma`` of its centre along the
edges. A tip that slides towards ``+a`` on the part pulls it there, ``k = mu``; one that slides the
other way has ``k = -mu``; one that sticks any ``k`` between. D slides towards ``+a`` exactly where
``d(sigma)/d(travel) < slip_D``, S where it is below ``-slip_D`` (``grip.py``).

A curve ``sigma = U(h)`` with the slope ``u`` per travel is an upper barrier if no motion on it has a
speed ``y >= u``. Assume one had. A tip that sticks at a speed below ``u`` slides towards ``-a`` then,
its ratio is ``-mu``. A tip that sticks at a speed ``v`` above ``u`` has the ratio ``mu`` if ``y < v``;
that ``y >= v`` is excluded separately, with any ratio of this tip. Otherwise the ratio is anything in
its cone. The speed is a quotient of two linear functions of either ratio, with a denominator that
does not vanish, hence greatest at ends of the cones: where it is below ``u`` (or ``v``) at all of
those that are left, ``y`` cannot be. Such a curve cannot be crossed, as a motion on it is slower by
a margin than the curve is. For lower barriers all signs change. Nothing is asked of the motion
itself, which need not be unique.

Barriers are cubic in ``h``, piece by piece; how they were found does not matter.
"""

from __future__ import annotations

import dataclasses
import itertools
import math

from flint import arb

from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.grip import Grip
from meso_robust.checker.guess import Corners, corners_of, curve
from meso_robust.checker.ids import Objection, named
from meso_robust.checker.pushing import UNIT
from meso_robust.checker.ranges import Box, Formula, Side, positive
from meso_robust.checker.refusal import Refused

PIECES = 40
BAND = 4
"""Pieces while a motion can still begin, that is until every part touches both tips."""
FEW = 16
"""Cuts of a piece before a steeper slope is tried."""
SPARE = (2e-4, 8e-4, 3e-3, 1.2e-2, 5e-2, 0.2)
"""Slopes that are added to a guess, one after the other."""
BOTH = (-1, 1)
ROOM = 1e-12
"""m; between what must be held and what holds it."""
CLAIM = named(Objection.SLIDE_IN_TUBE)


@dataclasses.dataclass(frozen=True, slots=True)
class Cubic:
    """A piece of a barrier, in the share of the piece that is done."""

    coefficients: tuple[float, float, float, float]

    def __call__(self, done: Dual) -> Dual:
        """Value."""
        a, b, c, d = map(arb, self.coefficients)
        return ((done * d + c) * done + b) * done + a

    def slope(self, done: Dual) -> Dual:
        """Derivative."""
        _, b, c, d = map(arb, self.coefficients)
        return (done * (3 * d) + 2 * c) * done + b

    @property
    def end(self) -> float:
        """A number near the value at the end."""
        return math.fsum(self.coefficients)


@dataclasses.dataclass(frozen=True, slots=True)
class Piece:
    """A piece of the tube."""

    first: float
    """h at its start, m."""
    last: float
    lower: Cubic
    upper: Cubic

    def h(self, done: Dual) -> Dual:
        """Where h is when ``done`` of the piece is done."""
        return arb(self.first) - done * (arb(self.first) - arb(self.last))

    def done(self, h: Dual) -> Dual:
        """The inverse."""
        return (arb(self.first) - h) / (arb(self.first) - arb(self.last))

    def sigma(self, done: Dual, share: Dual) -> Dual:
        """Any slide in the tube."""
        low = self.lower(done)
        return low + share * (self.upper(done) - low)


def enclose(box: Box, h: Side, sigma: Side, h_end: Side) -> tuple[Piece, ...]:
    """Barriers from the touch of both tips to the end of the travel.

    Parameters
    ----------
    box
        Sides ``V``, ``d1``, ``rho`` and ``mu``.
    h, sigma
        Where both tips can touch first.
    h_end
        h at the end of the travel, below ``h``.

    Raises
    ------
    Refused
        No barrier was confirmed.
    """
    knots = _knots(h, h_end)
    lower, upper = (_barrier(box, knots, sigma, side) for side in (-1, 1))
    return tuple(
        Piece(first, last, one, other)
        for (first, last), one, other in zip(itertools.pairwise(knots), lower, upper, strict=True)
    )


def _knots(h: Side, h_end: Side) -> list[float]:
    """Ends of the pieces; the first ones hold every start, the last one every end."""
    top, landed = _beyond(h[1], 1), _beyond(h[0], -1)
    near, bottom = _beyond(h_end[1], 1), _beyond(h_end[0], -1)
    if not landed > near:
        raise Refused(named(Objection.RESTS_WELL_BEFORE_END), landed, near)
    band = [top + (landed - top) * k / BAND for k in range(BAND)]
    turn = [landed + (near - landed) * k / PIECES for k in range(PIECES)]
    return [*band, *turn, near, bottom]


def _beyond(value: arb, side: int) -> float:
    """A double above (1) or below (-1) a number."""
    return math.nextafter(float(value), side * math.inf) + side * ROOM


def _barrier(box: Box, knots: list[float], sigma: Side, side: int) -> list[Cubic]:
    """One barrier; a curve that is not confirmed is tried again with a steeper slope."""
    begin = sigma[(side + 1) // 2]
    value, found = _beyond(begin, side), []
    corners = corners_of({name: (float(s[0]), float(s[1])) for name, s in box.items()})
    for k, (first, last) in enumerate(itertools.pairwise(knots)):
        piece = _confirmed(box, (first, last), value, corners, side, k < BAND)
        if k < BAND and not positive(_spare(piece, begin, side), {"done": UNIT}):
            raise Refused(
                CLAIM, "holds every state in which both tips can touch first", "not shown"
            )
        found.append(piece)
        value = piece.end + side * ROOM
    for one, other in itertools.pairwise(found):
        end = one(Dual(arb(1))).value
        if not (arb(other.coefficients[0]) - end) * side >= 0:
            raise Refused(CLAIM, "without a gap", "a gap")
    return found


def _spare(piece: Cubic, begin: arb, side: int) -> Formula:
    """How far a piece is beyond the slides that a turn can begin with."""
    return lambda at: (piece(at["done"]) - begin) * side


def _confirmed(
    box: Box, ends: tuple[float, float], value: float, corners: Corners, side: int, band: bool
) -> Cubic:
    first, last = ends
    length = first - last
    one, two, rise = curve(first, last, value, float(box["d1"][0]), corners, side, band)
    for spare in SPARE:
        start, end, up = one + side * spare, two + side * spare, rise + side * spare * length
        cubic = Cubic(
            (
                value,
                length * start,
                3.0 * up - length * (2.0 * start + end),
                -2.0 * up + length * (start + end),
            )
        )
        if _is_barrier(cubic, box, ends, side):
            return cubic
    raise Refused(CLAIM, "a barrier", f"none at h = {first:.6g} m: the tips may close on the part")


def _is_barrier(cubic: Cubic, box: Box, ends: tuple[float, float], side: int) -> bool:
    """Whether every motion on the curve is slower than the curve (see the module's text)."""
    first, last = arb(ends[0]), arb(ends[1])
    states: Box = {**box, "done": UNIT}

    def grip(at: Point) -> Grip:
        return Grip.at(first - at["done"] * (first - last), at["V"], box["d1"][0])

    def slope(at: Point) -> Dual:
        return cubic.slope(at["done"]) / (first - last)

    def speed(k_D: int, k_S: int) -> Formula:
        return lambda at: grip(at).slide(cubic(at["done"]), at["rho"], at["mu"], k_D, k_S)

    def exceeds(one: Formula, other: Formula) -> bool:
        return positive(lambda at: (one(at) - other(at)) * side, states, cuts=FEW)

    sticks: tuple[Formula, Formula] = (lambda at: grip(at).slip_D, lambda at: -grip(at).slip_D)
    below = [exceeds(slope, one) for one in sticks]
    above = [not under and exceeds(one, slope) for under, one in zip(below, sticks, strict=True)]
    ratios = [_ratios(under, over, side) for under, over in zip(below, above, strict=True)]
    levels: list[tuple[Formula, list[tuple[int, ...]]]] = [(slope, ratios)]
    for tip in (0, 1):
        if above[tip]:
            other = (-side,) if below[1 - tip] else BOTH
            levels.append((sticks[tip], [BOTH, other] if tip == 0 else [other, BOTH]))
    return all(
        exceeds(level, speed(k_D, k_S))
        for level, ratios in levels
        for k_D, k_S in itertools.product(*ratios)
    )


def _ratios(below: bool, above: bool, side: int) -> tuple[int, ...]:
    """Friction ratios, over mu, of a tip while the centre is about as fast as the curve.

    ``below``: the speed at which the tip sticks is proved to be below the curve's slope.
    """
    if below:
        return (-side,)
    return (side,) if above else BOTH
