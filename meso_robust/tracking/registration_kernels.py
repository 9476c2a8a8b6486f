"""Compiled loops of `learned.Learned.register`, apart so that a bad file is refused before they load."""

from __future__ import annotations

import numpy as np
from numba import njit

from meso_robust.types import Flags, Floats, Ints, Singles

_TUKEY = 4.7  # standard deviations beyond which a pixel does not count
_LEAST_SIGMA = 0.5  # grey values


@njit(cache=True, nogil=True, error_model="numpy")
def gathered(
    grey: Singles, inside: Flags, seen: Flags, rows: Ints, target: Singles, weight: Singles
) -> None:
    """Grey values (N,) of some pixels of an image (h, w), and whether each can be compared."""
    width = grey.shape[1]
    for n in range(len(rows)):
        i, j = rows[n] // width, rows[n] % width
        target[n] = grey[i, j]
        weight[n] = 1.0 if inside[i, j] and seen[i, j] else 0.0


@njit(cache=True, nogil=True, error_model="numpy")
def before_edge(
    rows: Ints,
    change: Singles,
    variance: Singles,
    clear: Singles,
    fading: Floats,
    learned: Singles,
    view: tuple[Singles, Singles, Singles],
) -> None:
    """Take the part's edge behind a needle out of a view: target, weight and columns are changed.

    ``clear`` (N,) and ``fading`` (N, 2) are the needle's transmission and its slopes, ``learned`` (N, K)
    the columns without an edge.
    """
    target, weight, columns = view
    for k in range(len(rows)):
        n = rows[k]
        target[n] -= clear[n] * change[k]
        weight[n] /= np.float32(1.0) + clear[n] ** 2 * variance[k]
        # the needle stands out against what is behind it there, not against film
        for i in range(2):
            columns[n, 1 + i] = learned[n, 1 + i] - fading[n, i] * change[k]


@njit(cache=True, nogil=True, error_model="numpy")
def solve(
    target: Singles, weight: Singles, columns: Singles, residual: Singles
) -> tuple[Floats, Floats]:
    """Solution (K,) of weighted least squares and cofactors (K, K); ``residual`` (N,) is filled."""
    scaled = np.empty(columns.shape, np.float32)
    for n in range(len(target)):
        for k in range(columns.shape[1]):
            scaled[n, k] = weight[n] * columns[n, k]
    gram = (scaled.T @ columns).astype(np.float64)
    for k in range(len(gram)):
        gram[k, k] += 1e-2  # a segment that does not show stays at none
    inverse = np.linalg.inv(gram)
    x = inverse @ (scaled.T @ target).astype(np.float64)
    residual[:] = target - columns @ x.astype(np.float32)
    return x, inverse


@njit(cache=True, nogil=True, error_model="numpy")
def robust(residual: Singles, weight: Singles, out: Singles) -> None:
    """Tukey's weights (N,) of residuals."""
    rough = np.abs(residual) * np.sqrt(weight)
    sigma = max(1.4826 * np.median(rough[weight > 0.0][::2]), _LEAST_SIGMA)
    for n in range(len(out)):
        out[n] = max(1.0 - (rough[n] / (_TUKEY * sigma)) ** 2, 0.0) ** 2
