"""Largest memory of every verb, on the tutorial's data: ``python -m reports.scale.memory`` prints it.

In a process of its own, with little in memory: what a process holds before it becomes another one counts as
the other's.
"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from meso_robust.tasks import MICROSCOPE, PAPER
from reports.benchmarks.waits import Wait, cost

CAMPAIGN = """schema = "meso-robust/campaign/1"
name = "a short attack"
seed = 0

[[part]]
kind = "falsify"
name = "event-driven"
plan = "plan/plan.json"
executions = 20_000
restarts = 1
evaluations = 200
"""


def words(folder: Path) -> dict[str, tuple[str, ...]]:
    """Arguments of every verb, by its name, in an order in which each finds what it needs."""
    here, task = str(folder), str(PAPER)
    plan, set_ = f"{here}/plan", f"{here}/set"
    certificate = f"{plan}/certificate.json"
    videos = [str(path) for path in sorted((folder / "latch" / "videos").glob("push_*.mp4"))]
    stated = ("--task", f"{here}/latch/task.toml", "--grid", f"{here}/latch/grid.png")
    return {
        "example": ("example", f"{here}/latch"),
        "plan": ("plan", task, "--out", plan),
        "certify": ("certify", task, f"{plan}/plan.json", "--out", f"{here}/again"),
        "check": ("check", certificate),
        "simulate": ("simulate", task, f"{plan}/plan.json", "--out", f"{here}/runs"),
        "drive": ("drive", task, f"{plan}/plan.json"),
        "track": (
            "track", *videos, "--commands", f"{here}/latch/videos", *stated, "--tip-radius-um", "12.5",
            "--pitch-um", "200", "--start", ",,0", "--out", set_,
        ),
        "recordings": ("recordings", set_, "--out", f"{here}/checked"),
        "identify": ("identify", set_, "--out", f"{here}/model"),
        "diagnose --quick": ("diagnose", set_, "--quick", "--out", f"{here}/diagnosis"),
        "run --lab virtual": ("run", str(MICROSCOPE), f"{here}/live/plan.json", "--lab", "virtual",
                              "--yes", "--out", f"{here}/journal"),
        "campaign": ("campaign", f"{here}/attack.toml", "--workers", "1", "--out", f"{here}/attack"),
        "derive --check": ("derive", "--check"),
    }  # fmt: skip


def peaks() -> Iterator[tuple[str, float]]:
    """Name and megabytes of each verb, the largest of its processes.

    Raises
    ------
    RuntimeError
        A verb failed, so that its memory would say nothing.
    """
    folder = Path(tempfile.mkdtemp())
    (folder / "attack.toml").write_text(CAMPAIGN, encoding="utf-8")
    try:
        _megabytes("plan", ("plan", str(MICROSCOPE), "--out", str(folder / "live")))
        # what a verb works on may be written by the one before
        for name in words(folder):
            yield name, _megabytes(name, words(folder)[name])
    finally:
        shutil.rmtree(folder)


def _megabytes(name: str, given: tuple[str, ...]) -> float:
    took = cost(Wait(name=name, words=given, before="", wanted=0.0))
    if took.status not in (0, 1):
        raise RuntimeError(f"{name} ended with {took.status}: meso-robust {' '.join(given)}")
    return took.megabytes


def main() -> None:
    """Print a line for each verb."""
    for name, megabytes in peaks():
        print(f"{name}\t{megabytes:.0f}", flush=True)


if __name__ == "__main__":
    main()
