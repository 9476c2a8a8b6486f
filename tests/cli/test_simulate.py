"""``meso-robust simulate`` as a user meets it: exit status, messages, files."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from meso_robust.cli import app
from meso_robust.laboratory.draws import draw
from meso_robust.laboratory.running import run
from meso_robust.laboratory.simulation_document import SimulationDocument
from meso_robust.planning.document import PlanDocument
from meso_robust.planning.rules import rules_of
from meso_robust.primitives.setup import setup_of
from meso_robust.task import load_task
from meso_robust.tasks import PAPER

RUNNER = CliRunner()
REPORT = Path(__file__).parents[2] / "reports" / "paper_task"
PLAN = REPORT / "plan.json"
FILES = ["animation.html", "simulation.json", "trajectories.csv"]


def wide_task(folder: Path) -> Path:
    """The paper's task with friction anywhere from 0.05 to 0.9."""
    text = PAPER.read_text(encoding="utf-8")
    assert "[0.30, 0.36]" in text
    path = folder / "wide.toml"
    path.write_text(text.replace("[0.30, 0.36]", "[0.05, 0.9]"), encoding="utf-8")
    return path


def changed(source: Path, folder: Path, **values: Any) -> Path:
    """A JSON file with some top keys changed."""
    path = folder / f"changed_{source.name}"
    loaded = json.loads(source.read_text(encoding="utf-8"))
    path.write_text(json.dumps({**loaded, **values}), encoding="utf-8")
    return path


def simulate(*words: object) -> Any:
    return RUNNER.invoke(app, ["simulate", *map(str, words)])


@pytest.fixture(scope="module")
def robust(tmp_path_factory: pytest.TempPathFactory) -> tuple[Any, Path]:
    out = tmp_path_factory.mktemp("robust") / "out"
    return simulate(PAPER, PLAN, "--out", out, "--samples", 40, "--seed", 3, "--adversarial"), out


def test_robust_plan_is_status_0_with_three_files(robust: tuple[Any, Path]) -> None:
    result, out = robust

    assert result.exit_code == 0, result.output
    assert sorted(path.name for path in out.iterdir()) == FILES
    assert "40 of 40 completed, 40 in the goal" in result.stdout
    assert "a search, no proof" in result.stdout


def test_sampled_runs_are_those_of_the_monte_carlo_campaign(robust: tuple[Any, Path]) -> None:
    answer = SimulationDocument.model_validate_json((robust[1] / "simulation.json").read_text())
    plan = PlanDocument.model_validate_json(PLAN.read_text())
    rules, setup = rules_of(plan), setup_of(load_task(PAPER))

    direct = run(rules, setup, draw(setup, 4, 40, np.random.default_rng(3)))

    ours = np.array([[s.final.x_um, s.final.y_um, s.final.theta_deg] for s in answer.samples])
    theirs = direct.final * [1e6, 1e6, 180 / np.pi]
    assert np.abs(ours - theirs).max() <= 5.1e-5
    assert answer.sampled.largest_miss == pytest.approx(
        (np.abs(theirs - [0, 0, 180]) / [76, 76, 5]).max(), abs=1e-6
    )


def test_document_says_what_was_run(robust: tuple[Any, Path]) -> None:
    answer = json.loads((robust[1] / "simulation.json").read_text())

    assert answer["schema"] == "meso-robust/simulation/1"
    assert answer["task_hash"] == load_task(PAPER).hash
    assert (answer["seed"], answer["step_um"], answer["kind"]) == (3, 2.0, "feedback")
    assert {"meso-robust", "numba", "numpy", "python"} <= set(answer["made_with"])
    worst = answer["adversary"]["worst"]
    assert worst["run"]["miss"] >= answer["sampled"]["largest_miss"] - 1e-3
    for entry in worst["draws"]:
        low, value, high = (float.fromhex(entry[key]) for key in ("low", "value", "high"))
        assert low <= value <= high


def test_trajectories_hold_every_run(robust: tuple[Any, Path]) -> None:
    with (robust[1] / "trajectories.csv").open(encoding="utf-8") as file:
        lines = list(csv.DictReader(file))

    assert {line["run"] for line in lines} == {
        "nominal",
        "worst",
        *(f"sample {k}" for k in range(40)),
    }
    assert {(line["run"], line["move"]) for line in lines} == {
        (name, str(move)) for name in {line["run"] for line in lines} for move in range(1, 5)
    }


def test_same_seed_same_bytes_and_another_seed_other_runs(
    robust: tuple[Any, Path], tmp_path: Path
) -> None:
    words = (PAPER, PLAN, "--samples", 40, "--quiet")
    simulate(*words, "--seed", 3, "--out", tmp_path / "same", "--adversarial")
    simulate(*words, "--seed", 4, "--out", tmp_path / "other")

    for name in FILES:
        assert (tmp_path / "same" / name).read_bytes() == (robust[1] / name).read_bytes()
    name = "trajectories.csv"
    assert (tmp_path / "other" / name).read_bytes() != (robust[1] / name).read_bytes()


def test_json_prints_the_document_and_nothing_else(tmp_path: Path) -> None:
    result = simulate(PAPER, PLAN, "--out", tmp_path, "--samples", 4, "--json")

    assert result.stdout == (tmp_path / "simulation.json").read_text()
    assert result.stderr == ""


def test_quiet_says_how_many_runs_reach_the_goal(tmp_path: Path) -> None:
    result = simulate(PAPER, PLAN, "--out", tmp_path, "--samples", 4, "--quiet")

    assert (result.exit_code, result.stderr) == (0, "")
    assert len(result.stdout.splitlines()) == 1
    assert "4 of 4" in result.stdout


def test_task_that_is_not_robust_is_status_1_and_says_what_jammed(tmp_path: Path) -> None:
    task = wide_task(tmp_path)
    plan = changed(PLAN, tmp_path, task_hash=load_task(task).hash)

    result = simulate(task, plan, "--out", tmp_path / "o", "--samples", 60, "--adversarial")

    assert result.exit_code == 1, result.output
    assert "move 3: the part jammed at dtp_bottom and stp" in result.stdout
    answer = json.loads((tmp_path / "o" / "simulation.json").read_text())
    assert answer["all_in_goal"] is False
    assert answer["adversary"]["worst"]["run"]["miss"] is None
    jams = [run for run in answer["samples"] if run["outcome"] == "jam"]
    assert {tuple(run["touching"]) for run in jams} == {("dtp_bottom", "stp")}
    assert all(run["move"] == 3 and not run["in_goal"] for run in jams)


def test_open_loop_plan_runs_its_moves_as_they_are(tmp_path: Path) -> None:
    """The paper's moves without sensing between them still end in the goal in the nominal run."""
    plan = changed(PLAN, tmp_path, policy=[])

    result = simulate(PAPER, plan, "--out", tmp_path / "o", "--samples", 5)

    answer = json.loads((tmp_path / "o" / "simulation.json").read_text())
    assert "open loop" in result.stdout
    assert answer["kind"] == "open_loop"
    assert answer["nominal"]["in_goal"] is True
    assert answer["moves"] == ["y_translation", "y_translation", "rotation", "x_translation"]


def witness_certificate(folder: Path, task_hash: str, friction: float) -> Path:
    """A certificate whose witness is the nominal start with this friction and no errors."""
    setup = setup_of(load_task(PAPER))
    zero = (0.0).hex()
    witness = {
        "outcome": "made up",
        "start": [float(value).hex() for value in setup.start.mid],
        "friction": friction.hex(),
        "film_ratio_m2": setup.uncertainty.film_ratio.mid.hex(),
        "misalignment_rad": zero,
        "sensing": [[zero] * 3] * 4,
        "dual_probe": [[zero] * 2] * 4,
        "single_probe": [[zero] * 2] * 4,
    }
    values = {"verdict": "REFUTED", "witness": witness, "task_hash": task_hash}
    return changed(REPORT / "certificate.json", folder, **values)


@pytest.mark.parametrize(("friction", "outcome"), [(0.9, "jam"), (0.33, "completed")])
def test_witness_is_replayed(tmp_path: Path, friction: float, outcome: str) -> None:
    task = wide_task(tmp_path)
    task_hash = load_task(task).hash
    plan = changed(PLAN, tmp_path, task_hash=task_hash)
    witness = witness_certificate(tmp_path, task_hash, friction)

    result = simulate(
        task, plan, "--out", tmp_path / "o", "--samples", 2, "--seed", 1, "--witness", witness
    )

    answer = json.loads((tmp_path / "o" / "simulation.json").read_text())
    assert answer["witness"]["run"]["outcome"] == outcome, result.output
    drawn = {entry["name"]: entry["value"] for entry in answer["witness"]["draws"]}
    assert drawn["friction"] == friction.hex()
    assert "witness: " in result.stdout
    assert result.exit_code == (0 if answer["all_in_goal"] else 1)
    assert outcome == "completed" or result.exit_code == 1


def _refused(result: Any, out: Path, *words: str) -> None:
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    assert all(word in result.stderr for word in words), result.stderr
    assert "Traceback" not in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
    assert not out.exists()


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"task_hash": "0" * 64}, ("task_hash", "another task")),
        ({"extra": 1}, ("extra", "unknown")),
        ({"policy": [], "moves": []}, ("moves = []",)),
        ({"moves": float("nan")}, ("moves", "nan")),
    ],
)
def test_bad_plan_is_status_2_one_message_no_files(
    tmp_path: Path, values: dict[str, Any], words: tuple[str, ...]
) -> None:
    out, plan = tmp_path / "out", changed(PLAN, tmp_path, **values)

    _refused(simulate(PAPER, plan, "--out", out), out, str(plan), *words)


def test_bad_task_missing_plan_and_bad_witness_are_status_2(tmp_path: Path) -> None:
    out, task = tmp_path / "out", tmp_path / "task.toml"
    task.write_text("schema = 3", encoding="utf-8")
    proved = REPORT / "certificate.json"

    _refused(simulate(task, PLAN, "--out", out), out, str(task))
    _refused(simulate(PAPER, tmp_path / "no.json", "--out", out), out, "no.json")
    _refused(simulate(PAPER, PLAN, "--out", out, "--witness", proved), out, str(proved), "'PROVED'")
    _refused(
        simulate(PAPER, PLAN, "--out", out, "--witness", PLAN),
        out,
        str(PLAN),
        "neither a witness nor a certificate",
    )


def test_out_that_is_a_file_is_status_2_before_any_work(tmp_path: Path) -> None:
    path = tmp_path / "taken"
    path.write_text("mine", encoding="utf-8")

    result = simulate(PAPER, PLAN, "--out", path)

    assert result.exit_code == 2
    assert "taken" in result.stderr
    assert "simulating" not in result.stderr
    assert path.read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize("words", [("--samples", 0), ("--seed", -1), ("--samples", "many")])
def test_bad_option_is_status_2(tmp_path: Path, words: tuple[object, ...]) -> None:
    out = tmp_path / "out"

    result = simulate(PAPER, PLAN, "--out", out, *words)

    assert result.exit_code == 2
    assert str(words[0]) in result.stderr
    assert not out.exists()
