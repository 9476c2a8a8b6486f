"""Kernels of the tube of a two-sided rotation: bounds of the slide that no motion crosses.

See `meso_robust.motion.two_sided` for what they enclose and why it holds.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba import njit

from meso_robust.bounds.arithmetic import add, down, mul, up
from meso_robust.bounds.bulk import Program
from meso_robust.bounds.tape import OUTPUT, run, run_block
from meso_robust.kernels import fingerprint
from meso_robust.types import Floats

H, Q = 0, 1  # the first two inputs of every function here
DOWN_DOWN, DOWN_UP, UP_DOWN, UP_UP, D_STICKS, S_STICKS = range(6)
"""Outputs of the rates: signs of both friction ratios, and the rate at which a tip sticks; then, at each
pair of signs, how far the rate is above that of D sticking, of S sticking, and the opening."""
RATES, OVER_D, OVER_S, OPENING, ALL = 6, 6, 10, 14, 18
GRIPS, PRESSED, FREELY, SLIPS_ALONE, STATES = 2, 6, 10, 11, 13
"""Outputs of a state: first contacts along their edges; grips; forces at S, at D; force at S if D has no
friction; slip of the part over D that pushes alone without friction, and what that grows by per ratio."""
PIECES = 8  # of q; fewer are looser, more take longer
FIRST_STRIP = (
    2.5e-4  # of a step in h; half of what a bound is first tried in, widened until it is enough
)


class Programs(NamedTuple):
    """The functions that the kernels evaluate."""

    rates: Program
    state: Program


class Known(NamedTuple):
    """What the inputs range over, in their order: h, q, constants, what may change at every instant."""

    lo: Floats
    hi: Floats
    dev_lo: Floats
    """(P,) constants and labels less their middles."""
    dev_hi: Floats
    constants: int
    ratios: int
    """How many of the last inputs are coefficients of friction of one tip each."""


class Tube(NamedTuple):
    """What is filled."""

    h: Floats
    centre: Floats
    spread: Floats
    lower: Floats
    upper: Floats
    margins: Floats


class _Frame(NamedTuple):
    """One stretch of the tube along a line."""

    h_first: float
    h_last: float
    centre: float
    rate: float
    spread: Floats
    drift: Floats


@njit
def _hull(frame: _Frame, known: Known, s_lo: float, s_hi: float) -> tuple[float, float]:
    """All slides of a stretch whose s is in a range."""
    gone_hi = up(frame.h_first - frame.h_last)
    lo, hi = mul(frame.rate, frame.rate, 0.0, gone_hi)
    lo, hi = add(lo, hi, frame.centre, frame.centre)
    lo, hi = add(lo, hi, s_lo, s_hi)
    for i in range(frame.spread.size):
        g_lo, g_hi = _slope(frame, i, 0.0, gone_hi)
        off_lo, off_hi = mul(g_lo, g_hi, known.dev_lo[i], known.dev_hi[i])
        lo, hi = add(lo, hi, off_lo, off_hi)
    return lo, hi


@njit
def _slope(frame: _Frame, i: int, gone_lo: float, gone_hi: float) -> tuple[float, float]:
    """g_i after ``gone`` of a stretch."""
    more_lo, more_hi = mul(frame.drift[i], frame.drift[i], gone_lo, gone_hi)
    return add(frame.spread[i], frame.spread[i], more_lo, more_hi)


@njit
def _along(frame: _Frame, dev_lo: Floats, dev_hi: Floats) -> tuple[float, float]:
    """Rate of the line, c' + g' (p - middle), for deviations in a range."""
    lo = hi = frame.rate
    for i in range(frame.drift.size):
        off_lo, off_hi = mul(frame.drift[i], frame.drift[i], dev_lo[i], dev_hi[i])
        lo, hi = add(lo, hi, off_lo, off_hi)
    return lo, hi


@njit
def _pick(d_lo: float, d_hi: float, a: float, b: float, side: int) -> tuple[float, float]:
    """Where a mean-value form is centred in one variable, and what the rest of its range can add.

    At the end where the bound is attained, if the derivative has one sign.
    """
    if (side == 1 and d_lo >= 0.0) or (side == 0 and d_hi <= 0.0):
        return b, 0.0
    if (side == 1 and d_hi <= 0.0) or (side == 0 and d_lo >= 0.0):
        return a, 0.0
    middle = 0.5 * (a + b)
    p_lo, p_hi = mul(d_lo, d_hi, down(a - middle), up(b - middle))
    return middle, p_hi if side == 1 else p_lo


@njit
def _more(total: float, part: float, side: int) -> float:
    return up(total + part) if side == 1 else down(total + part)


@njit
def _column(
    of: Program,
    frame: _Frame,
    known: Known,
    s_lo: float,
    s_hi: float,
    column: int,
    shifted: bool,
) -> tuple[float, float]:
    """Put the centre of a mean-value form into a column of the block.

    Returns what the rest of the box can add, and the line's rate at the centre. The column tells the
    output and the side. Derivatives are total ones, as the slide depends on h and on the constants.
    """
    i, side, inputs, outputs = column // 2, column % 2, known.lo.size, of.value.shape[0]
    grad = of.slope[outputs + i * inputs : outputs + (i + 1) * inputs]
    q_lo, q_hi = grad[Q, 0], grad[Q, 1]
    # q falls by the line's rate where h grows
    by_lo, by_hi = _along(frame, known.dev_lo, known.dev_hi)
    by_lo, by_hi = mul(q_lo, q_hi, -by_hi, -by_lo)
    by_lo, by_hi = add(grad[H, 0], grad[H, 1], by_lo, by_hi)
    at_h, total = _pick(by_lo, by_hi, frame.h_last, frame.h_first, side)
    at_s, part = _pick(q_lo, q_hi, s_lo, s_hi, side)
    total = _more(total, part, side)
    of.block_lo[H, column] = of.block_hi[H, column] = at_h
    gone_lo, gone_hi = down(frame.h_first - at_h), up(frame.h_first - at_h)
    here_lo, here_hi = mul(frame.rate, frame.rate, gone_lo, gone_hi)
    here_lo, here_hi = add(here_lo, here_hi, frame.centre, frame.centre)
    here_lo, here_hi = add(here_lo, here_hi, at_s, at_s)
    dev_lo, dev_hi = np.empty(frame.spread.size), np.empty(frame.spread.size)
    whole = up(frame.h_first - frame.h_last)
    for j in range(frame.spread.size):
        g_lo, g_hi = _slope(frame, j, 0.0, whole)
        by_lo, by_hi = mul(q_lo, q_hi, g_lo, g_hi)
        if shifted:
            by_lo, by_hi = add(by_lo, by_hi, -frame.drift[j], -frame.drift[j])
        if j < known.constants:
            by_lo, by_hi = add(by_lo, by_hi, grad[2 + j, 0], grad[2 + j, 1])
            a, b = known.lo[2 + j], known.hi[2 + j]
            at, part = _pick(by_lo, by_hi, a, b, side)
            of.block_lo[2 + j, column] = of.block_hi[2 + j, column] = at
            middle = 0.5 * (a + b)
            dev_lo[j], dev_hi[j] = down(at - middle), up(at - middle)
        else:
            at, part = _pick(by_lo, by_hi, known.dev_lo[j], known.dev_hi[j], side)
            dev_lo[j] = dev_hi[j] = at
        total = _more(total, part, side)
        g_lo, g_hi = _slope(frame, j, gone_lo, gone_hi)
        off_lo, off_hi = mul(g_lo, g_hi, dev_lo[j], dev_hi[j])
        here_lo, here_hi = add(here_lo, here_hi, off_lo, off_hi)
    for j in range(2 + known.constants, inputs):
        at, part = _pick(grad[j, 0], grad[j, 1], known.lo[j], known.hi[j], side)
        of.block_lo[j, column] = of.block_hi[j, column] = at
        total = _more(total, part, side)
    of.block_lo[Q, column], of.block_hi[Q, column] = here_lo, here_hi
    rate_lo, rate_hi = _along(frame, dev_lo, dev_hi)
    return total, rate_lo if side == 1 else rate_hi


@njit
def _bound(
    of: Program,
    frame: _Frame,
    known: Known,
    s_lo: float,
    s_hi: float,
    shifted: int,
    bounds: Floats,
) -> None:
    """Bound all outputs over a stretch: fill ``bounds`` (2, outputs); a mean-value form.

    The first ``shifted`` outputs are taken less the line's rate, which makes rates of q rates of s.
    """
    box_lo, box_hi = known.lo.copy(), known.hi.copy()
    box_lo[H], box_hi[H] = frame.h_last, frame.h_first
    box_lo[Q], box_hi[Q] = _hull(frame, known, s_lo, s_hi)
    run(of.slope_code, of.slope_constant, box_lo, box_hi, of.work, of.slope)
    all_lo, all_hi = _along(frame, known.dev_lo, known.dev_hi)
    outputs = bounds.shape[1]
    rest, rate = np.empty(2 * outputs), np.zeros(2 * outputs)
    for i in range(outputs):
        bounds[0, i], bounds[1, i] = of.slope[i, 0], of.slope[i, 1]
        for column in (2 * i, 2 * i + 1):
            rest[column], by = _column(of, frame, known, s_lo, s_hi, column, i < shifted)
            rate[column] = by if i < shifted else 0.0
        if i < shifted:
            bounds[0, i], bounds[1, i] = down(bounds[0, i] - all_hi), up(bounds[1, i] - all_lo)
    run_block(of.code, of.constant, of.block_lo, of.block_hi, 2 * outputs, of.block)
    for k in range(of.code.shape[0]):
        if of.code[k, 0] == OUTPUT:
            i = of.code[k, 1]
            low = down(down(of.block[k, 0, 2 * i] - rate[2 * i]) + rest[2 * i])
            high = up(up(of.block[k, 1, 2 * i + 1] - rate[2 * i + 1]) + rest[2 * i + 1])
            # where the function may be undefined a gradient proves nothing
            if np.isfinite(bounds[0, i]) and np.isfinite(bounds[1, i]):
                bounds[0, i] = low if low > bounds[0, i] else bounds[0, i]
                bounds[1, i] = high if high < bounds[1, i] else bounds[1, i]


@njit
def _bound_rates(
    rates: Program, frame: _Frame, known: Known, s_lo: float, s_hi: float, bounds: Floats
) -> None:
    """Bound all rates over a stretch.

    Each is a quotient of first degree in the friction ratio of either tip, so monotone in it: with a
    coefficient for each tip the ends of their ranges are enough, and what is left is much tighter.
    """
    inputs, corners = known.lo.size, 1 << known.ratios
    if corners == 1:
        _bound(rates, frame, known, s_lo, s_hi, RATES, bounds)
        return
    part = np.empty(bounds.shape)
    bounds[0], bounds[1] = np.inf, -np.inf
    for corner in range(corners):
        lo, hi = known.lo.copy(), known.hi.copy()
        for k in range(known.ratios):
            i = inputs - 1 - k
            lo[i] = hi[i] = known.hi[i] if (corner >> k) % 2 == 1 else known.lo[i]
        at = Known(lo, hi, known.dev_lo, known.dev_hi, known.constants, 0)
        _bound(rates, frame, at, s_lo, s_hi, RATES, part)
        bounds[0], bounds[1] = np.minimum(bounds[0], part[0]), np.maximum(bounds[1], part[1])


@njit
def _beside(lower: Floats, upper: Floats, mode: int, tip: int, above: bool) -> tuple[float, float]:
    """Where a rate is by the one at which a tip (0: D, 1: S) sticks; (inf, -inf) if it cannot be there."""
    stick, over = D_STICKS + tip, OVER_D + 4 * tip + mode
    opening = lower[OPENING + mode]
    low, high = -np.inf, np.inf
    if above:
        if not upper[over] >= 0.0:
            return np.inf, -np.inf
        low = lower[stick]
        if opening > 0.0:
            high = up(upper[stick] + up(upper[over] / opening))
    else:
        if not lower[over] <= 0.0:
            return np.inf, -np.inf
        high = upper[stick]
        if opening > 0.0:
            low = down(lower[stick] + down(lower[over] / opening))
    return low, high


@njit
def _both_signs(lower: Floats, upper: Floats, one: int, two: int) -> bool:
    """Whether one of two outputs may be positive and one negative, or one zero."""
    return min(lower[one], lower[two]) <= 0.0 <= max(upper[one], upper[two])


@njit
def _hull_of_modes(lower: Floats, upper: Floats) -> tuple[float, float]:
    """Infimum and supremum of ds/d(travel) over all possible modes; (inf, -inf) if none.

    A tip over which the part slips towards +a has the ratio -mu, towards -a mu. The part slips so where
    the rate is above (below) the one at which it sticks. How far it is above, times the opening, is of
    first degree in either ratio, so a tip can stick only if that has both signs at the ends of its cone.
    """
    least, most = np.inf, -np.inf
    for mode in range(4):
        d_lo, d_hi = _beside(lower, upper, mode, 0, mode < UP_DOWN)
        s_lo, s_hi = _beside(lower, upper, mode, 1, mode % 2 == 0)
        r_lo, r_hi = max(lower[mode], max(d_lo, s_lo)), min(upper[mode], min(d_hi, s_hi))
        if not r_lo > r_hi:
            least, most = min(least, r_lo), max(most, r_hi)
    for tip in range(2):
        stick, slips = D_STICKS + tip, S_STICKS - tip
        step = 2 - tip  # from the mode with its ratio negative to that with it positive
        for other in range(
            2
        ):  # the ratio of the tip that slips: 0 negative, as the rate is above its own
            one = other * (1 + tip)
            over = OVER_D + 4 * tip + one
            order = upper[stick] >= lower[slips] if other == 0 else lower[stick] <= upper[slips]
            if order and _both_signs(lower, upper, over, over + step):
                least, most = min(least, lower[stick]), max(most, upper[stick])
    low, high = max(lower[D_STICKS], lower[S_STICKS]), min(upper[D_STICKS], upper[S_STICKS])
    if low <= high:  # both may stick, whatever the ratios
        least, most = min(least, low), max(most, high)
    return least, most


@njit
def _next_bound(
    rates: Program,
    frame: _Frame,
    known: Known,
    at: float,
    side: int,
    strip: float,
    keep: bool,
) -> tuple[float, int]:
    """Bound of s one step on: upper (side = 1) or lower (0), and a status.

    ``keep``: a motion may still start here, so the bound must not move inward.
    """
    dh = frame.h_first - frame.h_last
    bounds, pad = np.empty((2, ALL)), strip
    for _ in range(12):  # widen the strip until the line stays inside
        _bound_rates(rates, frame, known, down(at - pad), up(at + pad), bounds)
        least, most = _hull_of_modes(bounds[0], bounds[1])
        if least > most:
            return at, 4
        slope = most if side == 1 else least
        if keep:
            slope = max(slope, 0.0) if side == 1 else min(slope, 0.0)
        rise_lo, rise_hi = mul(slope, slope, down(dh), up(dh))
        reach = max(abs(rise_lo), abs(rise_hi))
        if reach < pad:
            return (up(at + rise_hi) if side == 1 else down(at + rise_lo)), 0
        pad = 1.5 * reach
        if not pad < 1.0:
            break
    return at, 1


@njit
def _guess(rates: Program, at: Floats, constants: int, spread: Floats, drift: Floats) -> float:
    """Rate of the motion with middle values, from its active mode; fills g'. Any guess is sound."""
    run(rates.slope_code, rates.slope_constant, at, at, rates.work, rates.slope)
    value = 0.5 * (rates.slope[:ALL, 0] + rates.slope[:ALL, 1])
    high, low, between = S_STICKS, D_STICKS, DOWN_UP
    if value[D_STICKS] > value[S_STICKS]:
        high, low, between = D_STICKS, S_STICKS, UP_DOWN
    mode = between
    if value[DOWN_DOWN] >= value[high]:
        mode = DOWN_DOWN
    elif value[UP_UP] <= value[low]:
        mode = UP_UP
    elif value[between] >= value[high]:
        mode = high
    elif value[between] <= value[low]:
        mode = low
    grad = rates.slope[ALL + mode * at.size : ALL + (mode + 1) * at.size]
    by_q = 0.5 * (grad[Q, 0] + grad[Q, 1])
    for j in range(spread.size):
        drift[j] = by_q * spread[j]
        if j < constants:
            drift[j] += 0.5 * (grad[2 + j, 0] + grad[2 + j, 1])
    return value[mode]


@njit
def _offsets(
    h: Floats, centre: Floats, spread: Floats, rate: float, drift: Floats, known: Known
) -> tuple[Floats, Floats]:
    """How far c + g (p - middle) at each knot can be off one line from the first knot."""
    off_lo, off_hi = np.zeros(h.size), np.zeros(h.size)
    for k in range(h.size):
        gone_lo, gone_hi = down(h[0] - h[k]), up(h[0] - h[k])
        way_lo, way_hi = mul(rate, rate, gone_lo, gone_hi)
        ahead_lo, ahead_hi = down(centre[k] - centre[0]), up(centre[k] - centre[0])
        lo, hi = add(ahead_lo, ahead_hi, -way_hi, -way_lo)
        for j in range(drift.size):
            way_lo, way_hi = mul(drift[j], drift[j], gone_lo, gone_hi)
            more_lo, more_hi = down(spread[k, j] - spread[0, j]), up(spread[k, j] - spread[0, j])
            more_lo, more_hi = add(more_lo, more_hi, -way_hi, -way_lo)
            more_lo, more_hi = mul(more_lo, more_hi, known.dev_lo[j], known.dev_hi[j])
            lo, hi = add(lo, hi, more_lo, more_hi)
        off_lo[k], off_hi[k] = lo, hi
    return off_lo, off_hi


@njit
def _line(tube: Tube, first: int, last: int) -> _Frame:
    """The straight line between two knots."""
    reach = tube.h[first] - tube.h[last]
    return _Frame(
        tube.h[first],
        tube.h[last],
        tube.centre[first],
        (tube.centre[last] - tube.centre[first]) / reach,
        tube.spread[first],
        (tube.spread[last] - tube.spread[first]) / reach,
    )


@njit
def _off(tube: Tube, frame: _Frame, known: Known, first: int, last: int) -> tuple[Floats, Floats]:
    """How far the knots from ``first`` to ``last`` can be off a line."""
    h, centre = tube.h[first : last + 1], tube.centre[first : last + 1]
    return _offsets(h, centre, tube.spread[first : last + 1], frame.rate, frame.drift, known)


@njit
def _pressed(lower: Floats) -> float:
    """Lower bound of the force at S at every ratio that D has, times the grip."""
    if lower[PRESSED + 1] > 0.0:
        return min(lower[PRESSED], lower[PRESSED + 1])
    # D alone has no positive ratio where it would slip under one
    if lower[SLIPS_ALONE] > 0.0 and lower[SLIPS_ALONE + 1] >= 0.0:
        return min(lower[PRESSED], lower[FREELY])
    return -np.inf


@njit
def _piecewise(
    state: Program, frame: _Frame, known: Known, s_lo: float, s_hi: float, bounds: Floats
) -> float:
    """Tighten the bounds of a state by cutting the range of q; the least of `_pressed`."""
    low, high = _hull(frame, known, s_lo, s_hi)
    none = np.zeros(frame.spread.size)
    level = _Frame(frame.h_first, frame.h_last, 0.0, 0.0, none, none)
    piece, hull = np.empty(bounds.shape), np.empty(bounds.shape)
    hull[0], hull[1] = np.inf, -np.inf
    least, start = np.inf, low
    for k in range(PIECES):
        end = high if k + 1 == PIECES else low + (k + 1) * ((high - low) / PIECES)
        _bound(state, level, known, start, end, 0, piece)
        least, start = min(least, _pressed(piece[0])), end
        hull[0], hull[1] = np.minimum(hull[0], piece[0]), np.maximum(hull[1], piece[1])
    bounds[0], bounds[1] = np.maximum(bounds[0], hull[0]), np.minimum(bounds[1], hull[1])
    return least


@njit
def _holds(state: Program, known: Known, ends: Floats, tube: Tube, first: int, last: int) -> int:
    """Check over some knots that both tips stay in contact and on their edges."""
    frame = _line(tube, first, last)
    off_lo, off_hi = _off(tube, frame, known, first, last)
    s_lo, s_hi = np.inf, -np.inf
    for k in range(first, last + 1):
        s_lo = min(s_lo, down(tube.lower[k] + off_lo[k - first]))
        s_hi = max(s_hi, up(tube.upper[k] + off_hi[k - first]))
    bounds, margins = np.empty((2, STATES)), tube.margins
    _bound(state, frame, known, s_lo, s_hi, 0, bounds)
    lower, upper = bounds[0], bounds[1]
    pressed = _pressed(lower)
    if not pressed > 0.0:
        pressed = _piecewise(state, frame, known, s_lo, s_hi, bounds)
    tightest, widest = lower[GRIPS:PRESSED].min(), upper[GRIPS:PRESSED].max()
    margins[2] = min(margins[2], tightest)
    if not margins[2] > 0.0:
        return 1
    margins[0] = min(margins[0], down(pressed / widest))
    margins[3] = max(margins[3], up(upper[PRESSED:FREELY].max() / tightest))
    for k in range(2):
        margins[1] = min(margins[1], down(lower[k] - ends[k, 0]))
        margins[1] = min(margins[1], down(ends[k, 1] - upper[k]))
    if not (margins[0] > 0.0 and lower[PRESSED + 2 : FREELY].min() > 0.0):
        return 2
    return 0 if margins[1] > 0.0 else 3


@njit
def _predict(rates: Program, known: Known, tube: Tube, k: int, drift: Floats) -> bool:
    """Fill the next knot of the line; whether that could be computed."""
    dh, point = tube.h[k] - tube.h[k + 1], 0.5 * (known.lo + known.hi)
    point[H] = 0.5 * (tube.h[k] + tube.h[k + 1])
    point[Q] = tube.centre[k] + 0.5 * (tube.centre[k] - tube.centre[k - 1])
    rate = _guess(rates, point, known.constants, tube.spread[k], drift)
    tube.centre[k + 1] = tube.centre[k] + rate * dh
    tube.spread[k + 1] = tube.spread[k] + drift * dh
    return bool(np.isfinite(rate) and np.isfinite(drift).all())


@njit
def _bound_lines(
    programs: Programs, known: Known, band: float, ends: Floats, every: int, tube: Tube
) -> int:
    """Fill the knots of ``tube`` from its first one.

    Until h has fallen to ``band`` a motion may still start anywhere between the first bounds, so the tube
    does not shrink there, and its knots are given.
    """
    h, drift = tube.h, np.zeros(known.dev_lo.size)
    strips = np.full(2, FIRST_STRIP * (h[0] - h[1]))
    checked = 0
    for k in range(h.size - 1):
        starts = h[k] > band
        if not (starts or _predict(programs.rates, known, tube, k, drift)):
            return 1
        frame, reached = _line(tube, k, k + 1), np.empty(2)
        for side in range(2):
            at = tube.upper[k] if side == 1 else tube.lower[k]
            reached[side], status = _next_bound(
                programs.rates, frame, known, at, side, strips[side], starts
            )
            if status != 0:
                return status
            strips[side] = max(1.5 * abs(reached[side] - at), 1e-4 * (h[k] - h[k + 1]))
        # the next knot is where the line ends, to within rounding
        off_lo, off_hi = _off(tube, frame, known, k, k + 1)
        tube.lower[k + 1], tube.upper[k + 1] = (
            down(reached[0] - off_hi[1]),
            up(reached[1] - off_lo[1]),
        )
        if starts or k + 1 - checked == every or k + 2 == h.size:
            status = _holds(programs.state, known, ends, tube, checked, k + 1)
            if status != 0:
                return status
            checked = k + 1
    return 0


def _compiled() -> tuple[Callable[..., int], Callable[..., tuple[Floats, Floats]]]:
    """The kernels that are called from Python, kept on disk; see ``kernels.fingerprint``."""
    key = fingerprint("bounds", "motion")

    @njit(cache=True, nogil=True)
    def bound(
        programs: Programs, known: Known, band: float, ends: Floats, every: int, tube: Tube
    ) -> int:
        return _bound_lines(programs, known, band, ends, every, tube) if key >= 0 else 1

    @njit(cache=True, nogil=True)
    def off(
        h: Floats, centre: Floats, spread: Floats, rate: float, drift: Floats, known: Known
    ) -> tuple[Floats, Floats]:
        if key < 0:
            return centre, centre
        return _offsets(h, centre, spread, rate, drift, known)

    return bound, off


grow, offsets = _compiled()
"""Fill a tube, with a status of `two_sided.TubeStatus`; how far knots can be off one line."""
