"""What a person waits for: ``python -m reports.benchmarks.waits [--only WORD] [--out FILE]``.

Each command runs in a process of its own; its wall clock, processor time and largest memory are what the
system counts for that process and those it starts; no other program does what these commands do. Then the
rates of compiled parts (``rates``), with a peer where there is one.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from meso_robust.files import write_all
from reports.benchmarks.timing import number, reached, table

ROOT = Path(__file__).resolve().parents[2]
VERB = Path(sys.executable).with_name("meso-robust")
TASK = ROOT / "meso_robust" / "tasks" / "paper.toml"
KEPT = ROOT / "derivations" / "__pycache__"


@dataclass(frozen=True, slots=True, kw_only=True)
class Wait:
    """A command and what is wanted of it."""

    name: str
    words: tuple[str, ...]
    before: str
    """Seconds by the wall clock at commit a28a793, two idle cores."""
    wanted: float
    """Seconds."""
    environment: Mapping[str, str] = field(default_factory=dict)
    anew: bool = False
    """Whether what is kept of derivations is removed before."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cost:
    """What a process took."""

    wall: float
    cpu: float
    megabytes: float
    status: int
    """Exit status."""


def waits(folder: Path) -> tuple[Wait, ...]:
    """What is timed; a plan for the paper's task lies in the folder."""
    plan, out = str(folder / "plan.json"), ("--quiet", "--out", str(folder / "out"))
    empty, bad, hopeless = folder / "kernels", folder / "bad.toml", folder / "hopeless.toml"
    bad.write_text("[part\n", encoding="utf-8")
    text = TASK.read_text(encoding="utf-8")
    short = text.replace("tip_spacing_um = 580.0", "tip_spacing_um = 200.0")
    hopeless.write_text(short, encoding="utf-8")
    recorded = folder / "recorded"
    words = (
        f"from reports.benchmarks import identification; identification.write({str(recorded)!r})"
    )
    subprocess.run([sys.executable, "-c", words], check=True, cwd=ROOT)
    task, cold = str(TASK), {"NUMBA_CACHE_DIR": str(empty)}
    return (
        Wait(name="plan, nothing compiled", words=("plan", task, *out), before="106", wanted=24.0,
             environment=cold),
        Wait(name="plan again", words=("plan", task, *out), before="8–12", wanted=4.0),
        Wait(name="certify", words=("certify", task, plan, *out), before="", wanted=4.0),
        Wait(name="drive, until ready", words=("drive", task, plan), before="", wanted=2.0),
        Wait(name="check", words=("check", str(folder / "certificate.json")), before="2.8",
             wanted=1.5),
        Wait(name="recordings, 240 rows", words=("recordings", str(recorded), *out), before="7",
             wanted=1.0),
        Wait(name="plan, a bad file", words=("plan", str(bad), *out), before="", wanted=0.5),
        Wait(name="plan, a hopeless task", words=("plan", str(hopeless), *out), before="15–60",
             wanted=5.0),
        Wait(name="derive --check, in full", words=("derive", "--check"), before="32–60",
             wanted=40.0, anew=True),
        Wait(name="derive --check, nothing changed", words=("derive", "--check"), before="32–60",
             wanted=15.0),
        Wait(name="--help", words=("--help",), before="0.12", wanted=0.2),
    )  # fmt: skip


def cost(wait: Wait) -> Cost:
    """Run a command once."""
    if wait.anew:
        for kept in KEPT.glob("*.proof"):
            kept.unlink()
    start = time.perf_counter()
    process = subprocess.Popen(
        [str(VERB), *wait.words],
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "", **wait.environment},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    _, status, used = os.wait4(process.pid, 0)
    wall = time.perf_counter() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    kilobytes = used.ru_maxrss / (1024.0 if sys.platform == "darwin" else 1.0)
    return Cost(
        wall=wall,
        cpu=used.ru_utime + used.ru_stime,
        megabytes=kilobytes / 1024.0,
        status=process.returncode,
    )


def _row(wait: Wait) -> tuple[str, ...]:
    took = cost(wait)
    numbers = (number(took.wall), number(took.cpu), f"{took.megabytes:.0f}")
    return wait.name, *numbers, wait.before, *reached(took.wall, wait.wanted, most=True)


def main() -> None:
    """Print the table, or write it as a page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="measure only what has this word in its name")
    parser.add_argument("--out", type=Path)
    chosen = parser.parse_args()
    load = f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f} before the start"
    folder = Path(tempfile.mkdtemp())
    try:
        made = [str(VERB), "plan", str(TASK), "--quiet", "--out", str(folder)]
        subprocess.run(made, check=True, capture_output=True)
        rows = [_row(wait) for wait in waits(folder) if chosen.only in wait.name]
    finally:
        shutil.rmtree(folder)
    heads = (
        "a command in a new process", "s (wall clock)", "s (CPU time)", "MB at most",
        "s at a28a793", "wanted", "reached",
    )  # fmt: skip
    from reports.benchmarks import rates  # now: a process begins as large as the one that starts it

    lines = table("Waits", heads, rows) + rates.section(chosen.only)
    text = "\n".join([load, "", *lines])
    if chosen.out is None:
        print(text)
        return
    command = f"`python -m reports.benchmarks.waits --out {chosen.out}`"
    page = f"# What a person waits for\n\n{command}: {text}"
    write_all(chosen.out.parent, {chosen.out.name: page})


if __name__ == "__main__":
    main()
