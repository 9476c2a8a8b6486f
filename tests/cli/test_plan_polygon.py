"""Tasks of polygons on the command line: what is offered for rectangles only says so."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from meso_robust.cli import app
from meso_robust.tasks import HEXAGON, L_SHAPE

RUNNER = CliRunner()


@pytest.fixture(scope="module")
def proved(tmp_path_factory: pytest.TempPathFactory) -> tuple[Any, Path]:
    out = tmp_path_factory.mktemp("hexagon")
    return RUNNER.invoke(
        app, ["plan", str(HEXAGON), "--out", str(out), "--samples", "40", "--quiet"]
    ), out


def test_the_hexagon_is_proved_and_drawn_with_its_corners(proved: tuple[Any, Path]) -> None:
    result, out = proved
    assert result.exit_code == 0, result.output
    certificate = json.loads((out / "certificate.json").read_text(encoding="utf-8"))
    assert certificate["verdict"] == "PROVED"
    assert certificate["simulation"]["in_goal"] == 40
    assert "between_corners" in certificate["claim"]["inequalities"]


def test_it_is_checked_simulated_and_driven(proved: tuple[Any, Path], tmp_path: Path) -> None:
    _, out = proved
    checked = RUNNER.invoke(app, ["check", str(out / "certificate.json"), str(HEXAGON)])
    assert checked.exit_code == 0, checked.output
    plan = str(out / "plan.json")
    asked = ["simulate", str(HEXAGON), plan, "--samples", "4", "--recordings", "1"]
    simulated = RUNNER.invoke(app, [*asked, "--out", str(tmp_path / "o")])
    assert simulated.exit_code == 0, simulated.output
    assert "polygon_um" in (tmp_path / "o" / "recordings" / "set.toml").read_text(encoding="utf-8")
    told = json.dumps({"x_um": 1800.0, "y_um": -16.0, "theta_deg": 1.0})
    driven = RUNNER.invoke(app, ["drive", str(HEXAGON), plan], input=told + "\n")
    assert driven.exit_code == 0, driven.output
    assert '"primitive": "y_translation"' in driven.stdout


@pytest.mark.parametrize("option", ["--policy", "--maps"])
def test_what_needs_a_rectangle_is_refused_before_any_work(option: str, tmp_path: Path) -> None:
    out = tmp_path / "o"
    result = RUNNER.invoke(app, ["plan", str(L_SHAPE), option, "--out", str(out)])
    assert result.exit_code == 2
    assert "for rectangles only" in result.output
    assert option in result.output
    assert not out.exists()


def test_attacks_on_a_polygons_certificate_find_nothing(
    proved: tuple[Any, Path], tmp_path: Path
) -> None:
    campaign = tmp_path / "campaign.toml"
    campaign.write_text(
        'schema = "meso-robust/campaign/1"\nname = "attack"\nseed = 1\n[[part]]\n'
        f'name = "hexagon"\nkind = "falsify"\ntask = "{HEXAGON}"\n'
        f'plan = "{proved[1] / "plan.json"}"\nexecutions = 2000\nmethods = ["mixed"]\n',
        encoding="utf-8",
    )
    result = RUNNER.invoke(app, ["campaign", str(campaign), "--out", str(tmp_path / "o")])
    assert result.exit_code == 0, result.output
    assert "No counterexample in 2,000 executions" in result.output


def test_a_quarter_turn_of_a_polygon_is_unknown_with_the_reason(tmp_path: Path) -> None:
    file = tmp_path / "task.toml"
    text = HEXAGON.read_text(encoding="utf-8").replace("theta_deg = 0.0", "theta_deg = 90.0")
    file.write_text(text, encoding="utf-8")
    result = RUNNER.invoke(app, ["plan", str(file), "--out", str(tmp_path / "o")])
    assert result.exit_code == 1
    assert "lie opposite each other over 520 um only" in " ".join(result.output.split())


def test_the_standard_tests_are_planned_for_a_polygon(tmp_path: Path) -> None:
    out = tmp_path / "o"
    result = RUNNER.invoke(app, ["identify", str(HEXAGON), "--plan", "--out", str(out)])
    assert result.exit_code == 0, result.output
    assert "polygon_um" in (out / "experiment.json").read_text(encoding="utf-8")
