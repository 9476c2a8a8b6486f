r"""Lemke's method for linear complementarity problems, for planar contact steps.

Find ``z`` with ``w = M z + q``, ``z ≥ 0``, ``w ≥ 0`` and ``z · w = 0``. An artificial variable
``z_0`` is added, ``w = M z + q + 1 z_0``, and complementary pivots are taken until it leaves the
basis (a solution) or until the driving variable can grow for ever (a secondary ray).

The tableau is condensed to ``n`` basic variables by ``n + 2`` columns, those of the nonbasic
variables and the right-hand side: ``basic = rhs + T nonbasic``. It is stored by columns, each
padded to a multiple of four, with one more column of scratch. Degenerate vertices are left by the lexicographic
rule, which perturbs ``q`` by ``(ε, ε², …)``. The inverse basis it needs is not stored: its j-th
column is the negative of the column of ``w_j`` if ``w_j`` is nonbasic and a unit vector if not.

Variables are numbered ``w_i = i``, ``z_i = n + i``, ``z_0 = 2 n``.

Sources: R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem*, algorithm
4.4.5 and section 4.9; D. E. Stewart, J. C. Trinkle 1996,
doi:10.1002/(SICI)1097-0207(19960815)39:15<2673::AID-NME972>3.0.CO;2-I.
"""

import numpy as np
from numba import njit

from meso_robust.kernels import sealed
from meso_robust.types import Floats, Ints

SOLVED = 0
"""A solution was found and passed the residual check."""
RAY = 1
"""The pivots ended on a secondary ray: no solution was found."""
PIVOT_LIMIT = 2
"""The pivots did not end."""
RESIDUAL = 3
"""The pivots ended on a point that fails the residual check."""

TOLERANCE = 1e-9
"""Largest residual of a solution, relative to max(1, |q|, z) up to `LARGEST`."""
LARGEST = 1e4
"""Forces beyond this do not loosen the residual check any more."""

_SMALL_PIVOT = 1e-11  # entries are of order 1; what should vanish is left at about 1e-16
_TIE = 1e-12  # numbers this close count as equal, relative to them
_ROUNDING = 1e-14  # and ratios this close in any case
_ZERO = 1e-10  # a z_0 this small has left, even if rounding let another row leave in its place
_PIVOTS_PER_ROW = 30  # beyond it the pivots are taken to cycle


@sealed
def lemke(n: int, M: Floats, q: Floats, z: Floats, tableau: Floats, index: Ints) -> int:
    """Solve ``0 ≤ z ⊥ M z + q ≥ 0``.

    The entries of `M` and `q` should be of order one, since what counts as zero is absolute.

    Parameters
    ----------
    n
        Size of the problem; only the leading part of each array is used.
    M
        (≥n, ≥n) matrix, left as it is.
    q
        (≥n,) vector, left as it is.
    z
        (≥n,) receives the solution, or zeros if there is none.
    tableau
        (≥n+3, ≥m) workspace, with m the next multiple of four from n.
    index
        (≥4n+2,) workspace.

    Returns
    -------
    int
        `SOLVED`, `RAY`, `PIVOT_LIMIT` or `RESIDUAL`.
    """
    # Of a fixed type: for a literal Numba would compile the functions below once more.
    first, no_row = np.int64(0), np.int64(-1)
    for i in range(n):
        z[i] = 0.0
        # The last of several lowest entries: the perturbed q is lowest there.
        first = np.int64(i) if q[i] <= q[first] else first
    if q[first] >= 0.0:
        return SOLVED
    _start(n, M, q, first, tableau, index)
    column = first
    for _ in range(_PIVOTS_PER_ROW * n):
        row = _blocking_row(n, tableau, index, column)
        if row < 0:
            return RAY
        leaving = index[row]
        if leaving == 2 * n:
            return _read(n, M, q, z, tableau, index, row, column)
        _pivot(n, tableau, row, column)
        index[row] = index[n + column]
        index[n + column] = leaving
        index[2 * n + 1 + leaving] = column
        if tableau[n + 1, first] <= _ZERO:  # z_0 stays in the row it entered
            return _read(n, M, q, z, tableau, index, no_row, column)
        # The column of the complement: it left the basis earlier or has never entered it.
        column = index[2 * n + 1 + (leaving + n if leaving < n else leaving - n)]
    return PIVOT_LIMIT


@njit(error_model="numpy", forceinline=True)
def _start(n: int, M: Floats, q: Floats, first: int, tableau: Floats, index: Ints) -> None:
    """Fill the tableau with ``w = q + M z + 1 z_0`` after ``w_first`` was exchanged for ``z_0``.

    `index` holds the basic variable of each row, then the nonbasic variable of each column, then
    the last known column of each variable (stale while the variable is basic).
    """
    for j in range(n):
        for i in range(n):
            tableau[j, i] = M[i, j] - M[first, j]
        tableau[j, first] = -M[first, j]
        tableau[n, j] = 1.0
        tableau[n + 1, j] = q[j] - q[first]
        index[j] = j
        index[n + j] = n + j
        index[2 * n + 1 + j] = 0
        index[3 * n + 1 + j] = j
    tableau[n + 1, first] = -q[first]
    for j in range(n + 3):
        for i in range(n, (n + 3) // 4 * 4):
            tableau[j, i] = 0.0
    index[first] = 2 * n
    index[2 * n] = first
    index[2 * n + 1 + first] = n


@njit(error_model="numpy", forceinline=True)
def _pivot(n: int, tableau: Floats, row: int, column: int) -> None:
    """Exchange the basic variable of `row` with the nonbasic variable of `column`.

    Rows go in blocks of four, loaded before any is stored, for the compiler to use its vectors.
    """
    inverse = 1.0 / tableau[column, row]
    for i in range(n):
        tableau[n + 2, i] = tableau[column, i]
    for j in range(n + 2):
        factor = -tableau[j, row] * inverse
        for i in range(0, n, 4):
            a = tableau[j, i] + factor * tableau[n + 2, i]
            b = tableau[j, i + 1] + factor * tableau[n + 2, i + 1]
            c = tableau[j, i + 2] + factor * tableau[n + 2, i + 2]
            d = tableau[j, i + 3] + factor * tableau[n + 2, i + 3]
            tableau[j, i] = a
            tableau[j, i + 1] = b
            tableau[j, i + 2] = c
            tableau[j, i + 3] = d
        tableau[j, row] = factor
    for i in range(n):
        tableau[column, i] = tableau[n + 2, i] * inverse
    tableau[column, row] = inverse


@njit(error_model="numpy", forceinline=True)
def _blocking_row(n: int, tableau: Floats, index: Ints, column: int) -> int:
    """Row that blocks the growth of the driving variable first, or -1 on a ray."""
    # Choices by value and few branches: which row blocks is as good as random to the processor.
    for i in range(n):
        slope = -tableau[column, i]
        ratio = tableau[n + 1, i] / slope
        tableau[n + 2, i] = ratio if slope > _SMALL_PIVOT else np.inf
    least = tableau[n + 2, 0]
    best = int(np.int64(0))  # of a fixed type, not to compile for a literal
    for i in range(1, n):
        lower = tableau[n + 2, i] < least
        least = tableau[n + 2, i] if lower else least
        best = i if lower else best
    if least == np.inf:
        return -1
    limit = least + _TIE * least + _ROUNDING
    ties = 0
    for i in range(n):
        ties += tableau[n + 2, i] <= limit
    if ties > 1:
        for i in range(n):
            tied = tableau[n + 2, i] <= limit and i != best
            if tied and _goes_first(n, tableau, index, column, i, best):
                best = i
    return best


@sealed
def _goes_first(n: int, tableau: Floats, index: Ints, column: int, i: int, best: int) -> bool:
    """Break a tie between two rows: the artificial variable first, then lexicographically."""
    if index[i] == 2 * n or index[best] == 2 * n:
        return bool(index[i] == 2 * n)
    slope_i = -tableau[column, i]
    slope_best = -tableau[column, best]
    for j in range(n):
        at = index[2 * n + 1 + j]
        if index[i] == j:
            difference = 1.0 / slope_i
        elif index[best] == j:
            difference = -1.0 / slope_best
        elif index[n + at] == j:
            difference = tableau[at, best] / slope_best - tableau[at, i] / slope_i
        else:
            difference = 0.0
        if abs(difference) > _TIE:
            return bool(difference < 0.0)
    return False


@njit(error_model="numpy", forceinline=True)
def _read(
    n: int, M: Floats, q: Floats, z: Floats, tableau: Floats, index: Ints, row: int, column: int
) -> int:
    """Exchange ``z_0`` for the driving variable, write the solution and check it.

    With a negative `row`, ``z_0`` is dropped as it is. The check is against the problem as given.
    """
    step = -tableau[n + 1, row] / tableau[column, row] if row >= 0 else 0.0
    scale = 1.0
    for i in range(n):
        scale = max(scale, abs(q[i]))
        variable = index[n + column] if i == row else index[i]
        if n <= variable < 2 * n:
            value = step if i == row else tableau[n + 1, i] + step * tableau[column, i]
            z[variable - n] = value
            scale = max(scale, value)
    limit = TOLERANCE * min(scale, LARGEST)
    for i in range(n):
        w = q[i]
        for j in range(n):
            w += M[i, j] * z[j]
        # Written so that a NaN fails; the smaller of the pair bounds their product.
        if not (z[i] >= -limit and w >= -limit and min(z[i], w) <= limit):
            return RESIDUAL
    return SOLVED
