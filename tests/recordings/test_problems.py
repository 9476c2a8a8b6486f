"""Each kind of mistake, planted in a clean set, is found in its rows, and nothing else is."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from meso_robust.recordings import (
    Polygon,
    Recording,
    RecordingSet,
    SensorInfo,
    write_set,
)
from meso_robust.recordings.loose import read_loosely
from meso_robust.recordings.problem import KINDS, Problem, in_brief, lines_text
from meso_robust.recordings.problems import problems
from meso_robust.recordings.summary import Checked, document
from tests.recordings.planted import (
    BACK,
    FILES,
    FRAMES,
    MIDDLE,
    PART,
    RATE,
    SIGMA,
    STEP,
    TOUCH,
    TURN_SIGMA,
    UM,
    Floats,
    clean,
    one,
    planted,
    poses,
    probes,
    tip_way,
)
from tests.recordings.simulated import Kind, made

REPEATABLE = settings(derandomize=True, deadline=None, database=None, max_examples=40)


def found(recordings: RecordingSet) -> list[tuple[str, str, str, tuple[int, ...]]]:
    """Severity, kind, file and rows of each problem."""
    return [(one.severity, one.kind, one.file, one.rows) for one in problems(recordings)]


def lines(*frames: int) -> tuple[int, ...]:
    """The header is line 1, so frame 0 stands on line 2."""
    return tuple(frame + 2 for frame in frames)


def without(frames: list[int]) -> RecordingSet:
    """The set with rows of the middle recording missing."""
    middle = clean().recordings[1]
    kept = np.delete(np.arange(FRAMES), frames)
    return planted(times=middle.times[kept], poses=middle.poses[kept], probes=middle.probes[kept])


def test_a_clean_set_has_no_problem() -> None:
    assert found(clean()) == []


def test_a_few_lost_frames_are_information() -> None:
    assert found(without([50, 51, 100])) == [
        ("information", "gap", MIDDLE, lines(49, 50, 97, 98))  # two rows fewer, then three
    ]


def test_a_long_hole_is_a_warning() -> None:
    assert found(without(list(range(100, 111)))) == [("warning", "gap", MIDDLE, lines(99, 100))]
    assert found(without(list(range(100, 110)))) == [("information", "gap", MIDDLE, lines(99, 100))]


def test_rows_without_a_pose_count_as_lost() -> None:
    changed = poses()
    changed[100:111, 1] = np.nan
    assert found(planted(poses=changed)) == [("warning", "gap", MIDDLE, lines(99, 111))]


def test_most_frames_lost_is_a_warning() -> None:
    gone = [k for k in range(FRAMES) if k % 5 in (1, 2, 3)]
    ((severity, kind, _, _),) = found(without(gone))
    assert (severity, kind) == ("warning", "gap")


def test_another_frame_rate_is_named_and_milliseconds_are_guessed() -> None:
    (slow,) = problems(planted(times=np.arange(FRAMES) / 10.0))
    assert (slow.severity, slow.kind, slow.file) == ("warning", "frame_rate", MIDDLE)
    assert slow.value == "steps of 0.1 s, that is 10 Hz"
    assert "ms" not in slow.advice
    (wrong,) = problems(planted(times=1000.0 * np.arange(FRAMES) / RATE))
    assert (wrong.severity, wrong.advice) == ("error", "the clock is in ms: divide it by 1000")
    (fast,) = problems(planted(times=np.arange(FRAMES) / (1.2 * RATE)))
    assert (fast.severity, fast.kind) == ("warning", "frame_rate")
    assert not problems(planted(times=np.arange(FRAMES) / (1.02 * RATE)))


@pytest.mark.parametrize("count", [0, 1, 2, 9])
def test_too_few_frames(count: int) -> None:
    changed = poses()
    changed[count:] = np.nan
    expected = "error" if count < 2 else "warning"
    assert found(planted(poses=changed)) == [(expected, "few_frames", MIDDLE, ())]


def test_wraps_are_information_in_the_rows_after_them() -> None:
    changed = poses()
    changed[60:90, 2] += 2 * np.pi
    assert found(planted(poses=changed)) == [("information", "wrap", MIDDLE, lines(60, 90))]


def test_poses_of_zeros_are_found_alone_and_in_a_row_and_at_the_ends() -> None:
    frames = [0, 1, 50, 100, 101, 102, FRAMES - 1]
    changed = poses()
    changed[frames] = 0.0
    assert found(planted(poses=changed)) == [("error", "zero_pose", MIDDLE, lines(*frames))]


def quiet(start: tuple[float, float, float], **arrays: Floats) -> RecordingSet:
    """One recording without noise, of which nothing is stated."""
    made = replace(one(MIDDLE, noise=0.0, start=start), **arrays)  # type: ignore[arg-type]
    return clean(sensor=SensorInfo(frame_rate=RATE), recordings=(made,))


def test_a_part_without_noise_may_start_at_the_origin_and_rest() -> None:
    assert found(quiet((0.0, 0.0, 0.0))) == [("error", "noise_unknown", "set.toml", ())]


def test_nothing_but_zeros_is_not_found() -> None:
    changed = np.zeros((FRAMES, 3))
    kinds = found(planted(poses=changed))
    assert kinds == [("error", "zero_pose", MIDDLE, lines(*range(FRAMES)))]


@pytest.mark.parametrize("frames", [[30], [100], [20, 21, 22, 23], [120, 121, FRAMES - 1]])
def test_frozen_poses_are_found_and_the_first_of_them_is_kept(frames: list[int]) -> None:
    changed = poses()
    for k in frames:
        changed[k] = changed[k - 1]
    assert found(planted(poses=changed)) == [("error", "frozen", MIDDLE, lines(*frames))]


def test_a_coarse_camera_repeats_itself_by_chance() -> None:
    coarse = np.array([2 * SIGMA, 2 * SIGMA, 2 * TURN_SIGMA])
    rounded = tuple(
        replace(each, poses=np.round(each.poses / coarse) * coarse) for each in clean().recordings
    )
    repeats = np.all(np.diff(rounded[0].poses, axis=0) == 0.0, axis=1)
    assert repeats.sum() > 5
    assert found(clean(recordings=rounded)) == []


def test_without_noise_a_pose_is_frozen_if_a_tip_goes_through_it() -> None:
    start = (700 * UM, -30 * UM, np.pi / 2)
    changed = one(MIDDLE, noise=0.0, start=start).poses.copy()
    changed[100:170, 0] = changed[100, 0]
    # the tip is 2.5 um deeper each frame; it counts beyond the margin, 1/100 of the size, and the
    # way of the tip in 0.15 s
    size = np.sqrt(1600 * 800)
    first = 100 + int((0.01 * size + 0.15 * 75) // 2.5) + 1
    (frozen, *_) = problems(quiet(start, poses=changed))
    assert (frozen.kind, frozen.rows) == ("frozen", lines(*range(first, 170)))


@pytest.mark.parametrize(
    "frames", [[0], [50], [100], [100, 101, 102], [60, 150], [FRAMES - 2, FRAMES - 1]]
)
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_outliers_are_found_in_their_rows(frames: list[int], axis: int) -> None:
    changed = poses()
    changed[frames, axis] += 0.3 if axis == 2 else 60 * UM
    assert found(planted(poses=changed)) == [("error", "outlier", MIDDLE, lines(*frames))]


def test_a_jump_that_lasts_is_an_error_in_the_row_after_it() -> None:
    changed = poses()
    changed[210:, 1] += 60 * UM
    assert found(planted(poses=changed)) == [("error", "jump", MIDDLE, lines(210))]


def test_half_a_turn_of_a_symmetric_part_is_named() -> None:
    changed = poses()
    changed[150:, 2] -= np.pi
    (jump,) = problems(planted(poses=changed))
    assert (jump.severity, jump.kind, jump.rows) == ("error", "jump", lines(150))
    assert "symmetric part by 180°" in jump.advice


@pytest.mark.parametrize("axis", [1, 2])
def test_an_image_that_shakes_is_a_warning_and_its_contact_is_judged(axis: int) -> None:
    changed = poses()
    changed[::2, axis] += 0.15 if axis == 2 else 60 * UM
    every = problems(planted(poses=changed))
    (shaken,) = (one for one in every if one.kind == "shake")
    assert len(shaken.rows) == FRAMES - 1
    assert f"{FRAMES - 1} of {FRAMES} frames" in shaken.value
    assert {one.severity for one in every} == {"warning"}


def test_a_recording_of_nothing_but_jumps_is_one_error() -> None:
    changed = poses()
    changed[::2, 1] += 500 * UM
    ((severity, kind, _, rows), *rest) = found(planted(poses=changed))
    assert (severity, kind, len(rows)) == ("error", "jump", FRAMES - 1)
    assert all(kind != "jump" for _, kind, _, _ in rest)


def test_a_part_that_moves_untouched() -> None:
    """From half a frame after the tip left by more than the margin and a camera's lag."""
    changed = poses()
    free = np.arange(FRAMES) - (BACK + 20)
    changed[:, 1] += np.clip(free, 0, 20) * UM
    ((severity, kind, _, rows),) = found(planted(poses=changed))
    assert (severity, kind) == ("warning", "untouched")
    # the tip is off by 11.3 um, 1/100 of the size, 5 frames after it turned, and 0.15 s are 5 more
    assert rows == lines(*range(BACK + 5 + 5, FRAMES))


def test_a_part_dragged_along_behind_a_tip_that_left() -> None:
    changed = poses()
    changed[:, 0] -= np.clip(np.arange(FRAMES) - (BACK + 10), 0, 30) * STEP
    kinds = {(kind, rows[-1]) for _, kind, _, rows in found(planted(poses=changed))}
    assert kinds == {("untouched", FRAMES + 1)}


@pytest.mark.parametrize(("depth", "severity"), [(270.0, "warning"), (295.0, "error")])
def test_a_tip_deep_inside_the_part(depth: float, severity: str) -> None:
    """Its centre, which is a radius behind the surface; a quarter of the size is 283 um."""
    changed = probes()
    changed[130:140, 0, 0] += (depth + 12.5) * UM
    expected = [(severity, "overlap", MIDDLE, lines(*range(130, 140)))]
    assert found(planted(probes=changed)) == expected


def test_a_recording_that_is_never_touched() -> None:
    still = clean().recordings[0].poses.copy()
    still[:, 0] -= np.maximum.accumulate(np.maximum(tip_way(), 0.0))
    changed = probes()
    changed[..., 1] += 1000 * UM  # past the end of the part
    assert found(planted(poses=still, probes=changed)) == [("warning", "never_touched", MIDDLE, ())]


def test_a_recording_in_which_nothing_moves() -> None:
    still = clean().recordings[0].poses.copy()
    still[:, 0] -= np.maximum.accumulate(np.maximum(tip_way(), 0.0))
    changed = probes()
    changed[..., 0] = np.minimum(changed[..., 0], changed[TOUCH, 0, 0])
    assert found(planted(poses=still, probes=changed)) == [("warning", "nothing_moves", MIDDLE, ())]


def test_probes_that_rest_or_are_not_there() -> None:
    middle = clean().recordings[1]
    passive = np.broadcast_to(np.array([5e-3, 0.0]), (FRAMES, 1, 2))
    both = np.concatenate((middle.probes, passive), axis=1)
    changed = replace(middle, probes=both, probe_names=("probe1", "holder"))
    assert found(clean(recordings=(changed,))) == [("information", "still_probe", MIDDLE, ())]
    both[:, 1] = np.nan
    changed = replace(middle, probes=both, probe_names=("probe1", "holder"))
    assert ("error", "unseen_probe", MIDDLE, ()) in found(clean(recordings=(changed,)))
    still = np.broadcast_to(middle.probes[:1], middle.probes.shape)
    kinds = {kind for _, kind, _, _ in found(planted(probes=still))}
    assert "still_probe" in kinds


UNITS = {
    "mm": ((1e-3, 1.0, 1e-3, 1.0), "part and probes in mm: factor 1000;"),
    "m": ((1e-6, 1.0, 1e-6, 1.0), "part and probes in m: factor 1e+06;"),
    "rad": ((1.0, np.pi / 180, 1.0, 1.0), "θ in rad: factor 57.29578;"),
    "m and rad": ((1e-6, np.pi / 180, 1e-6, 1.0), "factor 1e+06, and θ in rad: factor 57.29578;"),
    "part in mm": ((1e-3, 1.0, 1.0, 1.0), "part_x_um and part_y_um in mm: factor 1000;"),
    "probes in m": ((1.0, 1.0, 1e-6, 1.0), "positions of the probes in m: factor 1e+06;"),
    "outline in mm": ((1.0, 1.0, 1.0, 1e-3), "outline in set.toml in mm: factor 1000;"),
}


@pytest.mark.parametrize(("factors", "words"), UNITS.values(), ids=UNITS.keys())
def test_wrong_units_are_named_with_their_factor_and_hide_what_follows_from_them(
    factors: tuple[float, float, float, float], words: str
) -> None:
    place, angle, tip, outline = factors
    part = replace(PART, length=outline * PART.length, width=outline * PART.width)
    changed = tuple(
        replace(each, poses=each.poses * [place, place, angle], probes=each.probes * tip)
        for each in clean().recordings
    )
    made = problems(clean(part=part, tip_radius=outline * 12.5 * UM, recordings=changed))
    assert [(one.severity, one.kind, one.file) for one in made] == [
        ("error", "units", file) for file in FILES
    ]
    assert all(words in one.advice for one in made)


def test_where_units_are_wrong_noise_is_not_judged() -> None:
    middle = clean().recordings[1]
    made = planted(poses=middle.poses * [1e-3, 1e-3, 1.0], probes=middle.probes * 1e-3)
    sensor = replace(made.sensor, position_sigma=10 * SIGMA)
    assert {one.kind for one in problems(clean(sensor=sensor))} == {"noise"}
    assert {one.kind for one in problems(replace(made, sensor=sensor))} == {"units"}


def test_a_tip_near_the_reference_point_is_no_sign_of_a_small_outline() -> None:
    """The part moves while the tip is 0.35 sizes away; a huge outline would be near it."""
    corners = np.array([[-800.0, -800], [800, -800], [800, 0], [-800, 0]]) * UM
    kinds = {one.kind for one in problems(clean(part=Polygon(corners=corners)))}
    assert "untouched" in kinds
    assert "units" not in kinds


def test_a_force_that_is_not_zero_at_rest() -> None:
    rng = np.random.default_rng(3)
    forces = rng.normal(scale=0.5e-6, size=(FRAMES, 1, 2))
    forces[TOUCH:BACK, 0, 0] += 40e-6
    assert found(planted(forces=forces)) == []
    forces[:, 0, 1] -= 3e-6
    (offset,) = problems(planted(forces=forces))
    assert (offset.severity, offset.kind, offset.file) == ("warning", "force_offset", MIDDLE)
    assert "-2.9" in offset.value or "-3" in offset.value


@pytest.mark.parametrize(
    ("stated", "severity", "keys"),
    [
        # a tracker's errors may stay from frame to frame, where no scatter shows them
        ((SIGMA * 3.5, None), "information", ["position_sigma_um"]),
        ((SIGMA / 3.5, TURN_SIGMA), "warning", ["position_sigma_um"]),
        ((SIGMA * 2, TURN_SIGMA / 4), "warning", ["orientation_sigma_deg"]),
        ((0.0, 0.0), "warning", ["position_sigma_um", "orientation_sigma_deg"]),
        ((None, None), "", []),
    ],
)
def test_noise_that_is_not_as_stated(
    stated: tuple[float | None, float | None], severity: str, keys: list[str]
) -> None:
    sensor = SensorInfo(frame_rate=RATE, position_sigma=stated[0], orientation_sigma=stated[1])
    made = problems(clean(sensor=sensor))
    assert [(one.severity, one.kind, one.file) for one in made] == [
        (severity, "noise", "set.toml")
    ] * len(keys)
    assert [one.value.split(" ")[0] for one in made] == keys


def test_lines_are_those_of_the_file_where_rows_were_left_out(tmp_path: Path) -> None:
    changed = poses()
    changed[100] = 0.0
    write_set(tmp_path, planted(poses=changed))
    rows = (tmp_path / MIDDLE).read_text().splitlines()
    rows.insert(10, rows[9])  # the clock repeats
    (tmp_path / MIDDLE).write_text("\n".join(rows) + "\n")
    read = read_loosely(tmp_path)
    assert [(one.kind, one.rows) for one in read.problems] == [("clock", (11,))]
    (zero,) = problems(read.recordings, read.lines)
    assert (zero.kind, zero.rows) == ("zero_pose", (103,))


def test_a_problem_says_where_what_rule_and_advice() -> None:
    one = Problem(
        file="a.csv",
        kind="gap",
        severity="warning",
        rows=(3, 4, 5, 9),
        value="v",
        rule="r",
        advice="a",
    )
    assert str(one) == "warning: a.csv, lines 3-5, 9: missing frames: v; r; a"
    assert str(replace(one, rows=())) == "warning: a.csv: missing frames: v; r; a"
    assert lines_text((7,)) == "line 7"
    assert lines_text(tuple(range(2, 30, 2)), most=3) == "lines 2, 4, 6 and 11 more places"


def test_every_kind_has_words() -> None:
    sources = Path(__file__).parents[2] / "meso_robust" / "recordings"
    text = "".join(path.read_text(encoding="utf-8") for path in sources.rglob("*.py"))
    for kind in KINDS:
        assert text.count(f'"{kind}"') >= 2, kind


@st.composite
def kinds(draw: st.DrawFn) -> Kind:
    """Clean sets of many kinds."""
    return Kind(
        seed=draw(st.integers(0, 10**6)),
        outline=draw(st.integers(0, 2)),
        tips=draw(st.integers(1, 2)),
        radius=draw(st.sampled_from([0.0, 12.5, 60.0])) * UM,
        speed=draw(st.floats(40.0, 300.0)) * UM,
        position_sigma=draw(st.sampled_from([0.0, 0.1, 1.2, 3.0])) * UM,
        orientation_sigma=draw(st.sampled_from([0.0, 2e-4, 1.4e-3, 4e-3])),
        correlation_time=draw(st.sampled_from([0.0, 0.1])),
        dropout=draw(st.floats(0.0, 0.2)),
        latency_ms=draw(st.floats(0.0, 80.0)),
        seen_tips=draw(st.booleans()),
        stated=draw(st.booleans()),
        wrapped=draw(st.booleans()),
    )


@REPEATABLE
@given(kinds())
def test_clean_simulated_sets_of_many_kinds_have_no_problem(kind: Kind) -> None:
    others = [one for one in problems(made(kind)) if one.severity != "information"]
    noiseless = not (kind.position_sigma and kind.orientation_sigma)
    assert [str(one) for one in others if one.kind != "noise_unknown" or not noiseless] == []


@pytest.mark.parametrize("seed", range(60))
def test_no_set_is_too_wild_to_be_checked_and_written_down(seed: int) -> None:
    """Any warning of NumPy would be an error here."""
    rng = np.random.default_rng(seed)
    times = np.unique(rng.normal(size=rng.integers(1, 40)) * 10.0 ** rng.integers(-300, 14))
    tips = int(rng.integers(0, 3))

    def values(*shape: int) -> Floats:
        drawn = rng.normal(size=shape) * 10.0 ** rng.integers(-12, 9)
        drawn[rng.random(shape) < rng.choice([0.0, 0.2, 1.0])] = rng.choice([0.0, np.nan])
        return np.asarray(drawn)

    wild = Recording(
        file=MIDDLE,
        probe_names=("a", "b")[:tips],
        times=times,
        poses=values(times.size, 3),
        probes=values(times.size, tips, 2),
        forces=values(times.size, tips, 2) if tips else None,
    )
    recordings = clean(recordings=(wild,))
    made = problems(recordings)
    checked = Checked(
        source="s",
        format="set",
        recordings=recordings,
        found=made,
        repairs=(),
        remaining=made,
    )
    assert json.dumps(document(checked), allow_nan=False)
    assert all(0 < row - 1 <= times.size for each in made for row in each.rows)


def test_of_many_problems_of_a_kind_the_first_are_told_and_the_others_counted() -> None:
    made = [
        Problem(
            file=f"push_{k // 2}.csv",
            kind=kind,
            severity="warning",
            value=f"{k}",
            rule="r",
            advice="a",
        )
        for k, kind in enumerate(["jump"] * 5 + ["gap"] * 9)
    ]
    told = in_brief(made)
    assert told[:5] == tuple(map(str, made[:5]))
    assert told[5:9] == tuple(map(str, made[5:9]))
    assert told[9:] == (
        "warning: missing frames: 5 times more, in 3 files; the report on the recordings lists all",
    )
