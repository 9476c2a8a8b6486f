"""The camera: where a world point falls in the image, and back."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from meso_robust.types import Floats

_NEWTON_STEPS = 6  # the radius converges to rounding in four for |k1| <= 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class Optics:
    """Objective and sensor geometry, without what the light does (`Exposure`).

    Attributes
    ----------
    pixel_size
        m a pixel at the centre of distortion.
    width, height
        Size of the image in pixels.
    centre
        (x, y) world point in m that an undistorted camera shows at the middle of the image.
    rotation
        Angle in rad by which the camera is turned counter-clockwise against the world: the world
        looks turned clockwise.
    k1
        Radial distortion: a point at the distance of half the image's diagonal from the centre of
        distortion is seen further out by the fraction k1 of that distance (negative: barrel).
    distortion_centre
        (u, v) in px; None: the middle of the image.
    blur
        Standard deviation of the point spread function in px, in focus.

    Raises
    ------
    ValueError
        If a value breaks its rule, or k1 folds the image onto itself.
    """

    pixel_size: float = 5.26e-6
    width: int = 640
    height: int = 480
    centre: tuple[float, float] = (0.0, 0.0)
    rotation: float = 0.0
    k1: float = 0.0
    distortion_centre: tuple[float, float] | None = None
    blur: float = 0.8

    def __post_init__(self) -> None:
        """Check the values."""
        rules = {
            f"pixel_size = {self.pixel_size} m; must be positive": 0.0 < self.pixel_size < math.inf,
            f"size {self.width} x {self.height} px; must be at least 16 x 16": min(
                self.width, self.height
            )
            >= 16,
            f"k1 = {self.k1}; must be within ±0.1, beyond it the image folds": abs(self.k1) <= 0.1,
            f"blur = {self.blur} px; must not be negative": 0.0 <= self.blur < math.inf,
        }
        for rule, kept in rules.items():
            if not kept:
                raise ValueError(f"optics: {rule}")

    @property
    def middle(self) -> Floats:
        """(2,) pixel coordinates u, v of the middle of the image."""
        return np.array([0.5 * (self.width - 1), 0.5 * (self.height - 1)])

    @property
    def half_diagonal(self) -> float:
        """Length in px to which k1 refers."""
        return 0.5 * math.hypot(self.width, self.height)

    @property
    def distorted_about(self) -> Floats:
        """(2,) centre of distortion in px."""
        return self.middle if self.distortion_centre is None else np.array(self.distortion_centre)


def _axes(optics: Optics) -> Floats:
    """(2, 2) px per m: columns are where the world's x and y point in the image."""
    c, s = math.cos(optics.rotation), math.sin(optics.rotation)
    return np.array([[c, s], [s, -c]]) / optics.pixel_size


def project(optics: Optics, points: Floats) -> Floats:
    """Pixels (..., 2), u right and v down, of world points (..., 2) in m, y up."""
    flat = (points - np.array(optics.centre)) @ _axes(optics).T + optics.middle
    offset = (flat - optics.distorted_about) / optics.half_diagonal
    stretch = 1.0 + optics.k1 * np.sum(offset**2, axis=-1, keepdims=True)
    return optics.distorted_about + offset * stretch * optics.half_diagonal


def unproject(optics: Optics, pixels: Floats) -> Floats:
    """World points (..., 2) in m of pixels (..., 2); the inverse of `project` to rounding."""
    offset = (pixels - optics.distorted_about) / optics.half_diagonal
    seen = np.sqrt(np.sum(offset**2, axis=-1, keepdims=True))
    radius = seen.copy()
    for _ in range(_NEWTON_STEPS):
        excess = radius * (1.0 + optics.k1 * radius**2) - seen
        radius -= excess / (1.0 + 3.0 * optics.k1 * radius**2)
    flat = optics.distorted_about + offset * optics.half_diagonal / (1.0 + optics.k1 * radius**2)
    axes = _axes(optics) * optics.pixel_size**2  # its own inverse but for the scale
    return np.array(optics.centre) + (flat - optics.middle) @ axes.T


def pixel_centres(optics: Optics) -> Floats:
    """(height, width, 2) u, v of every pixel."""
    u, v = np.meshgrid(np.arange(optics.width), np.arange(optics.height))
    return np.stack([u, v], axis=-1).astype(np.float64)
