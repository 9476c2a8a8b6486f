"""Least squares in non-negative unknowns: the nearest point of a cone.

The residual of the solution is also the proof if the point is not in the cone: with ``r = q − A x``,
``A_jᵀ r ≤ 0`` for every column and ``rᵀ q = |r|² > 0``, the plane across r separates q from the cone.

Source: C. L. Lawson, R. J. Hanson, *Solving Least Squares Problems*, chapter 23,
doi:10.1137/1.9781611971217; each subproblem by Householder reflections.
"""

import numpy as np

from meso_robust.kernels import sealed
from meso_robust.types import Floats, Ints

_DEPENDENT = 1e-12  # of the length of a column: what is left of it when it depends on others
_FLAT = 1e-13  # of the lengths: a gradient this small is none
_ROUNDS = 6  # per column


@sealed
def nearest(A: Floats, q: Floats, x: Floats, r: Floats, space: Floats, order: Ints) -> bool:
    """Minimise ``|q − Σ x_j A_j|`` over ``x ≥ 0``.

    Parameters
    ----------
    A
        (m, n) columns, one a row.
    q
        (n,)
    x
        (m,) receives the minimiser.
    r
        (n,) receives the residual ``q − Σ x_j A_j``.
    space
        (n + 4, max(m, n) + 1) workspace.
    order
        (2 m,) workspace.

    Returns
    -------
    bool
        False if the iteration did not end.
    """
    m, n = A.shape
    gradient, trial = space[n], space[n + 1]
    count = int(np.int64(0))  # of a fixed type, not to compile for a literal
    for j in range(m):
        x[j] = 0.0
        order[m + j] = 0  # 1 in the passive set, 2 left out for this round
    for i in range(n):
        r[i] = q[i]
    for _ in range(_ROUNDS * m):
        entering = _steepest(A, r, gradient, order)
        if entering < 0:
            return True
        order[count], order[m + entering] = entering, 1
        count += 1
        if not _solve(A, q, order, count, space, trial) or not trial[count - 1] > 0.0:
            count -= 1
            order[m + entering] = 2
            continue
        count = _settle(A, q, x, order, count, space, trial)
        if count < 0:
            return False
        _remainder(A, q, x, r, order, count)
    return False


@sealed
def _remainder(A: Floats, q: Floats, x: Floats, r: Floats, order: Ints, count: int) -> None:
    """Write the residual; columns left out for a round may enter again."""
    m, n = A.shape
    for j in range(m):
        if order[m + j] == 2:
            order[m + j] = 0
    for i in range(n):
        r[i] = q[i]
        for k in range(count):
            r[i] -= x[order[k]] * A[order[k], i]


@sealed
def _steepest(A: Floats, r: Floats, gradient: Floats, order: Ints) -> int:
    """Column along which the residual falls fastest, or -1."""
    m, n = A.shape
    size = 0.0
    for i in range(n):
        size += r[i] * r[i]
    size = np.sqrt(size)
    best, most = -1, 0.0
    for j in range(m):
        along, length = 0.0, 0.0
        for i in range(n):
            along += A[j, i] * r[i]
            length += A[j, i] * A[j, i]
        gradient[j] = along
        if order[m + j] == 0 and length > 0.0:
            slope = along / np.sqrt(length)
            if slope > _FLAT * max(size, 1.0) and slope > most:
                best, most = j, slope
    return best


@sealed
def _settle(
    A: Floats, q: Floats, x: Floats, order: Ints, count: int, space: Floats, trial: Floats
) -> int:
    """Go to the minimum over the passive columns, dropping those that would become negative.

    Returns the number of passive columns, or -1 if the columns depend on each other.
    """
    m = A.shape[0]
    while True:
        share = 1.0
        for k in range(count):
            if trial[k] <= 0.0:
                old = x[order[k]]
                share = min(share, old / (old - trial[k]))
        for k in range(count):
            x[order[k]] += share * (trial[k] - x[order[k]])
        if share == 1.0:
            return count
        kept = int(np.int64(0))
        for k in range(count):
            j = order[k]
            if trial[k] <= 0.0 and x[j] <= 1e-14 * (1.0 + abs(trial[k])):
                x[j] = 0.0
                order[m + j] = 0
            else:
                order[kept] = j
                kept += 1
        if kept == count or not _solve(A, q, order, kept, space, trial):
            return -1
        count = kept


@sealed
def _solve(A: Floats, q: Floats, order: Ints, count: int, space: Floats, s: Floats) -> bool:
    """Least squares over the passive columns; False if one depends on those before it."""
    n = A.shape[1]
    if count > n:
        return False
    for i in range(n):
        for k in range(count):
            space[i, k] = A[order[k], i]
        space[i, count] = q[i]
    diagonal = space[n + 2]
    for k in range(count):
        if not _reflect(space, diagonal, n, k, count):
            return False
    for k in range(count - 1, -1, -1):
        s[k] = space[k, count]
        for c in range(k + 1, count):
            s[k] -= space[k, c] * s[c]
        s[k] /= diagonal[k]
    return True


@sealed
def _reflect(space: Floats, diagonal: Floats, n: int, k: int, count: int) -> bool:
    """Householder reflection that clears column k below its diagonal; False if nothing is left."""
    norm, whole = 0.0, 0.0
    for i in range(n):
        whole += space[i, k] ** 2
        norm += space[i, k] ** 2 if i >= k else 0.0
    norm = np.sqrt(norm)
    if norm <= _DEPENDENT * np.sqrt(whole):
        return False
    alpha = -norm if space[k, k] > 0.0 else norm
    scale = 1.0 / (norm * (norm + abs(space[k, k])))
    space[k, k] -= alpha
    for c in range(k + 1, count + 1):
        along = 0.0
        for i in range(k, n):
            along += space[i, k] * space[i, c]
        for i in range(k, n):
            space[i, c] -= scale * along * space[i, k]
    diagonal[k] = alpha
    return True
