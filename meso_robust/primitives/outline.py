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
from meso_robust.bounds.interval import arcsin
from meso_robust.conditions import condition
from meso_robust.errors import InputError, NotApplicableError
from meso_robust.task import Part, PolygonPart
from meso_robust.units import metres

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
    beyond: tuple[Line, ...] = ()
    """The other sides of the convex hull; none for a rectangle, which ends where its edge ends."""

    @property
    def half(self) -> Interval:
        """Half the length of a rectangle's edge, m."""
        return self.last


@dataclass(frozen=True, slots=True, kw_only=True)
class Rectangle:
    """A rectangle about its centre."""

    half_length: Interval
    half_width: Interval

    def edge(self, theta: float) -> Edge:
        """The edge that faces the probe at orientation ``theta``."""
        quarter = round(theta / HALF_PI.lo) - 1
        long_edge = quarter % 2 == 0
        depth, half = (
            (self.half_width, self.half_length)
            if long_edge
            else (self.half_length, self.half_width)
        )
        return Edge(
            name="long" if long_edge else "short",
            turn=HALF_PI * Interval.point(quarter),
            depth=depth,
            first=-half,
            last=half,
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Polygon:
    """A simple polygon about the centre of drag."""

    corners: tuple[Point, ...]
    """Counter-clockwise."""
    hull: tuple[Point, ...]
    """Those of the convex hull, counter-clockwise."""
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

        return Polygon(
            corners=tuple(map(point, reversed(self.corners))),
            hull=tuple(map(point, reversed(self.hull))),
            lines=tuple(map(_mirrored, self.lines)),
            edges=tuple(
                replace(
                    edge,
                    turn=-edge.turn - PI,
                    first=-edge.last,
                    last=-edge.first,
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
    sides = [_side(corners, *pair) for pair in pairs]
    lines = tuple(Line(turn=side.turn, depth=side.depth) for side in sides)
    return Polygon(
        corners=corners,
        hull=tuple(corners[k] for k in around),
        lines=lines,
        edges=tuple(
            replace(side, beyond=(*lines[:k], *lines[k + 1 :]))
            for k, (side, (i, j)) in enumerate(zip(sides, pairs, strict=True))
            if j == (i + 1) % len(corners)
        ),
    )


def _side(corners: Sequence[Point], first: int, last: int) -> Edge:
    """The side of the hull from one corner to another (derivations/polygon_edge.py)."""
    (x0, y0), (x1, y1) = corners[first], corners[last]
    box = {"x0": x0, "y0": y0, "x1": x1, "y1": y1}
    c, s = enclose(condition("polygon_edge", "edge_direction"), box)
    depth, begin, end = enclose(condition("polygon_edge", "edge_offsets"), box)
    direction = _direction(c, s)
    if not (depth.lo > 0.0 and direction.width < 1.0):
        raise InputError(
            f"key part.polygon_um: the side from corner {first} to corner {last} is too close to "
            "the reference point or too short to be computed with; leave more room"
        )
    return Edge(name=f"edge {first}", turn=-direction, depth=depth, first=begin, last=end)


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
