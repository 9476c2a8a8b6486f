"""Noise from still frames: as drawn, without what is no noise, and None with a reason."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.recordings import Recording, RecordingSet, Rectangle, SensorInfo
from meso_robust.recordings.contact import gaps, margin, nearest_gap, scatter, size
from meso_robust.recordings.noise import estimated_noise, estimated_sensor
from meso_robust.recordings.still import still
from tests.nightly import by_day
from tests.recordings.planted import (
    BACK,
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


def test_a_margin_is_that_of_the_part_or_of_its_scatter() -> None:
    quiet = one("a.csv", noise=0.0)
    # 1/200 of the size, 5.66 um; the tip goes 2.5 um a frame
    assert margin(clean(recordings=(quiet,)), quiet) == pytest.approx(
        0.005 * np.sqrt(1600 * 800) * UM
    )
    shaky = one("a.csv", noise=10.0)
    assert margin(clean(recordings=(shaky,)), shaky) == pytest.approx(4.0 * 10.0 * SIGMA, rel=0.3)


@pytest.mark.parametrize("away", [0.0, -150 * UM, 150 * UM])
@pytest.mark.parametrize("seed", range(4))
def test_still_ends_where_the_part_begins_to_move_wherever_the_tip_seems_to_be(
    seed: int, away: float
) -> None:
    made = one("a.csv", seed)
    frames = np.flatnonzero(
        still(clean(), replace(made, probes=made.probes + np.array([away, 0.0])))
    )
    assert frames.tolist() == list(range(len(frames)))
    assert TOUCH - 6 <= len(frames) <= TOUCH + 1


def test_a_part_that_is_pushed_from_the_first_frame_on_is_never_still() -> None:
    made = one("a.csv")
    late = slice(TOUCH + 5, BACK)
    pushed = replace(made, times=made.times[late], poses=made.poses[late], probes=made.probes[late])
    assert not np.any(still(clean(), pushed))
    # while the tip stays behind it is a drift, and a line through it leaves noise only
    left = replace(pushed, probes=np.tile(pushed.probes[:1], (len(pushed.times), 1, 1)))
    assert np.all(still(clean(), left))


def test_one_bad_pose_ends_no_rest() -> None:
    made = one("a.csv", 2)
    poses = made.poses.copy()
    poses[30] += [50 * UM, 0.0, 0.1]
    poses[31] = np.nan
    frames = still(clean(), replace(made, poses=poses))
    assert TOUCH - 8 <= np.count_nonzero(frames) <= TOUCH
    assert not frames[31]


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


@pytest.mark.parametrize("drift", by_day(1, [0.2 * UM, 0.0]))
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
    assert "degrees of freedom in still frames before the part moves" in found.noise.x.reason
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


def test_a_camera_that_is_off_does_not_spoil_the_noise() -> None:
    """By 150 um: the part moves while the tip seems far away, or seems to be inside it at rest."""
    made = clean(sensor=UNKNOWN)
    plain = estimated_noise(made)
    for away in (-150 * UM, 150 * UM):
        off = tuple(
            replace(each, probes=each.probes + np.array([away, 0.0])) for each in made.recordings
        )
        assert estimated_noise(replace(made, recordings=off)) == plain
    assert plain.x.sigma == pytest.approx(SIGMA, rel=0.15)
    assert plain.x.correlation == pytest.approx(0.0, abs=0.2)


def test_a_part_that_wanders_tells_neither_size_nor_colour() -> None:
    rng = np.random.default_rng(0)
    made = drawn(1)
    walks = tuple(
        replace(
            each, poses=each.poses + np.cumsum(rng.normal(size=(120, 1)), axis=0) * [5 * UM, 0, 0]
        )
        for each in made.recordings
    )
    found = estimated_noise(replace(made, recordings=walks))
    assert found.x.sigma is None
    assert found.x.correlation is None
    assert found.x.reason is not None
    assert found.x.reason.startswith("frames that should be still follow each other (correlation ")
    assert found.y.sigma == pytest.approx(SIGMA, rel=0.15)


def test_tips_of_any_radius_and_parts_without_probes() -> None:
    made = clean(tip_radius=RADIUS, part=PART, sensor=UNKNOWN)
    bare = tuple(
        replace(one, probe_names=(), probes=np.zeros((FRAMES, 0, 2))) for one in made.recordings
    )
    # nothing is known to push, and the part is still until it moves
    assert estimated_noise(replace(made, recordings=bare)).y.freedom == pytest.approx(
        estimated_noise(made).y.freedom, abs=3
    )
