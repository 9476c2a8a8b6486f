"""How close certified boxes are to the truth: ``python -m reports.posts [--task FILE ...]``.

Every move of a plan is taken by itself: from all poses of its certified box before the move, with all that
is uncertain in the task, runs are bred towards each side of the certified box after it. A straightening
right after a tilt is proved from where the tilt began, and so both are run from there. The plan is the one
beside the task's file, ``plan.json``, or is searched for.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from meso_robust.certificates.chain import certify
from meso_robust.files import write_all
from meso_robust.laboratory.draws import TIPS, Draws, draw, spread
from meso_robust.planning.compose import compose
from meso_robust.planning.reading import read_plan
from meso_robust.planning.rules import rules_of
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.task import POINT_TIPS, load_task
from meso_robust.tasks import TASKS
from meso_robust.types import Floats
from meso_robust.units import DEG, UM
from reports.posts.changing import Changing, run
from reports.posts.search import largest

LEGS = 8
"""Stretches of a move, each with a friction of its own."""
OUT = Path(__file__).parent
REAL_PAPER = OUT.parent / "real_paper" / "task.toml"
RESULTS, PAGE = "results.json", "results.md"
SHOWN = np.array([UM, UM, DEG])


@dataclass(frozen=True, slots=True, kw_only=True)
class Width:
    """What is promised of a move, and what runs fill of it; um, um, deg."""

    task: str
    move: int
    action: str
    certified: tuple[float, ...]
    found: tuple[float, ...]

    @property
    def ratios(self) -> Floats:
        """(3,) certified over found."""
        return np.array(self.certified) / np.array(self.found)


def widths(path: Path, size: int, rounds: int) -> Iterator[Width]:
    """The moves of a task's plan, one after the other."""
    task = load_task(path)
    setup, kept = setup_of(task), path.with_name("plan.json")
    rules = rules_of(read_plan(kept, task)) if kept.exists() else compose(task).rules
    steps = certify(rules, setup).steps
    for k, step in enumerate(steps):
        if step.post is None:
            return
        first = k - 1 if k and _together(steps[k - 1], step) else k
        moves, film = steps[first : k + 1], task.schema_ != POINT_TIPS
        found = filled(moves, setup, stated=first == 0, film=film, size=size, rounds=rounds)
        certified = np.ptp(step.post.ends, axis=0)
        yield Width(
            task=_name(path),
            move=k + 1,
            action=step.rule.action,
            certified=tuple(certified / SHOWN),
            found=tuple(found / SHOWN),
        )


def _together(before: Step, step: Step) -> bool:
    actions = (before.rule.action, step.rule.action)
    return actions == ("tilt", "straighten") and before.rule.frame == step.rule.frame


def filled(
    steps: Sequence[Step], setup: Setup, *, stated: bool, film: bool, size: int, rounds: int
) -> Floats:
    """(3,) how far apart runs end that begin in the box before the first of some moves.

    ``stated``: that box is the task's start, so that the pose sensed there is the stated one. ``film``: its
    drag may change on the way.
    """
    own, rules = replace(setup, start=steps[0].pre), [step.rule for step in steps]
    rng = np.random.default_rng(0)

    def fresh(count: int) -> Draws:
        drawn = draw(own, len(rules) + (not stated), count, rng)
        drawn = drawn if stated else replace(drawn, sensing=drawn.sensing[:, 1:])
        drawn = varying(drawn, own, rng)
        # the stretches of a path that wanders are of another kind
        return drawn if drawn.wander is not None or not film else Changing.of(drawn, own, LEGS, rng)

    def along(axis: int, sign: float) -> float:
        def value(draws: Draws) -> Floats:
            runs = run(rules, own, at_tips(draws))
            return np.where(runs.completed, sign * runs.final[:, axis], -np.inf)

        return largest(fresh, value, size, rounds, seed=axis)

    return np.array([along(axis, 1.0) + along(axis, -1.0) for axis in range(3)])


def varying(draws: Draws, setup: Setup, rng: np.random.Generator) -> Draws:
    """The same with friction that changes on the way, as the promise allows it to at every instant.

    One number a stretch where all tips have the same; see :func:`at_tips`.
    """
    if draws.wander is not None:
        return draws  # its legs are those of the path
    u, shape = setup.uncertainty, (*draws.sensing.shape[:2], LEGS)
    own = spread(u.friction.lo, u.friction.hi, (*shape, 1 if setup.friction_common else TIPS), rng)
    return replace(draws, tip_friction=own)


def at_tips(draws: Draws) -> Draws:
    """The same with a number for every tip."""
    own = draws.tip_friction
    return draws if own is None else replace(draws, tip_friction=own + np.zeros(TIPS))


def kept(folder: Path) -> list[Width]:
    """What an earlier run found, of all tasks."""
    path = folder / RESULTS
    return [Width(**one) for one in json.loads(path.read_text())] if path.exists() else []


def _name(path: Path) -> str:
    return path.parent.name if path.stem == "task" else path.stem


def page(rows: Sequence[Width]) -> str:
    """The results as tables in Markdown."""
    by_action = {
        action: np.array([one.ratios for one in rows if one.action == action])
        for action in dict.fromkeys(one.action for one in rows)
    }
    lines = [
        "# Certified boxes beside what runs fill of them",
        "",
        "Written by `python -m reports.posts`; see the [README](README.md).",
        "",
        "| move | how many | x: median, largest | y: median, largest | theta: median, largest |",
        "|---|---|---|---|---|",
    ]
    for action, ratios in by_action.items():
        told = [f"{np.median(one):.2f}, {one.max():.2f}" for one in ratios.T]
        lines.append(f"| {action} | {len(ratios)} | " + " | ".join(told) + " |")
    lines += [
        "",
        "| task | move | action | certified (um, um, deg) | over what runs fill |",
        "|---|---|---|---|---|",
    ]
    for one in rows:
        sides = ", ".join(f"{value:.4g}" for value in one.certified)
        over = ", ".join(f"{value:.2f}" for value in one.ratios)
        lines.append(f"| {one.task} | {one.move} | {one.action} | {sides} | {over} |")
    return "\n".join(lines) + "\n"


def main() -> int:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--task", type=Path, action="append")
    parser.add_argument("--size", type=int, default=2000, help="draws of a round")
    parser.add_argument("--rounds", type=int, default=30)
    parser.add_argument("--out", type=Path, default=OUT)
    asked = parser.parse_args()
    for path in asked.task or (*TASKS, REAL_PAPER):
        found: list[Width] = []
        for one in widths(path, asked.size, asked.rounds):
            found.append(one)
            sys.stdout.write(f"{one.task} {one.move} {one.action}: {one.ratios.round(3)}\n")
            sys.stdout.flush()
        rows = [*(one for one in kept(asked.out) if one.task != _name(path)), *found]
        text = json.dumps([asdict(one) for one in rows], indent=1) + "\n"
        write_all(asked.out, {RESULTS: text, PAGE: page(rows)})
    return 0


if __name__ == "__main__":
    sys.exit(main())
