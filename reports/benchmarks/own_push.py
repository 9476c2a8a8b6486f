"""The common push by the time stepper and by the event-driven engine."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from meso_robust.simulator import Outcome, simulate
from meso_robust.simulator.events import integrate
from reports.benchmarks.one_push import (
    BOX,
    FILM_RATIO,
    MM,
    MU,
    OUTPUTS,
    RADIUS,
    TIP,
    TRAVEL,
    Ground,
    errors,
    push,
)
from reports.benchmarks.timing import Clock, best_of

F = npt.NDArray[np.float64]

LIMIT = 0.1
"""%, the error that counts as accurate."""
RUNS = 32
"""Of a batch over which the cost of a call is spread."""
_LADDER = (25, 50, 75, 100, 150, 200, 220, 240, 260, 280, 300, 400, 600, 800, 1600, 3200)


def _end(poses: F, outcomes: npt.NDArray[np.int8]) -> F:
    """Pose of the first run in mm and degrees."""
    if not np.all(outcomes == Outcome.COMPLETED):
        raise RuntimeError(f"outcomes {set(outcomes.tolist())}: the push is not completed")
    return np.array([poses[0, 0] / MM, poses[0, 1] / MM, np.degrees(poses[0, 2])])


def stepped(ground: Ground, steps: int) -> F:
    """End of the push by the time stepper: x, y in mm, θ in deg."""
    result = simulate(push(ground, steps), record=OUTPUTS, workers=1)
    return _end(result.poses, result.outcomes)


def accurate_steps(ground: Ground, exact: F) -> int:
    """Fewest steps of a ladder with an error within the limit.

    Raises
    ------
    RuntimeError
        If none is.
    """
    for steps in _LADDER:
        if max(errors(stepped(ground, steps), exact)) <= LIMIT:
            return steps
    raise RuntimeError(f"{ground.name}: not within {LIMIT} % after {_LADDER[-1]} steps")


def step_times(ground: Ground, steps: int) -> tuple[Clock, Clock]:
    """Times of one call, and of a run in a batch on one thread, with the record."""
    one, many = push(ground, steps), push(ground, steps, RUNS)
    alone = best_of(lambda: simulate(one, record=OUTPUTS, workers=1), 50)
    return alone, _each(lambda: simulate(many, record=OUTPUTS, workers=1))


def _each(work: Callable[[], object]) -> Clock:
    """Times of one run of a batch."""
    batch = best_of(work, 25)
    return Clock(wall=batch.wall / RUNS, cpu=batch.cpu / RUNS)


def _followed(runs: int, samples: int = OUTPUTS) -> tuple[F, npt.NDArray[np.int8]]:
    """The push on the film by the event-driven engine."""
    result = integrate(
        vertices=BOX * MM,
        poses=np.zeros((runs, 3)),
        tips=np.tile(TIP * MM, (runs, 1, 1)),
        travel=np.tile([0.0, TRAVEL * MM], (runs, 1, 1)),
        friction=np.full((runs, 1), MU),
        drag=np.diag([1.0, 1.0, FILM_RATIO * MM**2]),
        radii=np.array([RADIUS * MM]),
        samples=samples,
    )
    return result.poses, result.outcomes


def followed() -> F:
    """End of the push on the film by the event-driven engine: x, y in mm, θ in deg."""
    return _end(*_followed(1))


def follow_times() -> tuple[Clock, Clock, Clock]:
    """Times of one call, of a run in a batch on one thread, and of that without outputs."""
    alone = best_of(lambda: _followed(1), 50)
    return alone, _each(lambda: _followed(RUNS)), _each(lambda: _followed(RUNS, 0))
