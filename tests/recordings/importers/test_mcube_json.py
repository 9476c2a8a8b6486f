"""Single pushes in JSON: one clock out of three."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from meso_robust.errors import InputError
from meso_robust.recordings import read_set, write_set
from meso_robust.recordings.importers import FORMATS
from tests.recordings.importers import written

IMPORTER = FORMATS["mcube_json"]
START = written.START


def test_a_push_is_on_the_clock_of_the_object(tmp_path: Path) -> None:
    path = written.mcube(tmp_path)
    assert IMPORTER.recognises(path)
    imported = IMPORTER.read(path)
    (push,) = imported.recordings.recordings
    assert not imported.left
    assert push.file == path.stem + ".csv"
    assert np.allclose(push.times, 0.01 * np.arange(6), atol=1e-6)
    assert np.allclose(push.poses[:, :2], [0.1, 0.2])
    # tip samples lie 4 ms after the object's, 1 mm a sample: 0.6 mm further at the next instant
    assert np.isnan(push.probes[0]).all()
    assert np.allclose(push.probes[1:, 0, 0], 1e-3 * np.arange(5) + 0.6e-3, atol=1e-7)
    assert np.allclose(push.probes[1:, 0, 1], -1.0)
    # the wrench is the pusher's: its sign turns
    assert push.forces is not None
    assert np.allclose(push.forces[1:, 0, 0], -(2.8 + np.arange(5)), atol=1e-3)
    assert np.allclose(push.forces[1:, 0, 1], 3.0)
    assert imported.recordings.tip_radius == 4.75e-3
    assert imported.recordings.part.outline.max() == 0.045


def test_angles_come_as_they_are_and_the_set_can_be_written(tmp_path: Path) -> None:
    poses = [[START + 0.01 * k, 0.0, 0.0, theta] for k, theta in enumerate([3.14, -3.14, -3.13])]
    imported = IMPORTER.read(written.mcube(tmp_path, object_pose=poses))
    write_set(tmp_path / "set", imported.recordings)
    (push,) = read_set(tmp_path / "set").recordings
    assert np.allclose(push.poses[:, 2], [3.14, -3.14, -3.13], atol=1e-7)
    assert np.allclose(push.times, [0.0, 0.01, 0.02], atol=1e-6)


def test_what_is_left_out_is_listed(tmp_path: Path) -> None:
    stamps = [0.0, 0.01, 0.005, 0.01, 0.02]
    poses = [[START + stamp, 0.1 * k, 0.0, 0.0] for k, stamp in enumerate(stamps)]
    wrench = [[START, 0.0, 1e-21, 0.0], [START + 0.02, 1.0, 1.0, 1.0]]
    path = written.mcube(tmp_path, object_pose=poses, ft_wrench=wrench)
    imported = IMPORTER.read(path)
    (push,) = imported.recordings.recordings
    assert np.allclose(push.poses[:, 0], [0.0, 0.1, 0.4])
    assert [(left.place, left.rows) for left in imported.left] == [
        ("object_pose", (2, 3)),
        ("ft_wrench", (0,)),
    ]
    assert str(imported.left[0]).startswith(f"{path.name}, object_pose 2, 3: its stamp")
    assert push.forces is not None
    assert np.isnan(push.forces[:2]).all()
    assert np.allclose(push.forces[2], -1.0)


def test_a_hole_of_the_tip_stays_a_hole(tmp_path: Path) -> None:
    tip = [[START + t, t, 0.0, 0.0] for t in (0.0, 0.01, 0.04, 0.05)]
    (push,) = IMPORTER.read(written.mcube(tmp_path, tip_pose=tip)).recordings.recordings
    known = np.isfinite(push.probes[:, 0, 0])
    assert known.tolist() == [True, True, False, False, True, True]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("[1, 2]", "must be one JSON object"),
        ("{", "is not a JSON file"),
        ("{}", "key object_pose is missing"),
        ('{"object_pose": []}', "key object_pose is no list or empty"),
        ('{"object_pose": [[1, 2, 3]]}', "key object_pose[0] = [1, 2, 3]"),
        ('{"object_pose": [[1, 2, 3, NaN]]}', "key object_pose[0] = [1, 2, 3, nan]"),
        ('{"object_pose": [[1, 2, 3, true]]}', "key object_pose[0] = [1, 2, 3, True]"),
    ],
)
def test_a_broken_file_is_named(tmp_path: Path, content: str, words: str) -> None:
    path = tmp_path / written.MCUBE_NAME.format(shape="rect1")
    path.write_text(content, encoding="utf-8")
    with pytest.raises(InputError, match=r"motion_surface=plywood.*\.json") as error:
        IMPORTER.read(path)
    assert words in str(error.value)


def test_a_set_holds_one_known_part(tmp_path: Path) -> None:
    written.mcube(tmp_path, shape="hex")
    with pytest.raises(InputError, match="shape = hex; must be one of rect1"):
        IMPORTER.read(tmp_path)
    written.mcube(tmp_path)
    with pytest.raises(InputError, match="shapes hex, rect1; a recording set holds one"):
        IMPORTER.read(tmp_path)


def test_other_files_are_not_taken(tmp_path: Path) -> None:
    (tmp_path / "set.json").write_text(json.dumps({"object_pose": []}), encoding="utf-8")
    assert not IMPORTER.recognises(tmp_path)
    assert not IMPORTER.recognises(tmp_path / "absent")
    with pytest.raises(InputError, match="no file of this format"):
        IMPORTER.read(tmp_path)
