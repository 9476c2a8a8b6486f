"""Proof of a jam: the exhaustive enumeration of contact modes.

A contact of the step is in one of four modes. With the unknowns ``(λ_n, λ_f+, λ_f−, γ)`` and their
complements ``w`` of one contact, each mode says which of each pair may be positive:

============  ========================  =====================================
mode          may be positive           meaning
============  ========================  =====================================
separate      w_n, w_f+, w_f−, γ        no force, the gap may open
stick         λ_n, λ_f+, λ_f−, w_γ      no slip, force inside the cone
slip +        λ_n, λ_f+, w_f−, γ        force on the + edge of the cone
slip −        λ_n, w_f+, λ_f−, γ        force on the − edge of the cone
============  ========================  =====================================

The four cover all sixteen choices, since λ_n = 0 forces λ_f± = 0, and w_f± = γ = 0 is a stick.
So the problem has a solution if and only if, for one of the 4^k combinations, ``q`` is a
non-negative sum of the columns ``e_i`` (for ``w_i``) and ``−M_i`` (for ``z_i``). The sums are
decided by the first phase of the simplex method, which takes singular modes (two contacts that
stick) as they come; a sum that it finds is checked against the columns as given. Nothing is shared
with the pivots of Lemke's method.

Source: the contact modes of D. E. Stewart, J. C. Trinkle 1996,
doi:10.1002/(SICI)1097-0207(19960815)39:15<2673::AID-NME972>3.0.CO;2-I.
"""

import numpy as np
import numpy.typing as npt
from numba import njit

_F = npt.NDArray[np.float64]
_I = npt.NDArray[np.int64]

_TOLERANCE = 1e-9  # of a sum that equals q, relative to its largest term from 1 to _LARGEST
_LARGEST = 1e4
_NOISE = 1e-12  # entries below this part of the largest of their column are rounding
_PIVOTS_PER_ROW = 60

_NONE, _FOUND, _UNDECIDED = 0, 1, 2


@njit(cache=True, error_model="numpy")
def some_mode_holds(n: int, M: _F, q: _F) -> bool:
    """Tell whether any contact mode solves the step.

    Parameters
    ----------
    n
        Size of the problem, four times the number of contacts.
    M
        (≥n, ≥n) matrix of the contact problem, four rows per contact in the order of the module
        docstring.
    q
        (≥n,) vector.

    Returns
    -------
    bool
        True if the linear complementarity problem has a solution, or if that could not be
        decided; False proves a jam, within rounding.
    """
    contacts = n // 4
    table = np.empty((n + 1, n + 1))
    basic = np.empty(n, np.int64)
    for code in range(4**contacts):
        _fill(n, M, q, code, table)
        outcome = _first_phase(n, table, basic)
        if outcome == _UNDECIDED or (outcome == _FOUND and _equals(n, M, q, code, table, basic)):
            return True
    return False


@njit(cache=True, error_model="numpy")
def _uses_z(mode: int, unknown: int) -> bool:
    """Whether `unknown` (0 λ_n, 1 λ_f+, 2 λ_f−, 3 γ) rather than its complement may be positive."""
    if mode == 0:  # separate
        return unknown == 3
    if mode == 1:  # stick
        return unknown != 3
    return unknown != 4 - mode  # slip + leaves out λ_f−, slip − leaves out λ_f+


@njit(cache=True, error_model="numpy")
def _entry(M: _F, code: int, i: int, j: int) -> float:
    """Return entry i of the column that the modes choose for the pair j."""
    if _uses_z((code >> (2 * (j // 4))) & 3, j % 4):
        return -M[i, j]
    return 1.0 if i == j else 0.0


@njit(cache=True, error_model="numpy")
def _fill(n: int, M: _F, q: _F, code: int, table: _F) -> None:
    """Write ``[columns | q]`` with q ≥ 0, and below it the sum of the rows (the reduced cost)."""
    for j in range(n + 1):
        table[n, j] = 0.0
    for i in range(n):
        sign = -1.0 if q[i] < 0.0 else 1.0
        for j in range(n):
            table[i, j] = sign * _entry(M, code, i, j)
            table[n, j] += table[i, j]
        table[i, n] = sign * q[i]
        table[n, n] += table[i, n]


@njit(cache=True, error_model="numpy")
def _first_phase(n: int, table: _F, basic: _I) -> int:
    """First phase of the simplex method with Bland's rule; artificial columns are not kept."""
    for i in range(n):
        basic[i] = n  # artificial
    for _ in range(_PIVOTS_PER_ROW * n):
        if table[n, n] <= _TOLERANCE:
            return _FOUND
        column, row = np.int64(0), np.int64(-1)
        while row < 0 and column < n:
            row = _leaving_row(n, table, basic, column)
            column += 1
        if row < 0:
            return _NONE
        basic[row] = column - 1
        _eliminate(n, table, row, column - 1)
    return _UNDECIDED


@njit(cache=True, error_model="numpy")
def _leaving_row(n: int, table: _F, basic: _I, column: int) -> int:
    """Row with the smallest ratio, or -1 if the column does not lessen the infeasibility.

    Among ties an artificial variable leaves first, then the lowest variable (Bland).
    """
    noise = _NOISE
    for i in range(n):
        noise = max(noise, _NOISE * abs(table[i, column]))
    row = -1
    least = np.inf
    for i in range(n if table[n, column] > n * noise else 0):
        if table[i, column] > noise:
            ratio = table[i, n] / table[i, column]
            rank = -1 if basic[i] == n else basic[i]
            if ratio < least or (ratio == least and basic[row] != n and rank < basic[row]):
                least = ratio
                row = i
    return row


@njit(cache=True, error_model="numpy")
def _equals(n: int, M: _F, q: _F, code: int, table: _F, basic: _I) -> bool:
    """Check the sum that was found against the columns and the vector as they were given."""
    largest = 1.0
    for i in range(n):
        largest = max(largest, table[i, n])
    limit = _TOLERANCE * min(largest, _LARGEST)
    for i in range(n):
        rest = -q[i]
        for r in range(n):
            if basic[r] < n:
                rest += table[r, n] * _entry(M, code, i, basic[r])
        if not abs(rest) <= limit:
            return False
    return True


@njit(cache=True, error_model="numpy")
def _eliminate(n: int, table: _F, row: int, column: int) -> None:
    """Gauss-Jordan step on the rows and the reduced cost."""
    pivot = table[row, column]
    for j in range(n + 1):
        table[row, j] /= pivot
    for i in range(n + 1):
        factor = table[i, column]
        if i != row and factor != 0.0:
            for j in range(n + 1):
                table[i, j] -= factor * table[row, j]
