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
So the problem has a solution if and only if, for one of the 4^k combinations, ``q`` lies in the cone
of the columns ``e_i`` (for ``w_i``) and ``−M_i`` (for ``z_i``). The nearest point of the cone is
sought (`nonnegative`), which takes singular modes (two contacts that stick) as they come. Where it
is q itself, the sum is checked against the columns as given. Where it is not, the residual r proves
it: no column has ``A_jᵀ r > ε |A_j| |r|`` and so no sum with forces below ``|r| / ε``, which must be
`_LARGEST`, is q. A mode that is neither is undecided. Nothing is shared with the pivots of Lemke's method.

The combinations are walked through as a tree, one contact after the other. A contact whose mode is
not chosen yet may use both columns of each pair; if q is not in that cone, no mode below holds.

Source: the contact modes of D. E. Stewart, J. C. Trinkle 1996,
doi:10.1002/(SICI)1097-0207(19960815)39:15<2673::AID-NME972>3.0.CO;2-I.
"""

import numpy as np

from meso_robust.kernels import maker, sealed
from meso_robust.simulator.nonnegative import nearest
from meso_robust.types import Floats, Ints

_TOLERANCE = 1e-9  # of a sum that equals q, relative to its largest term from 1 to _LARGEST
_LARGEST = 1e4  # force over the support's; beyond it a jam is not told from rounding
_APART = 1e-6  # a residual that proves something
_SMALL = 1e-9  # weight of the forces beside the residual: columns that all but depend do no harm

NONE = 0
"""No contact mode solves the step: a jam, within rounding."""
FOUND = 1
"""A contact mode solves the step."""
UNDECIDED = 2
"""Some mode could be neither found nor excluded, and no other holds."""

_FREE = 4  # a contact whose mode is not chosen yet
_TREE_LIMIT = 200_000  # nodes


@maker
def new_walk(n: int) -> Ints:
    """Start of a walk through the contact modes of a problem of size n; see `next_mode`."""
    state = np.full(n // 4 + 2, _FREE, np.int64)
    state[0], state[1] = 0, 0  # depth, and whether a node was undecided
    return state


@maker
def next_mode(n: int, M: Floats, q: Floats, z: Floats, state: Ints) -> int:  # noqa: C901
    """Walk on to the next contact mode that solves the step.

    Parameters
    ----------
    n
        Size of the problem, four times the number of contacts.
    M
        (≥n, ≥n) matrix of the contact problem, four rows per contact in the order of the module
        docstring.
    q
        (≥n,) vector.
    z
        (≥n,) receives a solution of that mode.
    state
        Place of the walk, from `new_walk`; it goes on from there at the next call.

    Returns
    -------
    int
        `FOUND`; or, when the walk has ended, `NONE` or `UNDECIDED`. `NONE` of a walk from its start
        proves a jam, within rounding.
    """
    contacts = n // 4
    columns, x, r = np.empty((2 * n, n)), np.empty(2 * n), np.empty(3 * n)
    weighed = np.zeros((2 * n, 3 * n))
    space, order = np.empty((3 * n + 4, 3 * n + 1)), np.empty(4 * n, np.int64)
    goal = np.zeros(3 * n)
    for j in range(n):
        goal[j] = q[j]
        weighed[j, n + j] = weighed[n + j, 2 * n + j] = _SMALL
    modes = state[2:]
    for _ in range(_TREE_LIMIT):
        depth = state[0]
        if depth < 0:
            return UNDECIDED if state[1] else NONE
        if modes[depth] == _FREE:
            modes[depth] = 0
        elif modes[depth] == 3:
            modes[depth] = _FREE
            state[0] -= 1
            continue
        else:
            modes[depth] += 1
        used = _fill(n, M, modes, columns)
        outcome = UNDECIDED
        if nearest(columns[:used], goal[:n], x, r[:n], space, order):
            outcome = _verdict(columns[:used], x, r[:n])
        if outcome == UNDECIDED:
            # by number: a slice would bring in the text of its errors, which takes 3 s to compile
            for j in range(used):
                for i in range(n):
                    weighed[j, i] = columns[j, i]
            if nearest(weighed[:used], goal, x, r, space, order):
                outcome = _verdict(columns[:used], x, r[:n])
        if outcome != NONE and depth < contacts - 1:
            state[0] += 1
        elif outcome == UNDECIDED:
            state[1] = 1
        elif outcome == FOUND:
            _write_solution(n, modes, x, z)
            return FOUND
    return UNDECIDED


@sealed
def _uses_z(mode: int, unknown: int) -> bool:
    """Whether `unknown` (0 λ_n, 1 λ_f+, 2 λ_f−, 3 γ) rather than its complement may be positive."""
    if mode == 0:  # separate
        return unknown == 3
    if mode == 1:  # stick
        return unknown != 3
    return unknown != 4 - mode  # slip + leaves out λ_f−, slip − leaves out λ_f+


@sealed
def _fill(n: int, M: Floats, modes: Ints, columns: Floats) -> int:
    """Write the columns that the modes allow, one a row; return their number.

    Column j stands for the pair j as its mode chooses; the second columns of free contacts follow.
    """
    used = n
    for j in range(n):
        mode = modes[j // 4]
        chosen = mode != _FREE and _uses_z(mode, j % 4)
        for i in range(n):
            columns[j, i] = -M[i, j] if chosen else (1.0 if i == j else 0.0)
        if mode == _FREE:
            for i in range(n):
                columns[used, i] = -M[i, j]
            used += 1
    return used


@sealed
def _verdict(columns: Floats, x: Floats, r: Floats) -> int:
    """Tell whether q is in the cone, from the nearest point of the cone."""
    largest, size = 1.0, 0.0
    for j in range(columns.shape[0]):
        largest = max(largest, x[j])
    for i in range(r.shape[0]):
        size = max(size, abs(r[i]))
    if size <= _TOLERANCE * min(largest, _LARGEST):
        return FOUND
    square = 0.0
    for i in range(r.shape[0]):
        square += r[i] * r[i]
    for j in range(columns.shape[0]):
        along, length = 0.0, 0.0
        for i in range(r.shape[0]):
            along += columns[j, i] * r[i]
            length += columns[j, i] ** 2
        if not _LARGEST * along <= np.sqrt(length) * square:
            return UNDECIDED
    return NONE if size > _APART else UNDECIDED


@sealed
def _write_solution(n: int, modes: Ints, x: Floats, z: Floats) -> None:
    """Write z of a sum, all modes being chosen."""
    for j in range(n):
        z[j] = x[j] if _uses_z(modes[j // 4], j % 4) else 0.0
