"""Outlines, recordings in memory, unwrapping and sets made of simulated motion."""

from __future__ import annotations

import math
from dataclasses import FrozenInstanceError
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.recordings import (
    Polygon,
    Recording,
    RecordingSet,
    Rectangle,
    SensorInfo,
    from_simulation,
    unwrapped,
)
from meso_robust.recordings.rules import clock_fault

Floats = npt.NDArray[np.float64]

PART = Rectangle(length=1.6e-3, width=0.8e-3)
SENSOR = SensorInfo(frame_rate=30.0)
SET: dict[str, Any] = {
    "part": PART,
    "tip_radius": 12.5e-6,
    "position_source": "camera",
    "sensor": SENSOR,
}


def recording(**changes: Any) -> Recording:
    """Three instants, one probe."""
    given: dict[str, Any] = {
        "file": "a.csv",
        "probe_names": ("probe1",),
        "times": np.array([0.0, 1.0, 2.0]),
        "poses": np.zeros((3, 3)),
        "probes": np.zeros((3, 1, 2)),
    }
    return Recording(**{**given, **changes})


def test_the_outline_of_a_rectangle_runs_counter_clockwise_about_its_centre() -> None:
    expected = [[-0.8e-3, -0.4e-3], [0.8e-3, -0.4e-3], [0.8e-3, 0.4e-3], [-0.8e-3, 0.4e-3]]
    np.testing.assert_allclose(PART.outline, expected, rtol=1e-15)


GOOD = {
    "triangle": [[0, 0], [1, 0], [0, 1]],
    "L": [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]],
    "comb with teeth in line": [[0, 0], [5, 0], [5, 2], [4, 2], [4, 1], [1, 1], [1, 2], [0, 2]],
    "corner within a side": [[0, 0], [1, 0], [2, 0], [2, 2], [0, 2]],
}
BAD = {
    "bow": ([[0, 0], [2, 2], [2, 0], [0, 2]], "the sides after corners 0 and 2 touch or cross"),
    "clockwise": ([[0, 0], [0, 1], [1, 1], [1, 0]], "the corners run clockwise; must run counter"),
    "no area": ([[0, 0], [1, 0], [2, 0]], "the sides after corners 0 and 2 touch or cross"),
    "twice": ([[0, 0], [1, 0], [1, 0], [0, 1]], "corners 1 and 2 coincide; must differ"),
    "closed": ([[0, 0], [1, 0], [0, 1], [0, 0]], "corners 3 and 0 coincide; must differ"),
    "spike": ([[0, 0], [3, 0], [2, 0], [2, 2], [0, 2]], "the sides after corners 0 and 1 touch"),
    "pinch": (
        [[0, 0], [2, 0], [2, 2], [1, 0], [0, 2]],
        "the sides after corners 0 and 2 touch or cross",
    ),
    "line": ([[0, 0], [1, 0]], "2 corners; must be at least 3; give the whole outline"),
}


@pytest.mark.parametrize("corners", GOOD.values(), ids=GOOD.keys())
def test_simple_polygons_are_outlines_wherever_they_start(corners: list[list[float]]) -> None:
    for turn in range(len(corners)):
        rolled = np.roll(np.array(corners) * 1e-3, turn, axis=0)
        assert np.array_equal(Polygon(corners=rolled).outline, rolled)


@pytest.mark.parametrize(("corners", "message"), BAD.values(), ids=BAD.keys())
def test_other_polygons_are_refused(corners: list[list[float]], message: str) -> None:
    with pytest.raises(ValueError, match=f"^corners: {message}"):
        Polygon(corners=np.array(corners, dtype=np.float64))


@pytest.mark.parametrize("corners", [np.zeros(3), np.zeros((4, 3)), np.full((3, 2), np.nan)])
def test_corners_of_the_wrong_form_are_refused(corners: Floats) -> None:
    with pytest.raises(ValueError, match=r"^corners: shape .*; must be \(V, 2\) and finite"):
        Polygon(corners=corners)


@pytest.mark.parametrize(
    ("length", "width"), [(1.0, 2.0), (1.0, 0.0), (1.0, math.nan), (math.inf, 1.0), (-1.0, -2.0)]
)
def test_a_rectangle_that_cannot_be_is_refused(length: float, width: float) -> None:
    with pytest.raises(ValueError, match=r"^rectangle: .*; must be positive, finite, the long"):
        Rectangle(length=length, width=width)


def test_recordings_are_frozen_copies() -> None:
    times = np.array([0.0, 1.0, 2.0])
    one = recording(times=times)
    times[0] = -5.0
    assert one.times[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        one.poses[0, 0] = 1.0
    with pytest.raises(FrozenInstanceError):
        one.file = "b.csv"  # type: ignore[misc]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"file": "a/b.csv"}, r"file: 'a/b.csv'; must be the plain name"),
        ({"probe_names": ("1a",)}, r"probe_names: '1a'; must be a letter, then letters"),
        ({"probe_names": ("a" * 65,)}, r"probe_names: 'a{65}'; must be a letter"),
        ({"probe_names": ("a", "a")}, r"probe_names: 'a' appears twice"),
        ({"probe_names": ()}, r"probes: shape \(3, 1, 2\); must be \(3, 0, 2\)"),
        ({"poses": np.zeros((2, 3))}, r"poses: shape \(2, 3\); must be \(3, 3\)"),
        ({"times": np.zeros((3, 1))}, r"times: shape \(3, 1\); must be \(3,\)"),
        ({"forces": np.zeros((3, 2))}, r"forces: shape \(3, 2\); must be \(3, 1, 2\)"),
        ({"times": np.array([0.0, 2.0, 1.0])}, r"times\[2\]: 1.0 s; must be after the instant"),
        ({"times": np.array([0.0, np.nan, 1.0])}, r"times\[1\]: nan; must be a finite number"),
        ({"times": np.array([0.0, 1.0, np.inf])}, r"times\[2\]: inf; must be a finite number"),
        ({"poses": np.full((3, 3), np.inf)}, r"poses: infinite; must be finite or NaN"),
        ({"forces": np.full((3, 1, 2), -np.inf)}, r"forces: infinite; must be finite or NaN"),
        (
            {"times": np.zeros(0), "poses": np.zeros((0, 3)), "probes": np.zeros((0, 1, 2))},
            r"times: no instants in a.csv; must be at least one",
        ),
        (
            {
                "probe_names": (),
                "probes": np.zeros((3, 0, 2)),
                "forces": np.zeros((3, 0, 2)),
            },
            r"forces: no probes; belong to probes; give None",
        ),
    ],
)
def test_a_recording_that_cannot_be_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}"):
        recording(**changes)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"tip_radius": -1.0}, r"tip_radius: -1.0 m; must be finite and not negative"),
        ({"tip_radius": math.nan}, r"tip_radius: nan m; must be finite and not negative"),
        ({"position_source": "eye"}, r"position_source: 'eye'; must be one of controller, camera"),
        ({"recordings": ()}, r"recordings: none; must be at least one"),
        ({"recordings": (recording(), recording())}, r"recordings: file 'a.csv' appears twice"),
    ],
)
def test_a_set_that_cannot_be_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}"):
        RecordingSet(**{**SET, "recordings": (recording(),), **changes})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"frame_rate": 0.0}, "frame_rate: 0.0 Hz; must be positive"),
        ({"frame_rate": math.inf}, "frame_rate: inf Hz; must be positive and finite"),
        ({"position_sigma": -1.0}, "position_sigma: -1.0; must be finite and not negative"),
        ({"orientation_sigma": math.nan}, "orientation_sigma: nan; must be finite and not"),
    ],
)
def test_a_sensor_that_cannot_be_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}"):
        SensorInfo(**{"frame_rate": 30.0, **changes})


def test_unwrapping_makes_whole_turns_and_passes_over_what_was_not_seen() -> None:
    # turning by 100 deg a row from 0, wrapped into (-180, 180], row 3 not seen
    wrapped = np.radians([0.0, 100.0, -160.0, np.nan, 40.0, 140.0, -120.0])
    times = np.arange(7.0)
    poses = np.zeros((7, 3))
    poses[:, 2] = wrapped
    poses[:, 0] = times
    one = recording(times=times, poses=poses, probes=np.zeros((7, 1, 2)))
    found = unwrapped(one)
    # over the gap the nearer way is taken: from 200 to 40 deg, not on to 400
    expected = [0.0, 100.0, 200.0, np.nan, 40.0, 140.0, 240.0]
    np.testing.assert_allclose(np.degrees(found.poses[:, 2]), expected, atol=1e-12)
    assert np.array_equal(found.poses[:, 0], times)
    assert np.array_equal(one.poses[:, 2], wrapped, equal_nan=True)


def test_unwrapping_changes_nothing_where_nothing_is_seen_or_wraps() -> None:
    poses = np.full((3, 3), np.nan)
    assert np.all(np.isnan(unwrapped(recording(poses=poses)).poses))
    poses[:, 2] = [0.1, 0.3, -0.2]
    assert np.array_equal(unwrapped(recording(poses=poses)).poses, poses, equal_nan=True)


def test_simulated_runs_become_recordings_without_their_lost_frames() -> None:
    times = np.array([0.0, 0.1, 0.2])
    poses = np.arange(18.0).reshape(2, 3, 3)
    probes = np.arange(24.0).reshape(2, 3, 2, 2)
    poses[0, 1] = np.nan
    probes[0, 1] = np.nan  # lost
    poses[1, 2] = np.nan  # the part not seen, the probes were
    found = from_simulation(times, poses, probes, **SET)
    first, second = found.recordings
    assert (first.file, second.file) == ("push_00.csv", "push_01.csv")
    assert first.probe_names == ("probe1", "probe2")
    assert first.times.tolist() == [0.0, 0.2]
    assert np.array_equal(first.poses, poses[0, [0, 2]])
    assert np.array_equal(first.probes, probes[0, [0, 2]])
    assert np.array_equal(second.poses, poses[1], equal_nan=True)
    assert np.array_equal(second.times, times)
    assert (found.part, found.tip_radius, found.sensor) == (PART, 12.5e-6, SENSOR)


def test_many_simulated_runs_have_names_in_order_and_probes_the_names_given() -> None:
    poses, probes = np.zeros((101, 1, 3)), np.zeros((101, 1, 1, 2))
    found = from_simulation(np.zeros(1), poses, probes, probe_names=["tip"], **SET)
    files = [one.file for one in found.recordings]
    assert files == sorted(files)
    assert (files[0], files[100]) == ("push_000.csv", "push_100.csv")
    assert found.recordings[7].probe_names == ("tip",)


@pytest.mark.parametrize(
    ("poses", "probes", "message"),
    [
        (np.zeros((3, 3)), np.zeros((1, 3, 1, 2)), r"poses, probes: shapes \(3, 3\) and"),
        (np.zeros((2, 3, 3)), np.zeros((1, 3, 1, 2)), r"poses, probes: shapes \(2, 3, 3\) and"),
        (np.zeros((1, 4, 3)), np.zeros((1, 3, 1, 2)), r"poses: shape \(4, 3\); must be \(3, 3\)"),
        (np.zeros((0, 3, 3)), np.zeros((0, 3, 1, 2)), r"recordings: none; must be at least one"),
        (
            np.full((1, 3, 3), np.nan),
            np.full((1, 3, 1, 2), np.nan),
            r"times: no instants in push_00.csv; must be at least one",
        ),
    ],
)
def test_simulated_runs_of_the_wrong_form_are_refused(
    poses: Floats, probes: Floats, message: str
) -> None:
    with pytest.raises(ValueError, match=f"^{message}"):
        from_simulation(np.array([0.0, 1.0, 2.0]), poses, probes, **SET)


@pytest.mark.parametrize(
    ("times", "row"), [([0.0, 1.0, 1.0], 2), ([0.0, 2.0, 1.0, 3.0], 2), ([0.0, np.nan], 1)]
)
def test_a_clock_that_repeats_runs_back_or_stops_is_a_fault(times: list[float], row: int) -> None:
    fault = clock_fault(np.array(times))

    assert fault is not None
    assert fault[0] == row
    assert clock_fault(np.array([0.0, 1e-9])) is None
