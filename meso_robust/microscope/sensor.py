"""From irradiance to grey levels: light, noise, quantisation, compression."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np

from meso_robust.microscope.optics import Optics
from meso_robust.types import Image, Singles

Irradiance = Singles


@dataclass(frozen=True, slots=True, kw_only=True)
class Exposure:
    """The lamp and the sensor.

    Attributes
    ----------
    level
        Grey level of brightness 1.
    gradient
        (right, up): relative change of the light from the middle to the border of the image.
    vignetting
        Relative loss of light at the corners, growing with the square of the radius.
    drift
        Relative change of the light a second.
    flicker, flicker_frequency
        Relative amplitude, and frequency in Hz (as seen, after aliasing).
    step, step_time
        From this time in s on, the light is changed by this relative amount.
    lamp_azimuth
        Direction in rad, world frame, from which oblique light comes; rims that face it shine.
    focus_rate
        Defocus in px a second, added in quadrature to the blur.
    shot_noise
        Variance of the noise, in grey levels squared, a grey level of signal.
    read_noise
        Standard deviation in grey levels.
    jpeg_quality
        1 to 100, or None: not compressed.
    """

    level: float = 230.0
    gradient: tuple[float, float] = (0.0, 0.0)
    vignetting: float = 0.0
    drift: float = 0.0
    flicker: float = 0.0
    flicker_frequency: float = 10.0
    step: float = 0.0
    step_time: float = math.inf
    lamp_azimuth: float = 2.2
    focus_rate: float = 0.0
    shot_noise: float = 0.04
    read_noise: float = 1.0
    jpeg_quality: int | None = None

    def __post_init__(self) -> None:
        """Check what has a limit."""
        if not (self.level > 0.0 and self.shot_noise >= 0.0 and self.read_noise >= 0.0):
            raise ValueError(
                f"exposure: level = {self.level}, shot_noise = {self.shot_noise}, read_noise = "
                f"{self.read_noise}; the level must be positive, noise not negative"
            )
        if self.jpeg_quality is not None and not 1 <= self.jpeg_quality <= 100:
            raise ValueError(f"exposure: jpeg_quality = {self.jpeg_quality}; must be 1 to 100")


def light_field(optics: Optics, exposure: Exposure) -> Irradiance:
    """(height, width) grey level of brightness 1 at every pixel, before changes in time."""
    u, v = (np.arange(n) - 0.5 * (n - 1) for n in (optics.width, optics.height))
    radius2 = (u[None, :] ** 2 + v[:, None] ** 2) / optics.half_diagonal**2
    right, up = exposure.gradient
    slope = right * 2.0 * u[None, :] / optics.width - up * 2.0 * v[:, None] / optics.height
    return (exposure.level * (1.0 + slope) * (1.0 - exposure.vignetting * radius2)).astype(
        np.float32
    )


def light_at(exposure: Exposure, time: float) -> float:
    """Factor on the light at a time in s."""
    wave = exposure.flicker * math.sin(2.0 * math.pi * exposure.flicker_frequency * time)
    jump = exposure.step if time >= exposure.step_time else 0.0
    return (1.0 + exposure.drift * time) * (1.0 + wave) * (1.0 + jump)


def blur_at(optics: Optics, exposure: Exposure, time: float) -> float:
    """Standard deviation of the point spread function in px at a time in s."""
    return math.hypot(optics.blur, exposure.focus_rate * time)


def blurred(image: Irradiance, sigma: float) -> Irradiance:
    """The image through a Gaussian point spread function; below 0.1 px it is left alone."""
    if sigma < 0.1:
        return image
    seen = cv2.GaussianBlur(image, (0, 0), sigma, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(seen, dtype=np.float32)


def noisy(image: Irradiance, exposure: Exposure, rng: np.random.Generator) -> Irradiance:
    """Grey levels with shot noise (normal, as for many electrons) and read noise."""
    if exposure.shot_noise == 0.0 and exposure.read_noise == 0.0:
        return image
    noise = rng.standard_normal(image.shape, dtype=np.float32)
    variance = np.maximum(image, 0.0)
    variance *= np.float32(exposure.shot_noise)
    variance += np.float32(exposure.read_noise**2)
    noise *= np.sqrt(variance, out=variance)
    noise += image
    return noise


def quantised(image: Irradiance) -> Image:
    """Grey levels rounded to the nearest of 0 to 255; what is brighter is white."""
    return np.asarray(cv2.convertScaleAbs(np.maximum(image, 0.0)), dtype=np.uint8)


def compressed(image: Image, quality: int) -> Image:
    """The image after JPEG at a quality of 1 to 100."""
    _, code = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])
    return np.asarray(cv2.imdecode(code, cv2.IMREAD_UNCHANGED), dtype=np.uint8)
