"""A recording in numbers and phases, and summary.json."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from meso_robust.recordings.phases import Phase, phases
from meso_robust.recordings.problem import KINDS
from meso_robust.recordings.problems import problems
from meso_robust.recordings.summary import SCHEMA, Checked, answer, document, summary
from tests.recordings.planted import BACK, FRAMES, RATE, STEP, TOUCH, UM, clean, one, planted, poses


def as_checked(**changes: object) -> Checked:
    recordings = clean()
    found = problems(recordings)
    given = {
        "source": "folder",
        "format": "set",
        "recordings": recordings,
        "found": found,
        "repairs": (),
        "remaining": found,
    }
    return Checked(**{**given, **changes})  # type: ignore[arg-type]


def test_numbers_of_a_recording() -> None:
    quiet = one("a.csv", noise=0.0)
    kept = np.delete(np.arange(FRAMES), [100, 101])
    hidden = quiet.poses[kept]
    hidden[50] = np.nan
    hidden[60:, 2] -= 2 * np.pi  # wrapped
    short = replace(quiet, times=quiet.times[kept], poses=hidden, probes=quiet.probes[kept])
    (found,) = summary(clean(recordings=(short,)))
    assert found.duration == pytest.approx((FRAMES - 1) / RATE)
    assert (found.frames, found.seen, found.lost) == (FRAMES - 2, FRAMES - 3, 3)
    assert found.travel == pytest.approx((BACK - TOUCH) * STEP)
    assert found.turn == pytest.approx(0.0, abs=1e-12)
    (tip,) = found.tips
    assert tip.name == "probe1"
    assert tip.path == pytest.approx((BACK - 40 + 40) * STEP)  # forth from frame 40, 40 frames back
    assert tip.largest_speed == pytest.approx(75 * UM)
    assert tip.mean_speed == pytest.approx(BACK * STEP / found.duration)


def test_what_was_not_seen_has_no_numbers() -> None:
    quiet = one("a.csv", noise=0.0)
    blind = replace(
        quiet, poses=np.full((FRAMES, 3), np.nan), probes=np.full((FRAMES, 1, 2), np.nan)
    )
    (found,) = summary(clean(recordings=(blind,)))
    assert (found.seen, found.lost, found.travel, found.turn) == (0, FRAMES, None, None)
    assert (found.tips[0].path, found.tips[0].mean_speed) == (None, None)
    assert [phase.name for phase in found.phases] == ["unknown"]


def test_phases_follow_the_tip() -> None:
    quiet = one("a.csv", noise=0.0)
    found = phases(clean(recordings=(quiet,)), quiet)
    assert [phase.name for phase in found] == ["rest", "approach", "contact", "retract", "rest"]
    # contact is within 5.66 um of the outline: two frames before the touch, two after the turn
    starts = [round(phase.start * RATE) for phase in found]
    assert starts[0] == 0
    assert abs(starts[1] - 40) <= 3
    assert starts[2] == TOUCH - 2
    assert starts[3] == BACK + 3
    assert abs(starts[4] - (BACK + 40)) <= 3
    ends = [phase.end for phase in found]
    assert ends == [*(phase.start for phase in found[1:]), quiet.times[-1]]


def test_frames_in_which_nothing_is_known_belong_to_the_phase_before() -> None:
    quiet = one("a.csv", noise=0.0)
    hidden = quiet.poses.copy()
    hidden[:10] = np.nan
    hidden[100:110] = np.nan
    found = phases(clean(recordings=(quiet,)), replace(quiet, poses=hidden))
    assert found[0] == Phase("unknown", 0.0, 10 / RATE)
    assert [phase.name for phase in found[1:]] == [
        *("rest", "approach", "contact", "retract", "rest")
    ]
    bare = replace(quiet, probe_names=(), probes=np.zeros((FRAMES, 0, 2)))
    assert [phase.name for phase in phases(clean(recordings=(bare,)), bare)] == ["rest"]


def test_the_document_is_json_and_complete() -> None:
    changed = poses()
    changed[50] = 0.0
    recordings = planted(poses=changed)
    found = problems(recordings)
    made = document(as_checked(recordings=recordings, found=found, remaining=found, notes=("n",)))
    assert json.loads(json.dumps(made, allow_nan=False)) == made
    assert (made["schema"], made["verdict"]) == (SCHEMA, "NOT USABLE AS IT IS")
    assert len(made["recordings"]) == 3
    (zero,) = made["remaining"]
    assert (zero["kind"], zero["rows"], zero["severity"]) == ("zero_pose", [52], "error")
    assert made["noise"]["position_source"] == "stated"
    assert made["noise"]["still_frames"]["x"]["sigma_um"] == pytest.approx(1.2, rel=0.15)
    assert made["recordings"][0]["noise"]["x"]["degrees_of_freedom"] > 70
    assert made["recordings"][0]["part_travel_um"] == pytest.approx(250.0, abs=6.0)
    assert made["notes"] == ["n"]


@pytest.mark.parametrize(
    ("severities", "verdict"),
    [
        ([], "CLEAN"),
        (["information"], "CLEAN"),
        (["information", "warning"], "USABLE WITH CARE"),
        (["warning", "error"], "NOT USABLE AS IT IS"),
    ],
)
def test_the_verdict_is_that_of_the_gravest_problem(severities: list[str], verdict: str) -> None:
    changed = poses()
    changed[50] = 0.0
    (zero,) = problems(planted(poses=changed))
    remaining = tuple(replace(zero, severity=each) for each in severities)  # type: ignore[arg-type]
    made = as_checked(remaining=remaining)
    assert made.verdict == verdict
    lines = answer(made).splitlines()
    assert lines[0] == f"{verdict}: 3 recordings, {3 * FRAMES} rows"
    shown = [each for each in severities if each != "information"]
    assert [line.split(":")[0] for line in lines[1 : 1 + len(shown)]] == shown


def test_long_lists_are_cut_and_say_so() -> None:
    changed = poses()
    changed[50] = 0.0
    (zero,) = problems(planted(poses=changed))
    lines = answer(as_checked(remaining=(zero,) * 30), most=5).splitlines()
    assert lines[-1].startswith("error: pose of zeros: not found: 26 times more, in 1 file; ")
    assert len(lines) == 6
    kinds = [replace(zero, kind=kind) for kind in KINDS][:7]
    assert answer(as_checked(remaining=tuple(kinds)), most=5).endswith("and 2 more, see the report")
