"""What is behind a probe's tip: film, and the part's own image, seen where the needle was elsewhere.

The part's image is the mean, in the part's frame, of what the pieces around a tip show of it beside
the needle. The light on a rim changes as the part turns, so that what differs beside the needle is
carried along the edge. Where the part was never seen, its edge is taken as it is beside the needle.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import cv2
import numpy as np

from meso_robust.tracking.alpha_matting import Window
from meso_robust.tracking.edge_profile import Behind, behind
from meso_robust.tracking.needle import Needle
from meso_robust.types import Flags, Floats, Image, Ints, Singles

_AROUND = 32  # px of the frame around the window that are kept
_MARGIN = 6.0  # px beside the needle that its meniscus changes
_BESIDE = (4.0, 8.0)  # px from the needle, between which the film is seen
_NOISE = 4.0  # grey values², as a camera of eight bits has it
_FILM_NEAR, _FILM_FAR = 8.0, 12.0  # px from the part; the film begins, and is all there is
_LOCAL = 100.0  # px within which a bent image counts as straight
_SEEN = 0.9  # of a pixel


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Glimpse:
    """The piece of a frame around a tip.

    Attributes
    ----------
    tip
        (2,) u, v, right to about two pixels.
    corner
        (u, v) of the first pixel.
    grey
        (h, w) grey values, those at the border repeated beyond it.
    size
        (width, height) of the frame.
    outline
        (V, 2) of the part in seen px, or None: not known.
    """

    tip: Floats
    corner: Ints
    grey: Image
    size: tuple[int, int]
    outline: Floats | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Canvas:
    """The part without needles, where it is in one frame.

    Attributes
    ----------
    mean, count
        (H, W) grey values and how many pieces they are the mean of.
    outline
        (V, 2) of the part in it, px.
    """

    mean: Singles
    count: Singles
    outline: Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Backdrop:
    """What is compared in a window around a tip.

    Attributes
    ----------
    grey
        (h, w) seen.
    relative, variance
        (h, w) brightness of what is behind over the film's, and its variance.
    used
        (h, w) 1 where something is known, else 0.
    near
        (2,) pixel that the window belongs to.
    film
        Grey value of the film beside the needle.
    """

    grey: Singles
    relative: Singles
    variance: Singles
    used: Singles
    near: Ints
    film: float


def glimpse(frame: Image, tip: Floats, window: Window, outline: Floats | None) -> Glimpse:
    """Cut the surroundings of a tip (2,) out of a frame (H, W)."""
    height, width = frame.shape
    corner = np.rint(tip).astype(np.int64) + np.array(window.low) - _AROUND
    shape = (window.shape[0] + 2 * _AROUND, window.shape[1] + 2 * _AROUND)
    return Glimpse(
        tip=np.array(tip),
        corner=corner,
        grey=_cut(frame, corner, shape),
        size=(width, height),
        outline=outline,
    )


def _cut(frame: Image, low: Ints, shape: tuple[int, int]) -> Image:
    """A copy of a piece (h, w) of a frame from (u, v) on, what lies beyond its border being as at it."""
    rows, columns = low[1] + np.arange(shape[0]), low[0] + np.arange(shape[1])
    (height, width), high = frame.shape, (rows[-1], columns[-1])
    if low.min() >= 0 and high[0] < height and high[1] < width:
        return frame[rows[0] : high[0] + 1, columns[0] : high[1] + 1].copy()
    return frame[np.ix_(np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1))]


def glimpse_at(one: Glimpse, offset: Floats) -> Glimpse:
    """The same piece with its tip moved by (2,) px."""
    return replace(one, tip=one.tip + offset)


def canvas(glimpses: Sequence[Glimpse], needle: Needle) -> Canvas | None:
    """The mean of what some pieces show beside the needle; None if none knows the part."""
    known = [(one, one.outline) for one in glimpses if one.outline is not None]
    if not known:
        return None
    width, height = known[0][0].size
    total, count = np.zeros((2, height, width), np.float32)
    outline = known[0][1]
    for one, border in known:
        low = np.array(one.corner, dtype=float)
        hidden = np.zeros(one.grey.shape, np.uint8)
        corners = _placed(needle, one.tip - low).polygon(_MARGIN, math.hypot(*one.grey.shape))
        cv2.fillPoly(hidden, [np.rint(corners * 16.0).astype(np.int32)], 1, cv2.LINE_8, 4)
        clear = (1 - hidden) * _in_frame(one.corner, one.grey.shape, one.size)
        move = _affine(border - low, outline, one.tip - low)
        first, shape = _reached(move, one.grey.shape, (width, height))
        move[:, 2] -= first
        grey = cv2.warpAffine(one.grey.astype(np.float32), move, shape, flags=cv2.INTER_CUBIC)
        free = cv2.warpAffine(clear, move, shape, flags=cv2.INTER_LINEAR) > 0.99
        where = np.s_[first[1] : first[1] + shape[1], first[0] : first[0] + shape[0]]
        total[where] += free * grey
        count[where] += free
    return Canvas(
        mean=(total / np.maximum(count, 1.0)).astype(np.float32), count=count, outline=outline
    )


def _reached(
    move: Floats, shape: tuple[int, ...], size: tuple[int, int]
) -> tuple[Ints, tuple[int, int]]:
    """First pixel (u, v), and width and height, of what a moved piece can reach in a frame."""
    ends = np.array([[0, 0], [shape[1], 0], [0, shape[0]], [shape[1], shape[0]]])
    there = ends @ move[:, :2].T + move[:, 2]
    limit = np.array(size)
    first = np.clip(np.floor(there.min(axis=0)).astype(int) - 1, 0, limit - 1)
    last = np.clip(np.ceil(there.max(axis=0)).astype(int) + 2, first + 1, limit)
    return first, (int(last[0] - first[0]), int(last[1] - first[1]))


def backdrop(one: Glimpse, window: Window, needle: Needle, part: Canvas | None) -> Backdrop:
    """What is behind a tip.

    Parameters
    ----------
    one
        The piece around it.
    window
        Of the pixels that are compared.
    needle
        Its shape and direction.
    part
        The part without needles, as far as it is known.
    """
    from meso_robust.tracking.needle_kernels import film_beside

    first = one.corner + _AROUND
    inner = np.s_[_AROUND : _AROUND + window.shape[0], _AROUND : _AROUND + window.shape[1]]
    seen = np.ascontiguousarray(one.grey[inner])
    film = film_beside(seen, _placed(needle, one.tip - first).drawn(), *_BESIDE)
    film = max(film, 1.0)
    grey = seen.astype(np.float32)
    relative, variance = np.ones_like(grey), np.zeros_like(grey)
    used = _in_frame(first, window.shape, one.size)
    if one.outline is not None:
        here, outline = _placed(needle, one.tip - one.corner), one.outline - one.corner
        edge = behind(one.grey, outline, _places(window), here)
        used[_within_part(outline - _AROUND, edge, window.shape)] = 0.0
        if edge is not None:
            change, spread = edge.here()
            if part is not None:
                _refine(change, spread, edge, one, part, window, outline)
            relative.ravel()[edge.rows] += change / film
            variance.ravel()[edge.rows] = spread * _NOISE / film**2
    return Backdrop(
        grey=grey,
        relative=relative,
        variance=variance,
        used=used,
        near=first - np.array(window.low),
        film=film,
    )


def beyond(scene: Backdrop, one: Glimpse, least: float) -> Backdrop:
    """What is compared without what lies nearer to the part than some px."""
    if one.outline is None or least <= 0.0:
        return scene
    near = np.zeros(scene.used.shape, np.uint8)
    corners = [np.rint((one.outline - one.corner - _AROUND) * 16.0).astype(np.int32)]
    cv2.fillPoly(near, corners, 1, cv2.LINE_8, 4)
    cv2.polylines(near, corners, True, 1, max(round(2.0 * least), 1), cv2.LINE_8, 4)
    return replace(scene, used=scene.used * (near == 0))


@lru_cache(8)  # the same for all frames of a film
def _places(window: Window) -> Floats:
    """(N, 2) places of a window's pixels in the piece around it."""
    v, u = np.mgrid[: window.shape[0], : window.shape[1]].astype(float) + _AROUND
    return np.stack([u.ravel(), v.ravel()], axis=1)


def _refine(
    change: Floats,
    spread: Floats,
    edge: Behind,
    one: Glimpse,
    part: Canvas,
    window: Window,
    outline: Floats,
) -> None:
    """Replace the edge's mean by the part's own image where that was seen, in place."""
    from meso_robust.tracking.fit_kernels import owned

    move = _affine(outline, part.outline, one.tip - one.corner)
    shape, back = (one.grey.shape[1], one.grey.shape[0]), cv2.WARP_INVERSE_MAP
    own = cv2.warpAffine(part.mean, move, shape, flags=cv2.INTER_CUBIC | back)
    count = cv2.warpAffine(part.count, move, shape, flags=cv2.INTER_LINEAR | back)
    differs = np.where(count > _SEEN, one.grey - own, np.float32(0.0))
    at = _places(window)[edge.rows].astype(int)
    ends = (_FILM_NEAR, _FILM_FAR, _SEEN)
    owned((own, count), at, edge.distance, edge.of(differs).here(), ends, (change, spread))


def _placed(needle: Needle, tip: Floats) -> Needle:
    return replace(needle, tip=(float(tip[0]), float(tip[1])))


def _in_frame(first: Ints, shape: tuple[int, ...], size: tuple[int, int]) -> Singles:
    """(h, w) 1 where pixels from ``first`` (u, v) on are not repeated ones, nor at the border, else 0."""
    used = np.zeros(shape, np.float32)
    low, high = np.maximum(1 - first, 0), np.maximum(np.array(size) - 1 - first, 0)
    used[low[1] : high[1], low[0] : high[0]] = 1.0
    return used


def _within_part(outline: Floats, edge: Behind | None, shape: tuple[int, int]) -> Flags:
    """(h, w) what lies in the part, away from its edge, whose brightness there is not known."""
    inside = np.zeros(shape, np.uint8)
    corners = [np.rint(outline * 16.0).astype(np.int32)]
    cv2.fillPoly(inside, corners, 1, cv2.LINE_8, 4)
    if edge is not None:
        cv2.polylines(inside, corners, True, 0, 19, cv2.LINE_8, 4)
    return np.asarray(inside != 0)


def _affine(source: Floats, target: Floats, about: Floats) -> Floats:
    """(2, 3) map of an image that carries one outline to another, best near a place of the first."""
    from meso_robust.tracking.fit_kernels import carried

    return carried(source, target, about, _LOCAL)
