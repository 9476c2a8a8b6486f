"""Running the moves of a plan as they are stated, whatever the part does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from meso_robust import units
from meso_robust.laboratory.draws import Draws, nominal, spread
from meso_robust.laboratory.replay import (
    Column,
    Slot,
    draws_of,
    limits,
    of_a_point,
    slots_of_a_move,
    slots_of_a_run,
)
from meso_robust.laboratory.running import (
    STEP,
    Bench,
    Order,
    PlanRun,
    carry_out,
    spacing_of,
    tips_of,
)
from meso_robust.planning.document import NAMES, MoveDocument
from meso_robust.primitives.move import Commands
from meso_robust.primitives.setup import Setup
from meso_robust.types import Flags, Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OpenLoop:
    """Moves whose commands do not depend on what is sensed."""

    moves: tuple[MoveDocument, ...]
    setup: Setup

    @property
    def primitives(self) -> tuple[str, ...]:
        """Name of each move's primitive."""
        return tuple(move.primitive for move in self.moves)

    @property
    def probes(self) -> tuple[tuple[str, ...], ...]:
        """Names of each move's probes."""
        return tuple(tuple(probe.name for probe in move.probes) for move in self.moves)

    @property
    def slots(self) -> tuple[Slot, ...]:
        """What is constant during a run, and the position of every probe in every move."""
        legs, found = nominal(self.setup, 1).legs, list(slots_of_a_run(self.setup))
        error = self.setup.uncertainty.probe_position
        for k, names in enumerate(self.probes):
            for at, body in enumerate(_bodies(names)):
                found += of_a_point(f"move {k + 1} {body}", error, "stated", k, at)
            found += slots_of_a_move(self.setup, k, names, legs)
        return tuple(found)

    @property
    def columns(self) -> tuple[Column, ...]:
        """The same without where it is kept."""
        return tuple(slot.column for slot in self.slots)

    def draw(self, runs: int, rng: np.random.Generator) -> Floats:
        """(N, D) random rows: the first half uniform over the box, the second half at corners."""
        low, high = limits(self)
        return spread(low, high, (runs, len(low)), rng)

    def run(self, rows: Floats, *, record: int = 0, step: float = STEP) -> PlanRun:
        """Run the moves once for every row; the sensed poses of the result are the true ones."""
        moves, most = len(self.moves), max(len(_bodies(names)) for names in self.probes)
        errors = np.zeros((len(rows), moves, most, 2))
        none = replace(nominal(self.setup, moves, len(rows)), stated=errors)
        draws = draws_of(self.slots, rows, none)
        more = {"probes": self.probes, "errors": errors}
        bench = _StatedBench.of(self.setup, draws, step=step, **more)
        rounds = tuple(partial(_as_stated, move, self.setup, draws) for move in self.moves)
        return carry_out(rounds, bench, draws.start, record)


def _as_stated(
    move: MoveDocument, setup: Setup, draws: Draws, sensed: Floats, going: Flags
) -> tuple[Order, ...]:
    """The move whatever is sensed, with the pair of tips as it really is."""
    names = [probe.name for probe in move.probes]
    starts = np.array([probe.start_um for probe in move.probes]) * units.UM
    ways = [(0.0, 0.0) if probe.passive else move.travel_um for probe in move.probes]
    shape = (len(going), len(names), 2)
    tips = np.broadcast_to(starts, shape)
    if set(NAMES[:2]) <= set(names):
        top, bottom = (starts[names.index(name)] for name in NAMES[:2])
        half, apart = 0.5 * (top - bottom), spacing_of(setup, draws) / setup.stated_spacing.mid
        # a positive angle turns the pair counter-clockwise
        true = half + np.tan(draws.misalignment)[:, None] * np.array([-half[1], half[0]])
        off = apart[:, None] * true - half
        sign = np.array([{NAMES[0]: 1.0, NAMES[1]: -1.0}.get(name, 0.0) for name in names])
        tips = tips + sign[:, None] * off[:, None]
    travel = np.broadcast_to(np.array(ways) * units.UM, shape)
    commands = Commands(tips=tips, travel=travel)
    return (Order(runs=going, commands=commands, names=tips_of(names)),)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _StatedBench(Bench):
    """The task's laboratory where each probe of each move has an error of its own."""

    probes: tuple[tuple[str, ...], ...]
    errors: Floats
    """(N, M, B, 2) of the probes, m."""

    def sense(self, k: int, poses: Floats, going: Flags) -> Floats:
        """Nothing looks at what is sensed."""
        return poses

    def place(self, k: int, order: Order) -> Floats:
        """(N, P, 2) tips as stated plus the errors of their probes."""
        names = self.probes[k]
        own = _bodies(names)
        at = [own.index(name) if name in own else own.index("dtp") for name in names]
        return np.asarray(order.commands.tips + self.errors[:, k, at])


def _bodies(names: Sequence[str]) -> tuple[str, ...]:
    """Probes that have an error of their own, in order: two tips of one probe share theirs."""
    pair = set(NAMES[:2])
    return tuple(dict.fromkeys("dtp" if pair <= {*names} and n in pair else n for n in names))
