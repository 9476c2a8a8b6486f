"""Runs whose film changes on the way as well, as the promise allows it to at every instant."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Self

import numpy as np

from meso_robust.laboratory.draws import Draws, spread
from meso_robust.laboratory.engines import Pushed
from meso_robust.laboratory.making import film_of
from meso_robust.laboratory.running import Bench, Order, PlanRun, Which, by_rules, carry_out
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import Setup
from meso_robust.simulator import Outcome
from meso_robust.simulator.support_models import Film
from meso_robust.types import Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Changing(Draws):
    """Draws with a film of its own in each of L stretches of each move."""

    ratios: Floats
    """(N, M, L) e_theta/e_x, m^2."""
    lays: Floats
    """(N, M, L, 2) drag along x over the mean, minus 1, and the shear over the mean, in the part's axes;
    what is longer than its bound is cut to it."""

    @classmethod
    def of(cls, draws: Draws, setup: Setup, legs: int, rng: np.random.Generator) -> Self:
        """Some draws with such films."""
        u, shape = setup.uncertainty, (*draws.sensing.shape[:2], legs)
        given = {one.name: getattr(draws, one.name) for one in fields(Draws)}
        lay = u.drag_anisotropy
        return cls(
            **given,
            ratios=spread(u.film_ratio.lo, u.film_ratio.hi, shape, rng),
            lays=spread(lay.lo, lay.hi, (*shape, 2), rng),
        )

    def film(self, setup: Setup, k: int, leg: int) -> Film:
        """Of each run, in a stretch of move ``k``."""
        lay = None
        if self.lay is not None:  # nothing of it is fixed in the stage: it is any lay anyhow
            lay = np.column_stack([self.lays[:, k, leg], np.zeros(len(self.lays))])
        return film_of(setup, replace(self, film_ratio=self.ratios[:, k, leg], lay=lay))


class _Bench(Bench):
    """The task's laboratory, each move carried out stretch by stretch."""

    __slots__ = ()

    def push(
        self, k: int, order: Order, runs: Which, poses: Floats, ways: Floats, record: int
    ) -> Pushed:
        """A stretch begins in the pose in which the one before it ended."""
        draws, ended = self.draws, np.full(len(poses), Outcome.COMPLETED, np.int8)
        if not isinstance(draws, Changing) or draws.tip_friction is None:
            raise TypeError(
                f"draws: {type(draws).__name__}; must be Changing, with friction of tips"
            )
        for leg in range(ways.shape[1] - 1):
            own = replace(draws, tip_friction=draws.tip_friction[:, :, leg : leg + 1])
            film = draws.film(self.setup, k, leg)
            bench = Bench(
                setup=self.setup,
                draws=own,
                film=film,
                outlines=self.outlines,
                engine=self.engine,
            )
            pushed = bench.push(k, order, runs, poses, ways[:, leg : leg + 2], record)
            poses = pushed.poses
            ended = np.where(ended == Outcome.COMPLETED, pushed.outcomes, ended)
        return replace(pushed, outcomes=ended)


def run(rules: Sequence[MoveRule], setup: Setup, draws: Draws) -> PlanRun:
    """Run a plan once for every row of draws, from event to event.

    Parameters
    ----------
    rules, setup, draws
        The plan, the task, and what is uncertain; with `Changing`, each stretch on a film of its own.

    Returns
    -------
    PlanRun
        One `MoveRun` a rule.
    """
    kind = _Bench if isinstance(draws, Changing) else Bench
    bench = kind.of(setup, draws, engine="events")
    return carry_out(by_rules(rules, setup, draws), bench, draws.start)
