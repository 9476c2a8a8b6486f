"""Results never replace what they come from, and go where files can be, or nowhere at all."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import meso_robust as mr
from meso_robust.cli import app
from meso_robust.cli.plan import written
from meso_robust.errors import InputError
from meso_robust.example import copy_example
from meso_robust.files import check_folder, write_all
from meso_robust.tasks import PAPER
from tests.nightly import at_night

REPORTS = Path(__file__).parents[1] / "reports" / "paper_task"
SMALL = PAPER.with_name("small.toml")
MODEL = PAPER.with_name("small_model.toml")


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A user's folder, in which the commands are given."""
    for name, source in {
        "task.toml": PAPER,
        "plan.json": REPORTS / "plan.json",
        "simulation.json": REPORTS / "certificate.json",
        "m.toml": MODEL,
    }.items():
        shutil.copy(source, tmp_path / name)
    for name in ("set.toml", "push.csv", "calibration.toml"):
        (tmp_path / name).write_text("mine", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    for work in (
        "pipeline.make",
        "pipeline.judge",
        "laboratory.simulation.simulated",
        "tracking.job.run",
    ):
        monkeypatch.setattr(f"meso_robust.{work}", _never)
    return tmp_path


def _never(*_: object, **__: object) -> None:
    raise AssertionError("work was begun")


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.parametrize(
    ("line", "name"),
    [
        ("plan task.toml --model m.toml --out .", "task.toml"),
        ("plan task.toml --widest --out .", "task.toml"),
        ("plan linked.toml --widest --out .", "task.toml"),
        ("certify task.toml plan.json --out .", "plan.json"),
        ("track v/push.avi --set set.toml --pixel-um 5 --out .", "set.toml"),
        ("track v/push.avi --task task.toml --commands . --out .", "push.csv"),
        ("track v/push.avi --calibration calibration.toml --out .", "calibration.toml"),
        ("simulate task.toml plan.json --witness simulation.json --out .", "simulation.json"),
    ],
)
def test_no_result_replaces_what_it_comes_from(line: str, name: str, own: Path) -> None:
    (own / "linked.toml").symlink_to("task.toml")
    before = contents(own)

    done = CliRunner().invoke(app, line.split())

    assert done.exit_code == 2, (done.output, done.exception)
    assert f"--out .: {name} would replace" in done.stderr
    assert "give another folder" in done.stderr
    assert contents(own) == before


def test_a_task_may_lie_beside_results_of_other_names(own: Path) -> None:
    done = CliRunner().invoke(app, ["plan", "task.toml", "--out", "."])
    assert isinstance(done.exception, AssertionError)  # the work was begun


@at_night
def test_a_call_replaces_no_task_either(tmp_path: Path) -> None:
    shutil.copy(SMALL, tmp_path / "task.toml")
    found = mr.plan(tmp_path / "task.toml", model=MODEL, samples=1)
    before = contents(tmp_path)
    asked = {"widest": False, "policy": False, "maps": False}
    assert set(found.files()) == set(written(model=MODEL, **asked))  # what the command refuses

    with pytest.raises(InputError, match=r"task\.toml would replace"):
        found.save(tmp_path)

    assert contents(tmp_path) == before
    found.save(tmp_path / "elsewhere")
    assert json.loads((tmp_path / "elsewhere" / "premises.json").read_text(encoding="utf-8"))


def test_a_folder_in_the_place_of_a_file_leaves_all_as_it_was(tmp_path: Path) -> None:
    (tmp_path / "b.html").mkdir()
    (tmp_path / "a.json").write_text("earlier", encoding="utf-8")

    with pytest.raises(InputError, match=r"b\.html is a folder, but"):
        write_all(tmp_path, {"a.json": "1", "b.html": "2"})

    assert (tmp_path / "a.json").read_text(encoding="utf-8") == "earlier"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.json", "b.html"]


PLACES = {
    "too long": "x" * 300,
    "too long below": "new/" + "x" * 300,
    "far too long": "/".join(["x" * 200] * 30),
    "NUL": "a\0b",
    "NUL below": "new/a\0b/c",
    "loop": "loop",
    "below a loop": "loop/c",
    "a link that leads nowhere": "dangling",
}


@pytest.mark.parametrize("place", PLACES)
def test_a_place_that_no_folder_can_have(place: str, tmp_path: Path) -> None:
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "dangling").symlink_to("missing")
    out = tmp_path / PLACES[place]

    calls: list[Any] = [lambda: check_folder(out), lambda: write_all(out, {"a": "1"})]
    if place != "a link that leads nowhere":
        calls.append(lambda: copy_example(out))
    for call in calls:
        with pytest.raises(InputError, match="give a"):
            call()

    assert sorted(path.name for path in tmp_path.iterdir()) == ["dangling", "loop"]


def test_a_folder_that_is_to_be_made_is_none_yet(tmp_path: Path) -> None:
    check_folder(tmp_path / "a" / ".." / "b" / "c", ["d.json"], [None, tmp_path / "d.json"])
    assert list(tmp_path.iterdir()) == []
