"""The full falsification campaign: ``python -m tests.execution.falsify --help``.

Its totals are kept after every chunk, so that it can be ended at any time and called again.
"""

from __future__ import annotations

import argparse
import itertools
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from meso_robust.execution.attack import (
    Failure,
    Threshold,
    all_targets,
    any_motion,
    attack,
    misses,
    threshold,
)
from meso_robust.execution.claims import Claims, claims_of, first_tip, slips
from meso_robust.execution.falsification import KINDS, Chunk, Ledger, identity, run_chunks
from meso_robust.execution.falsification_report import report
from meso_robust.execution.judging import judge
from meso_robust.execution.replay import Feedback
from meso_robust.certificates.chain import certify
from meso_robust.certificates.margin import margin
from meso_robust.files import write_all
from meso_robust.planning.document import NAMES
from meso_robust.planning.reading import read_plan, rules_of
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task, load_task
from meso_robust.tasks import PAPER

EVENTS_CHUNK, STEPPER_CHUNK = 50_000, 5_000
WANTED = {"any claim about the motion": any_motion, "carried out and in the goal": misses}
REPORT_EVERY = 60.0  # s
MODULE = "python -m tests.execution.falsify"


def main() -> None:
    """Run what is missing of the campaign and write its report."""
    asked = _arguments()
    task = load_task(asked.task)
    plan = read_plan(asked.plan, task)
    rules = rules_of(plan)
    claims = claims_of(certify(rules, setup_of(task)), rules)
    player = Feedback(rules=rules, setup=claims.setup, engine="events")
    ledger = Ledger(path=asked.totals, identity=identity(plan))
    asked.totals.parent.mkdir(parents=True, exist_ok=True)

    def write() -> None:
        text = report(task.name, ledger, claims, MODULE)
        write_all(asked.report.parent, {asked.report.name: text})

    _attack(ledger, player, claims, asked.seed)
    _thresholds(ledger, player, task, asked.seed)
    write()
    line = next(line for line in ledger.lines("attack") if line["engine"] == "events")
    seeds = np.array([[float.fromhex(v) for v in r["row"]] for r in line["reaches"]])
    work, last = (player, claims, seeds), time.monotonic()
    for chunk in run_chunks(ledger, work, list(_chunks(asked)), asked.workers):
        sys.stdout.write(f"{chunk}\n")
        sys.stdout.flush()
        if time.monotonic() - last > REPORT_EVERY:
            write()
            last = time.monotonic()
    if asked.stepper_attack:
        stepper = Feedback(rules=rules, setup=claims.setup, engine="stepper")
        _attack(ledger, stepper, claims, asked.seed)
    write()


def _arguments() -> argparse.Namespace:
    reports = Path("reports")
    parser = argparse.ArgumentParser(prog=MODULE, description=__doc__)
    parser.add_argument("--task", type=Path, default=PAPER)
    parser.add_argument("--plan", type=Path, default=reports / "paper_task" / "plan.json")
    parser.add_argument(
        "--totals", type=Path, default=reports / "falsification" / "paper_task.jsonl"
    )
    parser.add_argument("--report", type=Path, default=reports / "falsification" / "paper_task.md")
    parser.add_argument("--events", type=int, default=10_000_000, help="executions")
    parser.add_argument("--stepper", type=int, default=100_000, help="executions")
    parser.add_argument("--stepper-attack", action="store_true", help="attack by the stepper too")
    parser.add_argument("--workers", type=int, default=1, help="processes")
    parser.add_argument("--seed", type=int, default=0)
    return parser.parse_args()


def _chunks(asked: argparse.Namespace) -> Iterator[Chunk]:
    """All chunks, the kinds of draws in turn; ten of the event-driven engine to one stepped."""
    events = -(-asked.events // EVENTS_CHUNK)
    stepped = -(-asked.stepper // STEPPER_CHUNK)
    kinds = itertools.cycle(KINDS)
    for k, kind in zip(range(max(events, 10 * stepped)), kinds, strict=False):
        if k < events:
            yield Chunk(engine="events", kind=kind, index=k, runs=EVENTS_CHUNK, seed=asked.seed)
        at, rest = divmod(k, 10)
        if rest == 0 and at < stepped:
            own = KINDS[at % len(KINDS)]
            yield Chunk(engine="stepper", kind=own, index=at, runs=STEPPER_CHUNK, seed=asked.seed)


def _attack(ledger: Ledger, player: Feedback, claims: Claims, seed: int) -> None:
    if any(line["engine"] == player.engine for line in ledger.lines("attack")):
        return
    reached = attack(player, all_targets(claims), np.random.default_rng(seed))
    judged = judge(player, claims, np.array([one.summit.row for one in reached]))
    ledger.add(
        "attack",
        {
            "engine": player.engine,
            "broken": [name for name, flags in judged.broken.items() if flags.any()],
            "reaches": [
                {
                    "name": one.target.name,
                    "unit": one.target.unit,
                    "limit": one.target.limit,
                    "value": one.summit.value,
                    "evaluations": one.summit.evaluations,
                    "row": [float(value).hex() for value in one.summit.row],
                }
                for one in reached
            ],
        },
    )


def _thresholds(ledger: Ledger, player: Feedback, task: Task, seed: int) -> None:
    left = set(WANTED) - {line["wanted"] for line in ledger.lines("threshold")}
    if not left:
        return
    certified = margin(player.rules, task).factor
    for name in sorted(left):
        found = threshold(player, lambda f: setup_of(task, f), WANTED[name], seed=seed)
        ledger.add("threshold", _told(name, found, certified, player, task))


def _told(
    name: str, found: Threshold, certified: float, player: Feedback, task: Task
) -> dict[str, Any]:
    failure = found.failure
    return {
        "wanted": name,
        "certified": certified,
        "holds": found.holds,
        "fails": None if failure is None else failure.factor,
        "claims": [] if failure is None else failure.claims,
        "row": [] if failure is None else [float(value).hex() for value in failure.row],
        "told": "" if failure is None else _run_told(failure, player, task),
    }


def _run_told(failure: Failure, player: Feedback, task: Task) -> str:
    """Which move, which tip, how far; the row by its names."""
    setup = setup_of(task, failure.factor)
    stressed = Feedback(rules=player.rules, setup=setup, engine="events")
    runs = stressed.run(failure.row[None])
    half = np.array([setup.half_length.mid, setup.half_width.mid])
    contacts = []
    for k, move in enumerate(runs.moves[: int(runs.failed_in[0]) + 1]):
        tip, slip = NAMES[int(first_tip(move, half)[0])], 1e6 * float(slips(move, half)[0])
        phases = 0 if move.phases is None else int(move.phases[0])
        contacts.append(f"move {k + 1}: {tip} first, drifts {slip:.3g} um, {phases} phases")
    names = []
    for column, value in zip(stressed.columns, failure.row, strict=True):
        ends = {column.low: "low", column.high: "high", column.mid: "middle"}
        names.append(f"{column.name} {ends.get(float(value), f'{float(value):.6g}')}")
    return f"{'; '.join(contacts)} ({', '.join(names)})"


if __name__ == "__main__":
    main()
