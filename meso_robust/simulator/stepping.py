r"""One run of the simulator: semi-implicit steps along the path of the tips.

The path of all tips is cut into equal steps; nothing depends on the speed. In each step the gaps
and normals are taken at its start, the complementarity problem of `rows` is solved for the
displacement of the part, and the pose is updated. The turn of the part is not linear, so a step of
length h leaves gaps of order h², which the gap term of the next step takes back.

A step without a solution is a jam only if no contact mode solves it (`modes`).
"""

import numpy as np
import numpy.typing as npt
from numba import njit

from meso_robust.simulator.guess import guess_forces, remember_modes
from meso_robust.simulator.lemke import RAY, RESIDUAL, SOLVED, lemke
from meso_robust.simulator.modes import some_mode_holds
from meso_robust.simulator.outcome import Outcome
from meso_robust.simulator.rows import (
    TOLERANCE,
    Case,
    Work,
    assemble,
    is_solution,
    measure,
    move_by_forces,
    workspace,
)

_F = npt.NDArray[np.float64]

_COMPLETED = int(Outcome.COMPLETED)
_JAM = int(Outcome.JAM)
_SOLVER_FAILURE = int(Outcome.SOLVER_FAILURE)
_OUT_OF_RANGE = int(Outcome.OUT_OF_RANGE)

_NEAR = 4.0  # tip displacements: contacts farther off are first left out of a step
MAX_TURN = 0.05
"""Largest turn of the part in one step, rad; beyond it contact is no longer linear."""


@njit(error_model="numpy")
def run(case: Case, steps: int, warm: bool, pose: _F, path: _F) -> tuple[int, float]:
    """Push the part through one move.

    Parameters
    ----------
    case
        The run.
    steps
        Number of steps.
    warm
        Whether to try the contact modes of the last step before Lemke's method.
    pose
        (3,) x, y in m and θ in rad; the start on entry, the end on return.
    path
        (R + 1, 3) receives evenly spaced poses; not written if it has no rows.

    Returns
    -------
    tuple
        The outcome as an integer and the deepest penetration of a tip in m.
    """
    work = workspace(case.tips.shape[0])
    system = np.zeros((9, 3))
    before = pose.copy()
    outcome = _COMPLETED
    deepest = 0.0
    start = np.int64(0)  # of a fixed type, not to compile for a literal
    next_sample = _record(path, start, start, steps, before, pose)
    for step in range(steps if case.unit > 0.0 else 0):
        gap = measure(case, pose, float(step), work.rows)
        outcome = _advance(work, case.friction, warm, system) if gap == gap else _OUT_OF_RANGE
        turn = work.motion[2] * case.arm * case.unit
        if outcome == _COMPLETED and not abs(turn) <= MAX_TURN:
            outcome = _OUT_OF_RANGE
        if outcome != _COMPLETED:
            break
        deepest = max(deepest, -gap)
        for k in range(3):
            before[k] = pose[k]
        _displace(pose, work.motion, turn, case.unit)
        next_sample = _record(path, next_sample, step + 1, steps, before, pose)
    for sample in range(next_sample, path.shape[0]):
        for k in range(3):
            path[sample, k] = pose[k]
    if outcome == _COMPLETED and case.unit > 0.0:
        deepest = max(deepest, -measure(case, pose, float(steps), work.rows))
    return outcome, deepest


@njit(error_model="numpy")
def _displace(pose: _F, motion: _F, turn: float, unit: float) -> None:
    """Add the displacement of a step, turned from the body frame into the world."""
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    pose[0] += unit * (cos * motion[0] - sin * motion[1])
    pose[1] += unit * (sin * motion[0] + cos * motion[1])
    pose[2] += turn


@njit(error_model="numpy")
def _record(path: _F, sample: int, step: int, steps: int, before: _F, pose: _F) -> int:
    """Write the samples that fall into the last step; return the next one to write."""
    samples = path.shape[0] - 1
    while sample <= samples and sample * steps <= step * samples:
        # Share of the last step that was still to come at the sample.
        share = float(step) - sample * steps / max(samples, 1)
        for k in range(3):
            path[sample, k] = pose[k] - share * (pose[k] - before[k])
        sample += 1
    return sample


@njit(error_model="numpy")
def _advance(work: Work, friction: float, warm: bool, system: _F) -> int:
    """Find the forces and the motion of one step."""
    tips = work.rows.shape[0]
    closing = False
    for c in range(tips):
        closing |= not work.rows[c, 0] >= -TOLERANCE
    if not closing:
        for k in range(3):
            work.motion[k] = 0.0
        return _COMPLETED
    if warm and guess_forces(work, friction, system) and is_solution(work, friction):
        return _COMPLETED
    count = _collect(work, _NEAR)
    status = _solve(work, count, friction)
    if status != SOLVED and count < tips:
        count = _collect(work, np.inf)
        status = _solve(work, count, friction)
    if status == SOLVED:
        remember_modes(work, friction)
        return _COMPLETED
    if status == RAY and not some_mode_holds(4 * count, work.matrix, work.vector[0]):
        return _JAM
    return _SOLVER_FAILURE


@njit(error_model="numpy")
def _collect(work: Work, reach: float) -> int:
    """List the contacts that may close in this step."""
    count = 0
    for c in range(work.rows.shape[0]):
        if work.rows[c, 0] <= reach:
            work.active[count] = c
            count += 1
    return count


@njit(error_model="numpy")
def _solve(work: Work, count: int, friction: float) -> int:
    """Solve the step by Lemke's method and check it for all contacts."""
    n = assemble(work, count, friction)
    z = work.vector[1]
    status = lemke(n, work.matrix, work.vector[0], z, work.tableau, work.labels)
    if status != SOLVED:
        return int(status)
    for c in range(work.force.shape[0]):
        work.force[c, 0] = 0.0
        work.force[c, 1] = 0.0
    for a in range(count):
        work.force[work.active[a], 0] = z[4 * a]
        work.force[work.active[a], 1] = z[4 * a + 1] - z[4 * a + 2]
    move_by_forces(work)
    return SOLVED if is_solution(work, friction) else RESIDUAL
