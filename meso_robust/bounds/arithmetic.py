"""Outward-rounded interval operations on pairs of doubles.

Every operation returns an interval that holds the exact result for every pair of points of its
arguments; where the operation is undefined for some point, it returns the whole line, so that
nothing can be proved from it. IEEE 754 rounds + - * / sqrt correctly, so one step outward is enough
for them; sin, cos and log are summed here from series with bounded errors, because a system's libm
promises nothing.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

Pair = tuple[float, float]

EPS = 2.0**-52  # spacing of doubles at 1
TINY = 5e-324  # least positive double: a step outward where EPS times the number is lost
HALF_PI = (1.5707963267948966, 1.5707963267948968)  # neighbours: the first is below pi/2
TWO_OVER_PI = 0.6366197723675814
HALF_PI_HEAD = 1.5707963267341256  # the first 33 bits of pi/2: its product with |k| < 2^20 is exact
HALF_PI_TAIL = 6.077100506506192e-11  # the rest of pi/2, to within 2^-87
LN2 = (0.6931471805599453, 0.6931471805599454)  # neighbours: the first is below log 2
SINE = (
    1 / 6,
    1 / 20,
    1 / 42,
    1 / 72,
    1 / 110,
    1 / 156,
    1 / 210,
    1 / 272,
)  # 1/(n(n+1)), n = 2, 4 ..
COSINE = (1 / 2, 1 / 12, 1 / 30, 1 / 56, 1 / 90, 1 / 132, 1 / 182, 1 / 240)  # n = 1, 3 ...
ARGUMENT_LIMIT = 1e3  # beyond it the reduction of an angle is too coarse to be of use


@njit(cache=True, inline="always", error_model="numpy")
def down(x: float) -> float:
    """Round down by at least one step.

    Parameters
    ----------
    x
        A result that IEEE 754 rounded to nearest.

    Returns
    -------
    float
        A double at or below the predecessor of ``x``; -inf for a NaN.

    Notes
    -----
    ``|x| 2^-52`` is exact and at least one unit in the last place, so the difference, rounded or
    not, lies at least that far below.
    """
    r = x - (abs(x) * EPS + TINY)
    return r if r == r else -np.inf


@njit(cache=True, inline="always", error_model="numpy")
def up(x: float) -> float:
    """Round up by at least one step, as :func:`down` rounds down.

    Parameters
    ----------
    x
        A result that IEEE 754 rounded to nearest.

    Returns
    -------
    float
        A double at or above the successor of ``x``; inf for a NaN.
    """
    r = x + (abs(x) * EPS + TINY)
    return r if r == r else np.inf


@njit(cache=True, error_model="numpy")
def add(a: float, b: float, c: float, d: float) -> Pair:
    """[a, b] + [c, d].

    Parameters
    ----------
    a, b, c, d
        Ends of the two ranges.

    Returns
    -------
    lower, upper
        Rounded outward.
    """
    return down(a + c), up(b + d)


@njit(cache=True, error_model="numpy")
def sub(a: float, b: float, c: float, d: float) -> Pair:
    """[a, b] - [c, d].

    Parameters
    ----------
    a, b, c, d
        Ends of the two ranges.

    Returns
    -------
    lower, upper
        Rounded outward.
    """
    return down(a - d), up(b - c)


@njit(cache=True, error_model="numpy")
def mul(a: float, b: float, c: float, d: float) -> Pair:
    """[a, b] * [c, d].

    Parameters
    ----------
    a, b, c, d
        Ends of the two ranges.

    Returns
    -------
    lower, upper
        Rounded outward.
    """
    p, q, r, s = a * c, a * d, b * c, b * d
    if p + q + r + s != p + q + r + s:  # a NaN among them, from 0 * inf or inf - inf
        return -np.inf, np.inf
    if (a == 0.0 and b == 0.0) or (c == 0.0 and d == 0.0):  # a denormal slows what comes after
        return 0.0, 0.0
    return down(min(min(p, q), min(r, s))), up(max(max(p, q), max(r, s)))


@njit(cache=True, error_model="numpy")
def div(a: float, b: float, c: float, d: float) -> Pair:
    """[a, b] / [c, d].

    Parameters
    ----------
    a, b, c, d
        Ends of the two ranges.

    Returns
    -------
    lower, upper
        Rounded outward; the whole line if the divisor may be zero.
    """
    if not (c > 0.0 or d < 0.0):
        return -np.inf, np.inf
    p, q, r, s = a / c, a / d, b / c, b / d
    if p + q + r + s != p + q + r + s:
        return -np.inf, np.inf
    return down(min(min(p, q), min(r, s))), up(max(max(p, q), max(r, s)))


@njit(cache=True, error_model="numpy")
def sq(a: float, b: float) -> Pair:
    """[a, b]^2."""
    p, q = a * a, b * b
    if a <= 0.0 <= b:
        return 0.0, up(max(p, q))
    return max(0.0, down(min(p, q))), up(max(p, q))


@njit(cache=True, error_model="numpy")
def sqrt(a: float, b: float) -> Pair:
    """Square root; the whole line if the argument may be negative."""
    if not a >= 0.0:
        return -np.inf, np.inf
    return max(0.0, down(math.sqrt(a))), up(math.sqrt(b))


@njit(cache=True, inline="always", error_model="numpy")
def _series(x: float, weights: tuple[float, ...]) -> float:
    """1 - w0 x (1 - w1 x (1 - ...)) for x in [0, 0.62] and the weights of the sine or the cosine.

    With u = 2^-53: the terms of the alternating series decrease, so cutting it off after 9 of them
    costs less than 2e-18. A bracket lies in [0.69, 1]; if the one inside it is off by e, the product
    before it, at most x/2 at the outermost level of the cosine (x/6 of the sine) and x/12 further in,
    is off by the share 4u + 1.45e and the difference by u/2 more. So all brackets are off by less
    than 0.8u but the outermost: 2.1u for the cosine, 1.1u for the sine.
    """
    w0, w1, w2, w3, w4, w5, w6, w7 = weights
    inner = 1.0 - x * w4 * (1.0 - x * w5 * (1.0 - x * w6 * (1.0 - x * w7)))
    return 1.0 - x * w0 * (1.0 - x * w1 * (1.0 - x * w2 * (1.0 - x * w3 * inner)))


@njit(cache=True, inline="always", error_model="numpy")
def _sine(x: float, shift: float) -> Pair:
    """sin(x + shift pi/2) for shift 0 or 1, |x| <= ARGUMENT_LIMIT, and the bound of its error.

    x = k pi/2 + r. k times the first part of pi/2 is exact; the two differences and the second part
    leave an error in r of at most 2u|r| + 1.4e-26 |k|. With the errors of the series and one product
    sin(r) is off by less than the share 4.5u, cos(r) by 4.6u, plus that of k; 8u is granted.
    """
    k = np.floor(x * TWO_OVER_PI + 0.5)
    r = (x - k * HALF_PI_HEAD) - k * HALF_PI_TAIL
    square = r * r
    sine, cosine = r * _series(square, SINE), _series(square, COSINE)
    quadrant = k + shift
    quadrant -= 4.0 * np.floor(0.25 * quadrant)
    odd = quadrant - 2.0 * np.floor(0.5 * quadrant)
    value = cosine if odd == 1.0 else sine
    value = -value if quadrant >= 2.0 else value
    return value, abs(value) * (4.0 * EPS) + (abs(k) * 1e-25 + TINY)


@njit(cache=True, inline="always", error_model="numpy")
def _may_hold(a: float, b: float, quarters: float) -> bool:
    """Whether [a, b] may hold (quarters + 4 m) pi/2, m whole: never a wrong False.

    The margin is far above the rounding error of the two products.
    """
    scale, phase = 0.25 * TWO_OVER_PI, 0.25 * quarters
    return bool(np.ceil(a * scale - (phase + 1e-9)) <= b * scale - (phase - 1e-9))


@njit(cache=True, inline="always", error_model="numpy")
def shifted_sine(a: float, b: float, shift: float) -> Pair:
    """sin([a, b] + shift pi/2) for shift 0 or 1; without branches, so that loops are vectorised."""
    p, p_off = _sine(a, shift)
    q, q_off = _sine(b, shift)
    lo, hi = down(min(p - p_off, q - q_off)), up(max(p + p_off, q + q_off))
    lo = -1.0 if _may_hold(a, b, -1.0 - shift) else lo
    hi = 1.0 if _may_hold(a, b, 1.0 - shift) else hi
    lo = lo if a > -ARGUMENT_LIMIT else -1.0
    lo = lo if b < ARGUMENT_LIMIT else -1.0
    hi = hi if a > -ARGUMENT_LIMIT else 1.0
    hi = hi if b < ARGUMENT_LIMIT else 1.0
    return (lo if lo > -1.0 else -1.0), (hi if hi < 1.0 else 1.0)


@njit(cache=True, error_model="numpy")
def sin(a: float, b: float) -> Pair:
    """Sine.

    Parameters
    ----------
    a, b
        Ends of the angle, rad.

    Returns
    -------
    lower, upper
        Rounded outward; [-1, 1] for angles beyond `ARGUMENT_LIMIT`.
    """
    return shifted_sine(a, b, 0.0)


@njit(cache=True, error_model="numpy")
def cos(a: float, b: float) -> Pair:
    """Cosine.

    Parameters
    ----------
    a, b
        Ends of the angle, rad.

    Returns
    -------
    lower, upper
        Rounded outward; [-1, 1] for angles beyond `ARGUMENT_LIMIT`.
    """
    return shifted_sine(a, b, 1.0)


@njit(cache=True, error_model="numpy")
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


@njit(cache=True, error_model="numpy")
def log(a: float, b: float) -> Pair:
    """Natural logarithm; the whole line if the argument may be zero or less."""
    if not (a > 0.0 and b < np.inf):
        return -np.inf, np.inf
    return _log_point(a)[0], _log_point(b)[1]
