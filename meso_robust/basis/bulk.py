"""Many boxes at once: where a basis holds, and where other combinations of modes are excluded."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numba import njit

from meso_robust.basis.enclosure import Tapes, Work, derivatives, new_work, solve, visit
from meso_robust.basis.exclusion import excluded, fixes_turning
from meso_robust.basis.layout import FREE, Layout
from meso_robust.basis.problem import Problem
from meso_robust.kernels import fingerprint, inner, maker
from meso_robust.types import Floats

Signs = npt.NDArray[np.int8]


def tapes(problem: Problem) -> Tapes:
    """Lay out a problem for the kernels."""
    return Tapes(
        problem.values.code,
        problem.values.constant,
        problem.slopes.code,
        problem.slopes.constant,
        max(problem.values.slots, problem.slopes.slots),
        problem.first,
        problem.by,
    )


@maker
def _work_for(tapes_: Tapes, of: Layout, varying: int) -> Work:
    """Scratch for one problem."""
    pieces, derivatives_ = tapes_.first.size - 1, tapes_.by.size
    return new_work(tapes_.slots, pieces, derivatives_, varying, of.kind.shape[1])


@inner
def _reach(work: Work, i: int, k: int) -> float:
    """What parameter k can change in unknown i, relative to its size."""
    size = 0.5 * abs(work.right[i, 0, 0] + work.right[i, 0, 1]) + 1e-300
    width = work.reach[k, 1] - work.reach[k, 0]
    reach = max(abs(work.spread[i, k, 0]), abs(work.spread[i, k, 1])) * width / size
    return reach if reach == reach else 0.0


@inner
def _smear_all(of: Layout, m: int, work: Work, out: Floats) -> None:
    """Raise ``out`` (varying,) to what each parameter can change in any unknown with a sign."""
    for i in range(of.kind.shape[1]):
        for k in range(out.size):
            if of.kind[m, i] != FREE:
                out[k] = max(out[k], _reach(work, i, k))


@inner
def _smear_wrong(of: Layout, m: int, work: Work, out: Floats) -> None:
    """Raise ``out`` (varying,) likewise for the one unknown whose sign is most surely wrong."""
    best, least = -1, np.inf
    for i in range(of.kind.shape[1]):
        if of.kind[m, i] == FREE or not work.right[i, 0, 0] + work.right[i, 0, 1] < 0.0:
            continue
        total = 0.0
        for k in range(out.size):
            total += _reach(work, i, k)
        if total < least:
            best, least = i, total
    for k in range(out.size):
        if best >= 0:
            out[k] = max(out[k], _reach(work, best, k))


@maker
def holds(tapes_: Tapes, of: Layout, m: int, work: Work) -> int:
    """Whether combination m is proved to hold, strictly, on the box visited last.

    1 if it is; 0 if the solution, enclosed in ``work.right``, is not proved to have all its signs;
    -1 if the system, or the twist of a redundant pair, is not proved to be determined.
    """
    if not solve(tapes_, of, m, work):
        return -1
    if of.pair[m, 0] >= 0 and not fixes_turning(of, m, work):
        return -1
    for i in range(of.kind.shape[1]):
        if of.kind[m, i] != FREE and not work.right[i, 0, 0] > 0.0:
            return 0
    return 1


HOLD, EXCLUDE, DIFFERENTIATE = 0, 1, 2


class Survey(NamedTuple):
    """What was found on N boxes."""

    states: Signs
    """(N, M) 1 for what is proved."""
    unknowns: Floats
    """(N, n, 2) enclosures of the unknowns; whole lines where the system may be singular."""
    slopes: Floats
    """(N, n, varying, 2) enclosures of their derivatives, if asked for."""
    smear: Floats
    """(N, parameters) how much each parameter contributes to what is undecided."""


@maker
def _look(task: int, tapes_: Tapes, of: Layout, m: int, work: Work, k: int, found: Survey) -> None:
    """Do a task for combination m on box k, which was visited last."""
    work.spread[:] = 0.0
    if task == EXCLUDE:
        found.states[k, m] = excluded(tapes_, of, m, work)
        if found.states[k, m] != 1:
            _smear_wrong(of, m, work, found.smear[k])
    else:
        found.states[k, m] = holds(tapes_, of, m, work)
        if found.states[k, m] >= 0:
            found.unknowns[k] = work.right[:, 0, :]
        if found.states[k, m] != 1:
            _smear_all(of, m, work, found.smear[k])
    if task != DIFFERENTIATE or found.states[k, m] < 0:
        return
    if not derivatives(tapes_, of, m, work, found.slopes[k]):
        found.states[k, m] = -1


def _compiled() -> Callable[..., None]:
    """The kernel that is called from Python, kept on disk; see ``kernels.fingerprint``.

    One entry for all that is asked of a box: each entry is compiled with all it calls.
    """
    key = fingerprint("bounds", "basis")

    @njit(cache=True, nogil=True)
    def survey(task: int, tapes_: Tapes, of: Layout, lo: Floats, hi: Floats, found: Survey) -> None:
        if key < 0:
            return
        work = _work_for(tapes_, of, found.smear.shape[1])
        for k in range(lo.shape[0]):
            visit(tapes_, work, lo[k], hi[k])
            for m in range(found.states.shape[1]):
                if found.states[k, m] == 0:
                    _look(task, tapes_, of, m, work, k, found)

    return survey


_survey = _compiled()


def hold_many(
    problem: Problem, of: Layout, lo: Floats, hi: Floats, *, slopes: bool = False
) -> Survey:
    """Try the only combination of a layout on every box.

    Parameters
    ----------
    problem, of
        The contact problem and its system.
    lo, hi
        (N, parameters) ends of the boxes.
    slopes
        Whether to enclose the derivatives by the varying parameters.
    """
    states = np.zeros((len(lo), 1), dtype=np.int8)
    return _ask(DIFFERENTIATE if slopes else HOLD, problem, of, lo, hi, states)


def exclude_many(
    problem: Problem, of: Layout, lo: Floats, hi: Floats, done: Signs | None = None
) -> Survey:
    """Exclude combinations on every box.

    Parameters
    ----------
    problem, of, lo, hi
        As in `hold_many`.
    done
        (N, M) 1 for the combinations that are excluded already.
    """
    states = np.zeros((len(lo), len(of.modes)), dtype=np.int8) if done is None else done.copy()
    return _ask(EXCLUDE, problem, of, lo, hi, states)


def _ask(task: int, problem: Problem, of: Layout, lo: Floats, hi: Floats, states: Signs) -> Survey:
    boxes, n = len(lo), of.kind.shape[1]
    whole = np.array([-np.inf, np.inf])
    unknowns = np.broadcast_to(whole, (boxes, n, 2)).copy()
    kept = boxes if task == DIFFERENTIATE else 0
    slopes = np.broadcast_to(whole, (kept, n, problem.varying, 2)).copy()
    smear = np.zeros((boxes, problem.varying))
    lo, hi = np.ascontiguousarray(lo), np.ascontiguousarray(hi)
    found = Survey(states, unknowns, slopes, smear)
    _survey(task, tapes(problem), of, lo, hi, found)
    return found._replace(smear=_filled(problem, lo, hi, smear))


def _filled(problem: Problem, lo: Floats, hi: Floats, smear: Floats) -> Floats:
    """Smear of all parameters; shares of the whole box where nothing is known of a box."""
    whole = (problem.hi - problem.lo)[: problem.varying]
    share = (hi - lo)[:, : problem.varying] / np.where(whole > 0.0, whole, np.inf)
    known = np.where(np.any(smear > 0.0, axis=1, keepdims=True), smear, share)
    return np.pad(known, ((0, 0), (0, lo.shape[1] - problem.varying)))
