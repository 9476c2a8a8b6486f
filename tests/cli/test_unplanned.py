"""A task without a plan to judge ends early, and still leaves a report with the reason and the advice."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from meso_robust.cli import app
from meso_robust.tasks import PAPER

SHIPPED = Path(__file__).parents[2] / "reports/paper_task"


@pytest.mark.parametrize("verb", ["plan", "certify"])
def test_the_report_of_an_early_unknown_has_reason_and_advice(verb: str, tmp_path: Path) -> None:
    task, plan, out = tmp_path / "task.toml", tmp_path / "plan.json", tmp_path / "out"
    text = PAPER.read_text(encoding="utf-8")
    words = [verb, str(task), "--out", str(out)]
    if verb == "plan":
        task.write_text(text.replace("theta_deg = 90.0", "theta_deg = 0.0"), encoding="utf-8")
        reason, advice = (
            "the goal is 180.0 deg from the start",
            "make it two tasks of a quarter turn",
        )
        words += ["--search-s", "77"]
    else:
        task.write_text(text, encoding="utf-8")
        open_loop(plan)
        words.insert(2, str(plan))
        reason, advice = "", ""
    out.mkdir()
    (out / "certificate.json").write_text("of an earlier run", encoding="utf-8")

    done = CliRunner().invoke(app, words)

    assert done.exit_code == 1, done.output
    assert "UNKNOWN (point tips): " in done.stderr
    assert str(out / "report.html") in done.stderr
    assert {path.name for path in out.iterdir()} == {"report.html"}
    page = (out / "report.html").read_text(encoding="utf-8").casefold()
    assert "unknown" in page
    assert reason in page
    assert f"what would settle it:</strong> {advice}" in page
    assert "paper, section ix-e" in page
    assert ("plan task.toml --search-s 77" in page) == (verb == "plan")


def test_an_early_unknown_says_that_the_ratio_of_drags_is_no_even_films(tmp_path: Path) -> None:
    text = PAPER.read_text(encoding="utf-8").replace("theta_deg = 90.0", "theta_deg = 0.0")
    task = tmp_path / "task.toml"
    task.write_text(text.replace("film_ratio_um2 = 376900.0", "film_ratio_um2 = 1.0"), "utf-8")
    words = ["plan", str(task), "--out", str(tmp_path / "out")]
    remark = "note: uncertainty.film_ratio_um2 = 1 +- 5 %"

    assert remark in CliRunner().invoke(app, words).stderr
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "µm²" in page
    assert " um" not in page
    assert remark not in CliRunner().invoke(app, [*words, "--quiet"]).stderr


def open_loop(path: Path) -> None:
    """The shipped plan's moves alone, the first of them made by one tip: no primitive does that."""
    import json

    values = json.loads((SHIPPED / "plan.json").read_text(encoding="utf-8"))
    values["policy"] = []
    values["moves"][0]["probes"] = values["moves"][0]["probes"][:1]
    path.write_text(json.dumps(values), encoding="utf-8")
