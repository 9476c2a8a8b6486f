"""Pushes and complementarity problems shared by the tests and the benchmarks."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from meso_robust.simulator import Fixture, Point, Push
from meso_robust.simulator.arrange import inputs_of
from meso_robust.simulator.modes import NONE
from meso_robust.simulator.tables import (
    CONTACT_COLUMNS,
    CONTACTS,
    MARK_COLUMNS,
    MARKS,
    MAX_CONTACTS,
    OBSTACLES,
    PART,
    Work,
)
from meso_robust.simulator.tips import Tip
from tests.simulator.entries import case_of, find_contacts, new_walk, next_mode, workspace

F = npt.NDArray[np.float64]

UM = 1e-6
RHO = 0.3769e-6
MU = 0.33
HALF_LONG = 808 * UM
HALF_SHORT = 418.5 * UM
WIDTH = 2 * HALF_SHORT


def rectangle(half_long: float = HALF_LONG, half_short: float = HALF_SHORT) -> F:
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    return np.asarray(signs * [half_long, half_short], dtype=np.float64)


def one_point(d2: float, travel: float, step: float, mu: float = MU) -> Push:
    """One tip on the right-hand long edge, d2 beside the centre, going left; θ starts at 90°."""
    return Push.straight(
        vertices=rectangle(),
        poses=np.array([[0.0, 0.0, np.pi / 2]]),
        tips=np.array([[[HALF_SHORT, d2]]]),
        travel=np.array([[[-travel, 0.0]]]),
        friction=np.array([mu]),
        film_ratio=np.array([RHO]),
        step=step,
    )


def two_sided(
    heights: Sequence[float] | F, travel: float, step: float, half_long: float = HALF_LONG
) -> Push:
    """A passive tip low on the left edge and one high on the right edge going left, for each V."""
    V = np.asarray(heights, dtype=np.float64)
    runs = len(V)
    tips = np.zeros((runs, 2, 2))
    tips[:, 0] = np.column_stack([np.full(runs, -HALF_SHORT), -V / 2])
    tips[:, 1] = np.column_stack([np.full(runs, HALF_SHORT), V / 2])
    moves = np.zeros((runs, 2, 2))
    moves[:, 1, 0] = -travel
    return Push.straight(
        vertices=rectangle(half_long),
        poses=np.tile([0.0, 0.0, np.pi / 2], (runs, 1)),
        tips=tips,
        travel=moves,
        friction=np.full(runs, MU),
        film_ratio=np.full(runs, RHO),
        step=step,
    )


def single(  # noqa: PLR0913 - each of them is one number of a push
    vertices: F,
    start: Sequence[float] | F,
    travel: Sequence[float] | F,
    *,
    shape: Tip | None = None,
    pose: Sequence[float] | F = (0.0, 0.0, 0.0),
    mu: float = MU,
    fixture: Fixture | None = None,
    rho: float = RHO,
    step: float = 1 * UM,
) -> Push:
    """One probe and one run; lengths in m."""
    return Push.straight(
        vertices=vertices,
        poses=np.array([pose], dtype=np.float64),
        tips=np.array([[start]], dtype=np.float64),
        travel=np.array([[travel]], dtype=np.float64),
        friction=np.array([mu]),
        film_ratio=rho,
        shapes=(shape or Point(),),
        fixture=fixture or Fixture(),
        step=step,
    )


def contacts_at(
    push: Push, pose: F, tips: F, way: F, *, last: F | None = None, reach: float
) -> tuple[F, npt.NDArray[np.int64]]:
    """Contacts that the simulator finds with the probes at `tips`, about to move by `way`.

    Returns
    -------
    tuple
        (k, 7) rows of gap, normal, point, displacement of the obstacle, body frame; (k,) obstacles.
    """
    case = case_of(0, inputs_of(push, push.steps_of_legs, unique=False))
    obstacles, probes = case.obstacles.copy(), len(push.shapes)
    obstacles[:probes, OBSTACLES.x : OBSTACLES.x + 2] = tips
    obstacles[:probes, OBSTACLES.move_x : OBSTACLES.move_x + 2] = way
    contacts, marks = (
        np.zeros((MAX_CONTACTS, CONTACT_COLUMNS)),
        np.zeros((MAX_CONTACTS + 1, MARK_COLUMNS), int),
    )
    body = np.zeros(32)
    body[PART.moved : PART.moved + 3] = 0.0 if last is None else last
    ahead = pose[2] + 0.5 * body[PART.moved + 2]  # where displacements are turned
    body[PART.cos], body[PART.sin] = np.cos(ahead), np.sin(ahead)
    count = find_contacts(case.scene, obstacles, pose, body, reach, contacts, marks)
    assert count <= MAX_CONTACTS
    return contacts[:count, :7], marks[:count, MARKS.who]


def in_body(poses: F, points: F) -> F:
    """World points (K, 2) in the body frames of the poses (K, 3)."""
    turn = np.exp(-1j * poses[:, 2])
    z = turn * ((points[:, 0] - poses[:, 0]) + 1j * (points[:, 1] - poses[:, 1]))
    return np.column_stack([z.real, z.imag])


def random_rows(count: int, contacts: int, rng: np.random.Generator) -> F:
    """Contact rows (count, contacts, 8) with any normals, arms and slips."""
    angle = rng.uniform(0, 2 * np.pi, (count, contacts))
    m = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    t = np.stack([-m[..., 1], m[..., 0]], axis=-1)
    p = rng.uniform(-1.3, 1.3, (count, contacts, 2))
    arms = [p[..., 0] * v[..., 1] - p[..., 1] * v[..., 0] for v in (m, t)]
    q = np.stack(
        [rng.uniform(-1, 0.5, (count, contacts)), rng.uniform(-1, 1, (count, contacts))], axis=-1
    )
    return np.concatenate([q, m, arms[0][..., None], t, arms[1][..., None]], axis=-1)


def workspace_of(rows: F, friction: float | F) -> Work:
    """Workspace with rows (k, 8) of as many probes, all active, no modes to try."""
    work = workspace(len(rows))
    fill(work, rows, friction)
    return work


def fill(work: Work, rows: F, friction: float | F) -> None:
    """Write rows (k, 8) into a workspace."""
    work.contacts[:] = 0.0
    work.marks[:] = 0
    work.contacts[:, CONTACTS.qn], work.contacts[:, CONTACTS.qt] = rows[:, 0], rows[:, 1]
    (
        work.contacts[:, CONTACTS.wn : CONTACTS.wn + 3],
        work.contacts[:, CONTACTS.wt : CONTACTS.wt + 3],
    ) = rows[:, 2:5], rows[:, 5:8]
    work.contacts[:, CONTACTS.mu] = friction
    work.marks[:-1, MARKS.who] = work.marks[:-1, MARKS.active] = np.arange(len(rows))


def contact_problems(rows: F, friction: F) -> tuple[F, F]:
    """The matrices (count, 4k, 4k) and vectors (count, 4k) of contact rows (count, k, 8).

    Built from the wrenches as whole matrices, J Jᵀ and the blocks of the cone, unlike the package.
    """
    count, k, _ = rows.shape
    wn, wt = rows[..., 2:5], rows[..., 5:8]
    J = np.stack([wn, wt, -wt, 0 * wn], axis=2).reshape(count, 4 * k, 3)
    M = J @ J.transpose(0, 2, 1)
    cone = np.zeros((count, 4, 4))
    cone[:, 1:3, 3] = 1.0
    cone[:, 3, 1:3] = -1.0
    cone[:, 3, 0] = friction
    for c in range(k):
        M[:, 4 * c : 4 * c + 4, 4 * c : 4 * c + 4] += cone
    q = np.stack([rows[..., 0], rows[..., 1], -rows[..., 1], 0 * rows[..., 0]], axis=-1)
    return M, q.reshape(count, 4 * k)


def some_mode_holds(n: int, M: npt.NDArray[np.float64], q: npt.NDArray[np.float64]) -> bool:
    """Whether any contact mode solves a step, or that could not be decided."""
    return bool(next_mode(n, M, q, np.empty(n), new_walk(n)) != NONE)
