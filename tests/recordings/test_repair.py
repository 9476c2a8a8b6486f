"""Repairs keep every value that they do not take away, and say what they did."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from meso_robust.errors import InputError
from meso_robust.recordings import RecordingSet, read_set, write_set
from meso_robust.recordings.checking import checked
from meso_robust.recordings.problem import Problem
from meso_robust.recordings.problems import problems
from meso_robust.recordings.repair import repaired
from tests.recordings.planted import FILES, FRAMES, MIDDLE, PART, UM, Floats, clean, planted, poses

REPEATABLE = settings(derandomize=True, deadline=None, database=None, max_examples=40)


def mended(recordings: RecordingSet) -> tuple[Floats, list[str]]:
    """Poses of the middle recording after the repair, and what was done."""
    made, repairs = repaired(recordings, problems(recordings))
    (middle,) = [one for one in made.recordings if one.file == MIDDLE]
    return middle.poses, [str(one) for one in repairs]


def test_a_clean_set_stays_as_it_is() -> None:
    made = clean()
    found, repairs = repaired(made, problems(made))
    assert repairs == ()
    assert all(a is b for a, b in zip(found.recordings, made.recordings, strict=True))


def test_zeros_repeats_and_outliers_are_taken_as_not_seen() -> None:
    changed = poses()
    changed[20] = 0.0
    changed[50] = changed[49]
    changed[120, 1] += 80 * UM
    found, repairs = mended(planted(poses=changed))
    assert np.flatnonzero(np.any(np.isnan(found), axis=1)).tolist() == [20, 50, 120]
    kept = np.delete(np.arange(FRAMES), [20, 50, 120])
    assert np.array_equal(found[kept], changed[kept])
    assert repairs == [
        f"{MIDDLE}, line 22: pose of zeros: not found: the poses were taken as not seen",
        f"{MIDDLE}, line 52: frozen pose: the poses were taken as not seen",
        f"{MIDDLE}, line 122: poses off the path: the poses were taken as not seen",
    ]


def test_wrapped_angles_become_continuous() -> None:
    original = poses()
    changed = original.copy()
    changed[60:90, 2] += 2 * np.pi
    changed[100:, 2] -= 2 * np.pi
    found, repairs = mended(planted(poses=changed))
    np.testing.assert_allclose(found[:, 2], original[:, 2], atol=1e-14)
    assert np.array_equal(found[:, :2], original[:, :2])
    assert repairs == [
        f"{MIDDLE}, lines 62, 92, 102: angle wraps: whole turns were added, so θ is continuous"
    ]


def test_a_recording_that_cannot_be_used_is_left_out() -> None:
    changed = poses()
    changed[150:, 1] += 90 * UM
    recordings = planted(poses=changed)
    found, (repair,) = repaired(recordings, problems(recordings))
    assert [one.file for one in found.recordings] == [FILES[0], FILES[2]]
    assert (repair.file, repair.kind, repair.rows) == (MIDDLE, "jump", ())
    assert repair.done.startswith("the recording was left out: the part jumps by")


def test_units_and_warnings_of_other_kinds_stay() -> None:
    part = replace(PART, length=1.6 * UM, width=0.8 * UM)
    recordings = clean(part=part, tip_radius=0.0125 * UM)
    assert {one.kind for one in problems(recordings)} == {"units"}
    found, repairs = repaired(recordings, problems(recordings))
    assert repairs == ()
    assert found.recordings == recordings.recordings


def test_nothing_left_is_refused() -> None:
    changed = poses()
    changed[150:, 1] += 90 * UM
    one = replace(clean().recordings[1], poses=changed)
    recordings = clean(recordings=(one,))
    with pytest.raises(InputError, match=r"no recording is usable; the last one, push_01\.csv: "):
        repaired(recordings, problems(recordings))


@st.composite
def mistakes(draw: st.DrawFn) -> Floats:
    """Poses with mistakes of many kinds, some of them at once."""
    changed = poses()
    frames = st.lists(st.integers(1, FRAMES - 1), max_size=6)
    for k in draw(frames):
        changed[k] = 0.0
    for k in draw(frames):
        changed[k] = changed[k - 1]
    for k in draw(frames):
        changed[k, draw(st.integers(0, 1))] += draw(st.sampled_from([-1.0, 0.1])) * 1e-3
    for k in draw(frames):
        changed[k:, 2] += 2 * np.pi * draw(st.sampled_from([-1, 1]))
    for k in draw(frames):
        changed[k, draw(st.integers(0, 2))] = np.nan
    return changed


@REPEATABLE
@given(mistakes())
def test_no_kept_value_changes_and_no_value_appears(changed: Floats) -> None:
    recordings = planted(poses=changed)
    found, repairs = repaired(recordings, problems(recordings))
    for one in found.recordings:
        (old,) = [each for each in recordings.recordings if each.file == one.file]
        assert np.array_equal(one.times, old.times)
        assert np.array_equal(one.probes, old.probes, equal_nan=True)
        seen = ~np.isnan(one.poses)
        assert not np.any(seen & np.isnan(old.poses))
        assert np.array_equal(one.poses[:, :2][seen[:, :2]], old.poses[:, :2][seen[:, :2]])
        turns = (one.poses[:, 2] - old.poses[:, 2])[seen[:, 2]] / (2 * np.pi)
        np.testing.assert_allclose(turns, np.round(turns), atol=1e-12)
        gone = np.any(~seen & ~np.isnan(old.poses), axis=1)
        told = {row - 2 for each in repairs if each.file == one.file for row in each.rows}
        assert set(np.flatnonzero(gone).tolist()) <= told


@pytest.fixture
def spoilt(tmp_path: Path) -> Path:
    """A folder with a mistake of each repairable kind."""
    changed = poses()
    changed[20] = 0.0
    changed[50] = changed[49]
    changed[120, 1] += 80 * UM
    changed[60:90, 2] += 2 * np.pi
    folder = tmp_path / "spoilt"
    write_set(folder, planted(poses=changed))
    rows = (folder / MIDDLE).read_text().splitlines()
    rows[100:100] = [rows[99], rows[98]]  # the clock repeats, then runs backwards
    rows[200] = rows[200].replace(",", ",x", 1)
    (folder / MIDDLE).write_text("\n".join(rows) + "\n")
    return folder


def test_a_repaired_set_is_clean_when_it_is_written_and_read_again(
    spoilt: Path, tmp_path: Path
) -> None:
    with pytest.raises(InputError):
        read_set(spoilt)
    found = checked(spoilt, None, repair=True)
    assert {one.kind for one in found.repairs} == {
        *("zero_pose", "frozen", "outlier", "wrap", "clock", "cell")
    }
    assert found.verdict == "CLEAN"
    write_set(tmp_path / "again", found.recordings)
    again = checked(tmp_path / "again", None, repair=False)
    assert again.verdict == "CLEAN"
    assert {one.kind for one in again.found} <= {"gap"}
    assert [one.rows for one in again.remaining] == [one.rows for one in found.remaining]
    twice = checked(tmp_path / "again", None, repair=True)
    assert twice.repairs == ()


def test_what_the_first_look_missed_is_repaired_as_well(
    spoilt: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As when mistakes make the noise seem so large that others hide in it."""
    looks = []

    def short_sighted(*given: object) -> tuple[Problem, ...]:
        looks.append(given)
        found = problems(*given)  # type: ignore[arg-type]
        return tuple(one for one in found if one.kind != "frozen" or len(looks) > 1)

    monkeypatch.setattr("meso_robust.recordings.checking.problems", short_sighted)
    found = checked(spoilt, None, repair=True)
    assert found.repairs[-1].kind == "frozen"
    assert found.repairs[-1].rows == (52,)
    assert found.verdict == "CLEAN"


def test_without_repair_everything_remains(spoilt: Path) -> None:
    found = checked(spoilt, "set", repair=False)
    assert found.remaining == found.found
    assert found.verdict == "USABLE WITH CARE"  # a fit leaves out the same rows and poses
    assert {one.kind for one in found.left_out} == {one.kind for one in found.found} - {
        "gap",
        "wrap",
    }
    assert found.repairs == ()


def test_paths_and_formats_that_cannot_be(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist; give the folder of a recording set"):
        checked(tmp_path / "none", None, repair=False)
    with pytest.raises(InputError, match=r"no set.toml in it and no known format; must be a rec"):
        checked(tmp_path, None, repair=False)
    with pytest.raises(InputError, match=r"--format avi: must be one of set, "):
        checked(tmp_path, "avi", repair=False)
    write_set(tmp_path, clean())
    assert checked(tmp_path / "set.toml", None, repair=False).verdict == "CLEAN"
