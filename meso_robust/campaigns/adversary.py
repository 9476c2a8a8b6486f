"""Searching the uncertainties for the worst run: a search finds, it does not prove."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from meso_robust.campaigns.crosscheck import REFUTING
from meso_robust.campaigns.replay import Player, joined, limits, miss
from meso_robust.simulator import Outcome

Floats = npt.NDArray[np.float64]

CORNERS = 1024  # random corners of the box to begin with
ELITE = 6  # runs that are improved side by side
REACHES = (1.0, 1.0, 1.0, 0.5, 0.25, 0.1, 0.03, 0.01)  # of a step along a coordinate, of its range
TRIES = 6  # best candidates that are run again by themselves


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Worst:
    """The worst run that the search found."""

    row: Floats
    """(D,) what was uncertain, exactly."""
    value: float
    """Its miss in tolerances, run by itself; infinite if the plan could not be carried out."""
    evaluations: int
    """Runs that the search took."""


def badness(player: Player, rows: Floats) -> Floats:
    """(N,) how bad runs are: the miss in tolerances, infinite for a jam or a probe that cannot start.

    A run that the simulator itself could not finish says nothing of the plan: minus infinity.
    """
    runs = player.run(rows)
    known = np.where(np.isin(runs.outcomes, REFUTING), np.inf, -np.inf)
    return np.where(runs.outcomes == Outcome.COMPLETED, miss(runs, player.setup), known)


def search(player: Player, seeds: Floats, rng: np.random.Generator) -> Worst:
    """Look for the worst run in the box of everything uncertain.

    Starts from ``seeds`` and from random corners of the box, keeps the worst few, and goes along the
    coordinates, first from end to end and then in ever shorter steps; the better of the two ways
    along every coordinate is also taken for all coordinates at once. Ends early at a run that
    cannot be carried out.

    Parameters
    ----------
    player
        The plan.
    seeds
        (N, D) rows to start from.
    rng
        Source of the corners.
    """
    low, high = limits(player)
    corners = np.where(rng.random((CORNERS, len(low))) < 0.5, low, high)
    pool = joined([np.clip(seeds, low, high), corners])
    values = badness(player, pool)
    count = len(pool)
    for reach in REACHES:
        pool, values = _fittest(pool, values)
        if np.isposinf(values).any():
            break
        tried = joined([_around(row, reach, low, high) for row in pool])
        found = badness(player, tried)
        both = _combined(pool, values, tried, found)
        pool = joined([pool, tried, both])
        values = np.concatenate([values, found, badness(player, both)])
        count += len(tried) + len(both)
    return _confirmed(player, pool, values, count)


def _fittest(pool: Floats, values: Floats) -> tuple[Floats, Floats]:
    """The worst few, each once."""
    _, once = np.unique(pool, axis=0, return_index=True)
    best = once[np.argsort(-values[once], kind="stable")][:ELITE]
    return pool[best], values[best]


def _around(row: Floats, reach: float, low: Floats, high: Floats) -> Floats:
    """(2D, D) steps down, then up, along every coordinate, as far as the box goes."""
    way = np.diag(reach * (high - low))
    return np.clip(joined([row - way, row + way]), low, high)


def _combined(pool: Floats, values: Floats, tried: Floats, found: Floats) -> Floats:
    """(E, D) for each of the pool all steps at once that made it worse, each by itself."""
    many, size = pool.shape
    steps = tried.reshape(many, 2, size, size)
    gains = found.reshape(many, 2, size) - values[:, None, None]
    up = gains[:, 1] > gains[:, 0]
    own = np.arange(size)
    ends = np.where(up, steps[:, 1, own, own], steps[:, 0, own, own])
    return np.where(gains.max(axis=1) > 0.0, ends, pool)


def _confirmed(player: Player, pool: Floats, values: Floats, count: int) -> Worst:
    """The worst of the best candidates when each is run by itself.

    The steps of a batch depend on its longest travel, so a run by itself may differ in the last
    digits; what is reported is what anybody finds who repeats this one run.
    """
    rows = pool[np.argsort(-values, kind="stable")][:TRIES]
    alone = np.array([badness(player, row[None])[0] for row in rows])
    worst = int(np.argmax(alone))
    return Worst(row=rows[worst], value=float(alone[worst]), evaluations=count + len(rows))
