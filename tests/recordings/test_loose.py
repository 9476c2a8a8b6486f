"""Every row and cell that cannot be read is listed; what can be read is."""

from __future__ import annotations

from itertools import combinations, pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from meso_robust.errors import InputError
from meso_robust.recordings import read_set
from meso_robust.recordings.loose import read_loosely
from meso_robust.recordings.table import forward
from tests.recordings.examples import SET, TABLE, folder_of, replaced

REPEATABLE = settings(derandomize=True, deadline=None, database=None, max_examples=200)
HEADER = TABLE.splitlines()[0]


def table(*rows: str) -> str:
    return "\n".join([HEADER, *rows]) + "\n"


@REPEATABLE
@given(st.lists(st.integers(0, 6), max_size=7))
def test_as_many_rows_as_possible_are_kept(times: list[int]) -> None:
    kept = forward(np.array(times, dtype=np.float64))
    values = [times[k] for k in kept]
    assert all(a < b for a, b in pairwise(values))
    assert list(kept) == sorted(set(kept.tolist()))
    longest = max(
        (
            len(chosen)
            for count in range(len(times) + 1)
            for chosen in combinations(times, count)
            if all(a < b for a, b in pairwise(chosen))
        ),
        default=0,
    )
    assert len(kept) == longest


@pytest.mark.parametrize(
    ("times", "kept"),
    [
        ([0, 1, 1, 2], [0, 1, 3]),  # the first of equals
        ([0, 2, 1, 3], [0, 1, 3]),  # the row that goes back, not the one before it
        ([0, 1, 99, 2, 3], [0, 1, 3, 4]),  # one leap ahead does not throw out what follows
        ([5, 0, 1, 2], [1, 2, 3]),
        ([], []),
    ],
)
def test_which_rows_are_kept(times: list[float], kept: list[int]) -> None:
    assert forward(np.array(times, dtype=np.float64)).tolist() == kept


def test_a_sound_set_is_read_as_the_strict_reader_does(tmp_path: Path) -> None:
    read, strict = read_loosely(folder_of(tmp_path)), read_set(tmp_path)
    assert read.problems == ()
    assert read.lines == {"push_00.csv": (2, 3, 4)}
    np.testing.assert_array_equal(read.recordings.recordings[0].poses, strict.recordings[0].poses)
    assert (read.recordings.part, read.recordings.sensor) == (strict.part, strict.sensor)


def test_all_faults_of_a_file_are_listed_with_their_lines(tmp_path: Path) -> None:
    text = table(
        "0,1,2,3,4,5",
        "1,1,x,3,4,5",  # line 3: no number
        "2,1,2,3,4",  # line 4: too short
        "2,1,2,3,4,5",
        "2,1,2,3,4,6",  # line 6: repeats
        "1.5,1,2,3,4,7",  # line 7: backwards
        ",1,2,3,4,8",  # line 8: no instant
        "3,1,2,nan,inf,9",  # line 9: two cells
    )
    folder_of(tmp_path, table=text)
    read = read_loosely(tmp_path)
    assert sorted((one.rows[0], one.kind) for one in read.problems) == [
        (3, "cell"),
        (4, "row"),
        (6, "clock"),
        (7, "clock"),
        (8, "cell"),
        (9, "cell"),
        (9, "cell"),
    ]
    assert {one.severity for one in read.problems} == {"error"}
    (recording,) = read.recordings.recordings
    assert recording.times.tolist() == [0.0, 1.0, 2.0, 3.0]
    assert read.lines == {"push_00.csv": (2, 3, 5, 9)}
    assert np.isnan(recording.poses[1, 1])
    assert np.isnan(recording.poses[3, 2])
    assert np.isnan(recording.probes[3, 0, 0])
    assert recording.probes[2, 0, 1] == pytest.approx(5e-6)
    back = next(one for one in read.problems if one.rows == (7,))
    assert back.value == "column time_s = 1.5 s"
    assert back.rule == "must be after the instant of the row before, 2.0 s"
    # and the strict reader still refuses with one message
    with pytest.raises(InputError, match=r"push_00.csv, line 4: 5 cells; must be 6"):
        read_set(tmp_path)


def test_a_leap_of_the_clock_is_told_from_a_step_back(tmp_path: Path) -> None:
    rows = [f"{time},1,2,3,4,5" for time in (0, 1, 99, 2, 3)]
    (leap,) = read_loosely(folder_of(tmp_path, table=table(*rows))).problems
    assert leap.rows == (4,)
    assert leap.rule == "must be before the instant of the row after, 2.0 s"


def test_a_recording_that_cannot_be_read_is_listed_and_left_out(tmp_path: Path) -> None:
    toml = SET + '[[recording]]\nfile = "gone.csv"\nprobes = []\n'
    read = read_loosely(folder_of(tmp_path, toml))
    (problem,) = read.problems
    assert (problem.file, problem.kind, problem.severity) == ("gone.csv", "unreadable", "error")
    assert problem.value.startswith("cannot be read (No such file")
    assert [one.file for one in read.recordings.recordings] == ["push_00.csv"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (TABLE.replace("time_s", "time"), "column 'time' is unknown"),
        (HEADER + "\n", "no rows; must have at least one"),
        (table("x,1,2,3,4,5"), "line 2, column time_s = 'x': must be a finite number"),
        (table("1,2"), "line 2: 2 cells; must be 6"),
    ],
)
def test_a_set_of_which_nothing_can_be_read_is_refused(
    tmp_path: Path, text: str, message: str
) -> None:
    with pytest.raises(InputError, match=f"no recording can be read; push_00.csv: {message}"):
        read_loosely(folder_of(tmp_path, table=text))


def test_a_wrong_set_file_is_refused_by_both(tmp_path: Path) -> None:
    folder_of(tmp_path, replaced(SET, "recordings/1", "recordings/2"))
    with pytest.raises(InputError, match="key schema"):
        read_loosely(tmp_path)
