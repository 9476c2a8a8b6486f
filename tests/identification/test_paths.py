"""Paths of probes: thinned without loss, freed of noise, cut into steps."""

import numpy as np
import pytest

from meso_robust.identification.paths import in_steps, smoothed, thinned

UM = 1e-6


def bent(times: np.ndarray) -> np.ndarray:
    """At rest for 1 s, 75 um/s along x for 2 s, then along -y."""
    moving = np.clip(times - 1.0, 0.0, 2.0)
    down = np.clip(times - 3.0, 0.0, None)
    return np.stack([75 * UM * moving, -75 * UM * down], axis=1)


def test_only_the_corners_of_a_commanded_path_are_kept() -> None:
    times = np.arange(0.0, 4.01, 0.05)
    kept = thinned(times, bent(times), 1e-9)
    np.testing.assert_allclose(times[kept], [0.0, 1.0, 3.0, 4.0], atol=1e-9)
    again = np.stack(
        [np.interp(times, times[kept], bent(times)[kept, axis]) for axis in range(2)], axis=1
    )
    np.testing.assert_allclose(again, bent(times), atol=1e-9)


def test_a_seen_path_is_smoothed_to_its_legs() -> None:
    times = np.arange(0.0, 4.0, 1 / 30)
    rng = np.random.default_rng(0)
    sigma = 1.2 * UM
    knots, corners = smoothed(times, bent(times) + sigma * rng.standard_normal((120, 2)), sigma)
    assert len(knots) <= 8
    said = np.stack([np.interp(times, knots, corners[:, axis]) for axis in range(2)], axis=1)
    assert np.sqrt(np.mean((said - bent(times)) ** 2)) < 0.5 * sigma


def test_even_motion_needs_no_corner() -> None:
    times = np.arange(0.0, 8.0, 1 / 30)
    noise = 1.2 * UM * np.random.default_rng(1).standard_normal((240, 2))
    knots, _ = smoothed(times, 75 * UM * times[:, None] * [1.0, 0.5] + noise, 1.2 * UM)
    assert len(knots) == 2


def test_steps_are_short_enough_and_end_where_the_path_does() -> None:
    times = np.array([0.0, 1.0, 3.0])
    path = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 7.0]])[:, None] * UM
    clock, points = in_steps(times, path, np.array([3.0, 2.0]) * UM)
    lengths = np.hypot(*np.diff(points[:, 0], axis=0).T)
    assert len(lengths) == 4 + 4
    assert lengths[:4].max() <= 3 * UM + 1e-15
    assert lengths[4:].max() == pytest.approx(1.75 * UM)
    assert clock[4] == 1.0
    np.testing.assert_array_equal(points[-1], path[-1])
