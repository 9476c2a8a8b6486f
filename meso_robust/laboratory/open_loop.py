"""Running the moves of a plan as they are stated, whatever the part does."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from meso_robust import units
from meso_robust.laboratory.draws import spread
from meso_robust.laboratory.replay import (
    FILM,
    FRICTION,
    MISALIGNMENT,
    OF_A_RUN,
    START,
    Column,
    limits,
    of_a_point,
    of_a_run,
)
from meso_robust.laboratory.running import STEP, Bench, Order, PlanRun, carry_out
from meso_robust.planning.document import MoveDocument
from meso_robust.primitives.move import Commands
from meso_robust.primitives.setup import Setup
from meso_robust.types import Flags, Floats

DUAL = ("dtp_top", "dtp_bottom")  # two tips of one probe: they share its error


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
    def columns(self) -> tuple[Column, ...]:
        """Start, friction, film, misalignment, and the position of every probe in every move."""
        error, found = self.setup.uncertainty.probe_position, list(of_a_run(self.setup))
        for k, move in enumerate(self.moves):
            for body in _bodies(move):
                found += of_a_point(f"move {k + 1} {body}", error)
        return tuple(found)

    def draw(self, runs: int, rng: np.random.Generator) -> Floats:
        """(N, D) random rows: the first half uniform over the box, the second half at corners."""
        low, high = limits(self)
        return spread(low, high, (runs, len(low)), rng)

    def run(self, rows: Floats, *, record: int = 0, step: float = STEP) -> PlanRun:
        """Run the moves once for every row; the sensed poses of the result are the true ones."""
        bench = _StatedBench(
            setup=self.setup, friction=rows[:, FRICTION], film_ratio=rows[:, FILM], step=step,
            moves=self.moves, rows=rows,
        )  # fmt: skip
        rounds = tuple(partial(_as_stated, move) for move in self.moves)
        return carry_out(rounds, bench, rows[:, START], record)


def _as_stated(move: MoveDocument, sensed: Floats, going: Flags) -> tuple[Order, ...]:
    """The move whatever is sensed."""
    shape = (len(going), len(move.probes), 2)
    starts = np.array([probe.start_um for probe in move.probes]) * units.UM
    ways = [(0.0, 0.0) if probe.passive else move.travel_um for probe in move.probes]
    commands = Commands(
        tips=np.broadcast_to(starts, shape),
        travel=np.broadcast_to(np.array(ways) * units.UM, shape),
    )
    return (Order(runs=going, commands=commands),)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _StatedBench(Bench):
    """The task's laboratory where each probe of each move has an error of its own."""

    moves: tuple[MoveDocument, ...]
    rows: Floats

    def sense(self, k: int, poses: Floats, going: Flags) -> Floats:
        """Nothing looks at what is sensed."""
        return poses

    def place(self, k: int, order: Order) -> Floats:
        """(N, P, 2) tips as stated plus the errors, and the pair turned by its misalignment."""
        move, at = self.moves[k], OF_A_RUN + 2 * sum(map(len, map(_bodies, self.moves[:k])))
        names, bodies = [probe.name for probe in move.probes], _bodies(move)
        errors = self.rows[:, at : at + 2 * len(bodies)].reshape(len(self.rows), -1, 2)
        pair = "dtp" in bodies and set(DUAL) <= set(names)
        at_body = [bodies.index("dtp" if pair and name in DUAL else name) for name in names]
        tips = order.commands.tips + errors[:, at_body]
        if not pair:
            return tips
        upper, lower = (order.commands.tips[0, names.index(name)] for name in DUAL)
        half = 0.5 * (upper - lower)
        # a positive angle turns the pair counter-clockwise
        turn = np.tan(self.rows[:, MISALIGNMENT])[:, None] * np.array([-half[1], half[0]])
        signs = dict(zip(DUAL, (1.0, -1.0), strict=True))
        sign = np.array([signs.get(name, 0.0) for name in names])
        return np.asarray(tips + sign[:, None] * turn[:, None])


def _bodies(move: MoveDocument) -> tuple[str, ...]:
    """Probes that have an error of their own, in order."""
    names = [probe.name for probe in move.probes]
    both = set(DUAL) <= set(names)
    return tuple(dict.fromkeys("dtp" if both and name in DUAL else name for name in names))
