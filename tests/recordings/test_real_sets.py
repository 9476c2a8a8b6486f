"""Public research recordings, where they are at hand; they are no part of the project."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from meso_robust.recordings import read_set, write_set
from meso_robust.recordings.checking import checked
from meso_robust.recordings.contact import nearest_gap

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
