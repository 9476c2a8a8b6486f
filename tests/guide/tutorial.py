"""The tutorial walked: ``python -m tests.guide.tutorial --out reports/tutorial/times.md``.

Its commands are run in a new folder, each with its time; what they print is held against what the page
shows.
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from meso_robust import __version__
from meso_robust.files import write_all
from meso_robust.guide import TUTORIAL

_BLOCK = re.compile(r"^```(\w*)\n(.*?)^```\n", re.DOTALL | re.MULTILINE)
_EDIT = re.compile(r"`(friction = \[[^`]*\])`(?:, and plan| back)")
_SHOWN_CUT = "…"


@dataclass(frozen=True, slots=True)
class Command:
    """A command of the page."""

    text: str
    shown: tuple[str, ...]
    """Lines that the page shows of what it prints; one may end in an ellipsis."""
    friction: str | None
    """What the page tells to write into the task's line of friction before, if anything."""


def commands(page: str) -> tuple[Command, ...]:
    """All commands of the tutorial, in order."""
    found: list[Command] = []
    end = 0
    for block in _BLOCK.finditer(page):
        told = _EDIT.findall(page[end : block.start()])
        end = block.end()
        if block[1] == "":
            lines = block[2].splitlines()
            found += [Command(line, (), told[-1] if told else None) for line in lines]
        elif block[1] == "text" and found:
            shown = tuple(line for line in block[2].splitlines() if line != "...")
            found[-1] = Command(found[-1].text, shown, found[-1].friction)
    return tuple(found)


def edited(task: Path, friction: str) -> None:
    """Write another range of friction into a task, as a reader would."""
    before = task.read_text(encoding="utf-8")
    after, count = re.subn(r"(?m)^friction = \[[^\]]*\]", friction, before)
    assert count == 1, task
    task.write_text(after, encoding="utf-8")


def missing(shown: tuple[str, ...], printed: str) -> list[str]:
    """Lines that the page shows and that were not printed."""
    lines = printed.splitlines()
    return [
        one
        for one in shown
        if not any(
            line.startswith(one.removesuffix(_SHOWN_CUT)) if _SHOWN_CUT in one[-1:] else line == one
            for line in lines
        )
    ]


def walked(folder: Path) -> Iterator[tuple[str, float, int, list[str]]]:
    """Each command with its seconds, its exit status, and what it did not print as shown."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    where = folder
    for command in commands(TUTORIAL.read_text(encoding="utf-8")):
        if command.text.startswith("cd "):
            where = where / command.text.removeprefix("cd ")
            continue
        if command.friction:
            edited(where / "task.toml", command.friction)
        before = time.perf_counter()
        done = subprocess.run(
            ["bash", "-c", command.text],
            cwd=where,
            env={**os.environ, "PATH": path},
            capture_output=True,
            text=True,
            check=False,
        )
        seconds = time.perf_counter() - before
        yield command.text, seconds, done.returncode, missing(command.shown, done.stdout)


def main() -> None:
    """Walk and write the times."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("reports/tutorial/times.md"))
    out = parser.parse_args().out
    rows, whole = [], 0.0
    with tempfile.TemporaryDirectory() as name:
        for text, seconds, status, differs in walked(Path(name)):
            rows.append(_row(text, seconds, status, differs))
            sys.stdout.write(rows[-1] + "\n")
            sys.stdout.flush()
            whole += seconds
    head = [
        "# The tutorial, walked",
        "",
        f"`make tutorial`; meso-robust {__version__}, Python {platform.python_version()}, "
        f"{platform.machine()}, {os.cpu_count()} cores; load before: {os.getloadavg()[2]:.1f} "
        f"(15 min). In all {whole:.0f} s.",
        "",
        "| command | s | exit status | printed otherwise than the page shows |",
        "|---|---|---|---|",
    ]
    write_all(out.parent, {out.name: "\n".join([*head, *rows, ""])})


def _row(text: str, seconds: float, status: int, differs: list[str]) -> str:
    cells = (f"`{text}`", f"{seconds:.1f}", str(status), "; ".join(differs) or "–")
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


if __name__ == "__main__":
    main()
