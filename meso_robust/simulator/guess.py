"""A first guess of a step: the contact modes of the step before.

Contact modes seldom change between steps. With the modes given, the forces solve a linear system
with one unknown for a sliding contact (its friction is ``±μ λ_n``) and two for a sticking one. The
wrenches lie in a space of three dimensions, so that a system of more than three unknowns is
singular and is left to Lemke's method. The guess is a short cut only: its forces are taken if and
only if they pass the check of the whole problem (`rows.is_solution`).
"""

from meso_robust.kernels import sealed
from meso_robust.simulator.rows import TOLERANCE, deflection, is_soft, move_by_forces
from meso_robust.simulator.tables import CONTACTS, MARKS, STEP
from meso_robust.types import Floats, Ints

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


@sealed
def remember_modes(contacts: Floats, marks: Ints, count: int) -> None:
    """Read the modes of the step off its forces."""
    for c in range(count):
        ln, lt, friction = (
            contacts[c, CONTACTS.ln],
            contacts[c, CONTACTS.lt],
            contacts[c, CONTACTS.mu],
        )
        if ln <= TOLERANCE:
            marks[c, MARKS.mode] = SEPARATE
        elif abs(lt) <= TOLERANCE * ln:
            marks[c, MARKS.mode] = GLIDE
        elif abs(lt) < (friction - TOLERANCE) * ln:
            marks[c, MARKS.mode] = STICK
        else:
            marks[c, MARKS.mode] = SLIP_PLUS if lt > 0.0 else SLIP_MINUS


@sealed
def keep_modes(marks: Ints, count: int) -> None:
    """Keep features and modes of the step for the next one."""
    for c in range(count):
        for k in range(3):
            marks[c, MARKS.old_who + k] = marks[c, MARKS.who + k]
    marks[marks.shape[0] - 1, 0] = count


@sealed
def forget_modes(marks: Ints) -> None:
    """Start without modes of a last step."""
    marks[marks.shape[0] - 1, 0] = 0


@sealed
def recall_modes(marks: Ints, count: int) -> None:
    """Give every contact the mode that it had in the last step, if it was there."""
    old = marks[marks.shape[0] - 1, 0]
    for c in range(count):
        marks[c, MARKS.mode] = SEPARATE
        for b in range(old):
            if (
                marks[b, MARKS.old_who] == marks[c, MARKS.who]
                and marks[b, MARKS.old_feature] == marks[c, MARKS.feature]
            ):
                marks[c, MARKS.mode] = marks[b, MARKS.old_mode]


@sealed
def guess_forces(contacts: Floats, marks: Ints, step: Floats, system: Floats, count: int) -> bool:
    """Write the forces and the motion that the modes imply.

    Parameters
    ----------
    contacts, marks, step
        Tables of the step, its rows and modes being written.
    system
        (9, 3) workspace: wrenches that must not move, wrenches of unit forces, and the columns of
        the linear system.
    count
        Number of contacts.

    Returns
    -------
    bool
        False if the modes hold no contact or leave a singular system.
    """
    size = _collect(contacts, marks, step, system, count)
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
    if is_soft(step):
        _soften(contacts, marks, step, system, count)
    return _solve(contacts, marks, step, system, count)


@sealed
def _slope(mode: int, friction: float) -> float:
    """λ_t / λ_n of a slipping contact."""
    return friction if mode == SLIP_PLUS else (-friction if mode == SLIP_MINUS else 0.0)


@sealed
def _collect(contacts: Floats, marks: Ints, step: Floats, system: Floats, count: int) -> int:
    """List the unknowns of the modes; the motion takes the right-hand side."""
    for k in range(3):
        step[STEP.motion + k] = 0.0
    size = 0
    for c in range(count):
        mode = marks[c, MARKS.mode]
        if mode == SEPARATE:
            continue
        if size + (2 if mode == STICK else 1) > 3:
            return 4
        slope = _slope(mode, contacts[c, CONTACTS.mu])
        for k in range(3):
            system[size, k] = contacts[c, CONTACTS.wn + k]
            system[3 + size, k] = (
                contacts[c, CONTACTS.wn + k] + slope * contacts[c, CONTACTS.wt + k]
            )
        step[STEP.motion + size] = -contacts[c, CONTACTS.qn]
        size += 1
        if mode == STICK:
            for k in range(3):
                system[size, k] = contacts[c, CONTACTS.wt + k]
                system[3 + size, k] = contacts[c, CONTACTS.wt + k]
            step[STEP.motion + size] = -contacts[c, CONTACTS.qt]
            size += 1
    return size


@sealed
def _soften(contacts: Floats, marks: Ints, step: Floats, system: Floats, count: int) -> None:
    """Add the deflection of the probes to the linear system of the modes."""
    i = 0
    for a in range(count):
        if marks[a, MARKS.mode] == SEPARATE:
            continue
        j = 0
        for b in range(count):
            if marks[b, MARKS.mode] == SEPARATE:
                continue
            nn, nt, tn, tt = deflection(contacts, marks, step, a, b)
            slope, sticks = (
                _slope(marks[b, MARKS.mode], contacts[b, CONTACTS.mu]),
                marks[b, MARKS.mode] == STICK,
            )
            system[6 + j, i] += nn + slope * nt
            if sticks:
                system[7 + j, i] += nt
            if marks[a, MARKS.mode] == STICK:
                system[6 + j, i + 1] += tn + slope * tt
                if sticks:
                    system[7 + j, i + 1] += tt
            j += 2 if sticks else 1
        i += 2 if marks[a, MARKS.mode] == STICK else 1


@sealed
def _triple(a: Floats, b: Floats, c: Floats) -> float:
    """Return the determinant of three columns."""
    return float(
        a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
    )


@sealed
def _solve(contacts: Floats, marks: Ints, step: Floats, system: Floats, count: int) -> bool:
    """Solve by Cramer's rule and spread the unknowns over the contacts."""
    A, B, C, right = system[6], system[7], system[8], step[STEP.motion : STEP.motion + 3]
    determinant = _triple(A, B, C)
    if determinant == 0.0:
        return False
    x0 = _triple(right, B, C) / determinant
    x1 = _triple(A, right, C) / determinant
    x2 = _triple(A, B, right) / determinant
    for c in range(count):
        mode = marks[c, MARKS.mode]
        contacts[c, CONTACTS.ln] = 0.0
        contacts[c, CONTACTS.lt] = 0.0
        if mode == SEPARATE:
            continue
        contacts[c, CONTACTS.ln] = x0
        if mode == STICK:
            contacts[c, CONTACTS.lt] = x1
            x0 = x2
        else:
            contacts[c, CONTACTS.lt] = _slope(mode, contacts[c, CONTACTS.mu]) * x0
            x0, x1 = x1, x2
    move_by_forces(contacts, step, count)
    return True
