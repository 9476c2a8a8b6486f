"""``meso-robust certify`` as a user meets it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from meso_robust.cli import app
from meso_robust.tasks import PAPER
from tests.strategies import paper_chain, paper_task

RUNNER = CliRunner()


@pytest.fixture(scope="module")
def plan() -> dict[str, Any]:
    import numpy as np

    from meso_robust.planning.document import plan_document

    chain = paper_chain()
    rules = [step.rule for step in chain.steps]
    sensed = [np.array(step.pre.mid) for step in chain.steps]
    document = plan_document(paper_task(), rules, sensed, [step.post for step in chain.steps])
    found: dict[str, Any] = json.loads(document.model_dump_json(by_alias=True))
    return found


def certify(plan: dict[str, Any], folder: Path) -> Any:
    file = folder / "plan.json"
    file.write_text(json.dumps(plan), encoding="utf-8")
    options = ["--out", str(folder / "out"), "--samples", "30"]
    return RUNNER.invoke(app, ["certify", str(PAPER), str(file), *options])


def test_a_good_plan_is_proved_with_the_margin_of_the_planner(
    plan: dict[str, Any], tmp_path: Path
) -> None:
    result = certify(plan, tmp_path)

    assert result.exit_code == 0, result.output
    assert "PROVED" in result.stdout
    certificate = json.loads((tmp_path / "out" / "certificate.json").read_text())
    assert certificate["policy"] == plan["policy"]
    assert [s["post"] for s in certificate["steps"]] == [m["expect"] for m in plan["moves"]]
    assert json.loads((tmp_path / "out" / "plan.json").read_text())["policy"] == plan["policy"]


def test_a_worse_plan_is_refused_with_the_move_that_fails(
    plan: dict[str, Any], tmp_path: Path
) -> None:
    changed = json.loads(json.dumps(plan))
    changed["policy"][0]["dual_y"]["offset_um"] += 60.0  # the tip would slip

    result = certify(changed, tmp_path)

    assert result.exit_code == 1, result.output
    assert "not proved in step 1 (tilt)" in result.stdout
    assert "change the move" in result.stdout


def test_fixed_moves_are_certified_as_they_stand(plan: dict[str, Any], tmp_path: Path) -> None:
    """Without sensing they start where the part may be: the second move is not free of contact."""
    result = certify({**plan, "policy": []}, tmp_path)

    assert result.exit_code == 1, result.output
    certificate = json.loads((tmp_path / "out" / "certificate.json").read_text())
    assert [s["action"] for s in certificate["steps"]][:1] == ["tilt"]
    assert certificate["steps"][0]["verdict"] == "PROVED"
    assert "free of contact" in result.stdout


def test_fixed_moves_off_the_axes_are_unknown(plan: dict[str, Any], tmp_path: Path) -> None:
    moves = json.loads(json.dumps(plan["moves"]))
    moves[0]["travel_um"] = [-100.0, 5.0]

    result = certify({**plan, "policy": [], "moves": moves}, tmp_path)

    assert result.exit_code == 1
    assert "move 1 travels by [-100.0, 5.0] um" in result.stderr


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("side", 0, "policy.0.side = 0: must be one of [-1, 1] for action 'tilt'"),
        ("heading", "up", "policy.0.heading"),
        ("single_x", {"relative_to": "world", "offset_um": 1.0}, "policy.0.single_y = null"),
    ],
)
def test_a_rule_that_no_motion_is_made_for_is_status_2(
    plan: dict[str, Any], tmp_path: Path, key: str, value: object, words: str
) -> None:
    changed = json.loads(json.dumps(plan))
    changed["policy"][0][key] = value

    result = certify(changed, tmp_path)

    assert result.exit_code == 2
    assert words in result.stderr
    assert not (tmp_path / "out").exists()


def test_a_rotation_whose_tips_hang_on_different_things_is_status_2(
    plan: dict[str, Any], tmp_path: Path
) -> None:
    changed = json.loads(json.dumps(plan))
    changed["policy"][2]["single_x"]["relative_to"] = "world"

    result = certify(changed, tmp_path)

    assert result.exit_code == 2
    assert "policy.2.single_x.relative_to" in result.stderr
