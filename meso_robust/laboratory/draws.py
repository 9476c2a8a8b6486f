"""Draws of everything that is uncertain, one row a run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

import numpy as np

from meso_robust.bounds import Interval
from meso_robust.primitives.setup import Setup
from meso_robust.types import Floats, Ints

_Runs = TypeVar("_Runs", bound=Any)

LEGS = 2
"""Straight legs of a move whose probe wanders or whose friction changes: the least that can change."""
TIPS = 3
"""The tips, in the order of ``planning.document.NAMES``."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Draws:
    """What is uncertain, for N runs of M moves in L legs; SI units. None: as stated, exactly."""

    start: Floats
    """(N, 3) true pose at the start."""
    friction: Floats
    """(N,) of all tips, if they have no friction of their own."""
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
    tip_friction: Floats | None = None
    """(N, M, L, TIPS)"""
    spacing: Floats | None = None
    """(N,) true minus stated distance of the centres of the active tips."""
    radii: Floats | None = None
    """(N, TIPS)"""
    edges: Floats | None = None
    """(N, V, 2) how far out each edge lies, m, and by how much it is turned, rad."""
    drag_centre: Floats | None = None
    """(N, 2) from the reference point, part's axes; what is longer than its bound is cut to it. Where a task
    lets it move, a run still has it at one place: it is at every instant where it may be."""
    lay: Floats | None = None
    """(N, 3) drag along x over the mean, minus 1, and the shear over the mean, at orientation 0; and
    which share of both is fixed in the stage, the rest in the part. Cut to the bound as well."""
    direction: Floats | None = None
    """(N, M) rad, of the true travel from the commanded one."""
    scale: Floats | None = None
    """(N, M) true over commanded travel, minus 1."""
    wander: Floats | None = None
    """(N, M, L + 1, 2) of the active probe from its straight path, at the ends of the legs."""
    stated: Floats | None = None
    """(N, M, B, 2) error of each probe of moves that are stated, in place of `dual` and `single`."""

    def of_tips(self, k: int, tips: int) -> Floats:
        """(N, P, 2) errors of 2 or 3 tips in move ``k``: those of the active probe share one."""
        dual = self.dual[:, k]
        return np.stack([dual, dual, self.single[:, k]][:tips], axis=1)

    @property
    def legs(self) -> int:
        """Straight legs of every move."""
        if self.wander is not None:
            return self.wander.shape[2] - 1
        return 1 if self.tip_friction is None else self.tip_friction.shape[2]


def is_open(range_: Interval) -> bool:
    """Whether a quantity is uncertain at all.

    Parameters
    ----------
    range_
        What it may be.

    Returns
    -------
    bool
        False where it is one number.
    """
    return range_.hi > range_.lo


def nominal(setup: Setup, moves: int, runs: int = 1) -> Draws:
    """The run without errors.

    Parameters
    ----------
    setup, moves
        The task, and how many moves the plan has.
    runs
        How often it is repeated.

    Returns
    -------
    Draws
        Every error zero and every range at its middle.
    """
    u = setup.uncertainty

    def at(value: float, *shape: int) -> Floats:
        return np.full((runs, *shape), value)

    def maybe(range_: Interval, *shape: int) -> Floats | None:
        return at(range_.mid, *shape) if is_open(range_) else None

    each = is_open(u.friction) and not setup.friction_common
    legs = LEGS if each or is_open(u.probe_wander) else 1
    round_tips = max(u.tip_radius.hi, u.passive_tip_radius.hi) > 0.0
    middles = (u.tip_radius.mid, u.tip_radius.mid, u.passive_tip_radius.mid)
    made = is_open(u.size) or is_open(u.squareness)
    return Draws(
        start=np.tile(np.array(setup.start.mid), (runs, 1)),
        friction=at(u.friction.mid),
        film_ratio=at(u.film_ratio.mid),
        misalignment=at(u.misalignment.mid),
        sensing=at(0.0, moves, 3),
        dual=at(0.0, moves, 2),
        single=at(0.0, moves, 2),
        tip_friction=at(u.friction.mid, moves, legs, TIPS) if each else None,
        spacing=maybe(u.tip_spacing),
        radii=np.tile(middles, (runs, 1)) if round_tips else None,
        edges=at(0.0, len(setup.outline.corners), 2) if made else None,
        drag_centre=maybe(u.drag_centre, 2),
        lay=maybe(u.drag_anisotropy, 3),
        direction=maybe(u.travel_direction, moves),
        scale=maybe(u.travel_scale, moves),
        wander=maybe(u.probe_wander, moves, legs + 1, 2),
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
    drawn = replace(
        nominal(setup, moves, runs),
        start=start,
        friction=one(u.friction),
        film_ratio=one(u.film_ratio),
        misalignment=one(u.misalignment),
        sensing=sensing,
        dual=one(u.probe_position, moves, 2),
        single=one(u.probe_position, moves, 2),
    )
    for name, ends in RANGES.items():
        values = getattr(drawn, name)
        if values is not None:
            low, high = ends(setup)
            values[:] = spread(low, high, values.shape, rng)
    return drawn


def _ends(*ranges: Interval) -> tuple[Floats, Floats]:
    """Ends of the last axis of a field."""
    return np.array([r.lo for r in ranges]), np.array([r.hi for r in ranges])


_SHARE = Interval(0.0, 1.0)
RANGES: dict[str, Callable[[Setup], tuple[Floats, Floats]]] = {
    "tip_friction": lambda s: _ends(s.uncertainty.friction),
    "spacing": lambda s: _ends(s.uncertainty.tip_spacing),
    "radii": lambda s: _ends(
        s.uncertainty.tip_radius, s.uncertainty.tip_radius, s.uncertainty.passive_tip_radius
    ),
    "edges": lambda s: _ends(s.uncertainty.size, s.uncertainty.squareness),
    "drag_centre": lambda s: _ends(s.uncertainty.drag_centre),
    "lay": lambda s: _ends(s.uncertainty.drag_anisotropy, s.uncertainty.drag_anisotropy, _SHARE),
    "direction": lambda s: _ends(s.uncertainty.travel_direction),
    "scale": lambda s: _ends(s.uncertainty.travel_scale),
    "wander": lambda s: _ends(s.uncertainty.probe_wander),
}
"""Fields that may be exact, with the lower and upper ends of their last axis (or of all of it)."""


def some(values: _Runs, rows: Ints) -> _Runs:
    """Some of N runs.

    Parameters
    ----------
    values
        A dataclass all of whose fields are arrays with a row for each run, or None.
    rows
        Which.

    Returns
    -------
    Any
        Another of its kind.
    """
    given = {f.name: getattr(values, f.name) for f in fields(values)}
    return replace(values, **{name: a[rows] for name, a in given.items() if a is not None})
