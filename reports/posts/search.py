"""Runs that go as far as runs can go: draws that are bred towards a goal."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np

from meso_robust.laboratory.draws import Draws, some
from meso_robust.types import Floats

Value = Callable[[Draws], Floats]
"""(N,) of N draws; minus infinity of a run that does not count."""
PARENTS = 40
FRESH = 0.1
"""Share of a child's numbers that no parent has."""


def largest(
    fresh: Callable[[int], Draws], value: Value, size: int, rounds: int, seed: int
) -> float:
    """The largest value that draws are found to have.

    Half of what is drawn afresh lies at corners of the box, and children take each number from one of
    two parents, so that what is largest at a corner is found there.

    Parameters
    ----------
    fresh
        So many new draws.
    value
        What is to be large.
    size, rounds
        Draws of a round, and rounds after the first.
    seed
        Of the choices.

    Returns
    -------
    float
        A lower bound of the truth.
    """
    rng = np.random.default_rng(seed)
    parents = fresh(size)
    values = value(parents)
    for _ in range(rounds):
        best = np.argsort(values)[::-1][:PARENTS]
        parents, values = some(parents, best), values[best]
        children = bred(parents, fresh(size), rng)
        parents, values = joined(parents, children), np.append(values, value(children))
    return float(values.max())


def bred(parents: Draws, fresh: Draws, rng: np.random.Generator) -> Draws:
    """As many children as ``fresh`` has rows, each of two parents and a little of a fresh row."""
    count = len(fresh.start)
    one, other = (some(parents, rng.integers(len(parents.start), size=count)) for _ in range(2))

    def mixed(a: Floats, b: Floats, new: Floats) -> Floats:
        child = np.where(rng.random(new.shape) < 0.5, a, b)
        return np.where(rng.random(new.shape) < FRESH, new, child)

    return _each(mixed, one, other, fresh)


def joined(one: Draws, other: Draws) -> Draws:
    """The rows of both."""
    return _each(lambda a, b: np.concatenate([a, b]), one, other)


def _each(of: Callable[..., Floats], *draws: Draws) -> Draws:
    given = {f.name: [getattr(one, f.name) for one in draws] for f in fields(draws[0])}
    changes = {name: of(*arrays) for name, arrays in given.items() if arrays[0] is not None}
    return replace(draws[-1], **changes)
