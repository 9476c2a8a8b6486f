"""Kernels of the tube of a two-sided rotation: bounds of the slide that no motion crosses.

See `meso_robust.motion.two_sided` for what they enclose and why it holds.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, cast

import numpy as np
from numba import njit

from meso_robust.bounds.arithmetic import add, down, mul, up
from meso_robust.bounds.bulk import Program
from meso_robust.bounds.tape import OUTPUT, run, run_block
from meso_robust.kernels import fingerprint, strict
from meso_robust.types import Floats

H, Q = 0, 1  # the first two inputs of every function here
DOWN_DOWN, DOWN_UP, UP_DOWN, UP_UP, D_STICKS, S_STICKS = range(6)
"""Outputs of the rates: signs of both friction ratios, and the rate at which a tip sticks; then, at each
pair of signs, how far the rate is above that of D sticking, and of S sticking."""
RATES, OVER_D, OVER_S, ALL = 6, 6, 10, 14
GRIPS, PRESSED, FREELY, SLIPS_ALONE, STATES = 2, 6, 10, 11, 13
"""Outputs of a state: first contacts along their edges; grips; forces at S, at D; force at S if D has no
friction; slip of the part over D that pushes alone without friction, and what that grows by per ratio."""
PIECES = 8  # of q; fewer are looser, more take longer
# plain numbers would compile what they are given to once more
ALL_RATES, NONE = cast("int", np.int64(RATES)), cast("int", np.int64(0))
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
    bend: Floats
    """(K,) second derivative of the centre between two knots, 1/m; the parabola goes through both."""
    spread: Floats
    lower: Floats
    upper: Floats
    margins: Floats


class _Frame(NamedTuple):
    """One stretch of the tube: a parabola in the middle, lines in the parameters."""

    h_first: float
    h_last: float
    centre: float
    rate: float
    """Of the chord."""
    bend: float
    spread: Floats
    drift: Floats


@strict
def _hull(frame: _Frame, known: Known, s_lo: float, s_hi: float) -> tuple[float, float]:
    """All slides of a stretch whose s is in a range."""
    gone_hi = up(frame.h_first - frame.h_last)
    lo, hi = mul(frame.rate, frame.rate, 0.0, gone_hi)
    lo, hi = add(lo, hi, *_sag(frame.bend, gone_hi))
    lo, hi = add(lo, hi, frame.centre, frame.centre)
    lo, hi = add(lo, hi, s_lo, s_hi)
    for i in range(frame.spread.size):
        g_lo, g_hi = _slope(frame, i, 0.0, gone_hi)
        off_lo, off_hi = mul(g_lo, g_hi, known.dev_lo[i], known.dev_hi[i])
        lo, hi = add(lo, hi, off_lo, off_hi)
    return lo, hi


@strict
def _slope(frame: _Frame, i: int, gone_lo: float, gone_hi: float) -> tuple[float, float]:
    """g_i after ``gone`` of a stretch."""
    more_lo, more_hi = mul(frame.drift[i], frame.drift[i], gone_lo, gone_hi)
    return add(frame.spread[i], frame.spread[i], more_lo, more_hi)


@strict
def _sag(bend: float, reach: float) -> tuple[float, float]:
    """Where a parabola lies beside its chord: -bend/2 x (reach - x), at most bend reach^2/8 off it."""
    most = up(0.125 * up(reach * reach))
    lo, hi = mul(-bend, -bend, 0.0, most)
    return lo, hi


@strict
def _sag_at(frame: _Frame, gone_lo: float, gone_hi: float) -> tuple[float, float]:
    """The same after ``gone`` of a stretch."""
    left_lo, left_hi = down(frame.h_first - frame.h_last), up(frame.h_first - frame.h_last)
    left_lo, left_hi = add(left_lo, left_hi, -gone_hi, -gone_lo)
    lo, hi = mul(gone_lo, gone_hi, left_lo, left_hi)
    return mul(lo, hi, -0.5 * frame.bend, -0.5 * frame.bend)


@strict
def _along(
    frame: _Frame, gone_lo: float, gone_hi: float, dev_lo: Floats, dev_hi: Floats
) -> tuple[float, float]:
    """Rate of the curve, c' + g' (p - middle), after ``gone`` of a stretch, for deviations in a range."""
    half_lo, half_hi = down(frame.h_last - frame.h_first), up(frame.h_last - frame.h_first)
    off_lo, off_hi = add(gone_lo, gone_hi, 0.5 * half_lo, 0.5 * half_hi)
    lo, hi = mul(off_lo, off_hi, frame.bend, frame.bend)
    lo, hi = add(lo, hi, frame.rate, frame.rate)
    for i in range(dev_lo.size):
        off_lo, off_hi = mul(frame.drift[i], frame.drift[i], dev_lo[i], dev_hi[i])
        lo, hi = add(lo, hi, off_lo, off_hi)
    return lo, hi


@strict
def _pick(d_lo: float, d_hi: float, off_lo: float, off_hi: float, side: int) -> tuple[int, float]:
    """Where a mean-value form is centred in one variable, and what the rest of its range can add.

    At the end where the bound is attained, if the derivative has one sign: 0 at the lower, 2 at the
    upper end; otherwise 1, in the middle, from which the range reaches from ``off_lo`` to ``off_hi``.
    """
    if (side == 1 and d_lo >= 0.0) or (side == 0 and d_hi <= 0.0):
        return 2, 0.0
    if (side == 1 and d_hi <= 0.0) or (side == 0 and d_lo >= 0.0):
        return 0, 0.0
    p_lo, p_hi = mul(d_lo, d_hi, off_lo, off_hi)
    return 1, p_hi if side == 1 else p_lo


@strict
def _more(total: float, part: float, side: int) -> float:
    return up(total + part) if side == 1 else down(total + part)


class _Places(NamedTuple):
    """Where the variables of a mean-value form may be centred: lower end, middle, upper end."""

    at: Floats
    """(inputs, 3)"""
    off: Floats
    """(inputs, 2): how far the range reaches from its middle."""
    dev: Floats
    """(P, 3, 2): constants and labels less their middles there."""
    spread: Floats
    """(3, P, 2): g where h is the lower end, the middle, the upper end of a stretch."""
    spreads: Floats
    """(P, 2): g anywhere on the stretch."""
    centre: Floats
    """(3, 2): c at those three."""
    rate: Floats
    """(3, 2): c' at those three."""


@njit
def _places(frame: _Frame, known: Known, s_lo: float, s_hi: float) -> _Places:
    """What all outputs have in common; the row of Q is that of s."""
    inputs, count = known.lo.size, frame.spread.size
    at, off = np.empty((inputs, 3)), np.empty((inputs, 2))
    dev, spread = np.empty((count, 3, 2)), np.empty((3, count, 2))
    spreads, centre, rate = np.empty((count, 2)), np.empty((3, 2)), np.empty((3, 2))
    for i in range(inputs):
        a, b = known.lo[i], known.hi[i]
        if i == H:
            a, b = frame.h_last, frame.h_first
        elif i == Q:
            a, b = s_lo, s_hi
        middle = 0.5 * (a + b)
        at[i, 0], at[i, 1], at[i, 2] = a, middle, b
        off[i, 0], off[i, 1] = down(a - middle), up(b - middle)
    for j in range(count):
        if j < known.constants:
            middle = at[2 + j, 1]
            # exactly none in the middle: a denormal there would slow each product down
            dev[j, 1] = 0.0
            for k in (0, 2):
                dev[j, k, 0], dev[j, k, 1] = down(at[2 + j, k] - middle), up(at[2 + j, k] - middle)
        else:
            lo, hi = known.dev_lo[j], known.dev_hi[j]
            middle = 0.5 * (lo + hi)
            dev[j, 0], dev[j, 1], dev[j, 2] = lo, middle, hi
    whole = up(frame.h_first - frame.h_last)
    none = np.empty(0)
    for k in range(3):
        gone_lo, gone_hi = down(frame.h_first - at[H, k]), up(frame.h_first - at[H, k])
        for j in range(count):
            spread[k, j, 0], spread[k, j, 1] = _slope(frame, j, gone_lo, gone_hi)
        lo, hi = mul(frame.rate, frame.rate, gone_lo, gone_hi)
        lo, hi = add(lo, hi, *_sag_at(frame, gone_lo, gone_hi))
        centre[k, 0], centre[k, 1] = add(lo, hi, frame.centre, frame.centre)
        rate[k, 0], rate[k, 1] = _along(frame, gone_lo, gone_hi, none, none)
    for j in range(count):
        spreads[j, 0], spreads[j, 1] = _slope(frame, j, 0.0, whole)
    return _Places(at, off, dev, spread, spreads, centre, rate)


@strict
def _centred(
    of: Program,
    frame: _Frame,
    known: Known,
    places: _Places,
    by: Floats,
    column: int,
    shifted: bool,
) -> tuple[float, float]:
    """Put the centre of a mean-value form into a column of the block.

    ``by`` (inputs + labels, 2) are total derivatives: by h, s, the constants, what may change at every
    instant, the labels. Returns what the rest of the box can add, and the curve's rate at the centre.
    """
    side, inputs, total = column % 2, known.lo.size, 0.0
    # taken out once: a look into a tuple of arrays costs more than the sum does
    block_lo, block_hi, drift = of.block_lo, of.block_hi, frame.drift
    at, off, dev, spread = places.at, places.off, places.dev, places.spread
    for i in range(inputs):
        k, part = _pick(by[i, 0], by[i, 1], off[i, 0], off[i, 1], side)
        if part != 0.0:
            total = _more(total, part, side)
        block_lo[i, column] = block_hi[i, column] = at[i, k]
        if i == H:
            at_h = k
            here_lo, here_hi = places.centre[k, 0], places.centre[k, 1]
            rate_lo, rate_hi = places.rate[k, 0], places.rate[k, 1]
        elif i == Q:
            here_lo, here_hi = add(here_lo, here_hi, at[i, k], at[i, k])
        elif i < 2 + known.constants:
            j = i - 2
            dev_lo, dev_hi = dev[j, k, 0], dev[j, k, 1]
            off_lo, off_hi = mul(spread[at_h, j, 0], spread[at_h, j, 1], dev_lo, dev_hi)
            here_lo, here_hi = add(here_lo, here_hi, off_lo, off_hi)
            if shifted:
                off_lo, off_hi = mul(drift[j], drift[j], dev_lo, dev_hi)
                rate_lo, rate_hi = add(rate_lo, rate_hi, off_lo, off_hi)
    for j in range(known.constants, frame.spread.size):
        i = inputs + j - known.constants
        off_lo, off_hi = down(dev[j, 0, 0] - dev[j, 1, 0]), up(dev[j, 2, 0] - dev[j, 1, 0])
        k, part = _pick(by[i, 0], by[i, 1], off_lo, off_hi, side)
        if part != 0.0:
            total = _more(total, part, side)
        here = dev[j, k, 0]
        off_lo, off_hi = mul(spread[at_h, j, 0], spread[at_h, j, 1], here, here)
        here_lo, here_hi = add(here_lo, here_hi, off_lo, off_hi)
        if shifted:
            off_lo, off_hi = mul(drift[j], drift[j], here, here)
            rate_lo, rate_hi = add(rate_lo, rate_hi, off_lo, off_hi)
    block_lo[Q, column], block_hi[Q, column] = here_lo, here_hi
    return total, rate_lo if side == 1 else rate_hi


@strict
def _totals(
    grad: Floats,
    frame: _Frame,
    known: Known,
    places: _Places,
    along_lo: float,
    along_hi: float,
    shifted: bool,
    by: Floats,
) -> None:
    """Total derivatives of an output, as the slide depends on h, on the constants and on the labels."""
    inputs = known.lo.size
    q_lo, q_hi = grad[Q, 0], grad[Q, 1]
    # q falls by the curve's rate where h grows, and so does that rate by its bend
    lo, hi = mul(q_lo, q_hi, -along_hi, -along_lo)
    lo, hi = add(grad[H, 0], grad[H, 1], lo, hi)
    if shifted:
        lo, hi = add(lo, hi, frame.bend, frame.bend)
    by[H, 0], by[H, 1] = lo, hi
    by[Q, 0], by[Q, 1] = q_lo, q_hi
    for i in range(2 + known.constants, inputs):
        by[i, 0], by[i, 1] = grad[i, 0], grad[i, 1]
    for j in range(frame.spread.size):
        lo, hi = mul(q_lo, q_hi, places.spreads[j, 0], places.spreads[j, 1])
        if shifted:
            lo, hi = add(lo, hi, -frame.drift[j], -frame.drift[j])
        i = 2 + j
        if j < known.constants:
            lo, hi = add(lo, hi, grad[i, 0], grad[i, 1])
        else:
            i = inputs + j - known.constants
        by[i, 0], by[i, 1] = lo, hi


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

    The first ``shifted`` outputs are taken less the curve's rate, which makes rates of q rates of s.
    """
    inputs, outputs = known.lo.size, bounds.shape[1]
    box_lo, box_hi = known.lo.copy(), known.hi.copy()
    box_lo[H], box_hi[H] = frame.h_last, frame.h_first
    box_lo[Q], box_hi[Q] = _hull(frame, known, s_lo, s_hi)
    run(of.slope_code, of.slope_constant, box_lo, box_hi, of.work, of.slope)
    places = _places(frame, known, s_lo, s_hi)
    whole = up(frame.h_first - frame.h_last)
    all_lo, all_hi = _along(frame, 0.0, whole, known.dev_lo, known.dev_hi)
    rest, rate = np.empty(2 * outputs), np.zeros(2 * outputs)
    by = np.empty((inputs + frame.spread.size - known.constants, 2))
    for i in range(outputs):
        grad = of.slope[outputs + i * inputs : outputs + (i + 1) * inputs]
        _totals(grad, frame, known, places, all_lo, all_hi, i < shifted, by)
        bounds[0, i], bounds[1, i] = of.slope[i, 0], of.slope[i, 1]
        for column in (2 * i, 2 * i + 1):
            rest[column], at = _centred(of, frame, known, places, by, column, i < shifted)
            rate[column] = at if i < shifted else 0.0
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


@strict
def _bound_rates(
    rates: Program, frame: _Frame, known: Known, s_lo: float, s_hi: float, bounds: Floats
) -> None:
    """Bound all rates over a stretch.

    Each is a quotient of first degree in the friction ratio of either tip, so monotone in it: with a
    coefficient for each tip the ends of their ranges are enough, and what is left is much tighter.
    """
    inputs, corners = known.lo.size, 1 << known.ratios
    if corners == 1:
        _bound(rates, frame, known, s_lo, s_hi, ALL_RATES, bounds)
        return
    part = np.empty(bounds.shape)
    bounds[0], bounds[1] = np.inf, -np.inf
    for corner in range(corners):
        lo, hi = known.lo.copy(), known.hi.copy()
        for k in range(known.ratios):
            i = inputs - 1 - k
            lo[i] = hi[i] = known.hi[i] if (corner >> k) % 2 == 1 else known.lo[i]
        at = Known(lo, hi, known.dev_lo, known.dev_hi, known.constants, 0)
        _bound(rates, frame, at, s_lo, s_hi, ALL_RATES, part)
        _join(bounds, part)


@strict
def _join(bounds: Floats, part: Floats) -> None:
    """Widen bounds (2, outputs) so that they hold others."""
    # by number: a slice would bring in the text of its errors, which takes 2 s to compile
    for i in range(bounds.shape[1]):
        bounds[0, i] = np.minimum(bounds[0, i], part[0, i])
        bounds[1, i] = np.maximum(bounds[1, i], part[1, i])


@strict
def _beside(lower: Floats, upper: Floats, mode: int, tip: int, above: bool) -> tuple[float, float]:
    """Where a rate is by the one at which a tip (0: D, 1: S) sticks; (inf, -inf) if it cannot be there."""
    stick, over = D_STICKS + tip, OVER_D + 4 * tip + mode
    if above:
        if upper[over] < 0.0:
            return np.inf, -np.inf
        return lower[stick], up(upper[stick] + upper[over])
    if lower[over] > 0.0:
        return np.inf, -np.inf
    return down(lower[stick] + lower[over]), upper[stick]


@strict
def _both_signs(lower: Floats, upper: Floats, one: int, two: int) -> bool:
    """Whether one of two outputs may be positive and one negative, or one zero."""
    return min(lower[one], lower[two]) <= 0.0 <= max(upper[one], upper[two])


@strict
def _hull_of_modes(lower: Floats, upper: Floats) -> tuple[float, float]:
    """Infimum and supremum of ds/d(travel) over all possible modes; (inf, -inf) if none.

    A tip over which the part slips towards +a has the ratio -mu, towards -a mu. The part slips so where
    the rate is above (below) the one at which it sticks. How far it is above is a quotient of first degree
    in either ratio, so a tip can stick only if that has both signs at the ends of its cone. The divisor is
    the grip, which `_holds` shows to be positive.
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


@njit(inline="always")
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


@strict
def _guess(
    rates: Program, at: Floats, constants: int, spread: Floats, drift: Floats
) -> tuple[float, float]:
    """Rate of the motion with middle values, and what that changes by, from its active mode; fills g'.

    Any guess is sound.
    """
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
    return value[mode], by_q * value[mode] - 0.5 * (grad[H, 0] + grad[H, 1])


@strict
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


@strict
def _line(tube: Tube, first: int, last: int) -> _Frame:
    """The curve between two knots; over more than one step, its chord."""
    reach = tube.h[first] - tube.h[last]
    bend = tube.bend[first] if last == first + 1 else 0.0
    return _Frame(
        tube.h[first],
        tube.h[last],
        tube.centre[first],
        (tube.centre[last] - tube.centre[first]) / reach,
        bend,
        tube.spread[first],
        (tube.spread[last] - tube.spread[first]) / reach,
    )


@strict
def _off(tube: Tube, frame: _Frame, known: Known, first: int, last: int) -> tuple[Floats, Floats]:
    """How far the knots from ``first`` to ``last`` can be off a line."""
    h, centre = tube.h[first : last + 1], tube.centre[first : last + 1]
    return _offsets(h, centre, tube.spread[first : last + 1], frame.rate, frame.drift, known)


@strict
def _most_sag(h: Floats, bend: Floats) -> tuple[float, float]:
    """How far the centre lies off its chords between knots."""
    low = high = 0.0
    for k in range(bend.size):
        lo, hi = _sag(bend[k], up(h[k] - h[k + 1]))
        low, high = min(low, lo), max(high, hi)
    return low, high


@strict
def _pressed(lower: Floats) -> float:
    """Lower bound of the force at S at every ratio that D has, times the grip."""
    if lower[PRESSED + 1] > 0.0:
        return min(lower[PRESSED], lower[PRESSED + 1])
    # D alone has no positive ratio where it would slip under one
    if lower[SLIPS_ALONE] > 0.0 and lower[SLIPS_ALONE + 1] >= 0.0:
        return min(lower[PRESSED], lower[FREELY])
    return -np.inf


@strict
def _piecewise(
    state: Program, frame: _Frame, known: Known, s_lo: float, s_hi: float, bounds: Floats
) -> float:
    """Tighten the bounds of a state by cutting the range of q; the least of `_pressed`."""
    low, high = _hull(frame, known, s_lo, s_hi)
    none = np.zeros(frame.spread.size)
    level = _Frame(frame.h_first, frame.h_last, 0.0, 0.0, 0.0, none, none)
    piece, hull = np.empty(bounds.shape), np.empty(bounds.shape)
    hull[0], hull[1] = np.inf, -np.inf
    least, start = np.inf, low
    for k in range(PIECES):
        end = high if k + 1 == PIECES else low + (k + 1) * ((high - low) / PIECES)
        _bound(state, level, known, start, end, NONE, piece)
        least, start = min(least, _pressed(piece[0])), end
        _join(hull, piece)
    for i in range(bounds.shape[1]):
        bounds[0, i] = np.maximum(bounds[0, i], hull[0, i])
        bounds[1, i] = np.minimum(bounds[1, i], hull[1, i])
    return least


@njit(inline="always")
def _holds(state: Program, known: Known, ends: Floats, tube: Tube, first: int, last: int) -> int:
    """Check over some knots that both tips stay in contact and on their edges."""
    frame = _line(tube, first, last)
    off_lo, off_hi = _off(tube, frame, known, first, last)
    s_lo, s_hi = np.inf, -np.inf
    for k in range(first, last + 1):
        s_lo = min(s_lo, down(tube.lower[k] + off_lo[k - first]))
        s_hi = max(s_hi, up(tube.upper[k] + off_hi[k - first]))
    if last > first + 1:
        sag_lo, sag_hi = _most_sag(tube.h[first : last + 1], tube.bend[first:last])
        s_lo, s_hi = down(s_lo + sag_lo), up(s_hi + sag_hi)
    bounds, margins = np.empty((2, STATES)), tube.margins
    _bound(state, frame, known, s_lo, s_hi, NONE, bounds)
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


@njit(inline="always")
def _predict(rates: Program, known: Known, tube: Tube, k: int, drift: Floats) -> bool:
    """Fill the next knot of the curve; whether that could be computed."""
    dh, point = tube.h[k] - tube.h[k + 1], 0.5 * (known.lo + known.hi)
    point[H] = 0.5 * (tube.h[k] + tube.h[k + 1])
    point[Q] = tube.centre[k] + 0.5 * (tube.centre[k] - tube.centre[k - 1])
    rate, bend = _guess(rates, point, known.constants, tube.spread[k], drift)
    tube.bend[k] = bend
    tube.centre[k + 1] = tube.centre[k] + rate * dh
    finite = np.isfinite(rate) and np.isfinite(bend)
    for j in range(drift.size):
        tube.spread[k + 1, j] = tube.spread[k, j] + drift[j] * dh
        finite = finite and np.isfinite(drift[j])
    return bool(finite)


@njit(inline="always")
def _bound_lines(
    programs: Programs, known: Known, band: float, ends: Floats, every: int, tube: Tube
) -> int:
    """Fill the knots of ``tube`` from its first one.

    Until h has fallen to ``band`` a motion may still start anywhere between the first bounds, so the tube
    does not shrink there, and its knots are given.
    """
    h, drift = tube.h, np.zeros(known.dev_lo.size)
    strips = np.full(2, FIRST_STRIP * (h[0] - h[1]))
    checked = int(np.int64(0))  # of a fixed type, not to compile for a literal
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


def _compiled() -> tuple[
    Callable[..., int],
    Callable[..., tuple[Floats, Floats]],
    Callable[..., tuple[float, float]],
]:
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

    @njit(cache=True, nogil=True)
    def beside(h: Floats, bend: Floats) -> tuple[float, float]:
        return _most_sag(h, bend) if key >= 0 else (-np.inf, np.inf)

    return bound, off, beside


grow, offsets, beside_chords = _compiled()
"""Fill a tube, with a status of `two_sided.TubeStatus`; how far knots can be off one line; how far the
centre can be off its chords."""
