"""A needle as a layer before a scene: the share of light that it lets through and what it adds.

The camera sees G*(B T + R): the scene B behind, the needle's transmission T (nothing where it is
opaque, less than 1 in its meniscus) and its own brightness R, blurred by G. The blurred product is the
product of the blurred images and the series in their derivatives, G*(B T) = b t + var grad b . grad t +
..., exact for a Gaussian; two terms are kept. T and R depend on the place relative to the tip only.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from meso_robust.tracking import meniscus
from meso_robust.tracking.needle import FINER, Needle, pixel_weights
from meso_robust.types import Floats, Singles

AHEAD, ALONG, ASIDE = 8.0, 22.0, 9.0
"""px ahead of the tip, along and beside the axis that are compared."""
# over (variance k**2)**2: what a disc's spectrum lacks of a normal distribution's where k is that of an edge;
# its series begins with 1/24, and falls off faster
_DISC = 1.0 / 12.0
PAD = 6  # px around the window, so that neither blur nor shift meets its border
HALO_COUNT = meniscus.COUNT
"""Unknown shares of the transmission; the other brightnesses are the needle's own."""
OWN_COUNT = 8


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


def sharp(needle: Needle, window: Window) -> Singles:
    """(1 + HALO_COUNT + OWN_COUNT, h, w) fine images about the tip: T's parts, then R's."""
    from meso_robust.tracking.needle_kernels import layers

    rows, columns = (FINER * (k + 2 * PAD) for k in window.shape)
    first = np.array(window.low) + 0.5 / FINER - 0.5 - PAD
    out = np.empty((1 + HALO_COUNT + OWN_COUNT, rows, columns), np.float32)
    layers(first, needle.axis, np.array([needle.taper, needle.radius, needle.rise]), FINER, out)
    return out


def blurred(images: Singles, needle: Needle) -> Singles:
    """Fine images (K, h, w) as a camera sees them: blurred and summed over pixels."""
    weights = pixel_weights(needle.blur)
    share = -needle.disc * _DISC * (FINER * needle.blur) ** 4
    smooth = [cv2.sepFilter2D(one, cv2.CV_32F, weights, weights) for one in images]
    return np.stack([_flatter(one.astype(np.float32, copy=False), share) for one in smooth])


def _flatter(image: Singles, share: float) -> Singles:
    """The image (h, w) and a share of its Laplacian's Laplacian."""
    twice = cv2.Laplacian(cv2.Laplacian(image, -1, ksize=1), -1, ksize=1)
    return np.asarray(image + np.float32(share) * twice)


def sampled(fine: Singles, window: Window, part: Floats) -> Singles:
    """(K, h, w) pixels of fine images when the tip is a ``part`` (2,) of a pixel right and down."""
    from meso_robust.tracking.fit_kernels import sample

    out = np.empty((len(fine), *window.shape), np.float32)
    sample(fine, FINER * (PAD - part) + 0.5 * (FINER - 1), FINER, out)
    return out
