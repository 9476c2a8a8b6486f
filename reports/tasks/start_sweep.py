"""From which starts two probes lead to the goal that one does not: ``python -m reports.tasks.start_sweep``.

The shipped task of two probes is planned from a grid of starts, for one probe, for two and for four,
at the task's own uncertainties; every plan that is found is certified.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from meso_robust.bounds import Verdict
from meso_robust.certificates.chain import certify
from meso_robust.files import write_all
from meso_robust.planning.compose import IN_HAND, robust_at
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Heading, Task, load_task
from meso_robust.tasks import TWO_PROBES

ONE: tuple[Heading, ...] = ("-x",)
TWO: tuple[Heading, ...] = ("-x", "+x")
FOUR: tuple[Heading, ...] = ("-x", "+x", "-y", "+y")
XS = tuple(range(-3000, 3001, 500))
YS = (-300, -200, -100, 0, 100, 200, 300)
FAR = (-3000, -1000, -300, 300, 1000, 3000)
COMMAND = "python -m reports.tasks.start_sweep --out reports/tasks"


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """What came out for one start."""

    x_um: int
    y_um: int
    proved: bool
    headings: tuple[Heading, ...]
    """Of the moves."""


def task_at(x_um: float, y_um: float, headings: Sequence[Heading]) -> Task:
    """The shipped task from another start, with these probes."""
    task = load_task(TWO_PROBES)
    start = task.start.model_copy(update={"x_um": float(x_um), "y_um": float(y_um)})
    probe = task.probe.model_copy(update={"headings": tuple(headings)})
    return task.model_copy(update={"start": start, "probe": probe})


def found_at(x_um: int, y_um: int, headings: Sequence[Heading]) -> Found:
    """The verdict from one start."""
    task = task_at(x_um, y_um, headings)
    plans = (robust_at(task, scale) for scale in IN_HAND)
    rules = next((plan for plan in plans if plan is not None), ())
    proved = bool(rules) and certify(rules, setup_of(task)).verdict is Verdict.PROVED
    moves = tuple(rule.frame.heading for rule in rules)
    return Found(x_um=x_um, y_um=y_um, proved=proved, headings=moves)


def table(xs: Sequence[int], ys: Sequence[int], headings: Sequence[Heading]) -> Iterator[str]:
    """Rows of a grid, the largest y first; a cell has the headings of the moves."""
    yield f"| y \\ x in µm | {' | '.join(str(x) for x in xs)} |"
    yield f"|---|{'---|' * len(xs)}"
    for y in sorted(ys, reverse=True):
        cells = (_cell(found_at(x, y, headings)) for x in xs)
        yield f"| {y} | {' | '.join(cells)} |"


def _cell(found: Found) -> str:
    return " ".join(found.headings) if found.proved else "UNKNOWN"


def page(xs: Sequence[int], ys: Sequence[int], far: Sequence[int]) -> str:
    """The report."""
    task = load_task(TWO_PROBES)
    goal = task.goal
    lines = [
        "# Starts that need probes on more than one side",
        "",
        f"`{COMMAND}`: `meso_robust/tasks/two_probes.toml` planned from other starts, all at "
        f"{task.start.theta_deg:g}°, to the same goal ({goal.x_um:g} µm, {goal.y_um:g} µm, "
        f"{goal.theta_deg:g}°), with the task's uncertainties. A cell holds the headings of the moves "
        "of a plan that is PROVED; UNKNOWN: no robust plan was found, which does not say that there is "
        "none.",
        "",
        f"## One probe, `headings = {list(ONE)}`",
        "",
        *table(xs, (0,), ONE),
        "",
        f"## Two probes, `headings = {list(TWO)}`",
        "",
        *table(xs, ys, TWO),
        "",
        "Nothing is asked of x. The rotation pushes below or above the goal's line, so it makes up for "
        "y as far as a tip still meets the long edge where it turns the part.",
        "",
        f"## Four probes, `headings = {list(FOUR)}`",
        "",
        *table(xs[::3], far, FOUR),
        "",
        "A push across brings the part in line first; then nothing is asked of y either.",
    ]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Write ``two_probes.md``."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="folder of two_probes.md")
    write_all(parser.parse_args().out, {"two_probes.md": page(XS, YS, FAR)})


if __name__ == "__main__":
    main()
