"""Tips beside a part, by plain geometry, apart from proof and simulator."""

from __future__ import annotations

import numpy as np
from numba import njit

from meso_robust.types import Floats


def gaps_to(tips: Floats, poses: Floats, outlines: Floats, radii: Floats) -> Floats:
    """Gaps between round tips and parts.

    Parameters
    ----------
    tips
        (N, P, 2) centres, m, world frame.
    poses
        (N, 3) of the parts, m and rad.
    outlines
        (N, V, 2) their corners, m, own axes, counter-clockwise.
    radii
        (N, P) of the tips, m; 0 for a point.

    Returns
    -------
    Floats
        (N, P) m; a tip whose centre is inside has minus its distance to the nearest edge, less its
        radius.
    """
    found = np.empty(tips.shape[:2])
    _find_gaps(np.ascontiguousarray(tips), frames(poses), outlines, radii, found)
    return found


@njit(cache=True, nogil=True)
def _find_gaps(tips: Floats, parts: Floats, outlines: Floats, radii: Floats, found: Floats) -> None:
    """Write what `gaps_to` finds; of the parts `frames`."""
    count = outlines.shape[1]
    for i in range(tips.shape[0]):
        for k in range(tips.shape[1]):
            ax, ay = tips[i, k, 0] - parts[i, 0], tips[i, k, 1] - parts[i, 1]
            x, y = parts[i, 2] * ax + parts[i, 3] * ay, parts[i, 2] * ay - parts[i, 3] * ax
            square, inside = np.inf, False
            for j in range(count):
                after = j + 1 if j + 1 < count else 0
                dx, dy = x - outlines[i, j, 0], y - outlines[i, j, 1]
                ex = outlines[i, after, 0] - outlines[i, j, 0]
                ey = outlines[i, after, 1] - outlines[i, j, 1]
                along = min(max((dx * ex + dy * ey) / (ex * ex + ey * ey), 0.0), 1.0)
                across, beside = dx - along * ex, dy - along * ey
                square = min(square, across * across + beside * beside)
                # a ray to the right of the tip is crossed once more or less
                if (dy < 0.0) != (dy < ey) and (ex * dy - ey * dx) * (
                    1.0 if ey > 0.0 else -1.0
                ) > 0.0:
                    inside = not inside
            nearest = np.sqrt(square)
            found[i, k] = (-nearest if inside else nearest) - radii[i, k]


def frames(poses: Floats) -> Floats:
    """Axes of parts, for compiled code.

    Parameters
    ----------
    poses
        (N, 3) m and rad.

    Returns
    -------
    Floats
        (N, 4) x and y in m, and cosine and sine of the angle.
    """
    found = np.empty((len(poses), 4))
    found[:, :2] = poses[:, :2]
    np.cos(poses[:, 2], out=found[:, 2])
    np.sin(poses[:, 2], out=found[:, 3])
    return found


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
    found = np.empty((*np.broadcast_shapes(c.shape, x.shape), 2))
    found[..., 0], found[..., 1] = c * x + s * y, c * y - s * x
    return found
