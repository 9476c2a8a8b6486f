"""What `recordings` says of a set is what `identify` and `diagnose` act on."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meso_robust.api.recordings import Recordings, given_of, read_recordings
from meso_robust.diagnosis.noise import noise_of
from meso_robust.errors import InputError
from meso_robust.identification.prepared import prepare
from meso_robust.identification.usable import NOISE_IS_FITTED
from meso_robust.recordings import RecordingSet, SensorInfo, read_set, write_set
from meso_robust.recordings.checking import checked
from meso_robust.recordings.problems import problems
from meso_robust.recordings.usable import usable_set
from tests.nightly import by_day
from tests.recordings.planted import FILES, FRAMES, MIDDLE, RATE, UM, clean, one, planted, poses
from tests.recordings.simulated import Kind, made

REAL = Path(__file__).resolve().parents[3] / "shared" / "recordings"


def zeros() -> RecordingSet:
    changed = poses()
    changed[20] = 0.0
    return planted(poses=changed)


def frozen() -> RecordingSet:
    changed = poses()
    changed[51] = changed[50]
    return planted(poses=changed)


def leap() -> RecordingSet:
    changed = poses()
    changed[50, 0] += 400 * UM
    return planted(poses=changed)


def unseen_probe() -> RecordingSet:
    return planted(probes=np.full((FRAMES, 1, 2), np.nan))


def no_probe() -> RecordingSet:
    return planted(probe_names=(), probes=np.zeros((FRAMES, 0, 2)))


def begins_inside() -> RecordingSet:
    middle = clean().recordings[1]
    tips = middle.probes.copy()
    tips[:, 0, 0] += 250 * UM  # of a tip that would arrive after 200 um
    return planted(probes=tips)


def noiseless_two_poses() -> RecordingSet:
    """As a robot's log that knows the part before and after a push only."""
    seen = np.full((FRAMES, 3), np.nan)
    seen[[0, -1]] = poses()[[0, -1]]
    bare = tuple(replace(each, poses=seen) for each in clean().recordings)
    return clean(recordings=bare, sensor=SensorInfo(frame_rate=RATE))


def blind_camera() -> RecordingSet:
    seen = [replace(each, poses=each.poses[75:], times=each.times[75:], probes=each.probes[75:])
            for each in clean().recordings]  # fmt: skip
    return clean(
        recordings=tuple(seen), sensor=SensorInfo(frame_rate=RATE), position_source="camera"
    )


BAD = [
    unseen_probe,
    no_probe,
    begins_inside,
    noiseless_two_poses,
    blind_camera,
]


def refused_by_a_fit(recordings: RecordingSet) -> bool:
    """Whether checks, preparation or noise end a diagnosis."""
    try:
        left = usable_set(recordings).recordings
        prepare(left)
        noise_of(left)
    except InputError:
        return True
    return False


@pytest.mark.parametrize("bad", BAD)
def test_what_a_diagnosis_refuses_is_not_called_usable(bad: object, tmp_path: Path) -> None:
    assert callable(bad)
    write_set(tmp_path, bad())

    assert refused_by_a_fit(read_set(tmp_path))
    assert checked(tmp_path, None, repair=False).verdict == "NOT USABLE AS IT IS"


@pytest.mark.parametrize("bad", [zeros, frozen, leap])
def test_a_few_bad_poses_are_left_out_and_told(bad: object, tmp_path: Path) -> None:
    assert callable(bad)
    write_set(tmp_path, bad())
    found = checked(tmp_path, None, repair=False)

    assert found.verdict == "USABLE WITH CARE"
    assert {one.file for one in found.left_out} == {MIDDLE}
    left = usable_set(read_set(tmp_path))
    assert any(line.startswith(f"left out: {MIDDLE}") for line in left.warnings)
    seen = np.isfinite(left.recordings.recordings[1].poses[:, 0])
    assert FRAMES - 3 <= seen.sum() < FRAMES
    assert not refused_by_a_fit(read_set(tmp_path))


def of_twelve(bad: RecordingSet) -> RecordingSet:
    """A set of twelve recordings one of which is bad."""
    others = tuple(one(f"push_{k:02d}.csv", k) for k in range(2, 13))
    return replace(bad, recordings=(bad.recordings[1], *others))


@pytest.mark.parametrize("bad", [unseen_probe, begins_inside])
def test_one_bad_file_of_twelve_is_left_out_told_and_counted(bad: object) -> None:
    assert callable(bad)

    left = usable_set(of_twelve(bad()))

    assert MIDDLE not in {each.file for each in left.recordings.recordings}
    assert len(left.recordings.recordings) == 11
    assert left.warnings[0] == f"1 of 12 recordings left out: {MIDDLE}"
    assert not refused_by_a_fit(of_twelve(bad()))


def test_a_broken_file_of_twelve_does_not_refuse_the_set(tmp_path: Path) -> None:
    write_set(tmp_path / "set", of_twelve(clean()))
    (tmp_path / "set" / MIDDLE).write_text("time_s\n1\n")

    found = read_recordings(tmp_path / "set")

    assert found.verdict == "USABLE WITH CARE"
    given = given_of(tmp_path / "set").usable()
    assert given.warnings[0] == f"1 of 12 recordings left out: {MIDDLE}"
    for file in (tmp_path / "set").glob("*.csv"):
        file.write_text("time_s\n1\n")
    with pytest.raises(InputError, match="no recording can be read"):
        given_of(tmp_path / "set")


def test_one_late_stamp_leaves_out_its_row(tmp_path: Path) -> None:
    middle = clean().recordings[1]
    times = middle.times.copy()
    times[60] += 0.02
    late = replace(clean(), recordings=(clean().recordings[0], replace(middle, times=times)))

    left = usable_set(late)

    assert [(each.kind, each.rows) for each in left.left_out] == [("late_stamp", (62,))]
    row = left.recordings.recordings[1]
    assert np.isnan(row.poses[60]).all()
    assert np.isnan(row.probes[60]).all()
    assert np.isfinite(row.probes[[59, 61]]).all()
    # later than the next row, it is no clock any more; reading leaves the row out
    write_set(tmp_path, clean())
    lines = (tmp_path / MIDDLE).read_text().splitlines()
    cells = lines[61].split(",")
    lines[61] = ",".join([repr(float(cells[0]) + 0.05), *cells[1:]])
    (tmp_path / MIDDLE).write_text("\n".join(lines) + "\n")
    given = given_of(tmp_path).usable()
    left_out = {(each.kind, each.rows) for each in given.left_out}
    assert left_out == {("clock", (63,)), ("late_stamp", (62,))}


def test_a_tip_a_little_inside_the_part_is_a_sign_and_no_refusal() -> None:
    middle = clean().recordings[1]
    tips = middle.probes.copy()
    tips[:, 0, 0] += 144 * UM  # 44 um inside at first
    recordings = planted(probes=tips)

    left = usable_set(recordings)

    assert len(left.recordings.recordings) == 3
    assert any("µm inside the part" in line and "registration" in line for line in left.warnings)
    assert not refused_by_a_fit(recordings)


def test_a_refusal_names_the_likely_cause() -> None:
    mirrored = tuple(
        replace(each, poses=each.poses * [1.0, -1.0, -1.0])
        for each in made(Kind(seed=3)).recordings
    )
    with pytest.raises(InputError, match="likely cause: y of the tips has the other sign"):
        usable_set(replace(made(Kind(seed=3)), recordings=mirrored))


@pytest.mark.parametrize("bad", [zeros, frozen, leap])
def test_poses_that_are_no_measurements_are_mended_without_losing_the_recording(
    bad: object, tmp_path: Path
) -> None:
    assert callable(bad)
    write_set(tmp_path, bad())

    mended = checked(tmp_path, None, repair=True)

    assert [each.file for each in mended.recordings.recordings] == list(FILES)
    assert mended.verdict == "CLEAN"
    assert not refused_by_a_fit(mended.recordings)


def test_identify_may_fit_noise_that_nobody_knows() -> None:
    (warning,) = {
        line.split(":")[2].strip()
        for line in usable_set(noiseless_two_poses(), allowed=NOISE_IS_FITTED).warnings
        if line.startswith("error")
    }

    assert warning == "unknown noise"


@pytest.mark.skipif(not REAL.is_dir(), reason="the public recordings are not here")
@pytest.mark.parametrize(
    "folder",
    by_day(2, ["mit_plywood", "cmu_two_finger/tri_0_0_90",
     "cmu_support_points/patch", "cmu_two_finger/bigrect_3pts_20_neg30_90"]),
)  # fmt: skip
def test_real_sets_are_judged_as_a_diagnosis_takes_them(folder: str) -> None:
    found = checked(REAL / folder, None, repair=False)

    usable = found.verdict != "NOT USABLE AS IT IS"
    assert usable == (not refused_by_a_fit(found.recordings))


def test_same_recording_under_two_names_is_told_wherever_the_set_goes(tmp_path: Path) -> None:
    first, _, last = clean().recordings
    write_set(tmp_path, clean(recordings=(first, replace(first, file=MIDDLE), last)))

    (warning,) = usable_set(read_set(tmp_path)).warnings

    assert warning.startswith(f"warning: {MIDDLE}: the same push twice: ")
    assert FILES[0] in warning
    assert checked(tmp_path, None, repair=False).verdict == "USABLE WITH CARE"


def test_a_copy_that_begins_later_on_a_clock_of_its_own_is_still_one() -> None:
    first, _, last = clean().recordings
    later = replace(
        first, file=MIDDLE, times=first.times[60:] + 5.0, poses=first.poses[60:],
        probes=first.probes[60:],
    )  # fmt: skip

    found = problems(clean(recordings=(first, later, last)))

    assert [(p.kind, p.file) for p in found if p.severity != "information"] == [("copy", MIDDLE)]


def test_two_trials_of_one_push_are_no_copies() -> None:
    """The same commands, the same way of the part, noise of their own."""
    assert not problems(clean(recordings=tuple(one(file, k) for k, file in enumerate(FILES))))


def test_orientation_among_likes_is_a_warning_that_travels_with_the_set(tmp_path: Path) -> None:
    first, middle, last = clean().recordings
    unsure = clean(recordings=(first, replace(middle, alike_orientations=2), last))
    write_set(tmp_path / "a", unsure)
    write_set(tmp_path / "b", read_set(tmp_path / "a"))

    found = checked(tmp_path / "b", None, repair=False)

    assert "alike_orientations = 2" in (tmp_path / "b" / "set.toml").read_text()
    assert found.verdict == "USABLE WITH CARE"
    (warning,) = usable_set(read_set(tmp_path / "b")).warnings
    assert "up to 180°" in warning
    assert warning.startswith(f"warning: {MIDDLE}: ")


def near_zero(recordings: RecordingSet, angle: float) -> RecordingSet:
    """The set in a world turned so that every recording begins at an angle (rad)."""
    turned = []
    for each in recordings.recordings:
        first = each.poses[np.flatnonzero(np.isfinite(each.poses[:, 2]))[0], 2]
        cos, sin = np.cos(angle - first), np.sin(angle - first)
        turn = np.array([[cos, sin], [-sin, cos]])
        seen = each.poses.copy()
        seen[:, :2] = seen[:, :2] @ turn
        seen[:, 2] += angle - first
        turned.append(replace(each, poses=seen, probes=each.probes @ turn))
    return replace(recordings, recordings=tuple(turned))


def in_rad(recordings: RecordingSet) -> RecordingSet:
    """The set as it is read if its columns of degrees hold radians."""
    factor = np.array([1.0, 1.0, np.pi / 180.0])
    return replace(
        recordings,
        recordings=tuple(
            replace(each, poses=each.poses * factor) for each in recordings.recordings
        ),
    )


@pytest.mark.parametrize("seed", by_day(2, range(6)))
@pytest.mark.parametrize("seen_tips", [False, True])
def test_radians_in_the_column_of_degrees_are_found_at_small_angles(
    seed: int, seen_tips: bool
) -> None:
    """Where 57 times less leaves a tip within a tenth of the part of its outline."""
    right = near_zero(made(Kind(seed=seed, wrapped=False, seen_tips=seen_tips)), 0.2)

    assert not [p for p in problems(right) if p.severity != "information"]
    units = [p for p in problems(in_rad(right)) if p.kind == "units"]
    assert units
    assert "θ in rad: factor 57.29578" in units[0].advice
    with pytest.raises(InputError, match="θ in rad"):
        usable_set(in_rad(right))


def test_noise_is_told_apart_into_repeatability_and_systematic_error(tmp_path: Path) -> None:
    """A camera that scatters by 0.05 um on an outline that is wrong by 0.6 um."""
    rng = np.random.default_rng(5)
    scatter = np.array([0.05 * UM, 0.05 * UM, np.radians(0.002)])
    quiet = tuple(
        replace(
            each,
            poses=each.poses + scatter * rng.normal(size=each.poses.shape),
        )
        for each in (one(file, noise=0.0) for file in FILES)
    )
    stated = SensorInfo(
        frame_rate=RATE, position_sigma=0.6 * UM, orientation_sigma=float(np.radians(0.02))
    )
    recordings = clean(recordings=quiet, sensor=stated)

    answer = read_recordings_of(recordings, tmp_path)

    noise = answer.document["noise"]
    assert noise["position_sigma_um"] == pytest.approx(0.6)
    assert noise["position_repeatability_um"] == pytest.approx(0.05, rel=0.2)
    assert noise["position_systematic_um"] == pytest.approx(np.sqrt(0.36 - 0.0025), rel=0.01)
    page = answer.files()["report.html"]
    assert "repeatability, from still frames" in page
    assert "systematic error" in page
    assert noise_of(recordings).repeatability == pytest.approx(0.05 / 0.6, rel=0.25)
    assert not [p for p in problems(recordings) if p.severity != "information"]


def read_recordings_of(recordings: RecordingSet, folder: Path) -> Recordings:
    write_set(folder / "set", recordings)
    return read_recordings(folder / "set")
