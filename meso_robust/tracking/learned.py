"""The learned image of a needle, and registration of frames to it.

A needle moves without turning, so that its image only shifts. Each frame is registered to the mean of
many by least squares (Gauss-Newton, iteratively reweighted; Baker and Matthews, "Lucas-Kanade 20 years
on", doi:10.1023/B:VISI.0000011205.11775.fd). The brightness of the needle, and that of the film on
either side of it along the shaft, are free: what lies behind is not known.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np

from meso_robust.tracking.edge_profile import behind
from meso_robust.tracking.needle import Needle, alone, coverage, fit_needle
from meso_robust.types import Flags, Floats, Image, Ints, Singles

LEARNED = 40
"""Frames that the image of a needle is the mean of."""
_LENGTH = 110.0  # px of shaft that are followed
_BESIDE, _AHEAD = 4.5, 7.0  # px of film beside and ahead of the needle
_SEGMENT = 30.0  # px along the shaft within which the film's brightness changes evenly
_HALOS = 1.5, 4.0  # px from the needle, over which its meniscus fades
_CLEAR = 4  # power of what shows of the film that makes it film
_ROUNDS = 3  # of leaving out dust
_TUKEY, _LEAST_LEFT = 7.0, 0.3  # medians of what is left at which weights vanish; grey values
_EDGE = 8  # px; the part's rim and meniscus reach as far
_SMALL = 0.015  # px, step that ends Gauss-Newton
_LEAST_SCORE = 0.6
_LEAST_GAIN = 0.2  # brightness of the needle over the learned one
_LEAST_PIXELS = 150.0
_SEARCH = 40  # px around the last place, when lost
_LEAST_APART = 1.0  # px between two fits of a tip that are worth a word
_LIMITS = (_LEAST_PIXELS, _SMALL, _LEAST_GAIN)
_NONE = np.empty(0, np.int64)
_NO_EDGE = (_NONE, np.empty(0), np.empty((0, 2)), _NONE, np.empty((0, 2, 2)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Tip:
    """A probe in a frame.

    Attributes
    ----------
    found
        Whether it can be trusted.
    shift
        (2,) px from the learned image; NaN when not found.
    covariance
        (2, 2) of the shift, px².
    reason
        Why it is not found.
    score
        Share of the brightness's variance that the learned image explains.
    """

    found: bool
    shift: Floats
    covariance: Floats
    reason: str
    score: float


def lost(reason: str, score: float = 0.0) -> Tip:
    """A probe that was not found."""
    nothing, spread = np.full(2, math.nan), np.full((2, 2), math.nan)
    return Tip(found=False, shift=nothing, covariance=spread, reason=reason, score=score)


class Learned:
    """A piece of the first frame around a needle, then the mean of many.

    Parameters
    ----------
    frame
        (H, W) grey values.
    needle
        Where it is in it.
    outline
        (V, 2) border of the part in seen px, or None: pixels near it are learned later.
    """

    def __init__(self, frame: Image, needle: Needle, outline: Floats | None) -> None:
        self.needle = needle
        self.frames = 0
        corridor = needle.polygon(_BESIDE + 2.0, _LENGTH)
        height, width = frame.shape
        low = np.clip(np.floor(corridor.min(axis=0)), 0, (width - 1, height - 1)).astype(int)
        high = np.clip(np.ceil(corridor.max(axis=0)) + 1, low + 1, (width, height)).astype(int)
        self.corner = low
        self.shape = (int(high[1] - low[1]), int(high[0] - low[0]))
        v, u = np.mgrid[: self.shape[0], : self.shape[1]].astype(float)
        s, n = needle.along_across(u + low[0], v + low[1])
        distance = needle.distance(s, n)
        inside = (s < _LENGTH) & (distance < np.where(s < 0.0, _AHEAD, _BESIDE))
        self._rows = np.flatnonzero(inside.ravel())
        self._pixels = np.stack(np.nonzero(inside)[::-1], axis=1) + low
        self._places = self._pixels.astype(float)
        self._beside = _neighbours(inside)
        clear = 1.0 - coverage(needle, low.astype(float), self.shape)
        self._clear = clear.ravel()[self._rows].astype(np.float32)
        down, right = np.gradient(clear)
        self._fading = np.stack([right.ravel(), down.ravel()], axis=1)[self._rows]
        self._film = _film_basis(clear, s, n)[:, inside]
        self._film = self._film[np.abs(self._film).sum(axis=1) > 1.0]
        away = np.maximum(distance[inside], 0.0)
        self._halo = np.stack([np.ones(len(away)), *(np.exp(-away / reach) for reach in _HALOS)])
        self._grey = frame[low[1] : high[1], low[0] : high[0]].astype(np.float32)
        self._counts = np.zeros(self.shape, np.float32)
        self._seen = self._free_of(outline, np.zeros(2))
        self._known = self._rows_of(self._seen)
        self._drawn = np.zeros(self.shape, np.bool_)
        if not self._known.all():
            self._draw()
        self._slopes()

    def register(self, frame: Image, start: Floats, outline: Floats | None) -> Tip:
        """Shift of the needle in a frame, from a start (2,)."""
        from meso_robust.tracking.fit_kernels import registered

        if not self._tip_inside(frame, start):
            return lost("the tip is outside the image")
        scene = behind(frame, outline, self._places + start, self.needle.moved(start))
        edge = _NO_EDGE if scene is None else (
            scene.rows, scene.distance, scene.normals, scene.edge, scene.profiles
        )  # fmt: skip
        needle = (self._pixels, self._columns, self._clear, self._fading, self._known, self._beside)
        shift, covariance = np.array(start, dtype=float), np.empty((2, 2))
        visible, step, score = registered(frame, needle, edge, _LIMITS, shift, covariance)
        if visible < _LEAST_PIXELS:
            return lost("too little of the needle is visible")
        if not self._tip_inside(frame, shift):
            return lost("the tip is outside the image")
        if step >= 10.0 * _SMALL or np.abs(shift - start).max() > 1.5 * _SEARCH:
            return lost("the needle does not match its learned image")
        if score < _LEAST_SCORE:
            return lost("the needle does not look as learned", score)
        # the mean of so many frames has noise of its own
        covariance *= 1.0 + 1.0 / max(self.frames, 1)
        return Tip(found=True, shift=shift, covariance=covariance, reason="", score=score)

    def search(self, frame: Image, around: Floats) -> Floats:
        """Shift (2,) of the best match of the tip's surroundings, to a pixel."""
        at = np.rint(np.array(self.needle.tip)).astype(int) - self.corner
        low = np.clip(at - 14, 0, None)
        high = np.minimum(at + 15, self.shape[::-1])
        piece = np.ascontiguousarray(self._grey[low[1] : high[1], low[0] : high[0]])
        want = self.corner + low + np.rint(around).astype(int)
        first = np.clip(want - _SEARCH, 0, None)
        last = np.minimum(want + np.array(piece.shape[::-1]) + _SEARCH, frame.shape[::-1])
        window = frame[first[1] : last[1], first[0] : last[0]].astype(np.float32)
        if min(piece.shape) < 3 or np.any(np.array(window.shape) < np.array(piece.shape)):
            return around
        match = cv2.matchTemplate(window, piece, cv2.TM_CCOEFF_NORMED)
        best = np.array(cv2.minMaxLoc(match)[3])
        return np.asarray(first + best - self.corner - low, dtype=float)

    def learn(self, frame: Image, tip: Tip, outline: Floats | None) -> None:
        """Add a frame to the mean, while there are not enough."""
        if self.frames >= LEARNED:
            return
        self.frames += 1
        grey, inside = self._sampled(frame, tip.shift)
        new = inside & self._free_of(outline, tip.shift)
        self._counts += new
        share = new / np.maximum(self._counts, 1.0)
        self._grey += (share * (grey - self._grey)).astype(np.float32)
        self._see(self._counts > 0.0)
        if self.frames in (1, 2, 5, 10, 20, LEARNED):
            self._slopes()

    def anchor(self) -> tuple[Floats, Floats, str]:
        """Place (2,) of the tip in the learned image, its covariance (2, 2), and a remark or ""."""
        v, u = np.mgrid[: self.shape[0], : self.shape[1]].astype(float)
        tip = self.needle.tip
        near = np.hypot(u + self.corner[0] - tip[0], v + self.corner[1] - tip[1])
        free = float(self._seen[near < self.needle.radius + 3.0].mean()) > 0.9
        used = self._seen.astype(float) if free else None
        fit = fit_needle(self._grey.astype(float), self.corner.astype(float), self.needle, used)
        axis = fit.needle.axis
        place = np.array(fit.needle.tip)
        apart = place - np.array(tip)
        covariance = fit.covariance + _systematic(axis)
        if math.hypot(*apart) > _LEAST_APART:  # something beside the tip, such as dust, draws a fit
            covariance = covariance + np.outer(apart, apart)
            remark = (
                f"its tip in the first frame and in the mean differ by {math.hypot(*apart):.1f} px"
            )
            return place, covariance, remark
        if free:
            return place, covariance, ""
        # against the part's edge the end of the tip is not told apart from it
        covariance = covariance + np.outer(axis, axis)
        return place, covariance, "never seen free of the part"

    def _draw(self) -> None:
        """Put the needle as it was fitted where the part was too near to see it.

        Its flanks alone, which hardly change along it, hold it where the film behind was learned.
        """
        model, there = alone(
            self._grey.astype(float), self.corner.astype(float), self.needle, self._seen
        )
        self._drawn = there & ~self._seen
        self._grey[self._drawn] = model[self._drawn]
        self._known = self._rows_of(self._seen | self._drawn)

    def _rows_of(self, flags: Flags) -> Flags:
        """(N,) of flags (h, w), those of the pixels that are followed."""
        return np.asarray(flags.ravel()[self._rows])

    def _see(self, seen: Flags) -> None:
        """Note which pixels (h, w) are known."""
        self._seen, self._known = seen, self._rows_of(seen | self._drawn)

    def _tip_inside(self, frame: Image, shift: Floats) -> bool:
        place = np.array(self.needle.tip) + shift
        return bool(np.all(place >= 0.0) and np.all(place <= np.array(frame.shape[::-1]) - 1.0))

    def _sampled(self, frame: Image, shift: Floats) -> tuple[Singles, Flags]:
        """The frame where the learned image would be, and which pixels lie inside it."""
        from meso_robust.tracking.fit_kernels import shifted

        whole = np.floor(shift).astype(int)
        grey, inside = np.empty(self.shape, np.float32), np.empty(self.shape, np.bool_)
        shifted(frame, self.corner + whole, shift - whole, grey, inside)
        return grey, inside

    def _free_of(self, outline: Floats | None, shift: Floats) -> Flags:
        """(h, w) pixels that the part's edge, its rim and its meniscus do not reach."""
        reached = np.zeros(self.shape, np.uint8)
        if outline is not None:
            local = np.rint((outline - self.corner - shift) * 16.0).astype(np.int32)
            cv2.polylines(reached, [local], True, 1, 2 * _EDGE + 1, cv2.LINE_8, 4)
        return np.asarray(reached == 0)

    def _even(self) -> Singles:
        """(h, w) the learned image on even film: what is behind stays where it is, and would hold the needle."""
        beside = np.einsum("kn,fn->nkf", self._film, self._halo).reshape(len(self._rows), -1)
        grey, even = self._grey.ravel()[self._rows], self._grey.copy()
        share = self._clear**_CLEAR
        weight = share * self._known
        film, trust = weight > 0.5, weight
        if not film.any():
            return self._grey
        for _ in range(_ROUNDS):
            scaled = beside.T * trust
            gram = scaled @ beside + 1e-2 * np.eye(beside.shape[1])
            left = grey - beside @ np.linalg.solve(gram, scaled @ grey)
            limit = _TUKEY * max(float(np.median(np.abs(left[film]))), _LEAST_LEFT)
            trust = weight * np.maximum(1.0 - (left / limit) ** 2, 0.0) ** 2
        # the mean of more frames has less of each one's film in it, and then shows the meniscus better than this
        even.ravel()[self._rows] -= share * left / np.maximum(self._counts.ravel()[self._rows], 1.0)
        return even

    def _slopes(self) -> None:
        even = self._even()
        smooth = cv2.GaussianBlur(even, (0, 0), 0.6)
        slopes = [
            -np.asarray(cv2.Scharr(smooth, cv2.CV_32F, *order)).ravel()[self._rows] / 32.0
            for order in ((1, 0), (0, 1))
        ]
        own = even.ravel()[self._rows]
        self._columns = np.vstack([own[None], *(s[None] for s in slopes), self._film]).T
        self._columns = np.ascontiguousarray(self._columns, np.float32)


def _systematic(axis: Floats) -> Floats:
    """(2, 2) what texture, dust and the model's simplicity leave of the tip's place, px²."""
    along, across = 0.15**2, 0.03**2
    return across * np.eye(2) + (along - across) * np.outer(axis, axis)


def _film_basis(clear: Floats, s: Floats, n: Floats) -> Floats:
    """(K, h, w) brightness of the film, one value each side each segment, where it shows."""
    knots = np.arange(-_AHEAD, _LENGTH + _SEGMENT, _SEGMENT)
    hats = [np.maximum(0.0, 1.0 - np.abs(s - knot) / _SEGMENT) for knot in knots]
    return np.stack([clear * hat * side for hat in hats for side in (n >= 0.0, n < 0.0)])


def _neighbours(inside: Flags) -> Ints:
    """(N, 2) which of the pixels inside (h, w) are to the right of each and below it, −1: none."""
    number = np.full((inside.shape[0] + 1, inside.shape[1] + 1), -1)
    number[:-1, :-1][inside] = np.arange(int(inside.sum()))
    return np.stack([number[:-1, 1:][inside], number[1:, :-1][inside]], axis=1)
