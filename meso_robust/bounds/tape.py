"""Interval evaluation of CasADi functions.

A CasADi ``SX`` function is a list of elementary instructions; :func:`compile_tape` copies it into
arrays and :func:`run` walks them with the operations of :mod:`meso_robust.bounds.arithmetic`. One
formula therefore serves numbers, gradients and enclosures.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
import numpy.typing as npt
from numba import njit

from meso_robust.bounds import arithmetic as ia

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

CONST, INPUT, OUTPUT, ADD, SUB, MUL, DIV, NEG, SQ, SQRT, SIN, COS, LOG, TWICE, INV, ASSIGN = range(
    16
)

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
    """(K, 4): operation, result slot, first and second argument slot."""
    constant: Floats
    """(K,): value of a CONST instruction."""
    inputs: int
    outputs: int
    slots: int


def compile_tape(function: ca.Function) -> Tape:
    """Copy the instructions of a CasADi function of one vector into arrays.

    CasADi simplifies while a function is built (x/x becomes 1), so a tape can be defined where the
    formula as written is not; the generated formulas hold no such quotient.

    Raises
    ------
    ValueError
        If an instruction has no interval counterpart, or a constant is not a small dyadic number:
        a rounded constant would make every bound a bound on another function.
    """
    rows, constants = [], []
    for k in range(function.n_instructions()):
        code = _CODES.get(function.instruction_id(k))
        if code is None:
            raise ValueError(
                f"{function.name()}: CasADi operation {function.instruction_id(k)} has no interval "
                "form; add it to meso_robust.bounds.arithmetic"
            )
        target = ([*function.instruction_output(k), 0])[0 if code != OUTPUT else 1]
        source = function.instruction_input(k)
        first = source[1] if code == INPUT else (source[0] if source else 0)
        second = source[1] if len(source) > 1 and code != INPUT else 0
        constants.append(_exact(function, k) if code == CONST else 0.0)
        rows.append((code, target, first, second))
    return Tape(
        np.array(rows, dtype=np.int64),
        np.array(constants),
        function.nnz_in(0),
        function.nnz_out(0),
        function.sz_w(),
    )


def _exact(function: ca.Function, k: int) -> float:
    value = float(function.instruction_constant(k))
    if not (value * 1024.0).is_integer() or abs(value) > 2.0**40:
        raise ValueError(
            f"{function.name()}: constant {value!r} is not an exact small dyadic number"
        )
    return value


@njit
def _apply(op: int, a: float, b: float, c: float, d: float) -> tuple[float, float]:  # noqa: C901 - a table
    if op == ADD:
        return ia.add(a, b, c, d)
    if op == SUB:
        return ia.sub(a, b, c, d)
    if op == MUL:
        return ia.mul(a, b, c, d)
    if op == DIV:
        return ia.div(a, b, c, d)
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
    if op == ASSIGN:
        return a, b
    return -np.inf, np.inf


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
        else:
            work[target, 0], work[target, 1] = _apply(
                op, work[first, 0], work[first, 1], work[second, 0], work[second, 1]
            )
