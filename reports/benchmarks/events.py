"""Time of a push of 1 mm by the event-driven engine."""

from collections.abc import Callable

import numpy as np

from meso_robust.simulator import Outcome
from meso_robust.simulator.events import EventResult, integrate
from reports.benchmarks.timing import best_of, number, reached, table
from tests.simulator.problems import HALF_SHORT, MU, RHO, UM, rectangle

RUNS = 100
"""Few enough for the engine to keep to one thread."""


def _one_tip(low_um: float, high_um: float, runs: int) -> EventResult:
    """One tip on the long side of the paper's part, at places from `low_um` to `high_um`."""
    places = np.linspace(low_um, high_um, runs) * UM
    return integrate(
        vertices=rectangle(),
        poses=np.zeros((runs, 3)),
        tips=np.stack([places, np.full(runs, -HALF_SHORT)], axis=1)[:, None],
        travel=np.tile([0.0, 1000 * UM], (runs, 1, 1)),
        friction=np.full((runs, 1), MU),
        drag=np.diag([1.0, 1.0, RHO]),
    )


def _two_tips(runs: int) -> EventResult:
    """A passive tip low on one side and one high on the other that goes on: the part turns."""
    heights = np.linspace(900, 1300, runs) * UM
    tips = np.zeros((runs, 2, 2))
    tips[:, 0] = np.column_stack([np.full(runs, -HALF_SHORT), -heights / 2])
    tips[:, 1] = np.column_stack([np.full(runs, HALF_SHORT), heights / 2])
    travel = np.zeros((runs, 2, 2))
    travel[:, 1, 0] = -1000 * UM
    return integrate(
        vertices=rectangle(),
        poses=np.tile([0.0, 0.0, np.pi / 2], (runs, 1)),
        tips=tips,
        travel=travel,
        friction=np.full((runs, 2), MU),
        drag=np.diag([1.0, 1.0, RHO]),
    )


def _row(name: str, move: Callable[[int], EventResult], phases: tuple[int, int]) -> tuple[str, ...]:
    """Time one kind of push."""
    result = move(RUNS)
    least, most = int(result.events.min()), int(result.events.max())
    if np.any(result.outcomes != Outcome.COMPLETED) or not (
        phases[0] <= least <= most <= phases[1]
    ):
        outcomes = set(result.outcomes.tolist())
        raise RuntimeError(f"{name}: outcomes {outcomes}, {least} to {most} phases")
    batch, alone = best_of(lambda: move(RUNS), 25), best_of(lambda: move(1), 50)
    each = 1e6 * batch.cpu / RUNS
    goal = reached(each, 20.0, most=True)
    times = (number(each), number(1e6 * batch.wall / RUNS), number(1e6 * alone.cpu))
    return name, f"{result.events.mean():.1f}", *times, *goal


def two_tips_us() -> float:
    """µs of the processor that a push of 1 mm between two tips takes, in a run of many."""
    return 1e6 * best_of(lambda: _two_tips(RUNS), 25).cpu / RUNS


def section() -> list[str]:
    """Lines of this part of the report."""
    heads = (
        "push of 1 mm on a film", "phases", f"µs a run of {RUNS} (CPU time)", "µs (wall clock)",
        "µs for one call alone", "target", "reached",
    )  # fmt: skip
    rows = [
        _row("one tip, sticks", lambda runs: _one_tip(5, 40, runs), (1, 1)),
        _row("one tip, sticks, then slips", lambda runs: _one_tip(300, 600, runs), (2, 4)),
        _row("two tips on opposite sides", _two_tips, (1, 10)),
    ]
    return table("Event-driven engine", heads, rows)
