"""Random rows, executed in bulk."""

from __future__ import annotations

from typing import Literal

import numpy as np

from meso_robust.campaigns.falsify.section import Draw
from meso_robust.laboratory.ascent import shaken
from meso_robust.laboratory.draws import at_shares
from meso_robust.types import Floats

Spread = Literal["uniform", "corners", "mixed"]


def shares_of(how: Spread, shape: tuple[int, int], rng: np.random.Generator) -> Floats:
    """(N, D) points of the unit cube.

    ``mixed`` puts each coordinate at an end or within its range, with equal chances.
    """
    share = rng.random(shape)
    if how == "uniform":
        return share
    at_end = how == "corners" or rng.random(shape) < 0.5
    return np.where(at_end, np.rint(share), share)


def drawn(
    how: Draw, runs: int, box: tuple[Floats, Floats], seeds: Floats, rng: np.random.Generator
) -> Floats:
    """(N, D) rows; ``adversarial`` starts from ``seeds`` (S, D) and redraws some coordinates."""
    low, high = box
    if how == "adversarial":
        return shaken(np.clip(seeds, low, high), low, high, runs, rng)
    return at_shares(shares_of(how, (runs, len(low)), rng), low, high)
