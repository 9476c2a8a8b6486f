"""Steps along the coordinates and differential evolution, from random corners."""

from __future__ import annotations

import numpy as np

from meso_robust.campaigns.falsify.budgeted_search import Trail
from meso_robust.campaigns.falsify.draws import shares_of
from meso_robust.laboratory.ascent import Effort, climb

EFFORT = Effort(corners=1000)


def coordinate_climb(trail: Trail, rng: np.random.Generator) -> None:
    """Climbs from new corners until the budget is gone; see ``laboratory.ascent.climb``."""
    box = np.zeros(trail.size), np.ones(trail.size)
    while True:
        pool = shares_of("corners", (EFFORT.corners, trail.size), rng)
        climb(trail.score, pool, trail.score(pool), box, rng, EFFORT)
