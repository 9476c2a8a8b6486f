"""Lemke's method on problems with a known answer and on random ones."""

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings, strategies as st
from scipy.optimize import linprog

from meso_robust.simulator.lemke import RAY, RESIDUAL, SOLVED, _read
from tests.simulator.entries import goes_first, lemke
from tests.simulator.problems import contact_problems, random_rows, some_mode_holds

F = npt.NDArray[np.float64]


def solve(M: F, q: F) -> tuple[int, F]:
    n = len(q)
    z = np.full(n, np.nan)
    tableau = np.full((n + 3, (n + 3) // 4 * 4), np.nan)
    index = np.full(4 * n + 2, -(10**6), np.int64)
    return int(lemke(n, M, q, z, tableau, index)), z


def assert_solution(M: F, q: F, z: F) -> None:
    w = M @ z + q
    scale = max(1.0, float(np.max(z)), float(np.max(np.abs(q))))
    assert np.all(z >= -1e-8 * scale)
    assert np.all(w >= -1e-8 * scale)
    assert np.all(np.minimum(z, w) <= 1e-8 * scale)


def test_by_hand() -> None:
    # 2 z1 + z2 = 5, z1 + 2 z2 = 6
    status, z = solve(np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([-5.0, -6.0]))
    assert status == SOLVED
    np.testing.assert_allclose(z, [4 / 3, 7 / 3], rtol=1e-14)


def test_non_negative_vector_is_solved_by_zero() -> None:
    status, z = solve(np.array([[-1.0]]), np.array([0.0]))
    assert (status, z[0]) == (SOLVED, 0.0)


def test_without_solution_ends_on_a_ray() -> None:
    # w1 = z1 + z2 − 1 and w2 = −z1 − z2 − 1 cannot both be non-negative.
    status, z = solve(np.array([[1.0, 1.0], [-1.0, -1.0]]), np.array([-1.0, -1.0]))
    assert status == RAY
    assert np.all(z == 0.0)


def test_degenerate_ties_end() -> None:
    # All ratios tie; the one solution of z1 + z2 + z3 ≥ 1 with equal rows needs the sum only.
    M = np.ones((3, 3))
    status, z = solve(M, -np.ones(3))
    assert status == SOLVED
    assert z.sum() == pytest.approx(1.0)


@settings(deadline=None, max_examples=300)
@given(st.integers(1, 9), st.integers(0, 2**32 - 1))
def test_p_matrix_gives_the_one_solution(n: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    A = rng.uniform(-1, 1, (n, n))
    skew = rng.uniform(-1, 1, (n, n))
    M = A @ A.T + 0.2 * np.eye(n) + skew - skew.T  # positive definite, so a P-matrix
    # Choose the solution first, then the vector that it solves.
    z = rng.uniform(0.1, 1, n) * (rng.random(n) < 0.5)
    q = np.where(z > 0, 0.0, rng.uniform(0.1, 1, n)) - M @ z
    status, found = solve(M, q)
    assert status == SOLVED
    np.testing.assert_allclose(found, z, atol=1e-9)


@settings(deadline=None, max_examples=300)
@given(st.integers(1, 3), st.integers(0, 2**32 - 1))
def test_contact_problem_made_to_be_solvable(contacts: int, seed: int) -> None:
    # All gaps closing by the motion of one rigid body: its own velocity opens them all.
    rng = np.random.default_rng(seed)
    rows = random_rows(1, contacts, rng)
    twist = rng.uniform(-1, 1, 3)
    rows[0, :, 0] = -(rows[0, :, 2:5] @ twist)
    rows[0, :, 1] = -(rows[0, :, 5:8] @ twist)
    M, q = contact_problems(rows, np.zeros(1))
    status, z = solve(M[0], q[0])
    assert status == SOLVED
    assert_solution(M[0], q[0], z)


@settings(deadline=None, max_examples=200)
@given(st.integers(1, 4), st.floats(0, 1), st.integers(0, 2**32 - 1))
def test_what_is_called_solved_is_solved(contacts: int, mu: float, seed: int) -> None:
    rows = random_rows(1, contacts, np.random.default_rng(seed))
    M, q = contact_problems(rows, np.array([mu]))
    status, z = solve(M[0], q[0])
    # With three or more contacts, one problem in 10⁴ is too badly conditioned to pass the check.
    assert status in (SOLVED, RAY) or (contacts > 2 and status == RESIDUAL)
    if status == SOLVED:
        assert_solution(M[0], q[0], z)
    if contacts == 1:  # one contact can always give way
        assert status == SOLVED


def test_two_contacts_are_solved_if_and_only_if_a_mode_holds() -> None:
    rng = np.random.default_rng(7)
    M, q = contact_problems(random_rows(3000, 2, rng), rng.uniform(0, 1, 3000))
    rays = 0
    for i in range(3000):
        status, z = solve(M[i], q[i])
        if status == SOLVED:
            assert_solution(M[i], q[i], z)
        else:
            assert status == RAY
            assert not some_mode_holds(8, M[i], q[i])
            rays += 1
    assert 0 < rays < 300


def test_degenerate_problem_is_solved_if_and_only_if_it_is_feasible() -> None:
    # With M = A Aᵀ of small integers, ties abound and M is singular; a wrong choice ends on a ray.
    rng = np.random.default_rng(11)
    solved = 0
    for _ in range(400):
        A = rng.integers(-1, 2, (3, 3)).astype(float)
        M, q = A @ A.T, -rng.integers(0, 2, 3).astype(float)
        status, z = solve(M, q)
        assert (status == SOLVED) == (linprog(np.zeros(3), A_ub=-M, b_ub=q).status == 0)
        if status == SOLVED:
            assert_solution(M, q, z)
            solved += 1
    assert 0 < solved < 400


def test_tie_goes_to_the_artificial_variable_then_to_the_lexicographically_lower_row() -> None:
    # Basis (z1, z2) for the pair, both rows with slope 1; the columns of w1 and w2 are −B⁻¹.
    tableau = np.zeros((5, 4))
    tableau[0, :2] = [-1.0, -2.0]  # w1
    tableau[1, :2] = [-3.0, 0.0]  # w2
    tableau[2, :2] = [-1.0, -1.0]  # driving
    index = np.array([2, 3, 0, 1, 4, 0, 1, 0, 0, 0])
    assert goes_first(2, tableau, index, 2, 0, 1)
    assert not goes_first(2, tableau, index, 2, 1, 0)
    tableau[0, :2] = -1.0  # a tie in w1 too, so w2 decides
    assert not goes_first(2, tableau, index, 2, 0, 1)
    index[0] = 4  # z0
    assert goes_first(2, tableau, index, 2, 0, 1)
    assert not goes_first(2, tableau, index, 2, 1, 0)


@pytest.mark.parametrize(
    ("z", "status"), [(1.0, SOLVED), (0.5, RESIDUAL), (1.5, RESIDUAL), (-0.5, RESIDUAL)]
)
def test_the_residual_of_a_point_is_checked_against_the_problem_as_given(
    z: float, status: int
) -> None:
    """0 ≤ z ⊥ z − 1 ≥ 0 has z = 1 alone: a gap is open, a force pulls, or both are at once."""
    tableau, index = np.zeros((4, 4)), np.zeros(6, dtype=np.int64)
    tableau[2, 0], index[0] = z, 1  # the basis holds z, at this value

    assert _read(1, np.eye(1), -np.ones(1), np.zeros(1), tableau, index, -1, 0) == status
