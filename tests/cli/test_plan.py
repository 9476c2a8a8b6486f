"""``meso-robust plan`` as a user meets it: exit status, messages, files."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from meso_robust.checker.verdict import Answer as Verified
from meso_robust.cli import app
from meso_robust.laboratory.making import outline as original
from meso_robust.pipeline import SimulatorContradictsProofError
from meso_robust.reporting.answer import verified_words
from meso_robust.tasks import PAPER
from tests.nightly import at_night

RUNNER = CliRunner()


def task_file(folder: Path, old: str = "", new: str = "") -> Path:
    """The paper's task with one piece of text replaced."""
    text = PAPER.read_text(encoding="utf-8")
    assert old in text
    path = folder / "task.toml"
    path.write_text(text.replace(old, new) if old else text, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def proved(tmp_path_factory: pytest.TempPathFactory) -> tuple[Any, Path]:
    out = tmp_path_factory.mktemp("proved") / "out"
    return RUNNER.invoke(app, ["plan", "--out", str(out), "--samples", "50"]), out


def test_positive_answer_is_status_0_with_three_files(proved: tuple[Any, Path]) -> None:
    result, out = proved

    assert result.exit_code == 0, result.output
    assert "PROVED" in result.stdout
    assert sorted(path.name for path in out.iterdir()) == [
        "certificate.json",
        "plan.json",
        "report.html",
    ]


def test_the_page_repeats_how_long_was_searched(proved: tuple[Any, Path]) -> None:
    page = (proved[1] / "report.html").read_text(encoding="utf-8")
    assert "meso-robust plan TASK.toml --samples 50 --seed 0 --search-s 90" in page


def test_a_plan_is_verified_if_that_is_asked(tmp_path: Path) -> None:
    def planned(*options: str) -> Any:
        return RUNNER.invoke(app, ["plan", "--out", str(tmp_path), "--samples", "5", *options])

    asked = planned("--check")
    assert asked.exit_code == 0, asked.output
    assert "checked: VERIFIED" in asked.stdout
    assert json.loads((tmp_path / "check.json").read_text())["verdict"] == "VERIFIED"
    assert "Checked: VERIFIED" in (tmp_path / "report.html").read_text(encoding="utf-8")
    assert planned("--quiet").stdout == "PROVED\n"
    assert not (tmp_path / "check.json").exists()  # said of another certificate


@pytest.mark.parametrize(
    ("fault", "wrapped"),
    [(KeyboardInterrupt(), False), (KeyboardInterrupt(), True), (ValueError(), False)],
)
def test_a_plan_is_kept_whatever_becomes_of_its_check(
    fault: BaseException, wrapped: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def faulty(*_: object, **__: object) -> None:
        if wrapped:  # as compiled code hands it on
            raise SystemError from fault
        raise fault

    monkeypatch.setattr("meso_robust.api.checked.checked", faulty)
    options = ["--check", "--samples", "5", "--out", str(tmp_path)]
    result = RUNNER.invoke(app, ["plan", *options])
    if isinstance(fault, KeyboardInterrupt):
        assert result.exit_code == 130
        assert "its certificate is not checked" in result.stderr
    else:
        assert result.exception is fault
    assert (tmp_path / "certificate.json").exists()
    assert not (tmp_path / "check.json").exists()


def test_what_the_checker_says_of_a_plan_that_fails_is_told() -> None:
    said = verified_words(Verified(verdict="WITNESS CONFIRMED", claims="the plan fails"), "REFUTED")
    assert said == "checked: WITNESS CONFIRMED: the plan fails"


@at_night  # a search of its own
def test_a_plan_that_fails_is_checked_too(tmp_path: Path) -> None:
    task = task_file(tmp_path, "friction = [0.30, 0.36]", "friction = [0.05, 0.9]")
    task.write_text(task.read_text().replace("[probe]", '[probe]\nheadings = ["-x"]'))
    options = ["--check", "--samples", "100", "--out", str(tmp_path / "out")]
    result = RUNNER.invoke(app, ["plan", str(task), *options])
    assert result.exit_code == 1, result.output
    assert "checked: WITNESS" in result.stdout


def test_plan_moves_follow_the_contract(proved: tuple[Any, Path]) -> None:
    plan = json.loads((proved[1] / "plan.json").read_text())
    first = plan["moves"][0]

    assert set(first) == {"step", "primitive", "probes", "travel_um", "speed_um_s", "expect"}
    assert [probe["name"] for probe in first["probes"]] == ["dtp_top", "dtp_bottom"]
    assert first["travel_um"][0] < 0.0
    assert first["travel_um"][1] == 0.0
    turning = next(move for move in plan["moves"] if move["primitive"] == "rotation")
    assert {probe["name"]: probe["passive"] for probe in turning["probes"]}["stp"] is True
    # both tips of the active probe stand at one x, the spacing of the task apart
    top, bottom = first["probes"][0]["start_um"], first["probes"][1]["start_um"]
    assert top[0] == bottom[0]
    assert top[1] - bottom[1] == pytest.approx(580.0, abs=1e-3)


def test_certificate_numbers_are_exact_doubles(proved: tuple[Any, Path]) -> None:
    certificate = json.loads((proved[1] / "certificate.json").read_text())
    derivations = certificate["claim"]["inequalities"]

    for step in certificate["steps"]:
        for coordinate in ("x", "y", "theta"):
            unit = "rad" if coordinate == "theta" else "m"
            low, high = map(float.fromhex, step["post_exact"][f"{coordinate}_{unit}"])
            shown = step["post"][f"{coordinate}_{'deg' if unit == 'rad' else 'um'}"]
            factor = 180.0 / 3.141592653589793 if unit == "rad" else 1e6
            assert low < high
            assert shown[0] <= low * factor
            assert high * factor <= shown[1]
            assert shown[1] - shown[0] <= (high - low) * factor + 0.003
        assert all(o["inequality"] in derivations for o in step["obligations"])
    assert all(Path(file).exists() for file in derivations.values() if file is not None)


def test_same_seed_same_certificate(proved: tuple[Any, Path], tmp_path: Path) -> None:
    RUNNER.invoke(app, ["plan", "--out", str(tmp_path), "--samples", "50"])

    for name in ("certificate.json", "plan.json"):
        assert (tmp_path / name).read_bytes() == (proved[1] / name).read_bytes()


def test_json_prints_the_certificate_and_nothing_else(tmp_path: Path) -> None:
    result = RUNNER.invoke(app, ["plan", "--out", str(tmp_path), "--samples", "10", "--json"])

    assert json.loads(result.stdout) == json.loads((tmp_path / "certificate.json").read_text())


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("length_um = 1616.0", "", ("part.length_um", "missing")),
        ("length_um = 1616.0", 'length_um = "long"', ("part.length_um", "'long'", "number")),
        (
            "width_um = 837.0",
            "width_um = -837.0",
            ("part.width_um", "-837.0", "greater than or equal to 1"),
        ),
        ("friction = [0.30, 0.36]", "friction = [0.36, 0.30]", ("friction", "0.36, 0.3", "lower")),
        ("friction = [0.30, 0.36]", "friction = []", ("friction",)),
        ("x_um = 2060.4", "x_um = nan", ("start.x_um", "nan", "finite")),
        ("x_um = 2060.4", "x_um = inf", ("start.x_um", "inf", "finite")),
        ("[part]", "[part]\nheight_um = 40.0", ("part.height_um", "unknown")),
        ('schema = "meso-robust/task/1"', "", ("schema", "missing")),
        ("[part]", "[part", ("TOML",)),
    ],
)
def test_bad_task_is_status_2_one_message_no_files(
    tmp_path: Path, old: str, new: str, words: tuple[str, ...]
) -> None:
    out = tmp_path / "out"
    task = task_file(tmp_path, old, new)

    result = RUNNER.invoke(app, ["plan", str(task), "--out", str(out)])

    assert result.exit_code == 2
    assert result.stdout == ""
    assert str(task) in result.stderr
    assert all(word in result.stderr for word in words), result.stderr
    assert "Traceback" not in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
    assert not out.exists()


def test_missing_task_file_is_status_2(tmp_path: Path) -> None:
    result = RUNNER.invoke(app, ["plan", str(tmp_path / "no.toml"), "--out", str(tmp_path / "o")])

    assert result.exit_code == 2
    assert "no.toml" in result.stderr


def test_out_that_is_a_file_is_status_2_before_any_work(tmp_path: Path) -> None:
    path = tmp_path / "taken"
    path.write_text("mine")

    result = RUNNER.invoke(app, ["plan", "--out", str(path)])

    assert result.exit_code == 2
    assert "taken" in result.stderr
    assert path.read_text() == "mine"


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("theta_deg = 90.0", "theta_deg = 45.0", "from upright|135.0 deg from the start"),
        ("theta_deg = 90.0", "theta_deg = 0.0", "turns the part by one quarter"),
    ],
)
def test_start_that_no_primitive_can_handle_is_status_1_unknown_and_why(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    out = tmp_path / "out"

    result = RUNNER.invoke(app, ["plan", str(task_file(tmp_path, old, new)), "--out", str(out)])

    assert result.exit_code == 1
    assert "UNKNOWN" in result.stderr
    assert any(word in result.stderr for word in words.split("|")), result.stderr
    assert [file.name for file in out.iterdir()] == ["report.html"]


@at_night
def test_a_start_too_close_is_unknown_for_a_probe_on_one_side_and_proved_for_any(
    tmp_path: Path,
) -> None:
    any_side = task_file(tmp_path, "x_um = 2060.4", "x_um = 400.0")
    one_side = tmp_path / "one_side.toml"
    text = any_side.read_text(encoding="utf-8")
    one_side.write_text(text.replace("[probe]", '[probe]\nheadings = ["-x"]'), encoding="utf-8")

    refused = RUNNER.invoke(app, ["plan", str(one_side), "--out", str(tmp_path / "one")])
    proved = RUNNER.invoke(
        app, ["plan", str(any_side), "--out", str(tmp_path / "any"), "--samples", "20"]
    )

    assert (refused.exit_code, proved.exit_code) == (1, 0)
    assert "further from the goal" in refused.stderr


@at_night
def test_goal_that_is_too_tight_is_not_proved(tmp_path: Path) -> None:
    task = task_file(tmp_path, "position_tolerance_um = 76.0", "position_tolerance_um = 20.0")
    text = task.read_text(encoding="utf-8")
    # a probe on each side would be searched for minutes, and find nothing either
    task.write_text(text.replace("[probe]", '[probe]\nheadings = ["-x"]'), encoding="utf-8")

    result = RUNNER.invoke(
        app, ["plan", str(task), "--out", str(tmp_path / "o"), "--samples", "20"]
    )

    assert result.exit_code == 1
    assert "PROVED" not in result.stdout.replace("not proved", "").replace("still proved", "")


def test_simulator_that_contradicts_a_proof_is_never_reported_as_proved(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    from meso_robust.laboratory import making

    monkeypatch.setattr(
        making, "outline", lambda setup: 0.9 * original(setup)
    )  # a smaller part in the simulator only
    with pytest.raises(SimulatorContradictsProofError, match="breaks a PROVED claim"):
        RUNNER.invoke(
            app, ["plan", "--out", str(tmp_path), "--samples", "20"], catch_exceptions=False
        )
    assert not list(tmp_path.iterdir())


def test_internal_fault_is_status_3() -> None:
    code = "import meso_robust.cli as c; c.app = lambda: 1 / 0; c.main()"

    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)

    assert done.returncode == 3
    assert "internal fault" in done.stderr


def test_help_needs_none_of_the_heavy_packages() -> None:
    code = (
        "import sys; from typer.testing import CliRunner; from meso_robust.cli import app; "
        "assert CliRunner().invoke(app, ['--help']).exit_code == 0; "
        "heavy = {'numba', 'casadi', 'sympy', 'scipy', 'matplotlib', 'numpy'} & set(sys.modules); "
        "sys.exit(str(heavy) if heavy else 0)"
    )

    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)

    assert done.returncode == 0, done.stderr


def test_schema_describes_the_task() -> None:
    result = RUNNER.invoke(app, ["schema", "task"])

    assert "film_ratio_um2" in json.dumps(json.loads(result.stdout))
    assert RUNNER.invoke(app, ["schema", "tax"]).exit_code == 2
