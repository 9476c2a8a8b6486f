"""Largest memory of every verb, on the tutorial's data."""

from __future__ import annotations

import shutil
import tempfile
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


def peaks() -> list[tuple[str, float]]:
    """Name and megabytes of each verb, the largest of its processes.

    Raises
    ------
    RuntimeError
        A verb failed, so that its memory would say nothing.
    """
    folder = Path(tempfile.mkdtemp())
    (folder / "attack.toml").write_text(CAMPAIGN, encoding="utf-8")
    found = []
    try:
        _cost("plan", ("plan", str(MICROSCOPE), "--out", str(folder / "live")))
        for name in words(folder):
            # what a verb works on may be written by the one before
            megabytes = _cost(name, words(folder)[name])
            print(f"{name}: {megabytes:.0f} MB", flush=True)
            found.append((name, megabytes))
    finally:
        shutil.rmtree(folder)
    return found


def _cost(name: str, given: tuple[str, ...]) -> float:
    took = cost(Wait(name=name, words=given, before="", wanted=0.0))
    if took.status not in (0, 1):
        raise RuntimeError(f"{name} ended with {took.status}: meso-robust {' '.join(given)}")
    return took.megabytes
