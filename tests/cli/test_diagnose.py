"""``meso-robust diagnose`` as a user meets it: exit status, messages, files, and going on later."""

from __future__ import annotations

import io
import json
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rich.console
from rich.progress import Progress, TaskID
from typer.testing import CliRunner, Result

from meso_robust.cli import app
from meso_robust.cli.console import Reporter
from meso_robust.cli.diagnose import STATE
from meso_robust.diagnosis.document import DiagnosisDocument, Verdict
from meso_robust.diagnosis.evidence import Evidence
from meso_robust.errors import InputError
from meso_robust.recordings import RecordingSet, write_set
from meso_robust.recordings.direct.run import DirectTests
from tests.recordings.planted import clean, planted, poses
from tests.reporting import diagnoses

KEPT = f"{7:032x}.npz"
RESULTS = ["diagnosis.json", "model.toml", "report.html"]


@dataclass(frozen=True, slots=True)
class Made:
    """Stands for what the diagnosis found, so that these tests are of the command line alone."""

    verdict: Verdict
    doubts: tuple[str, ...] = ()

    def document(self, version: str, remarks: tuple[str, ...]) -> DiagnosisDocument:
        made = diagnoses.document(self.verdict)
        notes = (f"version {version}", *remarks)
        return made.model_copy(
            update={"provenance": made.provenance.model_copy(update={"notes": notes})}
        )

    def evidence(self) -> Evidence:
        return diagnoses.evidence(self.verdict)

    def model_toml(self, version: str) -> str:
        return "model = 'viscous'\n"


@pytest.fixture(autouse=True)
def _page(monkeypatch: pytest.MonkeyPatch) -> None:
    """A line for the page, which has tests of its own and takes a second."""

    def page(
        document: DiagnosisDocument, evidence: Evidence, source: str, direct: DirectTests
    ) -> str:
        assert direct.findings == ()
        return f"{document.verdict} of {Path(source).name}, {len(evidence.files)} recordings"

    monkeypatch.setattr("meso_robust.reporting.diagnosis.diagnosis_report", page)


@pytest.fixture
def given(monkeypatch: pytest.MonkeyPatch) -> Callable[..., list[dict[str, Any]]]:
    """Puts something in the place of the diagnosis; the list has what it is called with."""

    def put(verdict: Verdict = "named", raises: BaseException | None = None) -> list[Any]:
        asked: list[dict[str, Any]] = []

        def diagnose(recordings: RecordingSet, **options: Any) -> Made:
            asked.append({"recordings": recordings, **options})
            options["told"]("refitting [viscous]", 0, 3)
            options["told"]("refitting [viscous]", 2, 3)
            options["told"]("simulating", 0, 1)
            options["store"].mkdir(parents=True, exist_ok=True)
            (options["store"] / KEPT).write_text("half", encoding="utf-8")
            if raises is not None:
                raise raises
            return Made(verdict)

        room = "meso_robust.diagnosis"
        monkeypatch.setattr(f"{room}.diagnose.diagnose", diagnose)
        monkeypatch.setattr(f"{room}.answer.document", Made.document)
        monkeypatch.setattr(f"{room}.evidence.evidence", Made.evidence)
        monkeypatch.setattr(f"{room}.answer.model_toml", Made.model_toml)
        return asked

    return put


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_set(tmp_path / "set", clean())
    return tmp_path / "set"


def run(*words: str | Path) -> Result:
    return CliRunner().invoke(app, ["diagnose", *map(str, words)])


@pytest.mark.parametrize(
    ("verdict", "status"), [("consistent", 0), ("named", 0), ("ambiguous", 1), ("unknown", 1)]
)
def test_the_verdict_decides_the_exit_status(
    given: Any, folder: Path, tmp_path: Path, verdict: Verdict, status: int
) -> None:
    given(verdict)
    out = tmp_path / "out"

    done = run(folder, "--out", out)

    assert done.exit_code == status, done.output
    assert sorted(path.name for path in out.iterdir()) == RESULTS
    assert done.stdout.splitlines()[0].startswith(f"{verdict.upper()}: The reason of {verdict}")
    assert done.stdout.splitlines()[-1] == f"report: {out / 'report.html'}"
    written = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    assert written["verdict"] == verdict
    page = (out / "report.html").read_text(encoding="utf-8")
    assert page == f"{verdict} of set, 12 recordings"
    assert (out / "model.toml").read_text(encoding="utf-8") == Made(verdict).model_toml("")


def test_the_summary_says_what_where_and_how_much(given: Any, folder: Path, tmp_path: Path) -> None:
    given("named")
    said = run(folder, "--out", tmp_path / "out").stdout
    assert "dry_friction (support): ratio 0.21 [0.18, 0.24], probability 0.97" in said
    assert "where: push_03.csv at 1.90–7.00 s (one tip): y, 12.3 σ" in said
    assert "push_05.csv" not in said  # the fourth span of five
    assert "and 2 more spans" in said
    assert (
        "held-out error 4.1 → 1.05 σ (noise 1 σ, of it repeatability 0.07 σ), 4.92 → 1.26 µm"
        in said
    )


def test_json_is_the_document_and_nothing_else(given: Any, folder: Path, tmp_path: Path) -> None:
    given("named")
    done = run(folder, "--out", tmp_path / "out", "--json")
    assert DiagnosisDocument.model_validate_json(done.stdout).verdict == "named"
    assert done.stdout == (tmp_path / "out" / "diagnosis.json").read_text(encoding="utf-8")
    assert done.stderr == ""


def test_quiet_says_the_verdict(given: Any, folder: Path, tmp_path: Path) -> None:
    given("unknown")
    done = run(folder, "--out", tmp_path / "out", "--quiet")
    assert (done.exit_code, len(done.output.splitlines())) == (1, 1)
    assert done.output.startswith("UNKNOWN: ")


def test_options_and_remarks_reach_the_diagnosis(
    given: Any, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = given("named")
    monkeypatch.setattr("meso_robust.recordings.usable.Usable.warnings", ("push_00.csv: odd",))

    done = run(
        folder, "--out", tmp_path / "out", "--seed", "7", "--quick", "--model", "three_point"
    )

    (one,) = asked
    assert (one["model"], one["quick"], one["seed"]) == ("three_point", True, 7)
    assert one["store"] == tmp_path / "out" / STATE
    assert len(one["recordings"].recordings) == 3
    notes = json.loads((tmp_path / "out" / "diagnosis.json").read_text())["provenance"]["notes"]
    assert notes[1:] == ["push_00.csv: odd"]
    assert "  push_00.csv: odd" in done.stdout.splitlines()


def test_stages_are_said_once_where_there_is_no_terminal(
    given: Any, folder: Path, tmp_path: Path
) -> None:
    given("named")
    lines = run(folder, "--out", tmp_path / "out").stderr.splitlines()
    assert lines == [
        "checking the recordings ...",
        "refitting [viscous] ...",
        "simulating ...",
        "writing the results ...",
    ]


def test_what_somebody_else_keeps_there_stays(given: Any, folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    for name in (".state", STATE):
        (out / name).mkdir(parents=True)
        (out / name / "mine.npz").write_text("mine", encoding="utf-8")
    given("named")

    assert run(folder, "--out", out).exit_code == 0

    assert sorted(path.name for path in out.iterdir()) == sorted([".state", STATE, *RESULTS])
    for name in (".state", STATE):
        assert [path.name for path in (out / name).iterdir()] == ["mine.npz"]


def test_an_interrupted_run_goes_on_with_what_it_kept(
    given: Any, folder: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    first = given(raises=KeyboardInterrupt())

    done = run(folder, "--out", out)

    assert done.exit_code == 130
    assert done.stderr.splitlines()[-1] == "meso-robust: interrupted; run again to go on"
    assert "Traceback" not in done.output
    assert [path.name for path in out.iterdir()] == [STATE]
    assert (out / STATE / KEPT).read_text() == "half"

    second = given("named")
    assert run(folder, "--out", out).exit_code == 0
    assert second[0]["store"] == first[0]["store"]
    assert sorted(path.name for path in out.iterdir()) == RESULTS


def test_a_diagnosis_that_refuses_ends_with_its_message(
    given: Any, folder: Path, tmp_path: Path
) -> None:
    given(raises=InputError("--model magic: must be one of viscous; choose one"))
    done = run(folder, "--out", tmp_path / "out", "--model", "magic")
    assert done.exit_code == 2
    assert "must be one of viscous" in done.stderr
    assert "Traceback" not in done.output
    assert not (tmp_path / "out" / "diagnosis.json").exists()


def test_the_recordings_are_not_written_over(given: Any, folder: Path) -> None:
    asked = given()
    before = {path: path.read_bytes() for path in folder.iterdir()}
    done = run(folder, "--out", folder)
    assert done.exit_code == 2
    assert "folder of the recordings" in done.stderr
    assert before == {path: path.read_bytes() for path in folder.iterdir()}
    assert not asked


def test_poses_that_are_no_measurements_are_not_diagnosed(given: Any, tmp_path: Path) -> None:
    asked = given()
    dirty = poses()
    dirty[60:200] = 0.0  # more than half of one recording of three
    write_set(tmp_path / "set", planted(poses=dirty))
    done = run(tmp_path / "set", "--out", tmp_path / "out")
    assert done.exit_code == 2
    assert "push_01.csv, line" in done.stderr
    assert "--repair" in done.stderr
    assert not (tmp_path / "out").exists()
    assert not asked


def test_a_folder_without_a_set_and_an_out_that_is_a_file_are_refused(
    given: Any, folder: Path, tmp_path: Path
) -> None:
    given()
    (tmp_path / "empty").mkdir()
    (tmp_path / "file").write_text("mine", encoding="utf-8")
    no_set = run(tmp_path / "empty", "--out", tmp_path / "out")
    assert (no_set.exit_code, "set.toml" in no_set.stderr) == (2, True)
    a_file = run(folder, "--out", tmp_path / "file")
    assert (a_file.exit_code, "not a writable folder" in a_file.stderr) == (2, True)
    assert (tmp_path / "file").read_text(encoding="utf-8") == "mine"
    assert not (tmp_path / "out").exists()


def test_the_schema_is_published() -> None:
    done = CliRunner().invoke(app, ["schema", "diagnosis"])
    assert done.exit_code == 0
    assert "verdict" in json.loads(done.stdout)["required"]


def test_a_terminal_shows_a_bar_for_each_stage(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = rich.console.Console(file=io.StringIO(), force_terminal=True)
    monkeypatch.setattr(rich.console, "Console", lambda **_: terminal)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    shown: dict[str, tuple[float | None, float]] = {}
    update = Progress.update

    def spied(progress: Progress, task: TaskID, **given: Any) -> None:
        update(progress, task, **given)
        shown.update({one.description: (one.total, one.completed) for one in progress.tasks})

    monkeypatch.setattr(Progress, "update", spied)
    with Reporter(quiet=False).following() as told:
        told("refitting", 1, 3)
        assert shown == {"refitting": (3, 1)}
        told("simulating", 0, 1)
        assert shown == {"refitting": (1, 1), "simulating": (None, 0)}
        told("simulating", 1, 1)
        assert shown["simulating"] == (1, 1)


def test_the_set_that_is_refused_would_be_taken_without_its_fault(
    given: Any, tmp_path: Path
) -> None:
    asked = given()
    write_set(tmp_path / "set", replace(clean(), recordings=planted().recordings))
    assert run(tmp_path / "set", "--out", tmp_path / "out", "--quiet").exit_code == 0
    assert np.isfinite(asked[0]["recordings"].recordings[1].poses).all()
