"""How far each tip is from the part, frame by frame."""

from __future__ import annotations

import math

import numpy as np

from meso_robust.recordings.values import Recording, RecordingSet
from meso_robust.types import Floats

SHORTEST = 1e-9
"""Time in s that a speed is taken over at least: no camera is faster, and no speed is infinite."""

OVERLAP = 0.125
"""Of the farthest corner's distance, by which a tip may be inside the part at first: a registration, a
yaw, a scale or a delay that is wrong, which a fit is to find (a camera that is 0.15 s late shows a part
of 50 mm, pushed at 25 mm/s, 3.6 mm into the tip). Deeper, the frame is another one."""


def size(outline: Floats) -> float:
    """Square root of the area of an outline (V, 2) in m: the length that tolerances refer to."""
    x, y = outline.T
    return math.sqrt(0.5 * abs(float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))))


def gaps(outline: Floats, poses: Floats, tips: Floats, radius: float) -> Floats:
    """Distance from the surface of each tip to the outline of the part.

    Parameters
    ----------
    outline
        (V, 2) corners of a simple polygon, body frame.
    poses
        (T, 3) x, y and θ in rad, world frame.
    tips
        (T, P, 2) centres of the tips, world frame.
    radius
        Of the tips, in the unit of the lengths.

    Returns
    -------
    numpy.ndarray
        (T, P) in the unit of the lengths; negative where a tip overlaps the part, NaN where the
        pose or the tip was not seen.
    """
    away = tips - poses[:, None, :2]
    cos, sin = np.cos(poses[:, None, 2]), np.sin(poses[:, None, 2])
    x = cos * away[..., 0] + sin * away[..., 1]
    y = cos * away[..., 1] - sin * away[..., 0]
    nearest, inside = np.full(x.shape, np.inf), np.zeros(x.shape, dtype=bool)
    for (ax, ay), (bx, by) in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        ex, ey = bx - ax, by - ay
        share = np.clip(((x - ax) * ex + (y - ay) * ey) / (ex * ex + ey * ey), 0.0, 1.0)
        nearest = np.minimum(nearest, np.hypot(x - ax - share * ex, y - ay - share * ey))
        if ey != 0.0:  # even-odd rule: a ray along +x crosses the side
            inside ^= ((ay > y) != (by > y)) & (x < ax + (y - ay) * ex / ey)
    return np.where(np.isnan(x + y), np.nan, np.where(inside, -nearest, nearest)) - radius


def nearest_gap(recordings: RecordingSet, recording: Recording) -> Floats:
    """(T,) distance in m from the part to the nearest tip.

    Infinite where there are no tips; NaN where the pose was not seen, or one of the tips was not
    seen and the others do not touch: then it is unknown.
    """
    each = gaps(recordings.part.outline, recording.poses, recording.probes, recordings.tip_radius)
    if not each.shape[1]:
        return np.where(np.any(np.isnan(recording.poses), axis=1), np.nan, np.inf)
    known = np.where(np.isnan(each), np.inf, each).min(axis=1)
    return np.where(np.any(np.isnan(each), axis=1) & (known > 0.0), np.nan, known)


def margin(recordings: RecordingSet, recording: Recording) -> float:
    """Distance in m beyond which a tip is certainly free of the part.

    1/200 of the part's size (calibration of the probes, outline), or four times the scatter of the
    poses from frame to frame if that is more.

    Parameters
    ----------
    recordings
        The set: part and noise.
    recording
        One of it: its own scatter counts.

    Returns
    -------
    float
        m.
    """
    return max(0.005 * size(recordings.part.outline), 4.0 * scatter(recording.poses[:, :2]))


def scatter(values: Floats) -> float:
    """Robust standard deviation of one coordinate from the differences between frames.

    The median difference is taken off, so a steady motion does not count.

    Parameters
    ----------
    values
        (T, n) coordinates of one unit; rows with NaN are passed over. The largest of n is returned.
    """
    steps = np.diff(values[~np.any(np.isnan(values), axis=1)], axis=0)
    if not len(steps):
        return 0.0
    spread = np.median(np.abs(steps - np.median(steps, axis=0)), axis=0)
    return float(1.4826 * np.max(spread)) / math.sqrt(2.0)
