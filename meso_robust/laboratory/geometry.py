"""Points beside a part, by plain geometry, apart from proof and simulator."""

from __future__ import annotations

import numpy as np

from meso_robust.types import Floats


def distances(points: Floats, corners: Floats) -> Floats:
    """(...,) distance of points (..., 2) from the boundary of a polygon (V, 2), negative inside.

    Examples
    --------
    >>> triangle = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 3.0]])
    >>> distances(np.array([[1.0, 1.0], [2.0, -1.0], [7.0, 4.0]]), triangle)
    array([-1.,  1.,  5.])
    """
    sides = np.roll(corners, -1, axis=0) - corners
    offset = points[..., None, :] - corners
    along = np.clip(np.sum(offset * sides, axis=-1) / np.sum(sides**2, axis=-1), 0.0, 1.0)
    nearest = np.linalg.norm(offset - along[..., None] * sides, axis=-1).min(axis=-1)
    y = points[..., 1, None]
    passed = (corners[:, 1] > y) != (np.roll(corners, -1, axis=0)[:, 1] > y)
    # where a ray to the right meets a side: left of it the cross product has the side's direction
    left = (sides[:, 0] * offset[..., 1] - sides[:, 1] * offset[..., 0]) * np.sign(sides[:, 1]) > 0
    inside = (passed & left).sum(axis=-1) % 2 == 1
    return np.where(inside, -nearest, nearest)


def gaps_to(tips: Floats, pose: Floats, half: Floats) -> Floats:
    """Gaps between points and a rectangle.

    Parameters
    ----------
    tips
        (..., 2) points, m, world frame.
    pose
        (..., 3) of the rectangle, m and rad.
    half
        (2,) half its sides, m.

    Returns
    -------
    Floats
        (...,) distance from the rectangle, m; inside minus the distance to the nearest edge.
    """
    own = in_part(tips, pose)
    beyond = np.abs(own) - half
    outside = np.hypot(np.maximum(beyond[..., 0], 0.0), np.maximum(beyond[..., 1], 0.0))
    return np.asarray(outside + np.minimum(np.maximum(beyond[..., 0], beyond[..., 1]), 0.0))


def in_part(points: Floats, pose: Floats) -> Floats:
    """Points in the axes of a part.

    Parameters
    ----------
    points
        (..., 2) world frame, m.
    pose
        (..., 3) of the part, m and rad.

    Returns
    -------
    Floats
        (..., 2), m.
    """
    return turned(points - pose[..., :2], pose)


def turned(vectors: Floats, pose: Floats) -> Floats:
    """(..., 2) vectors of the world in the axes of a part at ``pose`` (..., 3)."""
    c, s = np.cos(pose[..., 2]), np.sin(pose[..., 2])
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([c * x + s * y, c * y - s * x], axis=-1)
