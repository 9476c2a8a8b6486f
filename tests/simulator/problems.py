"""Pushes and complementarity problems shared by the tests and the benchmarks."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from meso_robust.simulator import Push

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
    return Push(
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
    return Push(
        vertices=rectangle(half_long),
        poses=np.tile([0.0, 0.0, np.pi / 2], (runs, 1)),
        tips=tips,
        travel=moves,
        friction=np.full(runs, MU),
        film_ratio=np.full(runs, RHO),
        step=step,
    )


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
