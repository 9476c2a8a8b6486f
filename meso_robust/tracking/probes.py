"""Probe tips, frame by frame: the needle is learned where it is free and followed by registration.

Where the tip lies in the learned image is fitted once, at the end, to the mean of many frames
(`needle.fit_needle`); until then, and for the mask, the first fit serves.
"""

from __future__ import annotations

import math

import cv2
import numpy as np
import numpy.typing as npt

from meso_robust.tracking.learned import Learned, Tip, lost
from meso_robust.tracking.needle import Needle, fit_needle

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]

_LEAST_CONTRAST = 4.0  # of film and needle, in standard deviations of what the fit leaves


class ProbeTracker:
    """Follows one probe.

    Parameters
    ----------
    name
        Of the probe.
    needle
        Where it is in the first frame, right to a pixel or two.
    """

    def __init__(self, name: str, needle: Needle) -> None:
        self.name = name
        self.needle = needle
        self._learned: Learned | None = None
        self._shift = np.zeros(2)
        self._speed = np.zeros(2)
        self._visible = True

    def first(self, frame: Image, outline: Floats | None = None) -> Tip:
        """Start in a grey frame (H, W); ``outline`` (V, 2) is the part's in seen px, if it is known."""
        fit = fit_needle(frame.astype(float), np.zeros(2), self.needle)
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

    def anchor(self) -> tuple[Floats, Floats, str]:
        """Place (2,) of the tip in the learned image, its covariance (2, 2), and a remark or ""."""
        if self._learned is None:
            return np.full(2, math.nan), np.full((2, 2), math.nan), "never found"
        return self._learned.anchor()
