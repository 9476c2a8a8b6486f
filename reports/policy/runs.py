"""Runs of a policy in the simulator, from starts all over its region: evidence beside the proof."""

from __future__ import annotations

import copy
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from meso_robust import units
from meso_robust.laboratory.draws import Draws, draw, spread
from meso_robust.laboratory.running import (
    Bench,
    Order,
    PlanRun,
    carry_out,
    excess,
    spacing_of,
    tips_of,
    why,
)
from meso_robust.planning.document import names_of
from meso_robust.policy.cells import Policy
from meso_robust.policy.controller import Done, Move, PolicyController
from meso_robust.policy.cover import ends_of
from meso_robust.policy.pose import Sensed
from meso_robust.primitives.move import Commands
from meso_robust.primitives.setup import PoseBox, Setup, setup_of
from meso_robust.types import Flags, Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PolicyRuns:
    """Outcomes of N runs."""

    moves: npt.NDArray[np.int64]
    """(N,) moves that each run took."""
    done: npt.NDArray[np.bool_]
    """(N,) whether the policy said that the part is in the goal."""
    in_goal: npt.NDArray[np.bool_]
    """(N,) whether the true pose was, then."""
    promised: npt.NDArray[np.int64]
    """(N,) bound of the moves of the cell that a run started in."""
    excess: Floats
    """(3,) largest distance outside of what a move was answered to end in (m, m, rad)."""
    why: tuple[str, ...]
    """Why runs ended that were not done."""

    @property
    def kept(self) -> bool:
        """Whether every run ended in the goal within its bound."""
        return bool((self.done & self.in_goal & (self.moves <= self.promised)).all())


def draw_starts(policy: Policy, runs: int, rng: np.random.Generator) -> Draws:
    """Starts in random cells: half of them uniform, half at corners of everything uncertain."""
    setup = setup_of(policy.task)
    # the policy asks once more than it moves, as the pose sensed last gets a `done`
    draws = draw(setup, policy.moves + 1, runs, rng)
    chosen = rng.integers(len(policy.cells), size=runs)
    low, high = ends_of([policy.cells[int(k)].sensed for k in chosen])
    u = setup.uncertainty
    reach = np.array([u.sensed_position.hi, u.sensed_position.hi, u.sensed_orientation.hi])
    draws.sensing[:, 0] = spread(-reach, reach, (runs, 3), rng)
    draws.start[:] = spread(low, high, (runs, 3), rng) - draws.sensing[:, 0]
    return draws


def run_policy(policy: Policy, bench: Bench) -> PolicyRuns:
    """Run the policy from every start of a laboratory's draws, through the controller that one would use."""
    setup, draws = bench.setup, bench.draws
    answers = _Answers(policy, setup, draws)
    runs = carry_out([answers.orders] * (policy.moves + 1), bench, draws.start)
    ended = np.flatnonzero(~runs.completed)
    return PolicyRuns(
        moves=np.sum(
            [np.isin(np.arange(len(answers.done)), list(m)) for m in answers.moves], axis=0
        ),
        done=answers.done,
        in_goal=answers.done & (excess(runs.final, setup.goal) == 0.0).all(axis=1),
        promised=answers.promised,
        excess=_excess(answers, runs),
        why=(*answers.why, *(_why(answers, runs, int(k)) for k in ended)),
    )


def _excess(answers: _Answers, runs: PlanRun) -> Floats:
    """(3,) largest distance outside of what the completed moves were answered to end in."""
    found = np.zeros(3)
    for at, (answered, made) in enumerate(zip(answers.moves, runs.moves, strict=True)):
        for k, move in answered.items():
            if runs.failed_in[k] > at:
                pose = made.after[k] + _full_turns(made.after[k], move.expect)
                found = np.maximum(found, excess(pose[None], move.expect)[0])
    return found


def _why(answers: _Answers, runs: PlanRun, k: int) -> str:
    return f"{answers.moves[runs.failed_in[k]][k].rule.action}: {why(int(runs.outcomes[k]))}"


class _Answers:
    """What the controller that a laboratory would use answers to each of N runs."""

    def __init__(self, policy: Policy, setup: Setup, draws: Draws) -> None:
        self.setup, self.draws = setup, draws
        first = PolicyController(policy)
        self.controllers = [copy.copy(first) for _ in range(len(draws.start))]
        self.done = np.zeros(len(draws.start), dtype=bool)
        self.promised = np.zeros(len(draws.start), dtype=np.int64)
        self.why: list[str] = []
        self.moves: list[dict[int, Move]] = []
        """By run, of each order."""

    def orders(self, sensed: Floats, going: Flags) -> tuple[Order, ...]:
        """The next moves of the runs that go on, apart for two tips and for three."""
        answered: dict[int, dict[int, Move]] = {2: {}, 3: {}}
        for k in map(int, np.flatnonzero(going)):
            x, y, theta = (float(value) for value in sensed[k])
            reply = self.controllers[k].answer(
                Sensed(x_um=units.to_um(x), y_um=units.to_um(y), theta_deg=units.to_deg(theta))
            )
            if isinstance(reply, Move):
                answered[2 + (reply.rule.single is not None)][k] = reply
                self.promised[k] = self.promised[k] or self.controllers[k].to_go
            elif isinstance(reply, Done):
                self.done[k] = True
            else:
                self.why.append(reply.why)
        groups = {tips: moves for tips, moves in answered.items() if moves}
        self.moves += groups.values()
        return tuple(self._order(tips, moves) for tips, moves in groups.items())

    def _order(self, probes: int, moves: dict[int, Move]) -> Order:
        tips = np.full((len(self.done), probes, 2), np.nan)
        travel, runs = tips.copy(), np.zeros(len(self.done), dtype=bool)
        names = np.zeros((len(self.done), probes), dtype=np.int64)
        spacing = np.broadcast_to(spacing_of(self.setup, self.draws), (len(self.done),))
        for k, move in moves.items():
            commanded = move.rule.commands(
                np.array([move.sensed.mid]),
                spacing[k : k + 1],
                self.draws.misalignment[k : k + 1],
            )
            names[k] = tips_of(names_of(move.rule))
            runs[k], tips[k], travel[k] = True, commanded.tips[0], commanded.travel[0]
        return Order(runs=runs, commands=Commands(tips=tips, travel=travel), names=names)


def _full_turns(pose: Floats, box: PoseBox) -> Floats:
    turns = np.rint((box.theta.mid - pose[2]) / (2.0 * np.pi))
    return np.array([0.0, 0.0, 2.0 * np.pi * turns])
