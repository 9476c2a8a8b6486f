"""Compiled loops of the sampling between pixels, apart so that a bad file is refused before they load."""

from __future__ import annotations

import numpy as np
from numba import njit

from meso_robust.kernels import inner
from meso_robust.types import Floats, Image, Singles


@inner
def _inside(grey: Singles, hidden: Image, row: int, column: int, u: float, v: float) -> float:
    """Grey value at (u, v), which is right and down of a pixel; NaN where it is hidden."""
    # an index that has a sign is compared with zero at each use
    i, j, one = np.uintp(row), np.uintp(column), np.uintp(1)
    if hidden[i, j] or hidden[i + one, j + one]:
        return np.nan
    a, b = u - column, v - row
    top = (1.0 - a) * grey[i, j] + a * grey[i, j + one]
    bottom = (1.0 - a) * grey[i + one, j] + a * grey[i + one, j + one]
    return (1.0 - b) * top + b * bottom


@inner
def _bilinear(grey: Singles, hidden: Image, u: float, v: float) -> float:
    """Grey value at (u, v) of the piece; NaN outside it and where it is hidden."""
    height, width = grey.shape
    if not (0.0 <= u <= width - 1.0 and 0.0 <= v <= height - 1.0):
        return np.nan
    row, column = min(int(v), height - 2), min(int(u), width - 2)
    if row < 0 or column < 0:
        return np.nan
    return _inside(grey, hidden, row, column, u, v)


@njit(cache=True, nogil=True, error_model="numpy")
def sample(grey: Singles, hidden: Image, points: Floats, out: Floats) -> None:
    """Grey values at points."""
    for n in range(len(points)):
        out[n] = _bilinear(grey, hidden, points[n, 0], points[n, 1])


@njit(cache=True, nogil=True, error_model="numpy")
def profiles(
    grey: Singles, hidden: Image, points: Floats, normals: Floats, step: float, out: Floats
) -> None:
    """Grey values along normals."""
    half = 0.5 * (out.shape[1] - 1)
    height, width = grey.shape
    for n in range(len(points)):
        nu, nv = normals[n, 0], normals[n, 1]
        # a profile is a narrow rectangle, and inside if its corners are
        wide, high = half * step * abs(nu) + abs(nv), half * step * abs(nv) + abs(nu)
        inside = wide < points[n, 0] < width - 1.0 - wide
        inside = inside and high < points[n, 1] < height - 1.0 - high
        for k in range(out.shape[1]):
            u = points[n, 0] + (k - half) * step * nu
            v = points[n, 1] + (k - half) * step * nv
            total = 0.0
            for side in range(-1, 2):  # along the edge: thrice the light
                x, y = u - side * nv, v + side * nu
                if inside:
                    total += _inside(grey, hidden, int(y), int(x), x, y)
                else:
                    total += _bilinear(grey, hidden, x, y)
            out[n, k] = total / 3.0
