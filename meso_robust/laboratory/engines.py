"""The two engines of the simulator behind one call, for moves of rectangles on a film."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from meso_robust.simulator import Push, simulate
from meso_robust.simulator.exact import exact
from meso_robust.simulator.stage import REFERENCE_SPEED
from meso_robust.types import Floats

Engine = Literal["stepper", "events"]

NOT_RECORDED = -1  # no contact mode and no number of phases is negative


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pushed:
    """What a move did to the part in each of N runs, by either engine."""

    poses: Floats
    """(N, 3) poses at the end, m and rad."""
    outcomes: npt.NDArray[np.int8]
    """(N,) values of ``Outcome``."""
    path: Floats
    """(N, record + 1, 3) poses during the move, or no poses."""
    modes: npt.NDArray[np.int8]
    """(N, record + 1, P) contact modes during the move by the stepper; see ``PushResult.modes``.
    The event-driven engine keeps no modes at instants: all ``NOT_RECORDED``."""
    phases: npt.NDArray[np.int64]
    """(N,) intervals of constant contact modes by the event-driven engine; the stepper does not
    count them: all ``NOT_RECORDED``."""
    forces: Floats | None = None
    """(N, record + 1, P, 2) force of each tip on the part by the stepper, over the mean drag and the
    speed of the fastest tip; the event-driven engine keeps none."""


def push_all(push: Push, engine: Engine, record: int = 0) -> Pushed:
    """Push the part of every run through the move.

    Parameters
    ----------
    push
        The move and its N runs.
    engine
        ``stepper`` (time steps, a complementarity problem each) or ``events`` (event-driven).
    record
        Intervals of the path to keep; 0 keeps none.

    Returns
    -------
    Pushed
        The same of either engine.
    """
    runs, probes = len(push.poses), push.waypoints.shape[2]
    if engine == "stepper":
        taken = simulate(push, record=record)
        return Pushed(
            poses=taken.poses,
            outcomes=taken.outcomes,
            path=taken.path,
            modes=taken.modes,
            phases=np.full(runs, NOT_RECORDED),
            forces=taken.forces / REFERENCE_SPEED,
        )
    found = exact(push, samples=record)
    return Pushed(
        poses=found.poses,
        outcomes=found.outcomes,
        path=found.path,
        modes=np.full((runs, record + 1 if record else 0, probes), NOT_RECORDED, dtype=np.int8),
        phases=found.events,
    )
