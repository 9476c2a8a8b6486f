"""The user's whole story through the API: the same files as the command line, byte by byte."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

import meso_robust as mr
from meso_robust.cli import app
from meso_robust.tasks import PAPER
from tests.tracking.pushes import push

SAMPLES = 30


class Story:
    """A folder with spaces and letters of several languages, told twice."""

    def __init__(self, folder: Path) -> None:
        self.task = folder / "Aufgabe µ.toml"
        shutil.copy(PAPER, self.task)
        self.ours, self.theirs = folder / "by calls", folder / "by words"

    def said(self, verb: str, *words: object, status: int = 0, out: str = "") -> str:
        """What a verb prints."""
        more = ("--out", str(self.theirs / out)) if out else ()
        done = CliRunner().invoke(app, [verb, *map(str, words), *more])
        assert done.exit_code == status, done.output
        return done.stdout

    def same(self, folder: str) -> set[str]:
        """Names of the files of a folder, which are the same in both tellings."""
        ours, theirs = contents(self.ours / folder), contents(self.theirs / folder)
        assert set(ours) == set(theirs)
        for name, content in ours.items():
            assert content == theirs[name], name
        return set(ours)


def contents(folder: Path) -> dict[str, bytes]:
    files = [path for path in folder.rglob("*") if path.is_file()]
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def printed(said: str) -> str:
    """What was printed but for the line that says where the report is."""
    return "\n".join(line for line in said.splitlines() if not line.startswith("report: "))


@pytest.fixture(scope="module")
def story(tmp_path_factory: pytest.TempPathFactory) -> Story:
    folder = tmp_path_factory.mktemp("api") / "Prüfung µ 試験 été"
    folder.mkdir()
    return Story(folder)


@pytest.fixture(scope="module")
def planned(story: Story) -> mr.Planned:
    found = mr.plan(mr.Task.load(story.task), samples=SAMPLES, seed=3)
    found.save(story.ours / "plan")
    return found


@pytest.fixture(scope="module")
def recorded(story: Story, planned: mr.Planned) -> Path:
    """A recording set that was made by a simulation of the plan."""
    plan = story.ours / "plan" / "plan.json"
    simulated = mr.simulate(story.task, plan, samples=5, seed=2, adversarial=False)
    simulated.save(story.ours / "runs")
    simulated.record(story.ours / "runs" / "recordings", 1, mr.camera_of(noise_um=0.5), seed=2)
    assert simulated.all_in_goal
    words = ("--samples", 5, "--seed", 2, "--recordings", 1, "--noise-um", 0.5)
    said = story.said("simulate", story.task, plan, *words, out="runs")
    assert said.startswith(f"{simulated}\nanimation: ")
    return story.ours / "runs" / "recordings"


def test_plan(story: Story, planned: mr.Planned) -> None:
    words = ("--samples", SAMPLES, "--seed", 3)
    said = story.said("plan", story.task, *words, out="plan")
    assert story.same("plan") == {"plan.json", "certificate.json", "report.html"}
    assert printed(said) == str(planned)
    assert planned.proved
    assert planned.margin.factor == planned.certificate.margin.factor > 1.0


def test_certify_by_name_and_by_value(story: Story, planned: mr.Planned) -> None:
    plan = story.ours / "plan" / "plan.json"
    certified = mr.certify(str(story.task), planned, samples=SAMPLES)
    certified.save(str(story.ours / "again"))
    said = story.said("certify", story.task, plan, "--samples", SAMPLES, out="again")
    assert story.same("again") == {"plan.json", "certificate.json", "report.html"}
    assert printed(said) == str(certified)


def test_check_by_name_and_by_value(story: Story, planned: mr.Planned) -> None:
    certificate = story.ours / "plan" / "certificate.json"
    checked = mr.check(certificate, story.task)
    assert checked.verified
    assert story.said("check", certificate, story.task) == f"{checked}\n"
    assert json.loads(story.said("check", certificate, story.task, "--json")) == checked.document
    assert mr.check(planned, planned.task).document == checked.document

    values = json.loads(certificate.read_text(encoding="utf-8"))
    values["steps"][0]["post"]["x_um"][0] += 1.0
    changed = certificate.with_name("changed.json")
    changed.write_text(json.dumps(values), encoding="utf-8")
    rejected = mr.check(changed, story.task)
    changed.unlink()  # the folder is compared
    assert (rejected.verdict, rejected.verified) == ("REJECTED", False)
    assert "REJECTED" in rejected._repr_html_()


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


def test_identify_and_plan_again_with_the_model(story: Story, recorded: Path) -> None:
    identified = mr.identify(recorded, starts=2)
    identified.save(story.ours / "model")
    words = ("--starts", 2)
    said = story.said("identify", recorded, *words, out="model")
    assert printed(said) == str(identified)
    assert {"model.toml", "identification.json", "report.html"} < story.same("model")
    assert (
        identified.document.parameters["mu"].low < 0.33 < identified.document.parameters["mu"].high
    )

    model = story.ours / "model" / "model.toml"
    status = {"PROVED": 0, "REFUTED": 1, "UNKNOWN": 1}
    again = mr.plan(story.task, model=model, samples=5)
    again.save(story.ours / "promise")
    words_ = ("--model", model, "--samples", 5)
    code = status[again.verdict]
    said = story.said("plan", story.task, *words_, status=code, out="promise")
    assert printed(said) == str(again)
    assert "premises.json" in story.same("promise")


def test_standard_tests(story: Story) -> None:
    tests = mr.standard_tests(story.task)
    tests.save(story.ours / "tests")
    said = story.said("identify", story.task, "--plan", out="tests")
    assert said.splitlines()[0] == str(tests)
    assert "experiment.json" in story.same("tests")


def test_track(story: Story, tmp_path: Path) -> None:
    filmed = push(tmp_path / "Stoß 1.avi", 6)
    tip = filmed.tips[0, 0] * 1e6
    tracked = mr.track(
        filmed.path,
        task=story.task,
        tip_radius_um=12.5,
        pixel_um=5.26,
        start=(None, None, 0.0),
        probes={"left": (float(tip[0]), float(tip[1]))},
    )
    tracked.save(story.ours / "track")
    words = ("--task", story.task, "--tip-radius-um", 12.5, "--pixel-um", 5.26)
    where = ("--start", ",,0.0", "--probe", f"left={float(tip[0])},{float(tip[1])}")
    said = story.said("track", filmed.path, *words, *where, out="track")
    assert printed(said) == str(tracked)
    assert {"set.toml", "track.json", "overlay.avi"} < story.same("track")
    assert tracked.tracked
    assert mr.read_recordings(story.ours / "track").set.recordings[0].probe_names == ("left",)


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


def test_campaign(story: Story, planned: mr.Planned) -> None:
    file = story.task.with_name("campaign.toml")
    file.write_text(
        'schema = "meso-robust/campaign/1"\nname = "µ"\n[[part]]\nname = "rate"\n'
        'kind = "monte-carlo"\nplan = "by calls/plan/plan.json"\nexecutions = 60\nchunk = 30\n',
        encoding="utf-8",
    )
    done = mr.campaign(file, workers=1)
    done.save(story.ours / "campaign")
    said = story.said("campaign", file, "--workers", 1, out="campaign")
    assert printed(said) == str(done)
    assert (done.verdict, done.positive, done.left) == ("measured", True, {})
    one, other = (
        json.loads((folder / "campaign" / "campaign.json").read_text(encoding="utf-8"))
        for folder in (story.ours, story.theirs)
    )
    assert one["totals_digest"] == other["totals_digest"]  # the rest tells of times and machines
    # the store of a call without a folder is gone with it
    assert {path.name for path in (story.ours / "campaign").iterdir()} == {
        "campaign.json",
        "report.html",
    }


def test_reproduce(story: Story) -> None:
    made = mr.reproduce("table-1", quick=True)
    made.save(story.ours / "paper")
    said = story.said("reproduce", "table-1", "--quick", out="paper")
    assert printed(said) == str(made)
    values: Callable[[Path], dict[str, object]] = lambda folder: json.loads(  # noqa: E731
        (folder / "paper" / "reproduction.json").read_text(encoding="utf-8")
    )["items"]["table-1"]["rows"]
    assert values(story.ours) == values(story.theirs)
