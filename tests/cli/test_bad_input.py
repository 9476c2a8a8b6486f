"""Whatever a user gives by mistake: exit status 2, one line with the way out, and nothing is left behind."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner

from meso_robust.cli import app
from meso_robust.planning.document import plan_document
from meso_robust.reading import LARGEST_DATA, LARGEST_STATED
from meso_robust.tasks import PAPER
from meso_robust.toml_files import toml_text
from tests.recordings.examples import folder_of
from tests.strategies import paper_chain, paper_task
from tests.test_task_real import BAD as UNREAL, values as task_values

RUNNER = CliRunner()
WAY_OUT = re.compile(
    r"\b(give|correct|fix|record|leave|add|use|try|choose|write|copy|make|install|convert|download|keep|split)\b"
    r"|must|--help|`meso-robust"
)
PART = ("--length-um", "1616", "--width-um", "837", "--tip-radius-um", "12.5")
CAMERA = ("--pixel-um", "5.26")


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Files that are right, by the name of their place in a command."""
    folder = tmp_path_factory.mktemp("good")
    chain = paper_chain()
    sensed = [np.array(step.pre.mid) for step in chain.steps]
    rules = [step.rule for step in chain.steps]
    plan = plan_document(paper_task(), rules, sensed, [step.post for step in chain.steps])
    (folder / "plan.json").write_text(plan.model_dump_json(by_alias=True), encoding="utf-8")
    video = str(folder / "push.avi")
    writer = cv2.VideoWriter(video, cv2.VideoWriter.fourcc(*"MJPG"), 30.0, (64, 48), False)
    for _ in range(3):
        writer.write(np.full((48, 64), 70, np.uint8))
    writer.release()
    (folder / "set").mkdir()
    return {
        "TASK": str(PAPER),
        "PLAN": str(folder / "plan.json"),
        "VIDEO": video,
        "SET": str(folder_of(folder / "set")),
    }


FILES = {
    "plan {bad}": "toml",
    "plan TASK --model {bad}": "toml",
    "certify {bad} PLAN": "toml",
    "certify TASK {bad}": "json",
    "check {bad} TASK": "json",
    "check PLAN {bad}": "toml",
    "simulate {bad} PLAN": "toml",
    "simulate TASK {bad}": "json",
    "simulate TASK PLAN --witness {bad}": "json",
    "drive {bad} PLAN": "toml",
    "drive TASK {bad}": "json",
    "campaign {bad}": "toml",
    "identify --plan {bad}": "toml",
    "track VIDEO --task {bad} --tip-radius-um 12.5 --pixel-um 5.26": "toml",
    "track VIDEO --set {bad} --pixel-um 5.26": "toml",
    "track VIDEO PART --calibration {bad}": "toml",
    "track VIDEO PART CAMERA --commands {bad}": "csv",
    "track VIDEO PART --grid {bad} --pitch-um 100": "png",
    "track {bad} PART CAMERA": "avi",
}
"""Commands with the ending of the file in the place of ``{bad}``."""
SETS = ("identify {bad}", "diagnose {bad}", "recordings {bad}")
"""Commands that take a folder with a set.toml."""


def nested(ending: str, deep: int) -> bytes:
    brackets = "[" * deep + "]" * deep
    return (f"a = {brackets}" if ending == "toml" else brackets).encode()


def deeply(ending: str, deep: int) -> bytes:
    """Sections or objects, which are read by other code than lists."""
    if ending == "toml":
        return f"[{'.'.join('a' * deep)}]\n".encode()
    return ('{"a":' * deep + "1" + "}" * deep).encode()


CONTENTS: dict[str, Callable[[str], bytes]] = {
    "empty": lambda _: b"",
    "garbage": lambda _: bytes(range(256)) * 20,
    "one NUL": lambda _: b"\0",
    "Latin-1": lambda _: "name = 'Prüfung'".encode("latin-1"),
    "UTF-16": lambda _: 'schema = "meso-robust/task/1"'.encode("utf-16"),
    "lists too deep": lambda ending: nested(ending, 100),
    "lists that would fill the stack": lambda ending: nested(ending, 100_000),
    "sections too deep": lambda ending: deeply(ending, 100),
    "sections that would fill the stack": lambda ending: deeply(ending, 20_000),
    "a key twice": lambda ending: b"a = 1\na = 2\n" if ending == "toml" else b'{"a": 1, "a": 2}',
    "unknown keys": lambda ending: b"what = 1\n" if ending == "toml" else b'{"what": 1}',
    "another schema": lambda ending: b'schema = "x"\n' if ending == "toml" else b'{"schema": "x"}',
    "not a number": lambda ending: b"schema = nan\n" if ending == "toml" else b'{"schema": NaN}',
    "a long number": lambda ending: (
        (b"schema = %s\n" if ending == "toml" else b'{"schema": %s}') % (b"9" * 5000)
    ),
}


def ran(line: str, good: dict[str, str], bad: Path, out: Path) -> Any:
    words: list[str] = []
    for word in line.split():
        groups = {"PART": PART, "CAMERA": CAMERA, "{bad}": (str(bad),)}
        words += groups.get(word, (good.get(word, word),))
    takes_out = words[0] not in ("check", "drive", "schema")
    return RUNNER.invoke(app, [*words, *(("--out", str(out)) if takes_out else ())])


def refused(result: Any, name: str, out: Path) -> None:
    assert result.exit_code == 2, (result.exit_code, result.output, result.exception)
    said = [line for line in result.stderr.splitlines() if not line.endswith(" ...")]
    assert len(said) == 1, result.stderr
    assert said[0].startswith("meso-robust: ")
    assert name in said[0]
    assert WAY_OUT.search(said[0].replace(name, "")), said[0]
    assert len(said[0]) < 1000, len(said[0])
    assert not out.exists()
    assert result.stdout == ""


@pytest.mark.parametrize("line", FILES)
def test_a_file_that_is_not_what_it_should_be(
    line: str, good: dict[str, str], tmp_path: Path
) -> None:
    ending = FILES[line]
    for what, content in CONTENTS.items():
        bad = tmp_path / f"{what}.{ending}"
        bad.write_bytes(content(ending))
        refused(ran(line, good, bad, tmp_path / "out"), bad.name, tmp_path / "out")


@pytest.mark.parametrize("name", UNREAL)
def test_a_task_of_tips_and_parts_that_cannot_be(
    name: str, good: dict[str, str], tmp_path: Path
) -> None:
    changes, words = UNREAL[name]
    bad = tmp_path / "unreal.toml"
    bad.write_text(toml_text(task_values(changes)), encoding="utf-8")
    for line in ("plan {bad}", "drive {bad} PLAN"):
        result = ran(line, good, bad, tmp_path / "out")
        refused(result, bad.name, tmp_path / "out")
        assert all(word in result.stderr.replace("µm", "um") for word in words), result.stderr


@pytest.mark.parametrize("line", FILES)
def test_no_file_at_all(line: str, good: dict[str, str], tmp_path: Path) -> None:
    ending, out = FILES[line], tmp_path / "out"
    plain, folder = tmp_path / f"plain.{ending}", tmp_path / f"folder.{ending}"
    plain.write_bytes(b"x")
    folder.mkdir()
    pipe = tmp_path / f"pipe.{ending}"
    os.mkfifo(pipe)
    for bad in (tmp_path / f"nowhere.{ending}", folder, plain / f"below.{ending}", pipe):
        refused(ran(line, good, bad, out), bad.name, out)


@pytest.mark.parametrize("line", [line for line, ending in FILES.items() if ending != "avi"])
def test_a_file_that_is_too_large(line: str, good: dict[str, str], tmp_path: Path) -> None:
    bad = tmp_path / f"large.{FILES[line]}"
    with bad.open("wb") as file:
        file.truncate(300 * 2**20)  # holes: it takes no room on the disk

    result = ran(line, good, bad, tmp_path / "out")

    refused(result, bad.name, tmp_path / "out")
    limit = LARGEST_STATED if FILES[line] == "toml" else LARGEST_DATA
    if FILES[line] != "png":
        assert f"larger than {limit // 2**20} MiB" in result.stderr


@pytest.mark.parametrize("line", SETS)
def test_a_folder_that_is_no_recording_set(line: str, good: dict[str, str], tmp_path: Path) -> None:
    for what, content in CONTENTS.items():
        folder = tmp_path / what
        folder.mkdir()
        (folder / "set.toml").write_bytes(content("toml"))
        refused(ran(line, good, folder, tmp_path / "out"), what, tmp_path / "out")
    plain = tmp_path / "plain.txt"
    plain.write_text("x", encoding="utf-8")
    for bad in (tmp_path / "nowhere", plain):
        refused(ran(line, good, bad, tmp_path / "out"), bad.name, tmp_path / "out")


WRITING = (
    "plan TASK",
    "plan TASK --model TASK",
    "certify TASK PLAN",
    "simulate TASK PLAN",
    "campaign {bad}",
    "identify SET",
    "identify --plan TASK",
    "diagnose SET",
    "recordings SET",
    "track VIDEO PART CAMERA",
    "reproduce table-1 --quick",
)


@pytest.mark.parametrize("line", WRITING)
def test_a_place_that_cannot_be_written_to(line: str, good: dict[str, str], tmp_path: Path) -> None:
    campaign = tmp_path / "c.toml"
    campaign.write_text(
        'schema = "meso-robust/campaign/1"\nname = "x"\n[[part]]\nname = "p"\n'
        'kind = "property"\nproperties = ["formula-values"]\nexamples = 1\n',
        encoding="utf-8",
    )
    taken = tmp_path / "taken"
    taken.write_text("mine", encoding="utf-8")
    # not even root can make a folder there
    for out in (taken, taken / "below", Path("/proc/meso-robust"), Path("/proc/1/no/where")):
        result = ran(line, good, campaign, out)
        assert result.exit_code == 2, (out, result.output, result.exception)
        assert f"--out {out}" in result.stderr
        assert WAY_OUT.search(result.stderr)
        assert taken.read_text(encoding="utf-8") == "mine"
        # known before the work is begun, not after it
        assert "searching" not in result.stderr
        assert "simulating" not in result.stderr


OPTIONS = (
    ("plan --samples 0", "--samples"),
    ("plan --samples -3", "--samples"),
    ("plan --samples 1000000000000", "--samples"),
    ("plan --samples many", "--samples"),
    ("plan --seed -1", "--seed"),
    ("plan --what", "--what"),
    ("plan TASK TASK", "argument"),
    ("certify", "TASK"),
    ("certify TASK PLAN --samples 0", "--samples"),
    ("certify TASK PLAN --samples 1000000000000", "--samples"),
    ("check", "CERTIFICATE"),
    ("check PLAN TASK --what", "--what"),
    ("simulate TASK PLAN --samples 0", "--samples"),
    ("simulate TASK PLAN --samples 1000000000000", "--samples"),
    ("simulate TASK PLAN --recordings -1", "--recordings"),
    ("simulate TASK PLAN --recordings 1000000000000", "--recordings"),
    ("simulate TASK PLAN --noise-um nan", "--noise-um"),
    ("simulate TASK PLAN --noise-um -1", "--noise-um"),
    ("simulate TASK PLAN --noise-um inf", "--noise-um"),
    ("simulate TASK PLAN --noise-deg nan", "--noise-deg"),
    ("simulate TASK PLAN --dropout nan", "--dropout"),
    ("simulate TASK PLAN --dropout 2", "--dropout"),
    ("simulate TASK PLAN --latency-ms nan", "--latency-ms"),
    ("drive TASK", "PLAN"),
    ("campaign", "CAMPAIGN"),
    ("campaign TASK --workers 0", "--workers"),
    ("campaign TASK --workers 2 --scheduler tcp://localhost:1", "--workers"),
    ("derive --what", "--what"),
    ("track", "VIDEOS"),
    ("track VIDEO PART CAMERA --most-lost nan", "--most-lost"),
    ("track VIDEO PART CAMERA --most-lost 2", "--most-lost"),
    ("track VIDEO PART CAMERA --frame-rate-hz nan", "frame rate"),
    ("track VIDEO PART CAMERA --frame-rate-hz -5", "frame rate"),
    ("track VIDEO PART --pixel-um nan", "--pixel-um"),
    ("track VIDEO PART --pixel-um 0", "--pixel-um"),
    ("track VIDEO CAMERA --length-um nan --width-um 837 --tip-radius-um 12.5", "--length-um"),
    ("track VIDEO CAMERA --length-um 1616 --width-um 837 --tip-radius-um nan", "--tip-radius-um"),
    ("track VIDEO PART CAMERA --start nan,0,0", "--start"),
    ("track VIDEO PART CAMERA --start 0,0", "--start"),
    ("track VIDEO PART CAMERA --probe tip=nan,0", "--probe"),
    ("recordings SET --format what", "--format"),
    ("identify SET --model what", "what"),
    ("identify SET --starts 0", "--starts"),
    ("identify SET --confidence nan", "--confidence"),
    ("identify SET --confidence 2", "--confidence"),
    ("identify SET --objective what", "--objective"),
    ("identify SET --design -1", "--design"),
    ("diagnose SET --model what", "what"),
    ("diagnose SET --seed -1", "--seed"),
    ("reproduce what", "what"),
    ("reproduce --seed -1", "--seed"),
    ("schema what", "what"),
    ("what", "what"),
)


@pytest.mark.parametrize(("line", "name"), OPTIONS, ids=[line for line, _ in OPTIONS])
def test_an_option_that_makes_no_sense(
    line: str, name: str, good: dict[str, str], tmp_path: Path
) -> None:
    out = tmp_path / "out"

    result = ran(line, good, tmp_path, out) if line != "what" else RUNNER.invoke(app, [line])

    assert result.exit_code == 2, (result.exit_code, result.output, result.exception)
    assert name.lower() in result.stderr.lower()
    assert WAY_OUT.search(result.stderr.replace(name, ""))
    assert not out.exists()


def test_what_a_message_repeats_cannot_command_the_terminal(tmp_path: Path) -> None:
    bad = tmp_path / "a\x1b[2Jb\nc.toml"

    result = RUNNER.invoke(app, ["plan", str(bad), "--out", str(tmp_path / "out")])

    assert result.exit_code == 2
    assert "\x1b" not in result.stderr
    assert r"a\x1b[2Jb c.toml" in result.stderr
    assert result.stderr.count("\n") == 1


def test_marks_and_line_ends_of_other_systems_are_no_fault(
    good: dict[str, str], tmp_path: Path
) -> None:
    text = PAPER.read_text(encoding="utf-8").replace("\n", "\r\n")
    task = tmp_path / "task.toml"
    task.write_bytes(b"\xef\xbb\xbf" + text.encode())
    plan = tmp_path / "plan.json"
    values = json.loads(Path(good["PLAN"]).read_text(encoding="utf-8"))
    dumped = json.dumps(values, indent=1).replace("\n", "\r\n")
    plan.write_bytes(b"\xef\xbb\xbf" + dumped.encode())

    from meso_robust.planning.reading import read_plan
    from meso_robust.task import load_task

    found = load_task(task)
    assert found == load_task(PAPER)
    assert read_plan(plan, found) == read_plan(Path(good["PLAN"]), found)
