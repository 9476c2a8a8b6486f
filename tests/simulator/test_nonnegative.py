"""Non-negative least squares against SciPy's, and its residual as a proof."""

import numpy as np
import pytest
from numba import njit
from scipy.optimize import nnls

from tests.nightly import by_day
from tests.simulator.entries import nearest


@njit
def solve(A, q, x, r):  # type: ignore[no-untyped-def]
    m, n = A.shape
    return nearest(A, q, x, r, np.empty((n + 4, max(m, n) + 1)), np.empty(2 * m, np.int64))


@pytest.mark.parametrize(("columns", "size"), by_day(2, [(3, 5), (8, 8), (16, 8), (24, 12)]))
def test_nearest_point_of_random_cones(columns: int, size: int) -> None:
    rng = np.random.default_rng(columns)
    inside = 0
    for _ in range(200):
        A = rng.standard_normal((columns, size))
        q = (
            A.T @ np.maximum(rng.standard_normal(columns), 0)
            if rng.random() < 0.5
            else (rng.standard_normal(size))
        )
        x, r = np.zeros(columns), np.zeros(size)
        assert solve(A, q, x, r)
        _, distance = nnls(A.T, q)
        assert np.linalg.norm(r) == pytest.approx(distance, abs=1e-12)
        np.testing.assert_allclose(r, q - A.T @ x, atol=1e-12)
        assert np.all(x >= 0)
        # The plane across the residual has the whole cone on one side and q on the other.
        assert np.all(A @ r <= 1e-11)
        assert r @ q == pytest.approx(r @ r, abs=1e-11)
        inside += distance < 1e-10
    assert 50 < inside < 200


def test_columns_that_differ_by_a_hair_do_not_spoil_the_answer() -> None:
    rng = np.random.default_rng(1)
    for _ in range(200):
        A = rng.standard_normal((6, 6))
        twin = A[2] + 1e-8 * rng.standard_normal(6)
        A = np.vstack([A, twin])
        q = A.T @ np.abs(rng.standard_normal(7))
        x, r = np.zeros(7), np.zeros(6)
        assert solve(A, q, x, r)
        assert np.linalg.norm(r) < 1e-10
