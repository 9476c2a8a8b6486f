"""What a camera makes of a pose, and what a tracker adds to it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Camera:
    """From true poses to seen ones; the defaults see the truth. Units: um, s, rad."""

    latency: float = 0.0
    jitter: float = 0.0
    """Half width of the random error of a frame's time."""
    jitter_seed: int = 0
    offset: tuple[float, float] = (0.0, 0.0)
    """Tracked point on the part."""
    scale: tuple[float, float] = (0.0, 0.0)
    """Relative excess of seen lengths along x and y."""
    rotation: float = 0.0
    drift: tuple[float, float] = (0.0, 0.0)
    radial: float = 0.0
    """k1 of y = x (1 + k1 |x|²), 1/um²."""
    keystone: tuple[float, float] = (0.0, 0.0)
    """k of y = x / (1 + k · x), 1/um."""
    shake: tuple[float, float] = (0.0, 0.0)
    """Amplitude of a vibration of the image along x and y."""
    shake_rate: float = 12.0
    locking: float = 0.0
    """Amplitude of the pull towards the middle of pixels."""
    pitch: float = 40.0

    def exposures(self, frames: Floats) -> Floats:
        """(T,) true times of what the frames (T,) show."""
        late = np.random.default_rng(self.jitter_seed).uniform(-1.0, 1.0, len(frames))
        return frames - self.latency + self.jitter * late

    def image(self, points: Floats) -> Floats:
        """(..., 2) places in the image of points (..., 2) of the stage."""
        seen = points * (1.0 + self.radial * np.sum(points**2, axis=-1, keepdims=True))
        seen = seen / (1.0 + seen @ np.array(self.keystone))[..., None]
        c, s = np.cos(self.rotation), np.sin(self.rotation)
        turned = seen @ np.array([[c, s], [-s, c]])
        return np.asarray(turned * (1.0 + np.array(self.scale)))

    def see(self, poses: Floats, frames: Floats) -> Floats:
        """(T, 3) poses without noise that the tracker finds at the frames (T,)."""
        heading = np.stack([np.cos(poses[:, 2]), np.sin(poses[:, 2])], axis=1)
        across = np.stack([-heading[:, 1], heading[:, 0]], axis=1)
        points = poses[:, :2] + self.offset[0] * heading + self.offset[1] * across
        seen = self.image(points)
        way = self.image(points + heading) - self.image(points - heading)
        turn = np.arctan2(
            heading[:, 0] * way[:, 1] - heading[:, 1] * way[:, 0], np.sum(heading * way, axis=1)
        )
        seen = seen + frames[:, None] * self.drift
        seen = seen + np.sin(self.shake_rate * frames)[:, None] * self.shake
        seen = seen + self.locking * np.sin(2.0 * np.pi * seen / self.pitch)
        return np.column_stack([seen, poses[:, 2] + turn])


@dataclass(frozen=True, slots=True)
class Sensor:
    """Noise of the tracker: standard deviations in um and deg, stated to the user or not."""

    position_sigma: float
    orientation_sigma_deg: float
    correlation: float
    """Of the noise of neighbouring frames (first-order autoregression)."""
    dropped: float
    """Fraction of frames that are lost."""
    blank: float
    """Fraction of frames in which the part is not seen."""
    stated: bool

    @property
    def sigmas(self) -> Floats:
        """(3,) standard deviations, um and rad."""
        turn = np.radians(self.orientation_sigma_deg)
        return np.array([self.position_sigma, self.position_sigma, turn])


def drawn_sensor(rng: np.random.Generator) -> Sensor:
    """A sensor as a laboratory might have it."""
    return Sensor(
        position_sigma=float(rng.uniform(1.0, 1.5)),
        orientation_sigma_deg=float(rng.uniform(0.06, 0.10)),
        correlation=float(rng.uniform(0.0, 0.5)),
        dropped=float(rng.uniform(0.0, 0.03)),
        blank=0.01 * float(rng.random() < 0.3),
        stated=bool(rng.random() < 0.5),
    )


def coloured(rng: np.random.Generator, count: int, sensor: Sensor) -> Floats:
    """(T, 3) noise of the stated standard deviations, stationary from the first frame."""
    white = rng.normal(size=(count, 3)) * sensor.sigmas
    noise = white.copy()
    fresh = np.sqrt(1.0 - sensor.correlation**2)
    for k in range(1, count):
        noise[k] = sensor.correlation * noise[k - 1] + fresh * white[k]
    return noise
