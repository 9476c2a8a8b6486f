"""Enclosures of a function and its gradient over many boxes at once."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
from numba import njit

from meso_robust.bounds.arithmetic import down, mul, up
from meso_robust.bounds.tape import Floats, Ints, Tape, compile_tape, run


@dataclass(frozen=True, slots=True, eq=False)
class Bounded:
    """A CasADi function prepared for rigorous bounds."""

    name: str
    inputs: tuple[str, ...]
    """Names of the arguments, in the order of the box columns."""
    function: ca.Function
    """Numeric evaluation: one vector in, one vector out."""
    values: Tape
    slopes: Tape
    """Outputs followed by their gradients, row by row."""


def bounded(name: str, inputs: tuple[str, ...], function: ca.Function) -> Bounded:
    """Prepare ``function`` (one vector of ``inputs`` to one vector of values)."""
    x = ca.SX.sym("x", len(inputs))
    y = function(x)
    gradient = ca.densify(ca.jacobian(y, x))
    both = ca.Function("with_slopes", [x], [ca.vertcat(ca.densify(y), ca.vec(gradient.T))])
    return Bounded(name, inputs, function, compile_tape(function), compile_tape(both))


@njit(cache=True)
def bound_box(
    code: Ints,
    constant: Floats,
    slope_code: Ints,
    slope_constant: Floats,
    lo: Floats,
    hi: Floats,
    work: Floats,
    slope: Floats,
    value: Floats,
    lower: Floats,
    upper: Floats,
) -> None:
    """Fill ``lower`` and ``upper`` (outputs,) with proved bounds over one box.

    The best of three: the natural extension; the same on the box collapsed to one end of every side
    along which the gradient over the whole box has one sign (the bound is attained there); and the
    mean-value form on what is left of the box. ``slope`` is left filled with the outputs and their
    gradients; ``work`` must serve both tapes.
    """
    outputs, inputs = lower.size, lo.size
    run(slope_code, slope_constant, lo, hi, work, slope)
    at_lo, at_hi = np.empty(inputs), np.empty(inputs)
    for i in range(outputs):
        lower[i], upper[i] = slope[i, 0], slope[i, 1]
        if not (np.isfinite(lower[i]) and np.isfinite(upper[i])):
            continue  # perhaps undefined somewhere: a gradient proves nothing
        gradient = slope[outputs + i * inputs : outputs + (i + 1) * inputs]
        for side in range(2):
            for v in range(inputs):
                rises, falls = gradient[v, 0] >= 0.0, gradient[v, 1] <= 0.0
                at_lo[v], at_hi[v] = lo[v], hi[v]
                if (rises and side == 0) or (falls and side == 1):
                    at_hi[v] = lo[v]
                elif (falls and side == 0) or (rises and side == 1):
                    at_lo[v] = hi[v]
            run(code, constant, at_lo, at_hi, work, value)
            if side == 0:
                lower[i] = max(lower[i], value[i, 0])
            else:
                upper[i] = min(upper[i], value[i, 1])
            spread_lo, spread_hi = _spread(gradient, at_lo, at_hi)
            run(code, constant, at_lo, at_hi, work, value)
            if side == 0:
                lower[i] = max(lower[i], down(value[i, 0] + spread_lo))
            else:
                upper[i] = min(upper[i], up(value[i, 1] + spread_hi))


@njit(cache=True)
def _spread(gradient: Floats, lo: Floats, hi: Floats) -> tuple[float, float]:
    """Enclose sum of gradient * (x - middle) over the box, and collapse the box to its middle."""
    total_lo, total_hi = 0.0, 0.0
    for v in range(lo.size):
        middle = 0.5 * (lo[v] + hi[v])
        if lo[v] < hi[v]:
            x_lo, x_hi = down(lo[v] - middle), up(hi[v] - middle)
            p_lo, p_hi = mul(gradient[v, 0], gradient[v, 1], x_lo, x_hi)
            total_lo, total_hi = down(total_lo + p_lo), up(total_hi + p_hi)
        lo[v] = hi[v] = middle
    return total_lo, total_hi


@njit(cache=True)
def _enclose_many(
    code: Ints,
    constant: Floats,
    slope_code: Ints,
    slope_constant: Floats,
    slots: int,
    lo: Floats,
    hi: Floats,
    lower: Floats,
    upper: Floats,
    smear: Floats,
) -> None:
    """Fill ``lower`` and ``upper`` (N, outputs) and ``smear`` (N, inputs) for N boxes."""
    boxes, inputs = lo.shape
    outputs = lower.shape[1]
    work, value = np.empty((slots, 2)), np.empty((outputs, 2))
    slope = np.empty((outputs * (1 + inputs), 2))
    for k in range(boxes):
        bound_box(
            code, constant, slope_code, slope_constant, lo[k], hi[k], work, slope, value,
            lower[k], upper[k],
        )
        for v in range(inputs):
            smear[k, v] = 0.0
            for i in range(outputs):
                d = outputs + i * inputs + v
                reach = max(abs(slope[d, 0]), abs(slope[d, 1])) * (hi[k, v] - lo[k, v])
                smear[k, v] = max(smear[k, v], reach if reach == reach else np.inf)


def enclose_many(of: Bounded, lo: Floats, hi: Floats) -> tuple[Floats, Floats, Floats]:
    """Enclose all outputs over every box.

    Parameters
    ----------
    of
        The function.
    lo, hi
        (N, inputs) ends of the boxes.

    Returns
    -------
    lower, upper
        (N, outputs) proved bounds.
    smear
        (N, inputs) how much each side of a box contributes: the side to split.
    """
    lower, upper = np.empty((2, lo.shape[0], of.values.outputs))
    smear = np.empty_like(lo)
    v, s = of.values, of.slopes
    slots = max(v.slots, s.slots)
    _enclose_many(v.code, v.constant, s.code, s.constant, slots, lo, hi, lower, upper, smear)
    return lower, upper, smear


def split(lo: Floats, hi: Floats, smear: Floats) -> tuple[Floats, Floats]:
    """Bisect every box across the side that contributes most (the widest one on a draw)."""
    widths = hi - lo
    worth = np.where(np.isfinite(smear), smear, np.finfo(float).max) + 1e-300 * widths
    side = np.argmax(np.where(widths > 0.0, worth, -1.0), axis=1)
    rows = np.arange(lo.shape[0])
    middle = 0.5 * (lo[rows, side] + hi[rows, side])
    left_hi, right_lo = hi.copy(), lo.copy()
    left_hi[rows, side] = middle
    right_lo[rows, side] = middle
    return np.concatenate([lo, right_lo]), np.concatenate([left_hi, hi])
