"""``meso-robust drive`` as a laboratory meets it: a process, lines in, lines out."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meso_robust.planning.document import MoveDocument
from meso_robust.policy.cells import Policy
from meso_robust.policy.document import policy_document
from meso_robust.simulator import Outcome, Push, simulate
from meso_robust.tasks import PAPER
from tests.nightly import at_night
from tests.policy.small import from_starts
from tests.strategies import paper_task

PLAN = Path(__file__).parents[2] / "reports" / "paper_task" / "plan.json"
START = {"x_um": 2060.4, "y_um": -9.2, "theta_deg": 90.0}
FAR = (
    {"x_um": 900.0, "y_um": 800.0, "theta_deg": 181.0},
    {"x_um": 1500.0, "y_um": -1200.0, "theta_deg": 178.0},
)
"""Two moves from the goal of the paper's task."""
LIMIT_S = 0.05  # of an answer, as the contract states it


class Drive:
    """A running ``drive``."""

    def __init__(self, *words: object) -> None:
        code = "import sys; from meso_robust.cli import main; sys.exit(main())"
        self.process = subprocess.Popen(
            [sys.executable, "-c", code, "drive", *map(str, words)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        self.seconds: list[float] = []

    def say(self, line: object) -> dict[str, Any]:
        """Send a line, return the answer."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        before = time.perf_counter()
        self.process.stdin.write((line if isinstance(line, str) else json.dumps(line)) + "\n")
        self.process.stdin.flush()
        answer: dict[str, Any] = json.loads(self.process.stdout.readline())
        self.seconds.append(time.perf_counter() - before)
        return answer

    def end(self) -> int:
        """Close the input and wait."""
        assert self.process.stdin is not None
        self.process.stdin.close()
        return self.process.wait(timeout=30)


@contextmanager
def driving(*words: object) -> Iterator[Drive]:
    drive = Drive(*words)
    try:
        yield drive
    finally:
        drive.process.kill()
        drive.process.wait()
        for stream in (drive.process.stdin, drive.process.stdout, drive.process.stderr):
            assert stream is not None
            stream.close()


@pytest.fixture(scope="module")
def plan() -> Iterator[Drive]:
    with driving(PAPER, PLAN) as drive:
        yield drive


@pytest.fixture(scope="module")
def policy_file(small_policy: Policy, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What a policy may answer from two starts."""
    sensed = [(1e-6 * s["x_um"], 1e-6 * s["y_um"], np.radians(s["theta_deg"])) for s in FAR]
    path = tmp_path_factory.mktemp("drive") / "policy.json"
    document = policy_document(from_starts(small_policy, sensed))
    path.write_text(document.model_dump_json(by_alias=True), encoding="utf-8")
    return path


class Laboratory:
    """A part on a film that is pushed as an answer says, and sensed; um and deg outside."""

    def __init__(self, pose: dict[str, float], seed: int) -> None:
        self.rng, self.u = np.random.default_rng(seed), paper_task().uncertainty
        self.reach = np.array([self.u.sensed_position_um] * 2 + [self.u.sensed_orientation_deg])
        sensed = np.array([pose["x_um"], pose["y_um"], pose["theta_deg"]])
        self.first: dict[str, float] | None = pose
        self.pose = sensed - self.reach * self.rng.choice([-1.0, 1.0], 3)
        self.friction = float(self.rng.choice(self.u.friction))
        share = 0.01 * self.u.film_ratio_percent * self.rng.choice([-1.0, 1.0])
        self.film_ratio = self.u.film_ratio_um2 * 1e-12 * (1.0 + share)
        self.beta = np.radians(float(self.rng.choice(self.u.tip_misalignment_deg)))

    def sense(self) -> dict[str, float]:
        """What the camera says."""
        if self.first is not None:
            sensed, self.first = self.first, None
            return sensed
        x, y, theta = self.pose + self.reach * self.rng.choice([-1.0, 1.0], 3)
        return {"x_um": x, "y_um": y, "theta_deg": theta}

    def carry_out(self, answer: dict[str, Any]) -> None:
        """Push as commanded, with the probes' errors."""
        move = MoveDocument.model_validate_json(json.dumps(answer))
        tips = np.array([probe.start_um for probe in move.probes])
        middle = 0.5 * (tips[0] + tips[1])
        c, s = np.cos(self.beta), np.sin(self.beta)
        apart = (tips[:2] - middle) @ np.array([[c, s], [-s, c]]) / c
        errors = self.u.probe_position_um * self.rng.choice([-1.0, 1.0], (2, 2))
        tips[:2] = middle + apart + errors[0]
        tips[2:] += errors[1]
        travel = np.array([(0.0, 0.0) if p.passive else move.travel_um for p in move.probes])
        scale = np.array([1e-6, 1e-6, np.pi / 180.0])
        part = paper_task().rectangle("this test")
        a, b = 0.5e-6 * part.length_um, 0.5e-6 * part.width_um
        pushed = simulate(
            Push.straight(
                vertices=np.array([[-a, -b], [a, -b], [a, b], [-a, b]]),
                poses=(self.pose * scale)[None],
                tips=1e-6 * tips[None],
                travel=1e-6 * travel[None],
                friction=np.array([self.friction]),
                film_ratio=np.array([self.film_ratio]),
                step=2e-6,
            )
        )
        assert pushed.outcomes[0] == Outcome.COMPLETED
        self.pose = pushed.poses[0] / scale


def in_goal(pose: np.ndarray) -> bool:
    return bool((np.abs(pose - [0.0, 0.0, 180.0]) <= [76.0, 76.0, 5.0]).all())


def run(drive: Drive, laboratory: Laboratory, most: int) -> dict[str, Any]:
    """Do as answered until there is no move; the last answer."""
    for _ in range(most + 1):
        answer = drive.say(laboratory.sense())
        if "probes" not in answer:
            return answer
        laboratory.carry_out(answer)
        expect, pose = answer["expect"], laboratory.pose.copy()
        pose[2] += 360.0 * np.rint((np.mean(expect["theta_deg"]) - pose[2]) / 360.0)
        for (low, high), value in zip(expect.values(), pose, strict=True):
            assert low - 0.1 <= value <= high + 0.1
    raise AssertionError("more moves than were promised")


@pytest.mark.parametrize("seed", range(4))
def test_a_plan_is_driven_to_the_goal(plan: Drive, seed: int) -> None:
    laboratory = Laboratory(START, seed)

    answer = run(plan, laboratory, 4)

    assert answer["done"] is True
    assert set(answer) == {"done", "within"}
    assert in_goal(laboratory.pose)
    for (low, high), value in zip(answer["within"].values(), laboratory.pose, strict=True):
        assert low - 0.1 <= value <= high + 0.1


def test_a_full_turn_changes_nothing(plan: Drive) -> None:
    turned = [plan.say({**START, "theta_deg": 90.0 + 360.0 * k}) for k in (0, 1, -2)]

    assert turned[0] == turned[1] == turned[2]
    assert turned[0]["step"] == 1


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"theta_deg": 97.0}, "theta_deg = 97 is"),
        ({"y_um": 300.0}, "y_um = 300 is"),
        ({"x_um": -500.0}, "below the bound"),
    ],
)
def test_a_pose_outside_is_refused_by_name_and_amount(
    plan: Drive, change: dict[str, float], words: str
) -> None:
    answer = plan.say({**START, **change})

    assert list(answer) == ["refused"]
    assert words in answer["refused"]


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("no json", "not a JSON object"),
        ("", "a blank line is not a pose"),
        ("  \t", "a blank line is not a pose"),
        ("[1, 2, 3]", "a JSON object is needed"),
        ('{"x_um": 1.0, "y_um": 2.0}', "theta_deg is missing"),
        ('{"x_um": 1.0, "y_um": 2.0, "theta_deg": 90, "z": 1}', "z is unknown"),
        ('{"x_um": true, "y_um": 2.0, "theta_deg": 90}', "must be a number"),
        ('{"x_um": NaN, "y_um": 2.0, "theta_deg": 90}', "must be finite"),
        ('{"x_um": 1, "x_um": 1, "y_um": 2.0, "theta_deg": 90}', "given twice"),
    ],
)
def test_a_malformed_line_is_an_error_and_changes_nothing(
    plan: Drive, line: str, words: str
) -> None:
    laboratory = Laboratory(START, 9)
    first = plan.say(laboratory.sense())
    laboratory.carry_out(first)

    answer = plan.say(line)

    assert list(answer) == ["error"]
    assert words in answer["error"]
    assert plan.say(laboratory.sense())["step"] == 1
    # the second move of step 1: the malformed line has not moved the plan on or back
    assert plan.say(START)["probes"] == first["probes"]


def test_an_answer_takes_at_most_50_ms(plan: Drive) -> None:
    plan.seconds.clear()
    for k in range(60):
        plan.say({**START, "x_um": 2060.4 + 0.1 * k})

    assert np.median(plan.seconds) < 0.5 * LIMIT_S


@at_night
def test_a_policy_is_proved_again_and_driven(policy_file: Path) -> None:
    with driving(PAPER, policy_file) as drive:
        for seed, pose in enumerate(
            (
                FAR[0],
                FAR[1] | {"theta_deg": -182.0},  # the same, a turn back
                {"x_um": 20.0, "y_um": -30.0, "theta_deg": 180.0},  # in the goal
            )
        ):
            laboratory = Laboratory(pose, seed)
            answer = run(drive, laboratory, 2)
            assert answer["done"] is True
            turned = laboratory.pose[2] % 360.0
            assert in_goal(np.array([*laboratory.pose[:2], turned]))
        refused = drive.say({"x_um": 900.0, "y_um": 800.0, "theta_deg": 135.0})
        assert "theta_deg = 135 is" in refused["refused"]
        assert np.median(drive.seconds) < LIMIT_S
        assert drive.end() == 0


@at_night
def test_a_policy_that_was_tampered_with_is_status_2(policy_file: Path, tmp_path: Path) -> None:
    document = json.loads(policy_file.read_text(encoding="utf-8"))
    exact = document["cells"][0]["sensed_exact"]
    exact["theta_rad"][1] = (float.fromhex(exact["theta_rad"][1]) + 0.05).hex()
    path = tmp_path / "tampered.json"
    path.write_text(json.dumps(document), encoding="utf-8")

    with driving(PAPER, path) as drive:
        out, err = drive.process.communicate(timeout=60)

    assert drive.process.returncode == 2
    assert out == ""
    assert "cell 0" in err
    assert "is not proved" in err
    assert "Traceback" not in err


def test_a_plan_for_another_task_is_status_2(tmp_path: Path) -> None:
    text = PAPER.read_text(encoding="utf-8")
    other = tmp_path / "other.toml"
    other.write_text(text.replace("[0.30, 0.36]", "[0.05, 0.9]"), encoding="utf-8")

    with driving(other, PLAN) as drive:
        _, err = drive.process.communicate(timeout=60)

    assert drive.process.returncode == 2
    assert "task_hash" in err
    assert "Traceback" not in err


def test_an_interrupt_ends_it_quietly() -> None:
    with driving(PAPER, PLAN) as drive:
        drive.say(START)
        drive.process.send_signal(signal.SIGINT)
        _, err = drive.process.communicate(timeout=30)

    assert "Traceback" not in err
    assert drive.process.returncode in (0, 130)
