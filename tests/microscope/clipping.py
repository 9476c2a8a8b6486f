"""Exact coverage of pixels by a polygon, by clipping: what the renderer is measured against."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Point = tuple[float, float]


def coverage(polygon: Floats, width: int, height: int) -> Floats:
    """(height, width) share of each pixel (a unit square about integers) that a polygon covers.

    ``polygon`` is (V, 2) in px, convex. Each pixel is cut with each edge (Sutherland & Hodgman 1974).
    """
    result = np.zeros((height, width))
    u0, v0 = (max(0, math.floor(x)) for x in polygon.min(axis=0))
    u1, v1 = (math.ceil(x) + 1 for x in polygon.max(axis=0))
    corners = [(float(x), float(y)) for x, y in polygon]
    corners = corners if _area(corners) > 0.0 else corners[::-1]
    for v in range(v0, min(height, v1 + 1)):
        for u in range(u0, min(width, u1 + 1)):
            result[v, u] = _pixel(corners, u, v)
    return result


def _pixel(corners: list[Point], u: int, v: int) -> float:
    signs = [_side(a, b, (u, v)) for a, b in _edges(corners)]
    lengths = [math.dist(a, b) for a, b in _edges(corners)]
    if all(s > n for s, n in zip(signs, lengths, strict=True)):  # more than 1 px inside
        return 1.0
    if any(s < -n for s, n in zip(signs, lengths, strict=True)):
        return 0.0
    piece = [(u - 0.5, v - 0.5), (u + 0.5, v - 0.5), (u + 0.5, v + 0.5), (u - 0.5, v + 0.5)]
    for edge in _edges(corners):
        piece = _cut(piece, *edge)
    return _area(piece) if len(piece) > 2 else 0.0


def _cut(piece: list[Point], a: Point, b: Point) -> list[Point]:
    kept: list[Point] = []
    for p, q in _edges(piece):
        sp, sq = _side(a, b, p), _side(a, b, q)
        if sp >= 0.0:
            kept.append(p)
        if sp * sq < 0.0:
            t = sp / (sp - sq)
            kept.append((p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])))
    return kept


def _edges(points: list[Point]) -> list[tuple[Point, Point]]:
    return list(zip(points, points[1:] + points[:1], strict=True))


def _side(a: Point, b: Point, p: Point) -> float:
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])


def _area(points: list[Point]) -> float:
    return 0.5 * sum(p[0] * q[1] - q[0] * p[1] for p, q in _edges(points))
