"""Interval linear algebra of small systems.

Source: A. Neumaier, Interval Methods for Systems of Equations, 1990, sections 4.1 (preconditioning
by the inverse of the middle) and 4.5 (interval Gauss elimination).
"""

from __future__ import annotations

import numpy as np

from meso_robust.bounds.arithmetic import Pair, add, div, down, mul, sub, up
from meso_robust.kernels import inner, maker
from meso_robust.types import Floats


@inner
def scale(factor: float, lo: float, hi: float) -> Pair:
    """Factor * [lo, hi]."""
    p, q = factor * lo, factor * hi
    if p + q != p + q:
        return -np.inf, np.inf
    return down(min(p, q)), up(max(p, q))


@inner
def grow(of: Floats, i: int, j: int, by: Pair) -> None:
    """Add an interval to entry (i, j) of an array (., ., 2)."""
    of[i, j, 0], of[i, j, 1] = add(of[i, j, 0], of[i, j, 1], by[0], by[1])


@maker
def invert(matrix: Floats, inverse: Floats) -> bool:
    """Write an approximate inverse; False where no pivot is left. ``matrix`` is overwritten.

    Nothing is proved here: what is computed with the inverse is checked with intervals.
    """
    n = matrix.shape[0]
    inverse[:] = np.eye(n)
    for c in range(n):
        best = c + np.argmax(np.abs(matrix[c:, c]))
        pivot = matrix[best, c]
        if not (abs(pivot) > 0.0 and abs(pivot) < np.inf):
            return False
        for k in range(n):
            matrix[c, k], matrix[best, k] = matrix[best, k], matrix[c, k]
            inverse[c, k], inverse[best, k] = inverse[best, k], inverse[c, k]
        for k in range(n):
            matrix[c, k] /= pivot
            inverse[c, k] /= pivot
        for r in range(n):
            factor = matrix[r, c]
            if r != c and factor != 0.0:
                for k in range(n):
                    matrix[r, k] -= factor * matrix[c, k]
                    inverse[r, k] -= factor * inverse[c, k]
    return bool(np.isfinite(inverse).all())


@maker
def eliminate(a: Floats, b: Floats) -> bool:
    """Solve ``A X = B`` for every A in ``a`` (n, n, 2) and B in ``b`` (n, m, 2), in place.

    True proves that every A is regular; ``b`` then holds every solution. The pivots are taken from
    the diagonal: the caller preconditions, which leaves a matrix close to the unit matrix.
    """
    n, m = b.shape[0], b.shape[1]
    for c in range(n):
        if not (a[c, c, 0] > 0.0 or a[c, c, 1] < 0.0):
            return False
        for r in range(c + 1, n):
            if a[r, c, 0] == 0.0 and a[r, c, 1] == 0.0:
                continue
            f_lo, f_hi = div(a[r, c, 0], a[r, c, 1], a[c, c, 0], a[c, c, 1])
            for k in range(c + 1, n):
                _take(a, r, c, k, f_lo, f_hi)
            for k in range(m):
                _take(b, r, c, k, f_lo, f_hi)
    for c in range(n - 1, -1, -1):
        for k in range(m):
            lo, hi = b[c, k, 0], b[c, k, 1]
            for j in range(c + 1, n):
                p_lo, p_hi = mul(a[c, j, 0], a[c, j, 1], b[j, k, 0], b[j, k, 1])
                lo, hi = sub(lo, hi, p_lo, p_hi)
            b[c, k, 0], b[c, k, 1] = div(lo, hi, a[c, c, 0], a[c, c, 1])
    return bool(np.isfinite(b).all())


@inner
def _take(of: Floats, r: int, c: int, k: int, lo: float, hi: float) -> None:
    """Row r minus [lo, hi] times row c, in column k."""
    p_lo, p_hi = mul(lo, hi, of[c, k, 0], of[c, k, 1])
    of[r, k, 0], of[r, k, 1] = sub(of[r, k, 0], of[r, k, 1], p_lo, p_hi)


@inner
def cross(a: Floats, b: Floats, out: Floats) -> None:
    """Cross product of interval vectors (3, 2)."""
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        p_lo, p_hi = mul(a[j, 0], a[j, 1], b[k, 0], b[k, 1])
        q_lo, q_hi = mul(a[k, 0], a[k, 1], b[j, 0], b[j, 1])
        out[i, 0], out[i, 1] = sub(p_lo, p_hi, q_lo, q_hi)


@inner
def dot(a: Floats, b: Floats) -> Pair:
    """Product of interval vectors (3, 2)."""
    lo, hi = 0.0, 0.0
    for i in range(3):
        p_lo, p_hi = mul(a[i, 0], a[i, 1], b[i, 0], b[i, 1])
        lo, hi = add(lo, hi, p_lo, p_hi)
    return lo, hi
