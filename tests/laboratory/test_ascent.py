"""Raising a score: ends of the box and points inside of it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from meso_robust.laboratory.ascent import Effort, climb, corners, shaken

Floats = npt.NDArray[np.float64]


def test_climbing_finds_ends_and_interior_points() -> None:
    low, high = np.full(4, -1.0), np.full(4, 2.0)
    at = np.array([0.3, -0.7, 1.1, 2.0])
    rng = np.random.default_rng(0)
    pool = corners(low, high, 30, rng)

    def score(rows: Floats) -> Floats:
        own = rows - at
        return np.asarray(-np.sum(own**2, axis=1) - 0.9 * own[:, 0] * own[:, 1])

    found = climb(score, pool, score(pool), (low, high), rng, Effort(generations=40))

    assert found.value > -1e-3
    assert found.row[3] == 2.0
    assert found.evaluations > 100


def test_what_is_shaken_stays_in_the_box_and_near_its_seeds() -> None:
    rng = np.random.default_rng(3)
    low, high = np.array([-1.0, 0.0, 5.0]), np.array([1.0, 1e-9, 5.0])
    seeds = corners(low, high, 4, rng)

    rows = shaken(seeds, low, high, 500, rng)

    assert ((seeds == low) | (seeds == high)).all()
    assert ((rows >= low) & (rows <= high)).all()
    kept = (rows[:, None] == seeds[None]).sum(axis=2).max(axis=1)
    assert (kept == 3).any()
    assert ((rows > low) & (rows < high))[:, :2].any(axis=0).all()
