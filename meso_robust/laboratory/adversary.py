"""Searching the uncertainties for the worst run: a search finds, it does not prove."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meso_robust.laboratory.ascent import corners, stepped
from meso_robust.laboratory.crosscheck import REFUTING
from meso_robust.laboratory.replay import Player, limits, miss
from meso_robust.simulator import Outcome
from meso_robust.types import Floats

CORNERS = 1024  # random corners of the box to begin with
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

    Parameters
    ----------
    player
        The plan.
    seeds
        (N, D) rows to start from.
    rng
        Source of the corners.

    Returns
    -------
    Worst
        The worst run met, as it is when run by itself. A search finds, it does not prove.

    Notes
    -----
    Starts from ``seeds`` and from random corners of the box, keeps the worst few, and goes along the
    coordinates, first from end to end and then in ever shorter steps; the better of the two ways along
    every coordinate is also taken for all coordinates at once. Ends early at a run that cannot be
    carried out, as nothing is worse.
    """
    low, high = limits(player)
    pool = np.concatenate([np.clip(seeds, low, high), corners(low, high, CORNERS, rng)])
    count = len(pool)
    pool, values, more = stepped(
        lambda rows: badness(player, rows), pool, badness(player, pool), (low, high)
    )
    count += more
    return _confirmed(player, pool, values, count)


def _confirmed(player: Player, pool: Floats, values: Floats, count: int) -> Worst:
    """The worst of the best candidates when each is run by itself.

    The steps of a batch depend on its longest travel, so a run by itself may differ in the last
    digits; what is reported is what anybody finds who repeats this one run.
    """
    rows = pool[np.argsort(-values, kind="stable")][:TRIES]
    alone = np.array([badness(player, row[None])[0] for row in rows])
    worst = int(np.argmax(alone))
    return Worst(row=rows[worst], value=float(alone[worst]), evaluations=count + len(rows))
