"""Interval evaluation of CasADi functions.

A CasADi ``SX`` function is a list of elementary instructions; :func:`compile_tape` copies it into
arrays and :func:`run` walks them with the operations of :mod:`meso_robust.bounds.arithmetic`. One
formula therefore serves numbers, gradients and enclosures. :func:`run_block` walks them once for many
boxes, one instruction over all of them, which the compiler turns into vector instructions.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numba import njit

from meso_robust.bounds import arithmetic as ia
from meso_robust.types import Floats, Ints

Pairwise = Callable[..., tuple[float, float]]

CONST, INPUT, OUTPUT, ADD, SUB, MUL, DIV, NEG, SQ, SQRT, SIN, COS, LOG, TWICE, INV, ASSIGN = range(
    16
)

BINARY_CODES = (ADD, SUB, MUL, DIV)
BLOCK = 128  # boxes that walk a tape together: their scratch fits into the first-level cache

_CODES = {
    ca.OP_CONST: CONST,
    ca.OP_INPUT: INPUT,
    ca.OP_OUTPUT: OUTPUT,
    ca.OP_ADD: ADD,
    ca.OP_SUB: SUB,
    ca.OP_MUL: MUL,
    ca.OP_DIV: DIV,
    ca.OP_NEG: NEG,
    ca.OP_SQ: SQ,
    ca.OP_SQRT: SQRT,
    ca.OP_SIN: SIN,
    ca.OP_COS: COS,
    ca.OP_LOG: LOG,
    ca.OP_TWICE: TWICE,
    ca.OP_INV: INV,
    ca.OP_ASSIGN: ASSIGN,
}


@dataclass(frozen=True, slots=True, eq=False)
class Tape:
    """Instructions of one function R^inputs -> R^outputs."""

    code: Ints
    """(K, 4): operation, result slot (k itself, so that no slot is written twice; the row of the
    result for an OUTPUT), first and second argument slot."""
    constant: Floats
    """(K,): value of a CONST instruction."""
    inputs: int
    outputs: int
    slots: int


def compile_tape(function: ca.Function) -> Tape:
    """Copy the instructions of a CasADi function of one vector into arrays.

    CasADi simplifies while a function is built (x/x becomes 1), so a tape can be defined where the
    formula as written is not; the generated formulas hold no such quotient.

    Parameters
    ----------
    function
        Of one vector, to one vector.

    Returns
    -------
    Tape
        Its instructions, each with a slot of its own.

    Raises
    ------
    ValueError
        If an instruction has no interval counterpart, or a constant is not a small dyadic number:
        a rounded constant would make every bound a bound on another function.
    """
    rows, constants = [], []
    written: dict[int, int] = {}
    for k in range(function.n_instructions()):
        code = _CODES.get(function.instruction_id(k))
        if code is None:
            raise ValueError(
                f"{function.name()}: CasADi operation {function.instruction_id(k)} has no interval "
                "form; add it to meso_robust.bounds.arithmetic"
            )
        source = function.instruction_input(k)
        if code == INPUT:
            first, second = source[1], 0
        else:
            first, second = ([written[slot] for slot in source[:2]] + [0, 0])[:2]
        target = function.instruction_output(k)
        constants.append(_exact(function, k) if code == CONST else 0.0)
        rows.append((code, target[1] if code == OUTPUT else k, first, second))
        if code != OUTPUT:
            written[target[0]] = k
    return Tape(
        np.array(rows, dtype=np.int64),
        np.array(constants),
        function.nnz_in(0),
        function.nnz_out(0),
        len(rows),
    )


def _exact(function: ca.Function, k: int) -> float:
    value = float(function.instruction_constant(k))
    if not (value * 1024.0).is_integer() or abs(value) > 2.0**40:
        raise ValueError(
            f"{function.name()}: constant {value!r} is not an exact small dyadic number"
        )
    return value


@njit(error_model="numpy")
def _of_two(op: int, a: float, b: float, c: float, d: float) -> tuple[float, float]:
    if op == ADD:
        return ia.add(a, b, c, d)
    if op == SUB:
        return ia.sub(a, b, c, d)
    if op == MUL:
        return ia.mul(a, b, c, d)
    if op == DIV:
        return ia.div(a, b, c, d)
    return -np.inf, np.inf


@njit(error_model="numpy")
def _of_one(op: int, a: float, b: float) -> tuple[float, float]:
    if op == NEG:
        return -b, -a
    if op == SQ:
        return ia.sq(a, b)
    if op == SQRT:
        return ia.sqrt(a, b)
    if op == SIN:
        return ia.sin(a, b)
    if op == COS:
        return ia.cos(a, b)
    if op == LOG:
        return ia.log(a, b)
    if op == TWICE:
        return ia.add(a, b, a, b)
    if op == INV:
        return ia.div(1.0, 1.0, a, b)
    return (a, b) if op == ASSIGN else (-np.inf, np.inf)


@njit
def run(
    code: Ints, constant: Floats, box_lo: Floats, box_hi: Floats, work: Floats, result: Floats
) -> None:
    """Evaluate over one box.

    Parameters
    ----------
    code, constant
        Of the tape.
    box_lo, box_hi
        (inputs,) ends of the box.
    work
        (slots, 2) scratch.
    result
        (outputs, 2), filled with the ends of the enclosures.
    """
    for k in range(code.shape[0]):
        op, target, first, second = code[k, 0], code[k, 1], code[k, 2], code[k, 3]
        if op == CONST:
            work[target, 0] = work[target, 1] = constant[k]
        elif op == INPUT:
            work[target, 0], work[target, 1] = box_lo[first], box_hi[first]
        elif op == OUTPUT:
            result[target, 0], result[target, 1] = work[first, 0], work[first, 1]
        elif op in BINARY_CODES:
            work[target, 0], work[target, 1] = _of_two(
                op, work[first, 0], work[first, 1], work[second, 0], work[second, 1]
            )
        else:
            work[target, 0], work[target, 1] = _of_one(op, work[first, 0], work[first, 1])


@njit(error_model="numpy")
def _each_of_two(
    op: Pairwise, work: Floats, count: int, target: int, first: int, second: int
) -> None:
    for j in range(count):
        work[target, 0, j], work[target, 1, j] = op(
            work[first, 0, j], work[first, 1, j], work[second, 0, j], work[second, 1, j]
        )


@njit(error_model="numpy")
def _each_of_one(op: Pairwise, work: Floats, count: int, target: int, first: int) -> None:
    for j in range(count):
        work[target, 0, j], work[target, 1, j] = op(work[first, 0, j], work[first, 1, j])


@njit(error_model="numpy")
def _block_of_two(op: int, work: Floats, count: int, target: int, first: int, second: int) -> None:
    if op == ADD:
        _each_of_two(ia.add, work, count, target, first, second)
    elif op == SUB:
        _each_of_two(ia.sub, work, count, target, first, second)
    elif op == MUL:
        _each_of_two(ia.mul, work, count, target, first, second)
    else:
        _each_of_two(ia.div, work, count, target, first, second)


@njit(error_model="numpy")
def _block_of_one(op: int, work: Floats, count: int, target: int, first: int) -> None:
    if op == SQ:
        _each_of_one(ia.sq, work, count, target, first)
    elif op in (SIN, COS):
        for j in range(count):
            work[target, 0, j], work[target, 1, j] = ia.shifted_sine(
                work[first, 0, j], work[first, 1, j], 1.0 if op == COS else 0.0
            )
    else:  # rare or cheap: no need for a loop of its own
        for j in range(count):
            work[target, 0, j], work[target, 1, j] = _of_one(
                op, work[first, 0, j], work[first, 1, j]
            )


@njit(error_model="numpy")
def run_block(
    code: Ints, constant: Floats, box_lo: Floats, box_hi: Floats, count: int, work: Floats
) -> None:
    """Evaluate over ``count`` <= ``BLOCK`` boxes.

    Parameters
    ----------
    code, constant
        Of the tape.
    box_lo, box_hi
        (inputs, BLOCK) ends of the boxes.
    work
        (slots, 2, BLOCK) scratch; the row of an OUTPUT instruction is left holding the ends of that
        output.
    """
    for k in range(code.shape[0]):
        op, first, second = code[k, 0], code[k, 2], code[k, 3]
        if op == CONST:
            work[k, :, :count] = constant[k]
        elif op == INPUT:
            for i in range(count):  # a slice would bring the text of its errors: 3 s to compile
                work[k, 0, i], work[k, 1, i] = box_lo[first, i], box_hi[first, i]
        elif op == OUTPUT:
            for i in range(count):
                work[k, 0, i], work[k, 1, i] = work[first, 0, i], work[first, 1, i]
        elif op in BINARY_CODES:
            _block_of_two(op, work, count, k, first, second)
        else:
            _block_of_one(op, work, count, k, first)
