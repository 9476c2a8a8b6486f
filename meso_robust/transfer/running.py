"""A plan run in the simulator under the model's own physics: evidence, not proof.

Here nothing is bounded: the effects act as the simulator has them, at values from their intervals,
and the errors of the task are those that the user stated, without what the effects add. The clock of
drifting probes and cameras runs on from move to move. Tips that pull at the part back off in the
plane after each move, so that it shows how far they drag the part along.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from meso_robust import units
from meso_robust.identification.document import ModelDocument
from meso_robust.identification.models import Physics
from meso_robust.laboratory.draws import Draws, draw
from meso_robust.laboratory.engines import Pushed, push_all
from meso_robust.laboratory.making import outline, true_ways
from meso_robust.laboratory.running import (
    STARTS_INSIDE,
    STEP,
    Order,
    PlanRun,
    Which,
    by_rules,
    carry_out,
    drawn_radii,
    excess,
    there_and_back,
    walls,
    why,
)
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.simulator import Outcome, Push, simulate
from meso_robust.simulator.environment import FORCE_SLOTS
from meso_robust.simulator.geometry import outlines, radii, tracked_of_reference
from meso_robust.simulator.observation import observe
from meso_robust.simulator.push import leg_times
from meso_robust.simulator.support import INERTIA_TIME
from meso_robust.simulator.touch import PULL_SLOTS
from meso_robust.task import Task
from meso_robust.types import Flags, Floats
from meso_robust.wording import up

HANDLING_S = 10.0
"""s a move: lifting the probes, sensing, placing them; what drifts or draws the part goes on."""
_FAR = 0.1  # m: where probes do nothing to the part
_BACK = 0.25  # of the part's length: how far tips back off, if they pull at the part
_MENISCUS_STEP = 0.25e-6  # m, for menisci of a few um
_FIXED_POINT = 4  # rounds for a start that is seen where the task has it
_MECHANICS = "reference_offset"  # the one effect of the part's motion that is only seen
_TIPS = "friction_spread"  # nobody says which tip of a plan is which of the recordings
_GLIDES = 8.0  # times in which a free part stops, until it has


@dataclass(frozen=True, slots=True, kw_only=True)
class Evidence:
    """The outcome of the runs."""

    runs: int
    completed: int
    in_goal: int
    worst_um: float
    """Largest distance of a completed run's x or y outside the goal."""
    worst_deg: float
    endings: tuple[tuple[str, int], ...]
    """Why runs ended early, and how many."""
    broken: bool
    """Whether a run fails beyond doubt: a jam, a probe inside the part, a miss of the goal."""
    seed: int


@dataclass(slots=True, kw_only=True, eq=False)
class _Laboratory:
    """N laboratories that the model allows."""

    document: ModelDocument
    values: Floats
    """(N, n) parameters of the model, SI."""
    task: Task
    setup: Setup
    draws: Draws
    clock: float = 0.0
    """s since the start; drifting probes and cameras go by it from move to move."""

    def stated_radii(self, order: Order) -> Floats:
        """(1|N, P) of tips as the recordings state them, else as the task does, m."""
        if self.document.probe is not None and self.document.probe.tip_radius_um > 0.0:
            radius = units.UM * self.document.probe.tip_radius_um
            return np.full((1, order.names.shape[-1]), radius)
        return drawn_radii(self.draws, order)

    def physics(self, runs: Which = slice(None)) -> Physics:
        """The physics of some."""
        return self.document.made().physics(self.values[runs])

    def seen(self, poses: Floats) -> Floats:
        """(N, 3) where the tracker now has parts that are at rest at ``poses``."""
        table = self.physics().effects.table
        tracked = tracked_of_reference(poses, table)
        nothing = np.zeros((len(poses), 1, 1, 2))
        shown, _ = observe(
            np.array([self.clock]), tracked[:, None], nothing, table, probes_seen_by_camera=False
        )
        return shown[:, 0]

    def sense(self, k: int, poses: Floats, going: Flags) -> Floats:
        """(N, 3) what the tracker says, with the task's own errors."""
        return self.seen(poses) + self.draws.sensing[:, k]

    def ways(self, k: int, order: Order) -> Floats:
        """(N, L + 1, P, 2) as commanded, with the errors drawn and how far the probes' mount has drifted."""
        tips = order.commands.tips
        drift = self.physics().effects.values.get("probe_drift", {})
        along = np.zeros((len(tips), 2))
        for axis, key in enumerate(("x_um_s", "y_um_s")):
            along[:, axis] = self.clock * np.asarray(drift.get(key, 0.0))
        starts = tips + self.draws.of_tips(k, tips.shape[1]) + along[:, None]
        return true_ways(self.setup, self.draws, k, starts, order.commands.travel)

    @property
    def outlines(self) -> Floats:
        """(1|N, V, 2) of parts as the model has them, m."""
        return outlines(outline(self.setup), self.physics().effects.table)

    def radii(self, order: Order) -> Floats:
        """(1|N, P) of tips as the model has them, m."""
        return radii(self.stated_radii(order), self.physics().effects.table)

    def push(
        self, k: int, order: Order, runs: Which, poses: Floats, ways: Floats, record: int
    ) -> Pushed:
        """The move, and what the stage does to the parts until the next one."""
        stated = self.stated_radii(order)
        push = _push(poses, ways, runs, self, stated[runs] if len(stated) > 1 else stated)
        pushed = push_all(push, "stepper", record)
        self.clock += float(push.times[:, -1].max()) + HANDLING_S
        done = pushed.outcomes == Outcome.COMPLETED
        rests = np.zeros(len(self.values), dtype=np.bool_)
        rests[runs] = done
        ends = pushed.poses.copy()
        ends[done] = _rested(ends[done], rests, self)
        return replace(pushed, poses=ends)


def evidence(
    rules: Sequence[MoveRule],
    task: Task,
    document: ModelDocument,
    runs: int,
    seed: int,
    tolerance: tuple[float, float, float],
) -> Evidence:
    """Run a plan in laboratories drawn from the model's intervals.

    Parameters
    ----------
    rules
        The plan.
    task
        The task as the user stated it.
    document
        The model.
    runs, seed
        How many, and the seed of their draws: half uniform over all ranges, half at their corners.
    tolerance
        (m, m, rad) misses of the goal up to it are the simulator's own error.

    Raises
    ------
    ValueError
        The simulator cannot run this model.
    """
    setup, ran = setup_of(task), outcomes_of(rules, task, document, runs, seed)
    outcomes, done = ran.outcomes, ran.completed
    missed = excess(ran.final, setup.goal)
    clear = done & (missed > np.array(tolerance)).any(axis=1)
    ended = Counter(why(int(code)) for code in outcomes[~done])
    worst = missed[done].max(axis=0, initial=0.0)
    return Evidence(
        runs=runs,
        completed=int(done.sum()),
        in_goal=int((done & (missed == 0.0).all(axis=1)).sum()),
        worst_um=float(up(units.to_um(float(worst[:2].max())), 3)),
        worst_deg=float(up(units.to_deg(float(worst[2])), 4)),
        endings=tuple(sorted(ended.items())),
        broken=bool(clear.any() or np.isin(outcomes, (STARTS_INSIDE, Outcome.JAM)).any()),
        seed=seed,
    )


def outcomes_of(
    rules: Sequence[MoveRule], task: Task, document: ModelDocument, runs: int, seed: int
) -> PlanRun:
    """The runs of `evidence`, move by move; parameters as there."""
    rng, setup = np.random.default_rng(seed), setup_of(task)
    lab = _Laboratory(
        document=document,
        values=_values(document, runs, rng),
        task=task,
        setup=setup,
        draws=draw(setup, len(rules), runs, rng),
    )
    return _run(rules, lab)


def _values(document: ModelDocument, runs: int, rng: np.random.Generator) -> Floats:
    """(N, n) parameters within their intervals; an open side ends at the best value."""
    model, best = document.made(), document.values
    low, high = best.copy(), best.copy()
    for k, one in enumerate(model.parameters):
        section = document.parameters.get(one.key)
        if section is not None:
            low[k] = best[k] if section.open_low else section.low * one.to_si
            high[k] = best[k] if section.open_high else section.high * one.to_si
    share = rng.random((runs, len(best)))
    corners = np.arange(runs) >= (runs + 1) // 2
    share[corners] = np.rint(share[corners])
    values = low + share * (high - low)
    return np.where(model.valid(values)[:, None], values, best)


def _run(rules: Sequence[MoveRule], lab: _Laboratory) -> PlanRun:
    rounds = by_rules(rules, lab.setup, lab.draws)
    return carry_out(rounds, lab, _start(lab))


def _start(lab: _Laboratory) -> Floats:
    """True starts that are seen, up to the task's own errors, where the task has the start."""
    wanted = lab.draws.start
    true = wanted.copy()
    for _ in range(_FIXED_POINT):
        true = true - (lab.seen(true) - wanted)
    return true


def _push(poses: Floats, ways: Floats, runs: Which, lab: _Laboratory, stated: Floats) -> Push:
    physics = lab.physics(runs)
    felt = physics.effects.without(_MECHANICS).without(_TIPS)
    pulled = felt.is_on(*PULL_SLOTS)
    waypoints, times = _way(ways, lab, back=pulled)
    if felt.is_on(INERTIA_TIME):
        rest = _GLIDES * float(felt.table[:, INERTIA_TIME].max())
        waypoints = np.concatenate([waypoints, waypoints[:, -1:]], axis=1)
        times = np.concatenate([times, times[:, -1:] + rest], axis=1)
    return Push(
        vertices=outline(lab.setup),
        poses=poses,
        waypoints=waypoints,
        times=times,
        friction=physics.friction,
        support=physics.support,
        effects=felt,
        radii=stated,
        fixture=walls(lab.setup),
        step=_MENISCUS_STEP if pulled else STEP,
    )


def _way(ways: Floats, lab: _Laboratory, *, back: bool) -> tuple[Floats, Floats]:
    """(N, T, P, 2) waypoints and (N, T) times of a move, and of backing off if tips that leave matter."""
    speed = lab.task.probe.speed_um_s * units.UM
    reach = _BACK * 2.0 * lab.setup.outline.reach
    if not back:
        return ways, leg_times(np.diff(ways, axis=1), speed)
    return there_and_back(ways, speed, reach, speed)


def _rested(poses: Floats, runs: Flags, lab: _Laboratory) -> Floats:
    """(n, 3) where the stage takes the parts of some runs, which nothing touches, by the next move."""
    physics = lab.physics(runs)
    if not runs.any() or not physics.effects.is_on(*FORCE_SLOTS):
        return poses
    far = poses[:, None, :2] + _FAR
    waiting = Push(
        vertices=outline(lab.setup),
        poses=poses,
        waypoints=np.stack([far, far], axis=1),
        times=np.array([[0.0, HANDLING_S]]),
        friction=physics.friction,
        support=physics.support,
        effects=physics.effects.without(_MECHANICS).without(_TIPS),
        fixture=walls(lab.setup),
        step=STEP,
    )
    return simulate(waiting).poses
