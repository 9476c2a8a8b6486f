"""The batched simplexes go the way of SciPy's, and end where they are small."""

import numpy as np
import pytest
from scipy.optimize import minimize

from meso_robust.identification.nelder_mead import around, minimised, size

Floats = np.ndarray


def valley(points: Floats) -> Floats:
    """Rosenbrock's function in any dimension."""
    a, b = points[:, :-1], points[:, 1:]
    return np.asarray(np.sum(100.0 * (b - a**2) ** 2 + (1.0 - a) ** 2, axis=1))


def kinked(points: Floats) -> Floats:
    """Largest distance to a point along an axis, infinite beyond a wall: kinks and a constraint."""
    away = np.abs(points - np.arange(1, points.shape[1] + 1) * 0.3).max(axis=1)
    return np.where(points[:, 0] < 1.0, away, np.inf)


@pytest.mark.parametrize("function", [valley, kinked])
@pytest.mark.parametrize("iterations", [1, 7, 60])
def test_every_iteration_is_that_of_scipy(function: object, iterations: int) -> None:
    rng = np.random.default_rng(iterations)
    simplexes = rng.uniform(-0.5, 0.9, (4, 4, 3))
    found = minimised(function, simplexes, threshold=0.0, most=iterations)  # type: ignore[arg-type]
    for k in range(4):
        peer = minimize(
            lambda point: function(point[None])[0],  # type: ignore[operator]
            simplexes[k][0],
            method="Nelder-Mead",
            options={
                "initial_simplex": simplexes[k],
                "maxiter": iterations + 1,  # SciPy counts the first simplex as one
                "xatol": 0.0,
                "fatol": 0.0,
                "maxfev": 10**6,
            },
        )
        points, values = peer.final_simplex
        np.testing.assert_allclose(found.values[k], values, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(found.points[k], points, rtol=1e-6, atol=1e-9)


def test_the_size_is_the_average_distance_from_the_centre() -> None:
    corners = np.array([[[0.0, 0.0], [3.0, 0.0], [0.0, 3.0]]])
    assert size(corners)[0] == pytest.approx((np.sqrt(2.0) + 2.0 * np.sqrt(5.0)) / 3.0)


def test_searches_end_when_small_each_in_its_own_time() -> None:
    rng = np.random.default_rng(0)
    starts = np.concatenate([[[1.0, 1.0]], rng.uniform(-2.0, 2.0, (3, 2))])
    edges = around(starts, 0.1, lambda points: np.ones(len(points), dtype=bool))
    found = minimised(valley, edges, threshold=1e-4, most=1000)
    assert np.all(found.sizes < 1e-4)
    assert len(set(found.iterations.tolist())) > 1
    np.testing.assert_allclose(found.points[:, 0], 1.0, atol=1e-2)


def test_a_first_simplex_turns_away_from_a_wall() -> None:
    starts = np.array([[0.95, 0.5]])
    points = around(starts, 0.1, lambda p: np.all(p < 1.0, axis=1))
    np.testing.assert_allclose(points[0], [[0.95, 0.5], [0.85, 0.5], [0.95, 0.6]])
