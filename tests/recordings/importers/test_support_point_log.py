"""Logs of pushes on known support points: two poses a push, forces, files that end early."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from meso_robust.errors import InputError
from meso_robust.recordings.importers import FORMATS
from meso_robust.recordings.importers.support_point_log import support_points
from meso_robust.recordings.outline import Rectangle
from tests.recordings.importers import written

IMPORTER = FORMATS["support_point_log"]
EARLY, LATE = 1439065302.0, 1439302133.0
FOLDER = "30_90_30_30_30_90"


def test_two_poses_stand_at_the_ends_of_the_tools_instants(tmp_path: Path) -> None:
    path = written.support_log(tmp_path / FOLDER, ["1", *written.support_push(LATE)])
    assert IMPORTER.recognises(path)
    assert IMPORTER.recognises(path.parent)
    imported = IMPORTER.read(path.parent)
    (push,) = imported.recordings.recordings
    assert not imported.left
    assert push.file == "exp_push00.csv"
    assert np.allclose(push.times, [0.0, 0.1, 0.2], atol=1e-6)
    # the corner at (100, 200) mm, the centre 50 mm along both legs; then a quarter turn
    assert np.allclose(push.poses[0], [0.150, 0.250, 0.0])
    assert np.isnan(push.poses[1]).all()
    assert np.allclose(push.poses[2], [0.060, 0.250, np.pi / 2])
    assert np.allclose(push.probes[:, 0], [[0.090, 0.210], [0.091, 0.210], [0.092, 0.210]])


@pytest.mark.parametrize("angle", [0.0, 0.7, -2.0])
def test_forces_are_freed_of_the_first_sample_and_turned_into_the_world(
    tmp_path: Path, angle: float
) -> None:
    """A sensed (2, 0) is (-1, -1) √2 of the turned tool, (2, 0) of the tool before."""
    for start, along in ((LATE, np.exp(-0.75j * np.pi)), (EARLY, 1.0)):
        lines = ["1", *written.support_push(start, angle)]
        path = written.support_log(tmp_path / FOLDER, lines)
        (push,) = IMPORTER.read(path).recordings.recordings
        world = 2.0 * np.exp(1j * angle) * along  # at 0.1 s the third sample
        assert push.forces is not None
        assert np.allclose(push.forces[0], 0.0, atol=1e-6)
        assert np.allclose(push.forces[1, 0], [world.real, world.imag], atol=1e-5)


def test_a_sensed_sideways_force_is_mirrored(tmp_path: Path) -> None:
    forces = [(EARLY + 0.05 * k, 0.0, 0.5 * k) for k in range(5)]
    lines = ["1", *written.support_push(EARLY, 0.0, forces)]
    (push,) = IMPORTER.read(written.support_log(tmp_path / FOLDER, lines)).recordings.recordings
    assert push.forces is not None
    assert np.allclose(push.forces[:, 0], [[0.0, 0.0], [0.0, -1.0], [0.0, -2.0]], atol=1e-5)


def test_a_file_without_its_count_is_read(tmp_path: Path) -> None:
    lines = [*written.support_push(LATE), *written.support_push(LATE + 9.0), ""]
    imported = IMPORTER.read(written.support_log(tmp_path / FOLDER, lines, "exp.txt"))
    assert len(imported.recordings.recordings) == 2
    assert not imported.left


@pytest.mark.parametrize("kept", [1, 2, 3, 8, 9, 10, 11])
def test_a_file_that_ends_early_gives_what_is_complete(tmp_path: Path, kept: int) -> None:
    whole = written.support_push(LATE)
    lines = ["2", *whole, *written.support_push(LATE + 9.0)[:kept]]
    imported = IMPORTER.read(written.support_log(tmp_path / FOLDER, lines))
    assert len(imported.recordings.recordings) == 1
    (left,) = imported.left
    assert left.rows == tuple(range(len(whole) + 2, len(lines) + 1))
    assert "ends within push 1" in left.reason


def test_a_wrong_count_is_told(tmp_path: Path) -> None:
    lines = ["5", *written.support_push(LATE)]
    (left,) = IMPORTER.read(written.support_log(tmp_path / FOLDER, lines)).left
    assert str(left) == "exp.txt.gz, line 1: states 5 pushes and holds 1"


def test_a_copy_of_a_push_is_left_out(tmp_path: Path) -> None:
    first, second = written.support_push(LATE), written.support_push(LATE + 9.0)
    written.support_log(tmp_path / FOLDER, ["1", *first], "a.txt")
    written.support_log(tmp_path / FOLDER, ["2", *second, *first], "b.txt")
    imported = IMPORTER.read(tmp_path / FOLDER)
    names = [recording.file for recording in imported.recordings.recordings]
    assert names == ["a_push00.csv", "b_push00.csv"]
    assert [(left.file, left.rows) for left in imported.left] == [("b.txt", (1,))]


def test_stamps_that_run_back_are_left_out(tmp_path: Path) -> None:
    lines = ["1", *written.support_push(LATE)]
    lines[-2] = lines[-2].replace(repr(LATE + 0.1), repr(LATE - 0.1))
    imported = IMPORTER.read(written.support_log(tmp_path / FOLDER, lines))
    (push,) = imported.recordings.recordings
    assert np.allclose(push.times, [0.0, 0.2], atol=1e-6)
    assert [(left.place, left.rows) for left in imported.left] == [("push 0, tool", (1,))]


@pytest.mark.parametrize(
    ("line", "text", "words"),
    [
        (0, "-3", "line 1: '-3'; must be a number of lines or pushes"),
        (1, "1 2 3", "line 2: '1 2 3'; must be 7 finite numbers"),
        (3, "five", "line 4: 'five'; must be a number of lines"),
        (3, "0", "must be a number from 1"),
        (5, "1 2 inf", "must be 3 finite numbers"),
        (9, "1", "must be a number from 2"),
    ],
)
def test_a_broken_log_is_named(tmp_path: Path, line: int, text: str, words: str) -> None:
    lines = ["1", *written.support_push(LATE)]
    lines[line] = text
    path = written.support_log(tmp_path / FOLDER, lines)
    with pytest.raises(InputError, match=r"exp\.txt\.gz") as error:
        IMPORTER.read(path)
    assert words in str(error.value)


def test_a_file_that_is_not_packed_or_cut_short_is_named(tmp_path: Path) -> None:
    path = written.support_log(tmp_path / FOLDER, ["1", *written.support_push(LATE)])
    path.write_bytes(path.read_bytes()[:-9])
    with pytest.raises(InputError, match="cannot be unpacked"):
        IMPORTER.read(path)
    path.write_bytes(bytes.fromhex("1f8b0800000000000003") + b"\xff" * 20)
    with pytest.raises(InputError, match="cannot be unpacked"):
        IMPORTER.read(path)
    path.write_bytes(b"plain text")
    with pytest.raises(InputError, match="cannot be read"):
        IMPORTER.read(path)


def test_support_points_come_from_the_folders_name() -> None:
    points = support_points("wood_30_90_40_35_30_100")
    assert points is not None
    assert np.allclose(points, [[-0.020, -0.015], [0.040, -0.020], [-0.010, 0.050]])
    assert support_points("patch") is None


def test_a_file_outside_such_a_folder_is_not_taken(tmp_path: Path) -> None:
    assert not IMPORTER.recognises(written.support_log(tmp_path / "logs", ["1"]))


def test_supports_between_whole_millimetres_are_a_folder_of_this_format(tmp_path: Path) -> None:
    folder = "wood_30.5_90_30_30.25_30_90.0"
    path = written.support_log(tmp_path / folder, ["1", *written.support_push(LATE)])
    assert IMPORTER.recognises(path.parent)
    assert len(IMPORTER.read(path.parent).recordings.recordings) == 1
    points = support_points(folder)
    assert points is not None
    expected = np.array([[30.5, 30.25], [90.0, 30.0], [30.0, 90.0]]) - 50.0
    assert np.allclose(points, 1e-3 * expected)


def test_an_outline_for_the_one_known_triangle_is_refused(tmp_path: Path) -> None:
    path = written.support_log(tmp_path / FOLDER, ["1", *written.support_push(LATE)])
    with pytest.raises(InputError, match="leave --outline out"):
        IMPORTER.read(path, Rectangle(length=0.1, width=0.1))
