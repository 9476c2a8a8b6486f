r"""Velocity of the part and forces on it in a given mode of its contacts.

With the drag ``E`` of the film, a mode asks for ``E v = Σ a_j g_j`` with ``a_j ≥ 0`` and
``w_i · v = u_i``. The ``g_j`` are the wrenches along the edges of the friction cones: both for a
contact that sticks, the one against the slip for a contact that slips. The constraints ``w_i`` are
the normal of a closed contact and also the tangent of one that sticks. A basis of at most three
constraints and as many wrenches is enough (Carathéodory), so redundant contacts need no more.

Forces are not found by inverting the mobility of the contacts, which is singular where two forces
oppose each other (a jam), but from the vectors that are normal to the wrenches: the velocity stays
accurate up to there.

A twist is (v_x, v_y, ω) and a wrench (f_x, f_y, moment), both about the reference point and in
body axes.
"""

from typing import TypeAlias

import numpy as np

from meso_robust.simulator.events.contact import Place, frame, friction
from meso_robust.simulator.events.fused import inlined, sealed
from meso_robust.simulator.events.outline import BEFORE, NX, NY
from meso_robust.simulator.events.scene import (
    FIRST,
    HELD,
    KIND,
    POINT,
    SECOND,
    SEPARATE,
    SLIP_MINUS,
    SLIP_PLUS,
    STICK,
    TOUCHING,
    WALL,
    Scene,
    Work,
)
from meso_robust.types import Floats

Triple: TypeAlias = tuple[float, float, float]

LARGEST = 1e9
"""Forces beyond this are those of a jam."""


@inlined
def cross(a: Triple, b: Triple) -> Triple:
    """Cross product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def dot(a: Triple, b: Triple) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def times(matrix: Floats, a: Triple) -> Triple:
    """Product of a 3x3 matrix and a vector."""
    return (
        matrix[0, 0] * a[0] + matrix[0, 1] * a[1] + matrix[0, 2] * a[2],
        matrix[1, 0] * a[0] + matrix[1, 1] * a[1] + matrix[1, 2] * a[2],
        matrix[2, 0] * a[0] + matrix[2, 1] * a[1] + matrix[2, 2] * a[2],
    )


@inlined
def pick(rows: Floats, i: int) -> Triple:
    """Row i as a tuple."""
    return rows[i, 0], rows[i, 1], rows[i, 2]


@inlined
def solve_three(a: Triple, b: Triple, c: Triple, right: Triple) -> Triple:
    """Vector with the scalar products `right` with three vectors."""
    bc, ca, ab = cross(b, c), cross(c, a), cross(a, b)
    over = 1.0 / dot(a, bc)
    return (
        (right[0] * bc[0] + right[1] * ca[0] + right[2] * ab[0]) * over,
        (right[0] * bc[1] + right[1] * ca[1] + right[2] * ab[1]) * over,
        (right[0] * bc[2] + right[1] * ca[2] + right[2] * ab[2]) * over,
    )


@sealed
def invert(matrix: Floats, inverse: Floats) -> None:
    """Write the inverse of a symmetric 3x3 matrix."""
    a, b, c = pick(matrix, 0), pick(matrix, 1), pick(matrix, 2)
    det = dot(a, cross(b, c))
    for k, row in enumerate((cross(b, c), cross(c, a), cross(a, b))):
        inverse[k, 0], inverse[k, 1], inverse[k, 2] = row[0] / det, row[1] / det, row[2] / det


@inlined
def is_even(work: Work) -> bool:
    """Whether the stage has no lay, so that the drag in body axes is constant."""
    return bool(work.lay[0] == 0.0 and work.lay[1] == 0.0)


@sealed
def lay_out(work: Work, place: Place) -> None:
    """Write the drag at a place of the part, which changes with its angle if the stage has a lay.

    The lay adds ``[[p, q], [q, −p]]`` to the drag of a translation, in body axes and acting at the
    centre of drag.
    """
    cos, sin = place[2] * place[2] - place[3] * place[3], 2.0 * place[2] * place[3]
    p, q = work.lay[0] * cos + work.lay[1] * sin, work.lay[1] * cos - work.lay[0] * sin
    cx, cy = work.centre[0], work.centre[1]
    drag, even = work.drag, work.even
    drag[0, 0], drag[1, 1] = even[0, 0] + p, even[1, 1] - p
    drag[0, 1] = drag[1, 0] = even[0, 1] + q
    drag[0, 2] = drag[2, 0] = even[0, 2] - p * cy + q * cx
    drag[1, 2] = drag[2, 1] = even[1, 2] - q * cy - p * cx
    drag[2, 2] = even[2, 2] + p * (cy * cy - cx * cx) - 2.0 * q * cx * cy
    invert(drag, work.film)


@inlined
def fill(scene: Scene, work: Work, c: int, place: Place, clock: float) -> None:
    """Write the constraints and wrenches of a contact, and the lengths that it must keep."""
    kind, i, j = work.contact[c, KIND], work.contact[c, FIRST], work.contact[c, SECOND]
    nx, ny, px, py, ux, uy, low, high = frame(scene, kind, i, j, place, clock)
    n, t, row = 2 * c, 2 * c + 1, work.row
    row[n, 4], row[t, 4] = low, high
    row[n, 0], row[n, 1], row[n, 2], row[n, 3] = nx, ny, px * ny - py * nx, nx * ux + ny * uy
    row[t, 0], row[t, 1], row[t, 2], row[t, 3] = ny, -nx, -px * nx - py * ny, ny * ux - nx * uy
    push = work.push
    if kind == POINT:
        for k, edge in ((n, int(scene.edges[j, BEFORE])), (t, j)):
            mx, my = -scene.edges[edge, NX], -scene.edges[edge, NY]
            push[k, 0], push[k, 1], push[k, 2] = mx, my, px * my - py * mx
        return
    mu = friction(scene, work, kind, i)
    for k in range(3):
        push[n, k] = row[n, k] + mu * row[t, k]
        push[t, k] = row[n, k] - mu * row[t, k]


@inlined
def fill_all(scene: Scene, work: Work, place: Place, clock: float, closed_only: bool) -> None:
    """Write the constraints and wrenches of the contacts, and the drag."""
    if not is_even(work):
        lay_out(work, place)
    for c in range(work.count[TOUCHING]):
        if not closed_only or work.mode[c] != SEPARATE:
            fill(scene, work, c, place, clock)


@inlined
def solve_twist(work: Work) -> None:
    """Find the twist from the basis and the rows as they were written last, and a single force."""
    held, b, row = work.count[HELD], work.basis, work.row
    v: Triple = (0.0, 0.0, 0.0)
    if held == 1:
        v = times(work.film, pick(work.push, b[3]))
        share = row[b[0], 3] / dot(pick(row, b[0]), v)
        work.force[0] = share
        v = (share * v[0], share * v[1], share * v[2])
    elif held >= 2:
        last, speed = pick(row, b[2]), row[b[2], 3]
        if held == 2:
            # the wrench of the film has no part across the two wrenches
            g, h = pick(work.push, b[3]), pick(work.push, b[4])
            last, speed = times(work.drag, cross(g, _apart(g, h)[0])), 0.0
        v = solve_three(pick(row, b[0]), pick(row, b[1]), last, (row[b[0], 3], row[b[1], 3], speed))
    work.twist[0], work.twist[1], work.twist[2] = v


@inlined
def _apart(g: Triple, h: Triple) -> tuple[Triple, float, float]:
    """Write a wrench h as ``size · unit − share · g``, the unit vector without rounding errors.

    Where two forces come to oppose each other on one line the size falls to zero, and the cross
    product of the two would be left with nothing but rounding errors.
    """
    share = -(g[0] * h[0] + g[1] * h[1]) / (g[0] * g[0] + g[1] * g[1])
    rest = (h[0] + share * g[0], h[1] + share * g[1], h[2] + share * g[2])
    size = np.sqrt(dot(rest, rest))
    if size == 0.0:
        return (0.0, 0.0, 1.0), 0.0, share
    return (rest[0] / size, rest[1] / size, rest[2] / size), size, share


@inlined
def solve_forces(work: Work) -> None:
    """Find the forces of a basis of two or three from the twist; `solve_twist` finds a single one."""
    held, force = work.count[HELD], work.force
    if held < 2:
        return
    v: Triple = (work.twist[0], work.twist[1], work.twist[2])
    wrench, g = times(work.drag, v), pick(work.push, work.basis[3])
    h = pick(work.push, work.basis[4])
    if held == 2:
        unit, size, share = _apart(g, h)
        across = cross(g, unit)
        square = dot(across, across)
        force[1] = dot(cross(g, wrench), across) / (square * size)
        force[0] = dot(cross(wrench, unit), across) / square + share * force[1]
    elif work.basis[3] // 2 == work.basis[4] // 2:
        force[2], force[0], force[1] = _shares(wrench, pick(work.push, work.basis[5]), (g, h))
    elif work.basis[4] // 2 == work.basis[5] // 2:
        force[0], force[1], force[2] = _shares(wrench, g, (h, pick(work.push, work.basis[5])))
    else:
        e, gh = pick(work.push, work.basis[5]), cross(g, h)
        det = dot(e, gh)
        force[0] = dot(wrench, cross(h, e)) / det
        force[1] = dot(wrench, cross(e, g)) / det
        force[2] = dot(wrench, gh) / det


@inlined
def _shares(wrench: Triple, e: Triple, pair: tuple[Triple, Triple]) -> Triple:
    """Shares of three wrenches in one: of e, and of the two edges of the cone of another contact.

    The share of e grows without bound where its line goes through that contact. If it is parallel
    to an edge of the cone, the share of the other edge does not: then e does not enter it.
    """
    g, h = pair
    about = cross(g, h)
    share = dot(wrench, about) / dot(e, about)
    of_g = wrench[0] * h[1] - wrench[1] * h[0] - share * (e[0] * h[1] - e[1] * h[0])
    of_h = g[0] * wrench[1] - g[1] * wrench[0] - share * (g[0] * e[1] - g[1] * e[0])
    return share, of_g / about[2], of_h / about[2]


@inlined
def _slide(scene: Scene, work: Work, place: Place, clock: float) -> None:
    """Velocity with one contact that slips; the same as `solve_twist`, without the tables."""
    if not is_even(work):
        lay_out(work, place)
    c = work.basis[0] // 2
    kind, i = work.contact[c, KIND], work.contact[c, FIRST]
    nx, ny, px, py, ux, uy, _, _ = frame(scene, kind, i, work.contact[c, SECOND], place, clock)
    mu = friction(scene, work, kind, i) * (1.0 if work.mode[c] == SLIP_MINUS else -1.0)
    gx, gy = nx + mu * ny, ny - mu * nx
    v = times(work.film, (gx, gy, px * gy - py * gx))
    share = (nx * ux + ny * uy) / (nx * v[0] + ny * v[1] + (px * ny - py * nx) * v[2])
    work.force[0] = share
    work.twist[0], work.twist[1], work.twist[2] = share * v[0], share * v[1], share * v[2]


@sealed
def velocity(scene: Scene, work: Work, place: Place, clock: float) -> Triple:
    """Velocity (x', y', θ') of the part in the world, in the present mode and basis."""
    if work.count[HELD] == 1:
        _slide(scene, work, place, clock)
    else:
        fill_all(scene, work, place, clock, True)
        solve_twist(work)
    vx, vy = work.twist[0], work.twist[1]
    return place[2] * vx - place[3] * vy, place[3] * vx + place[2] * vy, work.twist[2]


@inlined
def speed(work: Work, row: int) -> float:
    """Speed of the part against a constraint."""
    r, v = work.row, work.twist
    return float(r[row, 0] * v[0] + r[row, 1] * v[1] + r[row, 2] * v[2] - r[row, 3])


@inlined
def _rolls(scene: Scene, kind: int, i: int) -> bool:
    """Whether a contact that sticks can move on the part: only that of a disc."""
    return bool(kind != WALL and scene.tips[i, 4] > 0.0)


@inlined
def monitor(scene: Scene, work: Work, place: Place, clock: float) -> int:
    """Find the forces, and write what must not become negative; `velocity` was called here before.

    Returns
    -------
    int
        How many there are; see `watch`.
    """
    if work.count[HELD] == 1:  # `velocity` went without the tables
        for c in range(work.count[TOUCHING]):
            if work.mode[c] != SEPARATE:
                fill(scene, work, c, place, clock)
    solve_forces(work)
    return watch(scene, work)


@inlined
def watch(scene: Scene, work: Work) -> int:
    """Write what must not become negative in the present mode, its twist and forces being known.

    First the forces of the basis, as ``1/(a + 1/a)``: that is zero both where
    a force ends and where it grows without bound and returns with the other sign. Then, for each
    closed contact, the slip in its direction and the two lengths of `frame`, if they can change.

    Returns
    -------
    int
        How many there are.
    """
    count = int(work.count[HELD])
    for k in range(count):
        work.slack[k] = 1.0 / (work.force[k] + 1.0 / work.force[k])
    for c in range(work.count[TOUCHING]):
        mode = work.mode[c]
        if mode == SEPARATE:
            continue
        kind, i = work.contact[c, KIND], work.contact[c, FIRST]
        if mode != STICK and friction(scene, work, kind, i) > 0.0:
            slip = speed(work, 2 * c + 1)
            work.slack[count] = slip if mode == SLIP_PLUS else -slip
            count += 1
        if mode != STICK or _rolls(scene, kind, i):
            work.slack[count] = work.row[2 * c, 4]
            work.slack[count + 1] = work.row[2 * c + 1, 4]
            count += 2
    return count
