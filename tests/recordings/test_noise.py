"""Noise from still frames: as drawn, without what is no noise, and None with a reason."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.recordings import Recording, RecordingSet, Rectangle, SensorInfo
from meso_robust.recordings.contact import gaps, margin, nearest_gap, scatter, size, still
from meso_robust.recordings.noise import estimated_noise, estimated_sensor
from tests.recordings.planted import (
    FRAMES,
    PART,
    RADIUS,
    RATE,
    SIGMA,
    TOUCH,
    TURN_SIGMA,
    UM,
    clean,
    one,
)

UNKNOWN = SensorInfo(frame_rate=RATE)


def test_gaps_of_a_turned_rectangle_and_of_a_notch() -> None:
    rectangle = Rectangle(length=4.0, width=2.0).outline
    pose = np.array([[10.0, 5.0, np.pi / 2], [np.nan, 5.0, 0.0]])
    # the long side now lies along y: x from 9 to 11, y from 3 to 7
    tips = np.array([[[8.0, 5.0], [10.0, 5.5], [12.0, 8.0]]] * 2)
    found = gaps(rectangle, pose, tips, 0.25)
    np.testing.assert_allclose(found[0], [0.75, -1.25, np.sqrt(2.0) - 0.25], atol=1e-12)
    assert np.all(np.isnan(found[1]))
    notched = np.array([[0.0, 0], [4, 0], [4, 4], [3, 4], [3, 1], [1, 1], [1, 4], [0, 4]])
    tips = np.array([[[2.0, 2.0], [0.5, 3.0], [2.0, 0.25], [2.0, 5.0]]])
    found = gaps(notched, np.zeros((1, 3)), tips, 0.0)
    np.testing.assert_allclose(found, [[1.0, -0.5, -0.25, np.sqrt(2.0)]], atol=1e-12)
    assert size(notched) == pytest.approx(np.sqrt(10.0))


def test_a_hidden_tip_leaves_the_gap_open_unless_another_touches() -> None:
    poses = np.zeros((3, 3))
    probes = np.array([[[-900.0, 0], [0, 500]], [[-900, 0], [np.nan, 0]], [[-790, 0], [np.nan, 0]]])
    both = Recording(
        file="a.csv",
        probe_names=("a", "b"),
        times=np.arange(3.0),
        poses=poses,
        probes=probes * UM,
    )
    found = nearest_gap(clean(recordings=(both,)), both) / UM
    np.testing.assert_allclose(found, [100 - 12.5, np.nan, -10 - 12.5], atol=1e-9)
    none = replace(both, probe_names=(), probes=np.zeros((3, 0, 2)))
    assert np.all(np.isinf(nearest_gap(clean(recordings=(none,)), none)))


def test_still_ends_before_the_first_contact_for_good() -> None:
    quiet = one("a.csv", noise=0.0)
    made = clean(recordings=(quiet,))
    # 1/200 of the size, 5.66 um; the tip goes 2.5 um a frame
    assert margin(made, quiet) == pytest.approx(0.005 * np.sqrt(1600 * 800) * UM)
    assert np.flatnonzero(still(made, quiet)).tolist() == list(range(TOUCH - 2))
    shaky = one("a.csv", noise=10.0)
    assert margin(made, shaky) == pytest.approx(4.0 * 10.0 * SIGMA, rel=0.3)


def test_the_scatter_of_a_steady_motion_is_that_of_its_noise() -> None:
    rng = np.random.default_rng(1)
    values = np.arange(4000.0)[:, None] * [3.0, -2.0] + rng.normal(size=(4000, 2))
    values[::50] = np.nan
    assert scatter(values) == pytest.approx(1.0, rel=0.08)
    assert scatter(values[:1]) == 0.0


def drawn(seed: int, correlation: float = 0.0, drift: float = 0.0) -> RecordingSet:
    """Four parts that are never touched."""
    rng = np.random.default_rng(seed)
    noise = rng.normal(size=(4, 120, 3))
    for k in range(1, 120):
        old = correlation * noise[:, k - 1]
        noise[:, k] = old + np.sqrt(1.0 - correlation**2) * noise[:, k]
    poses = noise * [SIGMA, SIGMA, TURN_SIGMA] + drift * np.arange(120)[:, None]
    base = clean().recordings[0]
    recordings = tuple(
        replace(
            base,
            file=f"push_{k}.csv",
            times=np.arange(120) / RATE,
            poses=poses[k],
            probes=np.full((120, 1, 2), 5e-3),
        )
        for k in range(4)
    )
    return clean(sensor=UNKNOWN, recordings=recordings)


@pytest.mark.parametrize("drift", [0.0, 0.2 * UM])
@pytest.mark.parametrize("correlation", [0.0, 0.5])
def test_noise_is_found_as_drawn_whatever_the_drift(correlation: float, drift: float) -> None:
    """The estimate of 480 white frames is good to 3.3 %; 12 sets average that to 1 %."""
    found = [estimated_noise(drawn(seed, correlation, drift)) for seed in range(12)]
    for axis, sigma in (("x", SIGMA), ("y", SIGMA), ("theta", TURN_SIGMA)):
        spreads = [getattr(noise, axis) for noise in found]
        ratio = np.mean([spread.sigma for spread in spreads]) / sigma
        assert ratio == pytest.approx(1.0, abs=0.03 if correlation == 0.0 else 0.06)
        lag = np.mean([spread.correlation for spread in spreads])
        assert lag == pytest.approx(correlation, abs=0.05)
        assert all(470 <= spread.freedom <= 472 for spread in spreads)


def test_outliers_and_repeats_do_not_count() -> None:
    made = drawn(5)
    plain = estimated_noise(made)
    first = made.recordings[0]
    poses = first.poses.copy()
    poses[[7, 60]] += 100 * SIGMA
    wild = estimated_noise(replace(made, recordings=(replace(first, poses=poses),)))
    alone = estimated_noise(replace(made, recordings=(first,)))
    assert wild.x.sigma == pytest.approx(alone.x.sigma, rel=0.03)
    twice = tuple(
        replace(
            one,
            times=np.arange(240) / RATE,
            poses=np.repeat(one.poses, 2, axis=0),
            probes=np.repeat(one.probes, 2, axis=0),
        )
        for one in made.recordings
    )
    doubled = estimated_noise(replace(made, recordings=twice))
    assert doubled.x.freedom == plain.x.freedom
    assert doubled.x.sigma == pytest.approx(plain.x.sigma, rel=1e-6)


def test_what_is_stated_stays_and_what_is_absent_is_estimated() -> None:
    half = SensorInfo(frame_rate=RATE, position_sigma=7 * UM)
    found = estimated_sensor(clean(sensor=half))
    assert found.info.position_sigma == 7 * UM
    assert (found.position_source, found.orientation_source) == ("stated", "estimated")
    assert found.info.orientation_sigma == pytest.approx(TURN_SIGMA, rel=0.15)
    noise = estimated_sensor(clean(sensor=UNKNOWN))
    assert noise.info.position_sigma == pytest.approx(SIGMA, rel=0.15)
    assert noise.info.frame_rate == RATE


def test_too_few_still_frames_are_said_to_be_too_few() -> None:
    whole = clean().recordings[0]
    late = replace(
        whole, times=whole.times[70:], poses=whole.poses[70:], probes=whole.probes[70:]
    )  # 9 frames before the touch
    found = estimated_sensor(clean(sensor=UNKNOWN, recordings=(late,)))
    assert found.info.position_sigma is None
    assert found.position_source == "unknown"
    assert found.noise.x.reason is not None
    assert found.noise.x.reason.startswith("5 degrees of freedom in still frames before the first")
    # two such recordings are enough
    both = (late, replace(late, file="other.csv"))  # 10 degrees of freedom
    assert estimated_sensor(clean(sensor=UNKNOWN, recordings=both)).position_source == "estimated"


def test_still_frames_that_do_not_differ_tell_nothing() -> None:
    poses = np.zeros((FRAMES, 3))
    poses[1::2, 0] = 1e-30  # so that frames are not bit by bit the same
    one = replace(clean().recordings[0], poses=poses, probes=np.full((FRAMES, 1, 2), 5e-3))
    found = estimated_noise(clean(sensor=UNKNOWN, recordings=(one,)))
    assert found.theta.sigma is None
    assert found.theta.reason is not None
    assert "half of the still frames or more show one value" in found.theta.reason


def test_a_part_that_moves_where_it_should_be_still_tells_nothing() -> None:
    """A camera that is off by 150 um: the part moves while the tip seems far away."""
    made = clean(sensor=UNKNOWN)
    off = tuple(
        replace(each, probes=each.probes - np.array([150 * UM, 0.0])) for each in made.recordings
    )
    found = estimated_noise(replace(made, recordings=off))
    assert found.x.sigma is None
    assert found.x.reason is not None
    assert found.x.reason.startswith("frames that should be still follow each other (correlation ")
    assert found.y.sigma == pytest.approx(SIGMA, rel=0.15)


def test_tips_of_any_radius_and_parts_without_probes() -> None:
    made = clean(tip_radius=RADIUS, part=PART, sensor=UNKNOWN)
    bare = tuple(
        replace(one, probe_names=(), probes=np.zeros((FRAMES, 0, 2))) for one in made.recordings
    )
    # nothing can touch: every frame counts, motion and all
    assert estimated_noise(replace(made, recordings=bare)).y.freedom > 700
