"""Noise of the controller's log is no motion of the tip: it must not look like friction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.identification.identify import identify
from meso_robust.identification.prepared import prepare
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.direct.straight import path_sigma
from meso_robust.recordings.noise import scatter
from tests.diagnosis.conftest import small_set
from tests.diagnosis.designs import RHO
from tests.identification.sets import UM

MU = 0.3
"""Of the set."""


@pytest.fixture(scope="module")
def clean() -> RecordingSet:
    return small_set(None, 12)


def shaking(recordings: RecordingSet, sigma: float, late: float = 0.0) -> RecordingSet:
    """The set with noise in the log of its tips (m), and in its stamps (s)."""
    rng = np.random.default_rng(1)

    def told(one: np.ndarray, times: np.ndarray) -> np.ndarray:
        speed = np.gradient(one, times, axis=0)
        return np.asarray(
            one
            + sigma * rng.normal(size=one.shape)
            + late * speed * rng.normal(size=(len(times), 1, 1))
        )

    return replace(
        recordings,
        recordings=tuple(
            replace(one, probes=told(one.probes, one.times)) for one in recordings.recordings
        ),
    )


@pytest.mark.parametrize("sigma", [0.1 * UM, 0.5 * UM])
def test_friction_is_as_it_was_without_noise(clean: RecordingSet, sigma: float) -> None:
    found = identify(shaking(clean, sigma), starts=4)
    (mu,) = [one for one in found.profiles if one.key == "mu"]
    assert mu.low <= MU <= mu.high
    assert mu.high - mu.low < 0.006


def test_tips_that_are_put_down_within_a_stated_error_do_not_look_like_friction(
    clean: RecordingSet,
) -> None:
    """Each push has its tip elsewhere than its log says; the log alone contradicts itself."""
    rng = np.random.default_rng(5)
    elsewhere = replace(
        clean,
        recordings=tuple(
            replace(one, probes=one.probes + 2.0 * UM * rng.normal(size=2))
            for one in clean.recordings
        ),
    )
    stated = replace(elsewhere, sensor=replace(clean.sensor, tip_offset=2.0 * UM))
    assert (prepare(elsewhere).tip_offset, prepare(stated).tip_offset) == (0.0, 2.0 * UM)

    undisturbed, plain, found = (identify(one, starts=2) for one in (clean, elsewhere, stated))

    assert plain.quality is not None
    assert found.quality is not None
    assert plain.quality.chi2 > 1.5 * plain.quality.freedom
    assert found.quality.chi2 < 1.1 * found.quality.freedom
    before, after, told = (
        next(profile for profile in one.profiles if profile.key == "mu")
        for one in (undisturbed, plain, found)
    )
    # the camera's noise is that of the set without the errors, and so is what it makes of friction
    assert abs(told.value - before.value) < 0.5 * abs(after.value - before.value)
    assert told.low <= before.value <= told.high


def test_tips_seen_off_by_a_stated_error_are_believed_no_more(clean: RecordingSet) -> None:
    """A needle's end that is taken for 10 µm farther out in all frames of a video, and less so in the next."""
    rng = np.random.default_rng(7)
    along = np.array([np.cos(1.1), np.sin(1.1)])
    seen = replace(
        clean,
        position_source="camera",
        recordings=tuple(
            replace(
                one,
                probes=one.probes
                + 10.0 * UM * rng.normal() * along
                + 0.05 * UM * rng.normal(size=one.probes.shape),
            )
            for one in clean.recordings
        ),
    )
    stated = replace(seen, sensor=replace(clean.sensor, tip_offset=10.0 * UM))
    assert prepare(stated).tip_offset == pytest.approx(10.0 * UM, rel=1e-2)

    plain, found = (identify(one, starts=2) for one in (seen, stated))

    assert plain.quality is not None
    assert found.quality is not None
    assert plain.quality.chi2 > 1.2 * plain.quality.freedom
    assert found.quality.chi2 < 1.1 * found.quality.freedom
    rho, sure = (
        next(profile for profile in one.profiles if profile.key == "rho_um2")
        for one in (found, plain)
    )
    assert rho.low <= RHO <= rho.high
    assert not sure.low <= RHO <= sure.high


def test_tips_seen_off_along_their_needles_are_believed_across_them(clean: RecordingSet) -> None:
    """Off by 10 µm along a needle that stands elsewhere in every film, by 0.5 µm across it."""
    rng = np.random.default_rng(7)
    angles = rng.uniform(0.0, np.pi, len(clean.recordings))
    ways = np.column_stack((np.cos(angles), np.sin(angles)))
    seen = replace(
        clean,
        position_source="camera",
        sensor=replace(clean.sensor, tip_offset=10.0 * UM),
        recordings=tuple(
            replace(
                one,
                probes=one.probes
                + 10.0 * UM * rng.normal() * way
                + 0.5 * UM * rng.normal() * np.array([-way[1], way[0]])
                + 0.05 * UM * rng.normal(size=one.probes.shape),
                tip_directions=(float(angle),),
            )
            for one, way, angle in zip(clean.recordings, ways, angles, strict=True)
        ),
    )
    told = replace(seen, sensor=replace(seen.sensor, tip_offset_across=0.5 * UM))
    lean = prepare(told).lean[:, 0]
    np.testing.assert_allclose(np.einsum("rij,rj->ri", lean, ways), ways, atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(lean), 0.05, rtol=0.02)

    alike, found = (identify(one, starts=2) for one in (seen, told))

    assert found.quality is not None
    assert found.quality.chi2 < 1.1 * found.quality.freedom
    wide, rho = (
        next(profile for profile in one.profiles if profile.key == "rho_um2")
        for one in (alike, found)
    )
    assert rho.low <= RHO <= rho.high
    assert rho.high - rho.low < 0.8 * (wide.high - wide.low)


def test_only_a_log_with_noise_is_smoothed(clean: RecordingSet) -> None:
    assert path_sigma(clean) < 1e-12
    exact, noisy = prepare(clean), prepare(shaking(clean, 0.3 * UM))
    assert path_sigma(shaking(clean, 0.3 * UM)) == pytest.approx(0.3 * UM, rel=0.15)
    assert noisy.waypoints.shape[1] < 1.2 * exact.waypoints.shape[1]  # no leg for every sample
    for times, path, at, way in zip(
        noisy.times, noisy.waypoints, exact.times, exact.waypoints, strict=True
    ):
        clock = np.linspace(at[0], at[-1], 50)
        for axis in range(2):
            away = np.interp(clock, times, path[:, 0, axis]) - np.interp(clock, at, way[:, 0, axis])
            assert np.sqrt(np.mean(away**2)) < 0.5 * UM


def test_a_stated_noise_counts_and_stamps_do_too(clean: RecordingSet) -> None:
    stated = replace(clean, sensor=replace(clean.sensor, tip_sigma=2e-6))
    assert path_sigma(stated) == 2e-6
    jitter = shaking(clean, 0.01 * UM, late=3e-3)
    # the tips go 75 or 225 µm/s
    assert 0.1 * UM < path_sigma(jitter) < 0.9 * UM


@pytest.mark.parametrize("turn", [-1.2, 0.1, 0.6, 1.5])
def test_a_scatter_is_told_along_the_needle_and_across_it(turn: float) -> None:
    rng, along = np.random.default_rng(3), np.array([np.cos(turn), np.sin(turn)])
    noise = rng.normal(size=(4000, 2)) * [0.4 * UM, 0.1 * UM]
    times = np.arange(4000)[:, None]
    path = noise @ np.array([along, [-along[1], along[0]]]) + 2.0 * UM * np.abs(times - 1700.3)

    longest, shortest = scatter(path)

    assert np.hypot(*longest) == pytest.approx(0.4 * UM, rel=0.05)
    assert np.hypot(*shortest) == pytest.approx(0.1 * UM, rel=0.05)
    assert abs(longest @ along) == pytest.approx(np.hypot(*longest), rel=1e-3)


def test_a_tip_seen_worse_along_its_needle_does_not_shake(clean: RecordingSet) -> None:
    """Its path is one of a few legs; taken alike in all directions, what is worst seen was motion."""
    rng, turn = np.random.default_rng(2), 1.3
    axes = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    seen = replace(
        clean,
        position_source="camera",
        recordings=tuple(
            replace(
                one,
                probes=one.probes
                + rng.normal(size=one.probes.shape) * [0.5 * UM, 0.05 * UM] @ axes,
            )
            for one in clean.recordings
        ),
    )
    exact, noisy = prepare(clean), prepare(seen)
    for times, path, at, way in zip(
        noisy.times, noisy.waypoints, exact.times, exact.waypoints, strict=True
    ):
        clock = np.linspace(at[0], at[-1], 200)
        away = np.array(
            [
                np.interp(clock, times, path[:, 0, k]) - np.interp(clock, at, way[:, 0, k])
                for k in range(2)
            ]
        )
        assert np.sqrt(np.mean((axes[0] @ away) ** 2)) < 0.2 * UM
        assert np.sqrt(np.mean((axes[1] @ away) ** 2)) < 0.1 * UM


def test_a_tip_that_does_not_scatter_across_its_way_is_prepared(clean: RecordingSet) -> None:
    """Its coordinates across are the same to the last bit: no direction may be lost for that."""
    still = replace(
        clean,
        position_source="camera",
        recordings=tuple(
            replace(
                one,
                probes=one.probes[:1] + np.array([[[1.0, 0.0]]]) * (one.probes - one.probes[:1]),
            )
            for one in clean.recordings
        ),
    )
    assert scatter(still.recordings[0].probes[:, 0], 1e-9)[1] @ [0.0, 1.0] != 0.0
    assert len(prepare(still).files) == len(clean.recordings)
