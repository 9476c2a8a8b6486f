"""``meso-robust campaign`` from end to end."""

from __future__ import annotations

import json
import os
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from contextlib import closing, suppress
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from meso_robust.campaigns.store import NAME
from meso_robust.cli import app
from tests.campaigns.test_monte_carlo import HEAD, PLAN

NAMES = {"campaign.sqlite", "campaign.json", "report.html"}


def written(folder: Path, *parts: dict[str, Any]) -> Path:
    """A campaign file with parts on the paper's plan."""
    text = HEAD
    for k, keys in enumerate(parts):
        values = {"name": f"part {k}", "kind": "monte-carlo", "plan": str(PLAN)} | keys
        text += "\n[[part]]\n" + "\n".join(f"{key} = {json.dumps(v)}" for key, v in values.items())
    path = folder / "campaign.toml"
    path.write_text(text + "\n", encoding="utf-8")
    return path


SMALL: dict[str, Any] = {"executions": 900, "chunk": 150}
FAILING: dict[str, Any] = {"executions": 200, "chunk": 100, "factor": 3.0}


def ran(*words: object) -> tuple[int, str, str]:
    result = CliRunner().invoke(app, ["campaign", *map(str, words)])
    return result.exit_code, result.stdout, result.stderr


def test_a_campaign_is_run_once_and_told(tmp_path: Path) -> None:
    path, out = written(tmp_path, SMALL, FAILING), tmp_path / "out ü 1"
    status, said, on_the_way = ran(path, "--out", out, "--workers", 2)
    assert status == 0
    assert "900 of 900 executions, drawn uniformly" in said
    # every part is told before its first chunk is done, which can take minutes
    told = [line for line in on_the_way.splitlines() if " chunks" in line]
    assert told[:2] == ["part 0: 0 of 6 chunks, begins", "part 1: 0 of 2 chunks, begins"]
    assert len(told) > 2
    assert {file.name for file in out.iterdir()} >= NAMES
    found = json.loads((out / "campaign.json").read_text(encoding="utf-8"))
    assert found["verdict"] == "measured"
    assert [one["runs"] for one in found["parts"]] == [900, 200]
    assert [one["chunks"] for one in found["parts"]] == [
        {"planned": 6, "done": 6},
        {"planned": 2, "done": 2},
    ]
    # each failure that is listed can be replayed from its folder
    failure = found["parts"][1]["failures"][0]
    folder = out / failure["folder"]
    assert sorted(file.name for file in folder.iterdir()) == failure["files"]
    replay = ["simulate", str(folder / "task.toml"), str(folder / "plan.json")]
    options = ["--witness", str(folder / "witness.json"), "--samples", "1", "--json"]
    answer = CliRunner().invoke(app, [*replay, *options, "--out", str(tmp_path / "replayed")])
    assert answer.exit_code == 1
    assert not json.loads(answer.stdout)["witness"]["run"]["in_goal"]
    # a second call needs --resume, which does nothing again but writes the same answer
    status, _, error = ran(path, "--out", out)
    assert status == 2
    assert "--resume" in error
    status, said, _ = ran(path, "--out", out, "--resume", "--json")
    assert status == 0
    again = json.loads(said)
    assert again["totals_digest"] == found["totals_digest"]
    assert again["sessions"] == found["sessions"]


def test_a_demand_that_is_not_met_is_negative(tmp_path: Path) -> None:
    path = written(tmp_path, FAILING | {"at_least": 0.99})
    status, said, _ = ran(path, "--out", tmp_path / "out", "--quiet")
    assert status == 1
    assert said.startswith("broken: ")
    assert len(said.splitlines()) == 1
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "is refuted" in page


def test_another_campaign_in_the_folder_is_refused(tmp_path: Path) -> None:
    path, out = written(tmp_path, SMALL | {"executions": 150}), tmp_path / "out"
    assert ran(path, "--out", out, "--workers", 1)[0] == 0
    before = (out / "campaign.json").read_bytes()
    (tmp_path / "other").mkdir()
    for words, wanted in (
        ((written(tmp_path / "other", SMALL), "--resume"), "executions"),
        ((path, "--resume", "--seed", 5), "seed"),
    ):
        status, _, error = ran(*words, "--out", out)
        assert status == 2
        assert "another campaign" in error
        assert wanted in error
    assert (out / "campaign.json").read_bytes() == before


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        (["nowhere.toml"], "nowhere.toml: cannot be read"),
        (["{campaign}", "--out", "{campaign}"], "is not a writable folder"),
        (["{campaign}", "--workers", "0"], "workers"),
        (["{campaign}", "--scheduler", "nobody"], "--scheduler nobody: cannot be reached"),
        (["{campaign}", "--scheduler", "tcp://a:1", "--workers", "2"], "give one of them"),
    ],
)
def test_bad_input_is_refused(tmp_path: Path, words: list[str], wanted: str) -> None:
    path = written(tmp_path, SMALL)
    named = [word.format(campaign=path) for word in words]
    out = [] if "--out" in named else ["--out", tmp_path / "out"]
    status, _, error = ran(*named, *out)
    assert status == 2
    assert wanted in error
    assert "Traceback" not in error


# what a shell starts in the background does not hear Ctrl-C, nor does what that starts
MAIN = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
    "from meso_robust.cli import main; main()"
)


def start(path: Path, out: Path) -> subprocess.Popen[bytes]:
    words = ["campaign", str(path), "--out", str(out), "--resume", "--workers", "2"]
    return subprocess.Popen(
        [sys.executable, "-c", MAIN, *words],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[2])},
    )


def chunks_kept(out: Path) -> int:
    """How many chunks the store in ``out`` holds, from a copy: a campaign locks its own."""
    with tempfile.TemporaryDirectory() as folder:
        for file in out.glob(f"{NAME}*"):
            with suppress(FileNotFoundError):  # a log may go while it is copied
                shutil.copy(file, folder)
        with closing(sqlite3.connect(Path(folder) / NAME)) as db:
            try:
                return int(db.execute("SELECT count(*) FROM result").fetchone()[0])
            except sqlite3.DatabaseError:  # nothing is stored yet, or it was copied while written
                return 0


def test_killed_and_resumed_the_totals_are_the_same_bits(tmp_path: Path) -> None:
    path = written(tmp_path, {"executions": 3000, "chunk": 50})
    assert ran(path, "--out", tmp_path / "whole", "--workers", 1)[0] == 0
    whole = json.loads((tmp_path / "whole" / "campaign.json").read_text(encoding="utf-8"))
    out, kept = tmp_path / "killed", 0
    for _ in range(2):
        with start(path, out) as process:
            # killed as soon as it has kept ten more of its 60 chunks, however fast it runs
            while process.poll() is None and chunks_kept(out) < kept + 10:
                time.sleep(0.02)
            process.send_signal(signal.SIGKILL)
            _, error = process.communicate()
        assert process.returncode == -signal.SIGKILL, error.decode()
        kept = chunks_kept(out)
        # a killed run leaves no half report
        assert not (out / "report.html").exists()
    with start(path, out) as process:
        _, error = process.communicate()
    assert process.returncode == 0, error.decode()
    found = json.loads((out / "campaign.json").read_text(encoding="utf-8"))
    assert found["totals_digest"] == whole["totals_digest"]
    assert found["parts"][0]["totals"] == whole["parts"][0]["totals"]
    assert not found["troubles"]


def test_ctrl_c_ends_cleanly_and_keeps_what_is_done(tmp_path: Path) -> None:
    path = written(tmp_path, {"executions": 2_000_000, "chunk": 50})
    out = tmp_path / "out"
    with start(path, out) as process:
        while not (out / "campaign.sqlite").exists():
            time.sleep(0.05)
        time.sleep(3.0)
        process.send_signal(signal.SIGINT)
        _, error = process.communicate()
    assert process.returncode == 130
    assert b"continue with --resume" in error
    assert b"Traceback" not in error
