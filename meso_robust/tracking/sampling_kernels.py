"""Compiled loops of the sampling between pixels, apart so that a bad file is refused before they load."""

from __future__ import annotations

import numpy as np
from numba import njit

from meso_robust.kernels import inner
from meso_robust.types import Floats, Image, Singles


@inner
def _bilinear(grey: Singles, hidden: Image, u: float, v: float) -> float:
    """Grey value at (u, v) of the piece; NaN outside it and where it is hidden."""
    height, width = grey.shape
    if not (0.0 <= u <= width - 1.0 and 0.0 <= v <= height - 1.0):
        return np.nan
    i, j = min(int(v), height - 2), min(int(u), width - 2)
    if i < 0 or j < 0 or hidden[i, j] or hidden[i + 1, j + 1]:
        return np.nan
    a, b = u - j, v - i
    top = (1.0 - a) * grey[i, j] + a * grey[i, j + 1]
    bottom = (1.0 - a) * grey[i + 1, j] + a * grey[i + 1, j + 1]
    return (1.0 - b) * top + b * bottom


@njit(cache=True, error_model="numpy")
def sample(grey: Singles, hidden: Image, points: Floats, out: Floats) -> None:
    """Grey values at points."""
    for n in range(len(points)):
        out[n] = _bilinear(grey, hidden, points[n, 0], points[n, 1])


@njit(cache=True, error_model="numpy")
def profiles(
    grey: Singles, hidden: Image, points: Floats, normals: Floats, step: float, out: Floats
) -> None:
    """Grey values along normals."""
    half = 0.5 * (out.shape[1] - 1)
    for n in range(len(points)):
        nu, nv = normals[n, 0], normals[n, 1]
        for k in range(out.shape[1]):
            u = points[n, 0] + (k - half) * step * nu
            v = points[n, 1] + (k - half) * step * nv
            total = 0.0
            for side in range(-1, 2):  # along the edge: thrice the light
                total += _bilinear(grey, hidden, u - side * nv, v + side * nu)
            out[n, k] = total / 3.0
