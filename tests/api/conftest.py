"""A user's whole story, told by calls; what costs time is done once."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

import meso_robust as mr
from meso_robust.cli import app
from meso_robust.tasks import PAPER
from tests.tracking.pushes import Filmed, push

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


@pytest.fixture(scope="session")
def story(tmp_path_factory: pytest.TempPathFactory) -> Story:
    folder = tmp_path_factory.mktemp("api") / "Prüfung µ 試験 été"
    folder.mkdir()
    return Story(folder)


@pytest.fixture(scope="session")
def planned(story: Story) -> mr.Planned:
    found = mr.plan(mr.Task.load(story.task), samples=SAMPLES, seed=3)
    found.save(story.ours / "plan")
    return found


@pytest.fixture(scope="session")
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


@pytest.fixture(scope="session")
def identified(recorded: Path) -> mr.Identified:
    return mr.identify(recorded, starts=2)


@pytest.fixture(scope="session")
def filmed(story: Story) -> Filmed:
    return push(story.task.with_name("Stoß 1.avi"), 4)


@pytest.fixture(scope="session")
def tracked(story: Story, filmed: Filmed) -> mr.Tracked:
    return mr.track(
        filmed.path,
        task=story.task,
        tip_radius_um=12.5,
        pixel_um=5.26,
        start=(None, None, 0.0),
        probes={"left": first_tip(filmed)},
    )


def first_tip(filmed: Filmed) -> tuple[float, float]:
    """Of the first frame, um."""
    x, y = (1e6 * filmed.tips[0, 0]).tolist()
    return x, y


@pytest.fixture(scope="session")
def campaign_file(story: Story, planned: mr.Planned) -> Path:
    file = story.task.with_name("campaign.toml")
    file.write_text(
        'schema = "meso-robust/campaign/1"\nname = "µ"\n[[part]]\nname = "rate"\n'
        'kind = "monte-carlo"\nplan = "by calls/plan/plan.json"\nexecutions = 60\nchunk = 30\n',
        encoding="utf-8",
    )
    return file


@pytest.fixture(scope="session")
def campaigned(campaign_file: Path) -> mr.Campaigned:
    return mr.campaign(campaign_file, workers=1)
