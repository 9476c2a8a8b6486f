"""One command from a part on the slide to a certified plan, or to the reason why there is none."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from meso_robust.cli import app
from meso_robust.live.designed import read_experiment
from meso_robust.live.loading import load_lab
from meso_robust.tasks import MICROSCOPE
from reports.live.experiments import CONCEALED, NOTHING, Answer, laid_out, page
from tests.nightly import at_night

RIGHT = Answer(
    concealed="dry_friction", values={"ratio": 0.15}, verdict="named", told=["dry_friction"],
    words=["dry_friction (support): ratio 0.15 [0.14, 0.16]"], before_um=2.3, after_um=0.2,
    planned="UNKNOWN", margin=None, advice="a laboratory without it", pushes_s=150.0, processor_s=60.0,
)  # fmt: skip


@at_night
@pytest.mark.parametrize("concealed", [NOTHING, "tip_radius"])
def test_pushes_are_made_recorded_identified_diagnosed_and_planned_from(
    concealed: str, tmp_path: Path
) -> None:
    laid_out(concealed, tmp_path)
    out = tmp_path / "out"
    given = [
        "run", str(MICROSCOPE), "--experiment", str(tmp_path / "experiment.json"),
        "--lab", str(tmp_path / "lab.toml"), "--yes", "--out", str(out),
    ]  # fmt: skip

    found = CliRunner().invoke(app, given)

    assert found.exit_code in (0, 1), found.output
    assert len(list((out / "recordings").glob("*.csv"))) == 8
    assert (out / "identification" / "model.toml").exists(), found.output
    told = json.loads((out / "diagnosis" / "diagnosis.json").read_text(encoding="utf-8"))
    named = {one["name"] for one in told["effects"]}
    assert found.exit_code == 0
    assert "PROVED" in found.output
    if concealed == NOTHING:
        assert (told["verdict"], named) == ("consistent", set())
    else:
        assert (told["verdict"], named) == ("named", {concealed})
        excess = told["effects"][0]["parameters"]["excess_um"]
        assert excess["low"] <= CONCEALED[concealed]["excess_um"] <= excess["high"]


@pytest.mark.parametrize("concealed", CONCEALED)
def test_a_case_is_laid_out_as_a_laboratory_would(concealed: str, tmp_path: Path) -> None:
    laid_out(concealed, tmp_path)
    effects = load_lab(tmp_path / "lab.toml").virtual.effects
    assert effects == ({} if concealed == NOTHING else {concealed: CONCEALED[concealed]})
    moves = read_experiment(tmp_path / "experiment.json").moves
    assert {move.speed_um_s for move in moves} == {15.0, 75.0, 150.0}
    assert min(move.rest_s for move in moves) >= 1.0


def test_only_what_was_concealed_and_nothing_else_is_right() -> None:
    assert RIGHT.right
    assert replace(RIGHT, verdict="partial").right
    plain = replace(RIGHT, concealed=NOTHING, values={}, told=[], words=[], verdict="consistent")
    assert plain.right
    for wrong in (
        replace(RIGHT, told=["dry_friction", "backlash"]),
        replace(RIGHT, told=["uneven_support"]),
        replace(RIGHT, verdict="ambiguous"),
        replace(RIGHT, verdict="consistent", told=[]),
        replace(plain, verdict="named"),
        replace(plain, verdict=""),
    ):
        assert not wrong.right


def test_the_page_counts_what_is_right_and_says_what_to_do() -> None:
    missed = replace(
        RIGHT, concealed="backlash", values={"width_um": 5.0}, verdict="unknown", told=[]
    )
    plain = replace(
        RIGHT, concealed=NOTHING, values={}, told=[], words=[], verdict="consistent",
        planned="PROVED", margin=1.48, advice="",
    )  # fmt: skip
    turned = replace(plain, set_right="rotation_deg 0 → −0.6")
    assert "| PROVED, margin 1.48, with rotation_deg 0 → −0.6 |" in page([turned])
    text = page([plain, RIGHT, missed])
    assert "Of 2 effects that were concealed, one at a time, 1 are told" in text
    assert "1 of 3 experiments end with a plan that is PROVED" in text
    assert "| PROVED, margin 1.48 |" in text
    assert "| 2.30 → 0.20 |" in text
    assert text.count(": a laboratory without it") == 2
