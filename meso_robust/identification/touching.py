"""Whether tips overlap a part, and the least shift of the part that frees it."""

from __future__ import annotations

import numpy as np

from meso_robust.types import Floats

_PASSES = 30  # shifts, one after the other, until no tip of several overlaps


def distances(outlines: Floats, points: Floats) -> tuple[Floats, Floats]:
    """Signed distance of points from outlines, positive outside, and its gradient.

    Parameters
    ----------
    outlines
        (1|N, V, 2) corners in m, counter-clockwise, body frame.
    points
        (N, 2) m, body frame.

    Returns
    -------
    (N,), (N, 2)
        Distance in m, and the unit vector along which it grows fastest.
    """
    best = np.full(len(points), np.inf)
    away, normal = np.zeros_like(points), np.zeros_like(points)
    turns = np.zeros(len(points))
    for k in range(outlines.shape[1]):
        start, end = outlines[:, k], outlines[:, (k + 1) % outlines.shape[1]]
        side, offset = end - start, points - start
        share = np.clip(np.sum(offset * side, axis=1) / np.sum(side * side, axis=1), 0.0, 1.0)
        gap = offset - share[:, None] * side
        distance = np.hypot(gap[:, 0], gap[:, 1])
        nearer = distance < best
        best = np.where(nearer, distance, best)
        away = np.where(nearer[:, None], gap, away)
        out = (
            np.stack([side[:, 1], -side[:, 0]], axis=1) / np.hypot(side[:, 0], side[:, 1])[:, None]
        )
        normal = np.where(nearer[:, None], out, normal)
        other = points - end
        cross = offset[:, 0] * other[:, 1] - offset[:, 1] * other[:, 0]
        turns += np.arctan2(cross, np.sum(offset * other, axis=1))
    inside = turns > np.pi
    sign = np.where(inside, -1.0, 1.0)
    on = best <= 1e-15  # on the line itself, where the offset has no direction
    direction = away / np.where(on, 1.0, best)[:, None] * sign[:, None]
    return sign * best, np.where(on[:, None], normal, direction)


def freed(poses: Floats, tips: Floats, outlines: Floats, radii: Floats) -> tuple[Floats, Floats]:
    """Shift parts out of the tips that they overlap, each by the least way.

    Parameters
    ----------
    poses
        (N, 3) m and rad, world frame.
    tips
        (N, P, 2) centres in m, world frame.
    outlines
        (1|N, V, 2) m, body frame.
    radii
        (1|N, P) m.

    Returns
    -------
    (N, 2), (N,)
        Shift of each part in m, world frame, zero where nothing overlaps, and the depth in m that is
        left: positive where a part is caught between tips.
    """
    shift = np.zeros((len(poses), 2))
    cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    radii = np.broadcast_to(radii, (len(poses), tips.shape[1]))

    def reach(p: int) -> tuple[Floats, Floats]:
        x, y = (tips[:, p] - poses[:, :2] - shift).T
        own = np.stack([cos * x + sin * y, cos * y - sin * x], axis=1)
        distance, out = distances(outlines, own)
        world = np.stack(
            [cos * out[:, 0] - sin * out[:, 1], sin * out[:, 0] + cos * out[:, 1]], axis=1
        )
        return radii[:, p] - distance, world

    for _ in range(1 if tips.shape[1] == 1 else _PASSES):
        depths = []
        for p in range(tips.shape[1]):
            depth, out = reach(p)
            depths.append(depth)
            over = depth > 0.0
            shift[over] -= depth[over, None] * out[over]
        if not np.any(np.array(depths) > 0.0):
            return shift, np.max(depths, axis=0)
    return shift, np.max([reach(p)[0] for p in range(tips.shape[1])], axis=0)
