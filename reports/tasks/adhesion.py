"""How much adhesion the small part's plan bears in simulation: ``python -m reports.tasks.adhesion``.

No certificate takes a pull, so this is evidence: runs of the plan with tips that back off in the plane,
at uniform draws and corners of the task's uncertainties, for pulls of one size each.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from meso_robust.files import write_all
from meso_robust.identification.document import ModelDocument
from meso_robust.planning.compose import compose
from meso_robust.primitives.move import MoveRule
from meso_robust.reproduction.scales import FULL_UM, PULLS
from meso_robust.task import Task, load_task
from meso_robust.tasks import SMALL
from meso_robust.transfer.promise import MOST_RUNS
from meso_robust.transfer.running import Evidence, evidence
from tests.transfer.models import model

PULLS_UM_S = (0.5, 1.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0, 16.0, 20.0, 30.0, 40.0)
HALVINGS = 4
COMMAND = "python -m reports.tasks.adhesion --out reports/tasks"


def adhering(pull_um_s: float) -> ModelDocument:
    """The task's own physics, with tips that pull so hard until they are 2 um away."""
    task = load_task(SMALL)
    return model(
        {"tip_adhesion.pull_um_s": (pull_um_s, pull_um_s)},
        base={"rho_um2": (12_850.0, 13_130.0), "mu": (0.30, 0.36)},
        held={"tip_adhesion.range_um": 2.0},
        part=task.part.model_dump(exclude_none=True),
    )


def at(pull_um_s: float, rules: Sequence[MoveRule], task: Task, runs: int) -> Evidence:
    """Runs with one pull."""
    return evidence(rules, task, adhering(pull_um_s), runs, 0, (0.0, 0.0, 0.0))


def borne(rules: Sequence[MoveRule], task: Task, runs: int, low: float, high: float) -> float:
    """A pull that all runs bear, by halving between one that they bear and one that some do not."""
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        all_in = at(middle, rules, task, runs).in_goal == runs
        low, high = (middle, high) if all_in else (low, middle)
    return low


def page(pulls: Sequence[float], runs: int) -> str:
    """The report."""
    task = load_task(SMALL)
    rules = compose(task).rules
    found = [(pull, at(pull, rules, task, runs)) for pull in pulls]
    good = max((pull for pull, one in found if one.in_goal == runs), default=0.0)
    bad = min((pull for pull, one in found if one.in_goal < runs and pull > good), default=good)
    limit = borne(rules, task, runs, good, bad)
    size = task.rectangle("the report").length_um / FULL_UM
    lines = [
        "# A 300 µm part whose tips adhere",
        "",
        f"`{COMMAND}`: the plan for `meso_robust/tasks/small.toml`, {runs} runs a pull, the tips back "
        f"off in the plane at {task.probe.speed_um_s:g} µm/s until the meniscus breaks at 2 µm. The "
        "pull is the force of one tip over the film's drag. This is evidence: adhesion is in no "
        "certificate, and `plan --model` answers UNKNOWN.",
        "",
        "| pull in µm/s | in the goal | worst miss in µm | in deg | ended early |",
        "|---|---|---|---|---|",
        *(_row(pull, one) for pull, one in found),
        "",
        f"All {runs} runs end in the goal up to {limit:.2g} µm/s (by halving). What fails first is the "
        "start of the next move: it is free of contact from the certified box of poses, and a tip that "
        "leaves drags the part out of it. Two tips that pull at p "
        "each are left behind only if they back off faster than the part follows, 2 p and more if they "
        f"pull off its centre; at {task.probe.speed_um_s:g} µm/s that is near "
        f"{task.probe.speed_um_s / 2:.0f} µm/s at the latest.",
        "",
        "For comparison, pulls of a meniscus of oil at this size (`reproduce`, smaller scales): "
        + "; ".join(f"{pull.name}: {pull.um_s(size):.0f} µm/s" for pull in PULLS)
        + ". A tip must hold less than a hundredth of its meniscus, as one wetted by the film's own oil "
        "may, or leave faster, or be lifted out of the plane.",
    ]
    return "\n".join(lines) + "\n"


def _row(pull: float, one: Evidence) -> str:
    early = "; ".join(f"{count}: {how}" for how, count in one.endings) or "–"
    share = f"{one.in_goal} of {one.runs}"
    return f"| {pull:g} | {share} | {one.worst_um:g} | {one.worst_deg:g} | {early} |"


def main() -> None:
    """Write ``small.md``."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="folder of small.md")
    write_all(parser.parse_args().out, {"small.md": page(PULLS_UM_S, MOST_RUNS)})


if __name__ == "__main__":
    main()
