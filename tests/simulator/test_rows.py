"""The problem of a step against its construction by whole matrices, and its residual check."""

import numpy as np

from meso_robust.simulator.rows import assemble, is_solution, move_by_forces, workspace
from tests.simulator.problems import contact_problems, random_rows


def test_matrix_and_vector() -> None:
    rows = random_rows(1, 3, np.random.default_rng(3))
    work = workspace(3)
    work.rows[:] = rows[0]
    work.active[:] = [2, 0, 0]
    assert assemble(work, 2, 0.4) == 8
    M, q = contact_problems(rows[:, [2, 0]], np.array([0.4]))
    np.testing.assert_allclose(work.matrix[:8, :8], M[0], atol=1e-15)
    np.testing.assert_allclose(work.vector[0, :8], q[0], atol=1e-15)


def test_residual_check_takes_only_the_solution() -> None:
    # A contact pushed along its normal through the centre with a sideways part: it slips.
    work = workspace(1)
    work.rows[:] = [[-1.0, 2.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]]
    cases = {
        (1.0, -0.5): True,  # on the edge of the cone, against the slip
        (1.0, 0.5): False,  # with the slip
        (1.0, -0.4): False,  # slips inside the cone
        (1.0, -2.0): False,  # sticks outside the cone
        (0.9, -0.45): False,  # penetrates
        (1.1, -0.55): False,  # pushes at a distance
        (np.nan, 0.0): False,
    }
    for force, expected in cases.items():
        work.force[:] = [force]
        move_by_forces(work)
        assert is_solution(work, 0.5) is expected, force
