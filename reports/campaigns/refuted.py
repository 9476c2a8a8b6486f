"""Witnesses of REFUTED certificates, replayed: ``python -m reports.campaigns.refuted``."""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from typer.testing import CliRunner

from meso_robust.cli import app
from meso_robust.files import write_all
from meso_robust.laboratory.replay import Feedback
from meso_robust.laboratory.simulation import in_goal, player_of
from meso_robust.laboratory.witness import read_witness
from meso_robust.pipeline import Planned, make
from meso_robust.planning.reading import read_plan
from meso_robust.primitives.setup import setup_of
from meso_robust.simulator import Outcome
from tests.paper import paper_task

SAMPLES = 100
TASKS: tuple[dict[str, Any], ...] = (
    {"uncertainty__friction": [0.05, 0.9]},
    {"uncertainty__friction": [0.3, 0.5]},
    {"uncertainty__friction": [0.2, 0.36]},
    {"uncertainty__sensed_orientation_deg": 6.0},
    {"uncertainty__sensed_position_um": 60.0},
    {"uncertainty__probe_position_um": 40.0},
    {"uncertainty__tip_misalignment_deg": [-4.0, 4.0]},
    {"uncertainty__film_ratio_percent": 80.0},
    {"goal__position_tolerance_um": 20.0},
    {"goal__orientation_tolerance_deg": 0.2},
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Replayed:
    """Outcome of one task, and of its witness if it was refuted."""

    task: str
    verdict: str
    claimed: str
    """How the witness ends, as the certificate tells it."""
    status: int | None
    """Exit status of ``simulate --witness``; None without a witness."""
    stepper: str
    """How the run of the witness ends in ``simulation.json``."""
    events: str
    """How it ends by the event-driven engine."""
    fails: bool
    """Whether it fails again by both engines."""


def replayed(planned: Planned, task: str, folder: Path) -> Replayed:
    """Write a plan and its certificate, and replay the witness from the files by ``simulate``."""
    verdict = planned.certificate.verdict
    witness = planned.certificate.witness
    if witness is None:
        return Replayed(
            task=task, verdict=verdict, claimed="", status=None, stepper="", events="", fails=False
        )
    files = {
        "task.toml": _toml(planned.task.model_dump(mode="json", by_alias=True)),
        "plan.json": planned.plan.model_dump_json(by_alias=True),
        "certificate.json": planned.certificate.model_dump_json(by_alias=True),
    }
    write_all(folder, files)
    paths = {name: folder / name for name in files}
    words = [paths["task.toml"], paths["plan.json"], "--witness", paths["certificate.json"]]
    out = folder / "simulated"
    options = ["--samples", "1", "--quiet", "--out", out]
    result = CliRunner().invoke(app, ["simulate", *map(str, (*words, *options))])
    if result.exit_code not in (0, 1):
        return Replayed(
            task=task,
            verdict=verdict,
            claimed=witness.outcome,
            status=result.exit_code,
            stepper=result.output,
            events="",
            fails=False,
        )
    again = json.loads((out / "simulation.json").read_text(encoding="utf-8"))["witness"]["run"]
    exact, ended = _by_events(planned, paths)
    return Replayed(
        task=task,
        verdict=verdict,
        claimed=witness.outcome,
        status=result.exit_code,
        stepper=f"{again['outcome']}, move {again['move']}, miss {again['miss']}",
        events=ended,
        fails=result.exit_code == 1 and not again["in_goal"] and not exact,
    )


def _by_events(planned: Planned, paths: dict[str, Path]) -> tuple[bool, str]:
    """Whether the witness ends in the goal by the event-driven engine, and how it ends."""
    task, setup = planned.task, setup_of(planned.task)
    plan = read_plan(paths["plan.json"], task)
    player = player_of(plan, setup)
    if not isinstance(player, Feedback):
        raise TypeError("a certificate is about a policy")
    row = read_witness(paths["certificate.json"], task, plan, player).row
    runs = replace(player, engine="events").run(row)
    code = int(runs.outcomes[0])
    name = "starts inside" if code < 0 else Outcome(code).name.lower()
    pose = np.round(runs.final[0] * [1e6, 1e6, 180.0 / np.pi], 3)
    return bool(in_goal(runs, setup)[0]), f"{name}, move {int(runs.failed_in[0]) + 1}, at {pose}"


def _toml(values: dict[str, Any]) -> str:
    """A task's values as TOML."""
    plain = {k: v for k, v in values.items() if not isinstance(v, dict)}
    lines = [f"{key} = {json.dumps(value)}" for key, value in plain.items() if value is not None]
    for name, section in values.items():
        if isinstance(section, dict):
            lines.append(f"[{name}]")
            lines += [f"{k} = {json.dumps(v)}" for k, v in section.items() if v is not None]
    return "\n".join(lines) + "\n"


def table(found: Iterable[Replayed]) -> str:
    """Markdown."""
    lines = [
        "# Witnesses of REFUTED certificates, replayed",
        "",
        "Each task is the paper's with one change. `simulate --witness` replays the run that the "
        "certificate tells (LCP stepper), and the event-driven engine makes the same run again. "
        "Made by `python -m reports.campaigns.refuted`.",
        "",
        "| Change | Verdict | Witness | Exit status | LCP stepper | Event-driven | Fails again |",
        "| --- | --- | --- | --- | --- | --- | --- |",
    ]
    for one in found:
        status = "-" if one.status is None else str(one.status)
        fails = "-" if one.status is None else "yes" if one.fails else "NO"
        lines.append(
            f"| {one.task} | {one.verdict} | {one.claimed or '-'} | {status} "
            f"| {one.stepper or '-'} | {one.events or '-'} | {fails} |"
        )
    return "\n".join(lines) + "\n"


def main() -> None:
    """Make all tasks and write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--report", type=Path, default=Path("reports/campaigns/refuted.md"))
    report = parser.parse_args().report
    found = []
    for changes in TASKS:
        name = ", ".join(f"{key.split('__')[1]} = {value}" for key, value in changes.items())
        with tempfile.TemporaryDirectory() as folder:
            try:
                planned = make(paper_task(**changes), SAMPLES, 0)
            except Exception as error:  # a task that cannot be planned for is told, not left out
                sys.stdout.write(f"{name}: {type(error).__name__}: {error}\n")
                continue
            one = replayed(planned, name, Path(folder))
        found.append(one)
        sys.stdout.write(f"{one}\n")
        write_all(report.parent, {report.name: table(found)})


if __name__ == "__main__":
    main()
