"""One command from a part on the slide to a certified plan, or to the reason why there is none."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from meso_robust.cli import app
from meso_robust.identification.experiment import Bench, standard_tests
from meso_robust.identification.experiment_document import experiment_files
from meso_robust.live.lab_file import VirtualSection
from meso_robust.live.virtual_bench import lab_of
from meso_robust.recordings import Rectangle
from meso_robust.task import load_task
from meso_robust.tasks import MICROSCOPE
from tests.nightly import at_night


def toml(value: Any) -> str:
    """A value in TOML, tables in one line."""
    if isinstance(value, dict):
        given = {key: one for key, one in value.items() if one is not None}
        return "{" + ", ".join(f"{key} = {toml(one)}" for key, one in given.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(toml, value)) + "]"
    return f'"{value}"' if isinstance(value, str) else str(value).lower()


@at_night
@pytest.mark.parametrize("effect", ["", "dry_friction"])
def test_pushes_are_made_recorded_identified_diagnosed_and_planned_from(
    effect: str, tmp_path: Path
) -> None:
    part = Rectangle(length=1616e-6, width=837e-6)
    files = experiment_files(standard_tests(part, Bench(trials=1)))
    (tmp_path / "experiment.json").write_text(files["experiment.json"], encoding="utf-8")
    effects = {effect: {"ratio": 0.15}} if effect else {}
    virtual = VirtualSection(seed=5, frame_rate_hz=12.0, effects=effects)
    lab = lab_of(load_task(MICROSCOPE), "-x", virtual).model_dump(mode="json", by_alias=True)
    text = "\n".join(f"{key} = {toml(value)}" for key, value in lab.items())
    (tmp_path / "lab.toml").write_text(text, encoding="utf-8")
    out = tmp_path / "out"
    given = [
        "run", str(MICROSCOPE), "--experiment", str(tmp_path / "experiment.json"),
        "--lab", str(tmp_path / "lab.toml"), "--yes", "--out", str(out),
    ]  # fmt: skip

    found = CliRunner().invoke(app, given)

    assert found.exit_code in (0, 1), found.output
    assert len(list((out / "recordings").glob("*.csv"))) == 8
    assert (out / "identification" / "model.toml").exists(), found.output
    said = found.output
    if found.exit_code == 0:
        assert "PROVED" in said
    else:
        assert "ended there: " in said or "UNKNOWN" in said or "REFUTED" in said
    if effect:
        # named, or said why not: never another name with confidence
        told = json.loads((out / "diagnosis" / "diagnosis.json").read_text(encoding="utf-8"))
        named = {one["name"] for one in told["effects"]}
        assert effect in named if told["verdict"] == "named" else told["why"]
