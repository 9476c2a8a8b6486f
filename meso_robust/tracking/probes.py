"""Probe tips, frame by frame: the needle is learned where it is free and followed by registration.

That serves while the video is read and for the mask. At the end all tips are fitted once more to the
pieces around them, before the part's own image (`refined`); a video of a few frames does not tell
needle and part apart, and the tip is then fitted once, to the mean of the frames (`needle.fit_needle`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from meso_robust.kernels import spread
from meso_robust.tracking.alpha_matting import Window, window_of
from meso_robust.tracking.backdrop import (
    Canvas,
    Glimpse,
    backdrop,
    beyond,
    canvas,
    glimpse,
    glimpse_at,
)
from meso_robust.tracking.learned import Learned, Tip, lost
from meso_robust.tracking.needle import Needle, fit_needle
from meso_robust.tracking.tip_fit import Matte, fit_matte, place
from meso_robust.types import Floats, Image, Ints

LEAST, MOST = 8, 16
"""Frames that the needle is fitted to; fewer do not tell it from what is behind it, more tell little else."""
_CANVAS = 32  # frames that the part's image is the mean of
_CLEAR = 12.0  # px from the part, from where on one place is as free as another
_FREE = 8.0  # px from the part where it serves to fit the needle; what is nearer to it than that does not
_AHEAD = 2.0  # px ahead of a tip that always serve
_ROUNDS = 2
_ALONG, _ACROSS = 0.05, 0.02  # px; what the needle's and the film's simplicity leave
# of a tip's variance if what is left were alike wherever the tip's slopes reach: these change their sign there
_CANCELS = 0.5
# likewise, along the needle, of what all tips of a film are off by, as it is not known exactly
_OF_SHAPE = 0.5
_AMISS = 2.0  # px between the two estimates that are worth a doubt
# px between part and needle, nearer than which the film between them tells less; and px along the axis by how much
_CLOSE, _AT_PART = 2.0, 0.12
_UNSEEN = 0.5  # px along the axis, where the part may be in front of the tip but was not found
_BLOCKED = 1.0  # px along the axis, where the part hides the end of the tip in all frames
_LEAST_GAP = 2.0  # px between part and needle where its end shows
_HALO = 4  # px about the part in which the film is not even
_LEAST_CONTRAST = 4.0  # of film and needle, in standard deviations of what the fit leaves


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Refined:
    """Tips (T, 2) px, their covariances (T, 2, 2), and a remark or ""."""

    tips: Floats
    covariances: Floats
    remark: str


def refined(glimpses: Sequence[Glimpse], needle: Needle, window: Window) -> Refined:
    """Fit the needle, then each tip.

    Parameters
    ----------
    glimpses
        T pieces around the tip.
    needle
        As first fitted, right to ten degrees.
    window
        Of the pixels that are compared; the pieces were cut with it.
    """
    free = np.array([_clearance(one) for one in glimpses])
    chosen = np.argsort(-free, kind="stable")
    even = np.linspace(0, len(glimpses) - 1, min(_CANVAS, len(glimpses))).astype(int)
    drawn = np.unique(np.concatenate([even, chosen[:LEAST]]))
    chosen = _spread(chosen, free)
    offset, part = np.zeros(2), None
    shape = needle.ordinary  # one frame may have been fitted by a blurred needle that ends too soon
    for _ in range(_ROUNDS):
        seen = [
            beyond(
                backdrop(glimpse_at(glimpses[k], offset), window, shape, part),
                glimpses[k],
                min(free[k] - needle.radius - _AHEAD, _FREE),
            )
            for k in chosen
        ]
        starts = np.array([glimpses[k].tip for k in chosen]) + offset
        matte, tips = fit_matte(seen, starts, shape, window)
        offset = offset + np.mean(tips - starts, axis=0)
        shape = matte.needle
        part = canvas([glimpse_at(glimpses[k], offset) for k in drawn], shape)
    if shape.at_limit:
        nothing = np.full((len(glimpses), 2), math.nan)
        return Refined(
            tips=nothing,
            covariances=np.full((len(glimpses), 2, 2), math.nan),
            remark="what is seen at its tip does not look like a needle",
        )
    blocked = float(free.max()) < needle.radius + _LEAST_GAP
    found = _each(glimpses, offset, matte, part, window)
    if not blocked:
        return found
    along = _BLOCKED**2 * np.outer(matte.needle.axis, matte.needle.axis)
    return replace(
        found, covariances=found.covariances + along, remark="never seen free of the part"
    )


def _each(
    glimpses: Sequence[Glimpse], offset: Floats, matte: Matte, part: Canvas | None, window: Window
) -> Refined:
    axis = matte.needle.axis
    constant = _ACROSS**2 * np.eye(2) + (_ALONG**2 - _ACROSS**2) * np.outer(axis, axis)
    shrunk = np.eye(2) + (math.sqrt(_OF_SHAPE) - 1.0) * np.outer(axis, axis)
    constant = constant + shrunk @ matte.common @ shrunk
    unseen, close = _UNSEEN**2 * np.outer(axis, axis), _AT_PART**2 * np.outer(axis, axis)
    tips, spreads = [], []
    for one in glimpses:
        seen = backdrop(glimpse_at(one, offset), window, matte.needle, part)
        found = place(seen, one.tip + offset, matte, window)
        apart = found.tip - one.tip - offset
        doubt = np.outer(apart, apart) if np.hypot(*apart) > _AMISS else np.zeros((2, 2))
        if part is not None and one.outline is None:
            doubt = doubt + unseen
        if _clearance(one) < matte.needle.radius + _CLOSE:
            doubt = doubt + close
        tips.append(found.tip)
        spreads.append(_CANCELS * matte.alike * found.covariance + constant + doubt)
    return Refined(tips=np.array(tips), covariances=np.array(spreads), remark="")


def _clearance(one: Glimpse) -> float:
    """Distance of the tip from the part, at most `_CLEAR`, px."""
    if one.outline is None:
        return _CLEAR
    at = (float(one.tip[0]), float(one.tip[1]))
    return min(-cv2.pointPolygonTest(one.outline.astype(np.float32), at, True), _CLEAR)


def _spread(order: Ints, free: Floats) -> Ints:
    """Frames in which the tip is clear of the part, evenly over time, or the clearest ones if they are few."""
    clear = np.flatnonzero(free >= _FREE)
    if len(clear) <= LEAST:
        return order[:LEAST]
    return np.asarray(clear[np.linspace(0, len(clear) - 1, min(MOST, len(clear))).astype(int)])


class ProbeTracker:
    """Follows one probe.

    Parameters
    ----------
    name
        Of the probe.
    needle
        Where it is in the first frame, right to a pixel or two.

    Attributes
    ----------
    glimpses
        What was around the tip, frame by frame, None where it was not found.
    """

    def __init__(self, name: str, needle: Needle) -> None:
        self.name = name
        self.needle = needle
        self._learned: Learned | None = None
        self._shift = np.zeros(2)
        self._speed = np.zeros(2)
        self._visible = True
        self.glimpses: list[Glimpse | None] = []

    def first(self, frame: Image, outline: Floats | None = None) -> Tip:
        """Start in a grey frame (H, W); ``outline`` (V, 2) is the part's in seen px, if it is known."""
        # without the part's rim before it, or whole, where the tip touches the part
        views = [None] if outline is None else [_beside(frame, outline), None]
        aside = (self.needle.radius * np.array([0.0, -1.0, 1.0])).tolist()
        grey = frame.astype(float)
        fits = spread(lambda used: fit_needle(grey, np.zeros(2), self.needle, used, aside), views)
        fit = max(fits, key=lambda one: one.contrast)
        moved = float(np.hypot(*(np.array(fit.needle.tip) - np.array(self.needle.tip))))
        unlike = fit.contrast < _LEAST_CONTRAST or fit.needle.at_limit
        if unlike or moved > 4.0 * (1.0 + self.needle.radius):
            self._visible = False
            return lost(f"no needle at ({self.needle.tip[0]:.0f}, {self.needle.tip[1]:.0f}) px")
        self.needle = fit.needle
        self._learned = Learned(frame, fit.needle, outline)
        self._shift = np.zeros(2)
        return self.next(frame, outline)

    def next(self, frame: Image, outline: Floats | None = None) -> Tip:
        """Find the probe in the next frame, near where it is expected, else around its last place."""
        if self._learned is None:
            return lost("the probe was not found at the start")
        tip = self._learned.register(frame, self._shift + self._speed, outline)
        if not tip.found:
            place = self._learned.search(frame, self._shift)
            again = self._learned.register(frame, place, outline)
            tip = again if again.found else tip
        if tip.found:
            self._speed = tip.shift - self._shift if self._learned.frames > 1 else np.zeros(2)
            self._shift = tip.shift
            self._learned.learn(frame, tip, outline)
        else:
            self._speed = np.zeros(2)
        return tip

    def mask(self, shape: tuple[int, ...], margin: float = 3.0) -> Image:
        """(H, W) 255 where the probe hides the scene, as it was last seen."""
        hidden = np.zeros(shape[:2], np.uint8)
        if self._visible:
            long = math.hypot(shape[0], shape[1])
            corners = self.needle.moved(self._shift).polygon(margin, long)
            cv2.fillPoly(hidden, [np.rint(corners * 16.0).astype(np.int32)], 255, cv2.LINE_8, 4)
        return hidden

    def remember(self, frame: Image, tip: Tip, outline: Floats | None) -> None:
        """Keep what is around a tip (about 10 kB); ``outline`` is the part's in this very frame."""
        if not tip.found:
            self.glimpses.append(None)
            return
        place = np.array(self.needle.tip) + tip.shift
        self.glimpses.append(glimpse(frame, place, window_of(self.needle), outline))

    def places(self, tips: Sequence[Tip]) -> Refined:
        """Tips in px of all frames that were remembered, NaN where they were not found.

        Parameters
        ----------
        tips
            What `first` and `next` said.
        """
        kept = [one for one in self.glimpses if one is not None]
        if len(kept) < LEAST:
            place, spread, remark = self.anchor()
            shifts = np.array([tip.shift for tip in tips]).reshape(-1, 2)
            covariances = np.array([tip.covariance for tip in tips]).reshape(-1, 2, 2)
            return Refined(tips=place + shifts, covariances=spread + covariances, remark=remark)
        found = refined(kept, self.needle, window_of(self.needle))
        where = [k for k, one in enumerate(self.glimpses) if one is not None]
        places = np.full((len(tips), 2), math.nan)
        spreads = np.full((len(tips), 2, 2), math.nan)
        places[where], spreads[where] = found.tips, found.covariances
        return Refined(tips=places, covariances=spreads, remark=found.remark)

    def anchor(self) -> tuple[Floats, Floats, str]:
        """Place (2,) of the tip in the learned image, its covariance (2, 2), and a remark or ""."""
        if self._learned is None:
            return np.full(2, math.nan), np.full((2, 2), math.nan), "never found"
        return self._learned.anchor()


def _beside(frame: Image, outline: Floats) -> Floats:
    """(H, W) 1 where the part and its halo are not, else 0."""
    covered = np.zeros(frame.shape, np.uint8)
    corners = [np.rint(outline * 16.0).astype(np.int32)]
    cv2.fillPoly(covered, corners, 1, cv2.LINE_8, 4)
    cv2.polylines(covered, corners, True, 1, 2 * _HALO, cv2.LINE_8, 4)
    return (covered == 0).astype(np.float64)
