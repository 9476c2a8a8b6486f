"""Enclosures of a function and its gradient over many boxes at once."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple, cast

import casadi as ca
import numpy as np
from numba import njit

from meso_robust.bounds.arithmetic import down, mul, up
from meso_robust.bounds.tape import BLOCK, OUTPUT, Tape, compile_tape, run, run_block
from meso_robust.kernels import fingerprint, strict
from meso_robust.types import Floats, Ints


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
    """Prepare a function for bounds.

    Parameters
    ----------
    name
        For messages.
    inputs
        Names of the arguments, in the order of the vector.
    function
        One vector of ``inputs`` to one vector of values.

    Returns
    -------
    Bounded
        With the tape of its gradient, which is what makes its bounds tight.

    Raises
    ------
    ValueError
        It has more outputs than are bounded together, or its tape cannot be bounded
        (:func:`meso_robust.bounds.tape.compile_tape`).
    """
    if 4 * function.nnz_out(0) > BLOCK:
        raise ValueError(
            f"{name} has {function.nnz_out(0)} outputs, at most {BLOCK // 4} are bounded"
        )
    x = ca.SX.sym("x", len(inputs))
    y = function(x)
    gradient = ca.densify(ca.jacobian(y, x))
    both = ca.Function("with_slopes", [x], [ca.vertcat(ca.densify(y), ca.vec(gradient.T))])
    return Bounded(name, inputs, function, compile_tape(function), compile_tape(both))


ONE = cast("int", np.int64(1))
"""For kernels: a plain number compiles what it is given to once more."""


class Program(NamedTuple):
    """A prepared function as the kernels take it: its two tapes, and scratch for them."""

    code: Ints
    constant: Floats
    slope_code: Ints
    slope_constant: Floats
    work: Floats
    slope: Floats
    value: Floats
    block_lo: Floats
    """(inputs, BLOCK) boxes that :func:`bound_box` evaluates together."""
    block_hi: Floats
    block: Floats
    """(slots, 2, BLOCK) scratch for them."""


def program(of: Bounded, boxes: int = BLOCK) -> Program:
    """Lay out a function for the kernels.

    Parameters
    ----------
    of
        The function.
    boxes
        How many boxes are evaluated together at most: scratch that is never touched costs time too,
        and :func:`bound_box` needs four an output.

    Returns
    -------
    Program
        With scratch of its own, which must not be shared between threads.
    """
    used = min(boxes, BLOCK)
    block_lo, block_hi = np.empty((2, of.values.inputs, used))
    return Program(
        code=of.values.code,
        constant=of.values.constant,
        slope_code=of.slopes.code,
        slope_constant=of.slopes.constant,
        work=np.empty((max(of.values.slots, of.slopes.slots), 2)),
        slope=np.empty((of.slopes.outputs, 2)),
        value=np.empty((of.values.outputs, 2)),
        block_lo=block_lo,
        block_hi=block_hi,
        block=np.empty((of.values.slots, 2, used)),
    )


@strict
def bound_box(
    program: Program, lo: Floats, hi: Floats, lower: Floats, upper: Floats, seen: Floats
) -> None:
    """Bound all outputs over one box.

    Parameters
    ----------
    program
        The function; its ``slope`` is left filled with the outputs and their gradients.
    lo, hi
        (inputs,) ends of the box.
    lower, upper
        (outputs,) filled with proved bounds.
    seen
        (outputs, 2) filled: the least value is proved to be no more than seen[i, 0], the largest no
        less than seen[i, 1] (values at points of the box).

    Notes
    -----
    The best of three: the natural extension; the same on the box collapsed to one end of every side
    along which the gradient over the whole box has one sign (the bound is attained there); and the
    mean-value form on what is left of the box (R. E. Moore, R. B. Kearfott, M. J. Cloud 2009,
    doi:10.1137/1.9780898717716).
    """
    outputs, inputs = lower.size, lo.size
    slope = program.slope
    run(program.slope_code, program.slope_constant, lo, hi, program.work, slope)
    spread = np.zeros((outputs, 2))
    for i in range(outputs):
        lower[i], upper[i] = slope[i, 0], slope[i, 1]
        seen[i, 0], seen[i, 1] = np.inf, -np.inf
        gradient = slope[outputs + i * inputs : outputs + (i + 1) * inputs]
        for side in range(2):
            column = 4 * i + 2 * side
            spread[i, side] = _collapse(program, lo, hi, gradient, side, column)
    code, block = program.code, program.block
    run_block(code, program.constant, program.block_lo, program.block_hi, 4 * outputs, block)
    for k in range(code.shape[0]):
        if code[k, 0] != OUTPUT:
            continue
        i = code[k, 1]
        if not (np.isfinite(lower[i]) and np.isfinite(upper[i])):
            continue  # perhaps undefined somewhere: a gradient proves nothing
        j = 4 * i
        mean = down(block[k, 0, j + 1] + spread[i, 0])
        lower[i] = max(lower[i], max(block[k, 0, j], mean))
        mean = up(block[k, 1, j + 3] + spread[i, 1])
        upper[i] = min(upper[i], min(block[k, 1, j + 2], mean))
        seen[i, 0], seen[i, 1] = block[k, 1, j + 1], block[k, 0, j + 3]


@strict
def _collapse(
    program: Program, lo: Floats, hi: Floats, gradient: Floats, side: int, column: int
) -> float:
    """Put what must be evaluated for one bound of one output into two columns of the block.

    First the box, every monotone side collapsed to the end at which the bound (``side`` 0: lower,
    1: upper) is attained, then its middle. Returns how far the output can lie beyond its value at
    the middle, by the mean-value form.
    """
    block_lo, block_hi = program.block_lo, program.block_hi
    total_lo, total_hi = 0.0, 0.0
    for v in range(lo.size):
        a, b = lo[v], hi[v]
        rises, falls = gradient[v, 0] >= 0.0, gradient[v, 1] <= 0.0
        if (rises and side == 0) or (falls and side == 1):
            b = a
        elif (falls and side == 0) or (rises and side == 1):
            a = b
        middle = 0.5 * (a + b)
        if a < b:
            p_lo, p_hi = mul(gradient[v, 0], gradient[v, 1], down(a - middle), up(b - middle))
            total_lo, total_hi = down(total_lo + p_lo), up(total_hi + p_hi)
        block_lo[v, column], block_hi[v, column] = a, b
        block_lo[v, column + 1] = block_hi[v, column + 1] = middle
    return total_lo if side == 0 else total_hi


@njit(inline="always")
def _bound_each(program: Program, lo: Floats, hi: Floats, lower: Floats, upper: Floats) -> None:
    """Fill ``lower`` and ``upper`` (N, outputs) for N boxes."""
    seen = np.empty((lower.shape[1], 2))
    for k in range(lo.shape[0]):
        bound_box(program, lo[k], hi[k], lower[k], upper[k], seen)


@njit(error_model="numpy", inline="always")
def _natural_each(program: Program, lo: Floats, hi: Floats, lower: Floats, upper: Floats) -> None:
    """The same by the natural extension alone, a block of boxes at a time."""
    boxes, inputs = lo.shape
    code = program.code
    block_lo, block_hi, work = program.block_lo, program.block_hi, program.block
    for start in range(0, boxes, BLOCK):
        used = min(BLOCK, boxes - start)
        for j in range(used):
            for v in range(inputs):
                block_lo[v, j], block_hi[v, j] = lo[start + j, v], hi[start + j, v]
        run_block(code, program.constant, block_lo, block_hi, used, work)
        for k in range(code.shape[0]):
            if code[k, 0] == OUTPUT:
                for j in range(used):
                    lower[start + j, code[k, 1]] = work[k, 0, j]
                    upper[start + j, code[k, 1]] = work[k, 1, j]


@strict
def append_halves(
    queue_lo: Floats, queue_hi: Floats, row: int, tail: int, side: int, middle: float
) -> None:
    """Append to the queue (capacity, inputs) both halves of the box in a row, divided at ``middle``."""
    # by number: a slice would bring in the text of its errors, which takes 3 s to compile
    for half in range(tail, tail + 2):
        for v in range(queue_lo.shape[1]):
            queue_lo[half, v], queue_hi[half, v] = queue_lo[row, v], queue_hi[row, v]
    queue_hi[tail, side] = queue_lo[tail + 1, side] = middle


@strict
def side_to_split(slope: Floats, lo: Floats, hi: Floats, outputs: int) -> int:
    """The side that can contribute most to the spread of an output; -1 if none can be divided.

    ``slope`` (outputs + outputs * inputs, 2): outputs and gradients over the box.
    """
    inputs = lo.size
    best, worth = -1, -1.0
    for v in range(inputs):
        width, most = hi[v] - lo[v], 0.0
        for i in range(outputs):
            d = outputs + i * inputs + v
            reach = max(abs(slope[d, 0]), abs(slope[d, 1])) * width
            most = max(most, reach if reach == reach else np.inf)
        middle = 0.5 * (lo[v] + hi[v])
        if lo[v] < middle < hi[v] and (best < 0 or most > worth):
            best, worth = v, most
    return best


@njit(inline="always")
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
    capacity, outputs = queue_lo.shape[0], lower.size
    seen = np.empty((outputs, 2))
    box_lower, box_upper = np.empty(outputs), np.empty(outputs)
    least, most = np.full(outputs, np.inf), np.full(outputs, -np.inf)
    lower[:], upper[:] = np.inf, -np.inf
    head, tail = 0, ONE
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
        side = side_to_split(program.slope, lo, hi, outputs)
        if tight or tail + 2 > capacity or side < 0:
            for i in range(outputs):
                lower[i] = np.minimum(lower[i], box_lower[i])
                upper[i] = np.maximum(upper[i], box_upper[i])
            continue
        middle = 0.5 * (lo[side] + hi[side])
        append_halves(queue_lo, queue_hi, head - 1, tail, side, middle)
        tail += 2


@lru_cache(maxsize=256)
def _scratch(of: Bounded, boxes: int, thread: int) -> Program:
    """A function laid out for so many boxes; kept, for a thread that is named by its number."""
    del thread
    return program(of, boxes)


def enclose_ranges(
    of: Bounded, lo: Floats, hi: Floats, boxes: int, slack: float
) -> tuple[Floats, Floats]:
    """Enclose the range of every output over each of some boxes.

    Parameters
    ----------
    of
        The function.
    lo, hi
        (N, inputs) ends of the boxes.
    boxes, slack
        When to stop bisecting one of them; see :func:`meso_robust.bounds.prove.enclose`.

    Returns
    -------
    lower, upper
        (N, outputs) proved bounds.
    """
    lower, upper = np.empty((2, lo.shape[0], of.values.outputs))
    queue_lo, queue_hi = np.empty((2, max(boxes, 1), lo.shape[1]))
    scratch = _scratch(of, 4 * of.values.outputs, threading.get_ident())
    _ranges(scratch, lo, hi, queue_lo, queue_hi, slack, lower, upper)
    return lower, upper


def _compiled() -> tuple[Callable[..., None], ...]:
    """The kernels that are called from Python, kept on disk; see ``kernels.fingerprint``."""
    key = fingerprint("bounds")

    @njit(cache=True, nogil=True)
    def each(program: Program, lo: Floats, hi: Floats, lower: Floats, upper: Floats) -> None:
        if key >= 0:
            _bound_each(program, lo, hi, lower, upper)

    @njit(cache=True, nogil=True, error_model="numpy")
    def natural(program: Program, lo: Floats, hi: Floats, lower: Floats, upper: Floats) -> None:
        if key >= 0:
            _natural_each(program, lo, hi, lower, upper)

    @njit(cache=True, nogil=True)
    def whole(
        program: Program,
        lo: Floats,
        hi: Floats,
        queue_lo: Floats,
        queue_hi: Floats,
        slack: float,
        lower: Floats,
        upper: Floats,
    ) -> None:
        for k in range(lo.shape[0] if key >= 0 else 0):
            for v in range(lo.shape[1]):  # by number, as in `append_halves`
                queue_lo[0, v], queue_hi[0, v] = lo[k, v], hi[k, v]
            _bisect(program, queue_lo, queue_hi, slack, lower[k], upper[k])

    return each, natural, whole


_enclose_each, _enclose_natural, _ranges = _compiled()


def enclose_many(
    of: Bounded, lo: Floats, hi: Floats, *, natural: bool = False
) -> tuple[Floats, Floats]:
    """Enclose all outputs over every box.

    Parameters
    ----------
    of
        The function.
    lo, hi
        (N, inputs) ends of the boxes.
    natural
        By the natural extension alone: looser, and about fifty times faster.

    Returns
    -------
    lower, upper
        (N, outputs) proved bounds.
    """
    lower, upper = np.empty((2, lo.shape[0], of.values.outputs))
    kernel = _enclose_natural if natural else _enclose_each
    if natural:  # the same few sizes, as what is not touched costs time too
        boxes = min(BLOCK, 1 << (lo.shape[0] - 1).bit_length())
        scratch = _scratch(of, boxes, threading.get_ident())
    else:
        scratch = program(of)
    kernel(scratch, np.ascontiguousarray(lo), np.ascontiguousarray(hi), lower, upper)
    return lower, upper
