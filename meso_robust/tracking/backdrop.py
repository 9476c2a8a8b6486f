"""What is behind a probe's tip: film, and the part's own image, seen where the needle was elsewhere.

The part's image is the mean, in the part's frame, of what the pieces around a tip show of it beside
the needle. The light on a rim changes as the part turns, so that what differs beside the needle is
carried along the edge. Where the part was never seen, its edge is taken as it is beside the needle.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from meso_robust.tracking.alpha_matting import Window
from meso_robust.tracking.edge_profile import Behind, behind
from meso_robust.tracking.needle import Needle
from meso_robust.types import Flags, Floats, Image, Ints, Singles

_AROUND = 32  # px of the frame around the window that are kept
_MARGIN = 6.0  # px beside the needle that its meniscus changes
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
    rows = np.clip(corner[1] + np.arange(window.shape[0] + 2 * _AROUND), 0, height - 1)
    columns = np.clip(corner[0] + np.arange(window.shape[1] + 2 * _AROUND), 0, width - 1)
    return Glimpse(
        tip=np.array(tip),
        corner=corner,
        grey=frame[np.ix_(rows, columns)],
        size=(width, height),
        outline=outline,
    )


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
        clear = (1.0 - hidden) * _in_frame(one)
        move = _affine(border - low, outline, one.tip - low)
        first, shape = _reached(move, one.grey.shape, (width, height))
        move[:, 2] -= first
        grey = cv2.warpAffine(one.grey.astype(np.float32), move, shape, flags=cv2.INTER_CUBIC)
        free = cv2.warpAffine(clear.astype(np.float32), move, shape, flags=cv2.INTER_LINEAR) > 0.99
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
    here = _placed(needle, one.tip - one.corner)
    inner = np.s_[_AROUND : _AROUND + window.shape[0], _AROUND : _AROUND + window.shape[1]]
    v, u = np.mgrid[inner].astype(float)
    grey = one.grey[inner].astype(np.float32)
    distance = here.distance(*here.along_across(u, v))
    film = float(np.median(grey[(distance > 4.0) & (distance < 8.0)]))
    film = max(film, 1.0)
    relative, variance = np.ones_like(grey), np.zeros_like(grey)
    used = _in_frame(one)[inner].astype(np.float32)
    if one.outline is not None:
        outline = one.outline - one.corner
        places = np.stack([u.ravel(), v.ravel()], axis=1)
        edge = behind(one.grey, outline, places, here)
        used *= _known(outline, edge, one.grey.shape)[inner]
        if edge is not None:
            change, spread = edge.here()
            if part is not None:
                _refine(change, spread, edge, one, part, here, places, outline)
            relative.ravel()[edge.rows] += change / film
            variance.ravel()[edge.rows] = spread * _NOISE / film**2
    return Backdrop(
        grey=grey,
        relative=relative,
        variance=variance,
        used=used,
        near=one.corner + _AROUND - np.array(window.low),
        film=film,
    )


def _refine(
    change: Singles,
    spread: Singles,
    edge: Behind,
    one: Glimpse,
    part: Canvas,
    needle: Needle,
    places: Floats,
    outline: Floats,
) -> None:
    """Replace the edge's mean by the part's own image where that was seen, in place."""
    move = _affine(outline, part.outline, np.array(needle.tip))
    shape, back = (one.grey.shape[1], one.grey.shape[0]), cv2.WARP_INVERSE_MAP
    own = cv2.warpAffine(part.mean, move, shape, flags=cv2.INTER_CUBIC | back)
    count = cv2.warpAffine(part.count, move, shape, flags=cv2.INTER_LINEAR | back)
    differs = np.where(count > _SEEN, one.grey - own, 0.0).astype(np.float32)
    at = places[edge.rows].astype(int)
    mean, seen = own[at[:, 1], at[:, 0]], count[at[:, 1], at[:, 0]]
    film = (edge.distance > _FILM_FAR - 3.0) & (seen > _SEEN)
    if film.sum() < 6:
        return
    light, rest = edge.of(differs).here()
    ends = np.clip((_FILM_FAR - edge.distance) / (_FILM_FAR - _FILM_NEAR), 0.0, 1.0)
    good = seen > _SEEN
    better = ends * (mean + light - np.median(mean[film]))
    change[good] = better[good]
    spread[good] = (rest + 1.25 / np.maximum(seen, 1.0))[good]


def _placed(needle: Needle, tip: Floats) -> Needle:
    return replace(needle, tip=(float(tip[0]), float(tip[1])))


def _in_frame(one: Glimpse) -> Flags:
    """(h, w) which pixels are not repeated ones."""
    v, u = np.mgrid[: one.grey.shape[0], : one.grey.shape[1]]
    u, v = u + one.corner[0], v + one.corner[1]
    return np.asarray((u >= 1) & (u < one.size[0] - 1) & (v >= 1) & (v < one.size[1] - 1))


def _known(outline: Floats, edge: Behind | None, shape: tuple[int, ...]) -> Singles:
    """(h, w) 0 in the part, away from its edge, whose brightness there is not known."""
    inside = np.zeros(shape[:2], np.uint8)
    cv2.fillPoly(inside, [np.rint(outline * 16.0).astype(np.int32)], 1, cv2.LINE_8, 4)
    if edge is not None:
        rim = np.zeros(shape[:2], np.uint8)
        cv2.polylines(rim, [np.rint(outline * 16.0).astype(np.int32)], True, 1, 19, cv2.LINE_8, 4)
        inside[rim > 0] = 0
    return (1.0 - inside).astype(np.float32)


def _affine(source: Floats, target: Floats, about: Floats) -> Floats:
    """(2, 3) map of an image that carries one outline to another, best near a place of the first."""
    weight = 1.0 / (1.0 + (np.hypot(*(source - about).T) / _LOCAL) ** 2)
    points = np.column_stack([source, np.ones(len(source))]) * weight[:, None]
    return np.asarray(np.linalg.lstsq(points, target * weight[:, None], rcond=None)[0].T)
