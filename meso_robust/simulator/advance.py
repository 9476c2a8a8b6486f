"""Forces and motion of one step: the modes of the step before, Lemke's method, all contact modes."""

import numpy as np

from meso_robust.kernels import maker, part, sealed
from meso_robust.simulator.guess import SEPARATE, guess_forces, remember_modes
from meso_robust.simulator.lemke import RESIDUAL, SOLVED, lemke
from meso_robust.simulator.modes import FOUND, NONE, new_walk, next_mode
from meso_robust.simulator.outcome import Outcome
from meso_robust.simulator.rows import TOLERANCE, assemble, is_solution, move_by_forces
from meso_robust.simulator.tables import CONTACTS, MARKS, STEP, Work
from meso_robust.types import Floats, Ints

COMPLETED = int(Outcome.COMPLETED)
JAM = int(Outcome.JAM)
SOLVER_FAILURE = int(Outcome.SOLVER_FAILURE)

_NEAR = 4.0  # units: contacts farther off are first left out of a step
_SAME = 1e-6  # units: motions this close are one


@sealed
def closes(contacts: Floats, marks: Ints, step: Floats, count: int) -> bool:
    """Whether a gap would close with no force; if not, write the motion without any."""
    for c in range(count):
        if not contacts[c, CONTACTS.qn] >= -TOLERANCE:
            return True
    for k in range(3):
        step[STEP.motion + k] = step[STEP.shift + k]
    for c in range(count):
        contacts[c, CONTACTS.ln], contacts[c, CONTACTS.lt] = 0.0, 0.0
        marks[c, MARKS.mode] = SEPARATE
    return False


@sealed
def advance(work: Work, count: int) -> int:
    """Find the forces and the motion of one step, its rows being written.

    Parameters
    ----------
    work
        Workspace with the rows of the step, and the modes to try first.
    count
        Number of contacts.

    Returns
    -------
    int
        `COMPLETED`, `JAM` or `SOLVER_FAILURE`.
    """
    contacts, marks, step = work.contacts, work.marks, work.step
    if guess_forces(contacts, marks, step, work.system, count) and is_solution(
        contacts, marks, step, count
    ):
        return COMPLETED
    return _search(work, count)


@part
def _search(work: Work, count: int) -> int:
    """Lemke's method on the near contacts, then on all; then all contact modes."""
    near = _collect(work, count, _NEAR)
    status = _solve(work, count, near)
    if status != SOLVED and near < count:
        near = _collect(work, count, np.inf)
        status = _solve(work, count, near)
    if status == SOLVED:
        remember_modes(work.contacts, work.marks, count)
        return COMPLETED
    n = 4 * near
    found = next_mode(n, work.matrix, work.vector[0], work.vector[1], new_walk(n))
    if found == FOUND:
        _spread(work, count, near)
        if is_solution(work.contacts, work.marks, work.step, count):
            remember_modes(work.contacts, work.marks, count)
            return COMPLETED
    return JAM if found == NONE else SOLVER_FAILURE


@maker
def is_ambiguous(work: Work, count: int) -> bool:
    """Whether some contact mode gives another motion than the one that was found."""
    if count == 0:
        return False
    contacts, step = work.contacts.copy(), work.step.copy()
    near = _collect(work, count, _NEAR)
    n = assemble(work.contacts, work.marks, work.step, near, work.matrix, work.vector[0])
    walk = new_walk(n)
    other = False
    while not other and next_mode(n, work.matrix, work.vector[0], work.vector[1], walk) == FOUND:
        _spread(work, count, near)
        if is_solution(work.contacts, work.marks, work.step, count):
            for k in range(STEP.motion, STEP.motion + 3):
                other |= abs(work.step[k] - step[k]) > _SAME
    # by number: a slice would bring in the text of its errors, which takes 3 s to compile
    for k in range(step.size):
        work.step[k] = step[k]
    for c in range(contacts.shape[0]):
        for k in range(contacts.shape[1]):
            work.contacts[c, k] = contacts[c, k]
    return other


@sealed
def _collect(work: Work, count: int, reach: float) -> int:
    """List the contacts that may close in this step."""
    near = 0
    for c in range(count):
        if work.contacts[c, CONTACTS.qn] <= reach:
            work.marks[near, MARKS.active] = c
            near += 1
    return near


@sealed
def _solve(work: Work, count: int, near: int) -> int:
    """Solve the step by Lemke's method and check it for all contacts."""
    n = assemble(work.contacts, work.marks, work.step, near, work.matrix, work.vector[0])
    status = lemke(n, work.matrix, work.vector[0], work.vector[1], work.tableau, work.labels)
    if status != SOLVED:
        return int(status)
    _spread(work, count, near)
    return SOLVED if is_solution(work.contacts, work.marks, work.step, count) else RESIDUAL


@sealed
def _spread(work: Work, count: int, near: int) -> None:
    """Take forces and motion from the solution of the problem."""
    z, contacts = work.vector[1], work.contacts
    for c in range(count):
        contacts[c, CONTACTS.ln], contacts[c, CONTACTS.lt] = 0.0, 0.0
    for a in range(near):
        c = work.marks[a, MARKS.active]
        contacts[c, CONTACTS.ln] = z[4 * a]
        contacts[c, CONTACTS.lt] = z[4 * a + 1] - z[4 * a + 2]
    move_by_forces(contacts, work.step, count)
