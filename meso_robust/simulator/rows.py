r"""The contact rows of a step and the complementarity problem they make.

All vectors are in the body frame at the start of the step; lengths are divided by a unit, the
longest tip displacement of the step. The support resists a motion Δ with ``K Δ − s`` (`support`),
K symmetric and positive definite; with ``K / k = L Lᵀ``, k its first entry, the motion is measured
as ``Δ' = Lᵀ Δ`` and a wrench as ``w' = L⁻¹ w``, so that the resistance is the identity. For a contact
with outward normal ``n`` the part is pushed along ``m = −n``; ``t`` is ``m`` turned by +90°. With
``w_n = L⁻¹ (m, p × m)`` and ``w_t = L⁻¹ (t, p × t)`` the motion is ``Δ' = s' + Σ (w_n λ_n + w_t λ_t)``,
and the relative displacement of part and tip is

    normal      v_n = w_n · (Δ' − s') + m · C f + q_n,   q_n = gap − m · Δtip + w_n · s'
    tangential  v_t = w_t · (Δ' − s') + t · C f + q_t,   q_t = − t · Δtip + w_t · s'

where C is the compliance of the probe (`actuation`), symmetric and positive semidefinite, and
``f = m λ_n + t λ_t``, so that one step is, for every contact,

    0 ≤ v_n ⊥ λ_n ≥ 0,   0 ≤ ± v_t + γ ⊥ λ_f± ≥ 0,   0 ≤ μ λ_n − λ_f+ − λ_f− ⊥ γ ≥ 0.

Two contacts of one compliant probe share its deflection: the compliance then also couples them.

Source: D. E. Stewart, J. C. Trinkle 1996, equations of the time-stepping scheme,
doi:10.1002/(SICI)1097-0207(19960815)39:15<2673::AID-NME972>3.0.CO;2-I, with the inertia replaced
by the resistance of the support.
"""

import numpy as np

from meso_robust.kernels import sealed
from meso_robust.simulator.tables import CONTACTS, MARKS, STEP
from meso_robust.types import Floats, Ints

TOLERANCE = 1e-9
"""Residual of an accepted step in tip displacements, relative to the largest force (1 to 1e4)."""
LARGEST = 1e4
"""Forces beyond this do not loosen the residual check any more."""


@sealed
def write_rows(contacts: Floats, step: Floats, count: int, unit: float) -> bool:
    """Write the rows of the first `count` contacts; False if one is not finite."""
    f0, f1, f2 = step[STEP.factor], step[STEP.factor + 1], step[STEP.factor + 2]
    f3, f4, f5 = step[STEP.factor + 3], step[STEP.factor + 4], step[STEP.factor + 5]
    s0, s1, s2 = step[STEP.shift], step[STEP.shift + 1], step[STEP.shift + 2]
    scale = 1.0 / unit
    total = s0 + s1 + s2
    for c in range(count):
        row = contacts[c]
        nx, ny, px, py, dx, dy = (
            row[CONTACTS.nx],
            row[CONTACTS.ny],
            row[CONTACTS.px],
            row[CONTACTS.py],
            row[CONTACTS.dx],
            row[CONTACTS.dy],
        )
        arm_n, arm_t = py * nx - px * ny, -(px * nx + py * ny)
        n0, n1, n2 = -f0 * nx, -f1 * nx - f2 * ny, -f3 * nx - f4 * ny + f5 * arm_n
        t0, t1, t2 = f0 * ny, f1 * ny - f2 * nx, f3 * ny - f4 * nx + f5 * arm_t
        row[CONTACTS.wn], row[CONTACTS.wn + 1], row[CONTACTS.wn + 2] = n0, n1, n2
        row[CONTACTS.wt], row[CONTACTS.wt + 1], row[CONTACTS.wt + 2] = t0, t1, t2
        row[CONTACTS.qn] = (
            (row[CONTACTS.gap] + nx * dx + ny * dy) * scale + n0 * s0 + n1 * s1 + n2 * s2
        )
        row[CONTACTS.qt] = (nx * dy - ny * dx) * scale + t0 * s0 + t1 * s1 + t2 * s2
        total += row[CONTACTS.qn] + row[CONTACTS.qt] + n2 + t2
    return bool(np.isfinite(total))


@sealed
def is_soft(step: Floats) -> bool:
    """Whether the probes give way."""
    return bool(step[STEP.soft] != 0.0 or step[STEP.soft + 2] != 0.0)


@sealed
def deflection(
    contacts: Floats, marks: Ints, step: Floats, a: int, b: int
) -> tuple[float, float, float, float]:
    """How far a probe gives way at contact a to unit forces at contact b, if both are its own.

    Along the normal of a by a normal and by a tangential force, then along the tangent likewise.
    """
    if marks[a, MARKS.who] != marks[b, MARKS.who]:
        return 0.0, 0.0, 0.0, 0.0
    ax, ay, bx, by = (
        contacts[a, CONTACTS.nx],
        contacts[a, CONTACTS.ny],
        contacts[b, CONTACTS.nx],
        contacts[b, CONTACTS.ny],
    )
    xx, xy, yy = step[STEP.soft], step[STEP.soft + 1], step[STEP.soft + 2]
    nx, ny, tx, ty = xx * bx + xy * by, xy * bx + yy * by, xx * by - xy * bx, xy * by - yy * bx
    # of the directions m = (−x, −y) and t = (y, −x)
    return ax * nx + ay * ny, -ax * tx - ay * ty, ax * ny - ay * nx, ay * tx - ax * ty


@sealed
def _dot(contacts: Floats, a: int, i: int, b: int, j: int) -> float:
    """Product of three columns of contact a from i and three of b from j."""
    return float(
        contacts[a, i] * contacts[b, j]
        + contacts[a, i + 1] * contacts[b, j + 1]
        + contacts[a, i + 2] * contacts[b, j + 2]
    )


@sealed
def assemble(contacts: Floats, marks: Ints, step: Floats, count: int, M: Floats, q: Floats) -> int:
    """Write M and q of the first `count` active contacts; return their size."""
    soft = is_soft(step)
    for a in range(count):
        ca, i = marks[a, MARKS.active], 4 * a
        mu = contacts[ca, CONTACTS.mu]
        for b in range(count):
            cb, j = marks[b, MARKS.active], 4 * b
            nn, nt = (
                _dot(contacts, ca, CONTACTS.wn, cb, CONTACTS.wn),
                _dot(contacts, ca, CONTACTS.wn, cb, CONTACTS.wt),
            )
            tn, tt = (
                _dot(contacts, ca, CONTACTS.wt, cb, CONTACTS.wn),
                _dot(contacts, ca, CONTACTS.wt, cb, CONTACTS.wt),
            )
            if soft:
                own = deflection(contacts, marks, step, ca, cb)
                nn, nt, tn, tt = nn + own[0], nt + own[1], tn + own[2], tt + own[3]
            same = 1.0 if a == b else 0.0
            M[i, j], M[i, j + 1], M[i, j + 2], M[i, j + 3] = nn, nt, -nt, 0.0
            M[i + 1, j], M[i + 1, j + 1], M[i + 1, j + 2], M[i + 1, j + 3] = tn, tt, -tt, same
            M[i + 2, j], M[i + 2, j + 1], M[i + 2, j + 2], M[i + 2, j + 3] = -tn, -tt, tt, same
            M[i + 3, j], M[i + 3, j + 1] = mu * same, -same
            M[i + 3, j + 2], M[i + 3, j + 3] = -same, 0.0
        qn, qt = contacts[ca, CONTACTS.qn], contacts[ca, CONTACTS.qt]
        q[i], q[i + 1], q[i + 2], q[i + 3] = qn, qt, -qt, 0.0
    return 4 * count


@sealed
def move_by_forces(contacts: Floats, step: Floats, count: int) -> None:
    """Write the motion of the part, ``Δ' = s' + Σ (w_n λ_n + w_t λ_t)``."""
    for k in range(3):
        step[STEP.motion + k] = step[STEP.shift + k]
        for c in range(count):
            ln, lt = contacts[c, CONTACTS.ln], contacts[c, CONTACTS.lt]
            step[STEP.motion + k] += (
                ln * contacts[c, CONTACTS.wn + k] + lt * contacts[c, CONTACTS.wt + k]
            )


@sealed
def slips(contacts: Floats, marks: Ints, step: Floats, count: int, c: int) -> tuple[float, float]:
    """Relative displacements v_n and v_t of a contact under the forces and motion of the step."""
    vn, vt = contacts[c, CONTACTS.qn], contacts[c, CONTACTS.qt]
    for k in range(3):
        way = step[STEP.motion + k] - step[STEP.shift + k]
        vn += contacts[c, CONTACTS.wn + k] * way
        vt += contacts[c, CONTACTS.wt + k] * way
    if is_soft(step):
        for b in range(count):
            nn, nt, tn, tt = deflection(contacts, marks, step, c, b)
            vn += nn * contacts[b, CONTACTS.ln] + nt * contacts[b, CONTACTS.lt]
            vt += tn * contacts[b, CONTACTS.ln] + tt * contacts[b, CONTACTS.lt]
    return vn, vt


@sealed
def is_solution(contacts: Floats, marks: Ints, step: Floats, count: int) -> bool:
    """Check forces and motion against every condition of the step, for all contacts.

    This is the residual check of the whole problem, contacts left out of it included, with γ put
    at its only possible value ``|v_t|``; it is what makes a guess of the modes safe.
    """
    largest = 1.0
    for c in range(count):
        largest = max(largest, contacts[c, CONTACTS.ln])
    limit = TOLERANCE * min(largest, LARGEST)
    for c in range(count):
        ln, lt = contacts[c, CONTACTS.ln], contacts[c, CONTACTS.lt]
        vn, vt = slips(contacts, marks, step, count, c)
        # Written so that a NaN fails.
        if not (ln >= -limit and vn >= -limit and min(ln, vn) <= limit):
            return False
        spare = contacts[c, CONTACTS.mu] * ln - abs(lt)
        if not (spare >= -limit and min(spare, abs(vt)) <= limit):
            return False
        if abs(vt) > limit and abs(lt) > limit and lt * vt > 0.0:
            return False
    return True
