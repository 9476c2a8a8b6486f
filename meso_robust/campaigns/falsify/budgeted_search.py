"""A search for the highest score over a box, within a budget."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from meso_robust.laboratory.ascent import Score, Summit
from meso_robust.laboratory.draws import at_shares
from meso_robust.types import Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Problem:
    """A score to be raised over a box of D numbers."""

    score: Score
    low: Floats
    """(D,)"""
    high: Floats
    """(D,)"""
    limit: float
    """Score above which something is broken."""

    def rows(self, shares: Floats) -> Floats:
        """(N, D) points of the unit cube as points of the box, ends to ends."""
        return at_shares(shares, self.low, self.high)

    def shares(self, rows: Floats) -> Floats:
        """(N, D) points of the box as points of the unit cube, ends to ends."""
        width = np.where(self.high > self.low, self.high - self.low, 1.0)
        return np.where(rows >= self.high, 1.0, np.clip((rows - self.low) / width, 0.0, 1.0))


class SpentError(Exception):
    """There is nothing more to evaluate: the budget is gone, or nothing can be higher."""


class Trail:
    """Everything a search evaluates goes through here: counted, and the highest kept."""

    def __init__(self, problem: Problem, budget: int) -> None:
        self.problem = problem
        self.left = budget
        self.evaluations = 0
        self.value = -np.inf
        self._row = 0.5 * (problem.low + problem.high)

    @property
    def size(self) -> int:
        """Dimension of the box."""
        return len(self.problem.low)

    @property
    def summit(self) -> Summit:
        """The highest so far; the middle of the box if nothing said anything."""
        return Summit(row=self._row, value=self.value, evaluations=self.evaluations)

    def measure(self, shares: Floats) -> Floats:
        """(N,) scores of points (N, D) of the unit cube.

        Raises
        ------
        SpentError
            The budget ends within these points; as many as it has room for are evaluated.
        """
        rows = self.problem.rows(shares[: self.left])
        if not len(rows):
            raise SpentError
        values = self.problem.score(rows)
        self.left -= len(rows)
        self.evaluations += len(rows)
        best = int(np.argmax(values))
        if values[best] > self.value:
            self.value, self._row = float(values[best]), rows[best]
        if len(rows) < len(shares):
            raise SpentError
        return values

    def score(self, shares: Floats) -> Floats:
        """(N,) the same for a search that has no more to do once a score is infinite.

        Raises
        ------
        SpentError
            Also if a score is infinite.
        """
        values = self.measure(shares)
        if np.isposinf(self.value):
            raise SpentError
        return values


@dataclass(frozen=True, slots=True, kw_only=True)
class Rare:
    """How likely a uniform draw scores high."""

    probability: float
    """That the score is above the problem's limit; 0 if no such point was met."""
    variation: float
    """Coefficient of variation of ``probability``; of ``level_probability`` if it is 0."""
    level: float
    """Highest level whose probability was reached."""
    level_probability: float
    """That the score is at least ``level``."""


Method = Callable[[Trail, np.random.Generator], Rare | None]
"""A way to search: raises the trail's score until it is :class:`SpentError`, or ends by itself."""


def search(
    method: Method, problem: Problem, rng: np.random.Generator, budget: int
) -> tuple[Summit, Rare | None]:
    """The highest point that a method finds with so many evaluations, and what else it tells."""
    trail, rare = Trail(problem, budget), None
    with suppress(SpentError):
        rare = method(trail, rng)
    return trail.summit, rare
