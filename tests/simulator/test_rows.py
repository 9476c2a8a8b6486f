"""The rows and the problem of a step against whole matrices, and its residual check."""

import numpy as np
import pytest

from meso_robust.simulator.tables import CONTACT_COLUMNS, CONTACTS, MARKS, STEP, STEP_LENGTH
from tests.simulator.entries import assemble, factorise, is_solution, move_by_forces, write_rows
from tests.simulator.problems import contact_problems, random_rows, workspace_of


def test_matrix_and_vector() -> None:
    rows = random_rows(1, 3, np.random.default_rng(3))
    work = workspace_of(rows[0], 0.4)
    work.marks[:3, MARKS.active] = [2, 0, 0]
    assert assemble(work.contacts, work.marks, work.step, 2, work.matrix, work.vector[0]) == 8
    M, q = contact_problems(rows[:, [2, 0]], np.array([0.4]))
    np.testing.assert_allclose(work.matrix[:8, :8], M[0], atol=1e-15)
    np.testing.assert_allclose(work.vector[0, :8], q[0], atol=1e-15)


def test_each_contact_has_its_own_friction() -> None:
    rows = random_rows(1, 2, np.random.default_rng(3))
    work = workspace_of(rows[0], np.array([0.2, 0.7]))
    assemble(work.contacts, work.marks, work.step, 2, work.matrix, work.vector[0])
    assert work.matrix[3, 0] == 0.2
    assert work.matrix[7, 4] == 0.7
    assert work.matrix[3, 4] == work.matrix[7, 0] == 0.0


def test_rows_give_motion_and_slip_of_the_full_film() -> None:
    """For any film E: forces λ move the part by E⁻¹ Σ wrench, and v is that of the points."""
    rng = np.random.default_rng(8)
    A = rng.normal(size=(3, 3))
    E = A @ A.T + 0.3 * np.eye(3)
    contacts, step = np.zeros((2, CONTACT_COLUMNS)), np.zeros(STEP_LENGTH)
    angle, unit = rng.uniform(0, 6, 2), 0.37
    n = np.column_stack([np.cos(angle), np.sin(angle)])
    p, d, gap = rng.normal(size=(2, 2)), rng.normal(size=(2, 2)), rng.normal(size=2)
    contacts[:, 0], contacts[:, 1:3], contacts[:, 3:5], contacts[:, 5:7] = gap, n, p, d
    assert factorise(E[np.triu_indices(3)], step)
    assert write_rows(contacts, step, 2, unit)
    contacts[:, CONTACTS.ln], contacts[:, CONTACTS.lt] = rng.uniform(0, 1, 2), rng.normal(size=2)
    move_by_forces(contacts, step, 2)
    t = np.column_stack([n[:, 1], -n[:, 0]])  # the inward normal turned by +90°
    force = -contacts[:, [CONTACTS.ln]] * n + contacts[:, [CONTACTS.lt]] * t
    wrench = np.append(force.sum(axis=0), np.sum(p[:, 0] * force[:, 1] - p[:, 1] * force[:, 0]))
    motion = E[0, 0] * unit * np.linalg.solve(E, wrench)
    point = motion[:2] + motion[2] * np.column_stack([-p[:, 1], p[:, 0]])
    relative = point - d
    vn = contacts[:, CONTACTS.qn] + contacts[:, CONTACTS.wn : CONTACTS.wn + 3] @ step[:3]
    vt = contacts[:, CONTACTS.qt] + contacts[:, CONTACTS.wt : CONTACTS.wt + 3] @ step[:3]
    np.testing.assert_allclose(unit * vn, gap - np.sum(relative * n, axis=1), atol=1e-12)
    np.testing.assert_allclose(unit * vt, np.sum(relative * t, axis=1), atol=1e-12)


def test_rows_that_are_not_finite_are_told() -> None:
    contacts, step = np.zeros((1, CONTACT_COLUMNS)), np.zeros(STEP_LENGTH)
    step[[STEP.factor, STEP.factor + 2, STEP.factor + 5]] = 1.0
    contacts[0, 1] = 1.0
    assert write_rows(contacts, step, 1, 1.0)
    contacts[0, 0] = np.nan
    assert not write_rows(contacts, step, 1, 1.0)


@pytest.mark.parametrize(
    ("force", "expected"),
    [
        ((1.0, -0.5), True),  # on the edge of the cone, against the slip
        ((1.0, 0.5), False),  # with the slip
        ((1.0, -0.4), False),  # slips inside the cone
        ((1.0, -2.0), False),  # sticks outside the cone
        ((0.9, -0.45), False),  # penetrates
        ((1.1, -0.55), False),  # pushes at a distance
        ((np.nan, 0.0), False),
    ],
)
def test_residual_check_takes_only_the_solution(force: tuple[float, float], expected: bool) -> None:
    # A contact pushed along its normal through the centre with a sideways part: it slips.
    work = workspace_of(np.array([[-1.0, 2.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]]), 0.5)
    work.contacts[0, [CONTACTS.ln, CONTACTS.lt]] = force
    move_by_forces(work.contacts, work.step, 1)
    assert is_solution(work.contacts, work.marks, work.step, 1) is expected
