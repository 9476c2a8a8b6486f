"""The part's outline: which of its edges can be pushed, and what lies beyond the part.

An edge can be pushed if the whole part lies on one side of its line: every edge of a convex polygon,
and the edges of another one that belong to its convex hull. A tip that is off the line of any side
of the convex hull is clear of the part.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from meso_robust.bounds import HALF_PI, Interval, enclose
from meso_robust.bounds.interval import arcsin, cos, sin
from meso_robust.conditions import condition
from meso_robust.errors import InputError, NotApplicableError
from meso_robust.task import Part, PolygonPart
from meso_robust.units import metres

ZERO = Interval.point(0.0)
PI = HALF_PI + HALF_PI
ANYWHERE = Interval(-math.inf, math.inf)
Point = tuple[Interval, Interval]
"""x and y in the part's own frame, m."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """A side of the part's convex hull, run counter-clockwise about the part."""

    turn: Interval
    """Orientation of the part minus direction of the line, rad."""
    depth: Interval
    """Distance from the centre (d1), m."""

    def angle(self, theta: Interval) -> Interval:
        """Direction of the line at orientation ``theta`` of the part."""
        return theta - self.turn

    def orientation(self, angle: Interval) -> Interval:
        """Orientation of the part at direction ``angle`` of the line."""
        return angle + self.turn


@dataclass(frozen=True, slots=True, kw_only=True)
class Edge(Line):
    """An edge of the part that can face the active probe (which pushes along -x).

    It stands upright, outward normal +x, at angle pi/2.
    """

    name: str
    first: Interval
    """Where it begins along its direction (least d2), from the foot of the centre, m."""
    last: Interval
    """Where it ends (largest d2), m."""
    before: Line
    after: Line
    """The edges of the part that it meets where it begins and where it ends."""
    beyond: tuple[Line, ...] = ()
    """The other sides of the convex hull; none for a rectangle."""
    parallel: tuple[str, ...] = ()
    """Names of the edges that are exactly parallel to it as stated."""

    @property
    def half(self) -> Interval:
        """Half the length of a rectangle's edge, m."""
        return self.last


@dataclass(frozen=True, slots=True, kw_only=True)
class Tolerance:
    """How far a part may be from its outline as stated."""

    size: Interval
    """How much farther out an edge lies, each by its own amount, m."""
    squareness: Interval
    """By how much an edge is turned from its direction, each by its own angle, rad."""
    rounding: Interval
    """Largest radius of a corner, m."""

    @property
    def exact(self) -> bool:
        """Whether the part is the outline as stated."""
        return self == EXACT

    def line(self, line: Line) -> Line:
        """Where the line of an edge can be: its own angle is in its turn."""
        return Line(turn=line.turn + self.squareness, depth=line.depth + self.size)

    def edge(self, edge: Edge) -> Edge:
        """An edge that is pushed: its own angle is not in its turn, its ends are those that are certain."""
        depth = edge.depth + self.size
        last = self._end(depth, edge.after, edge.turn - edge.after.turn, self.rounding)
        first = self._end(depth, edge.before, edge.before.turn - edge.turn, self.rounding)
        return replace(
            edge,
            depth=depth,
            first=Interval.point(-first.lo),
            last=Interval.point(last.lo),
            beyond=tuple(map(self.line, edge.beyond)),
        )

    def corner(self, before: Line, after: Line) -> Point:
        """Where the sharp corner can be in which two edges meet, in the part's own frame."""
        depth = after.depth + self.size
        first = -self._end(depth, before, before.turn - after.turn, ZERO)
        c, s = cos(self.line(after).turn), -sin(self.line(after).turn)
        return first * c + depth * s, first * s - depth * c

    def _end(
        self, depth: Interval, other: Line, exterior: Interval, rounding: Interval
    ) -> Interval:
        """Where the straight part of an edge ends, derivations/polygon_edge.py."""
        box = {
            "d1": depth,
            "d1_next": other.depth + self.size,
            "exterior": exterior + self.squareness - self.squareness,
            "rounding": rounding,
        }
        return enclose(condition("polygon_edge", "end_offset"), box)[0]


EXACT = Tolerance(size=ZERO, squareness=ZERO, rounding=ZERO)


@dataclass(frozen=True, slots=True, kw_only=True)
class Rectangle:
    """A rectangle about its centre."""

    half_length: Interval
    half_width: Interval

    def sides(self, theta: float) -> tuple[Line, ...]:
        """All sides, the one that faces the probe at orientation ``theta`` first."""
        edges = (self.edge(theta + k * HALF_PI.mid) for k in range(4))
        return tuple(Line(turn=edge.turn, depth=edge.depth) for edge in edges)

    def edge(self, theta: float) -> Edge:
        """The edge that faces the probe at orientation ``theta``."""
        quarter = round(theta / HALF_PI.lo) - 1
        long_edge = quarter % 2 == 0
        depth, half = (
            (self.half_width, self.half_length)
            if long_edge
            else (self.half_length, self.half_width)
        )
        turn = HALF_PI * Interval.point(quarter)
        return Edge(
            name="long" if long_edge else "short",
            turn=turn,
            depth=depth,
            first=-half,
            last=half,
            before=Line(turn=turn + HALF_PI, depth=half),
            after=Line(turn=turn - HALF_PI, depth=half),
            parallel=("long" if long_edge else "short",),
        )

    @property
    def corners(self) -> tuple[Point, ...]:
        """The corners, counter-clockwise."""
        a, b = self.half_length, self.half_width
        return ((-a, -b), (a, -b), (a, b), (-a, b))

    @property
    def reach(self) -> float:
        """About how far a corner is from the centre, m; for choosing, not for proofs."""
        return self.half_length.hi

    @property
    def width(self) -> float:
        """The least distance of parallels that hold the part, m; for choosing, not for proofs."""
        return 2.0 * self.half_width.mid

    def mirrored(self) -> Rectangle:
        """The outline with the y axis mirrored: the same."""
        return self

    def within(self, tolerance: Tolerance) -> Rectangle:
        """A rectangle that holds every part within ``tolerance`` of this one."""
        a, b = (side + tolerance.size for side in (self.half_length, self.half_width))
        lean = Interval.point(tolerance.squareness.hi)
        # a corner lies on two lines, at x cos k1 + y sin k1 = a' and y cos k2 + x sin k2 = b'
        c, s, below = cos(lean), sin(lean), cos(lean + lean)
        return Rectangle(half_length=(a * c + b * s) / below, half_width=(b * c + a * s) / below)


@dataclass(frozen=True, slots=True, kw_only=True)
class Polygon:
    """A simple polygon about its reference point."""

    corners: tuple[Point, ...]
    """Counter-clockwise."""
    around: tuple[int, ...]
    """Numbers of those of the convex hull, counter-clockwise."""
    hull: tuple[Point, ...]
    """These corners."""
    walls: tuple[Line, ...]
    """All edges of the part, from one corner to the next; a depth may be negative."""
    lines: tuple[Line, ...]
    """All sides of the convex hull."""
    edges: tuple[Edge, ...]
    """Those that are edges of the part."""

    def edge(self, theta: float) -> Edge:
        """The edge that faces the probe at orientation ``theta``, its angle close to pi/2 there.

        Raises
        ------
        NotApplicableError
            No edge of the part belongs to its convex hull.
        """
        if not self.edges:
            raise NotApplicableError(
                "no edge of the part can be pushed: each has some of the part on its outer side; "
                "give another part"
            )
        upright = [theta - edge.turn.mid - HALF_PI.mid for edge in self.edges]
        off = [math.remainder(angle, 4.0 * HALF_PI.mid) for angle in upright]
        best = min(range(len(off)), key=lambda k: abs(off[k]))
        edge, turns = self.edges[best], round((upright[best] - off[best]) / (4.0 * HALF_PI.mid))
        turn = _whole_turns(edge.turn, turns)
        ahead = (replace(line, turn=_next_below(line.turn, turn)) for line in edge.beyond)
        return replace(edge, turn=turn, beyond=tuple(ahead))

    def sides(self, theta: float) -> tuple[Line, ...]:
        """All sides of the convex hull, the one that faces the probe at orientation ``theta`` first."""
        edge = self.edge(theta)
        return (Line(turn=edge.turn, depth=edge.depth), *edge.beyond)

    def within(self, tolerance: Tolerance) -> Polygon:
        """Where corners and sides of every part within ``tolerance`` can be.

        A side of the hull that joins two corners of the part, none of its edges, is put beyond all of
        them, which are all that the part is the hull of. An edge on whose outer side some of the part may
        come to lie cannot be pushed.
        """
        walls = self.walls
        corners = tuple(
            tolerance.corner(before, after)
            for before, after in zip((walls[-1], *walls[:-1]), walls, strict=True)
        )
        steps = zip(self.around, (*self.around[1:], self.around[0]), strict=True)
        lines = tuple(
            tolerance.line(line) if (j - i) % len(corners) == 1 else _beyond(line, corners)
            for line, (i, j) in zip(self.lines, steps, strict=True)
        )
        edges = tuple(
            replace(
                tolerance.edge(edge),
                beyond=tuple(
                    new for new, old in zip(lines, self.lines, strict=True) if old.turn != edge.turn
                ),
            )
            for edge in self.edges
            if self._holds(edge, corners, tolerance)
        )
        return replace(
            self,
            corners=corners,
            hull=tuple(corners[k] for k in self.around),
            lines=lines,
            edges=edges,
        )

    def _holds(self, edge: Edge, corners: Sequence[Point], tolerance: Tolerance) -> bool:
        """Whether all other corners, which can be there, are certain to be inside of an edge's line."""
        line, count = tolerance.line(edge), len(corners)
        own = Line(turn=edge.turn, depth=edge.depth)
        first = self.walls.index(own)
        return all(
            _out_of(line, corners[(first + k) % count]).hi < line.depth.lo for k in range(2, count)
        )

    @property
    def reach(self) -> float:
        """About how far a corner is from the centre, m; for choosing, not for proofs."""
        return max(math.hypot(x.mid, y.mid) for x, y in self.corners)

    @property
    def width(self) -> float:
        """The least distance of parallels that hold the part, m; for choosing, not for proofs."""
        return min(self._breadth(line) for line in self.lines)

    def _breadth(self, line: Line) -> float:
        out = (-math.sin(line.turn.mid), -math.cos(line.turn.mid))
        return line.depth.mid - min(x.mid * out[0] + y.mid * out[1] for x, y in self.hull)

    def mirrored(self) -> Polygon:
        """The outline with the y axis mirrored; an edge is run the other way there."""

        def point(corner: Point) -> Point:
            return corner[0], -corner[1]

        count = len(self.corners)
        return Polygon(
            corners=tuple(map(point, reversed(self.corners))),
            around=tuple(count - 1 - k for k in reversed(self.around)),
            hull=tuple(map(point, reversed(self.hull))),
            # the edge from corner k to the next ends at what is corner count - 1 - k now
            walls=tuple(_mirrored(self.walls[(count - 2 - k) % count]) for k in range(count)),
            lines=tuple(map(_mirrored, self.lines)),
            edges=tuple(
                replace(
                    edge,
                    turn=-edge.turn - PI,
                    first=-edge.last,
                    last=-edge.first,
                    before=_mirrored(edge.after),
                    after=_mirrored(edge.before),
                    beyond=tuple(map(_mirrored, edge.beyond)),
                )
                for edge in self.edges
            ),
        )


def _whole_turns(angle: Interval, turns: int) -> Interval:
    return angle + HALF_PI * Interval.point(4.0 * turns)


def _next_below(turn: Interval, edge: Interval) -> Interval:
    """The turn of a line by whole turns less than an edge's: run on from it, the line comes later."""
    return _whole_turns(turn, math.floor((edge.mid - turn.mid) / (4.0 * HALF_PI.mid)))


def _beyond(line: Line, corners: Sequence[Point]) -> Line:
    """A line of this direction that has all corners inside."""
    reached = [_out_of(line, corner) for corner in corners]
    return Line(turn=line.turn, depth=functools.reduce(Interval.hull, reached, line.depth))


def _out_of(line: Line, point: Point) -> Interval:
    """How far a point is from the centre along a line's outward normal, m."""
    return -sin(line.turn) * point[0] - cos(line.turn) * point[1]


def _mirrored(line: Line) -> Line:
    return Line(turn=-line.turn - PI, depth=line.depth)


Outline = Rectangle | Polygon


def outline_of(part: Part | PolygonPart) -> Outline:
    """The outline of a task's part in SI intervals."""
    if isinstance(part, PolygonPart):
        return _polygon(part)
    two = Interval.point(2.0)
    return Rectangle(
        half_length=metres(part.length_um) / two, half_width=metres(part.width_um) / two
    )


@functools.lru_cache(maxsize=8)  # a search converts one task many times
def _polygon(part: PolygonPart) -> Polygon:
    corners = tuple((metres(x), metres(y)) for x, y in part.polygon_um)
    around = part.hull
    pairs = list(zip(around, (*around[1:], around[0]), strict=True))
    count = len(corners)
    walls = tuple(_line(corners, k, (k + 1) % count)[0] for k in range(count))
    sides = [_side(corners, walls, *pair) for pair in pairs]
    own = [i for i, j in pairs if j == (i + 1) % count]
    lines = tuple(Line(turn=side.turn, depth=side.depth) for side in sides)
    return Polygon(
        corners=corners,
        around=tuple(around),
        hull=tuple(corners[k] for k in around),
        walls=walls,
        lines=lines,
        edges=tuple(
            replace(
                side,
                beyond=(*lines[:k], *lines[k + 1 :]),
                parallel=tuple(_named(m) for m in own if part.are_parallel(i, m)),
            )
            for k, (side, (i, j)) in enumerate(zip(sides, pairs, strict=True))
            if j == (i + 1) % count
        ),
    )


def _named(corner: int) -> str:
    """What the edge after a corner is called."""
    return f"edge {corner}"


def _line(corners: Sequence[Point], first: int, last: int) -> tuple[Line, Interval, Interval]:
    """The line from one corner to another, and d2 at both (derivations/polygon_edge.py)."""
    (x0, y0), (x1, y1) = corners[first], corners[last]
    box = {"x0": x0, "y0": y0, "x1": x1, "y1": y1}
    c, s = enclose(condition("polygon_edge", "edge_direction"), box)
    depth, begin, end = enclose(condition("polygon_edge", "edge_offsets"), box)
    return Line(turn=-_direction(c, s), depth=depth), begin, end


def _side(corners: Sequence[Point], walls: Sequence[Line], first: int, last: int) -> Edge:
    """The side of the hull from one corner to another."""
    line, begin, end = _line(corners, first, last)
    if not (line.depth.lo > 0.0 and line.turn.width < 1.0):
        raise InputError(
            f"key part.polygon_um: the side from corner {first} to corner {last} is too close to "
            "the reference point or too short to be computed with; leave more room"
        )
    return Edge(
        name=_named(first),
        turn=line.turn,
        depth=line.depth,
        first=begin,
        last=end,
        before=walls[first - 1],
        after=walls[last],
    )


def _direction(c: Interval, s: Interval) -> Interval:
    """The angle with cosine ``c`` and sine ``s``, by the one that is far from +-1.

    The whole line if the sign of the other one, which tells the half of the circle, is not certain.
    """
    if abs(s.mid) < abs(c.mid):
        if not (c.lo > 0.0 or c.hi < 0.0):
            return ANYWHERE
        return arcsin(s) if c.lo > 0.0 else PI - arcsin(s)
    if not (s.lo > 0.0 or s.hi < 0.0):
        return ANYWHERE
    return HALF_PI - arcsin(c) if s.lo > 0.0 else arcsin(c) - HALF_PI
