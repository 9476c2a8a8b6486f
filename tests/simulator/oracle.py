"""Geometry and contact modes by plain NumPy, to hold against the simulator; nothing is shared."""

from __future__ import annotations

import itertools
from functools import cache

import numpy as np
import numpy.typing as npt
from scipy.optimize import nnls

F = npt.NDArray[np.float64]


def turned(angle: float) -> F:
    """Matrix of a rotation."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def placed(vertices: F, pose: F) -> F:
    """Corners in the world at a pose x, y, θ."""
    return np.asarray(vertices @ turned(pose[2]).T + pose[:2])


def signed_distance(vertices: F, points: F) -> F:
    """Distance of points (K, 2) to the boundary of an outline, negative in the solid.

    Inside or outside is the parity of crossings of a ray, so that the outline may be clockwise, with
    the solid around it.
    """
    start, end = vertices, np.roll(vertices, -1, axis=0)
    edge, to = end - start, points[:, None] - start
    share = np.sum(to * edge, axis=2) / np.sum(edge**2, axis=1)
    near = to - np.clip(share, 0, 1)[..., None] * edge
    distance = np.sqrt(np.min(np.sum(near**2, axis=2), axis=1))
    y = points[:, None, 1]
    spans = (start[:, 1] > y) != (end[:, 1] > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        cut = start[:, 0] + (y - start[:, 1]) / edge[:, 1] * edge[:, 0]
    inside = np.sum(spans & (points[:, None, 0] < cut), axis=1) % 2 == 1
    x, yy = vertices.T
    hollow = np.sum(x * np.roll(yy, -1) - yy * np.roll(x, -1)) < 0
    return np.where(inside != hollow, -distance, distance)


def crosses(one: F, two: F) -> bool:
    """Whether any edge of one outline properly crosses any of another."""

    def side(a: F, b: F, p: F) -> F:
        u, v = b - a, p - a
        return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])

    a, b = one[:, None], np.roll(one, -1, axis=0)[:, None]
    c, d = two[None], np.roll(two, -1, axis=0)[None]
    return bool(np.any((side(a, b, c) * side(a, b, d) < 0) & (side(c, d, a) * side(c, d, b) < 0)))


def gap_of_outlines(one: F, two: F) -> float:
    """Distance of two solids that are apart; minus the depth of the deepest corner if they are not."""
    return min(float(signed_distance(one, two).min()), float(signed_distance(two, one).min()))


def motions(rows: F, friction: F, tolerance: float = 1e-9) -> tuple[list[F], float]:
    """Every motion of a step, by linear algebra on each of the 4^k contact modes.

    Parameters
    ----------
    rows
        (k, 8) q_n, q_t, w_n and w_t of contacts.
    friction
        (k,)
    tolerance
        Violation that is taken for rounding, in steps and relative to the largest force.

    Returns
    -------
    tuple
        Distinct motions (3,), and the least violation over all modes: negative where one holds with
        room to spare, large and positive where none comes near.
    """
    qn, qt, wn, wt = rows[:, 0], rows[:, 1], rows[:, 2:5], rows[:, 5:8]
    k = len(rows)
    found: list[F] = []
    least = np.inf
    modes = _all_modes(k)
    systems, rights = _systems(modes, rows, friction)
    unknowns = np.sum(np.array([0, 2, 1, 1])[modes], axis=1)
    small = unknowns <= 3
    with np.errstate(all="ignore"):
        try:
            solutions = np.linalg.solve(systems[small], rights[small][..., None])[..., 0]
        except np.linalg.LinAlgError:
            solutions = np.einsum("mij,mj->mi", np.linalg.pinv(systems[small]), rights[small])
        error = np.abs(np.einsum("mij,mj->mi", systems[small], solutions) - rights[small])
        violation = _violation(modes[small], solutions, qn, qt, wn, wt, friction)
        violation = np.maximum(violation, np.max(error, axis=1))
    for m in range(len(violation)):
        if np.isfinite(violation[m]):
            least = min(least, float(violation[m]))
            if violation[m] <= tolerance:
                _keep(found, solutions[m, :3])
    for mode in modes[~small]:
        least = min(least, _redundant(mode, rows, friction, tolerance, found))
    return found, least


@cache
def _all_modes(k: int) -> npt.NDArray[np.int64]:
    return np.array(list(itertools.product(range(4), repeat=k)), dtype=np.int64).reshape(-1, k)


def _systems(modes: npt.NDArray[np.int64], rows: F, friction: F) -> tuple[F, F]:
    """Linear systems in (motion, λ_n, λ_t): the balance, then two conditions a contact."""
    count, k = modes.shape
    qn, qt, wn, wt = rows[:, 0], rows[:, 1], rows[:, 2:5], rows[:, 5:8]
    A, b = np.zeros((count, 3 + 2 * k, 3 + 2 * k)), np.zeros((count, 3 + 2 * k))
    A[:, :3, :3] = np.eye(3)
    A[:, :3, 3 : 3 + k], A[:, :3, 3 + k :] = -wn.T, -wt.T
    for c in range(k):
        r = 3 + 2 * c
        apart, stick = modes[:, c] == 0, modes[:, c] == 1
        slope = np.array([0.0, 0.0, 1.0, -1.0])[modes[:, c]] * friction[c]
        A[:, r, :3] = np.where(apart[:, None], 0.0, wn[c])
        A[:, r, 3 + c] = apart
        b[:, r] = np.where(apart, 0.0, -qn[c])
        A[:, r + 1, :3] = np.where(stick[:, None], wt[c], 0.0)
        A[:, r + 1, 3 + k + c] = ~stick
        A[:, r + 1, 3 + c] = -slope
        b[:, r + 1] = np.where(stick, -qt[c], 0.0)
    return A, b


def _violation(modes: npt.NDArray[np.int64], x: F, qn: F, qt: F, wn: F, wt: F, friction: F) -> F:
    """(m,) the worst inequality of each solution, relative to the largest force."""
    k = len(qn)
    vn, vt = x[:, :3] @ wn.T + qn, x[:, :3] @ wt.T + qt
    ln, lt = x[:, 3 : 3 + k], x[:, 3 + k :]
    apart, stick = modes == 0, modes == 1
    worst = np.where(apart, -vn, -ln)
    worst = np.maximum(worst, np.where(stick, np.abs(lt) - friction * ln, -np.inf))
    worst = np.maximum(worst, np.where(modes == 2, vt, -np.inf))
    worst = np.maximum(worst, np.where(modes == 3, -vt, -np.inf))
    return np.asarray(worst.max(axis=1) / np.maximum(1.0, np.abs(ln).max(axis=1)))


def _redundant(
    mode: npt.NDArray[np.int64], rows: F, friction: F, tolerance: float, found: list[F]
) -> float:
    """Violation of a mode with more forces than the motion can tell apart.

    Its conditions of no motion leave at most one motion; the forces are then a non-negative sum of
    the edges of the cones.
    """
    qn, qt, wn, wt = rows[:, 0], rows[:, 1], rows[:, 2:5], rows[:, 5:8]
    on, stick = mode > 0, mode == 1
    C = np.vstack([wn[on], wt[stick]])
    right = -np.concatenate([qn[on], qt[stick]])
    motion, _, rank, _ = np.linalg.lstsq(C, right, rcond=1e-10)
    miss = float(np.max(np.abs(C @ motion - right)))
    if miss > 1e-6:
        return miss
    edges = []
    for c in np.flatnonzero(on):
        plus, minus = wn[c] + friction[c] * wt[c], wn[c] - friction[c] * wt[c]
        edges += [plus, minus] if stick[c] else [plus if mode[c] == 2 else minus]
    columns = np.array(edges).T
    if rank == 3:
        _, rest = nnls(columns, motion)
    else:  # the motion along the free direction follows from the forces
        _, rest = nnls(C @ columns, right)
        motion = columns @ nnls(C @ columns, right)[0]
    vn, vt = wn @ motion + qn, wt @ motion + qt
    worst = max(miss, rest, float(np.max(np.where(on, -np.inf, -vn))))
    worst = max(worst, float(np.max(np.where(mode == 2, vt, -np.inf))))
    worst = max(worst, float(np.max(np.where(mode == 3, -vt, -np.inf))))
    if worst <= tolerance * 10:
        _keep(found, motion)
    return worst


def _keep(found: list[F], motion: F) -> None:
    if all(np.max(np.abs(motion - other)) > 1e-6 for other in found):
        found.append(motion.copy())
