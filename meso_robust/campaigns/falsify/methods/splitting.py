"""Rare-event splitting: how likely a uniform draw scores above a limit that draws hardly reach.

Subset simulation (Au and Beck 2001, doi:10.1016/S0266-8920(01)00019-4): a small probability is a
product of larger ones, each the share of a population above a level that the population itself
sets; Markov chains within the level make the next population. The chains move standard normal
numbers, of which the uniform ones are the distribution function (Papaioannou et al. 2015,
doi:10.1016/j.probengmech.2015.06.006): their steps become shorter towards the ends of a range.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr

from meso_robust.campaigns.falsify.budgeted_search import Rare, Trail
from meso_robust.types import Floats

SPLIT = 0.1  # of a population goes on to the next level
LEVELS = 10  # that the budget pays for: probabilities down to SPLIT ** LEVELS
SHORTEST = 0.5  # step of a chain along a coordinate, in standard deviations; the longest is 1


def splitting(trail: Trail, rng: np.random.Generator) -> Rare:
    """Probability of a score above the problem's limit under uniform draws, as far as it is found.

    Levels descend from each other: the coefficients of variation of their shares are added, which
    is the upper bound of Au and Beck (levels fully correlated). Within a level the chains are taken
    as independent.
    """
    chains = max(int(SPLIT * trail.left / LEVELS), 2)
    length = round(1.0 / SPLIT)
    places = rng.standard_normal((length, chains, trail.size))
    values = trail.measure(ndtr(places).reshape(-1, trail.size)).reshape(length, chains)
    known, variation, level = 1.0, 0.0, -np.inf
    while True:
        above = values > trail.problem.limit
        bar = float(np.sort(values, axis=None)[-chains])
        # the last level, no budget for another, or a plateau that fills the population
        if above.mean() >= SPLIT or trail.left < values.size or bar <= level:
            break
        stays = values >= bar
        known, variation, level = known * float(stays.mean()), variation + _variation(stays), bar
        places, values = _chains(
            trail, places[stays][:chains], values[stays][:chains], level, length, rng
        )
    share = float(above.mean())
    return Rare(
        probability=known * share,
        variation=variation + (_variation(above) if share else 0.0),
        level=level,
        level_probability=known,
    )


def _variation(above: npt.NDArray[np.bool_]) -> float:
    """Coefficient of variation of a share, from (length, chains) flags.

    From the sums over each chain, so that correlation along a chain counts in full; of independent
    flags it is the binomial ``sqrt((1 - p) / (p n))`` on average.
    """
    p = above.mean()
    sums = (above - p).sum(axis=0)
    return float(np.sqrt((sums**2).sum()) / (p * above.size))


def _chains(
    trail: Trail,
    seeds: Floats,
    values: Floats,
    level: float,
    length: int,
    rng: np.random.Generator,
) -> tuple[Floats, Floats]:
    """(length, C, D) Markov chains from seeds (C, D) at or above the level, and their scores."""
    places, heights = [seeds], [values]
    for _ in range(length - 1):
        tried = _proposed(places[-1], rng)
        found = trail.measure(ndtr(tried))
        accepted = found >= level
        places.append(np.where(accepted[:, None], tried, places[-1]))
        heights.append(np.where(accepted, found, heights[-1]))
    return np.stack(places), np.stack(heights)


def _proposed(normal: Floats, rng: np.random.Generator) -> Floats:
    """(C, D) points moved along some coordinates, so that the normal distribution is kept.

    How many coordinates and how far is redrawn for every point, whatever it is: a mixture of
    kernels that each keep it.
    """
    some = rng.random((len(normal), 1))
    reach = SHORTEST ** rng.random((len(normal), 1))
    moves = rng.random(normal.shape) < np.maximum(some, 1.0 / normal.shape[1])
    moved = np.sqrt(1.0 - reach**2) * normal + reach * rng.standard_normal(normal.shape)
    return np.where(moves, moved, normal)
