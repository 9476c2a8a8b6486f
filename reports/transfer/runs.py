"""Runs under effects that are bounded by the speed, against the certified boxes: ``python -m reports.transfer.runs``.

Laboratories are drawn from the same models as those of :mod:`reports.transfer.effects`, half of them at the ends
of their intervals, and simulated with the effect as the simulator has it.
"""

from __future__ import annotations

import numpy as np

from meso_robust.files import write_all
from meso_robust.laboratory.running import excess
from meso_robust.task import Task
from meso_robust.transfer.promise import as_fast, recertified
from meso_robust.transfer.running import outcomes_of
from reports.transfer.effects import HERE, cases, fitted

EFFECTS = ("dry_friction", "stribeck_friction", "uneven_support")
RUNS, SEED = 900, 7
MARKS = "<!-- runs: made by the program -->\n", "<!-- end of runs -->\n"


def row(effect: str, task: Task) -> str:
    """How many runs of an effect were carried out, and how many left a box that is certified."""
    document = fitted(effect, cases()[effect])
    found = recertified(task, document)
    fast = as_fast(task, found.changed.task)
    ran = outcomes_of(found.plan.rules, fast, document, RUNS, SEED)
    left = np.zeros(RUNS, dtype=np.bool_)
    for move, step in zip(ran.moves, found.wide.steps, strict=True):
        if step.post is not None:
            left |= (excess(move.after, step.post) > 0.0).any(axis=1)
    speed = found.changed.task.probe.speed_um_s
    verdict = found.wide.verdict.name if found.proved else "UNKNOWN"
    return f"| `{effect}` | {verdict} | {speed:g} | {RUNS} | {int(ran.completed.sum())} | {int(left.sum())} |"


def main() -> None:
    """Write the table into the page."""
    page = (HERE / "README.md").read_text(encoding="utf-8")
    before, rest = page.split(MARKS[0])
    after = rest.split(MARKS[1])[1]
    lines = [
        "| effect | verdict | µm/s | runs | carried out | outside a certified box |",
        "|---|---|---|---|---|---|",
        *(row(effect, Task.paper()) for effect in EFFECTS),
    ]
    table = "\n".join(lines)
    write_all(HERE, {"README.md": before + MARKS[0] + "\n" + table + "\n\n" + MARKS[1] + after})


if __name__ == "__main__":
    main()
