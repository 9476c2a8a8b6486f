"""Running the moves of a plan as they are stated, whatever the part does."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from meso_robust import units
from meso_robust.laboratory.replay import Column, of_a_point, of_a_run
from meso_robust.laboratory.running import (
    STARTS_INSIDE,
    STEP,
    MoveRun,
    PlanRun,
    outline,
    starts_inside,
)
from meso_robust.planning.document import MoveDocument
from meso_robust.primitives.setup import Setup
from meso_robust.simulator import Outcome, Push, PushResult, simulate
from meso_robust.types import Floats

DUAL = ("dtp_top", "dtp_bottom")  # two tips of one probe: they share its error
CONSTANT = 6  # columns that hold for the whole run


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OpenLoop:
    """Moves whose commands do not depend on what is sensed."""

    moves: tuple[MoveDocument, ...]
    setup: Setup

    @property
    def kind(self) -> str:
        """How the plan is run."""
        return "open_loop"

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
        low = np.array([column.low for column in self.columns])
        high = np.array([column.high for column in self.columns])
        share = rng.random((runs, len(low)))
        corners = np.arange(runs) >= (runs + 1) // 2
        share[corners] = np.rint(share[corners])
        return np.clip(low + share * (high - low), low, high)

    def run(self, rows: Floats, *, record: int = 0, step: float = STEP) -> PlanRun:
        """Run the moves once for every row; the sensed poses of the result are the true ones."""
        poses = rows[:, :3].copy()
        outcomes = np.full(len(rows), Outcome.COMPLETED, dtype=np.int8)
        failed_in = np.full(len(rows), len(self.moves))
        done, at = [], CONSTANT
        for k, move in enumerate(self.moves):
            width = 2 * len(_bodies(move))
            errors = rows[:, at : at + width].reshape(len(rows), -1, 2)
            at += width
            tips, travel = _commands(move, errors, rows[:, 5])
            alive = outcomes == Outcome.COMPLETED
            inside = alive & starts_inside(tips, poses, self.setup)
            outcomes[inside], failed_in[inside] = STARTS_INSIDE, k
            alive &= ~inside
            one = _move(self.setup, rows, (poses, tips, travel), alive, outcomes, (record, step))
            failed_in[alive & (outcomes != Outcome.COMPLETED)] = k
            poses = one.after
            done.append(one)
        return PlanRun(moves=tuple(done), outcomes=outcomes, failed_in=failed_in)


def _bodies(move: MoveDocument) -> tuple[str, ...]:
    """Probes that have an error of their own, in order."""
    names = [probe.name for probe in move.probes]
    both = set(DUAL) <= set(names)
    return tuple(dict.fromkeys("dtp" if both and name in DUAL else name for name in names))


def _commands(move: MoveDocument, errors: Floats, misalignment: Floats) -> tuple[Floats, Floats]:
    """(N, P, 2) true tips at the start and their travel: as stated plus the probes' errors."""
    starts = {probe.name: np.array(probe.start_um) * units.UM for probe in move.probes}
    bodies = _bodies(move)
    ahead = np.zeros(2)
    if "dtp" in bodies and set(DUAL) <= set(starts):
        half = 0.5 * (starts[DUAL[0]] - starts[DUAL[1]])
        ahead = np.array([-half[1], half[0]])  # a positive angle turns the pair counter-clockwise
    turn = np.tan(misalignment)[:, None] * ahead
    tips, travel = [], []
    for probe in move.probes:
        shared = probe.name in DUAL and probe.name not in bodies
        body = bodies.index("dtp" if shared else probe.name)
        sign = 0.0 if not shared else 1.0 if probe.name == DUAL[0] else -1.0
        tips.append(starts[probe.name] + errors[:, body] + sign * turn)
        way = np.zeros(2) if probe.passive else np.array(move.travel_um) * units.UM
        travel.append(np.broadcast_to(way, (len(errors), 2)))
    return np.stack(tips, axis=1), np.stack(travel, axis=1)


def _move(
    setup: Setup,
    rows: Floats,
    geometry: tuple[Floats, Floats, Floats],
    alive: npt.NDArray[np.bool_],
    outcomes: npt.NDArray[np.int8],
    resolution: tuple[int, float],
) -> MoveRun:
    """One move of the runs that are still alive; writes their outcomes."""
    poses, tips, travel = geometry
    record, step = resolution
    after, path = poses.copy(), np.repeat(poses[:, None], record + 1, axis=1)
    modes = np.zeros((*path.shape[:2], tips.shape[1]), dtype=np.int8)
    if alive.any():
        result = _push(setup, rows[alive], (poses[alive], tips[alive], travel[alive]), record, step)
        after[alive], outcomes[alive] = result.poses, result.outcomes
        if record:
            path[alive], modes[alive] = result.path, result.modes
    return MoveRun(
        before=poses,
        sensed=poses,
        tips=tips,
        travel=travel,
        path=path,
        modes=modes,
        after=after,
    )


def _push(
    setup: Setup,
    rows: Floats,
    geometry: tuple[Floats, Floats, Floats],
    record: int,
    step: float,
) -> PushResult:
    """The only place that calls the simulator."""
    poses, tips, travel = geometry
    return simulate(
        Push.straight(
            vertices=outline(setup),
            poses=poses,
            tips=tips,
            travel=travel,
            friction=rows[:, 3],
            film_ratio=rows[:, 4],
            step=step,
        ),
        record=record,
    )
