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
from meso_robust.checker.ranges import Side
from meso_robust.checker.refusal import Refused
from meso_robust.task import Part, PolygonPart

Corner = tuple[Fraction, Fraction]
"""m"""


def _ball(value: Fraction) -> arb:
    return arb(fmpq(value.numerator, value.denominator))


def _metres(value_um: float) -> Fraction:
    return Fraction(repr(float(value_um))) / 10**6


@dataclass(frozen=True, slots=True, kw_only=True)
class Neighbour:
    """The edge of the part that meets another one at a corner."""

    turn: arb
    """By how much the outline turns at the corner, run counter-clockwise, rad."""
    d1: arb
    """Distance of its line from the centre, m; negative: the centre is on its outer side."""


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
    ends: tuple[Neighbour, Neighbour] | None = None
    """What meets it at both; None: it bridges a notch and is no edge of the part."""


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
        corner = Neighbour(turn=arb.pi() / 2, d1=half)
        turn = arb.pi() / 2 * quarter
        return Edge(name=quarter, turn=turn, d1=d1, first=-half, last=half, ends=(corner, corner))

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

    def astray(self, out: Side, turned: Side) -> arb:
        """How far a corner of the hull can be from where it is stated, m.

        ``out`` and ``turned``: by how much each edge lies farther out, and is turned.
        """
        return _astray([self._edge(k) for k in (0, 1)], out, turned)

    def opposite(self, edge: Edge) -> tuple[Edge, arb]:
        """The edge on the other side, and how it is turned against ``edge``, rad: not at all."""
        return self._edge(edge.name + 2), arb(0)

    def holds(self, edge: Edge, out: Side, turned: Side) -> bool:
        """Whether the part as it is lies on one side of an edge's line: a rectangle does."""
        return True

    def extent(self, edge: Edge) -> tuple[arb, arb]:
        """How far the part reaches along an edge, run as it is, and to either side of the centre across it, m."""
        return _extent(self.hull, edge)

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
        own = [edge for edge in self.every if edge.ends is not None]
        if not own:
            raise Refused(named(Objection.EDGE_ON_HULL), 0, "1 or more")
        ahead = [(theta - edge.turn) / (arb.pi() / 2) - 1 for edge in own]
        turns = [round(float((right / 4).mid())) for right in ahead]
        off = [abs(float((r - 4 * n).mid())) for r, n in zip(ahead, turns, strict=True)]
        best = off.index(min(off))
        return replace(own[best], turn=own[best].turn + 2 * arb.pi() * turns[best])

    def opposite(self, edge: Edge) -> tuple[Edge, arb]:
        """The edge that faces the other way, and how it, run backwards, is turned against ``edge``, rad."""
        far = self.facing(edge.turn + arb.pi() * 3 / 2)
        (a, b), (c, d) = self._along(edge), self._along(far)
        cross, dot = b * c - a * d, -a * c - b * d
        exact = cross == 0 and dot > 0
        return far, arb(0) if exact else arb.atan2(_ball(cross), _ball(dot))

    def _along(self, edge: Edge) -> Corner:
        """From the first corner of an edge of the part to its last."""
        (p, q), (r, s) = (self.corners[(edge.name + k) % len(self.corners)] for k in (0, 1))
        return r - p, s - q

    def holds(self, edge: Edge, out: Side, turned: Side) -> bool:
        """Whether the part as it is lies on one side of an edge's line, whichever that is."""
        s, c = edge.turn.sin_cos()
        lean = abs(turned[0]).max(abs(turned[1])).sin().upper()
        room = edge.d1 + out[0] - self.astray(out, turned)
        own = {edge.name, (edge.name + 1) % len(self.corners)}
        others = ((_ball(x), _ball(y)) for k, (x, y) in enumerate(self.corners) if k not in own)
        return all(room + x * s + y * c - lean * abs(x * c - y * s) > 0 for x, y in others)

    def extent(self, edge: Edge) -> tuple[arb, arb]:
        """How far the part reaches along an edge, run as it is, and to either side of the centre across it, m."""
        return _extent([(_ball(x), _ball(y)) for x, y in self.corners], edge)

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

    def astray(self, out: Side, turned: Side) -> arb:
        """How far a corner can be from where it is stated, m; one in a notch may come to stick out."""
        return _astray(self._at_corners, out, turned)

    @property
    def _at_corners(self) -> list[Edge]:
        """The edge of the part after each corner."""
        count = len(self.corners)
        return [_side(self.corners, k, (k + 1) % count, hull=False) for k in range(count)]

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
        every=tuple(_side(corners, i, j) for i, j in ends),
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


def _extent(corners: Sequence[tuple[arb, arb]], edge: Edge) -> tuple[arb, arb]:
    """Largest coordinate of corners along an edge, and largest size of one across it."""
    s, c = edge.turn.sin_cos()  # the edge runs along (c, -s)
    along = [x * c - y * s for x, y in corners]
    across = [abs(x * s + y * c) for x, y in corners]
    return _largest(along), _largest(across)


def _largest(values: Sequence[arb]) -> arb:
    found = values[0]
    for value in values[1:]:
        found = found.max(value)
    return found.upper()


def _astray(edges: Sequence[Edge], out: Side, turned: Side) -> arb:
    """How far the corners at which some edges begin can be from where they are stated.

    In the axes of an edge as it is the corner is at ``-(e' - e cos(t))/sin(t)`` along it and at its
    distance ``e`` across; these axes are themselves turned.
    """
    found = arb(0)
    off, turn = out[0].union(out[1]), turned[0].union(turned[1])
    for edge in edges:
        if edge.ends is None:
            continue
        before, across = edge.ends[0], edge.d1 + off
        s, c = (before.turn + turn - turn).sin_cos()  # each of the two edges has its own turn
        along = (across * c - (before.d1 + off)) / s
        sin, cos = turn.sin_cos()
        x, y = along * cos + across * sin - edge.first, across * cos - along * sin - edge.d1
        # of their largest sizes: the square of a ball around zero would reach below it
        far, wide = abs(x).upper(), abs(y).upper()
        found = found.max((far * far + wide * wide).sqrt().upper())
    return found


def _side(corners: Sequence[Corner], i: int, j: int, *, hull: bool = True) -> Edge:
    """The side of the hull between two corners."""
    line, count = _line(corners[i], corners[j]), len(corners)
    if hull and not line.d1 > 0:
        raise Refused(named(Objection.CENTRE_IN_HULL), float(line.d1), "more than 0")
    ends = None
    if (j - i) % count == 1:
        before = _line(corners[i - 1], corners[i])
        after = _line(corners[j], corners[(j + 1) % count])
        ends = (_corner(before, line, before), _corner(line, after, after))
    return Edge(name=i, turn=-line.heading, d1=line.d1, first=line.first, last=line.last, ends=ends)


@dataclass(frozen=True, slots=True)
class _Line:
    """From one corner to another one."""

    along: Corner
    d1: arb
    first: arb
    last: arb

    @property
    def heading(self) -> arb:
        return arb.atan2(_ball(self.along[1]), _ball(self.along[0]))


def _line(p: Corner, q: Corner) -> _Line:
    along = (q[0] - p[0], q[1] - p[1])
    length = _ball(along[0] ** 2 + along[1] ** 2).sqrt()
    return _Line(
        along,
        _ball(p[0] * q[1] - p[1] * q[0]) / length,
        _ball(p[0] * along[0] + p[1] * along[1]) / length,
        _ball(q[0] * along[0] + q[1] * along[1]) / length,
    )


def _corner(before: _Line, after: _Line, other: _Line) -> Neighbour:
    """What ``other`` is at the corner where two lines meet."""
    (a, b), (c, d) = before.along, after.along
    return Neighbour(turn=arb.atan2(_ball(a * d - b * c), _ball(a * c + b * d)), d1=other.d1)
