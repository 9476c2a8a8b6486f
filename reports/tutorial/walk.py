"""The tutorial walked: ``python -m reports.tutorial.walk --out reports/tutorial/times.md``.

Its commands are run in a new folder, each with its time; what they print is held against what the page
shows.
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import resource
import shlex
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
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


@dataclass(frozen=True, slots=True)
class Walked:
    """A command that was run."""

    text: str
    seconds: float
    """By the clock."""
    processor: float
    """Seconds of all cores together."""
    status: int
    differs: list[str]
    """What the page shows and it did not print."""


def installed(source: Path, folder: Path) -> Iterator[Walked]:
    """Clone a checkout and run ``make demo`` in it, as a new user would."""
    for text, where in (
        (f"git clone {shlex.quote(str(source.resolve()))} clone", folder),
        ("make demo", folder / "clone"),
    ):
        done, _ = _run(text, where, os.environ["PATH"])
        yield replace(done, text=text.replace(shlex.quote(str(source.resolve())), "REPOSITORY"))


def walked(folder: Path, programs: Path) -> Iterator[Walked]:
    """Run each command of the tutorial as a reader would, with the programs of a folder."""
    path = f"{programs}{os.pathsep}{os.environ['PATH']}"
    where = folder
    for command in commands(TUTORIAL.read_text(encoding="utf-8")):
        if command.text.startswith("cd "):
            where = where / command.text.removeprefix("cd ")
            continue
        if command.friction:
            edited(where / "task.toml", command.friction)
        done, printed = _run(command.text, where, path)
        yield replace(done, differs=missing(command.shown, printed))


def _run(text: str, where: Path, path: str) -> tuple[Walked, str]:
    """A command that was run, and what it printed."""
    before, used = time.perf_counter(), _processor()
    done = subprocess.run(
        ["bash", "-c", text],
        cwd=where,
        env={**os.environ, "PATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    found = Walked(
        text=text,
        seconds=time.perf_counter() - before,
        processor=_processor() - used,
        status=done.returncode,
        differs=[],
    )
    return found, done.stdout


def _processor() -> float:
    """Processor time of all commands so far, s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main() -> None:
    """Walk and write the times."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("reports/tutorial/times.md"))
    parser.add_argument("--clone", type=Path, help="checkout to clone and install first")
    asked = parser.parse_args()
    out, load, rows, whole, used = asked.out, os.getloadavg()[1], [], 0.0, 0.0
    with tempfile.TemporaryDirectory() as name:
        for one in _all(Path(name), asked.clone):
            rows.append(_row(one))
            sys.stdout.write(rows[-1] + "\n")
            sys.stdout.flush()
            whole, used = whole + one.seconds, used + one.processor
    head = [
        "# The tutorial, walked",
        "",
        f"`make tutorial`; meso-robust {__version__}, Python {platform.python_version()}, "
        f"{platform.machine()}, {os.cpu_count()} cores; other work on them before: a load of "
        f"{load:.1f}. In all {whole:.0f} s by the clock, {used:.0f} s of processor time.",
        "",
        "| command | s | processor s | exit status | shown on the page and not printed |",
        "|---|---|---|---|---|",
    ]
    write_all(out.parent, {out.name: "\n".join([*head, *rows, ""])})


def _all(folder: Path, source: Path | None) -> Iterator[Walked]:
    programs = Path(sys.executable).parent
    if source is not None:
        yield from installed(source, folder)
        programs = folder / "clone" / ".venv" / "bin"
    yield from walked(folder, programs)


def _row(one: Walked) -> str:
    times = f"{one.seconds:.1f}", f"{one.processor:.1f}"
    cells = (f"`{one.text}`", *times, str(one.status), "; ".join(one.differs) or "–")
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


if __name__ == "__main__":
    main()
