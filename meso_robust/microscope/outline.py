"""Signed distance to polygons, and polygons with rounded corners."""

from __future__ import annotations

import numpy as np

from meso_robust.types import Floats


def area(corners: Floats) -> float:
    """Signed area of a polygon (V, 2): positive if counter-clockwise."""
    x, y = corners.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def signed_distance(rings: tuple[Floats, ...], x: Floats, y: Floats) -> Floats:
    """Distance to the nearest edge, negative inside.

    Parameters
    ----------
    rings
        Polygons (V, 2); a point is inside if it is inside an odd number of them.
    x, y
        Points, of shapes that broadcast together, in the unit of the corners.
    """
    nearest = np.full(np.broadcast(x, y).shape, np.inf)
    inside = np.zeros(nearest.shape, dtype=bool)
    for ring in rings:
        for (ax, ay), (bx, by) in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            ex, ey = bx - ax, by - ay
            along = np.clip(((x - ax) * ex + (y - ay) * ey) / (ex * ex + ey * ey), 0.0, 1.0)
            square = (x - ax - along * ex) ** 2 + (y - ay - along * ey) ** 2
            np.minimum(nearest, square, out=nearest)
            if ay != by:
                inside ^= ((ay > y) != (by > y)) & (x < ax + (y - ay) * ex / ey)
    return np.where(inside, -1.0, 1.0) * np.sqrt(nearest)


def inset(corners: Floats, by: float) -> Floats:
    """Corners (V, 2) of the polygon whose edges lie ``by`` further inside, mitred.

    Raises
    ------
    ValueError
        If an edge is too short for it.
    """
    corners = corners if area(corners) > 0 else corners[::-1]
    edge = np.roll(corners, -1, axis=0) - corners
    tangent = edge / np.linalg.norm(edge, axis=1, keepdims=True)
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
    before = np.roll(normal, 1, axis=0)
    mitre = (normal + before) / (1.0 + np.sum(normal * before, axis=1, keepdims=True))
    moved = corners + by * mitre
    if np.any(np.sum((np.roll(moved, -1, axis=0) - moved) * tangent, axis=1) <= 0.0):
        raise ValueError(f"corner radius {by} m; an edge is too short for it; make it smaller")
    return moved


def rounded_distance(corners: Floats, radius: float, x: Floats, y: Floats) -> Floats:
    """Signed distance to a polygon whose convex corners are rounded; straight edges stay in place.

    The polygon is shrunk by the radius and grown again, which also leaves reflex corners sharp.
    """
    if radius == 0.0:
        return signed_distance((corners,), x, y)
    return signed_distance((inset(corners, radius),), x, y) - radius
