"""Plans carried out in the foreign plant: ``python -m reports.foreign_plant.campaign [--runs 10000]``.

Every shipped task (or those of ``--task``) is planned and certified, and the plans of ``reports/real_paper``
are certified again; then the plan is carried out with everything uncertain drawn from the task's box, half of
the runs within it and half at its corners. A run
is outside if it is stuck, or lies outside a promised box after a move, or outside the goal at its end, by
more than its own change in a plant that is four times as fine. ``--radius LOW HIGH`` (um) gives the tips
other radii than the task states.

Continues where it was stopped, as long as task, plan and seed are the same.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from meso_robust.bounds import Verdict
from meso_robust.certificates.chain import certify
from meso_robust.files import write_all
from meso_robust.laboratory.draws import Draws, draw, some
from meso_robust.laboratory.running import PlanRun, excess
from meso_robust.planning.compose import compose
from meso_robust.planning.reading import read_plan
from meso_robust.planning.rules import rules_of
from meso_robust.plant.kernel import COARSE, FINE
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import PoseBox, Setup, setup_of
from meso_robust.task import Task, load_task
from meso_robust.tasks import MICROSCOPE, TASKS
from meso_robust.types import Flags, Floats, Indices
from meso_robust.units import DEG, UM
from reports.foreign_plant.running import run_foreign

OUT = Path(__file__).parent
REAL = OUT.parent / "real_paper"
KEPT = {REAL / "task.toml": "± 76 um", REAL / "at_38_um" / "task.toml": "± 38 um"}
"""Tasks whose plans are kept beside them, as these take minutes to find, and their tolerances."""
CHUNK = 500
MEASURED = 16  # runs of each chunk that are repeated in the finer plant to measure the error
SHOWN = np.array([UM, UM, DEG])
RESULTS, PAGE = "results.json", "results.md"
Triple = tuple[float, float, float]
NONE: Triple = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """A plan and what is promised of it."""

    task: Task
    rules: tuple[MoveRule, ...]
    setup: Setup
    posts: tuple[PoseBox | None, ...]
    """Proved box after each move."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What came of runs of a plan."""

    runs: int = 0
    stuck: int = 0
    """Not carried out: the part jammed, or a tip came down on it."""
    outside_box: int = 0
    """Outside a promised box beyond the error; stuck runs are not counted."""
    outside_goal: int = 0
    too_close: int = 0
    """Outside of a box or stuck, but within the error of the plant, or not so in the finer plant."""
    error: Triple = NONE
    """Of the plant, after any move, by the runs that were measured: um, um, deg."""
    worst: Triple = NONE
    """Largest distance outside of a box beyond the error: um, um, deg."""

    def plus(self, other: Outcome) -> Outcome:
        """Both together."""
        both: dict[str, Any] = asdict(self)
        for name, more in asdict(other).items():
            so_far = both[name]
            both[name] = so_far + more if isinstance(more, int) else tuple(map(max, so_far, more))
        return Outcome(**both)

    @property
    def outside(self) -> int:
        """Runs that break what is promised."""
        return self.stuck + self.outside_box + self.outside_goal


def plan_of(task: Task, kept: Path | None = None) -> Plan:
    """Plan and certify a task, or certify a kept plan for it."""
    setup = setup_of(task)
    rules = compose(task).rules if kept is None else rules_of(read_plan(kept, task))
    posts = [s.post for s in certify(rules, setup).steps if s.verdict is Verdict.PROVED]
    none: list[PoseBox | None] = [None] * (len(rules) - len(posts))
    return Plan(task=task, rules=tuple(rules), setup=setup, posts=(*posts, *none))


def drawn(plan: Plan, runs: int, rng: np.random.Generator, radius: Sequence[float] | None) -> Draws:
    """Runs of the box; ``radius``: of the tips in its place, um."""
    draws = draw(plan.setup, len(plan.rules), runs, rng)
    if radius is None:
        return draws
    return replace(draws, radii=rng.uniform(radius[0], radius[1], (runs, 3)) * UM)


def outcome_of(plan: Plan, draws: Draws) -> Outcome:
    """Run the plan for every row, and hold it against what is promised."""
    coarse = run_foreign(plan.rules, plan.setup, draws, COARSE)
    none = [np.zeros((1, 3))] * len(plan.rules)
    any_ = np.flatnonzero(_breaks(plan, coarse, none).any(axis=0))
    # a few at first, whose change tells which of the others are worth the finer plant
    measured = np.unique(np.linspace(0, len(draws.start) - 1, MEASURED).astype(int))
    error = _error(_changes(*_again(plan, draws, coarse, measured)))
    bad = np.flatnonzero(_breaks(plan, coarse, error).any(axis=0))
    again = np.union1d(bad, measured)
    before, fine = _again(plan, draws, coarse, again)
    changes = _changes(before, fine)
    stuck, box, goal = (flags & np.isin(again, bad) for flags in _breaks(plan, fine, changes))
    stuck &= ~before.completed
    box, goal = box & ~stuck & before.completed, goal & ~stuck & before.completed
    goal &= ~box
    beyond = [
        np.where((fine.failed_in > k)[:, None], excess(move.after, post) - changes[k], 0.0)
        for k, (move, post) in enumerate(zip(fine.moves, plan.posts, strict=True))
        if post is not None
    ]
    found = box[:, None] & np.ones(3, dtype=np.bool_)
    worst = np.max([np.where(found, b, 0.0).max(axis=0) for b in beyond] or [np.zeros(3)], axis=0)
    return Outcome(
        runs=len(draws.start),
        stuck=int(stuck.sum()),
        outside_box=int(box.sum()),
        outside_goal=int(goal.sum()),
        too_close=len(any_) - int((stuck | box | goal).sum()),
        error=_triple(np.max(error, axis=(0, 1))),
        worst=_triple(worst),
    )


def _again(plan: Plan, draws: Draws, coarse: PlanRun, rows: Indices) -> tuple[PlanRun, PlanRun]:
    """Some runs as they were, and in the finer plant."""
    before = PlanRun(
        moves=tuple(some(move, rows) for move in coarse.moves),
        outcomes=coarse.outcomes[rows],
        failed_in=coarse.failed_in[rows],
    )
    return before, run_foreign(plan.rules, plan.setup, some(draws, rows), FINE)


def _error(changes: Sequence[Floats]) -> list[Floats]:
    """Per move (1, 3) the error of the plant: linear in its grain, which is a quarter in the finer one."""
    return [4.0 / 3.0 * change.max(axis=0, keepdims=True) for change in changes]


def _triple(values: Floats) -> Triple:
    x, y, theta = (round(float(v), 4) for v in values / SHOWN)
    return x, y, theta


def _breaks(plan: Plan, runs: PlanRun, slack: Sequence[Floats]) -> Flags:
    """(3, N) stuck, outside of a box, outside of the goal, each by more than the slack (1|N, 3)."""
    box = np.zeros(len(runs.outcomes), dtype=np.bool_)
    for k, (move, post) in enumerate(zip(runs.moves, plan.posts, strict=True)):
        if post is not None:
            out = (excess(move.after, post) > slack[k]).any(axis=1)
            box |= out & (runs.failed_in > k)
    goal = (excess(runs.final, plan.setup.goal) > slack[-1]).any(axis=1) & runs.completed
    return np.array([~runs.completed, box, goal])


def _changes(one: PlanRun, other: PlanRun) -> list[Floats]:
    """Per move (N, 3) by how much the poses after it differ; 0 of runs that one has not come so far."""
    return [
        np.where(
            ((one.failed_in > k) & (other.failed_in > k))[:, None], np.abs(a.after - b.after), 0.0
        )
        for k, (a, b) in enumerate(zip(one.moves, other.moves, strict=True))
    ]


def carried_on(
    plan: Plan, runs: int, seed: int, radius: Sequence[float] | None, name: str, out: Path
) -> Outcome:
    """Runs of a plan in chunks, each written as it is done."""
    path = out / RESULTS
    kept = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    rules = repr(plan.rules)
    key = {"task": plan.task.hash, "plan": rules, "seed": seed, "radius_um": radius}
    entry = kept.get(name, {})
    same = all(entry.get(k) == v for k, v in key.items())
    done = read(entry) if same else Outcome()
    while done.runs < runs:
        rng = np.random.default_rng([seed, done.runs])
        count = min(CHUNK, runs - done.runs)
        done = done.plus(outcome_of(plan, drawn(plan, count, rng, radius)))
        proved = sum(post is not None for post in plan.posts)
        kept[name] = {**key, "proved": [proved, len(plan.rules)], "outcome": asdict(done)}
        text = json.dumps(kept, indent=1, ensure_ascii=False) + "\n"
        write_all(out, {RESULTS: text, PAGE: page(kept)})
        sys.stdout.write(f"{name}: {done}\n")
        sys.stdout.flush()
    return done


def read(entry: dict[str, Any]) -> Outcome:
    """What was written of a task."""
    values: dict[str, Any] = entry["outcome"]
    values = {k: tuple(v) if isinstance(v, list) else v for k, v in values.items()}
    return Outcome(**values)


def page(kept: dict[str, dict[str, Any]]) -> str:
    """The results as a table in Markdown."""
    lines = [
        "# Plans in the foreign plant",
        "",
        "Written by `python -m reports.foreign_plant.campaign`; see the [README](README.md).",
        "",
        "| task | boxes proved | runs | stuck | outside a box | outside the goal | too close to call | error (um, um, deg) |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for name, entry in kept.items():
        o = read(entry)
        proved, moves = entry["proved"]
        error = ", ".join(f"{value:g}" for value in o.error)
        lines.append(
            f"| {name} | {proved} of {moves} | {o.runs:,} | {o.stuck} | {o.outside_box} | "
            f"{o.outside_goal} | {o.too_close} | {error} |"
        )
    return "\n".join(lines) + "\n"


def main() -> int:
    """Run; exit status 1 if a run broke what was promised."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--task", type=Path, action="append")
    parser.add_argument("--radius", type=float, nargs=2, metavar=("LOW", "HIGH"))
    parser.add_argument("--out", type=Path, default=OUT)
    asked = parser.parse_args()
    outside = 0
    for path in asked.task or (*TASKS, MICROSCOPE, *KEPT):
        plan = plan_of(load_task(path), path.with_name("plan.json") if path in KEPT else None)
        name = path.stem if path not in KEPT else f"real_paper, {KEPT[path]}"
        if asked.radius is not None:
            name += f", tips of {asked.radius[0]:g} to {asked.radius[1]:g} um instead"
        done = carried_on(plan, asked.runs, asked.seed, asked.radius, name, asked.out)
        outside += done.outside if asked.radius is None else 0
    return 1 if outside else 0


if __name__ == "__main__":
    sys.exit(main())
