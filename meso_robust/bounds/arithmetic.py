"""Outward-rounded interval operations on pairs of doubles.

Every operation returns an interval that holds the exact result for every pair of points of its
arguments; where the operation is undefined for some point, it returns the whole line, so that
nothing can be proved from it. IEEE 754 rounds + - * / sqrt correctly, so one step outward is enough
for them; sin, cos and log are summed here from series with enclosed remainders, because a system's
libm promises nothing.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

Pair = tuple[float, float]

EPS = 2.0**-52
TINY = 5e-324
HALF_PI = (1.5707963267948966, 1.5707963267948968)  # neighbours: the first is below pi/2
LN2 = (0.6931471805599453, 0.6931471805599454)  # neighbours: the first is below log 2
ARGUMENT_LIMIT = 1e3  # beyond it the reduction of an angle is too coarse to be of use


@njit(cache=True, inline="always")
def down(x: float) -> float:
    """Return a double at or below the predecessor of ``x`` (-inf for an undefined one).

    ``|x| 2^-52`` is exact and at least one unit in the last place, so the difference, rounded or
    not, lies at least that far below.
    """
    r = x - (abs(x) * EPS + TINY)
    return r if r == r else -np.inf


@njit(cache=True, inline="always")
def up(x: float) -> float:
    """Return a double at or above the successor of ``x`` (inf for an undefined one)."""
    r = x + (abs(x) * EPS + TINY)
    return r if r == r else np.inf


@njit(cache=True)
def add(a: float, b: float, c: float, d: float) -> Pair:
    """[a, b] + [c, d]."""
    return down(a + c), up(b + d)


@njit(cache=True)
def sub(a: float, b: float, c: float, d: float) -> Pair:
    """[a, b] - [c, d]."""
    return down(a - d), up(b - c)


@njit(cache=True)
def mul(a: float, b: float, c: float, d: float) -> Pair:
    """[a, b] * [c, d]."""
    p, q, r, s = a * c, a * d, b * c, b * d
    if p + q + r + s != p + q + r + s:  # a NaN among them, from 0 * inf or inf - inf
        return -np.inf, np.inf
    return down(min(min(p, q), min(r, s))), up(max(max(p, q), max(r, s)))


@njit(cache=True)
def div(a: float, b: float, c: float, d: float) -> Pair:
    """[a, b] / [c, d]; the whole line if the divisor may be zero."""
    if not (c > 0.0 or d < 0.0):
        return -np.inf, np.inf
    p, q, r, s = a / c, a / d, b / c, b / d
    if p + q + r + s != p + q + r + s:
        return -np.inf, np.inf
    return down(min(min(p, q), min(r, s))), up(max(max(p, q), max(r, s)))


@njit(cache=True)
def sq(a: float, b: float) -> Pair:
    """[a, b]^2."""
    p, q = a * a, b * b
    if a <= 0.0 <= b:
        return 0.0, up(max(p, q))
    return max(0.0, down(min(p, q))), up(max(p, q))


@njit(cache=True)
def sqrt(a: float, b: float) -> Pair:
    """Square root; the whole line if the argument may be negative."""
    if not a >= 0.0:
        return -np.inf, np.inf
    return max(0.0, down(math.sqrt(a))), up(math.sqrt(b))


@njit(cache=True)
def _series(lo: float, hi: float, first: int) -> Pair:
    """1 - x/(n(n+1)) (1 - x/((n+2)(n+3)) (1 - ...)) for x = [lo, hi] in [0, 0.7], n = first.

    The terms of the alternating series decrease, so its tail, the innermost bracket, lies in [0, 1].
    """
    inner_lo, inner_hi = 0.0, 1.0
    for k in range(11, -1, -1):
        n = float(first + 2 * k)
        t_lo, t_hi = mul(lo, hi, inner_lo, inner_hi)
        t_lo, t_hi = div(t_lo, t_hi, n * (n + 1.0), n * (n + 1.0))
        inner_lo, inner_hi = sub(1.0, 1.0, t_lo, t_hi)
    return inner_lo, inner_hi


@njit(cache=True)
def _sin_cos(x: float) -> tuple[float, float, float, float]:
    """Enclosures of sin and cos of the double ``x``, |x| <= ARGUMENT_LIMIT."""
    k = np.rint(x / HALF_PI[0])
    p_lo, p_hi = mul(k, k, HALF_PI[0], HALF_PI[1])
    r_lo, r_hi = sub(x, x, p_lo, p_hi)
    x_lo, x_hi = sq(r_lo, r_hi)
    s_lo, s_hi = _series(x_lo, x_hi, 2)
    s_lo, s_hi = mul(r_lo, r_hi, s_lo, s_hi)
    c_lo, c_hi = _series(x_lo, x_hi, 1)
    quadrant = int(k) % 4
    if quadrant == 1:
        return c_lo, c_hi, -s_hi, -s_lo
    if quadrant == 2:
        return -s_hi, -s_lo, -c_hi, -c_lo
    if quadrant == 3:
        return -c_hi, -c_lo, s_lo, s_hi
    return s_lo, s_hi, c_lo, c_hi


@njit(cache=True)
def _may_hold(a: float, b: float, phase: float) -> bool:
    """Whether [a, b] may hold phase + 2 pi k: never a wrong False.

    The margin is far above the rounding error of the two quotients.
    """
    turn = 4.0 * HALF_PI[0]
    return math.ceil((a - phase) / turn - 1e-9) <= (b - phase) / turn + 1e-9


@njit(cache=True)
def sin(a: float, b: float) -> Pair:
    """Sine."""
    if not (a > -ARGUMENT_LIMIT and b < ARGUMENT_LIMIT):
        return -1.0, 1.0
    p, q, _, _ = _sin_cos(a)
    r, s, _, _ = _sin_cos(b)
    lo = -1.0 if _may_hold(a, b, -HALF_PI[0]) else max(-1.0, min(p, r))
    hi = 1.0 if _may_hold(a, b, HALF_PI[0]) else min(1.0, max(q, s))
    return lo, hi


@njit(cache=True)
def cos(a: float, b: float) -> Pair:
    """Cosine."""
    if not (a > -ARGUMENT_LIMIT and b < ARGUMENT_LIMIT):
        return -1.0, 1.0
    _, _, p, q = _sin_cos(a)
    _, _, r, s = _sin_cos(b)
    lo = -1.0 if _may_hold(a, b, 2.0 * HALF_PI[0]) else max(-1.0, min(p, r))
    hi = 1.0 if _may_hold(a, b, 0.0) else min(1.0, max(q, s))
    return lo, hi


@njit(cache=True)
def _log_point(x: float) -> Pair:
    """Logarithm of a positive double: log(m) = 2 atanh((m-1)/(m+1)), |u| <= 0.18, plus e log 2."""
    m, e = math.frexp(x)
    if m < 0.7071:
        m, e = 2.0 * m, e - 1
    n_lo, n_hi = sub(m, m, 1.0, 1.0)
    d_lo, d_hi = add(m, m, 1.0, 1.0)
    u_lo, u_hi = div(n_lo, n_hi, d_lo, d_hi)
    v_lo, v_hi = sq(u_lo, u_hi)
    s_lo, s_hi = 0.0, 1.0  # holds the tail sum of v^j/(2(12+j)+1), as v < 0.04
    for k in range(11, -1, -1):
        t_lo, t_hi = mul(v_lo, v_hi, s_lo, s_hi)
        q_lo, q_hi = div(1.0, 1.0, 2.0 * k + 1.0, 2.0 * k + 1.0)
        s_lo, s_hi = add(q_lo, q_hi, t_lo, t_hi)
    s_lo, s_hi = mul(2.0 * u_lo, 2.0 * u_hi, s_lo, s_hi)
    b_lo, b_hi = mul(float(e), float(e), LN2[0], LN2[1])
    return add(b_lo, b_hi, s_lo, s_hi)


@njit(cache=True)
def log(a: float, b: float) -> Pair:
    """Natural logarithm; the whole line if the argument may be zero or less."""
    if not (a > 0.0 and b < np.inf):
        return -np.inf, np.inf
    return _log_point(a)[0], _log_point(b)[1]
