"""Enclosures of a function and its gradient over many boxes at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import casadi as ca
import numpy as np
from numba import njit

from meso_robust.bounds.arithmetic import down, mul, up
from meso_robust.bounds.tape import Floats, Ints, Tape, compile_tape, run
from meso_robust.kernels import fingerprint


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


class Program(NamedTuple):
    """A prepared function as the kernels take it: its two tapes, and scratch for them."""

    code: Ints
    constant: Floats
    slope_code: Ints
    slope_constant: Floats
    work: Floats
    slope: Floats
    value: Floats


def program(of: Bounded) -> Program:
    """Lay out ``of`` for the kernels; the scratch must not be shared between threads."""
    return Program(
        code=of.values.code,
        constant=of.values.constant,
        slope_code=of.slopes.code,
        slope_constant=of.slopes.constant,
        work=np.empty((max(of.values.slots, of.slopes.slots), 2)),
        slope=np.empty((of.slopes.outputs, 2)),
        value=np.empty((of.values.outputs, 2)),
    )


@njit
def bound_box(
    program: Program, lo: Floats, hi: Floats, lower: Floats, upper: Floats, seen: Floats
) -> None:
    """Fill ``lower`` and ``upper`` (outputs,) with proved bounds over one box.

    The best of three: the natural extension; the same on the box collapsed to one end of every side
    along which the gradient over the whole box has one sign (the bound is attained there); and the
    mean-value form on what is left of the box. ``program.slope`` is left filled with the outputs and
    their gradients. ``seen`` (outputs, 2): the least value is proved to be
    no more than seen[i, 0], the largest no less than seen[i, 1] (values at points of the box).
    """
    outputs, inputs = lower.size, lo.size
    slope, value, work = program.slope, program.value, program.work
    run(program.slope_code, program.slope_constant, lo, hi, work, slope)
    at_lo, at_hi = np.empty(inputs), np.empty(inputs)
    for i in range(outputs):
        lower[i], upper[i] = slope[i, 0], slope[i, 1]
        seen[i, 0], seen[i, 1] = np.inf, -np.inf
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
            run(program.code, program.constant, at_lo, at_hi, work, value)
            if side == 0:
                lower[i] = max(lower[i], value[i, 0])
            else:
                upper[i] = min(upper[i], value[i, 1])
            spread_lo, spread_hi = _spread(gradient, at_lo, at_hi)
            run(program.code, program.constant, at_lo, at_hi, work, value)
            if side == 0:
                lower[i] = max(lower[i], down(value[i, 0] + spread_lo))
                seen[i, 0] = value[i, 1]
            else:
                upper[i] = min(upper[i], up(value[i, 1] + spread_hi))
                seen[i, 1] = value[i, 0]


@njit
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


@njit
def _bound_each(
    program: Program, lo: Floats, hi: Floats, lower: Floats, upper: Floats, smear: Floats
) -> None:
    """Fill ``lower`` and ``upper`` (N, outputs) and ``smear`` (N, inputs) for N boxes."""
    boxes, inputs = lo.shape
    outputs = lower.shape[1]
    seen = np.empty((outputs, 2))
    for k in range(boxes):
        bound_box(program, lo[k], hi[k], lower[k], upper[k], seen)
        for v in range(inputs):
            smear[k, v] = _smear(program.slope, v, outputs, inputs, hi[k, v] - lo[k, v])


@njit
def _smear(slope: Floats, v: int, outputs: int, inputs: int, width: float) -> float:
    """How much side ``v`` of a box can contribute to the spread of an output."""
    most = 0.0
    for i in range(outputs):
        d = outputs + i * inputs + v
        reach = max(abs(slope[d, 0]), abs(slope[d, 1])) * width
        most = max(most, reach if reach == reach else np.inf)
    return most


@njit
def _bisect(
    program: Program,
    queue_lo: Floats,
    queue_hi: Floats,
    slack: float,
    lower: Floats,
    upper: Floats,
) -> None:
    """Fill ``lower`` and ``upper`` (outputs,): the range over the first box of the queue.

    Boxes are bisected, first in first out, until each lies within ``slack`` of the values that are
    known to be attained, or the queue (capacity, inputs) is full.
    """
    capacity, inputs = queue_lo.shape
    outputs = lower.size
    seen = np.empty((outputs, 2))
    box_lower, box_upper = np.empty(outputs), np.empty(outputs)
    least, most = np.full(outputs, np.inf), np.full(outputs, -np.inf)
    lower[:], upper[:] = np.inf, -np.inf
    head, tail = 0, 1
    while head < tail:
        lo, hi = queue_lo[head], queue_hi[head]
        head += 1
        bound_box(program, lo, hi, box_lower, box_upper, seen)
        tight = True
        for i in range(outputs):
            least[i], most[i] = min(least[i], seen[i, 0]), max(most[i], seen[i, 1])
            size = max(abs(least[i]), abs(most[i]))
            room = slack * (max(most[i] - least[i], 0.0) + 1e-3 * size)
            if not (box_lower[i] >= least[i] - room and box_upper[i] <= most[i] + room):
                tight = False
        side, worth = -1, -1.0
        for v in range(inputs):
            reach = _smear(program.slope, v, outputs, inputs, hi[v] - lo[v])
            if lo[v] < hi[v] and reach > worth:
                side, worth = v, reach
        if tight or tail + 2 > capacity or side < 0:
            lower[:] = np.minimum(lower, box_lower)
            upper[:] = np.maximum(upper, box_upper)
            continue
        middle = 0.5 * (lo[side] + hi[side])
        queue_lo[tail : tail + 2], queue_hi[tail : tail + 2] = lo, hi
        queue_hi[tail, side] = queue_lo[tail + 1, side] = middle
        tail += 2


def enclose_range(
    of: Bounded, lo: Floats, hi: Floats, boxes: int, slack: float
) -> tuple[Floats, Floats]:
    """Enclose the range of every output over one box.

    Parameters
    ----------
    of
        The function.
    lo, hi
        (inputs,) ends of the box.
    boxes, slack
        When to stop bisecting; see :func:`meso_robust.bounds.prove.enclose`.
    """
    lower, upper = np.empty((2, of.values.outputs))
    queue_lo, queue_hi = np.empty((2, max(boxes, 1), lo.size))
    queue_lo[0], queue_hi[0] = lo, hi
    _range(program(of), queue_lo, queue_hi, slack, lower, upper)
    return lower, upper


def _compiled() -> tuple[Callable[..., None], Callable[..., None]]:
    """The two kernels that are called from Python, kept on disk; see ``kernels.fingerprint``."""
    key = fingerprint("bounds")

    @njit(cache=True, nogil=True)
    def many(
        program: Program, lo: Floats, hi: Floats, lower: Floats, upper: Floats, smear: Floats
    ) -> None:
        if key >= 0:
            _bound_each(program, lo, hi, lower, upper, smear)

    @njit(cache=True, nogil=True)
    def whole(
        program: Program, lo: Floats, hi: Floats, slack: float, lower: Floats, upper: Floats
    ) -> None:
        if key >= 0:
            _bisect(program, lo, hi, slack, lower, upper)

    return many, whole


_enclose_many, _range = _compiled()


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
    _enclose_many(program(of), lo, hi, lower, upper, smear)
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
