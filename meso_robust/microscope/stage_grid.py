"""Image of a stage grid, from which optics are calibrated."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from meso_robust.microscope.optics import Optics
from meso_robust.microscope.sensor import (
    Exposure,
    blurred,
    compressed,
    light_field,
    noisy,
    quantised,
)
from meso_robust.microscope.stamp import AT_EDGES, PixelMap
from meso_robust.types import Floats, Image

Kind = Literal["chessboard", "dots"]
_WHITE, _BLACK = 0.85, 0.12
_DOT = 0.5  # diameter of a dot, pitches
_RAMP = 0.03  # px over which a sample sees an edge, about the spacing of samples


def grid_image(  # a grid, where it lies, and what sees it
    optics: Optics,
    pitch: float,
    kind: Kind = "chessboard",
    *,
    count: tuple[int, int] | None = None,
    pose: tuple[float, float, float] = (0.0, 0.0, 0.0),
    exposure: Exposure | None = None,
    rng: np.random.Generator | None = None,
) -> Image:
    """A grid on the stage through the optics.

    Parameters
    ----------
    optics
        Camera.
    pitch
        Side of a square, or distance of dots, in m.
    kind
        "chessboard", or "dots": black discs of half a pitch in diameter.
    count
        (along x, along y) squares or dots, centred on the pose, on white; None: without end, with a
        corner of four squares, or a dot, at the pose.
    pose
        x, y in m and θ in rad of the grid in the world.
    exposure
        Light and noise; None: as of `Exposure`, without noise.
    rng
        Of the noise; None: seed 0.

    Returns
    -------
    :
        (height, width) uint8.

    Raises
    ------
    ValueError
        If the pitch is not positive.
    """
    if not 0.0 < pitch < math.inf:
        raise ValueError(f"grid: pitch = {pitch} m; must be positive; give the pitch of the grid")
    exposure = exposure or Exposure(shot_noise=0.0, read_noise=0.0)
    pixels = PixelMap(optics)
    black = np.zeros((optics.height, optics.width))
    for du, dv in AT_EDGES:
        points = pixels.world + du * pixels.by_pixel[..., :2] + dv * pixels.by_pixel[..., 2:]
        black += _blackness(_in_grid(points, pose), pitch, kind, count, _RAMP * optics.pixel_size)
    brightness = (_WHITE - (_WHITE - _BLACK) * black / len(AT_EDGES)).astype(np.float32)
    grey = blurred(brightness, optics.blur) * light_field(optics, exposure)
    image = quantised(noisy(grey, exposure, rng or np.random.default_rng(0)))
    quality = exposure.jpeg_quality
    return image if quality is None else compressed(image, quality)


def grid_points(
    pitch: float,
    count: tuple[int, int],
    kind: Kind = "chessboard",
    pose: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Floats:
    """World points (rows, columns, 2) in m of the inner corners of a chessboard, or of the dots.

    Rows run along the grid's +y, columns along its +x; arguments as of `grid_image`.
    """
    inner = tuple(n - 1 for n in count) if kind == "chessboard" else count
    x, y = (pitch * (np.arange(n) - 0.5 * (n - 1)) for n in inner)
    c, s = math.cos(pose[2]), math.sin(pose[2])
    local = np.stack(np.meshgrid(x, y), axis=-1)
    return local @ np.array([[c, s], [-s, c]]) + np.array(pose[:2])


def _in_grid(points: Floats, pose: tuple[float, float, float]) -> Floats:
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return (points - np.array(pose[:2])) @ np.array([[c, -s], [s, c]])


def _blackness(
    points: Floats, pitch: float, kind: Kind, count: tuple[int, int] | None, ramp: float
) -> Floats:
    """Share of black at points (..., 2) in m, in the frame of the grid."""
    size = np.array(count if count is not None else (0, 0))
    if kind == "dots":
        first = -0.5 * (size - 1) * (count is not None)
        index = np.round(points / pitch - first)
        away = np.hypot(*np.moveaxis(points - (index + first) * pitch, -1, 0))
        black = np.clip(0.5 - (away - 0.5 * _DOT * pitch) / ramp, 0.0, 1.0)
        there = np.all((index >= 0) & (index < size), axis=-1)
        return np.asarray(black if count is None else black * there)
    t = points / pitch + 0.5 * size
    to_line = pitch * (0.5 - np.abs(t % 1.0 - 0.5))
    sign = 1.0 - 2.0 * (np.floor(t) % 2.0)
    wave = sign * np.clip(2.0 * to_line / ramp, 0.0, 1.0)
    black = 0.5 + 0.5 * wave[..., 0] * wave[..., 1]
    if count is None:
        return np.asarray(black)
    beyond = np.max(pitch * (np.abs(t - 0.5 * size) - 0.5 * size), axis=-1)
    return np.asarray(black * np.clip(0.5 - beyond / ramp, 0.0, 1.0))
