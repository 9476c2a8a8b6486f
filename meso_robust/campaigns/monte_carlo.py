"""Running a plan's policy in the simulator, as the laboratory would run it.

Before each move the pose is sensed with an error, the commands follow from the sensed pose, and the
probes go where they are commanded, with an error. Nothing of the proof is used here but the rules.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from meso_robust.campaigns.draws import Draws
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.simulator import Outcome, Push, simulate

Floats = npt.NDArray[np.float64]

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
    """(N, record + 1, P) contact mode of each tip during the move; see `PushResult.modes`."""
    after: Floats
    """(N, 3) true poses."""


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
        Longest probe displacement of a simulation step, m.
    """
    poses = draws.start.copy()
    outcomes = np.full(len(poses), Outcome.COMPLETED, dtype=np.int8)
    failed_in = np.full(len(poses), len(rules))
    moves = []
    for k, rule in enumerate(rules):
        sensed = poses + draws.sensing[:, k]
        tips, travel = _commands(rule, sensed, draws, k, setup)
        alive = outcomes == Outcome.COMPLETED
        inside = alive & _starts_inside(tips, poses, setup)
        outcomes[inside], failed_in[inside] = STARTS_INSIDE, k
        alive &= ~inside
        after, path = poses.copy(), np.repeat(poses[:, None], record + 1, axis=1)
        modes = np.zeros((len(poses), record + 1, tips.shape[1]), dtype=np.int8)
        if alive.any():
            result = simulate(
                Push.straight(
                    vertices=rectangle(setup),
                    poses=poses[alive],
                    tips=tips[alive],
                    travel=travel[alive],
                    friction=draws.friction[alive],
                    film_ratio=draws.film_ratio[alive],
                    step=step,
                ),
                record=record,
            )
            after[alive], outcomes[alive] = result.poses, result.outcomes
            if record:
                path[alive], modes[alive] = result.path, result.modes
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
            )
        )
        poses = after
    return PlanRun(moves=tuple(moves), outcomes=outcomes, failed_in=failed_in)


def rectangle(setup: Setup) -> Floats:
    """(4, 2) corners of the part, body frame, counter-clockwise, m."""
    a, b = setup.half_length.mid, setup.half_width.mid
    return np.array([[-a, -b], [a, -b], [a, b], [-a, b]])


def _commands(
    rule: MoveRule, sensed: Floats, draws: Draws, k: int, setup: Setup
) -> tuple[Floats, Floats]:
    """True tip positions at the start and their travel: commands plus the probes' errors."""
    middle = np.stack(
        [rule.dual.x.command(sensed[:, 0]), rule.dual.y.command(sensed[:, 1])], axis=1
    )
    end = rule.dual_end.command(sensed[:, 0])
    up = 0.5 * setup.spacing.mid
    # a positive misalignment puts the upper tip ahead, towards -x
    upper = np.stack([-up * np.tan(draws.misalignment), np.full(len(sensed), up)], axis=1)
    tips = [middle + draws.dual[:, k] + upper, middle + draws.dual[:, k] - upper]
    push = np.stack([end - middle[:, 0], np.zeros(len(sensed))], axis=1)
    travel = [push, push]
    if rule.single is not None:
        passive = np.stack(
            [rule.single.x.command(sensed[:, 0]), rule.single.y.command(sensed[:, 1])], axis=1
        )
        tips.append(passive + draws.single[:, k])
        travel.append(np.zeros_like(push))
    return np.stack(tips, axis=1), np.stack(travel, axis=1)


def _starts_inside(tips: Floats, poses: Floats, setup: Setup) -> npt.NDArray[np.bool_]:
    offset = tips - poses[:, None, :2]
    c, s = np.cos(poses[:, None, 2]), np.sin(poses[:, None, 2])
    along = c * offset[..., 0] + s * offset[..., 1]
    across = -s * offset[..., 0] + c * offset[..., 1]
    inside = (np.abs(along) < setup.half_length.mid) & (np.abs(across) < setup.half_width.mid)
    return np.asarray(inside.any(axis=1))


def excess(poses: Floats, box: PoseBox) -> Floats:
    """(N, 3) by how much each coordinate lies outside ``box`` (m, m, rad); 0 inside."""
    low = np.array([box.x.lo, box.y.lo, box.theta.lo])
    high = np.array([box.x.hi, box.y.hi, box.theta.hi])
    return np.maximum(np.maximum(low - poses, poses - high), 0.0)
