"""A first guess of a step: the contact modes of the step before.

Contact modes seldom change between steps. With the modes given, the forces solve a linear system
with one unknown for a sliding contact (its friction is ``±μ λ_n``) and two for a sticking one. The
wrenches lie in a space of three dimensions, so that a system of more than three unknowns is
singular and is left to Lemke's method. The guess is a short cut only: its forces are taken if and
only if they pass the check of the whole problem (`rows.is_solution`).
"""

import numpy as np
import numpy.typing as npt
from numba import njit

from meso_robust.simulator.rows import TOLERANCE, Work, move_by_forces

_F = npt.NDArray[np.float64]

SEPARATE = 0
"""No force."""
STICK = 1
"""Force inside the friction cone, no slip."""
SLIP_PLUS = 2
"""Force on the + edge of the cone, λ_t = μ λ_n."""
SLIP_MINUS = 3
"""Force on the − edge of the cone, λ_t = −μ λ_n."""
GLIDE = 4
"""Force along the normal, as in a push without slip through the centre, or with μ = 0."""


@njit(error_model="numpy")
def remember_modes(work: Work, friction: float) -> None:
    """Read the modes of the step off its forces."""
    for c in range(work.force.shape[0]):
        ln, lt = work.force[c, 0], work.force[c, 1]
        if ln <= TOLERANCE:
            work.modes[c] = SEPARATE
        elif abs(lt) <= TOLERANCE * ln:
            work.modes[c] = GLIDE
        elif abs(lt) < (friction - TOLERANCE) * ln:
            work.modes[c] = STICK
        else:
            work.modes[c] = SLIP_PLUS if lt > 0.0 else SLIP_MINUS


@njit(error_model="numpy")
def guess_forces(work: Work, friction: float, system: _F) -> bool:
    """Write the forces and the motion that the last modes imply.

    Parameters
    ----------
    work
        Workspace with the rows of this step and the modes of the last.
    friction
        μ.
    system
        (9, 3) workspace: wrenches that must not move, wrenches of unit forces, and the columns of
        the linear system.

    Returns
    -------
    bool
        False if the modes hold no contact or leave a singular system.
    """
    size = _collect(work, friction, system)
    if size < 1 or size > 3:
        return False
    for a in range(3):
        for b in range(3):
            entry = 1.0 if a == b else 0.0
            if a < size and b < size:
                entry = 0.0
                for k in range(3):
                    entry += system[a, k] * system[3 + b, k]
            system[6 + b, a] = entry
    return _solve(work, friction, system)


@njit(error_model="numpy")
def _collect(work: Work, friction: float, system: _F) -> int:
    """List the unknowns of the modes; ``work.motion`` takes the right-hand side."""
    rows, motion = work.rows, work.motion
    for k in range(3):
        motion[k] = 0.0
    size = 0
    for c in range(rows.shape[0]):
        mode = work.modes[c]
        if mode == SEPARATE:
            continue
        if size + (2 if mode == STICK else 1) > 3:
            return 4
        slope = friction if mode == SLIP_PLUS else (-friction if mode == SLIP_MINUS else 0.0)
        for k in range(3):
            system[size, k] = rows[c, 2 + k]
            system[3 + size, k] = rows[c, 2 + k] + slope * rows[c, 5 + k]
        motion[size] = -rows[c, 0]
        size += 1
        if mode == STICK:
            for k in range(3):
                system[size, k] = rows[c, 5 + k]
                system[3 + size, k] = rows[c, 5 + k]
            motion[size] = -rows[c, 1]
            size += 1
    return size


@njit(error_model="numpy")
def _triple(a: _F, b: _F, c: _F) -> float:
    """Return the determinant of three columns."""
    return (
        a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
    )


@njit(error_model="numpy")
def _solve(work: Work, friction: float, system: _F) -> bool:
    """Solve by Cramer's rule and spread the unknowns over the contacts."""
    A, B, C, right = system[6], system[7], system[8], work.motion
    determinant = _triple(A, B, C)
    if determinant == 0.0:
        return False
    x0 = _triple(right, B, C) / determinant
    x1 = _triple(A, right, C) / determinant
    x2 = _triple(A, B, right) / determinant
    for c in range(work.modes.shape[0]):
        mode = work.modes[c]
        work.force[c, 0] = 0.0
        work.force[c, 1] = 0.0
        if mode == SEPARATE:
            continue
        work.force[c, 0] = x0
        if mode == STICK:
            work.force[c, 1] = x1
            x0 = x2
        else:
            work.force[c, 1] = friction * x0 if mode == SLIP_PLUS else 0.0
            if mode == SLIP_MINUS:
                work.force[c, 1] = -friction * x0
            x0, x1 = x1, x2
    move_by_forces(work)
    return True
