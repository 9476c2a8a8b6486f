"""Public research recordings, where they are at hand; they are no part of the project."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meso_robust.recordings import RecordingSet, read_set, write_set
from meso_robust.recordings.checking import checked
from meso_robust.recordings.contact import nearest_gap
from meso_robust.recordings.direct.run import DirectTests, direct_tests

FOLDER = Path(__file__).parents[3] / "shared" / "recordings"
pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason="the public recordings are not here")


def test_a_camera_that_repeats_its_frames_is_caught_and_mended(tmp_path: Path) -> None:
    source = FOLDER / "cmu_two_finger" / "bigrect_3pts_20_neg30_90"
    found = checked(source, None, repair=False)
    assert found.format == "two_finger_log"
    assert {one.kind for one in found.matters} == {"frozen", "gap", "frames"}
    assert found.verdict == "USABLE WITH CARE"
    by_file = {one.file: one for one in found.recordings.recordings}
    for problem in found.matters:
        if problem.kind == "frozen":
            poses = by_file[problem.file].poses
            frames = np.array(problem.rows) - 2
            assert np.all(poses[frames] == poses[frames - 1])
    mended = checked(source, None, repair=True)
    assert {one.kind for one in mended.repairs} == {"frozen"}
    assert {one.kind for one in mended.matters} == {"gap"}  # the camera lost the part for 0.6 s
    write_set(tmp_path, mended.recordings)
    assert len(read_set(tmp_path).recordings) == len(found.recordings.recordings)


def test_forces_of_a_robot_that_was_not_tared_are_named() -> None:
    found = checked(FOLDER / "mit_plywood", None, repair=False)
    assert {one.kind for one in found.matters} <= {"force_offset", "gap", "overlap"}
    offsets = [one.file for one in found.matters if one.kind == "force_offset"]
    assert len(offsets) >= 5
    (one,) = [each for each in found.recordings.recordings if each.file == offsets[0]]
    assert one.forces is not None
    # by another route: newtons at the tip while it is millimetres from the block
    far = nearest_gap(found.recordings, one) > 2e-3
    assert np.nanmin(np.linalg.norm(one.forces[far, 0], axis=1)) > 1.0


def test_two_poses_a_push_are_few_and_show_no_noise() -> None:
    found = checked(FOLDER / "cmu_support_points" / "patch", None, repair=False)
    *few, noise = found.matters
    assert {(one.severity, one.kind) for one in few} == {("warning", "few_frames")}
    assert len(few) == len(found.recordings.recordings)
    assert (noise.severity, noise.kind) == ("error", "noise_unknown")


def shifted(recordings: RecordingSet, by: tuple[float, float, float]) -> RecordingSet:
    """Poses as a camera shows them whose frame is shifted (m) and whose template is turned (rad)."""
    moved = tuple(replace(one, poses=one.poses + by) for one in recordings.recordings)
    return replace(recordings, recordings=moved)


def sizes(tests: DirectTests) -> dict[str, tuple[float, ...]]:
    return {one.effect: tuple(each.value for each in one.estimates) for one in tests.findings}


def test_registration_offset_and_yaw_of_the_plywood_set_are_seen_without_a_simulation() -> None:
    """By the gap between tip and face; and what is concealed comes on top of the set's own."""
    found = checked(FOLDER / "mit_plywood", None, repair=False)
    assert found.direct is not None
    assert found.direct.gap is not None
    before, after = found.direct.gap.rms
    assert before > 0.6e-3
    assert after < 0.31e-3
    own = sizes(found.direct)
    assert own["reference_offset"] == pytest.approx((-450.0, 300.0), abs=120.0)
    assert own["registration_shift"] == pytest.approx((320.0, 320.0), abs=120.0)
    assert own["part_yaw"] == pytest.approx((0.62,), abs=0.12)
    # the robot's own clock is late by up to milliseconds; on a regular one the tip travels evenly
    assert "stamp_jitter" in own
    (jitter,) = [one for one in found.direct.findings if one.effect == "stamp_jitter"]
    assert jitter.after < 10e-6 < 50e-6 < jitter.before

    wrong = shifted(found.recordings, (1e-3, -2e-3, np.radians(1.0)))
    more = sizes(direct_tests(wrong))
    assert np.subtract(more["registration_shift"], own["registration_shift"]) == pytest.approx(
        (1000.0, -2000.0), abs=60.0
    )
    assert more["part_yaw"][0] - own["part_yaw"][0] == pytest.approx(1.0, abs=0.05)


def test_one_rig_has_one_latency() -> None:
    """Found in the hand's frame, it takes most of the gap between tip and face, which it has not seen."""
    latencies = []
    for folder in ("bigrect_3pts_20_neg30_90", "bigrect_3pts_30_50_60", "bigrect_ridge_30_50_60"):
        found = checked(FOLDER / "cmu_two_finger" / folder, None, repair=False)
        assert found.verdict == "USABLE WITH CARE"
        assert found.direct is not None
        assert found.direct.gap is not None
        (late,) = [one for one in found.direct.findings if one.effect == "camera_latency"]
        assert late.test == "hand"
        latencies.append(late.estimates[0].value)
        assert found.direct.gap.rms[0] < 1e-3  # 2.6 to 2.8 mm with the delay in
    assert np.ptp(latencies) < 15.0
    assert 140.0 < np.mean(latencies) < 165.0
