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
    """Normal matrix (k, k) of rows (N, k) with weights (N,).

    Raises
    ------
    ValueError
        If there is not one weight to each row: what lies beyond an array would be read for weights.
    """
    if len(weight) != len(design):
        raise ValueError("not one weight to each row")
    scaled = np.empty(design.shape)
    for n in range(len(design)):
        for k in range(np.uintp(design.shape[1])):
            scaled[n, k] = weight[n] * design[n, k]
    return np.dot(design.T, scaled)


@njit(cache=True, nogil=True, error_model="numpy")
def scattered(design: Floats, weight: Floats, residual: Floats, starts: Ints) -> tuple[Floats, int]:
    """Sum (k, k) of the outer products of each cluster's score, and how many clusters count at all."""
    many = design.shape[1]
    out, score, used = np.zeros((many, many)), np.empty(many), 0
    for k in range(len(starts)):
        last = starts[k + 1] if k + 1 < len(starts) else len(design)
        counts = 0.0
        for i in range(many):
            score[i] = 0.0
        for n in range(starts[k], last):
            counts += weight[n]
            scaled = weight[n] * residual[n]
            for i in range(many):
                score[i] += scaled * design[n, i]
        _added(score, 1.0, out)
        used += counts > 0.0
    _mirrored(out)
    return out, used


@njit(cache=True, nogil=True, error_model="numpy")
def modes_seen(
    design: Floats, weight: Floats, residual: Floats, modes: Floats, bread: Floats
) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """What displaced sides (M, N) do to a fit; see `covariance.systematic`.

    Returns by how much each displaces the solution (M, k), by how much it displaces what is left along
    each other (M, M), its weight (M,), the most that could have, and the displacement that is seen.
    """
    many = len(modes)
    pull, power, most = np.zeros((many, design.shape[1])), np.zeros(many), np.zeros(many)
    seen = np.zeros(many)
    for m in range(many):
        for n in range(len(weight)):
            if modes[m, n] == 0.0:
                continue
            scaled = weight[n] * modes[m, n]
            most[m] += modes[m, n] ** 2
            power[m] += scaled * modes[m, n]
            seen[m] += scaled * residual[n]
            for k in range(design.shape[1]):
                pull[m, k] += scaled * design[n, k]
    response = np.dot(pull, bread)
    left = np.dot(response, pull.T)
    for m in range(many):
        seen[m] /= max(power[m], 1e-9)
        for other in range(many):
            left[other, m] /= -max(power[m], 1e-9)
        left[m, m] += 1.0
    return response, left, power, most, seen
