"""Walks from corner to corner of the box, along edges."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import numpy.typing as npt

from meso_robust.campaigns.falsify.budgeted_search import Trail
from meso_robust.campaigns.falsify.draws import shares_of
from meso_robust.types import Floats

WALKS = 8  # side by side, so that a batch is large


def corner_walk(trail: Trail, rng: np.random.Generator) -> None:
    """Walks from random corners, again and again until the budget is gone.

    Each step tries to flip every coordinate, takes the best flip, or all that help at once if that
    is better still. The best of the walks continues with pairs of flips.
    """
    while True:
        corners = shares_of("corners", (WALKS, trail.size), rng)
        corners, values = _uphill(trail, corners, trail.score(corners))
        best = int(np.argmax(values))
        _by_pairs(trail, corners[best : best + 1], values[best : best + 1])


def _by_pairs(trail: Trail, corner: Floats, value: Floats) -> None:
    pairs = np.zeros((trail.size * (trail.size - 1) // 2, trail.size), dtype=bool)
    for which, (i, j) in zip(pairs, combinations(range(trail.size), 2), strict=True):
        which[[i, j]] = True
    while True:
        tried = _flipped(corner, pairs)
        found = trail.score(tried)
        best = int(np.argmax(found))
        if not found[best] > value[0]:
            return
        corner, value = _uphill(trail, tried[best : best + 1], found[best : best + 1])


def _uphill(trail: Trail, corners: Floats, values: Floats) -> tuple[Floats, Floats]:
    """(W, D) corners from which no single flip leads higher, and their values."""
    walks, size = corners.shape
    single = np.eye(size, dtype=bool)
    while True:
        tried = np.stack([_flipped(corner[None], single) for corner in corners])
        found = trail.score(tried.reshape(-1, size)).reshape(walks, size)
        together = _flipped(corners, found > values[:, None])
        best = found.argmax(axis=1)
        own = np.arange(walks)
        pool = np.stack([corners, tried[own, best], together])
        heights = np.stack([values, found[own, best], trail.score(together)])
        top = heights.argmax(axis=0)
        if not top.any():
            return corners, values
        corners, values = pool[top, own], heights[top, own]


def _flipped(corners: Floats, which: npt.NDArray[np.bool_]) -> Floats:
    return np.where(which, 1.0 - corners, corners)
