"""Compiled loops that draw a needle finely, apart so that a bad file is refused before they load."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from meso_robust.kernels import inner
from meso_robust.types import Floats, Ints, Singles

HALOS = (1.5, 4.0)
"""px; lengths over which the film may darken or brighten towards the needle."""
KNOTS = 5
"""Of the brightness across the needle, evenly from one flank to the other."""
CLIMB = 9.0
"""px of shaft over which the liquid's meniscus may change."""
BASIS = 6 + KNOTS
"""Images of `basis`: film and its two slopes, two halos, the needle's brightness and its slope."""
_SHARPEST = 0.1  # px, standard deviation of an edge in focus
_CERTAIN = 8.0  # standard deviations beyond which a normal distribution is 0 or 1


@inner
def _distance(s: float, n: float, c: float, d: float, radius: float) -> float:
    """Signed distance to a needle of taper (cos, sin) = (c, d), negative inside, px."""
    if s * c + abs(n) * d >= 0.0:
        return abs(n) * c - s * d - radius
    return math.sqrt(s * s + n * n) - radius


def half_width(s: float, c: float, d: float, radius: float) -> float:
    """Half the width at a place along the axis, at least the radius, px."""
    return max(radius / c + s * d / c, radius)


_half_width = inner(half_width)


@inner
def _covered(distance: float, s: float, rise: float) -> float:
    """Share of a fine sample that a needle covers, which rises out of focus along its shaft."""
    z = distance / max(rise * s, _SHARPEST)
    if abs(z) > _CERTAIN:
        return 0.0 if z > 0.0 else 1.0
    return 0.5 * math.erfc(z / math.sqrt(2.0))


@inner
def _hat(across: float, knot: int) -> float:
    """Share of a knot of the brightness at a place across a needle, in half widths."""
    return max(0.0, 1.0 - abs(across - (2.0 * knot / (KNOTS - 1) - 1.0)) * 0.5 * (KNOTS - 1))


@njit(cache=True, nogil=True, error_model="numpy")
def distances(s: Floats, n: Floats, taper: float, radius: float, out: Floats) -> None:
    """Signed distances (N,) of places along and across the axis."""
    c, d = math.cos(taper), math.sin(taper)
    for k in range(len(out)):
        out[k] = _distance(s[k], n[k], c, d, radius)


@inner
def _samples(
    u: float, v: float, axis: Floats, shape: Floats, finer: int, first: int, last: int, line: Floats
) -> None:
    """Images of `basis` at fine samples of one row, finer a px, from the tip at (u, v) before them."""
    radius, rise = shape[1], shape[2]
    c, d = math.cos(shape[0]), math.sin(shape[0])
    for j in range(first, last):
        x = u + (j + 0.5) / finer - 0.5
        s, n = x * axis[0] + v * axis[1], v * axis[0] - x * axis[1]
        distance = _distance(s, n, c, d, radius)
        inside = _covered(distance, s, rise)
        film, far = 1.0 - inside, max(distance, 0.0)
        out = line[j - first]
        out[0], out[1], out[2] = film, 0.1 * film * s, 0.1 * film * n
        out[3] = film * math.exp(-far / HALOS[0]) if film > 0.0 else 0.0
        out[4] = film * math.exp(-far / HALOS[1]) if film > 0.0 else 0.0
        across = n / _half_width(s, c, d, radius) if inside > 0.0 else 0.0
        for knot in range(KNOTS):
            out[5 + knot] = inside * _hat(across, knot) if inside > 0.0 else 0.0
        out[5 + KNOTS] = 0.1 * inside * s


@inner
def _span(columns: Ints) -> tuple[int, int]:
    """The first column of several rows, and the one after their last; (0, 0) if there is none."""
    first, last = 0, 0
    for row in range(len(columns)):
        if columns[row, 0] < columns[row, 1]:
            first = min(first, columns[row, 0]) if first < last else columns[row, 0]
            last = max(last, columns[row, 1])
    return first, last


@inner
def _gathered(line: Floats, begin: int, weights: Floats, out: Floats) -> None:
    """Weighted sum of fine samples."""
    out[:] = 0.0
    for t in range(len(weights)):
        for k in range(BASIS):
            out[k] += weights[t] * line[begin + t, k]


@njit(cache=True, nogil=True, error_model="numpy")
def basis(
    tip: Floats, axis: Floats, shape: Floats, blur: Floats, finer: int, columns: Ints, out: Floats
) -> None:
    """Images of film and needle, drawn finely, blurred and summed over pixels.

    ``tip`` (2,) from the first pixel, ``axis`` (2,), ``shape`` (taper, radius, rise), ``blur`` the
    weights of fine samples in a pixel, ``finer`` of which lie in one, ``columns`` (h, 2) first and last-but-one pixel of each row that
    is drawn, ``out`` (h, w, BASIS), zeros.
    """
    rows, reach = len(columns), (len(blur) - finer) // 2
    longest = finer * out.shape[1] + 2 * reach
    line, across = np.empty((longest, BASIS)), np.empty((out.shape[1], BASIS))
    for i in range(-reach, finer * rows + reach):
        low = max(-((reach + finer - 1 - i) // finer), 0)
        high = min((i + reach) // finer + 1, rows)
        first, last = _span(columns[low:high])
        if first >= last:
            continue
        begin = finer * first - reach
        v = (i + 0.5) / finer - 0.5 - tip[1]
        _samples(-tip[0], v, axis, shape, finer, begin, finer * last + reach, line)
        for column in range(first, last):
            _gathered(line, finer * (column - first), blur, across[column])
        for row in range(low, high):
            weight = blur[i - finer * row + reach]
            for column in range(columns[row, 0], columns[row, 1]):
                for k in range(BASIS):
                    out[row, column, k] += weight * across[column, k]


@njit(cache=True, nogil=True, error_model="numpy")
def layers(first: Floats, axis: Floats, shape: Floats, finer: int, out: Singles) -> None:
    """Sharp images of a needle as `alpha_matting.layers` has them, at fine samples.

    ``first`` (2,) px from the tip to the first sample, ``axis`` (2,), ``shape`` (taper, radius, rise),
    ``out`` (1 + 3 * 2 + KNOTS + 1, h, w).
    """
    radius, rise = shape[1], shape[2]
    c, d = math.cos(shape[0]), math.sin(shape[0])
    for i in range(out.shape[1]):
        for j in range(out.shape[2]):
            u, v = first[0] + j / finer, first[1] + i / finer
            s, n = u * axis[0] + v * axis[1], v * axis[0] - u * axis[1]
            distance = _distance(s, n, c, d, radius)
            inside = _covered(distance, s, rise)
            clear, far = 1.0 - inside, max(distance, 0.0)
            out[0, i, j] = clear
            for h in range(len(HALOS)):
                halo = clear * math.exp(-far / HALOS[h]) if clear > 0.0 else 0.0
                # how far the meniscus reaches up the needle is not known: three hats along the axis
                out[1 + 3 * h, i, j] = halo * min(max(1.0 - s / CLIMB, 0.0), 1.0)
                out[2 + 3 * h, i, j] = halo * max(1.0 - abs(s - CLIMB) / CLIMB, 0.0)
                out[3 + 3 * h, i, j] = halo * min(max((s - CLIMB) / CLIMB, 0.0), 1.0)
            across = n / _half_width(s, c, d, radius)
            for knot in range(KNOTS):
                out[7 + knot, i, j] = inside * _hat(across, knot)
            out[7 + KNOTS, i, j] = 0.1 * inside * s
