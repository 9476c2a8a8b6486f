"""Covariance matrix adaptation: searches inside of the box and on its faces at once.

Hansen, "The CMA Evolution Strategy: A Tutorial" (2016, arXiv:1604.00772), by the package ``cma``,
bounds by its smooth transformation of the box.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from meso_robust.campaigns.falsify.budgeted_search import Trail
from meso_robust.campaigns.falsify.draws import shares_of
from meso_robust.types import Floats

POPULATION = 64  # rows of a generation, run in bulk
SPREAD = 0.3  # standard deviation at the start, of the width of the box
SAYS_NOTHING = 1e30  # loss of a row that says nothing: finite, or the package would complain
SNAPS = (1e-6, 1e-3, 0.03, 0.15, 0.5)  # distances from an end that are closed; 0.5: a corner


def cma_es(trail: Trail, rng: np.random.Generator) -> None:
    """Runs of the evolution strategy, each from the best of a draw, until the budget is gone."""
    while True:
        pool = shares_of("mixed", (POPULATION, trail.size), rng)
        start = pool[int(np.argmax(trail.score(pool)))]
        _evolve(trail, start, rng)


def _evolve(trail: Trail, start: Floats, rng: np.random.Generator) -> None:
    """One run of the strategy; the ends that its best point is near are tried beside it."""
    strategy = _strategy(start, rng)
    best, height = start, -np.inf
    while not strategy.stop():
        asked = strategy.ask()
        shares = np.clip(np.array(asked), 0.0, 1.0)
        values = trail.score(np.concatenate([shares, _snapped(best)]))[: len(shares)]
        strategy.tell(asked, np.where(np.isneginf(values), SAYS_NOTHING, -values).tolist())
        top = int(np.argmax(values))
        if values[top] > height:
            best, height = shares[top], float(values[top])


def _strategy(start: Floats, rng: np.random.Generator) -> Any:
    """Silent, without files, and with no other source of random numbers than ``rng``."""
    import cma

    return cma.CMAEvolutionStrategy(
        start,
        SPREAD,
        {
            "bounds": [0.0, 1.0],
            "BoundaryHandler": cma.BoundTransform,
            "popsize": POPULATION,
            "seed": float("nan"),
            "randn": lambda *shape: rng.standard_normal(shape),
            "verbose": -9,
            "verb_disp": -9,
            "verb_log": 0,
            "signals_filename": "",
        },
    )


def _snapped(share: Floats) -> Floats:
    """(S, D) the point with all coordinates near an end put there, for each distance of SNAPS."""
    ends = np.rint(share)
    return np.array([np.where(np.abs(share - ends) <= near, ends, share) for near in SNAPS])
