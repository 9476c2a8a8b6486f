"""Needles in the first frames: around a stated tip, or by what moves in from the image's border."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import cv2
import numpy as np
from scipy import ndimage

from meso_robust.errors import InputError
from meso_robust.tracking.needle import Needle, nearest_needle
from meso_robust.types import Floats, Image

SPREAD = 24
"""Frames between which motion is looked for."""
_TAPER = 0.08  # rad; usual for etched tungsten needles, refined by the fit
_NEAR, _FAR = 6.0, 50.0  # px along a shaft that are compared with what is beside it
_SATURATION = 6.0  # grey values by which it differs that count half
_LEAST_LENGTH = 25.0  # px of shaft in the image
_WIDEST = 70  # px; of a shaft at the border
_DARKER = 0.12  # of the brightness beside it
_INSET = 3  # px from the border, where no filter meets it
_STEP, _MOST_STEPS = 2.0, 500  # px along a shaft that is followed
_ANGLES = np.radians(np.arange(0.0, 360.0, 3.0))


def needle_at(frame: Image, tip: Floats, radius: float, direction: float | None = None) -> Needle:
    """The needle whose tip is near a place.

    Parameters
    ----------
    frame
        (H, W) grey values.
    tip
        (2,) u, v in px, right to about five pixels.
    radius
        Of the tip, px.
    direction
        Of the shaft away from the tip, from +u to +v, if it is known.

    Returns
    -------
    Needle
        Tip and shaft as fitted.

    Raises
    ------
    InputError
        The place is outside the image.
    """
    size = np.array(frame.shape[::-1])
    if np.any(tip < 0.0) or np.any(tip > size - 1.0):
        raise InputError(
            f"--probe: the tip at ({tip[0]:.0f}, {tip[1]:.0f}) px is outside the image of "
            f"{size[0]} x {size[1]} px; give a place inside"
        )
    smooth = np.asarray(cv2.GaussianBlur(frame, (0, 0), 1.0), np.uint8)
    if direction is None:
        direction = max(_ANGLES.tolist(), key=lambda angle: _standing_out(smooth, tip, angle))
    axis = np.array([math.cos(direction), math.sin(direction)])
    aside = np.array([-axis[1], axis[0]])
    starts = [
        Needle(
            tip=(float(place[0]), float(place[1])),
            direction=direction,
            taper=_TAPER,
            radius=radius,
        )
        for along in (0.0, -2.0, 2.0, -4.0, 4.0, -6.0, 6.0)
        for across in (0.0, -2.0, 2.0)
        for place in (tip + along * axis + across * aside,)
    ]
    return nearest_needle(frame.astype(float), starts)


def moving_needles(frames: Sequence[Image], radius: float) -> list[Needle]:
    """Needles in the first of some frames that reach in from the border and whose tips move later.

    Parameters
    ----------
    frames
        (H, W) grey values; the more they are apart in time, the slower a probe may be.
    radius
        Of the tips, px.

    Returns
    -------
    list of Needle
        From left to right, then downwards.
    """
    if len(frames) < 2:
        return []
    smooth = np.asarray(cv2.GaussianBlur(frames[0], (0, 0), 1.5), np.uint8)
    changes = [cv2.absdiff(frames[0], frame) for frame in frames[1:]]
    moved = np.asarray(cv2.GaussianBlur(np.maximum.reduce(changes), (0, 0), 1.5), np.uint8)
    still = float(np.median(moved))
    found: list[Needle] = []
    for entry in _entries(smooth):
        traced = _traced(smooth, entry)
        if traced is None:
            continue
        tip, direction = traced
        u, v = np.rint(tip).astype(int).tolist()
        near = moved[max(v - 8, 0) : v + 9, max(u - 8, 0) : u + 9]
        if float(near.max()) < max(2.0 * still, still + 8.0):
            continue
        needle = needle_at(frames[0], tip, radius, direction)
        known = [np.hypot(*(np.array(needle.tip) - np.array(other.tip))) for other in found]
        if min(known, default=math.inf) > 10.0:
            found.append(needle)
    return sorted(found, key=lambda needle: needle.tip)


def _entries(smooth: Image) -> list[tuple[Floats, Floats, float]]:
    """Where something dark and narrow crosses the border: middle, direction inward, width."""
    height, width = smooth.shape
    right, down = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    lines = (  # brightness along a border, a place on it, the direction along it and inward
        (smooth[_INSET], _INSET * down, right, down),
        (smooth[-1 - _INSET], (height - 1 - _INSET) * down, right, -down),
        (smooth[:, _INSET], _INSET * right, down, right),
        (smooth[:, -1 - _INSET], (width - 1 - _INSET) * right, down, -right),
    )
    entries = []
    for line, origin, along, inward in lines:
        level = line.astype(float)
        around = ndimage.median_filter(level, size=_WIDEST * 2 + 1, mode="nearest")
        dark = np.concatenate(([False], around - level > _DARKER * around, [False]))
        edges = np.flatnonzero(np.diff(dark.astype(int)))
        for start, stop in _runs(edges.reshape(-1, 2).tolist()):
            if 3 <= stop - start <= _WIDEST:
                middle = origin + 0.5 * (start + stop - 1) * along
                entries.append((middle, inward, float(stop - start)))
    return entries


def _runs(dark: list[list[int]]) -> list[tuple[int, int]]:
    """Dark runs, and before them pairs of neighbours: both sides of a shaft that shines between."""
    pairs = [
        (a[0], b[1]) for a, b in pairwise(dark) if b[0] - a[1] <= max(a[1] - a[0], b[1] - b[0])
    ]
    return [*pairs, *((a, b) for a, b in dark)]


def _traced(smooth: Image, entry: tuple[Floats, Floats, float]) -> tuple[Floats, float] | None:
    """Tip and direction (away from it) of a shaft that is followed from the border inward."""
    centre, inward, width = entry
    path = [np.asarray(centre, dtype=float)]
    axis = inward
    contrast = None
    while len(path) < _MOST_STEPS:
        ahead = path[-1] + _STEP * axis
        if np.any(ahead < 0.0) or np.any(ahead > np.array(smooth.shape[::-1]) - 1.0):
            return None  # it crosses the image
        across = np.array([-axis[1], axis[0]])
        reach = np.arange(-width - 6.0, width + 6.5, 0.5)
        profile = _sampled(smooth, ahead + reach[:, None] * across)
        beside = 0.5 * (np.median(profile[:8]) + np.median(profile[-8:]))
        depth = np.maximum(beside - profile, 0.0)
        depth[depth < 0.4 * depth.max()] = 0.0
        core = depth > 0.0
        deep = float(depth.max())
        if contrast is None:
            contrast = deep
        if deep < 0.4 * contrast or core.sum() * 0.5 > 1.6 * width + 4.0:
            break
        # the best of a short range of contrasts: the shaft is sharper, hence darker, near the tip
        contrast = max(contrast, 0.7 * deep)
        path.append(ahead + float(depth @ reach) / float(depth.sum()) * across)
        width = min(width, 0.5 * float(np.ptp(np.flatnonzero(core))) + 2.0)
        chord = path[-1] - path[max(0, len(path) - 10)]
        if len(path) > 3:
            axis = chord / np.hypot(*chord)
    if len(path) * _STEP < _LEAST_LENGTH:
        return None
    last = np.array(path[len(path) // 2 :])
    chord = last[-1] - last[0]
    return path[-1], math.atan2(-chord[1], -chord[0])


def _standing_out(smooth: Image, tip: Floats, angle: float) -> float:
    """How much darker or brighter a ray from the tip is than both its sides."""
    axis = np.array([math.cos(angle), math.sin(angle)])
    aside = np.array([-axis[1], axis[0]])
    along = np.arange(_NEAR, _FAR, 1.0)
    flank = 5.0 + 0.12 * along
    inside = _sampled(smooth, tip + along[:, None] * axis)
    left = _sampled(smooth, tip + along[:, None] * axis + flank[:, None] * aside)
    right = _sampled(smooth, tip + along[:, None] * axis - flank[:, None] * aside)
    # the nearer of the two sides in brightness: a ray along the part's edge differs from one only
    differs = np.minimum(np.abs(left - inside), np.abs(right - inside))
    # saturated: a shaft differs all along its length, a scratch of the part more, but for a while
    share = differs / (differs + _SATURATION)
    return float(abs(np.mean(share * np.sign((left - inside) * (right - inside)))))


def _sampled(image: Image, points: Floats) -> Floats:
    """Grey values at the pixels nearest to (N, 2) points, those at the border beyond it."""
    at = np.rint(points).astype(int)
    at = np.clip(at, 0, np.array(image.shape[::-1]) - 1)
    return image[at[:, 1], at[:, 0]].astype(float)
