"""Holding a certified plan against the simulator, which shares nothing with the proof."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from meso_robust.laboratory.draws import Draws, draw, nominal, some
from meso_robust.laboratory.running import STARTS_INSIDE, STEP, PlanRun, excess, run
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.simulator import Outcome

RECORD = 48  # intervals of a recorded path
CLEAR = 4.0  # times the simulator's error, which is only estimated: what counts as missing the goal
ROUNDING = 1e-12  # m and rad: what thousands of steps in doubles can add up to
REFUTING = (STARTS_INSIDE, Outcome.JAM)  # how a run can end that breaks the claim
COMPARED = 64  # runs that are repeated at half the step: enough for an estimate of its error


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CrossCheck:
    """What the simulator says of a plan."""

    seed: int
    draws: Draws
    nominal: PlanRun
    sampled: PlanRun
    missed: npt.NDArray[np.float64]
    """(N, 3) by how much the last pose lies outside the goal (m, m, rad)."""
    in_box: npt.NDArray[np.bool_] | None
    """(N,) whether it ended in the certified box of the last move, where there is one."""
    step_excess: tuple[tuple[float, float, float], ...]
    """Largest distance outside the certified box after each move (m, m, rad)."""
    error: tuple[float, float, float]
    """Largest change of any pose after a move when the simulation step is halved (m, m, rad)."""

    @property
    def in_goal(self) -> npt.NDArray[np.bool_]:
        """(N,) whether the run was completed and ended in the goal."""
        return self.sampled.completed & (self.missed == 0.0).all(axis=1)

    @property
    def failure(self) -> int | None:
        """A run that could not be carried out, else the one that misses the goal by most.

        None if there is neither. A failure of the solver says nothing of the plan, and a miss
        within ``CLEAR`` times the simulator's own error (or the rounding of doubles) nothing either.
        """
        stuck = np.flatnonzero(np.isin(self.sampled.outcomes, REFUTING))
        if stuck.size:
            return int(stuck[0])
        clear = self.sampled.completed & _clear(self.missed, self.error).any(axis=1)
        if not clear.any():
            return None
        return int(np.argmax(np.where(clear, self.missed.max(axis=1), -1.0)))


def crosscheck(
    rules: Sequence[MoveRule],
    setup: Setup,
    posts: Sequence[PoseBox | None],
    samples: int,
    seed: int,
) -> CrossCheck:
    """Run a plan at the nominal and at random uncertainties.

    Parameters
    ----------
    rules, setup
        The plan and the task.
    posts
        Certified box after each move, as far as there is one.
    samples, seed
        How many runs, and the seed of their draws.

    Returns
    -------
    CrossCheck
        The runs, how they ended, and the simulator's own error.
    """
    draws = draw(setup, len(rules), samples, np.random.default_rng(seed))
    sampled = run(rules, setup, draws, record=RECORD)
    last = posts[-1] if len(posts) == len(rules) else None
    inside = None
    if last is not None:
        inside = sampled.completed & (excess(sampled.final, last) == 0.0).all(axis=1)
    return CrossCheck(
        seed=seed,
        draws=draws,
        nominal=run(rules, setup, nominal(setup, len(rules)), record=RECORD),
        sampled=sampled,
        missed=excess(sampled.final, setup.goal),
        in_box=inside,
        step_excess=tuple(
            _largest(excess(move.after[sampled.completed], post))
            for move, post in zip(sampled.moves, posts, strict=False)
            if post is not None
        ),
        error=_step_error(rules, setup, draws, sampled),
    )


def confirmed(rules: Sequence[MoveRule], setup: Setup, check: CrossCheck) -> bool:
    """Whether the worst failing run also fails at half the simulation step.

    Parameters
    ----------
    rules, setup, check
        The plan, the task, and what `crosscheck` found.

    Returns
    -------
    bool
        False as well if no run fails.
    """
    if check.failure is None:
        return False
    again = run(rules, setup, some(check.draws, np.array([check.failure])), step=0.5 * STEP)
    missed = excess(again.final, setup.goal)[0]
    if not again.completed[0]:
        return bool(again.outcomes[0] in REFUTING)
    return bool(_clear(missed, check.error).any())


def _clear(
    missed: npt.NDArray[np.float64], error: tuple[float, float, float]
) -> npt.NDArray[np.bool_]:
    return np.asarray(missed > CLEAR * np.array(error) + ROUNDING)


def _largest(values: npt.NDArray[np.float64]) -> tuple[float, float, float]:
    x, y, theta = np.max(values, axis=0, initial=0.0)
    return float(x), float(y), float(theta)


def _step_error(
    rules: Sequence[MoveRule], setup: Setup, draws: Draws, sampled: PlanRun
) -> tuple[float, float, float]:
    first = np.arange(min(COMPARED, len(draws.start)))
    finer = run(rules, setup, some(draws, first), step=0.5 * STEP)
    both = finer.completed & sampled.completed[first]
    changes = [
        np.abs(fine.after - coarse.after[first])[both]
        for fine, coarse in zip(finer.moves, sampled.moves, strict=True)
    ]
    return _largest(np.concatenate(changes))
