"""Compiled loops of the sampling between pixels, apart so that a bad file is refused before they load."""

from __future__ import annotations

import numpy as np
from numba import njit

from meso_robust.kernels import sealed
from meso_robust.types import Floats, Image, Singles


@sealed
def _bilinear(grey: Singles, hidden: Image, u: float, v: float) -> float:
    """Grey value at (u, v) of the piece; NaN outside it and where it is hidden."""
    height, width = grey.shape
    if not (0.0 <= u <= width - 1.0 and 0.0 <= v <= height - 1.0):
        return np.nan
    row, column = min(int(v), height - 2), min(int(u), width - 2)
    if row < 0 or column < 0:
        return np.nan
    # an index that has a sign is compared with zero at each use
    i, j, one = np.uintp(row), np.uintp(column), np.uintp(1)
    if hidden[i, j] or hidden[i + one, j + one]:
        return np.nan
    a, b = u - column, v - row
    top = (1.0 - a) * grey[i, j] + a * grey[i, j + one]
    bottom = (1.0 - a) * grey[i + one, j] + a * grey[i + one, j + one]
    return (1.0 - b) * top + b * bottom


@njit(cache=True, nogil=True, error_model="numpy")
def sample(grey: Singles, hidden: Image, points: Floats, out: Floats) -> None:
    """Grey values at points."""
    for n in range(len(points)):
        out[n] = _bilinear(grey, hidden, points[n, 0], points[n, 1])


@njit(cache=True, nogil=True, error_model="numpy")
def placed(points: Floats, turn: tuple[float, float], to: tuple[float, float]) -> Floats:
    """Points (N, 2) turned by an angle of that cosine and sine, then shifted."""
    out = np.empty(points.shape)
    for n in range(len(points)):
        x, y = points[n, 0], points[n, 1]
        out[n, 0] = turn[0] * x - turn[1] * y + to[0]
        out[n, 1] = turn[1] * x + turn[0] * y + to[1]
    return out


@sealed
def _added(grey: Singles, u: float, v: float, du: float, dv: float, line: Singles) -> None:
    """Add grey values from (u, v) on in steps of (du, dv), none of which is hidden or outside."""
    x, y, across, down = np.float32(u), np.float32(v), np.float32(du), np.float32(dv)
    one = np.uintp(1)
    for k in range(np.uintp(len(line))):
        at, below = x + np.float32(k) * across, y + np.float32(k) * down
        i, j = np.uintp(np.int32(below)), np.uintp(np.int32(at))
        a, b = at - np.float32(np.int32(at)), below - np.float32(np.int32(below))
        left, lower = grey[i, j], grey[i + one, j]
        top = left + a * (grey[i, j + one] - left)
        line[k] += top + b * (lower + a * (grey[i + one, j + one] - lower) - top)


@njit(cache=True, nogil=True, error_model="numpy")
def derivatives(
    grey: Singles,
    hidden: Image,
    covered: tuple[int, int, int, int],
    points: Floats,
    normals: Floats,
    step: float,
    out: Floats,
) -> None:
    """Derivatives (N, K) of grey values along normals; nothing is hidden but in ``covered``, see `Patch`."""
    half, line = 0.5 * (out.shape[1] + 1), np.empty(out.shape[1] + 2, np.float32)
    height, width = grey.shape
    first, top = covered[0] - 2.0, covered[1] - 2.0
    last, bottom = first + covered[2] + 3.0, top + covered[3] + 3.0
    for n in range(len(points)):
        u, v, nu, nv = points[n, 0], points[n, 1], normals[n, 0], normals[n, 1]
        # a profile is a narrow rectangle, and inside if its corners are
        wide, high = half * step * abs(nu) + abs(nv), half * step * abs(nv) + abs(nu)
        clear = 1.0 + wide < u < width - 2.0 - wide and 1.0 + high < v < height - 2.0 - high
        beside = u + wide < first or u - wide > last or v + high < top or v - high > bottom
        for k in range(len(line)):
            line[k] = 0.0
        for side in range(-1, 2):  # along the edge: thrice the light
            x, y = u - side * nv - half * step * nu, v + side * nu - half * step * nv
            if clear and beside:
                _added(grey, x, y, step * nu, step * nv, line)
                continue
            for k in range(len(line)):
                line[k] += _bilinear(grey, hidden, x + k * step * nu, y + k * step * nv)
        for k in range(out.shape[1]):
            out[n, k] = (line[k + 2] - line[k]) / np.float32(6.0 * step)
