"""``meso-robust identify`` as a user meets it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from meso_robust.cli import app
from meso_robust.identification.document import read_model
from meso_robust.recordings import RecordingSet, read_set, write_set
from meso_robust.simulator import Film
from meso_robust.tasks import PAPER
from tests.identification.sets import PART, RADIUS, random_pushes, recorded

EXAMPLE_SET = Path(__file__).parents[1] / "example" / "set"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    rng = np.random.default_rng(7)
    made: RecordingSet = recorded(
        random_pushes(rng, 3), Film.ratio(np.full(3, 0.3769e-6)), 0.33, rng
    )
    path = tmp_path_factory.mktemp("set")
    write_set(path, made)
    return path


def run(*words: str | Path) -> tuple[int, str]:
    result = CliRunner().invoke(app, ["identify", *map(str, words)])
    return result.exit_code, result.output


def test_a_set_gives_a_model_a_document_and_a_page(folder: Path, tmp_path: Path) -> None:
    code, said = run(
        folder, "--starts", "3", "--design", "1", "--out", tmp_path, "--json", "--quiet"
    )
    assert code == 0
    document = json.loads(said)
    assert document["schema"] == "meso-robust/model/1"
    assert document["verdict"] == "IDENTIFIED"
    model = read_model(tmp_path / "model.toml")
    assert model.parameters["rho_um2"].low < 376900.0 * 1.05
    assert model.parameters["rho_um2"].high > 376900.0 * 0.95
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "rho_um2" in page
    assert "push_02.csv" in page
    assert "http" not in page.replace("http://www.w3.org", "").replace("http-equiv", "")
    assert len(json.loads((tmp_path / "experiment.json").read_text())["moves"]) >= 1


def test_a_model_that_its_recordings_reject_is_a_negative_answer(tmp_path: Path) -> None:
    """The example's part has a burr that the plain model knows nothing of."""
    code, said = run(EXAMPLE_SET, "--starts", "2", "--out", tmp_path, "--json", "--quiet")

    document = json.loads(said)
    assert code == 1
    assert document["verdict"] == "FIT REJECTED"
    assert document["probe"] == {"tip_radius_um": 12.5}
    assert document["quality"]["chi2"] > 5 * document["quality"]["freedom"]
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "FIT REJECTED" in page
    assert "✓" not in page.split("FIT REJECTED")[0][-200:]
    assert "meso-robust diagnose" in page


def test_the_printed_objective_has_no_probability(folder: Path, tmp_path: Path) -> None:
    code, said = run(folder, "--starts", "3", "--objective", "printed", "--out", tmp_path)
    assert code == 0
    assert "last simplex" in said
    assert read_model(tmp_path / "model.toml").confidence is None


@pytest.mark.parametrize("task", [True, False])
def test_a_plan_needs_a_part_only(folder: Path, tmp_path: Path, task: bool) -> None:
    code, said = run(PAPER if task else folder, "--plan", "--out", tmp_path)
    assert code == 0
    assert "8 pushes" in said
    assert (tmp_path / "experiment.json").exists()


@pytest.mark.parametrize(
    ("words", "rule"),
    [
        (["--model", "magic"], "must be one of viscous"),
        (["--objective", "magic"], "must be likelihood or printed"),
        (["--model", "three_point"], "record 1 more"),
        (["--objective", "printed", "--design", "3"], "leave --objective out"),
    ],
)
def test_bad_input_is_refused(folder: Path, tmp_path: Path, words: list[str], rule: str) -> None:
    code, said = run(folder, *words, "--out", tmp_path / "out")
    assert code == 2
    assert rule in said
    assert not (tmp_path / "out").exists()


def test_the_recordings_are_not_written_over(folder: Path) -> None:
    before = {path: path.read_bytes() for path in folder.iterdir()}
    code, said = run(folder, "--plan", "--out", folder)
    assert code == 2
    assert "folder of the recordings" in said
    assert before == {path: path.read_bytes() for path in folder.iterdir()}


def test_a_folder_without_a_set_is_refused(tmp_path: Path) -> None:
    code, said = run(tmp_path, "--out", tmp_path / "out")
    assert code == 2
    assert "set.toml" in said


def test_poses_that_are_no_measurements_are_not_fitted(folder: Path, tmp_path: Path) -> None:
    made = read_set(folder)
    poses = [one.poses.copy() for one in made.recordings]
    for each in poses:
        each[np.arange(len(each)) % 4 > 0] = 0.0
    both = zip(made.recordings, poses, strict=True)
    dirty = replace(made, recordings=tuple(replace(one, poses=each) for one, each in both))
    write_set(tmp_path / "set", dirty)

    code, said = run(tmp_path / "set", "--out", tmp_path / "out")

    assert code == 2
    assert "push_00.csv, line" in said
    assert "--repair" in said
    assert not (tmp_path / "out").exists()


def test_a_push_through_the_middle_is_named_pathological(tmp_path: Path) -> None:
    """Fig. 4 of the paper: pushed at the centre of drag, the part turns either way."""
    rng = np.random.default_rng(3)
    pushes = random_pushes(rng, 3)
    pushes.poses[0] = 0.0
    pushes.tips[0, 0] = [0.0, 0.5 * PART.width + RADIUS + 20e-6]
    pushes.travels[0, 0] = [0.0, -500e-6]
    made = recorded(pushes, Film.ratio(np.full(3, 0.3769e-6)), 0.33, rng)
    write_set(tmp_path / "set", made)

    code, said = run(tmp_path / "set", "--starts", "3", "--out", tmp_path / "out")

    assert code == 0
    named = [line for line in said.splitlines() if "pathological start (turns either way" in line]
    assert [line.split(":")[0].strip() for line in named] == ["push_00.csv"]
