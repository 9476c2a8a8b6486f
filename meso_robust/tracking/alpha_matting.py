"""A needle as a layer before a scene: the share of light that it lets through and what it adds.

The camera sees G*(B T + R): the scene B behind, the needle's transmission T (nothing where it is
opaque, less than 1 in its meniscus) and its own brightness R, blurred by G. The blurred product is the
product of the blurred images and the series in their derivatives, G*(B T) = b t + var grad b . grad t +
..., exact for a Gaussian; two terms are kept. T and R depend on the place relative to the tip only.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np
from scipy.special import ndtr

from meso_robust.tracking.needle import Needle
from meso_robust.types import Floats, Singles

AHEAD, ALONG, ASIDE = 8.0, 22.0, 9.0
"""px ahead of the tip, along and beside the axis that are compared."""
FINER = 3  # samples a pixel and direction
_HALOS = (1.5, 4.0)  # px; lengths over which the film may darken or brighten towards the needle
_KNOTS = np.linspace(-1.0, 1.0, 5)  # of the brightness across the needle, in half widths
_CLIMB = 9.0  # px of shaft over which the liquid's meniscus may change
_PAD = 6  # px around the window, so that neither blur nor shift meets its border
HALO_COUNT = 3 * len(_HALOS)
"""Unknown shares of the transmission; the other brightnesses are the needle's own."""
OWN_COUNT = len(_KNOTS) + 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Window:
    """Pixels around a tip: of offsets ``low`` to ``low + shape`` (u, v) from its nearest pixel."""

    low: tuple[int, int]
    shape: tuple[int, int]


def window_of(needle: Needle) -> Window:
    """The box around all that is compared."""
    a = needle.axis
    aside = np.array([-a[1], a[0]])
    reach = [s * a + n * aside for s in (-AHEAD, ALONG) for n in (-ASIDE, ASIDE)]
    low = np.floor(np.min(reach, axis=0)).astype(int) - 1
    high = np.ceil(np.max(reach, axis=0)).astype(int) + 1
    return Window(
        low=(int(low[0]), int(low[1])), shape=(int(high[1] - low[1]) + 1, int(high[0] - low[0]) + 1)
    )


def layers(needle: Needle, window: Window) -> Singles:
    """(1 + HALO_COUNT + OWN_COUNT, h, w) fine images about the tip, blurred: T's parts, then R's."""
    rows, columns = (FINER * (k + 2 * _PAD) for k in window.shape)
    u = (np.arange(columns) + 0.5) / FINER - 0.5 - _PAD + window.low[0]
    v = (np.arange(rows) + 0.5) / FINER - 0.5 - _PAD + window.low[1]
    here = replace(needle, tip=(0.0, 0.0))
    s, n = here.along_across(u[None, :], v[:, None])
    distance = here.distance(s, n)
    inside = ndtr(-distance / np.maximum(needle.rise * s, 0.3 / FINER))
    clear = 1.0 - inside
    far = np.maximum(distance, 0.0)
    halos = [clear * np.exp(-far / length) * wet for length in _HALOS for wet in _wetness(s)]
    across = n / here.half_width(s)
    hats = [inside * np.maximum(0.0, 1.0 - np.abs(across - knot) / 0.5) for knot in _KNOTS]
    sharp = np.stack([clear, *halos, *hats, inside * s / 10.0]).astype(np.float32)
    size = 2 * math.ceil(3.5 * needle.blur * FINER) + 1
    blur = cv2.getGaussianKernel(size, needle.blur * FINER)
    seen = np.convolve(blur.ravel(), np.full(FINER, 1.0 / FINER))  # and summed over pixels
    return np.stack([cv2.sepFilter2D(one, -1, seen, seen) for one in sharp])


def _wetness(s: Floats) -> list[Floats]:
    """How far the meniscus reaches up the needle is not known: three hats along the axis."""
    return [
        np.clip(1.0 - s / _CLIMB, 0.0, 1.0),
        np.clip(1.0 - np.abs(s - _CLIMB) / _CLIMB, 0.0, 1.0),
        np.clip((s - _CLIMB) / _CLIMB, 0.0, 1.0),
    ]


def sampled(fine: Singles, window: Window, part: Floats) -> Singles:
    """(K, h, w) pixels of fine images when the tip is a ``part`` (2,) of a pixel right and down."""
    at = FINER * (_PAD - part) + 0.5 * (FINER - 1)
    low = np.floor(at).astype(int)
    fu, fv = (at - low).astype(np.float32)
    h, w = window.shape
    rows = fine[:, low[1] : low[1] + FINER * h + 1]
    down = (1 - fv) * rows[:, :-1:FINER] + fv * rows[:, 1::FINER]
    columns = down[:, :, low[0] : low[0] + FINER * w + 1]
    return np.asarray((1 - fu) * columns[:, :, :-1:FINER] + fu * columns[:, :, 1::FINER])
