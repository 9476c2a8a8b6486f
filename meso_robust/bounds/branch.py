"""Branch and bound: whether a function is positive over a box, or over each of many."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from numba import njit

from meso_robust.bounds.bulk import (
    ONE,
    Bounded,
    Program,
    append_halves,
    bound_box,
    program,
    side_to_split,
)
from meso_robust.bounds.tape import run
from meso_robust.kernels import fingerprint, strict
from meso_robust.types import Floats

PROVED, REFUTED, TOO_MANY, INDIVISIBLE, UNDEFINED = range(5)

Result = tuple[int, float, int, int]


@strict
def _joined(ends: Floats, any_output: bool) -> float:
    """The end that decides: the largest if one positive output is enough, else the smallest."""
    best = ends[0]
    for i in range(1, ends.size):
        best = max(best, ends[i]) if any_output else min(best, ends[i])
    return best


@strict
def _fails_at(program: Program, point: Floats, any_output: bool) -> bool:
    """Whether the inequality is proved to fail at one point."""
    run(program.code, program.constant, point, point, program.work, program.value)
    return bool(_joined(program.value[:, 1], any_output) <= 0.0)


@njit(inline="always")
def _decide(program: Program, any_output: bool, queue_lo: Floats, queue_hi: Floats) -> Result:
    """Decide over the first box of the queue (capacity, inputs).

    Boxes are bisected, first in first out, so that the first one that stays open is among the widest.

    Returns
    -------
    outcome, lower, boxes, row
        PROVED: the least lower bound; else the row of the queue that holds the witness or the open
        box. ``boxes``: how many were bounded.
    """
    capacity, outputs = queue_lo.shape[0], program.value.shape[0]
    seen = np.empty((outputs, 2))
    lower, upper = np.empty(outputs), np.empty(outputs)
    least = np.inf
    head, tail = 0, ONE
    while head < tail:
        lo, hi = queue_lo[head], queue_hi[head]
        bound_box(program, lo, hi, lower, upper, seen)
        score = _joined(lower, any_output)
        head += 1
        if score > 0.0:
            least = min(least, score)
            continue
        side = side_to_split(program.slope, lo, hi, outputs)
        middle = np.empty(lo.size)
        for v in range(lo.size):
            middle[v] = 0.5 * (lo[v] + hi[v])
        if _fails_at(program, middle, any_output):
            for v in range(lo.size):
                lo[v] = hi[v] = middle[v]
            return REFUTED, -np.inf, head, head - 1
        if side < 0 or tail + 2 > capacity:
            open_ = TOO_MANY if side >= 0 else INDIVISIBLE
            return (open_ if score > -np.inf else UNDEFINED), -np.inf, head, head - 1
        append_halves(queue_lo, queue_hi, head - 1, tail, side, middle[side])
        tail += 2
    return PROVED, least, head, 0


def _compiled() -> tuple[Callable[..., Result], Callable[..., None]]:
    """The kernels that are called from Python, kept on disk; see ``kernels.fingerprint``."""
    key = fingerprint("bounds")

    @njit(cache=True, nogil=True)
    def one(program: Program, any_output: bool, queue_lo: Floats, queue_hi: Floats) -> Result:
        if key < 0:
            return UNDEFINED, -np.inf, 0, 0
        return _decide(program, any_output, queue_lo, queue_hi)

    @njit(cache=True, nogil=True)
    def many(
        program: Program,
        any_output: bool,
        lo: Floats,
        hi: Floats,
        queue: Floats,
        outcomes: npt.NDArray[np.int8],
    ) -> None:
        for k in range(lo.shape[0] if key >= 0 else 0):
            queue[0, 0], queue[1, 0] = lo[k], hi[k]
            outcomes[k] = _decide(program, any_output, queue[0], queue[1])[0]

    return one, many


_one, _many = _compiled()


def decide(
    of: Bounded, lo: Floats, hi: Floats, any_output: bool, most: int
) -> tuple[int, float, int, Floats, Floats]:
    """Decide over one box.

    Parameters
    ----------
    of, any_output
        As for :func:`decide_many`.
    lo, hi
        (inputs,) ends of the box.
    most
        How many boxes may be made.

    Returns
    -------
    outcome, least, boxes, at_lo, at_hi
        What was found, the proved lower bound, how many boxes were bounded, and the ends (inputs,) of
        the box that holds the witness or stayed open.
    """
    for capacity in (min(64, most), most):  # most proofs are short: do not touch a long queue
        queue = np.empty((2, capacity, lo.size))
        queue[0, 0], queue[1, 0] = lo, hi
        outcome, least, boxes, row = _one(program(of), any_output, queue[0], queue[1])
        if outcome in (PROVED, REFUTED, INDIVISIBLE):
            break
    return outcome, least, boxes, queue[0, row], queue[1, row]


def decide_many(
    of: Bounded, lo: Floats, hi: Floats, *, any_output: bool = False, most: int = 64
) -> npt.NDArray[np.int8]:
    """Outcomes (``PROVED``, ``REFUTED`` at some point, or why it is open) over many boxes.

    Parameters
    ----------
    of
        The function; all its outputs must be positive, or one of them if ``any_output``.
    lo, hi
        (N, inputs) finite ends of the boxes.
    any_output
        As for :func:`meso_robust.bounds.prove_positive`.
    most
        How many boxes may be made of each.

    Returns
    -------
    NDArray
        (N,) one of ``PROVED``, ``REFUTED``, ``TOO_MANY``, ``INDIVISIBLE``, ``UNDEFINED`` a box.
    """
    outcomes = np.full(lo.shape[0], UNDEFINED, dtype=np.int8)
    queue = np.empty((2, most, lo.shape[1]))
    _many(
        program(of),
        any_output,
        np.ascontiguousarray(lo),
        np.ascontiguousarray(hi),
        queue,
        outcomes,
    )
    return outcomes
