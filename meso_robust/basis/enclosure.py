"""Enclosure of the unknowns of one combination of modes over one box of parameters.

With the middle m of the box and an approximate solution x0 there, ``A(p) (x - x0) = b(p) - A(p) x0``.
Both sides are taken in their mean-value form about m and multiplied by an approximate inverse of
``A(m)`` before anything is summed over the box, so that what the parameters do together cancels
where it does in truth; interval elimination solves the rest. The enclosure is second order in the
width of the box. Source: A. Neumaier, Interval Methods for Systems of Equations, 1990, section 4.1.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from meso_robust.basis.layout import Layout
from meso_robust.basis.linear import eliminate, grow, invert, scale
from meso_robust.basis.problem import DRAG, MINUS, PER_CONTACT, PLUS
from meso_robust.bounds.arithmetic import Pair, add, down, mul, up
from meso_robust.bounds.tape import run
from meso_robust.kernels import inner, maker
from meso_robust.types import Floats, Ints


class Tapes(NamedTuple):
    """The problem as the kernels read it; fields as in :class:`~meso_robust.basis.problem.Problem`."""

    code: Ints
    constant: Floats
    slope_code: Ints
    slope_constant: Floats
    slots: int
    first: Ints
    by: Ints


class Work(NamedTuple):
    """What is known on the box in hand, and scratch; not shared between threads."""

    slots: Floats
    middle: Floats
    """(pieces, 2) at the middle of the box."""
    value: Floats
    """(pieces, 2) over the box."""
    slope: Floats
    """(derivatives, 2) over the box."""
    reach: Floats
    """(varying, 2): parameter less its middle."""
    inverse: Floats
    left: Floats
    """(n, n, 2) the preconditioned matrix."""
    right: Floats
    """(n, 1, 2) the solution."""
    spread: Floats
    """(n, varying, 2): derivative of the preconditioned residual."""
    choice: Floats
    """(4,) relation between the forces of a redundant pair."""


@maker
def new_work(slots: int, pieces: int, derivatives: int, varying: int, n: int) -> Work:
    """Scratch for boxes of one problem."""
    return Work(
        np.empty((slots, 2)),
        np.empty((pieces, 2)),
        np.empty((pieces, 2)),
        np.empty((derivatives, 2)),
        np.empty((varying, 2)),
        np.empty((n, n)),
        np.empty((n, n, 2)),
        np.empty((n, 1, 2)),
        np.empty((n, varying, 2)),
        np.empty(4),
    )


@maker
def visit(tapes: Tapes, work: Work, lo: Floats, hi: Floats) -> None:
    """Evaluate all pieces on one box, which later calls are about."""
    middle = 0.5 * (lo + hi)
    run(tapes.code, tapes.constant, middle, middle, work.slots, work.middle)
    run(tapes.code, tapes.constant, lo, hi, work.slots, work.value)
    run(tapes.slope_code, tapes.slope_constant, lo, hi, work.slots, work.slope)
    for k in range(work.reach.shape[0]):
        fixed = lo[k] == hi[k]
        work.reach[k, 0] = 0.0 if fixed else down(lo[k] - middle[k])
        work.reach[k, 1] = 0.0 if fixed else up(hi[k] - middle[k])


@maker
def solve(tapes: Tapes, of: Layout, m: int, work: Work) -> bool:
    """Write every solution of combination ``m`` over the box into ``work.right``.

    True proves that the system is regular on the whole box.
    """
    if of.pair[m, 2] != 0:
        return False
    n = of.kind.shape[1]
    if of.pair[m, 0] >= 0 and not _choose(of, m, work):
        return False
    guess = np.zeros(n)
    if not _approximate(of, m, work, guess):
        return False
    _precondition(tapes, of, m, work, guess)
    if not eliminate(work.left, work.right):
        for i in range(n):
            work.right[i, 0, 0] = work.right[i, 0, 1] = guess[
                i
            ]  # a guess, to choose a side to split
        return False
    for i in range(n):
        grow(work.right, i, 0, (guess[i], guess[i]))
    return True


@maker
def _approximate(of: Layout, m: int, work: Work, guess: Floats) -> bool:
    """Fill ``work.inverse`` and ``guess`` (n,) at the middle of the box, in plain floating point."""
    n = guess.size
    matrix = np.empty((n, n))
    for i in range(n):
        for j in range(n):
            lo, hi = _entry(of, m, work, i, j)
            matrix[i, j] = 0.5 * (lo + hi)
    if not invert(matrix, work.inverse):
        return False
    for r in range(n):
        guess[r] = 0.0
        for i in range(n):
            lo, hi = _entry(of, m, work, i, n)
            guess[r] += work.inverse[r, i] * (0.5 * (lo + hi))
    return True


@inner
def _entry(of: Layout, m: int, work: Work, i: int, j: int) -> tuple[float, float]:
    """Entry of the matrix, or of the right side, at the middle of the box."""
    piece, fixed = of.piece[m, i, j], of.constant[m, i, j]
    if piece >= 0:
        if of.sign[m, i, j] < 0.0:
            return -work.middle[piece, 1], -work.middle[piece, 0]
        return work.middle[piece, 0], work.middle[piece, 1]
    if of.pair[m, 0] >= 0 and i == 4 + 2 * of.pair[m, 1]:
        for k in range(4):
            if j == 3 + 2 * of.pair[m, k // 2] + k % 2:
                return work.choice[k], work.choice[k]
    return fixed, fixed


@maker
def _precondition(tapes: Tapes, of: Layout, m: int, work: Work, guess: Floats) -> None:
    """Fill ``work.left``, ``work.right`` (residual of the guess) and ``work.spread``."""
    n, varying = work.inverse.shape[0], work.reach.shape[0]
    work.left[:], work.right[:], work.spread[:] = 0.0, 0.0, 0.0
    turn = np.empty((n, varying, 2))
    for j in range(n + 1):
        _turn(tapes, of, m, work, j, turn)
        weight = 1.0 if j == n else -guess[j]
        for r in range(n):
            middle = _row_times_column(of, m, work, r, j)
            grow(work.right, r, 0, scale(weight, middle[0], middle[1]))
            if j < n:
                grow(work.left, r, j, middle)
            for k in range(varying):
                lo, hi = turn[r, k, 0], turn[r, k, 1]
                if lo == 0.0 and hi == 0.0:
                    continue
                grow(work.spread, r, k, scale(weight, lo, hi))
                if j < n:
                    grow(work.left, r, j, mul(lo, hi, work.reach[k, 0], work.reach[k, 1]))
    for r in range(n):
        for k in range(varying):
            lo, hi = work.spread[r, k, 0], work.spread[r, k, 1]
            grow(work.right, r, 0, mul(lo, hi, work.reach[k, 0], work.reach[k, 1]))


@inner
def _row_times_column(of: Layout, m: int, work: Work, r: int, j: int) -> Pair:
    """Row r of the approximate inverse times column j at the middle of the box."""
    lo, hi = 0.0, 0.0
    for i in range(work.inverse.shape[0]):
        e_lo, e_hi = _entry(of, m, work, i, j)
        if e_lo != 0.0 or e_hi != 0.0:
            p_lo, p_hi = scale(work.inverse[r, i], e_lo, e_hi)
            lo, hi = add(lo, hi, p_lo, p_hi)
    return lo, hi


@inner
def _turn(tapes: Tapes, of: Layout, m: int, work: Work, j: int, turn: Floats) -> None:
    """Fill ``turn`` (n, varying, 2): derivatives of column j over the box, preconditioned."""
    n = turn.shape[0]
    turn[:] = 0.0
    for i in range(n):
        piece, sign = of.piece[m, i, j], of.sign[m, i, j]
        if piece < 0:
            continue
        for q in range(tapes.first[piece], tapes.first[piece + 1]):
            for r in range(n):
                factor = sign * work.inverse[r, i]
                if factor != 0.0:
                    slope = scale(factor, work.slope[q, 0], work.slope[q, 1])
                    grow(turn, r, tapes.by[q], slope)


@maker
def derivatives(tapes: Tapes, of: Layout, m: int, work: Work, out: Floats) -> bool:
    """Enclose the derivatives of all unknowns by all varying parameters, (n, varying, 2).

    ``A dx/dp = db/dp - dA/dp x`` over the box, after :func:`solve`.
    """
    n, varying = work.inverse.shape[0], work.reach.shape[0]
    solution = work.right.copy()
    turn = np.empty((n, varying, 2))
    out[:] = 0.0
    for j in range(n + 1):
        _turn(tapes, of, m, work, j, turn)
        for r in range(n):
            for k in range(varying):
                lo, hi = turn[r, k, 0], turn[r, k, 1]
                if j < n:
                    lo, hi = mul(-hi, -lo, solution[j, 0, 0], solution[j, 0, 1])
                grow(out, r, k, (lo, hi))
    _precondition(tapes, of, m, work, np.zeros(n))
    work.right[:] = solution
    return eliminate(work.left, out)


@maker
def _choose(of: Layout, m: int, work: Work) -> bool:
    """Choose the relation between the forces of a redundant pair: ``choice . forces = 0``.

    At the middle of the box the forces are a line ``a + s N``, N the internal force. The relation
    holds where the least of the four is largest, and in proportion for any load. Any choice proves
    the same: forces that satisfy it exist.
    """
    n = of.kind.shape[1]
    _internal(of, m, work)
    inside = work.choice.copy()
    size = np.sqrt(np.sum(inside**2))
    if not (size > 0.0 and size < np.inf):
        return False
    inside /= size
    work.choice[:] = inside
    base = np.zeros(n)
    if not _approximate(of, m, work, base):
        return False
    along = work.inverse[:, 4 + 2 * of.pair[m, 1]]
    first, second = 3 + 2 * of.pair[m, 0], 3 + 2 * of.pair[m, 1]
    a = np.array([base[first], base[first + 1], base[second], base[second + 1]])
    b = np.array([along[first], along[first + 1], along[second], along[second + 1]])
    best = a + _highest(a, b) * b
    work.choice[:] = inside - np.sum(inside * best) / np.sum(best**2) * best
    return bool(np.isfinite(work.choice).all())


@maker
def _highest(a: Floats, b: Floats) -> float:
    """The s at which the least of ``a + s b`` is largest, among the crossings of two of them."""
    best, where = -np.inf, 0.0
    for i in range(4):
        for j in range(i):
            if b[i] != b[j]:
                s = (a[j] - a[i]) / (b[i] - b[j])
                least = np.min(a + s * b)
                if least > best:
                    best, where = least, s
    return where


@maker
def _internal(of: Layout, m: int, work: Work) -> None:
    """Write the forces of the pair that balance each other into ``work.choice`` (not a proof)."""
    w = np.empty((3, 4))
    for k in range(4):
        edge = PLUS if k % 2 == 0 else MINUS
        start = DRAG + PER_CONTACT * of.pair[m, k // 2] + edge
        for i in range(3):
            w[i, k] = 0.5 * (work.middle[start + i, 0] + work.middle[start + i, 1])
    for k in range(4):
        p, q, r = (k + 1) % 4, (k + 2) % 4, (k + 3) % 4
        determinant = (
            w[0, p] * (w[1, q] * w[2, r] - w[2, q] * w[1, r])
            - w[0, q] * (w[1, p] * w[2, r] - w[2, p] * w[1, r])
            + w[0, r] * (w[1, p] * w[2, q] - w[2, p] * w[1, q])
        )
        work.choice[k] = determinant if k % 2 == 0 else -determinant
