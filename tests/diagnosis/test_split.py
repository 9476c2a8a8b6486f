"""What is held out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.diagnosis.diagnose import Diagnosis, _amiss, _in_order
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


@pytest.mark.parametrize("seed", range(5))
def test_the_order_in_which_a_set_lists_its_recordings_is_of_no_account(
    null_set: RecordingSet, seed: int
) -> None:
    recordings = of(null_set, 12)
    mixed = replace(recordings, recordings=recordings.recordings[::-1])
    chosen = [sorted(files(split(one, seed).held_out)) for one in (recordings, mixed)]
    assert chosen[0] == chosen[1]
    listed = _in_order(mixed)
    assert files(listed) == files(recordings)


def test_the_seed_makes_the_choice(null_set: RecordingSet) -> None:
    recordings = of(null_set, 20)
    chosen = [files(split(recordings, seed).held_out) for seed in (0, 0, 1, 2, 3)]
    assert chosen[0] == chosen[1]
    assert len({tuple(one) for one in chosen}) == 4


def test_files_are_left_out_by_name(null_set: RecordingSet) -> None:
    rest = without(null_set, {"push_02.csv", "push_05.csv", "no_such.csv"})
    assert files(rest) == [f for f in files(null_set) if f not in ("push_02.csv", "push_05.csv")]


def test_some_recordings_are_fitted_in_any_case(null_set: RecordingSet) -> None:
    recordings = of(null_set, 10)
    plain = split(recordings, 0)
    wanted = frozenset(files(plain.held_out))
    other = split(recordings, 0, wanted)
    assert wanted <= set(files(other.training))
    assert len(files(other.held_out)) == 2
    same = split(recordings, 0, frozenset(files(plain.training)[:1]))
    assert files(same.held_out) == files(plain.held_out)


def test_a_recording_that_was_held_out_and_is_far_off_is_fitted(null: Diagnosis) -> None:
    """Where those of the fit show nothing, the only push on an edge may have been held out."""
    assert null.plain.held_out is not None
    assert _amiss(null.plain, null.baseline) == frozenset()
    errors = replace(null.plain.held_out, sigma=np.array([1.0, 2.0]))
    off = replace(null.plain, held_out=errors)
    assert _amiss(off, null.baseline) == {errors.prepared.files[1]}
    assert _amiss(replace(off, held_out=None), null.baseline) == frozenset()
