"""``meso-robust plan --model`` as a user meets it: the promise made again from a fitted model."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from meso_robust.cli import app
from meso_robust.identification.document import read_model
from meso_robust.task import load_task
from meso_robust.tasks import PAPER
from meso_robust.transfer.promise import model_hash
from tests.transfer.models import written
from tests.transfer.plans import share

RUNNER = CliRunner()
SURE = {"rho_um2": (374_000.0, 379_000.0), "mu": (0.325, 0.335)}
FILES = ["certificate.json", "plan.json", "premises.json", "report.html", "task.toml"]


def planned(model: Path, out: Path, *more: str) -> Any:
    asked = ["plan", "--model", str(model), "--out", str(out), "--samples", "10", *more]
    return RUNNER.invoke(app, asked)


@pytest.fixture(scope="module")
def larger(tmp_path_factory: pytest.TempPathFactory) -> tuple[Any, Path, Path]:
    """A part whose edges stand out by 2.9 to 3.1 um."""
    folder = tmp_path_factory.mktemp("larger")
    sizes = {"part_geometry.x_um": (2.9, 3.1), "part_geometry.y_um": (2.9, 3.1)}
    model = written(folder, sizes, base=SURE)
    with pytest.MonkeyPatch.context() as patched:
        share(patched)
        return planned(model, folder / "out"), folder / "out", model


@pytest.fixture(scope="module")
def sticky(tmp_path_factory: pytest.TempPathFactory) -> tuple[Any, Path]:
    folder = tmp_path_factory.mktemp("sticky")
    model = written(folder, {"tip_adhesion.pull_um_s": (20.0, 30.0)})
    with pytest.MonkeyPatch.context() as patched:
        share(patched)
        return planned(model, folder / "out"), folder / "out"


def test_a_part_of_another_size_is_proved_and_what_changed_is_told(
    larger: tuple[Any, Path, Path],
) -> None:
    result, out, model = larger

    assert result.exit_code == 0, result.output
    assert result.stdout.startswith("PROVED")
    assert "part.length_um: 1616 -> 1622 (part_geometry)" in result.stdout
    assert "uncertainty.friction: 0.3 … 0.36 -> 0.325 … 0.335 (mu)" in result.stdout
    assert sorted(path.name for path in out.iterdir()) == FILES
    told = json.loads((out / "premises.json").read_text())
    certificate = json.loads((out / "certificate.json").read_text())
    task = load_task(out / "task.toml")
    assert told["verdict"] == certificate["verdict"] == "PROVED"
    assert told["beyond"] is None  # all sizes are in the task itself: nothing is claimed beside it
    assert task.part.size_tolerance_um == pytest.approx(0.2)
    assert told["task_hash_before"] == load_task(PAPER).hash
    assert told["task_hash"] == certificate["task_hash"] == task.hash
    assert certificate["made_with"]["model"] == model_hash(read_model(model))
    assert task.rectangle("this test").length_um == 1622.0


def test_a_ratio_that_the_model_gave_is_not_to_be_measured_by_fitting_again(
    larger: tuple[Any, Path, Path],
) -> None:
    result, out, _ = larger
    page = (out / "report.html").read_text(encoding="utf-8")
    advice = "the value is the fitted model's: compare the outline of the recordings with the part"

    assert result.stderr.count("note: uncertainty.film_ratio_um2 = 376500") == 1
    assert advice in result.stderr
    assert advice in page.replace("&#39;", "'")
    assert "`meso-robust identify` measures it" not in result.stderr
    assert "measures it" not in page


def test_the_certificate_is_verified_for_the_changed_task_and_for_no_other(
    larger: tuple[Any, Path, Path],
) -> None:
    certificate, task = (str(larger[1] / name) for name in ("certificate.json", "task.toml"))

    verified = RUNNER.invoke(app, ["check", certificate, task])
    other = RUNNER.invoke(app, ["check", certificate])

    assert verified.exit_code == 0, verified.output
    assert "VERIFIED" in verified.stdout
    assert other.exit_code == 2
    assert "about another task" in other.stderr


def test_a_broken_premise_is_status_1_and_named_everywhere(sticky: tuple[Any, Path]) -> None:
    result, out = sticky
    told = json.loads((out / "premises.json").read_text())

    assert result.exit_code == 1
    assert result.stdout.startswith("UNKNOWN")
    for text in (result.stdout, told["why"], (out / "report.html").read_text()):
        assert "Coulomb friction at point contacts" in text
        assert "derivations/one_point_sticking.py" in text
    assert told["evidence"]["runs"] == 10
    assert "Evidence, not proof" in (out / "report.html").read_text()
    assert sorted(path.name for path in out.iterdir()) == FILES


def test_nothing_of_a_broken_promise_is_verified(sticky: tuple[Any, Path]) -> None:
    certificate, task = (str(sticky[1] / name) for name in ("certificate.json", "task.toml"))

    result = RUNNER.invoke(app, ["check", certificate, task])

    assert result.exit_code == 1
    assert "NOTHING CLAIMED" in result.stdout
    assert json.loads(Path(certificate).read_text())["margin"]["factor"] == 0.0


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('schema = "meso-robust/model/1"', 'schema = "meso-robust/model/9"', ("schema", "model/1")),
        ("width_um = 837.0", "width_um = 900.0", ("part", "1616 x 900 um", "1616 x 837 um")),
        ("+dry_friction", "+wet_friction", ("wet_friction", "catalogue")),
        ("viscous+", "elastic+", ("elastic", "viscous", "identify")),
        ("+dry_friction", "", ("dry_friction", "must be the same")),
        ('"dry_friction.ratio"', '"dry_friction.ration"', ("ration", "dry_friction.ratio")),
        ("[part]", "[part", ("TOML",)),
    ],
)
def test_a_bad_model_is_status_2_one_message_no_files(
    tmp_path: Path, old: str, new: str, words: tuple[str, ...]
) -> None:
    path = written(tmp_path, {"dry_friction.ratio": (0.2, 0.3)})
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")

    result = planned(path, tmp_path / "out")

    assert result.exit_code == 2
    assert result.stdout == ""
    assert str(path) in result.stderr
    assert all(word in result.stderr for word in words), result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("option", ["--widest", "--policy", "--maps"])
def test_options_about_a_task_alone_are_refused_with_what_to_do(
    tmp_path: Path, option: str
) -> None:
    result = planned(written(tmp_path), tmp_path / "out", option)

    assert result.exit_code == 2
    assert "task.toml" in result.stderr
    assert not (tmp_path / "out").exists()


def test_no_plan_for_the_model_s_ranges_is_status_1_and_says_them(tmp_path: Path) -> None:
    wide = {"rho_um2": (372_000.0, 381_000.0), "mu": (0.0, 0.9)}
    task = tmp_path / "start.toml"
    text = PAPER.read_text(encoding="utf-8")
    task.write_text(text.replace("theta_deg = 90.0", "theta_deg = 45.0"), encoding="utf-8")
    model = written(tmp_path, base=wide)
    asked = ["plan", str(task), "--model", str(model), "--out", str(tmp_path / "out")]

    result = RUNNER.invoke(app, asked)

    assert result.exit_code == 1
    assert "UNKNOWN" in result.stderr
    assert "uncertainty.friction = 0 … 0.9" in result.stderr
    assert [file.name for file in (tmp_path / "out").iterdir()] == ["report.html"]
