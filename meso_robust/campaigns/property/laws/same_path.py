"""Moves that must take the part the same way: scaled drag, other units, mirrored."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from hypothesis import strategies as st

from meso_robust.campaigns.property.law import Breach, Cost, Property, Silence, Verdict
from meso_robust.campaigns.property.laws.convergence import apart
from meso_robust.campaigns.property.laws.moves import STEP, Move, moves, push_of
from meso_robust.simulator import Outcome, Push, simulate
from meso_robust.simulator.exact import exact
from meso_robust.types import Floats

SAMPLES = 8  # intervals of the path that are compared
ROUNDING = 1e-9
"""Of the part's radius, for a move that is completed. The roundings of a path add up to some 1e-14;
they may grow where a contact mode changes, and without bound where a grasp closes."""
MIRROR = np.array([1.0, -1.0, -1.0])
ENGINES: dict[str, Callable[[Push], tuple[Floats, int]]] = {
    "event-driven": lambda push: _path(exact(push, samples=SAMPLES)),
    "stepper": lambda push: _path(simulate(push, record=SAMPLES)),
}


@dataclass(frozen=True, slots=True)
class Changed:
    """A move, and the factor by which something of it is changed."""

    move: Move
    factor: float


@dataclass(frozen=True, slots=True)
class Twin:
    """A push that must go the same way as another one, and how to read its poses."""

    push: Push
    back: Floats
    """(3,) factors that turn its poses into those of the other."""
    exact: bool
    """Whether every rounding is the same, so that the path is to the last bit."""


def _path(found: object) -> tuple[Floats, int]:
    path, outcomes = found.path, found.outcomes  # type: ignore[attr-defined]
    return path[0], int(outcomes[0])


def _same(what: str, move: Move, twins: Mapping[str, Twin]) -> Verdict:
    """Compare the move with its twins, by both engines."""
    compared = False
    for engine, run in ENGINES.items():
        base = run(push_of(move))
        for name, twin in twins.items():
            other = run(twin.push)
            if not twin.exact and Outcome.COMPLETED not in (base[1], other[1]):
                continue  # where a grasp closes, the pose follows from roundings
            compared = True
            found = _differ(move.size, base, other, twin)
            if found:
                return Breach(what=f"{what}, {engine} engine", detail=f"{name}: {found}")
    return None if compared else Silence("the move ends early in both engines")


def _differ(size: float, base: tuple[Floats, int], other: tuple[Floats, int], twin: Twin) -> str:
    if base[1] != other[1]:
        return f"ends as {Outcome(base[1]).name}, the other as {Outcome(other[1]).name}"
    off = max(apart(a, b * twin.back, size) for a, b in zip(base[0], other[0], strict=True))
    small = 0.0 if twin.exact else ROUNDING * size
    return "" if off <= small else f"the paths are {off / size:.3g} radii apart"


# -- scaled drag ----------------------------------------------------------------------------------


def _scaled_drag(example: Changed) -> Verdict:
    twins = {
        f"drag times {factor!r}": Twin(push_of(example.move, factor), np.ones(3), exactly)
        for factor, exactly in ((4.0, True), (0.125, True), (example.factor, False))
    }
    return _same("scaled drag", example.move, twins)


# -- other units ----------------------------------------------------------------------------------


def in_units(move: Move, factor: float) -> Push:
    """All lengths times ``factor``, rho times its square, and other units of time."""
    passive = move.passive
    scaled = replace(
        move,
        half_length_um=move.half_length_um * factor,
        half_width_um=move.half_width_um * factor,
        gap_um=move.gap_um * factor,
        spacing_um=None if move.spacing_um is None else move.spacing_um * factor,
        travel_um=move.travel_um * factor,
        ratio_um2=move.ratio_um2 * factor**2,
        passive=None if passive is None else replace(passive, gap_um=passive.gap_um * factor),
    )
    push = push_of(scaled)
    return replace(push, step=STEP * factor, times=push.times * 4.0)


def _other_units(example: Changed) -> Verdict:
    twins = {
        f"lengths times {factor!r}": Twin(
            in_units(example.move, factor), np.array([1.0 / factor, 1.0 / factor, 1.0]), exactly
        )
        for factor, exactly in ((2.0, True), (0.25, True), (example.factor, False))
    }
    return _same("other units", example.move, twins)


# -- mirrored -------------------------------------------------------------------------------------


def mirrored(push: Push) -> Push:
    """The push seen in a mirror along the x axis."""
    return replace(push, poses=push.poses * MIRROR, waypoints=push.waypoints * MIRROR[:2])


def _mirrored(move: Move) -> Verdict:
    return _same("mirrored move", move, {"mirrored": Twin(mirrored(push_of(move)), MIRROR, False)})


TO_ROUNDING = "to 1e-9 of the part's radius if it is completed (roundings add up to some 1e-14)"

DRAG = Property(
    name="scaled-drag",
    statement="All of the film's drag times any factor: both engines take the part the same way.",
    agreement=f"exact for factors 4 and 1/8; for any other {TO_ROUNDING}",
    examples=st.builds(Changed, move=moves, factor=st.floats(1e-3, 1e3)),
    check=_scaled_drag,
    cost=Cost.MODERATE,
)
UNITS = Property(
    name="other-units-move",
    statement=(
        "All lengths times a factor, rho times its square and other units of time: both engines take "
        "the part the same way, times the factor."
    ),
    agreement=f"exact for factors 2 and 1/4; for any other {TO_ROUNDING}",
    examples=st.builds(Changed, move=moves, factor=st.floats(0.3, 30.0)),
    check=_other_units,
    cost=Cost.MODERATE,
)
MIRRORED = Property(
    name="mirrored-move",
    statement="A mirrored move: both engines take the part the mirrored way.",
    agreement=TO_ROUNDING,
    examples=moves,
    check=_mirrored,
    cost=Cost.MODERATE,
)
