"""Probe tips, frame by frame: the needle is learned where it is free and followed by registration.

That serves while the video is read and for the mask. At the end all tips are fitted once more to the
pieces around them, before the part's own image (`tip_refine`); a video of a few frames does not tell
needle and part apart, and the tip is then fitted once, to the mean of the frames (`needle.fit_needle`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import cv2
import numpy as np

from meso_robust.tracking.alpha_matting import window_of
from meso_robust.tracking.backdrop import Glimpse, glimpse
from meso_robust.tracking.learned import Learned, Tip, lost
from meso_robust.tracking.needle import Needle, fit_needle
from meso_robust.tracking.tip_refine import LEAST, Refined, refined
from meso_robust.types import Floats, Image

_HALO = 4  # px about the part in which the film is not even
_LEAST_CONTRAST = 4.0  # of film and needle, in standard deviations of what the fit leaves


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
        fits = [fit_needle(frame.astype(float), np.zeros(2), self.needle, used) for used in views]
        fit = max(fits, key=lambda one: one.contrast)
        moved = float(np.hypot(*(np.array(fit.needle.tip) - np.array(self.needle.tip))))
        if fit.contrast < _LEAST_CONTRAST or moved > 4.0 * (1.0 + self.needle.radius):
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
