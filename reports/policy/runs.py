"""Runs of a policy in the simulator, from starts all over its region: evidence beside the proof."""

from __future__ import annotations

import copy
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from meso_robust import units
from meso_robust.bounds import Interval
from meso_robust.laboratory.engines import Engine, push_all
from meso_robust.laboratory.running import STEP, excess, rectangle
from meso_robust.policy.cells import Policy
from meso_robust.policy.controller import Done, Move, PolicyController
from meso_robust.policy.pose import Sensed
from meso_robust.primitives.setup import PoseBox, setup_of
from meso_robust.simulator import Outcome, Push

Floats = npt.NDArray[np.float64]


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

    boxes = [policy.cells[int(k)].sensed for k in chosen]
    low = np.array([[b.x.lo, b.y.lo, b.theta.lo] for b in boxes])
    high = np.array([[b.x.hi, b.y.hi, b.theta.hi] for b in boxes])
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
    return _Campaign(policy, starts, rng, engine, step).run()


class _Campaign:
    """N runs side by side."""

    def __init__(
        self, policy: Policy, starts: Starts, rng: np.random.Generator, engine: Engine, step: float
    ) -> None:
        self.setup, self.starts, self.rng = setup_of(policy.task), starts, rng
        self.engine, self.step, self.policy = engine, step, policy
        runs = len(starts.poses)
        first = PolicyController(policy)
        self.controllers = [copy.copy(first) for _ in range(runs)]
        self.poses = starts.poses.copy()
        self.alive = np.ones(runs, dtype=bool)
        self.done = np.zeros(runs, dtype=bool)
        self.moves = np.zeros(runs, dtype=np.int64)
        self.promised = np.zeros(runs, dtype=np.int64)
        self.excess = np.zeros(3)
        self.why: list[str] = []

    def run(self) -> PolicyRuns:
        """All moves of all runs."""
        for made in range(self.policy.moves + 1):
            pairs = self._asked(made)
            for probes in (2, 3):
                some = {k: m for k, m in pairs.items() if 2 + (m.rule.single is not None) == probes}
                if some:
                    self._push(some)
        goal = excess(self.poses, self.setup.goal).max(axis=1) == 0.0
        return PolicyRuns(
            moves=self.moves,
            done=self.done,
            in_goal=self.done & goal,
            promised=self.promised,
            excess=self.excess,
            why=tuple(self.why),
        )

    def _asked(self, made: int) -> dict[int, Move]:
        """What the policy answers to the runs that go on."""
        found = {}
        for k in np.flatnonzero(self.alive):
            sensed = self.poses[k] + (self.starts.sensing[k] if made == 0 else self._error())
            x, y, theta = (float(value) for value in sensed)
            reply = self.controllers[k].answer(
                Sensed(x_um=units.to_um(x), y_um=units.to_um(y), theta_deg=units.to_deg(theta))
            )
            if isinstance(reply, Move):
                found[int(k)] = reply
                if made == 0:
                    self.promised[k] = self.controllers[k].to_go
                continue
            self.alive[k] = False
            if isinstance(reply, Done):
                self.done[k] = True
            else:
                self.why.append(reply.why)
        return found

    def _error(self) -> Floats:
        u = self.setup.uncertainty
        reach = np.array([u.sensed_position.hi, u.sensed_position.hi, u.sensed_orientation.hi])
        share = self.rng.uniform(-1.0, 1.0, 3)
        return np.asarray(reach * (np.sign(share) if self.rng.random() < 0.5 else share))

    def _push(self, some: dict[int, Move]) -> None:
        """One move of some runs, all with as many probes."""
        rows = np.array(list(some))
        tips, travel = zip(*(self._commands(k, move) for k, move in some.items()), strict=True)
        pushed = push_all(
            Push.straight(
                vertices=rectangle(self.setup),
                poses=self.poses[rows],
                tips=np.array(tips),
                travel=np.array(travel),
                friction=self.starts.friction[rows],
                film_ratio=self.starts.film_ratio[rows],
                step=self.step,
            ),
            self.engine,
        )
        self.poses[rows] = pushed.poses
        self.moves[rows] += 1
        for row, move, outcome in zip(rows, some.values(), pushed.outcomes, strict=True):
            if outcome != Outcome.COMPLETED:
                self.alive[row] = False
                self.why.append(f"{move.rule.action}: {Outcome(outcome).message}")
            else:
                turns = _full_turns(self.poses[row], move.expect)
                outside = excess((self.poses[row] + turns)[None], move.expect)[0]
                self.excess = np.maximum(self.excess, outside)

    def _commands(self, k: int, move: Move) -> tuple[Floats, Floats]:
        """True tips and their travel: as commanded plus the probes' errors."""
        pose = np.array(move.sensed.mid)
        commanded = move.rule.commands(
            pose[None], self.setup.spacing.mid, self.starts.misalignment[k : k + 1]
        )
        reach = self.setup.uncertainty.probe_position.hi
        dual, single = self.rng.uniform(-reach, reach, (2, 2))
        if self.rng.random() < 0.5:
            dual, single = reach * np.sign(dual), reach * np.sign(single)
        errors = np.array([dual, dual, single])[: commanded.tips.shape[1]]
        return commanded.tips[0] + errors, commanded.travel[0]


def _full_turns(pose: Floats, box: PoseBox) -> Floats:
    turns = np.rint((box.theta.mid - pose[2]) / (2.0 * np.pi))
    return np.array([0.0, 0.0, 2.0 * np.pi * turns])
