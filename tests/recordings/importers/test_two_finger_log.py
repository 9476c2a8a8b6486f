"""Logs of two fingers: splitting, lost frames, fingers from the pusher's pose."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from meso_robust.errors import InputError
from meso_robust.recordings.importers import FORMATS
from tests.recordings.importers import written

IMPORTER = FORMATS["two_finger_log"]
START = 1495591575.53
ROWS = [
    (START, 90, 90, 3, 40, 50, 0, 3),  # of the run before
    (START + 0.03, 10, 20, 1.5, 40, 50, 0, 3),
    (START + 0.06, 0, 0, 0, 41, 50, 0, 3),
    (START + 0.06, 11, 20, 1.5, 41, 50, 0, 3),
    (START + 0.10, 11, 20, 1.5, 42, 50, 0, 3),
    (START + 2.10, 12, 21, 1.6, 42, 50, np.pi / 2, 3),
    (START + 2.13, 13, 21, 1.6, 42, 51, np.pi / 2, 1),
]


def test_a_log_is_split_where_the_robot_takes_a_new_place(tmp_path: Path) -> None:
    path = written.two_finger(tmp_path / "bigrect_3pts_20", ROWS)
    assert IMPORTER.recognises(path)
    assert IMPORTER.recognises(path.parent)
    imported = IMPORTER.read(path.parent)
    first, second = imported.recordings.recordings
    assert (first.file, second.file) == ("log2017_push1.csv", "log2017_push2.csv")
    assert np.allclose(first.times, [0.0, 0.03, 0.07], atol=1e-6)
    assert np.allclose(second.times, [0.0, 0.03], atol=1e-6)
    assert np.allclose(first.poses[[0, 2]], [[0.010, 0.020, 1.5], [0.011, 0.020, 1.5]])
    assert np.isnan(first.poses[1]).all()
    assert np.isfinite(first.probes).all()
    assert [(left.rows, left.place) for left in imported.left] == [
        ((1,), "line"),
        ((4,), "line"),
        ((3,), "line"),
    ]


def test_the_fingers_stand_across_the_pushers_direction(tmp_path: Path) -> None:
    path = written.two_finger(tmp_path / "bigrect_3pts_20", ROWS)
    first, second = IMPORTER.read(path).recordings.recordings
    assert np.allclose(first.probes[0], [[0.040, 0.062], [0.040, 0.038]], atol=1e-9)
    assert np.allclose(second.probes[0], [[0.030, 0.050], [0.054, 0.050]], atol=1e-9)


@pytest.mark.parametrize("folder", ["bigrect_3pts_1", "bigrect_ridge_1", "tri_0_0_90"])
def test_outlines_are_about_their_centre_of_area(tmp_path: Path, folder: str) -> None:
    outline = IMPORTER.read(written.two_finger(tmp_path / folder, ROWS)).recordings.part.outline
    x, y = outline.T
    after = np.roll(outline, -1, axis=0)
    cross = x * after[:, 1] - y * after[:, 0]
    assert cross.sum() > 0.0  # counter-clockwise
    assert np.allclose((cross[:, None] * (outline + after)).sum(axis=0), 0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ([ROWS[0], (1, 2)], "line 2: '1,2'; must be eight finite numbers"),
        ([ROWS[0], (*ROWS[0][:7], "nan")], "must be eight finite numbers"),
        ([ROWS[0]], "one row; must have more"),
    ],
)
def test_a_broken_log_is_named(tmp_path: Path, rows: list[written.Row], words: str) -> None:
    path = written.two_finger(tmp_path / "tri_0", rows)
    with pytest.raises(InputError, match=r"log2017\.txt") as error:
        IMPORTER.read(path)
    assert words in str(error.value)


def test_a_part_without_a_known_outline_is_refused(tmp_path: Path) -> None:
    path = written.two_finger(tmp_path / "butter_60_20_135", ROWS)
    with pytest.raises(InputError, match="folder butter_60_20_135; must begin with one of"):
        IMPORTER.read(path)


def test_two_logs_of_one_name_are_told_apart_by_the_user(tmp_path: Path) -> None:
    for name in ("log.txt", "log.csv"):
        written.two_finger(tmp_path / "tri_0", ROWS, name)
    with pytest.raises(InputError, match=r"tri_0: recordings: file 'log_push1\.csv' appears twice"):
        IMPORTER.read(tmp_path / "tri_0")


def test_other_text_is_not_taken(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("1,2,3,4,5,6,7,8\n", encoding="utf-8")
    (tmp_path / "words.txt").write_text("a log\n", encoding="utf-8")
    assert not IMPORTER.recognises(tmp_path)
