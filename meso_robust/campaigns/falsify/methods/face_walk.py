"""Walks on faces of the box, of any dimension: some coordinates at an end, the others inside."""

from __future__ import annotations

import numpy as np

from meso_robust.campaigns.falsify.budgeted_search import Trail
from meso_robust.types import Flags, Floats

WALKS = 4  # side by side
TRIES = 32  # of each walk in a step
PATIENCE = 12  # steps in which a walk may stay where it is
SHORTEST = 1e-4  # step within a face, of the width of the box


def face_walk(trail: Trail, rng: np.random.Generator) -> None:
    """Walks from random points of random faces, again and again until the budget is gone.

    In each step half of the tries move inside of the face that the walk is on, the others also leave
    it: coordinates are put to an end and held there, or let go. The highest is taken if it is
    higher, and its face with it.
    """
    while True:
        held = rng.random((WALKS, trail.size)) < rng.random((WALKS, 1))
        inside = rng.random((WALKS, trail.size))
        shares = np.where(held, np.rint(inside), inside)
        values, idle = trail.score(shares), 0
        while idle < PATIENCE:
            tried, faces = _tries(shares, held, rng)
            found = trail.score(tried.reshape(-1, trail.size)).reshape(WALKS, TRIES)
            best, own = found.argmax(axis=1), np.arange(WALKS)
            higher = found[own, best] > values
            shares = np.where(higher[:, None], tried[own, best], shares)
            held = np.where(higher[:, None], faces[own, best], held)
            values = np.where(higher, found[own, best], values)
            idle = 0 if higher.any() else idle + 1


def _tries(shares: Floats, held: Flags, rng: np.random.Generator) -> tuple[Floats, Flags]:
    """(W, TRIES, D) points near those of W walks, and which of their coordinates are held."""
    shape = (len(shares), TRIES, shares.shape[1])
    faces = np.broadcast_to(held[:, None], shape)
    toggled = rng.random(shape) < rng.choice([1.5, 4.0], size=(*shape[:2], 1)) / shape[2]
    toggled[:, ::2] = False
    ends = np.rint(rng.random(shape))
    # to an end if it was free; if it was held, free or at the other end
    freed = toggled & faces & (rng.random(shape) < 0.5)
    faces = (faces | toggled) & ~freed
    reach = SHORTEST ** rng.random((*shape[:2], 1))
    which = rng.random(shape) < rng.choice([2.0 / shape[2], 0.3, 1.0], size=(*shape[:2], 1))
    step = np.where(which, reach * rng.uniform(-1.0, 1.0, shape), 0.0)
    moved = np.clip(np.where(freed, rng.random(shape), shares[:, None] + step), 0.0, 1.0)
    kept = np.broadcast_to(shares[:, None], shape)
    return np.where(faces, np.where(toggled, ends, kept), moved), faces
