"""A part at rest that sways is no noise; noise of any colour is no sway; a drift leaves frames at rest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.recordings import RecordingSet, SensorInfo
from meso_robust.recordings.direct.run import direct_tests
from meso_robust.recordings.noise import estimated_noise
from meso_robust.recordings.still import still
from meso_robust.recordings.sway import sway_of
from tests.nightly import by_day
from tests.recordings.planted import RATE, SIGMA, TURN_SIGMA, UM, Floats, clean, one

UNKNOWN = SensorInfo(frame_rate=RATE)


def at_rest(seed: int, colour: float = 0.0, seconds: float = 1.5, count: int = 6) -> RecordingSet:
    """Parts that are never touched, seen with noise of a colour."""
    rng = np.random.default_rng(seed)
    frames = int(seconds * RATE)
    shocks = rng.normal(size=(count, frames, 3))
    for k in range(1, frames):
        shocks[:, k] = colour * shocks[:, k - 1] + np.sqrt(1.0 - colour**2) * shocks[:, k]
    base = clean().recordings[0]
    return clean(
        sensor=UNKNOWN,
        recordings=tuple(
            replace(
                base,
                file=f"push_{k}.csv",
                times=np.arange(frames) / RATE,
                poses=shocks[k] * [SIGMA, SIGMA, TURN_SIGMA],
                probes=np.full((frames, 1, 2), 5e-3),
            )
            for k in range(count)
        ),
    )


def shaken(made: RecordingSet, size: float, rate: float, way: Floats) -> RecordingSet:
    """The image shakes, in every recording with a phase of its own."""
    phases = np.random.default_rng(7).uniform(0.0, 2.0 * np.pi, len(made.recordings))
    moved = []
    for each, phase in zip(made.recordings, phases, strict=True):
        poses = each.poses.copy()
        poses[:, :2] += size * np.sin(2.0 * np.pi * rate * each.times + phase)[:, None] * way
        moved.append(replace(each, poses=poses))
    return replace(made, recordings=tuple(moved))


@pytest.mark.parametrize("colour", by_day(1, [0.0, 0.5, 0.85]))
def test_noise_of_any_colour_is_no_sway(colour: float) -> None:
    """One in two hundred sets may be one by chance; of thirty at most two."""
    found = [estimated_noise(at_rest(seed, colour)).sway for seed in range(30)]
    assert sum(one is not None for one in found) <= 2


@pytest.mark.parametrize(("size", "rate"), [(20.0, 2.3), (20.0, 1.1), (2.5, 3.0)])
def test_a_sway_is_sized_and_is_not_in_the_noise(size: float, rate: float) -> None:
    way = np.array([0.8, 0.6])
    found = estimated_noise(shaken(at_rest(3), size * UM, rate, way))
    assert found.sway is not None
    assert found.sway.rate == pytest.approx(rate, abs=0.15)
    # a sine has a root mean square of size/√2, and the mean of two coordinates is 1/√2 of that
    assert found.sway.metres == pytest.approx(0.5 * size * UM, rel=0.15)
    assert found.sway.size[0] / found.sway.size[1] == pytest.approx(0.8 / 0.6, rel=0.3)
    for axis, sigma in ((found.x, SIGMA), (found.y, SIGMA), (found.theta, TURN_SIGMA)):
        assert axis.sigma == pytest.approx(sigma, rel=0.25)
        assert axis.correlation == pytest.approx(0.0, abs=0.35)


@pytest.mark.parametrize("frames", [1, 2])
def test_a_part_that_moves_in_one_rest_is_no_sway(frames: int) -> None:
    """Under a slow camera the last frames at rest may be ones in which it was pushed."""
    for seed in range(4):
        rng, times = np.random.default_rng(seed), np.arange(10) / 5.0
        rests = [(times, rng.normal(size=(10, 3)) * [SIGMA, SIGMA, TURN_SIGMA]) for _ in range(12)]
        pushed = np.maximum(np.arange(10) - (9 - frames), 0) / frames
        rests[4][1][:, :2] += 16.0 * SIGMA * pushed[:, None]
        assert sway_of(rests, 5.0) is None


def test_a_sway_is_told_by_the_direct_tests() -> None:
    made = clean()
    assert not [each for each in direct_tests(made).findings if each.test == "rest"]
    (told,) = (
        each
        for each in direct_tests(shaken(made, 8.0 * UM, 2.0, np.array([1.0, 0.0]))).findings
        if each.test == "rest"
    )
    sizes = {each.key: each for each in told.estimates}
    assert sizes["size_um"].low < 4.0 < sizes["size_um"].high
    assert sizes["rate_hz"].value == pytest.approx(2.0, abs=0.2)
    assert told.after == pytest.approx(SIGMA, rel=0.2)
    assert told.before == pytest.approx(np.hypot(SIGMA, 4.0 * UM), rel=0.2)


def test_a_part_that_drifts_as_fast_as_a_tip_is_still_until_a_tip_sets_out() -> None:
    made = one("a.csv")
    drift = 25.0 * UM * made.times[:, None] * [1.0, 0.5, 0.0]
    poses = made.poses + drift
    kept = np.flatnonzero(still(clean(), replace(made, poses=poses)))
    # the tip rests for forty frames and sets out for the part
    assert kept.tolist() == list(range(len(kept)))
    assert 30 <= len(kept) <= 42
