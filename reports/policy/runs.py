"""Runs of a policy in the simulator, from starts all over its region: evidence beside the proof."""

from __future__ import annotations

import copy
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from meso_robust import units
from meso_robust.bounds import Interval
from meso_robust.laboratory.engines import Engine
from meso_robust.laboratory.running import (
    STEP,
    Bench,
    Order,
    PlanRun,
    carry_out,
    excess,
    why,
)
from meso_robust.policy.cells import Policy
from meso_robust.policy.controller import Done, Move, PolicyController
from meso_robust.policy.cover import ends_of
from meso_robust.policy.pose import Sensed
from meso_robust.primitives.move import Commands
from meso_robust.primitives.setup import PoseBox, Setup, setup_of
from meso_robust.types import Flags, Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Starts:
    """Where N runs start, and what is constant during each."""

    poses: Floats
    """(N, 3) true poses, m and rad."""
    sensing: Floats
    """(N, 3) first sensing error, sensed minus true."""
    friction: Floats
    film_ratio: Floats
    misalignment: Floats


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


def draw_starts(policy: Policy, runs: int, rng: np.random.Generator) -> Starts:
    """Starts in random cells: half of them uniform, half at corners of everything uncertain."""
    setup = setup_of(policy.task)
    u = setup.uncertainty
    chosen = rng.integers(len(policy.cells), size=runs)
    corner = rng.random(runs) < 0.5

    def one(low: Floats, high: Floats) -> Floats:
        share = rng.random(low.shape)
        share[corner] = np.rint(share[corner])
        return np.asarray(low + share * (high - low))

    def of(range_: Interval, *shape: int) -> Floats:
        return one(np.full((runs, *shape), range_.lo), np.full((runs, *shape), range_.hi))

    low, high = ends_of([policy.cells[int(k)].sensed for k in chosen])
    sensing = np.hstack([of(u.sensed_position, 2), of(u.sensed_orientation, 1)])
    return Starts(
        poses=one(low, high) - sensing,
        sensing=sensing,
        friction=of(u.friction),
        film_ratio=of(u.film_ratio),
        misalignment=of(u.misalignment),
    )


def run_policy(
    policy: Policy,
    starts: Starts,
    rng: np.random.Generator,
    *,
    engine: Engine = "stepper",
    step: float = STEP,
) -> PolicyRuns:
    """Run the policy from every start, through the controller that a laboratory would use."""
    setup = setup_of(policy.task)
    bench = _PolicyBench(
        setup=setup,
        friction=starts.friction,
        film_ratio=starts.film_ratio,
        engine=engine,
        step=step,
        starts=starts,
        rng=rng,
    )
    answers = _Answers(policy, setup, starts)
    # one round more than moves: the pose sensed in it gets a `done`
    runs = carry_out([answers.orders] * (policy.moves + 1), bench, starts.poses)
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

    def __init__(self, policy: Policy, setup: Setup, starts: Starts) -> None:
        self.setup, self.starts = setup, starts
        first = PolicyController(policy)
        self.controllers = [copy.copy(first) for _ in range(len(starts.poses))]
        self.done = np.zeros(len(starts.poses), dtype=bool)
        self.promised = np.zeros(len(starts.poses), dtype=np.int64)
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
        for k, move in moves.items():
            commanded = move.rule.commands(
                np.array([move.sensed.mid]),
                self.setup.spacing.mid,
                self.starts.misalignment[k : k + 1],
            )
            runs[k], tips[k], travel[k] = True, commanded.tips[0], commanded.travel[0]
        return Order(runs=runs, commands=Commands(tips=tips, travel=travel))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _PolicyBench(Bench):
    """The task's laboratory with errors that are drawn as they come, as nobody knows how many moves."""

    starts: Starts
    rng: np.random.Generator

    def sense(self, k: int, poses: Floats, going: Flags) -> Floats:
        """(N, 3) poses with an error, drawn for the runs that go on."""
        if k == 0:
            return poses + self.starts.sensing
        u, sensed = self.setup.uncertainty, poses.copy()
        reach = np.array([u.sensed_position.hi, u.sensed_position.hi, u.sensed_orientation.hi])
        for row in np.flatnonzero(going):
            share = self.rng.uniform(-1.0, 1.0, 3)
            sensed[row] += reach * (np.sign(share) if self.rng.random() < 0.5 else share)
        return sensed

    def place(self, k: int, order: Order) -> Floats:
        """(N, P, 2) tips as commanded plus the probes' errors; two tips of one probe share theirs."""
        tips, reach = order.commands.tips.copy(), self.setup.uncertainty.probe_position.hi
        for row in np.flatnonzero(order.runs):
            error = self.rng.uniform(-reach, reach, (2, 2))
            if self.rng.random() < 0.5:
                error = reach * np.sign(error)
            tips[row] += error[[0, 0, 1]][: tips.shape[1]]
        return tips


def _full_turns(pose: Floats, box: PoseBox) -> Floats:
    turns = np.rint((box.theta.mid - pose[2]) / (2.0 * np.pi))
    return np.array([0.0, 0.0, 2.0 * np.pi * turns])
