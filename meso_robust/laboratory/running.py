"""Running a plan's policy in the simulator, as the laboratory would run it.

Before each move the pose is sensed with an error, the commands follow from the sensed pose, and the
probes go where they are commanded, with an error. Nothing of the proof is used here but the rules.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from meso_robust.laboratory.draws import Draws
from meso_robust.laboratory.engines import Engine, push_all
from meso_robust.laboratory.polygon import distances
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.outline import Polygon
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.simulator import Fixture, Outcome, Push
from meso_robust.types import Floats
from meso_robust.units import UM

_Numbers = TypeVar("_Numbers", Floats, npt.NDArray[np.int8])

STEP = 2e-6  # m, of the probes; its error is measured by a second run at half of it
STARTS_INSIDE = -1  # a run whose probe would start inside the part is not simulated further


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MoveRun:
    """One move of N runs."""

    before: Floats
    """(N, 3) true poses."""
    sensed: Floats
    """(N, 3) sensed poses that the commands follow from."""
    tips: Floats
    """(N, P, 2) true tip positions at the start: upper, lower and, if present, passive tip, m."""
    travel: Floats
    """(N, P, 2) displacement of the tips, m."""
    path: Floats
    """(N, record + 1, 3) poses during the move."""
    modes: npt.NDArray[np.int8]
    """(N, record + 1, P) contact mode of each tip during the move; see `PushResult.modes`.
    ``NOT_RECORDED`` by the event-driven engine."""
    after: Floats
    """(N, 3) true poses."""
    phases: npt.NDArray[np.int64] | None = None
    """(N,) intervals of constant contact modes, if the event-driven engine made the run; 0 for a
    run that had ended before."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlanRun:
    """N runs of a whole plan."""

    moves: tuple[MoveRun, ...]
    outcomes: npt.NDArray[np.int8]
    """(N,) values of ``Outcome``, or STARTS_INSIDE: why a run ended."""
    failed_in: npt.NDArray[np.int64]
    """(N,) index of the move in which the run ended early; the number of moves if it did not."""

    @property
    def final(self) -> Floats:
        """(N, 3) poses at the end."""
        return self.moves[-1].after

    @property
    def completed(self) -> npt.NDArray[np.bool_]:
        """(N,) whether every move was completed."""
        return self.outcomes == Outcome.COMPLETED


def run(
    rules: Sequence[MoveRule],
    setup: Setup,
    draws: Draws,
    *,
    record: int = 0,
    step: float = STEP,
    engine: Engine = "stepper",
) -> PlanRun:
    """Run the plan once for every row of ``draws``.

    Parameters
    ----------
    rules, setup
        The plan and the task.
    draws
        What is uncertain.
    record
        Intervals of the path to keep of each move.
    step
        Longest probe displacement of a simulation step, m; the event-driven engine takes none.
    engine
        Which engine of the simulator makes the moves.
    """
    poses = draws.start.copy()
    outcomes = np.full(len(poses), Outcome.COMPLETED, dtype=np.int8)
    failed_in = np.full(len(poses), len(rules))
    moves = []
    for k, rule in enumerate(rules):
        sensed = poses + draws.sensing[:, k]
        tips, travel = _commands(rule, sensed, draws, k, setup)
        alive = outcomes == Outcome.COMPLETED
        inside = alive & starts_inside(tips, poses, setup)
        outcomes[inside], failed_in[inside] = STARTS_INSIDE, k
        alive &= ~inside
        after, path = poses, np.broadcast_to(poses[:, None], (len(poses), record + 1, 3))
        modes = np.zeros((len(poses), record + 1, tips.shape[1]), dtype=np.int8)
        phases = np.zeros(len(poses), dtype=np.int64)
        if alive.any():
            which = slice(None) if alive.all() else alive  # a slice copies nothing
            result = push_all(
                Push.straight(
                    vertices=outline(setup),
                    poses=poses[which],
                    tips=tips[which],
                    travel=travel[which],
                    friction=draws.friction[which],
                    film_ratio=draws.film_ratio[which],
                    step=step,
                    fixture=walls(setup),
                ),
                engine,
                record,
            )
            after, outcomes[which] = _over(alive, result.poses, poses), result.outcomes
            if record:
                path, modes = _over(alive, result.path, path), _over(alive, result.modes, modes)
            phases[which] = result.phases
            failed_in[alive & (outcomes != Outcome.COMPLETED)] = k
        moves.append(
            MoveRun(
                before=poses,
                sensed=sensed,
                tips=tips,
                travel=travel,
                path=path,
                modes=modes,
                after=after,
                phases=phases if engine == "events" else None,
            )
        )
        poses = after
    return PlanRun(moves=tuple(moves), outcomes=outcomes, failed_in=failed_in)


def _over(alive: npt.NDArray[np.bool_], made: _Numbers, before: _Numbers) -> _Numbers:
    """What was made of the runs that are alive, and what there was before of the others."""
    if alive.all():
        return made
    whole = before.copy()
    whole[alive] = made
    return whole


def walls(setup: Setup) -> Fixture:
    """The walls of the task's slot, if it has one."""
    if setup.slot is None:
        return Fixture()
    outline = np.array(setup.slot.outline_um, dtype=np.float64) * UM
    return Fixture((outline,), setup.slot.friction)


def outline(setup: Setup) -> Floats:
    """(V, 2) corners of the part, body frame, counter-clockwise, m."""
    return np.array([[x.mid, y.mid] for x, y in setup.outline.corners])


def rectangle(setup: Setup) -> Floats:
    """(4, 2) corners of a part that must be a rectangle, as :func:`outline` gives them.

    Raises
    ------
    InputError
        The part is a polygon.
    """
    a, b = setup.half_length.mid, setup.half_width.mid
    return np.array([[-a, -b], [a, -b], [a, b], [-a, b]])


def _commands(
    rule: MoveRule, sensed: Floats, draws: Draws, k: int, setup: Setup
) -> tuple[Floats, Floats]:
    """True tip positions at the start and their travel: commands plus the probes' errors."""
    commanded = rule.commands(sensed, setup.spacing.mid, draws.misalignment)
    errors = [draws.dual[:, k], draws.dual[:, k], draws.single[:, k]][: commanded.tips.shape[1]]
    return commanded.tips + np.stack(errors, axis=1), commanded.travel


def starts_inside(tips: Floats, poses: Floats, setup: Setup) -> npt.NDArray[np.bool_]:
    """(N,) whether one of the tips (N, P, 2), m, is inside the part at its pose (N, 3)."""
    offset = tips - poses[:, None, :2]
    c, s = np.cos(poses[:, None, 2]), np.sin(poses[:, None, 2])
    along = c * offset[..., 0] + s * offset[..., 1]
    across = -s * offset[..., 0] + c * offset[..., 1]
    if isinstance(setup.outline, Polygon):
        own = np.stack([along, across], axis=-1)
        return np.asarray((distances(own, outline(setup)) < 0.0).any(axis=1))
    inside = (np.abs(along) < setup.half_length.mid) & (np.abs(across) < setup.half_width.mid)
    return np.asarray(inside.any(axis=1))


def excess(poses: Floats, box: PoseBox) -> Floats:
    """(N, 3) by how much each coordinate lies outside ``box`` (m, m, rad); 0 inside."""
    low = np.array([box.x.lo, box.y.lo, box.theta.lo])
    high = np.array([box.x.hi, box.y.hi, box.theta.hi])
    return np.maximum(np.maximum(low - poses, poses - high), 0.0)
