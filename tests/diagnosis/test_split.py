"""What is held out."""

from __future__ import annotations

from dataclasses import replace

import pytest

from meso_robust.diagnosis.validation import split, without
from meso_robust.recordings import RecordingSet


def of(recordings: RecordingSet, count: int) -> RecordingSet:
    one = recordings.recordings[0]
    many = tuple(replace(one, file=f"push_{k:02d}.csv") for k in range(count))
    return replace(recordings, recordings=many)


def files(recordings: RecordingSet | None) -> list[str]:
    return [one.file for one in recordings.recordings] if recordings else []


@pytest.mark.parametrize(("count", "spared"), [(1, 0), (5, 0), (6, 2), (10, 2), (20, 4), (33, 7)])
def test_a_fifth_of_the_recordings_is_held_out(
    null_set: RecordingSet, count: int, spared: int
) -> None:
    recordings = of(null_set, count)
    parts = split(recordings, 0)
    training, held_out = files(parts.training), files(parts.held_out)
    assert len(held_out) == spared
    assert (parts.held_out is None) == (spared == 0)
    assert sorted(training + held_out) == files(recordings)
    assert training == sorted(training)
    assert held_out == sorted(held_out)
    assert parts.training.sensor == recordings.sensor


def test_the_seed_makes_the_choice(null_set: RecordingSet) -> None:
    recordings = of(null_set, 20)
    chosen = [files(split(recordings, seed).held_out) for seed in (0, 0, 1, 2, 3)]
    assert chosen[0] == chosen[1]
    assert len({tuple(one) for one in chosen}) == 4


def test_files_are_left_out_by_name(null_set: RecordingSet) -> None:
    rest = without(null_set, {"push_02.csv", "push_05.csv", "no_such.csv"})
    assert files(rest) == [f for f in files(null_set) if f not in ("push_02.csv", "push_05.csv")]
