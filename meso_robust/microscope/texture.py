"""Random surfaces: rolled metal, slow shading, scratches, specks and dust."""

from __future__ import annotations

import math
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from meso_robust.types import Singles

Field = Singles


def smooth_noise(shape: tuple[int, int], sigma: tuple[float, float], seed: int) -> Field:
    """Noise of unit variance, correlated over ``sigma`` (across rows, along rows) in samples."""
    rng = np.random.default_rng(seed)
    # drawn on a coarser grid where it is smooth, so that the filter stays small
    step = [max(1, int(s / 3.0)) for s in sigma]
    coarse = tuple(n // k + 2 for n, k in zip(shape, step, strict=True))
    noise = rng.standard_normal(coarse).astype(np.float32)
    across, along = (s / k for s, k in zip(sigma, step, strict=True))
    soft = cv2.GaussianBlur(noise, (0, 0), sigmaX=max(along, 1e-3), sigmaY=max(across, 1e-3))
    noise = _float32(cv2.resize(soft, shape[::-1], interpolation=cv2.INTER_CUBIC))
    return ((noise - noise.mean()) / (noise.std() + 1e-12)).astype(np.float32)


def _float32(image: npt.NDArray[Any]) -> Field:
    return np.asarray(image, dtype=np.float32)


def rolled(shape: tuple[int, int], pitch: float, seed: int) -> Field:
    """Rolled and etched sheet, unit variance: lines along x, grain and patches; ``pitch`` in m."""
    lines = smooth_noise(shape, (4e-6 / pitch, 180e-6 / pitch), seed)
    grain = smooth_noise(shape, (5e-6 / pitch, 5e-6 / pitch), seed + 1)
    patches = smooth_noise(shape, (90e-6 / pitch, 90e-6 / pitch), seed + 2)
    return 0.55 * lines + 0.65 * grain + 0.53 * patches


def marks(shape: tuple[int, int], pitch: float, scratches: int, specks: int, seed: int) -> Field:
    """Relative change of brightness by scratches and specks; ``pitch`` in m."""
    rng = np.random.default_rng(seed + 3)
    field = np.zeros(shape, dtype=np.float32)
    for _ in range(scratches):
        _scratch(field, pitch, rng)
    for _ in range(specks):
        _blob(field, pitch, rng, radii=(3e-6, 16e-6), depth=(-0.6, -0.15))
    return _float32(cv2.GaussianBlur(field, (0, 0), 1.5e-6 / pitch))


def dust(shape: tuple[int, int], pitch: float, count: int, seed: int) -> Field:
    """Relative change of brightness by dust on the slide, some of it ringed by a halo."""
    rng = np.random.default_rng(seed + 4)
    field = np.zeros(shape, dtype=np.float32)
    for _ in range(count):
        _blob(field, pitch, rng, radii=(4e-6, 20e-6), depth=(-0.7, 0.35))
    return _float32(cv2.GaussianBlur(field, (0, 0), max(3e-6 / pitch, 0.3)))


_FRACTION = 4  # bits of sub-sample position in OpenCV's drawing


def _scratch(field: Field, pitch: float, rng: np.random.Generator) -> None:
    length, angle = rng.uniform(50e-6, 400e-6) / pitch, rng.uniform(0.0, math.pi)
    start = rng.uniform(0.0, 1.0, 2) * field.shape[::-1]
    bend = rng.normal(0.0, 0.04, 3).cumsum()
    steps = np.stack([np.cos(angle + bend), np.sin(angle + bend)], axis=1) * length / 3.0
    path = np.vstack([start, start + steps.cumsum(axis=0)]) * 2**_FRACTION
    depth = rng.choice([-1.0, 1.0]) * rng.uniform(0.1, 0.35)
    thickness = max(1, round(rng.uniform(2e-6, 5e-6) / pitch))
    points = path.round().astype(np.int32).reshape(-1, 1, 2)
    cv2.polylines(field, [points], False, depth, thickness, cv2.LINE_8, _FRACTION)


def _blob(
    field: Field,
    pitch: float,
    rng: np.random.Generator,
    *,
    radii: tuple[float, float],
    depth: tuple[float, float],
) -> None:
    centre = rng.uniform(0.0, 1.0, 2) * field.shape[::-1] * 2**_FRACTION
    radius = radii[0] * (radii[1] / radii[0]) ** rng.uniform() / pitch
    axes = radius * np.array([1.0, rng.uniform(0.5, 1.0)]) * 2**_FRACTION
    u, v = centre.round().astype(int).tolist()
    a, b = axes.round().astype(int).tolist()
    turn, value = rng.uniform(0.0, 180.0), rng.uniform(*depth)
    cv2.ellipse(field, (u, v), (a, b), turn, 0.0, 360.0, value, -1, cv2.LINE_8, _FRACTION)
