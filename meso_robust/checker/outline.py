"""The part's outline in exact numbers: its edges, and the sides of its convex hull.

Of a polygon, the hull is wrapped corner by corner: from each one to the corner that has all others
on the left. A side ``p q`` of length ``L`` has the direction ``atan2`` of ``q - p``, lies
``d1 = (p x q)/L`` from the centre, and runs from ``p.(q - p)/L`` to ``q.(q - p)/L`` along itself.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from flint import arb, fmpq

from meso_robust.checker.ids import Objection, named
from meso_robust.checker.refusal import Refused
from meso_robust.task import Part, PolygonPart

Corner = tuple[Fraction, Fraction]
"""m"""


def _ball(value: Fraction) -> arb:
    return arb(fmpq(value.numerator, value.denominator))


def _metres(value_um: float) -> Fraction:
    return Fraction(repr(float(value_um))) / 10**6


@dataclass(frozen=True, slots=True, kw_only=True)
class Edge:
    """A side of the convex hull."""

    name: int
    """Rectangle: the right angles of ``turn``; polygon: its first corner."""
    turn: arb
    """Orientation of the part minus direction of the side, rad."""
    d1: arb
    """Distance from the centre, m."""
    first: arb
    last: arb
    """Its ends along its direction, from the centre's foot, m."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rectangle:
    """A rectangle about its centre."""

    half_length: arb
    """m"""
    half_width: arb
    """m"""

    def facing(self, theta: arb) -> Edge:
        """The edge with an outward normal close to +x when the part's orientation is ``theta``."""
        return self._edge(round(float((theta / (arb.pi() / 2)).mid())) - 1)

    def _edge(self, quarter: int) -> Edge:
        d1, half = self.half_width, self.half_length
        if quarter % 2 == 1:
            d1, half = half, d1
        return Edge(name=quarter, turn=arb.pi() / 2 * quarter, d1=d1, first=-half, last=half)

    def sides(self, edge: Edge) -> tuple[Edge, ...]:
        """All sides of the hull, ``edge`` first."""
        return tuple(self._edge(edge.name + k) for k in range(4))

    @property
    def hull(self) -> tuple[tuple[arb, arb], ...]:
        """Corners of the convex hull, the part's own axes, m."""
        a, b = self.half_length, self.half_width
        return ((-a, -b), (-a, b), (a, -b), (a, b))

    @property
    def reach(self) -> arb:
        """About how far a corner is from the centre, m."""
        return self.half_length

    def mirrored(self) -> Rectangle:
        """With the y axis mirrored: the same."""
        return self


@dataclass(frozen=True, slots=True, kw_only=True)
class Polygon:
    """A simple polygon."""

    corners: tuple[Corner, ...]
    """Counter-clockwise, the part's own axes."""
    around: tuple[int, ...]
    """Which of them are those of the convex hull, counter-clockwise."""
    every: tuple[Edge, ...]
    """The sides of the convex hull."""

    def facing(self, theta: arb) -> Edge:
        """The edge of the part with an outward normal close to +x at the orientation ``theta``.

        Raises
        ------
        Refused
            No edge of the part is a side of its convex hull.
        """
        count = len(self.corners)
        ends = zip(self.around, (*self.around[1:], self.around[0]), strict=True)
        own = [e for e, (i, j) in zip(self.every, ends, strict=True) if (j - i) % count == 1]
        if not own:
            raise Refused(named(Objection.EDGE_ON_HULL), 0, "1 or more")
        ahead = [(theta - edge.turn) / (arb.pi() / 2) - 1 for edge in own]
        turns = [round(float((right / 4).mid())) for right in ahead]
        off = [abs(float((r - 4 * n).mid())) for r, n in zip(ahead, turns, strict=True)]
        best = off.index(min(off))
        return replace(own[best], turn=own[best].turn + 2 * arb.pi() * turns[best])

    def sides(self, edge: Edge) -> tuple[Edge, ...]:
        """All sides of the hull, ``edge`` first, the others less than a whole turn on from it."""
        turn = 2 * arb.pi()

        def later(one: Edge) -> Edge:
            turns = math.floor(float(((edge.turn - one.turn) / turn).mid()))
            return replace(one, turn=one.turn + turn * turns)

        return (edge, *(later(one) for one in self.every if one.name != edge.name))

    @property
    def hull(self) -> tuple[tuple[arb, arb], ...]:
        """Corners of the convex hull, the part's own axes, m."""
        return tuple((_ball(x), _ball(y)) for x, y in (self.corners[k] for k in self.around))

    @property
    def reach(self) -> arb:
        """About how far a corner is from the centre, m."""
        return _ball(max(abs(x) + abs(y) for x, y in self.corners))

    def mirrored(self) -> Polygon:
        """With the y axis mirrored."""
        return _polygon(tuple((x, -y) for x, y in reversed(self.corners)))


Outline = Rectangle | Polygon


def outline(part: Part | PolygonPart) -> Outline:
    """The outline that a task states."""
    if isinstance(part, PolygonPart):
        return _polygon(tuple((_metres(x), _metres(y)) for x, y in part.polygon_um))
    return Rectangle(
        half_length=_ball(_metres(part.length_um) / 2), half_width=_ball(_metres(part.width_um) / 2)
    )


def _polygon(corners: tuple[Corner, ...]) -> Polygon:
    around = _wrapped(corners)
    ends = zip(around, (*around[1:], around[0]), strict=True)
    return Polygon(
        corners=corners,
        around=around,
        every=tuple(_side(i, corners[i], corners[j]) for i, j in ends),
    )


def _wrapped(corners: Sequence[Corner]) -> tuple[int, ...]:
    first = min(range(len(corners)), key=lambda k: corners[k])
    found = [first]
    while True:
        here, best = corners[found[-1]], None
        for k, corner in enumerate(corners):
            if corner == here:
                continue
            if best is None or _further_right(here, corners[best], corner):
                best = k
        if best is None or best == first:
            return tuple(found)
        found.append(best)


def _further_right(here: Corner, known: Corner, new: Corner) -> bool:
    """Whether the way to ``new`` is right of that to ``known``, or the same and longer."""
    a, b = (known[0] - here[0], known[1] - here[1]), (new[0] - here[0], new[1] - here[1])
    left = a[0] * b[1] - a[1] * b[0]
    return left < 0 or (left == 0 and b[0] ** 2 + b[1] ** 2 > a[0] ** 2 + a[1] ** 2)


def _side(name: int, p: Corner, q: Corner) -> Edge:
    along = (q[0] - p[0], q[1] - p[1])
    length = _ball(along[0] ** 2 + along[1] ** 2).sqrt()

    def over(value: Fraction) -> arb:
        return _ball(value) / length

    d1 = over(p[0] * q[1] - p[1] * q[0])
    if not d1 > 0:
        raise Refused(named(Objection.CENTRE_IN_HULL), float(d1), "more than 0")
    return Edge(
        name=name,
        turn=-arb.atan2(_ball(along[1]), _ball(along[0])),
        d1=d1,
        first=over(p[0] * along[0] + p[1] * along[1]),
        last=over(q[0] * along[0] + q[1] * along[1]),
    )
