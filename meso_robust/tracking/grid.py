"""Points of a stage grid in an image: corners of a chessboard or centres of dots, with their indices.

Corners are saddle points of the grey values, refined by `cv2.cornerSubPix`; dots are blobs, refined as
centroids of their contrast. Both are ordered by walking from point to neighbouring point, so that the
grid may be turned, distorted and cut by the border of the image.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from meso_robust.errors import InputError
from meso_robust.types import Flags, Floats, Image, Ints

LEAST_POINTS = 12
"""Fewer would leave nothing to judge the fit by."""
_AROUND = 16  # places around a corner, opposite ones compared
_UNEVEN = 0.5  # of the contrast there
_SMOOTHING = 2.0  # px; noise must not make saddles, squares are much larger
_REACH = 0.3  # of the pitch; how far a neighbour may lie from where it is expected
_ROUND = 0.8  # least share of its enclosing circle that a dot fills; a square fills 0.64


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GridPoints:
    """What was found.

    Attributes
    ----------
    kind
        "chessboard" or "dots".
    seen
        (N, 2) u, v in px.
    index
        (N, 2) integers: steps along the grid, the first nearly along +u, the second nearly along
        −v (up).
    radius
        Of the dots, px; 0 for corners.
    """

    kind: str
    seen: Floats
    index: Ints
    radius: float = 0.0


def find_grid(image: Image) -> GridPoints:
    """Find the grid in a grey image (H, W).

    Raises
    ------
    InputError
        No grid with at least twelve points is there.
    """
    found = [
        _ordered("chessboard", _corners(image)),
        _ordered("dots", *_dots(image)),
    ]
    best = max(found, key=lambda grid: len(grid.seen))
    if len(best.seen) < LEAST_POINTS:
        raise InputError(
            f"--grid: {len(best.seen)} points of a chessboard or dot grid found; must be at least "
            f"{LEAST_POINTS}; give a sharp image that shows more of the grid"
        )
    return best


def _corners(image: Image) -> Floats:
    """(N, 2) saddle points, sub-pixel."""
    smooth = cv2.GaussianBlur(image.astype(np.float32), (0, 0), _SMOOTHING)
    xx, yy = cv2.Sobel(smooth, cv2.CV_32F, 2, 0), cv2.Sobel(smooth, cv2.CV_32F, 0, 2)
    xy = cv2.Sobel(smooth, cv2.CV_32F, 1, 1)
    saddle = np.maximum(xy**2 - xx * yy, 0.0)
    peak = (saddle == cv2.dilate(saddle, np.ones((9, 9), np.uint8))) & (
        saddle > 0.2 * np.percentile(saddle[saddle > 0.1 * saddle.max()], 90)
        if saddle.max() > 0.0
        else False
    )
    margin = 6
    peak[:margin] = peak[-margin:] = False
    peak[:, :margin] = peak[:, -margin:] = False
    rough = np.argwhere(peak)[:, ::-1].astype(np.float32)
    if not len(rough):
        return np.empty((0, 2))
    half = int(np.clip(_spacing(rough.astype(float)) / 4.0, 3, 10))
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_COUNT, 60, 1e-4)
    fine = cv2.cornerSubPix(image, rough.reshape(-1, 1, 2).copy(), (half, half), (-1, -1), stop)
    fine = fine.reshape(-1, 2)
    inside = np.all((fine >= half) & (fine < np.array(image.shape[::-1]) - half), axis=1)
    kept = fine[inside & (np.abs(fine - rough).max(axis=1) < half)]
    corners = kept.astype(float)
    return corners[_alike_opposite(smooth, corners, 1.4 * half)]


def _alike_opposite(smooth: npt.NDArray[Any], points: Floats, reach: float) -> Flags:
    """(N,) whether a corner looks alike after half a turn; one on the rim of a board does not."""
    if not len(points):
        return np.zeros(0, dtype=bool)
    angles = np.linspace(0.0, 2.0 * np.pi, _AROUND, endpoint=False)
    around = points[:, None] + reach * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    u, v = (np.ascontiguousarray(around[..., k], dtype=np.float32) for k in range(2))
    grey = cv2.remap(smooth, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    uneven = np.abs(grey - np.roll(grey, _AROUND // 2, axis=1)).max(axis=1)
    return np.asarray(uneven < _UNEVEN * np.ptp(grey, axis=1))


def _spacing(points: Floats) -> float:
    """Median distance to the nearest other point, px."""
    if len(points) < 2:
        return 0.0
    gaps = np.linalg.norm(points[:, None] - points[None], axis=-1)
    np.fill_diagonal(gaps, np.inf)
    return float(np.median(gaps.min(axis=1)))


def _dots(image: Image) -> tuple[Floats, float]:
    """(N, 2) centres of round blobs, dark on bright or bright on dark, and their radius, px."""
    smooth = cv2.GaussianBlur(image, (0, 0), 1.0)
    _, bright = cv2.threshold(smooth, 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)
    sets = [_blobs(image, np.asarray(mask, np.uint8)) for mask in (bright, 255 - bright)]
    best = max(sets, key=len)
    return best[:, :2], float(np.median(best[:, 2])) if len(best) else 0.0


def _blobs(image: Image, mask: Image) -> Floats:
    outlines, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    found = [centre for outline in outlines if (centre := _blob(image, np.asarray(outline)))]
    return np.array(found).reshape(-1, 3)


def _blob(image: Image, outline: npt.NDArray[np.int32]) -> tuple[float, float, float] | None:
    """Centroid and radius of the contrast of a round blob; None if it is not round, small or at the border."""
    _, radius = cv2.minEnclosingCircle(outline)
    # the outline runs through the centres of the border's pixels, half a pixel inside
    area = cv2.contourArea(outline) + 0.5 * cv2.arcLength(outline, True)
    u, v, width, height = cv2.boundingRect(outline)
    space = max(3, round(0.3 * radius))
    low, high = (u - space, v - space), (u + width + space, v + height + space)
    rows, columns = image.shape
    if min(low) < 0 or high[0] > columns or high[1] > rows:
        return None
    if radius < 2.0 or area < _ROUND * np.pi * (radius + 0.5) ** 2:
        return None
    piece = image[low[1] : high[1], low[0] : high[0]].astype(float)
    v_at, u_at = np.mgrid[low[1] : high[1], low[0] : high[0]]
    far = np.hypot(u_at - (u + 0.5 * (width - 1)), v_at - (v + 0.5 * (height - 1)))
    ring = (far > radius + 2.0) & (far <= radius + space + 1.0)
    weight = (piece - np.median(piece[ring])) * (far <= radius + 2.0)
    total = weight.sum()
    centre = float((weight * u_at).sum() / total), float((weight * v_at).sum() / total)
    return *centre, float(np.sqrt(area / np.pi))


def _ordered(kind: str, points: Floats, radius: float = 0.0) -> GridPoints:
    """The largest set of points that neighbours lead to, with their indices."""
    if len(points) < LEAST_POINTS:
        return GridPoints(kind=kind, seen=points[:0], index=np.empty((0, 2), np.int64))
    middle = np.median(points, axis=0)
    starts = np.argsort(np.linalg.norm(points - middle, axis=1))[:5]
    walks = [_walk(points, int(start)) for start in starts]
    best = max(walks, key=len)
    kept = np.array(sorted(best), dtype=np.int64)
    index = np.array([best[k] for k in kept.tolist()], dtype=np.int64).reshape(-1, 2)
    return GridPoints(kind=kind, seen=points[kept], index=index, radius=radius)


def _walk(points: Floats, start: int) -> dict[int, tuple[int, int]]:
    """Index of every point that can be reached from one, from neighbour to neighbour."""
    gaps = np.linalg.norm(points - points[start], axis=1)
    gaps[start] = np.inf
    along = points[int(np.argmin(gaps))] - points[start]
    # of the four directions of the grid, the one nearest to +u
    quarters = [along, np.array([along[1], -along[0]]), -along, np.array([-along[1], along[0]])]
    first = max(quarters, key=lambda step: float(step[0]))
    second = np.array([first[1], -first[0]])  # a quarter turn, to −v
    found = {start: (0, 0)}
    taken = {(0, 0)}
    queue = [(start, first, second)]
    while queue:
        at, first, second = queue.pop(0)
        i, j = found[at]
        for di, dj in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            step = di * first + dj * second
            gaps = np.linalg.norm(points - (points[at] + step), axis=1)
            near = int(np.argmin(gaps))
            where = (i + di, j + dj)
            if gaps[near] > _REACH * np.linalg.norm(step) or near in found or where in taken:
                continue
            found[near] = where
            taken.add(where)
            queue.append((near, *_bent(first, second, points[near] - points[at], (di, dj))))
    return found


def _bent(
    first: Floats, second: Floats, step: Floats, by: tuple[int, int]
) -> tuple[Floats, Floats]:
    """The two directions of the grid one step further on, where the lens bends them."""
    if by[0]:
        return 0.5 * (first + by[0] * step), second
    return first, 0.5 * (second + by[1] * step)
