"""From pixels to the world and back: scale, turn of the camera, radial distortion of the lens.

Seen pixels are those of the image, u right, v down, the centre of the first pixel at (0, 0). Ideal
pixels are what a lens without distortion would show. A point at the ideal offset d from the centre of
distortion is seen at d (1 + k1 |d|² / h²), with h half the diagonal of the image (Brown, "Close-range
camera calibration", Photogrammetric Engineering 37, 1971, radial term of lowest order). The world has x
right, y up and θ counter-clockwise; the camera is turned by its rotation counter-clockwise in it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from meso_robust.types import Floats

MOST_K1 = 0.1
"""Largest distortion: below it no ray of the image folds, and Newton's method converges."""
_NEWTON_STEPS = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class Interval:
    """Half widths of the 95 % intervals of a calibration, in its units; infinite: not identifiable.

    Attributes
    ----------
    pixel_size, rotation, k1, k1_centre
        As in `Calibration`.
    """

    pixel_size: float
    rotation: float
    k1: float
    k1_centre: tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Calibration:
    """Where the camera looks.

    Attributes
    ----------
    pixel_size
        m a pixel.
    size
        Width and height of the image in px.
    centre
        (x, y) of the world in m that is at the middle of the ideal image.
    rotation
        Of the camera in the world, rad, counter-clockwise.
    k1
        Radial distortion, relative, half a diagonal from its centre; negative: barrel.
    k1_centre
        (u, v) of its centre in px; None: the middle of the image.
    interval
        How well the values are known; None if they were given.

    Raises
    ------
    ValueError
        If the pixel size is not positive, the image is empty, or |k1| exceeds 0.1.
    """

    pixel_size: float
    size: tuple[int, int]
    centre: tuple[float, float] = (0.0, 0.0)
    rotation: float = 0.0
    k1: float = 0.0
    k1_centre: tuple[float, float] | None = None
    interval: Interval | None = None

    def __post_init__(self) -> None:
        """Check the values."""
        if not 0.0 < self.pixel_size < math.inf:
            raise ValueError(
                f"pixel_size: {self.pixel_size} m; must be positive; give metres per pixel"
            )
        if min(self.size) < 1:
            raise ValueError(f"size: {self.size} px; must be positive; give width and height")
        if not abs(self.k1) <= MOST_K1:
            raise ValueError(f"k1: {self.k1}; must be within ±{MOST_K1}; calibrate again")

    @property
    def middle(self) -> Floats:
        """(2,) u, v of the middle of the image."""
        return 0.5 * (np.array(self.size, dtype=float) - 1.0)

    @property
    def half_diagonal(self) -> float:
        """Length in px that k1 refers to."""
        return 0.5 * math.hypot(*self.size)

    @property
    def _about(self) -> Floats:
        return self.middle if self.k1_centre is None else np.array(self.k1_centre)

    @property
    def _turned(self) -> Floats:
        """(2, 2) world offset a pixel offset, m: turn, scale, and v down to y up."""
        c, s = math.cos(self.rotation), math.sin(self.rotation)
        return self.pixel_size * np.array([[c, s], [s, -c]])

    def to_image(self, ideal: Floats) -> Floats:
        """Seen pixels (..., 2) of ideal ones (..., 2)."""
        if self.k1 == 0.0:
            return np.array(ideal, dtype=float)
        offset = np.asarray(ideal) - self._about
        square = np.sum(offset**2, axis=-1, keepdims=True) / self.half_diagonal**2
        return self._about + offset * (1.0 + self.k1 * square)

    def to_ideal(self, seen: Floats) -> Floats:
        """Ideal pixels (..., 2) of seen ones (..., 2); the inverse of `to_image`, to rounding."""
        if self.k1 == 0.0:
            return np.array(seen, dtype=float)
        offset = (np.asarray(seen, dtype=float) - self._about) / self.half_diagonal
        square = np.sum(offset**2, axis=-1, keepdims=True)
        stretch = np.ones_like(square)  # seen over ideal distance, root of s = 1 + k1 |o|² / s²
        for _ in range(_NEWTON_STEPS):
            part = self.k1 * square / stretch**2
            stretch -= (stretch - 1.0 - part) / (1.0 + 2.0 * part / stretch)
        return self._about + self.half_diagonal * offset / stretch

    def to_world(self, points_px: Floats) -> Floats:
        """World points (..., 2) in m of seen pixels (..., 2)."""
        return self.ideal_to_world(self.to_ideal(points_px))

    def to_pixels(self, points: Floats) -> Floats:
        """Seen pixels (..., 2) of world points (..., 2) in m."""
        return self.to_image(self.world_to_ideal(points))

    def ideal_to_world(self, ideal: Floats) -> Floats:
        """World points (..., 2) in m of ideal pixels (..., 2)."""
        return np.array(self.centre) + (np.asarray(ideal) - self.middle) @ self._turned.T

    def world_to_ideal(self, points: Floats) -> Floats:
        """Ideal pixels (..., 2) of world points (..., 2) in m."""
        # the matrix mirrors and scales: its inverse is itself over the square of the scale
        back = self._turned / self.pixel_size**2
        return self.middle + (np.asarray(points) - np.array(self.centre)) @ back.T

    def pose_to_world(self, poses_px: Floats) -> Floats:
        """Poses (..., 3) x, y in m, θ in rad, of u, v in ideal px and the angle from +u to +v."""
        poses_px = np.asarray(poses_px, dtype=float)
        place = self.ideal_to_world(poses_px[..., :2])
        return np.concatenate((place, self.rotation - poses_px[..., 2:]), axis=-1)

    def pose_to_pixels(self, poses: Floats) -> Floats:
        """The inverse of `pose_to_world`."""
        poses = np.asarray(poses, dtype=float)
        place = self.world_to_ideal(poses[..., :2])
        return np.concatenate((place, self.rotation - poses[..., 2:]), axis=-1)

    def pose_covariance(self, covariances_px: Floats) -> Floats:
        """Covariances (..., 3, 3) in m and rad of those of ideal poses in px and rad."""
        change = np.zeros((3, 3))
        change[:2, :2], change[2, 2] = self._turned, -1.0
        return change @ np.asarray(covariances_px) @ change.T

    def point_covariance(self, points_px: Floats, covariances_px: Floats) -> Floats:
        """Covariances (..., 2, 2) in m² of points (..., 2) and their covariances in seen px."""
        offset = (self.to_ideal(points_px) - self._about) / self.half_diagonal
        square = np.sum(offset**2, axis=-1)[..., None, None]
        outer = offset[..., :, None] * offset[..., None, :]
        seen_by_ideal = (1.0 + self.k1 * square) * np.eye(2) + 2.0 * self.k1 * outer
        change = self._turned @ np.linalg.inv(seen_by_ideal)
        return change @ np.asarray(covariances_px) @ np.swapaxes(change, -1, -2)

    def outline_px(self, outline: Floats) -> Floats:
        """Corners (V, 2) of a part in ideal px, v down, of those in m, body frame, y up."""
        return np.asarray(outline) / self.pixel_size * np.array([1.0, -1.0])
