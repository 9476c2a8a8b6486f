"""Compiled sums of weighted least squares, apart so that a bad file is refused before they load."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from meso_robust.kernels import maker, sealed
from meso_robust.types import Flags, Floats, Ints

# points of 3 px: farther apart than pixels and blocks of compression that profiles have in common
_APART = 4, 8


@sealed
def _added(row: Floats, weight: float, matrix: Floats) -> None:
    """Add the weighted outer product of a row with itself to the upper triangle of a matrix."""
    for i in range(np.uintp(len(row))):
        scaled = weight * row[i]
        for j in range(i, np.uintp(len(row))):
            matrix[i, j] += scaled * row[j]


@sealed
def _mirrored(matrix: Floats) -> None:
    """Fill the lower triangle of a matrix."""
    for i in range(len(matrix)):
        for j in range(i):
            matrix[i, j] = matrix[j, i]


@maker
def _normal(design: Floats, weight: Floats) -> Floats:
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


@sealed
def _rescaled(matrix: Floats, scale: Floats) -> None:
    """Rows and columns of a matrix times their scales."""
    for i in range(len(scale)):
        for j in range(len(scale)):
            matrix[i, j] *= scale[i] * scale[j]


@sealed
def _inverted(matrix: Floats, out: Floats) -> None:
    """Turn ``out``, at first the unit matrix, into the inverse of a definite one, which needs no pivots and is used up."""
    for k in range(len(out)):
        pivot = 1.0 / matrix[k, k]
        for j in range(len(out)):
            matrix[k, j] *= pivot
            out[k, j] *= pivot
        for i in range(len(out)):
            factor = matrix[i, k] if i != k else 0.0
            for j in range(len(out)):
                matrix[i, j] -= factor * matrix[k, j]
                out[i, j] -= factor * out[k, j]


@maker
def _bread(design: Floats, weight: Floats) -> Floats:
    """(k, k) inverse of the normal matrix; of what is not determined, a very large variance."""
    matrix = _normal(design, weight)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(matrix), 1e-12))
    _rescaled(matrix, scale)
    for k in range(len(scale)):
        matrix[k, k] += 1e-9
    out = np.eye(len(scale))
    _inverted(matrix, out)
    _rescaled(out, scale)
    return out


@njit(cache=True, nogil=True, error_model="numpy")
def clustered(design: Floats, weight: Floats, residual: Floats, starts: Ints) -> Floats:
    """Covariance (k, k) of a solution whose errors come in clusters; see `covariance.clustered`."""
    many, bread = design.shape[1], _bread(design, weight)
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
    # a fit to few clusters hides their scatter
    return used / max(used - many, 1) * np.dot(np.dot(bread, out), bread)


@sealed
def _gathered(
    design: Floats, weight: Floats, residual: Floats, mode: Floats, pull: Floats
) -> tuple[float, float, float]:
    """Add what a mode (N,) draws from a fit; its weight, the most that could have, and how far it is displaced."""
    power, most, seen = 0.0, 0.0, 0.0
    for n in range(len(weight)):
        if mode[n] == 0.0:
            continue
        scaled = weight[n] * mode[n]
        most += mode[n] ** 2
        power += scaled * mode[n]
        seen += scaled * residual[n]
        for k in range(design.shape[1]):
            pull[k] += scaled * design[n, k]
    return power, most, seen / max(power, 1e-9)


@sealed
def _shared(weight: Floats, residual: Floats, side: Floats) -> tuple[float, float]:
    """Products of residuals some points apart on one side, about its mean, and what they weigh.

    ``side`` (N,) is the mode of it that displaces it as a whole.
    """
    first, last, power, mean = len(side), 0, 1e-9, 0.0
    for n in range(len(side)):
        if side[n] != 0.0:
            first, last = min(first, n), n + 1
            power += weight[n]
            mean += weight[n] * residual[n]
    mean /= power
    total, pairs = 0.0, 0.0
    for n in range(first, last):
        for other in range(n + _APART[0], min(n + _APART[1] + 1, last)):
            both = math.sqrt(weight[n] * weight[other])
            total += both * (residual[n] - mean) * (residual[other] - mean)
            pairs += both
    return total, pairs


@njit(cache=True, nogil=True, error_model="numpy")
def displaced(
    design: Floats,
    weight: Floats,
    residual: Floats,
    modes: Floats,
    assumed: tuple[float, float, float],
) -> tuple[Floats, Floats]:
    """How far sides may be displaced in modes (M, N), and what that does to a fit; see `covariance.systematic`.

    ``assumed`` are the variance of a displacement over that which points of a side share, the share of the
    residuals' variance that is shared at least, and the observations that this is worth. Returns the standard
    deviations (M,) and by how much each displaces the solution (M, k).
    """
    many = len(modes)
    pull, used = np.zeros((many, design.shape[1])), np.zeros(many, np.bool_)
    power, seen, sigma = np.empty(many), np.empty(many), np.empty(many)
    for m in range(many):
        power[m], most, seen[m] = _gathered(design, weight, residual, modes[m], pull[m])
        used[m] = power[m] > 0.05 * most
    response = np.dot(pull, _bread(design, weight))
    # by how much each displaces what is left along each other
    left = -np.dot(response, pull.T) / np.maximum(power, 1e-9)
    total, pairs = 0.0, 1e-9
    for m in range(0, many, 2):
        side = _shared(weight, residual, modes[m])
        total, pairs = total + side[0], pairs + side[1]
    spread = np.sum(weight * residual**2) / max(np.sum(weight), 1e-9)
    expected = assumed[0] * (max(total / pairs, 0.0) + assumed[1] * spread)
    for kind in range(2):
        free, found = 0.0, 0.0
        for m in range(kind, many, 2):
            found += seen[m] ** 2 if used[m] else 0.0
            for other in range(kind, many, 2):
                own = 1.0 if m == other else 0.0
                free += (own + left[m, other]) ** 2 if used[m] and used[other] else 0.0
        for m in range(kind, many, 2):
            sigma[m] = math.sqrt((assumed[2] * expected + found) / (assumed[2] + free))
    return sigma, response


@sealed
def _decomposed(matrix: Floats) -> None:
    """Replace the lower triangle of a definite matrix by that of its Cholesky decomposition."""
    for j in range(len(matrix)):
        for i in range(j, len(matrix)):
            for k in range(j):
                matrix[i, j] -= matrix[i, k] * matrix[j, k]
            matrix[i, j] = math.sqrt(matrix[j, j]) if i == j else matrix[i, j] / matrix[j, j]


@sealed
def _divided(lower: Floats, columns: Floats) -> None:
    """Solve with a lower triangle for each column, in place."""
    for c in range(columns.shape[1]):
        for i in range(len(lower)):
            for k in range(i):
                columns[i, c] -= lower[i, k] * columns[k, c]
            columns[i, c] /= lower[i, i]


@njit(cache=True, nogil=True, error_model="numpy")
def support(design: Floats, visible: Flags, agrees: Flags) -> Floats:
    """Symmetric (k, k); its eigenvalues are the shares of what visible rows (N, k) tell that agreeing ones tell."""
    many = design.shape[1]
    whole, part = np.zeros((many, many)), np.zeros((many, many))
    for n in range(len(design)):
        if visible[n]:
            _added(design[n], 1.0, whole)
        if agrees[n]:
            _added(design[n], 1.0, part)
    _mirrored(whole)
    _mirrored(part)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(whole), 1e-12))
    _rescaled(whole, scale)
    _rescaled(part, scale)
    for k in range(many):
        whole[k, k] += 1e-9
    _decomposed(whole)
    _divided(whole, part)
    turned = part.T.copy()
    _divided(whole, turned)
    return turned
