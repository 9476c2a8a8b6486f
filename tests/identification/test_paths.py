"""Paths of probes: thinned without loss, freed of noise, cut into steps."""

import numpy as np
import pytest

from meso_robust.identification.paths import in_steps, smoothed, thinned, with_corners

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


def test_a_smoothed_path_is_kept_and_cannot_be_changed() -> None:
    times = np.arange(0.0, 3.0, 1 / 30)
    path = np.random.default_rng(6).normal(0.0, 1e-6, (len(times), 2))
    first, second = smoothed(times, path, 1e-6), smoothed(times.copy(), path.copy(), 1e-6)
    assert all(one is other for one, other in zip(first, second, strict=True))
    with pytest.raises(ValueError, match="read-only"):
        first[1][0] = 0.0
    far = smoothed(times, path + 1e-3, 1e-6)[1]
    np.testing.assert_allclose(far, first[1] + 1e-3, atol=1e-12)


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


def turning(times: np.ndarray, at: float, before: list[float], after: list[float]) -> np.ndarray:
    """Even motion up to an instant, and other even motion from there; µm/s to m."""
    since = (times - at)[:, None]
    return UM * (np.minimum(since, 0.0) * before + np.maximum(since, 0.0) * after)


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ([0.0, 0.0], [75.0, 0.0]),  # from rest
        ([75.0, 20.0], [0.0, 0.0]),  # to rest
        ([75.0, 20.0], [-75.0, -20.0]),  # back
        ([75.0, 0.0], [0.0, -30.0]),
    ],
)
def test_a_turning_point_between_two_samples_is_recovered(
    before: list[float], after: list[float]
) -> None:
    times = np.arange(12) / 30.0 + 0.7
    at = 0.7 + 5.37 / 30.0
    path = turning(times, at, before, after)
    clock, places = with_corners(times, path, 5e-9)
    assert len(clock) == len(times) + 1
    assert clock[6] == pytest.approx(at, abs=1e-12)
    np.testing.assert_allclose(places[6], 0.0, atol=1e-14)
    np.testing.assert_array_equal(np.delete(clock, 6), times)
    np.testing.assert_array_equal(np.delete(places, 6, axis=0), path)


def test_every_turning_point_is_recovered() -> None:
    times = np.arange(0.0, 3.0, 1 / 30)
    instants = np.array([0.0, 0.41, 1.22, 1.77, 3.0])
    corners = UM * np.array([[0.0, 5.0], [0.0, 5.0], [60.0, 5.0], [20.0, 5.0], [20.0, 5.0]])

    def path(at: np.ndarray) -> np.ndarray:
        return np.stack([np.interp(at, instants, corners[:, axis]) for axis in range(2)], axis=1)

    clock, places = with_corners(times, path(times), 5e-9)
    assert len(clock) == len(times) + 3
    for instant, corner in zip(instants[1:-1], corners[1:-1], strict=True):
        row = int(np.argmin(np.abs(clock - instant)))
        assert clock[row] == pytest.approx(instant, abs=1e-12)
        np.testing.assert_allclose(places[row], corner, atol=1e-14)
    np.testing.assert_allclose(places, path(clock), atol=1e-14)


def test_no_corner_is_put_where_there_is_none() -> None:
    times = np.arange(0.0, 2.0, 1 / 30)
    even = UM * times[:, None] * [75.0, -10.0]
    on_a_sample = turning(times, times[20], [75.0, 0.0], [0.0, 75.0])
    # both coordinates turn between the same samples, but not at one instant
    apart = np.stack(
        [
            turning(times, times[20] + 0.008, [75.0, 0.0], [0.0, 0.0])[:, 0],
            turning(times, times[20] + 0.025, [0.0, 75.0], [0.0, 0.0])[:, 1],
        ],
        axis=1,
    )
    for path in (even, on_a_sample, apart, even[:3]):
        clock, places = with_corners(times[: len(path)], path, 5e-9)
        np.testing.assert_array_equal(clock, times[: len(path)])
        np.testing.assert_array_equal(places, path)


def test_smooth_motion_has_no_corner() -> None:
    times = np.arange(0.0, 2.0, 1 / 30)
    faster = UM * np.stack([40.0 * times**2, 0.0 * times], axis=1)
    circle = UM * 300.0 * np.stack([np.cos(times), np.sin(times)], axis=1)
    for path in (faster, circle):
        np.testing.assert_array_equal(with_corners(times, path, 5e-9)[0], times)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.5, 0.8])
def test_a_turning_point_between_two_noisy_samples_is_recovered(share: float) -> None:
    """A tip at rest that goes out, back a little and rests: its farthest point is in no sample."""
    frame, rng = 0.05, np.random.default_rng(7)
    instants = np.array([0.0, 0.62, 2.0 + share * frame, 2.42, 2.9])
    corners = np.array([[0.0, 0.0], [0.0, 0.0], [150.0, 40.0], [110.0, 30.0], [110.0, 30.0]])
    times = np.arange(0.0, 2.9, frame)
    path = np.column_stack([np.interp(times, instants, of) for of in corners.T])
    noisy = path + 0.08 * rng.standard_normal(path.shape)

    knots, found = smoothed(times, noisy * UM, 0.08 * UM)

    assert len(knots) <= 6
    nearest = np.abs(knots[:, None] - instants[1:-1]).argmin(axis=0)
    assert knots[nearest] == pytest.approx(instants[1:-1], abs=0.05 * frame)
    assert found[nearest] / UM == pytest.approx(corners[1:-1], abs=0.3)


@pytest.mark.parametrize("rest", [0.3, 0.35, 0.4, 0.5])  # of one sample at rest alone it is open
@pytest.mark.parametrize("phase", [0.02, 0.07, 0.13])
def test_a_probe_that_comes_back_soon_is_followed_under_a_slow_camera(
    rest: float, phase: float
) -> None:
    """Its rest and its way back are a sample or two each: no path may go where the probe was not."""
    way, back, speed, sigma = 348.0, 28.0, 120.0, 0.05
    clock = np.cumsum([0.0, 1.5 + phase, way / speed, rest, back / speed, 1.5])
    times = np.arange(0.0, clock[-1], 0.2)
    fine = np.linspace(0.0, times[-1], 5000)
    along = np.array([0.0, 0.0, way, way, way - back, way - back])
    noise = sigma * np.random.default_rng(3).standard_normal(len(times))
    seen = np.interp(times, clock, along) + noise
    knots, corners = smoothed(times, np.stack([seen, 0.3 * seen], axis=1) * UM, sigma * UM)
    path = corners[:, 0] / UM
    assert np.abs(np.interp(times, knots, path) - seen).max() < 6.0 * sigma
    # between two samples it may turn a little later than they tell, but goes no farther than the tip
    assert np.interp(fine, knots, path).max() < way + 6.0 * sigma
