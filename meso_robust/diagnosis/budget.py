"""The explainable error as a budget: shares by effect, stage, phase and component that add up."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from math import factorial

import numpy as np

from meso_robust.diagnosis.candidates import Candidate
from meso_robust.diagnosis.document import Channel
from meso_robust.diagnosis.folds import Bench
from meso_robust.diagnosis.judge import Judge, Names
from meso_robust.diagnosis.windows import cuts_of
from meso_robust.recordings import RecordingSet
from meso_robust.simulator.catalogue import stage_of
from meso_robust.types import Floats, Ints

_PHASES = ("approach", "one_point", "two_point", "retract", "rest")
_COMPONENTS = ("x", "y", "theta")


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """Part of the explainable error, as a share of it; the shares of all cells add up to one.

    Attributes
    ----------
    effect
        That explains it; empty for what nothing explains.
    stage
        Of the effect, or the one whose hidden input helps most.
    phase, component
        Of the motion.
    share
        May be slightly negative, where an effect makes it worse.
    """

    effect: str
    stage: str
    phase: str
    component: str
    share: float


def phases(recordings: RecordingSet, bench: Bench) -> Ints:
    """(R, T) index into the phases; a frame of no window belongs to the one before it."""
    codes = np.full(bench.still.shape, -1)
    for cut in cuts_of(recordings, bench.prepared):
        codes[cut.recording, cut.first : cut.last] = _PHASES.index(cut.phase)
    codes[:, 0] = np.maximum(codes[:, 0], 0)
    frames = np.arange(len(codes[0]))
    last = np.maximum.accumulate(np.where(codes >= 0, frames, 0), axis=1)
    return np.asarray(np.take_along_axis(codes, last, axis=1))


def shapley(
    judge: Judge, chosen: Candidate | None, phases: Ints
) -> tuple[dict[str, float], dict[str, Floats]]:
    """Shares of the effects, and shares (P, 3) by phase and component of them and of the rest ("").

    An effect's share is its mean fall of the error over all orders in which effects may be added, so
    that the shares add up, whatever they overlap.
    """
    effects = chosen.effects if chosen else ()
    whole, count = judge.explainable, len(effects)
    parts = [part for n in range(count) for part in itertools.combinations(effects, n)]
    for part in parts:
        if chosen is not None:
            judge.with_part(chosen, part)
    tables = {part: _table(judge.seen[part].squares, phases) for part in (*parts, effects)}
    each: dict[str, Floats] = {}
    for effect in effects:
        others = [part for part in parts if effect not in part]
        each[effect] = (
            sum(
                (
                    factorial(len(part))
                    * factorial(count - len(part) - 1)
                    / factorial(count)
                    * (tables[part] - tables[tuple(sorted((*part, effect)))])
                    for part in others
                ),
                np.zeros((len(_PHASES), 3)),
            )
            / whole
        )
    counts = judge.bench.seen.sum(axis=(1, 2))
    spread = np.broadcast_to((judge.floor / counts)[:, None, None], judge.bench.seen.shape)
    each[""] = (tables[effects] - _table(np.where(judge.bench.seen, spread, 0.0), phases)) / whole
    return {effect: float(each[effect].sum()) for effect in effects}, each


def _table(squares: Floats, phases: Ints) -> Floats:
    """(P, 3) sums of squares (R, T, 3) by phase and component."""
    return np.stack([squares[phases == code].sum(axis=0) for code in range(len(_PHASES))])


def budget(
    tables: Mapping[str, Floats], effects: Names, unnamed: Channel | None
) -> tuple[Cell, ...]:
    """All cells of the tables of `shapley`, what no effect explains at the stage ``unnamed``."""
    return tuple(
        Cell(
            effect=effect,
            stage=stage_of(effect).name if effect else (unnamed or ""),
            phase=phase,
            component=component,
            share=float(table[k, axis]),
        )
        for effect, table in tables.items()
        for k, phase in enumerate(_PHASES)
        for axis, component in enumerate(_COMPONENTS)
        if table[k, axis] != 0.0
    )
