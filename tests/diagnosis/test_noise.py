"""Noise of recordings whose noise is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.diagnosis.noise import Noise, _beyond, noise_of, weighed, with_noise
from meso_robust.errors import InputError
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.sway import Sway
from tests.diagnosis.designs import SIGMA, Plan, recorded_plans
from tests.identification.sets import PART, UM

Floats = npt.NDArray[np.float64]
NORTH = Plan(pose=(0.0, 0.0, 0.4), place=(0.0, 0.5 * PART.width), normal=(0.0, 1.0), wait=4.0)
THETA = np.array([False, False, True])


def unstated(recordings: RecordingSet) -> RecordingSet:
    sensor = replace(recordings.sensor, position_sigma=None, orientation_sigma=None)
    return replace(recordings, sensor=sensor)


def waiting(colour: float, *, noise: float = 1.0, plan: Plan = NORTH) -> RecordingSet:
    """Four pushes with rest before each."""
    rng = np.random.default_rng(1)
    return recorded_plans([plan] * 4, rng, noise=noise, colour=colour)


def in_contact(recordings: RecordingSet) -> RecordingSet:
    """Without the frames before the tip has come."""
    first = int(np.ceil(30.0 * (NORTH.wait + NORTH.gap / NORTH.speed))) + 2
    kept = tuple(
        replace(
            one,
            times=one.times[first:] - one.times[first],
            poses=one.poses[first:],
            probes=one.probes[first:],
        )
        for one in recordings.recordings
    )
    return replace(recordings, recordings=kept)


def test_a_sway_below_the_stated_noise_is_the_trackers() -> None:
    size = np.array([0.1 * UM, 0.1 * UM, 0.0])
    sway = Sway(rate=0.2, rate_error=0.1, size=size, error=0.1 * size, p_value=0.005)
    assert _beyond(sway, 0.2 * UM) is None
    assert _beyond(sway, 0.05 * UM) is sway
    assert _beyond(sway, None) is sway


def test_noise_that_is_stated_is_believed() -> None:
    found = noise_of(waiting(0.0, noise=3.0))  # the set states a third of it
    np.testing.assert_allclose(found.sigma, SIGMA, rtol=1e-12)
    assert found.source == "stated"
    assert found.known
    assert found.freedom == np.inf
    assert found.floor == 1.0


@pytest.mark.parametrize(
    ("stated", "least", "most"), [(1.0, 0.0, 0.05), (1.5, 0.2, 0.5), (20.0, 0.9, 0.9)]
)
def test_what_is_stated_beyond_the_scatter_stays_from_frame_to_frame(
    stated: float, least: float, most: float
) -> None:
    """Of variances a² + b², b² of what stays, neighbours have the correlation b² / (a² + b²)."""
    quiet = waiting(0.0)
    sensor = replace(
        quiet.sensor,
        position_sigma=stated * float(SIGMA[0]),
        orientation_sigma=stated * float(SIGMA[2]),
    )
    plain, found = noise_of(quiet), noise_of(replace(quiet, sensor=sensor))
    assert abs(plain.correlation) < 4.0 * plain.correlation_error
    assert least <= found.correlation <= most + 4.0 * plain.correlation_error
    there = float(np.sqrt(stated**2 - 1.0)) * SIGMA
    assert np.all(found.stays <= 1.01 * there)  # what surely stays is at most what is there
    assert np.all(found.stays >= 0.8 * there)


@pytest.mark.parametrize("colour", [0.0, 0.5])
def test_noise_of_a_known_colour_is_found_in_still_frames(colour: float) -> None:
    found = noise_of(unstated(waiting(colour)))
    assert found.source == "still frames"
    assert found.known
    np.testing.assert_allclose(found.sigma, SIGMA, rtol=0.12)
    # three coordinates, four recordings, a line each, and more than 110 still frames
    free = 3 * 4 * 110
    assert found.correlation_error == pytest.approx(1.0 / np.sqrt(free), rel=0.1)
    assert found.correlation == pytest.approx(colour, abs=4.0 * found.correlation_error)
    assert found.freedom == pytest.approx(free / 3, rel=0.2)


def test_of_smooth_motion_without_rest_only_the_floor_is_known() -> None:
    recordings = unstated(in_contact(waiting(0.0)))
    found = noise_of(recordings)
    assert found.source == "roughness of the poses"
    assert not found.known
    np.testing.assert_allclose(found.sigma, SIGMA, rtol=0.15)
    assert found.correlation == 0.0
    assert with_noise(recordings, found) is recordings


def test_roughness_is_freed_of_the_colour_of_the_noise() -> None:
    recordings = waiting(0.6, plan=replace(NORTH, wait=2.0, speed=10 * UM))
    # θ is held while the part rests, so that its noise shows by its roughness in motion only
    resting = [(one.times < 2.8)[:, None] for one in recordings.recordings]
    still = tuple(
        replace(one, poses=np.where(rests & THETA, one.poses[0], one.poses))
        for one, rests in zip(recordings.recordings, resting, strict=True)
    )
    found = noise_of(unstated(replace(recordings, recordings=still)))
    assert found.source == "still frames, θ roughness of the poses"
    assert found.correlation == pytest.approx(0.6, abs=0.15)
    rough = [np.diff(one.poses[90:, 2], n=3) for one in still]
    # an autoregression has var(Δ³) = σ² c' Φ c with c = (1, −3, 3, −1)
    weights = np.array([1.0, -3.0, 3.0, -1.0])
    lags = np.abs(np.subtract.outer(np.arange(4), np.arange(4)))
    share = weights @ found.correlation**lags @ weights
    expected = np.std(np.concatenate(rough)) / np.sqrt(share)
    assert 0.85 < found.sigma[2] / expected < 1.05  # its median has the held frames in it
    np.testing.assert_allclose(found.sigma, SIGMA, rtol=0.25)


def test_stated_noise_is_handed_on() -> None:
    recordings = unstated(waiting(0.0))
    found = noise_of(recordings)
    sensor = with_noise(recordings, found).sensor
    assert sensor.position_sigma == found.sigma[0] == found.sigma[1]
    assert sensor.orientation_sigma == found.sigma[2]
    assert sensor.frame_rate == recordings.sensor.frame_rate


def test_a_fit_weighs_what_is_not_known() -> None:
    rough = Noise(
        sigma=SIGMA, correlation=0.0, freedom=np.inf, correlation_error=0.1, source="", known=False
    )
    by_fit = weighed(rough, 2.0 * SIGMA)
    np.testing.assert_allclose(by_fit.sigma, 2.0 * SIGMA)
    assert by_fit.floor == pytest.approx(0.5)
    assert by_fit.source == "residuals of the fit"
    uneven = weighed(rough, SIGMA * [1.0, 2.0, 4.0])
    assert uneven.floor == pytest.approx(np.sqrt((1.0 + 0.25 + 0.0625) / 3.0))
    known = replace(rough, known=True)
    assert weighed(known, 1.0 * SIGMA) is known
    # a misfit of a hundred times the noise is weighed by more than it; the noise is then the floor
    assert weighed(known, 2.0 * SIGMA).floor == pytest.approx(0.5)


def test_poses_without_any_noise_are_refused() -> None:
    recordings = waiting(0.0)
    frozen = tuple(
        replace(one, poses=np.tile(one.poses[0], (len(one.poses), 1)))
        for one in recordings.recordings
    )
    with pytest.raises(InputError, match="position_sigma_um") as caught:
        noise_of(unstated(replace(recordings, recordings=frozen)))
    assert "must be" in str(caught.value)
    assert "state" in str(caught.value)
