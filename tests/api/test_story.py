"""The user's whole story through the API: the same files as the command line, byte by byte."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

import meso_robust as mr
from meso_robust.cli import app
from tests.api.conftest import SAMPLES, Story, contents, first_tip, printed
from tests.tracking.pushes import Filmed


def test_plan(story: Story, planned: mr.Planned) -> None:
    words = ("--samples", SAMPLES, "--seed", 3)
    said = story.said("plan", story.task, *words, out="plan")
    assert story.same("plan") == {"plan.json", "certificate.json", "report.html"}
    assert printed(said) == str(planned)
    assert planned.proved
    assert planned.margin.factor == planned.certificate.margin.factor > 1.0


def test_what_a_plan_was_made_of_is_no_plan(planned: mr.Planned) -> None:
    with pytest.raises(mr.InputError, match="must be a Planned, its plan, or the name"):
        mr.certify(mr.Task.paper(), planned.result)  # type: ignore[arg-type]


def test_certify_by_name_and_by_value(story: Story, planned: mr.Planned) -> None:
    plan = story.ours / "plan" / "plan.json"
    certified = mr.certify(str(story.task), planned, samples=SAMPLES)
    certified.save(str(story.ours / "again"))
    said = story.said("certify", story.task, plan, "--samples", SAMPLES, out="again")
    assert story.same("again") == {"plan.json", "certificate.json", "report.html"}
    assert printed(said) == str(certified)


def test_check(story: Story, planned: mr.Planned) -> None:
    certificate = story.ours / "plan" / "certificate.json"
    checked = mr.check(certificate, story.task)
    assert checked.verified
    assert str(checked).startswith("VERIFIED (point tips): From every start ")
    assert story.said("check", certificate, story.task) == f"{checked}\n"

    values = json.loads(certificate.read_text(encoding="utf-8"))
    values["steps"][0]["post"]["x_um"][0] += 1.0
    changed = certificate.with_name("changed.json")
    changed.write_text(json.dumps(values), encoding="utf-8")
    rejected = mr.check(changed, story.task)
    said = story.said("check", changed, story.task, "--json", status=1)
    assert json.loads(said) == rejected.document
    assert (rejected.verdict, rejected.verified) == ("REJECTED", False)
    assert "REJECTED" in rejected._repr_html_()
    doubted = replace(planned, checked=rejected)
    assert (planned.positive, doubted.positive, doubted.proved) == (True, False, True)
    assert "checked: REJECTED at " in str(doubted)
    files = doubted.files()
    assert "do not rely on this plan" in files["report.html"]
    assert json.loads(files["check.json"])["verdict"] == "REJECTED"
    assert "REJECTED" in doubted._repr_html_()
    changed.unlink()  # the folder is compared with another


def test_simulate_and_record(story: Story, recorded: Path) -> None:
    names = story.same("runs")
    assert {"simulation.json", "trajectories.csv", "animation.html"} < names
    assert len([name for name in names if name.startswith("recordings")]) == 5  # of 4 moves


def test_recordings(story: Story, recorded: Path) -> None:
    found = mr.read_recordings(recorded, repair=True)
    found.save(story.ours / "set")
    said = story.said("recordings", recorded, "--repair", out="set")
    assert printed(said).startswith(f"{found}\nrecording set: ")
    assert {"summary.json", "report.html"} < story.same("set")
    assert (found.verdict, found.problems, found.repairs) == ("CLEAN", (), ())


def test_identify_and_plan_again_with_the_model(
    story: Story, recorded: Path, identified: mr.Identified
) -> None:
    identified.save(story.ours / "model")
    said = story.said("identify", recorded, "--starts", 2, out="model")
    assert printed(said) == str(identified)
    assert story.same("model") == {"model.toml", "identification.json", "report.html"}
    assert (
        identified.document.parameters["mu"].low < 0.33 < identified.document.parameters["mu"].high
    )

    again = mr.plan(story.task, model=story.ours / "model" / "model.toml", samples=5)
    assert again.task != mr.Task.load(story.task)  # the ranges are the model's
    premises = json.loads(again.files()["premises.json"])
    assert (premises["verdict"], premises["task_hash"]) == (again.verdict, again.task.hash)
    assert "with the model viscous" in str(again)


def test_standard_tests(story: Story) -> None:
    tests = mr.standard_tests(story.task)
    tests.save(story.ours / "tests")
    said = story.said("identify", story.task, "--plan", out="tests")
    assert said.splitlines()[0] == str(tests)
    assert "experiment.json" in story.same("tests")


def test_track(story: Story, filmed: Filmed, tracked: mr.Tracked) -> None:
    tracked.save(story.ours / "track")
    x, y = first_tip(filmed)
    words = ("--task", story.task, "--tip-radius-um", 12.5, "--pixel-um", 5.26)
    where = ("--start", ",,0.0", "--probe", f"left={x},{y}")
    said = story.said("track", filmed.path, *words, *where, out="track")
    assert printed(said) == str(tracked)
    assert {"set.toml", "track.json", "overlay.avi"} < story.same("track")
    assert tracked.tracked
    assert mr.read_recordings(story.ours / "track").set.recordings[0].probe_names == ("left",)
    with pytest.raises(mr.InputError, match="must not be overwritten"):
        tracked.save(filmed.path.parent)


def test_drive(story: Story, planned: mr.Planned) -> None:
    plan = story.ours / "plan" / "plan.json"
    lines = ['{"x_um": 2060.4, "y_um": -9.2, "theta_deg": 90.0}', "[]", ""]
    driver = mr.drive(story.task, plan)
    ours = [driver.answer(2060.4, -9.2, 90.0), driver.answer_line(lines[1])]
    words = ["drive", str(story.task), str(plan), "--quiet"]
    done = CliRunner().invoke(app, words, input="\n".join(lines))
    assert done.exit_code == 0
    assert [json.loads(line) for line in done.stdout.splitlines()] == ours
    assert set(ours[1]) == {"error"}


def test_campaign(story: Story, campaigned: mr.Campaigned) -> None:
    campaigned.save(story.ours / "campaign")
    # the store of a call without a folder is gone with it
    assert set(contents(story.ours / "campaign")) == {"campaign.json", "report.html"}
    text = (story.ours / "campaign" / "campaign.json").read_text(encoding="utf-8")
    assert json.loads(text) == campaigned.document
    assert campaigned.document["parts"][0]["runs"] == 60
    assert (campaigned.verdict, campaigned.positive, campaigned.left) == ("measured", True, {})


def test_reproduce(story: Story) -> None:
    made = mr.reproduce("table-1", quick=True)
    made.save(story.ours / "paper")
    assert set(contents(story.ours / "paper")) == {"reproduction.json", "index.html"}
    assert str(made).startswith("table-1: ")
    assert "REPRODUCED" in made._repr_html_()
