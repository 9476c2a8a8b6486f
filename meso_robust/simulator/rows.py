r"""The contact rows of a step and the complementarity problem they make.

All vectors are in the body frame at the start of the step; lengths are divided by the longest tip
displacement of the step, and the third component of a motion is ``√ρ Δθ`` (see `support`). For a
contact with outward normal ``n`` the part is pushed along ``m = −n``; ``t`` is ``m`` turned by
+90°. With the wrenches ``w_n = (m, p × m / √ρ)`` and ``w_t = (t, p × t / √ρ)`` the motion is
``Δ = Σ (w_n λ_n + w_t λ_t)``, and the relative displacement of part and tip is

    normal      v_n = w_n · Δ + q_n,   q_n = gap − m · Δtip
    tangential  v_t = w_t · Δ + q_t,   q_t = − t · Δtip

so that one step is, for every contact,

    0 ≤ v_n ⊥ λ_n ≥ 0,   0 ≤ ± v_t + γ ⊥ λ_f± ≥ 0,   0 ≤ μ λ_n − λ_f+ − λ_f− ⊥ γ ≥ 0.

Source: D. E. Stewart, J. C. Trinkle 1996, equations of the time-stepping scheme,
doi:10.1002/(SICI)1097-0207(19960815)39:15<2673::AID-NME972>3.0.CO;2-I, with the inertia replaced
by the film drag.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numba import njit

from meso_robust.simulator.contact import locate

_F = npt.NDArray[np.float64]
_I = npt.NDArray[np.int64]

TOLERANCE = 1e-9
"""Residual of an accepted step in tip displacements, relative to the largest force (1 to 1e4)."""
LARGEST = 1e4
"""Forces beyond this do not loosen the residual check any more."""


class Case(NamedTuple):
    """One run as the kernels see it."""

    faces: _F
    """(V, 6) table of `polygon_faces`."""
    tips: _F
    """(P, 2) tips at the start, m, world frame."""
    move: _F
    """(P, 2) displacement of each tip in one step, m, world frame."""
    unit: float
    """Longest tip displacement of one step, m."""
    friction: float
    """μ."""
    arm: float
    """1/√ρ in 1/m."""


class Work(NamedTuple):
    """Workspace of one run, for P contacts."""

    rows: _F
    """(P, 8): q_n, q_t, w_n (3), w_t (3)."""
    force: _F
    """(P, 2): λ_n, λ_t of the last step."""
    motion: _F
    """(3,): Δ of the last step."""
    modes: _I
    """(P,): modes of the last step, from `guess`."""
    active: _I
    """(P,): contacts in the complementarity problem."""
    matrix: _F
    """(4P, 4P)."""
    vector: _F
    """(2, 4P): q and z."""
    tableau: _F
    """(4P + 3, 4P), for Lemke's method."""
    labels: _I
    """(16P + 2,), for Lemke's method."""


@njit(error_model="numpy")
def workspace(tips: int) -> Work:
    """Allocate the workspace of a run with `tips` contacts."""
    n = 4 * tips
    return Work(
        np.zeros((tips, 8)),
        np.zeros((tips, 2)),
        np.zeros(3),
        np.zeros(tips, np.int64),
        np.zeros(tips, np.int64),
        np.zeros((n, n)),
        np.zeros((2, n)),
        np.zeros((n + 3, n)),
        np.zeros(4 * n + 2, np.int64),
    )


@njit(error_model="numpy")
def measure(case: Case, pose: _F, done: float, rows: _F) -> float:
    """Write the contact rows at a pose and return the smallest gap.

    Parameters
    ----------
    case
        The run.
    pose
        (3,) x, y in m and θ in rad.
    done
        Steps taken so far, which places the tips.
    rows
        (P, 8) receives the rows.

    Returns
    -------
    float
        The smallest gap of any tip in m, negative where a tip is inside the part; NaN if a row
        is not finite.
    """
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    scale = 1.0 / case.unit
    smallest = np.inf
    total = 0.0
    for c in range(rows.shape[0]):
        mx, my = case.move[c, 0], case.move[c, 1]
        rx = case.tips[c, 0] + done * mx - pose[0]
        ry = case.tips[c, 1] + done * my - pose[1]
        dx, dy = cos * mx + sin * my, cos * my - sin * mx
        gap, nx, ny, px, py = locate(case.faces, cos * rx + sin * ry, cos * ry - sin * rx, dx, dy)
        rows[c, 0] = (gap + nx * dx + ny * dy) * scale
        rows[c, 1] = (nx * dy - ny * dx) * scale
        rows[c, 2] = -nx
        rows[c, 3] = -ny
        rows[c, 4] = (py * nx - px * ny) * case.arm
        rows[c, 5] = ny
        rows[c, 6] = -nx
        rows[c, 7] = -(px * nx + py * ny) * case.arm
        smallest = min(smallest, gap)
        total += rows[c, 0] + rows[c, 1] + rows[c, 4] + rows[c, 7]
    return smallest if np.isfinite(total) else np.nan


@njit(error_model="numpy")
def assemble(work: Work, count: int, friction: float) -> int:
    """Write M and q of the first `count` contacts of ``work.active``; return their size."""
    rows, M, q = work.rows, work.matrix, work.vector[0]
    for a in range(count):
        ca, i = work.active[a], 4 * a
        for b in range(count):
            cb, j = work.active[b], 4 * b
            nn = rows[ca, 2] * rows[cb, 2] + rows[ca, 3] * rows[cb, 3] + rows[ca, 4] * rows[cb, 4]
            nt = rows[ca, 2] * rows[cb, 5] + rows[ca, 3] * rows[cb, 6] + rows[ca, 4] * rows[cb, 7]
            tn = rows[ca, 5] * rows[cb, 2] + rows[ca, 6] * rows[cb, 3] + rows[ca, 7] * rows[cb, 4]
            tt = rows[ca, 5] * rows[cb, 5] + rows[ca, 6] * rows[cb, 6] + rows[ca, 7] * rows[cb, 7]
            same = 1.0 if a == b else 0.0
            M[i, j], M[i, j + 1], M[i, j + 2], M[i, j + 3] = nn, nt, -nt, 0.0
            M[i + 1, j], M[i + 1, j + 1], M[i + 1, j + 2], M[i + 1, j + 3] = tn, tt, -tt, same
            M[i + 2, j], M[i + 2, j + 1], M[i + 2, j + 2], M[i + 2, j + 3] = -tn, -tt, tt, same
            M[i + 3, j], M[i + 3, j + 1] = friction * same, -same
            M[i + 3, j + 2], M[i + 3, j + 3] = -same, 0.0
        q[i], q[i + 1], q[i + 2], q[i + 3] = rows[ca, 0], rows[ca, 1], -rows[ca, 1], 0.0
    return 4 * count


@njit(error_model="numpy")
def move_by_forces(work: Work) -> None:
    """Write the motion of the part, ``Δ = Σ (w_n λ_n + w_t λ_t)``."""
    rows, force, motion = work.rows, work.force, work.motion
    for k in range(3):
        motion[k] = 0.0
    for c in range(rows.shape[0]):
        for k in range(3):
            motion[k] += force[c, 0] * rows[c, 2 + k] + force[c, 1] * rows[c, 5 + k]


@njit(error_model="numpy")
def is_solution(work: Work, friction: float) -> bool:
    """Check forces and motion against every condition of the step, for all contacts.

    This is the residual check of the whole problem, contacts left out of it included, with γ put
    at its only possible value ``|v_t|``; it is what makes a guess of the modes safe.
    """
    rows, force, motion = work.rows, work.force, work.motion
    largest = 1.0
    for c in range(rows.shape[0]):
        largest = max(largest, force[c, 0])
    limit = TOLERANCE * min(largest, LARGEST)
    for c in range(rows.shape[0]):
        ln, lt = force[c, 0], force[c, 1]
        vn, vt = rows[c, 0], rows[c, 1]
        for k in range(3):
            vn += rows[c, 2 + k] * motion[k]
            vt += rows[c, 5 + k] * motion[k]
        # Written so that a NaN fails.
        if not (ln >= -limit and vn >= -limit and min(ln, vn) <= limit):
            return False
        spare = friction * ln - abs(lt)
        if not (spare >= -limit and min(spare, abs(vt)) <= limit):
            return False
        if abs(vt) > limit and abs(lt) > limit and lt * vt > 0.0:
            return False
    return True
