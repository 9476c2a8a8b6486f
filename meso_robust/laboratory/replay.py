"""A plan as something to be run: each run is a row of numbers, one for everything uncertain.

A plan with a policy is run as a feedback policy, one without as the moves it states. Both take the
same rows and give the same kind of result, so that sampling, searching and showing need not know
which is which.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from meso_robust.bounds import Interval
from meso_robust.laboratory.draws import Draws, draw
from meso_robust.laboratory.engines import Engine
from meso_robust.laboratory.running import STEP, PlanRun, run
from meso_robust.planning.document import names_of
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import Setup
from meso_robust.types import Floats

START, FRICTION, FILM, MISALIGNMENT = slice(3), 3, 4, 5
"""Columns of a row that hold for the whole run; see `of_a_run`."""
OF_A_RUN = 6
"""How many those are; what belongs to single moves comes after them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """Something uncertain."""

    name: str
    """Name with its SI unit, such as ``friction`` or ``move 2 dtp x_m``."""
    low: float
    high: float
    mid: float


class Player(Protocol):
    """A plan that can be run."""

    @property
    def setup(self) -> Setup:
        """The task."""

    @property
    def primitives(self) -> tuple[str, ...]:
        """Name of each move's primitive."""

    @property
    def probes(self) -> tuple[tuple[str, ...], ...]:
        """Names of each move's probes."""

    @property
    def columns(self) -> tuple[Column, ...]:
        """Everything uncertain, in the order of a row."""

    def draw(self, runs: int, rng: np.random.Generator) -> Floats:
        """(N, D) random rows: the first half uniform over the box, the second half at corners."""

    def run(self, rows: Floats, *, record: int = 0, step: float = STEP) -> PlanRun:
        """Run the plan once for every row; see ``laboratory.running.run``."""


def nominal_row(player: Player) -> Floats:
    """The run without errors as a row.

    Parameters
    ----------
    player
        The plan.

    Returns
    -------
    Floats
        (1, D) every error zero and every range at its middle.
    """
    return np.array([[column.mid for column in player.columns]])


def limits(player: Player) -> tuple[Floats, Floats]:
    """The box of everything uncertain.

    Parameters
    ----------
    player
        The plan.

    Returns
    -------
    tuple
        (D,) lower and (D,) upper ends, SI.
    """
    columns = player.columns
    return np.array([c.low for c in columns]), np.array([c.high for c in columns])


def column(name: str, range_: Interval) -> Column:
    """One number that lies in ``range_``."""
    return Column(name=name, low=range_.lo, high=range_.hi, mid=range_.mid)


def of_a_run(setup: Setup) -> tuple[Column, ...]:
    """What is constant during a run: the pose at the start, friction, film, misalignment."""
    s, u = setup.start, setup.uncertainty
    return (
        column("start x_m", s.x),
        column("start y_m", s.y),
        column("start theta_rad", s.theta),
        column("friction", u.friction),
        column("film_ratio_m2", u.film_ratio),
        column("misalignment_rad", u.misalignment),
    )


def of_a_point(name: str, range_: Interval) -> tuple[Column, Column]:
    """The error of a position."""
    return column(f"{name} x_m", range_), column(f"{name} y_m", range_)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Feedback:
    """A policy: before each move the pose is sensed, and the commands follow from it."""

    rules: tuple[MoveRule, ...]
    setup: Setup
    engine: Engine = "stepper"
    """Which engine of the simulator makes the moves."""

    @property
    def primitives(self) -> tuple[str, ...]:
        """Name of each move's primitive."""
        return tuple(rule.primitive for rule in self.rules)

    @property
    def probes(self) -> tuple[tuple[str, ...], ...]:
        """Names of each move's probes."""
        return tuple(map(names_of, self.rules))

    @property
    def columns(self) -> tuple[Column, ...]:
        """What bears on the runs; not the first sensing error, which follows from the start."""
        u, found = self.setup.uncertainty, list(of_a_run(self.setup))
        for k, rule in enumerate(self.rules):
            if k > 0:
                found += of_a_point(f"move {k + 1} sensing", u.sensed_position)
                found.append(column(f"move {k + 1} sensing theta_rad", u.sensed_orientation))
            found += of_a_point(f"move {k + 1} dtp", u.probe_position)
            if rule.single is not None:
                found += of_a_point(f"move {k + 1} stp", u.probe_position)
        return tuple(found)

    def draw(self, runs: int, rng: np.random.Generator) -> Floats:
        """(N, D) the rows of ``laboratory.draws.draw``, so that a seed means the same everywhere."""
        return self.rows_of(draw(self.setup, len(self.rules), runs, rng))

    def run(self, rows: Floats, *, record: int = 0, step: float = STEP) -> PlanRun:
        """Run the policy once for every row."""
        draws = self.draws_of(rows)
        return run(self.rules, self.setup, draws, record=record, step=step, engine=self.engine)

    def rows_of(self, draws: Draws) -> Floats:
        """(N, D) draws as rows, number for number."""
        of_a_run = (draws.start, draws.friction, draws.film_ratio, draws.misalignment)
        return np.column_stack([*of_a_run, *self._of_moves(draws)])

    def draws_of(self, rows: Floats) -> Draws:
        """Rows as draws; errors of a probe that is not there are zero."""
        runs, moves = len(rows), len(self.rules)
        draws = Draws(
            start=rows[:, START].copy(),
            friction=rows[:, FRICTION].copy(),
            film_ratio=rows[:, FILM].copy(),
            misalignment=rows[:, MISALIGNMENT].copy(),
            sensing=np.zeros((runs, moves, 3)),
            dual=np.zeros((runs, moves, 2)),
            single=np.zeros((runs, moves, 2)),
        )
        # the first pose is sensed as the task states it
        draws.sensing[:, 0] = np.array(self.setup.start.mid) - draws.start
        at = OF_A_RUN
        for target in self._of_moves(draws):
            target[:] = rows[:, at : at + target.shape[1]]
            at += target.shape[1]
        return draws

    def _of_moves(self, draws: Draws) -> Iterator[Floats]:
        """(N, 2) or (N, 3) views of what belongs to single moves, in the order of ``columns``."""
        for k, rule in enumerate(self.rules):
            if k > 0:
                yield draws.sensing[:, k]
            yield draws.dual[:, k]
            if rule.single is not None:
                yield draws.single[:, k]


def miss(runs: PlanRun, setup: Setup) -> Floats:
    """How far runs end from the middle of the goal.

    Parameters
    ----------
    runs, setup
        N runs, and their task.

    Returns
    -------
    Floats
        (N,) largest of the three coordinates' distances in tolerances; within 1 is a hit, and NaN is a
        run that ended early.
    """
    low, high = setup.goal.ends
    away = np.abs(runs.final - 0.5 * (low + high)) / (0.5 * (high - low))
    return np.where(runs.completed, away.max(axis=1), np.nan)
