"""The loop in the virtual laboratory: a plan that is proved, carried out, and everything that goes wrong."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meso_robust.api.drive import Driver, drive
from meso_robust.live.conductor import Conductor
from meso_robust.live.exchange import Command
from meso_robust.live.journal import Header, Journal, Turn, read_journal, replayed
from meso_robust.live.lab_file import Lab, VirtualSection, WatchSection
from meso_robust.live.loop import Words, run_loop
from meso_robust.live.preflight import check_lab, trust_of
from meso_robust.live.session import eye_of
from meso_robust.live.virtual import VirtualLaboratory, then
from meso_robust.live.virtual_bench import UNPACED, lab_of, laboratory_of
from meso_robust.planning.compose import compose
from meso_robust.planning.document import plan_document
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task, load_task
from meso_robust.tasks import MICROSCOPE
from tests.nightly import at_night

UM = 1e-6


@cache
def task() -> Task:
    return load_task(MICROSCOPE)


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A plan of the task, as ``meso-robust plan`` writes it."""
    path = tmp_path_factory.mktemp("plan") / "plan.json"
    rules = compose(task()).rules
    setup = setup_of(task())
    poses = [np.array(setup.start.mid)] * len(rules)
    document = plan_document(task(), rules, poses, [None] * len(rules))
    path.write_text(document.model_dump_json(by_alias=True), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def driver(plan: Path) -> Driver:
    return drive(task(), plan)


def slow_lab(seed: int = 0, **virtual: Any) -> Lab:
    """Five frames a second are enough, and quicker."""
    made = lab_of(task(), "-x", VirtualSection(seed=seed, frame_rate_hz=5.0, **virtual))
    watch = WatchSection(max_age_ms=500.0, max_latency_ms=UNPACED, patience_s=3.0)
    return made.model_copy(update={"watch": watch})


class Run:
    """One run, and the truth about it."""

    def __init__(
        self, driver: Driver, lab: Lab, words: Words | None = None, most: int = 10**6
    ) -> None:
        check_lab(task(), lab, "lab")
        self.header = Header(
            task_hash=task().hash, plan_hash="", lab=lab, trust=trust_of(task()), confirm=False, dry=False,
            version="", started="",
        )  # fmt: skip
        self.laboratory: VirtualLaboratory = laboratory_of(task(), lab)
        self.conductor = Conductor(lab, driver.answer, trust_of(task()))
        self.poses: dict[str, list[np.ndarray[Any, Any]]] = {}
        self.journal = Journal(None, self.header)
        self.words = Words() if words is None else words
        self.left = most

        def noted(_: object) -> None:
            self.poses.setdefault(self.conductor.phase, []).append(self.laboratory.pose)
            self.left -= 1
            if self.left == 0:
                self.words.say("stop")

        self.ending: Command = run_loop(
            self.laboratory.devices(), lab, eye_of(task(), self.header), self.conductor, self.journal,
            self.words, noted,
        )  # fmt: skip

    @property
    def turns(self) -> list[Turn]:
        return self.journal.turns

    @property
    def lifted(self) -> bool:
        return all(one.status().height == pytest.approx(300.0 * UM) for one in self.laboratory.manipulators.values())  # fmt: skip


def fresh(driver: Driver) -> Driver:
    """The same plan from its beginning: a refusal ends the part that went before."""
    driver.answer(9e5, 9e5, 0.0)
    return driver


@pytest.fixture(scope="module")
def good(driver: Driver) -> Run:
    return Run(fresh(driver), slow_lab(3))


def within(pose: np.ndarray[Any, Any], expect: Mapping[str, Any], slack: float = 2.0) -> bool:
    """Whether a true pose lies in a certified box; slack: um that the plant is soft by."""
    shown = [pose[0], pose[1], np.degrees(pose[2])]
    sides = [expect["x_um"], expect["y_um"], expect["theta_deg"]]
    room = [slack, slack, 0.05]
    return all(
        low - r <= v <= high + r for v, (low, high), r in zip(shown, sides, room, strict=True)
    )


def test_a_proved_plan_brings_the_part_into_the_goal(good: Run) -> None:
    assert good.ending.outcome == "done"
    goal = setup_of(task()).goal
    x, y, theta = good.laboratory.pose
    assert goal.x.lo <= x * UM <= goal.x.hi
    assert goal.y.lo <= y * UM <= goal.y.hi
    assert goal.theta.lo <= theta <= goal.theta.hi
    assert good.lifted
    assert not good.laboratory.landed
    assert not good.laboratory.stuck


def test_after_every_move_the_part_lies_where_the_certificate_says(good: Run) -> None:
    moves = [turn.move for turn in good.turns if turn.move is not None]
    assert len(moves) == 4
    after = [k for k, turn in enumerate(good.turns) if turn.phase == "seeing" and good.turns[k - 1].phase == "raising"]  # fmt: skip
    poses = [good.laboratory.pose_at(good.turns[k].reading.time) for k in after]
    for move, pose in zip(moves, poses, strict=True):
        assert within(pose, move["expect"]), move["primitive"]


def test_what_is_seen_is_true_within_what_the_task_states(good: Run) -> None:
    checked = 0
    for turn in good.turns:
        seen = turn.reading.seen
        if turn.sensed is not None and seen is not None and seen.sight.pose is not None:
            true = good.laboratory.pose_at(seen.time)
            off = np.abs(np.array(seen.sight.pose)[:2] - true[:2])
            assert off.max() < task().uncertainty.sensed_position_um
            checked += 1
    assert checked == 4


def test_the_part_moves_only_while_it_is_pushed(good: Run) -> None:
    phases = [turn.phase for turn in good.turns]
    truth = [good.laboratory.pose_at(turn.reading.time) for turn in good.turns]
    for before, after, a, b in zip(phases, phases[1:], truth, truth[1:], strict=False):
        if "pushing" not in (before, after):
            assert np.abs(b - a)[:2].max() < 0.1, (before, after)


def test_a_journal_is_decided_again_to_the_last_bit(
    good: Run, driver: Driver, tmp_path: Path
) -> None:
    path = tmp_path / "journal.jsonl"
    kept = Journal(path, good.header)
    for turn in good.turns:
        kept.add(turn)
    kept.close()
    header, turns = read_journal(path)

    assert replayed(header, turns, fresh(driver).answer) is None

    lines = path.read_text(encoding="utf-8").split("\n")
    at = next(k for k, line in enumerate(lines) if '"do": "go"' in line)
    values = json.loads(lines[at])
    values["commands"][0]["x_um"] = np.nextafter(values["commands"][0]["x_um"], 1e9)
    lines[at] = json.dumps(values)
    path.write_text("\n".join(lines), encoding="utf-8")
    assert replayed(*read_journal(path), fresh(driver).answer) == at


def test_the_pushes_are_a_recording_set(good: Run, tmp_path: Path) -> None:
    from meso_robust.laboratory.filming import recorded_part
    from meso_robust.live.recorder import recordings_of
    from meso_robust.recordings import read_set, write_set

    made = recordings_of(good.header, good.turns, recorded_part(task().part))
    assert made is not None
    write_set(tmp_path, made)
    again = read_set(tmp_path)
    assert [one.file for one in again.recordings] == [f"move_{k:02d}.csv" for k in (1, 2, 3, 4)]
    assert again.recordings[2].probe_names == ("dtp_top", "dtp_bottom", "stp")
    tips = again.recordings[0].probes[:, 0]
    way = tips[np.isfinite(tips[:, 0])]
    # the last frame before the tips are lifted may be 0.2 s old, at 75 um/s
    assert way[-1, 0] - way[0, 0] == pytest.approx(-185.2e-6, abs=16e-6)


def test_a_camera_that_is_late_shows_what_was_between_two_known_instants() -> None:
    past = [
        (1.0, np.array([0.0, 10.0, 0.1]), {"stp": np.array([5.0, 0.0])}),
        (1.2, np.array([2.0, 14.0, 0.3]), {"stp": np.array([7.0, 1.0]), "dtp_top": np.zeros(2)}),
    ]
    pose, tips = then(past, 1.05)
    assert pose == pytest.approx([0.5, 11.0, 0.15])
    assert list(tips) == ["stp"]
    assert tips["stp"] == pytest.approx([5.5, 0.25])
    for at, expected in ((0.9, 0), (1.0, 0), (1.2, 1), (9.0, 1)):
        pose, tips = then(past, at)
        assert np.all(pose == past[expected][1])
        assert set(tips) == (set() if at < 1.0 else set(past[expected][2]))


FAULTS: Mapping[str, tuple[Mapping[str, float], str]] = {
    "no part": ({"absent": 1.0}, "refused"),
    "frames are lost": ({"lost_from_s": 4.0}, "fault"),
    "frames are lost before anything": ({"lost_from_s": 0.0}, "refused"),
    "the camera freezes": ({"frozen_from_s": 4.0}, "fault"),
    "a manipulator stops short": ({"short_um": 30.0}, "fault"),
    "a manipulator stalls": ({"stalls_from_s": 4.0}, "fault"),
    "the stage moves": ({"stage_moves_at_s": 4.0}, "fault"),
    "the part is kicked while probes are placed": ({"kicked_at_s": 2.0}, "refused"),
    "a probe cannot be lifted": ({"lift_fails_from_s": 4.0}, "fault"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_ends_it_with_the_probes_lifted_and_no_move_more(name: str, driver: Driver) -> None:
    faults, outcome = FAULTS[name]
    run = Run(fresh(driver), slow_lab(1, faults=faults))
    assert run.ending.outcome == outcome, run.ending.text
    assert run.lifted or "lift by hand" in run.ending.text
    gone = [c for turn in run.turns for c in turn.commands if c["do"] == "go"]
    decided = [turn for turn in run.turns if turn.sensed is not None]
    # at most: placed once, pushed once, by what was decided; nothing after the fault
    assert len(gone) <= 2 * len(decided) <= 2
    assert not run.laboratory.landed


def test_a_part_outside_of_the_certified_starts_is_not_touched(driver: Driver) -> None:
    lab = slow_lab(1, part=(1500.0, 300.0, 70.0))
    run = Run(fresh(driver), lab)
    assert run.ending.outcome == "refused"
    assert "outside the certified starts" in run.ending.text
    assert [c for turn in run.turns for c in turn.commands if c["do"] == "go"] == []


@pytest.mark.parametrize("turns", [3, 25, 60])
def test_a_stop_at_any_time_lifts_the_probes(turns: int, driver: Driver) -> None:
    run = Run(fresh(driver), slow_lab(1), most=turns)
    assert run.ending.outcome == "stopped"
    assert run.lifted


@at_night
def test_a_killed_run_leaves_a_journal_and_the_next_one_begins_with_lifting(
    plan: Path, driver: Driver, tmp_path: Path
) -> None:
    program = (
        "import sys; from meso_robust.cli import main; "
        f"sys.argv = ['meso-robust', 'run', {str(MICROSCOPE)!r}, {str(plan)!r}, '--yes', "
        f"'--out', {str(tmp_path)!r}]; main()"
    )
    process = subprocess.Popen([sys.executable, "-c", program], stderr=subprocess.DEVNULL)
    draft = tmp_path / "journal.jsonl.part"
    end = time.monotonic() + 240.0
    while time.monotonic() < end and process.poll() is None:
        if draft.exists() and draft.read_text(encoding="utf-8").count('"phase": "pushing"') > 3:
            break
        time.sleep(0.1)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()

    header, turns = read_journal(draft)
    assert turns[-1].phase == "pushing"
    assert replayed(header, turns, fresh(driver).answer) is None
    assert sorted(path.name for path in tmp_path.iterdir()) == ["journal.jsonl.part"]

    # the part lies wherever the killed push has left it, which no plan was proved from
    pose = turns[-1].reading.seen
    assert pose is not None
    assert pose.sight.pose is not None
    x, y, theta = pose.sight.pose
    again = Run(fresh(driver), slow_lab(0, part=(x - 60.0, y - 20.0, theta + 3.0)))
    assert [c["do"] for c in again.turns[0].commands] == ["halt", "lift", "lift"]
    assert again.ending.outcome == "refused"
    assert [c for turn in again.turns for c in turn.commands if c["do"] == "go"] == []
