"""Draws of everything that is uncertain, one row a run."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

import numpy as np

from meso_robust.bounds import Interval
from meso_robust.primitives.setup import Setup
from meso_robust.types import Floats, Ints

_Runs = TypeVar("_Runs", bound=Any)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Draws:
    """What is uncertain, for N runs of M moves; SI units."""

    start: Floats
    """(N, 3) true pose at the start."""
    friction: Floats
    """(N,)"""
    film_ratio: Floats
    """(N,)"""
    misalignment: Floats
    """(N,) rad; positive: the tip on the right, seen along the push, is ahead."""
    sensing: Floats
    """(N, M, 3) sensed minus true pose before each move. The pose sensed before the first move is
    the task's start, so the first error follows from the true start."""
    dual: Floats
    """(N, M, 2) error of the active probe during each move."""
    single: Floats
    """(N, M, 2) error of the passive probe."""

    def of_tips(self, k: int, tips: int) -> Floats:
        """(N, P, 2) errors of 2 or 3 tips in move ``k``: those of the active probe share one."""
        dual = self.dual[:, k]
        return np.stack([dual, dual, self.single[:, k]][:tips], axis=1)


def nominal(setup: Setup, moves: int) -> Draws:
    """The run without errors.

    Parameters
    ----------
    setup, moves
        The task, and how many moves the plan has.

    Returns
    -------
    Draws
        One run with every error zero and every range at its middle.
    """
    u = setup.uncertainty
    return Draws(
        start=np.array([setup.start.mid]),
        friction=np.array([u.friction.mid]),
        film_ratio=np.array([u.film_ratio.mid]),
        misalignment=np.array([u.misalignment.mid]),
        sensing=np.zeros((1, moves, 3)),
        dual=np.zeros((1, moves, 2)),
        single=np.zeros((1, moves, 2)),
    )


def at_shares(share: Floats, low: Floats, high: Floats) -> Floats:
    """Points of the unit cube as points of a box.

    Parameters
    ----------
    share
        (N, D) 0 to 1.
    low, high
        (D,) ends of the box.

    Returns
    -------
    Floats
        (N, D) exactly at an end where the share is 0 or 1.
    """
    # rounding could pass an end by a digit, or miss the upper one
    return np.where(share >= 1.0, high, np.clip(low + share * (high - low), low, high))


def spread(
    low: Floats | float, high: Floats | float, shape: tuple[int, ...], rng: np.random.Generator
) -> Floats:
    """(N, ...) numbers of N runs in a box: the first half uniform, the second half at its corners."""
    share = rng.random(shape)
    corners = np.arange(shape[0]) >= (shape[0] + 1) // 2
    share[corners] = np.rint(share[corners])
    # rounding could pass an end by a digit
    return np.clip(low + share * (high - low), low, high)


def draw(setup: Setup, moves: int, runs: int, rng: np.random.Generator) -> Draws:
    """Random runs.

    Parameters
    ----------
    setup, moves
        The task, and how many moves the plan has.
    runs
        How many.
    rng
        Source of the numbers.

    Returns
    -------
    Draws
        The first half uniform over the box, the second half at its corners: what fails first, fails at
        corners.
    """
    s, u = setup.start, setup.uncertainty

    def one(range_: Interval, *shape: int) -> Floats:
        return spread(range_.lo, range_.hi, (runs, *shape), rng)

    sensing = np.concatenate(
        [one(u.sensed_position, moves, 2), one(u.sensed_orientation, moves, 1)], axis=2
    )
    start = np.stack([one(s.x), one(s.y), one(s.theta)], axis=1)
    sensing[:, 0] = np.array(s.mid) - start
    return Draws(
        start=start,
        friction=one(u.friction),
        film_ratio=one(u.film_ratio),
        misalignment=one(u.misalignment),
        sensing=sensing,
        dual=one(u.probe_position, moves, 2),
        single=one(u.probe_position, moves, 2),
    )


def some(values: _Runs, rows: Ints) -> _Runs:
    """Some of N runs: of a dataclass all of whose fields are arrays with a row for each."""
    return replace(values, **{f.name: getattr(values, f.name)[rows] for f in fields(values)})
