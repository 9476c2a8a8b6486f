"""Long verbs in a real terminal: they show that they work, and Ctrl-C ends them and all they started."""

from __future__ import annotations

import os
import pty
import re
import select
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from meso_robust.planning.document import plan_document
from meso_robust.tasks import PAPER
from tests.nightly import at_night
from tests.recordings.examples import folder_of
from tests.strategies import paper_chain, paper_task

ROOT = Path(__file__).parents[2]
# The terminal becomes the one that controls the process, so that its Ctrl-C is a real one; what a shell
# starts in the background does not hear Ctrl-C, nor does what that starts.
MAIN = (
    "import fcntl, signal, termios; fcntl.ioctl(0, termios.TIOCSCTTY, 0); "
    "signal.signal(signal.SIGINT, signal.default_int_handler); "
    "from meso_robust.cli import main; main()"
)
MOVING = re.compile("[⠋⠙⠹⠸⠼⠴⠦⠧⠇⠏━╸╺]")  # a spinner or a bar
LONGEST = 120.0  # s


class Terminal:
    """A verb that runs in a terminal of its own."""

    def __init__(self, words: list[str], environ: dict[str, str]) -> None:
        self._own, its = pty.openpty()
        self.process = subprocess.Popen(
            [sys.executable, "-c", MAIN, *words],
            stdin=its,
            stdout=its,
            stderr=its,
            start_new_session=True,
            env=os.environ | {"PYTHONPATH": str(ROOT), "TERM": "xterm", "COLUMNS": "100"} | environ,
        )
        os.close(its)
        self.shown = ""

    def see(self, seconds: float) -> None:
        """Read for some time, or until the verb ends."""
        until = time.monotonic() + seconds
        while (left := until - time.monotonic()) > 0.0:
            if not select.select([self._own], [], [], left)[0]:
                return
            try:
                self.shown += os.read(self._own, 65536).decode(errors="replace")
            except OSError:  # the other end is closed
                return

    def wait_for(self, pattern: re.Pattern[str]) -> None:
        until = time.monotonic() + LONGEST
        while not pattern.search(self.shown):
            assert time.monotonic() < until, self.shown
            assert self.process.poll() is None, self.shown
            self.see(0.2)

    def press_ctrl_c(self) -> int:
        os.write(self._own, b"\x03")
        until = time.monotonic() + LONGEST
        while self.process.poll() is None and time.monotonic() < until:
            self.see(0.2)
        assert self.process.returncode is not None, f"does not end: {self.shown}"
        self.see(0.2)
        return self.process.returncode

    def left(self) -> list[str]:
        """What still runs of what the verb started."""
        found = []
        for stat in Path("/proc").glob("[0-9]*/stat"):
            try:
                fields = stat.read_text(encoding="utf-8").rsplit(")", 1)[1].split()
            except OSError:
                continue
            if int(fields[3]) == self.process.pid and fields[0] not in "ZX":
                found.append(stat.parent.name)
        return found

    def close(self) -> None:
        self.process.kill()
        self.process.wait()
        os.close(self._own)


@contextmanager
def terminal(words: list[str], **environ: str) -> Iterator[Terminal]:
    one = Terminal(words, environ)
    try:
        yield one
    finally:
        one.close()


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    chain = paper_chain()
    sensed = [np.array(step.pre.mid) for step in chain.steps]
    rules = [step.rule for step in chain.steps]
    made = plan_document(paper_task(), rules, sensed, [step.post for step in chain.steps])
    path = tmp_path_factory.mktemp("plan") / "plan.json"
    path.write_text(made.model_dump_json(by_alias=True), encoding="utf-8")
    return path


CAMPAIGN = """
schema = "meso-robust/campaign/1"
name = "long"
[[part]]
name = "laws"
kind = "property"
properties = ["formula-values"]
examples = 100_000
"""

VERBS = {
    "plan": (["plan", "TASK", "--out", "OUT"], 3.0),
    "certify": (["certify", "TASK", "PLAN", "--samples", "1000000", "--out", "OUT"], 1.0),
    "simulate": (["simulate", "TASK", "PLAN", "--samples", "1000000", "--out", "OUT"], 2.0),
    "check": (["check", "CERTIFICATE", "--thorough"], 0.5),
    "drive": (["drive", "TASK", "PLAN"], 0.0),
    "derive": (["derive", "--check"], 2.0),
    "campaign": (["campaign", "CAMPAIGN", "--workers", "2", "--out", "OUT"], 0.5),
    "identify": (["identify", "SET", "--starts", "10000", "--out", "OUT"], 0.0),
    "recordings": (["recordings", "SET", "--repair", "--out", "OUT"], 0.0),
    "reproduce": (["reproduce", "table-1", "--out", "OUT"], 0.5),
}
"""Words of a verb, and the seconds from the first sign of work to Ctrl-C."""
SHORT_ENOUGH = ("check", "campaign", "simulate")
"""Those that every run of the tests can bear; the others at night."""


@pytest.mark.parametrize(
    "verb",
    [name if name in SHORT_ENOUGH else pytest.param(name, marks=at_night) for name in VERBS],
)
def test_a_long_verb_shows_that_it_works_and_ends_by_ctrl_c(
    verb: str, plan: Path, tmp_path: Path
) -> None:
    (tmp_path / "set").mkdir()
    campaign, out = tmp_path / "c.toml", tmp_path / "out"
    campaign.write_text(CAMPAIGN, encoding="utf-8")
    names = {
        "TASK": PAPER,
        "PLAN": plan,
        "OUT": out,
        "CAMPAIGN": campaign,
        "CERTIFICATE": ROOT / "reports" / "paper_task" / "certificate.json",
        "SET": folder_of(tmp_path / "set"),
    }
    words, later = VERBS[verb]

    with terminal([str(names.get(word, word)) for word in words]) as shown:
        shown.wait_for(MOVING)
        shown.see(later)
        status = shown.press_ctrl_c()

        assert status == (0 if verb == "drive" else 130), shown.shown
        assert "Traceback" not in shown.shown
        assert shown.shown.count("meso-robust: ") == (0 if verb == "drive" else 1)
        assert shown.left() == []
    if verb != "campaign":
        assert not out.exists()
    elif out.exists():  # what is done is kept, and nothing is half done
        assert {path.name for path in out.iterdir()} <= {"campaign.sqlite", "examples"}


@at_night
def test_ctrl_c_while_kernels_are_compiled(tmp_path: Path) -> None:
    cache = tmp_path / "kernels"
    with terminal(["plan", "--out", str(tmp_path / "out")], NUMBA_CACHE_DIR=str(cache)) as shown:
        while not list(cache.rglob("*.nbi")):  # the first is done, others are under way
            shown.see(0.2)
            assert shown.process.poll() is None, shown.shown
        status = shown.press_ctrl_c()

        assert status == 130, shown.shown
        assert "Traceback" not in shown.shown
        assert shown.left() == []
    assert not (tmp_path / "out").exists()


def test_elsewhere_progress_is_plain_lines(tmp_path: Path) -> None:
    done = subprocess.run(
        [
            sys.executable,
            "-c",
            "from meso_robust.cli import main; main()",
            "check",
            str(ROOT / "reports" / "paper_task" / "certificate.json"),
        ],
        capture_output=True,
        text=True,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == "verifying ...\n"
    assert not MOVING.search(done.stdout + done.stderr)
