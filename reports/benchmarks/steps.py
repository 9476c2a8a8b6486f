"""Steps per second of the time stepper on one thread, on every kind of support."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from meso_robust.simulator import (
    Film,
    Fixture,
    LimitSurface,
    Mixture,
    Outcome,
    Push,
    ThreePoints,
    simulate,
)
from meso_robust.simulator.fixture import slot
from meso_robust.simulator.support_models import Support
from reports.benchmarks.timing import best_of, number, reached, table
from tests.simulator.problems import HALF_LONG, HALF_SHORT, MU, RHO, UM, rectangle, two_sided

F = npt.NDArray[np.float64]

FEET = np.array([[-600.0, -300.0], [600.0, -300.0], [0.0, 300.0]]) * UM
_STEP = 1.0 * UM
_TRAVEL = 1000.0 * UM


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """A batch whose steps are timed."""

    name: str
    push: Push
    target: float | None = None
    """Steps per second."""


def one_sided(support: Support, runs: int, low_um: float = -300.0, high_um: float = 300.0) -> Push:
    """One tip on the long side of the paper's part: by default about the centre, sticking and sliding."""
    offsets = np.linspace(low_um, high_um, runs) * UM
    tips = np.stack([offsets, np.full(runs, -HALF_SHORT)], axis=1)[:, None]
    return Push.straight(
        vertices=rectangle(),
        poses=np.zeros((runs, 3)),
        tips=tips,
        travel=np.tile([0.0, _TRAVEL], (runs, 1, 1)),
        friction=np.full(runs, MU),
        support=support,
        step=_STEP,
    )


def in_slot(runs: int) -> Push:
    """One tip drives the part down a slot, off the centre line, against both walls."""
    offsets = np.linspace(100.0, 300.0, runs) * UM
    tips = np.stack([np.full(runs, HALF_LONG - 900.0 * UM), offsets], axis=1)[:, None]
    fixture: Fixture = slot((0.0, 0.0), 4000.0 * UM, friction=0.2)
    return Push.straight(
        vertices=rectangle(),
        poses=np.tile([-900.0 * UM, 0.0, 0.0], (runs, 1)),
        tips=tips,
        travel=np.tile([-_TRAVEL, 0.0], (runs, 1, 1)),
        friction=np.full(runs, MU),
        film_ratio=RHO,
        fixture=fixture,
        step=_STEP,
    )


def jobs() -> list[Job]:
    """What is timed."""
    feet = ThreePoints(points=FEET)
    film = Film.ratio(RHO)
    both = Mixture(film=film, dry=feet, ratio=1.0)
    surface = LimitSurface(np.diag([1.0, 1.0, RHO]))
    # Both tips stay on the part, without a jam, over the whole of this move.
    sided = two_sided(np.linspace(900, 1300, 200) * UM, _TRAVEL, 0.5 * UM)
    return [
        Job(name="film, two tips in contact", push=sided, target=1.5e6),
        Job(name="film, one tip", push=one_sided(film, 200)),
        Job(name="film, one tip, part against the walls of a slot", push=in_slot(100)),
        Job(name="three support points, one tip", push=one_sided(feet, 100), target=1e5),
        # The tip slides, and the part turns about the foot that stands still.
        Job(name="the same, one point at rest", push=one_sided(feet, 100, 310.0, 430.0)),
        Job(name="ellipsoidal limit surface, one tip", push=one_sided(surface, 100)),
        Job(name="film and three support points, one tip", push=one_sided(both, 100)),
    ]


def rate(job: Job) -> float:
    """Steps a second of the processor, by one thread; all runs are completed."""
    clock = best_of(lambda: simulate(job.push, workers=1), 8)
    return job.push.steps * len(job.push.poses) / clock.cpu


def _row(job: Job) -> tuple[str, ...]:
    """Time one batch."""
    result = simulate(job.push, workers=1)
    completed = int(np.sum(result.outcomes == Outcome.COMPLETED))
    ends = sorted({Outcome(k).name.lower() for k in result.outcomes} - {"completed"})
    clock = best_of(lambda: simulate(job.push, workers=1), 8)
    steps = completed * job.push.steps
    cells = reached(steps / clock.cpu, job.target) if job.target else ("", "")
    speeds = (number(steps / clock.cpu), number(steps / clock.wall))
    return job.name, *speeds, ", ".join([f"{completed} of {len(result.outcomes)}", *ends]), *cells


def section() -> list[str]:
    """Lines of this part of the report."""
    heads: tuple[str, ...] = (
        "one thread",
        "steps/s (CPU time)",
        "steps/s (wall clock)",
        "runs completed",
    )
    heads += ("target", "reached")
    return table("Steps of the time stepper", heads, [_row(job) for job in jobs()])
