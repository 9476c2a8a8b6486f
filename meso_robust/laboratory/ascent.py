"""Raising a score over a box of rows: corners, steps along the coordinates, evolution."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from meso_robust.types import Floats

Score = Callable[[Floats], Floats]
"""(N, D) rows to (N,) scores; minus infinity for a row that says nothing."""

ELITE = 6  # rows that are improved side by side
REACHES = (1.0, 1.0, 1.0, 0.5, 0.25, 0.1, 0.03, 0.01)  # of a step along a coordinate, of its range
CROSSING, PUSH = 0.8, 0.7  # evolution: share of coordinates taken over, and factor of differences


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Summit:
    """Where a climb ended."""

    row: Floats
    """(D,)"""
    value: float
    evaluations: int


def fittest(pool: Floats, values: Floats, count: int) -> tuple[Floats, Floats]:
    """The best few rows, each once, best first, and their values."""
    _, once = np.unique(pool, axis=0, return_index=True)
    best = once[np.argsort(-values[once], kind="stable")][:count]
    return pool[best], values[best]


def around(row: Floats, reach: float, low: Floats, high: Floats) -> Floats:
    """(2D, D) steps down, then up, along every coordinate, as far as the box goes."""
    way = np.diag(reach * (high - low))
    return np.clip(np.concatenate([row - way, row + way]), low, high)


def combined(pool: Floats, values: Floats, tried: Floats, found: Floats) -> Floats:
    """(E, D) for each of the pool all steps at once that raised it, each by itself."""
    many, size = pool.shape
    steps = tried.reshape(many, 2, size, size)
    with np.errstate(invalid="ignore"):  # of two rows that say nothing
        gains = np.nan_to_num(found.reshape(many, 2, size) - values[:, None, None], nan=0.0)
    up = gains[:, 1] > gains[:, 0]
    own = np.arange(size)
    ends = np.where(up, steps[:, 1, own, own], steps[:, 0, own, own])
    return np.where(gains.max(axis=1) > 0.0, ends, pool)


def stepped(
    score: Score,
    pool: Floats,
    values: Floats,
    box: tuple[Floats, Floats],
    reaches: tuple[float, ...] = REACHES,
    elite: int = ELITE,
) -> tuple[Floats, Floats, int]:
    """Go along the coordinates, first from end to end of the box and then in ever shorter steps.

    The better of the two ways along every coordinate is also taken for all coordinates at once.
    Ends early at an infinite score.

    Returns
    -------
    tuple
        All rows of the last round with their scores, and the number of evaluations.
    """
    low, high = box
    count = 0
    for reach in reaches:
        pool, values = fittest(pool, values, elite)
        if np.isposinf(values).any():
            break
        tried = np.concatenate([around(row, reach, low, high) for row in pool])
        found = score(tried)
        both = combined(pool, values, tried, found)
        pool = np.concatenate([pool, tried, both])
        values = np.concatenate([values, found, score(both)])
        count += len(tried) + len(both)
    return pool, values, count


def evolved(
    score: Score,
    pool: Floats,
    values: Floats,
    box: tuple[Floats, Floats],
    rng: np.random.Generator,
    generations: int,
) -> tuple[Floats, Floats, int]:
    """Differential evolution (rand-to-best, Storn and Price 1997, doi:10.1023/A:1008202821328).

    Finds scores that are best inside of the box, where steps along one coordinate do not lead.
    """
    low, high = box
    many, size = pool.shape
    for _ in range(generations):
        best = pool[np.argmax(values)]
        one, two = pool[rng.permutation(many)], pool[rng.permutation(many)]
        mutants = np.clip(pool + PUSH * (best - pool) + PUSH * (one - two), low, high)
        mutants = np.where(rng.random((many, size)) < CROSSING, mutants, pool)
        found = score(mutants)
        better = found > values
        pool = np.where(better[:, None], mutants, pool)
        values = np.where(better, found, values)
    return pool, values, generations * many


@dataclass(frozen=True, slots=True, kw_only=True)
class Effort:
    """How hard a climb is tried."""

    corners: int = 4000
    """Random corners of the box to begin with."""
    reaches: tuple[float, ...] = REACHES
    """Of the steps along the coordinates."""
    elite: int = ELITE
    """Rows that are improved side by side."""
    generations: int = 12
    """Of the evolution after them; 0 leaves it out."""


def climb(
    score: Score,
    pool: Floats,
    values: Floats,
    box: tuple[Floats, Floats],
    rng: np.random.Generator,
    effort: Effort,
) -> Summit:
    """Climb from a pool: coordinate steps, then evolution, then steps again.

    Parameters
    ----------
    score
        What is raised.
    pool, values
        (N, D) rows to start from, and their scores (N,).
    box
        (D,) lower and (D,) upper ends.
    rng
        Source of the evolution's randomness.
    effort
        How hard it is tried.

    Returns
    -------
    Summit
        The highest row found.
    """
    many = 4 * pool.shape[1]
    rows, heights, count = stepped(score, pool, values, box, effort.reaches, effort.elite)
    if effort.generations:
        both = np.concatenate([rows, pool]), np.concatenate([heights, values])
        start = fittest(*both, many)
        rows, heights, more = evolved(score, *start, box, rng, effort.generations)
        rows, heights, most = stepped(score, rows, heights, box, (1.0, 0.1, 0.01), effort.elite)
        count += more + most
    best = int(np.argmax(heights))
    return Summit(row=rows[best], value=float(heights[best]), evaluations=count)


def corners(low: Floats, high: Floats, count: int, rng: np.random.Generator) -> Floats:
    """Random corners of a box.

    Parameters
    ----------
    low, high
        (D,) ends of the box.
    count
        How many.
    rng
        Their source.

    Returns
    -------
    Floats
        (count, D)
    """
    return np.where(rng.random((count, len(low))) < 0.5, low, high)


def shaken(
    seeds: Floats, low: Floats, high: Floats, count: int, rng: np.random.Generator
) -> Floats:
    """Rows near hard ones: some coordinates redrawn, at an end of their range or within it.

    Parameters
    ----------
    seeds
        (S, D) hard rows.
    low, high
        (D,) ends of the box.
    count
        How many.
    rng
        Their source.

    Returns
    -------
    Floats
        (count, D); of each row 5 %, 20 % or half of the coordinates are redrawn on average.
    """
    rows = seeds[rng.integers(len(seeds), size=count)]
    share = rng.random(rows.shape)
    share = np.where(rng.random(rows.shape) < 0.5, np.rint(share), share)
    again = rng.random(rows.shape) < rng.choice([0.05, 0.2, 0.5], size=(count, 1))
    return np.where(again, np.clip(low + share * (high - low), low, high), rows)
