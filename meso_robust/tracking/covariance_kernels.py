"""Compiled sums of weighted least squares, apart so that a bad file is refused before they load."""

from __future__ import annotations

import numpy as np
from numba import njit

from meso_robust.kernels import inner
from meso_robust.types import Floats, Ints


@inner
def _added(row: Floats, weight: float, matrix: Floats) -> None:
    """Add the weighted outer product of a row with itself to the upper triangle of a matrix."""
    for i in range(np.uintp(len(row))):
        scaled = weight * row[i]
        for j in range(i, np.uintp(len(row))):
            matrix[i, j] += scaled * row[j]


@inner
def _mirrored(matrix: Floats) -> None:
    """Fill the lower triangle of a matrix."""
    for i in range(len(matrix)):
        for j in range(i):
            matrix[i, j] = matrix[j, i]


@njit(cache=True, nogil=True, error_model="numpy")
def normal(design: Floats, weight: Floats) -> Floats:
    """Normal matrix (k, k) of rows (N, k) with weights (N,)."""
    out = np.zeros((design.shape[1], design.shape[1]))
    for n in range(len(design)):
        _added(design[n], weight[n], out)
    _mirrored(out)
    return out


@njit(cache=True, nogil=True, error_model="numpy")
def scattered(design: Floats, weight: Floats, residual: Floats, starts: Ints) -> tuple[Floats, int]:
    """Sum (k, k) of the outer products of each cluster's score, and how many clusters count at all."""
    many = design.shape[1]
    out, score, used = np.zeros((many, many)), np.empty(many), 0
    for k in range(len(starts)):
        last = starts[k + 1] if k + 1 < len(starts) else len(design)
        score[:] = 0.0
        counts = 0.0
        for n in range(starts[k], last):
            counts += weight[n]
            scaled = weight[n] * residual[n]
            for i in range(many):
                score[i] += scaled * design[n, i]
        _added(score, 1.0, out)
        used += counts > 0.0
    _mirrored(out)
    return out, used
