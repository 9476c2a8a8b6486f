"""A plan run in the simulator under the model's own physics: evidence, not proof.

Here nothing is bounded: the effects act as the simulator has them, at values from their intervals,
and the errors of the task are those that the user stated, without what the effects add. The clock of
drifting probes and cameras runs on from move to move. Tips that pull at the part back off in the
plane after each move, so that it shows how far they drag the part along.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from meso_robust import units
from meso_robust.identification.document import ModelDocument
from meso_robust.identification.models import Physics
from meso_robust.laboratory.draws import Draws, draw
from meso_robust.laboratory.running import STARTS_INSIDE, STEP, excess, rectangle, walls
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.simulator import Outcome, Point, Push, Round, simulate
from meso_robust.simulator.environment import FORCE_SLOTS
from meso_robust.simulator.geometry import radii, stretch, tracked_of_reference
from meso_robust.simulator.observation import observe
from meso_robust.simulator.touch import PULL_SLOTS
from meso_robust.task import Task
from meso_robust.types import Flags, Floats, Ints
from meso_robust.wording import up

HANDLING_S = 10.0
"""s a move: lifting the probes, sensing, placing them; what drifts or draws the part goes on."""
_FAR = 0.1  # m: where probes do nothing to the part
_BACK = 0.25  # of the part's length: how far tips back off, if they pull at the part
_MENISCUS_STEP = 0.25e-6  # m, for menisci of a few um
_FIXED_POINT = 4  # rounds for a start that is seen where the task has it
_MECHANICS = "reference_offset"  # the one effect of the part's motion that is only seen


@dataclass(frozen=True, slots=True, kw_only=True)
class Evidence:
    """What came of the runs."""

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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Laboratory:
    """N laboratories that the model allows."""

    document: ModelDocument
    values: Floats
    """(N, n) parameters of the model, SI."""
    task: Task
    setup: Setup
    draws: Draws

    @property
    def tip(self) -> Round | Point:
        """The tips that the recordings state; a commanded place is that of a tip's centre."""
        radius = 0.0 if self.document.probe is None else self.document.probe.tip_radius_um
        return Round(units.UM * radius) if radius > 0.0 else Point()

    def physics(self, rows: Ints) -> Physics:
        """The physics of some."""
        return self.document.made().physics(self.values[rows])

    def seen(self, poses: Floats, time: float) -> Floats:
        """(N, 3) where the tracker has parts that are at rest at ``poses``."""
        table = self.physics(np.arange(len(poses))).effects.table
        tracked = tracked_of_reference(poses, table)
        nothing = np.zeros((len(poses), 1, 1, 2))
        shown, _ = observe(
            np.array([time]), tracked[:, None], nothing, table, probes_seen_by_camera=False
        )
        return shown[:, 0]


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
    rng, setup = np.random.default_rng(seed), setup_of(task)
    lab = _Laboratory(
        document=document,
        values=_values(document, runs, rng),
        task=task,
        setup=setup,
        draws=draw(setup, len(rules), runs, rng),
    )
    poses, outcomes = _run(rules, lab)
    done = outcomes == Outcome.COMPLETED
    missed = excess(poses, setup.goal)
    clear = done & (missed > np.array(tolerance)).any(axis=1)
    ended = Counter(_ending(int(code)) for code in outcomes[~done])
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


def _run(rules: Sequence[MoveRule], lab: _Laboratory) -> tuple[Floats, npt.NDArray[np.int8]]:
    """Final poses (N, 3), and outcomes (N,), of the whole plan."""
    poses, clock = _start(lab), 0.0
    outcomes = np.full(len(poses), Outcome.COMPLETED, dtype=np.int8)
    for k, rule in enumerate(rules):
        tips, travel = _commands(rule, poses, k, clock, lab)
        alive = outcomes == Outcome.COMPLETED
        inside = alive & _inside(tips, poses, lab)
        outcomes[inside] = STARTS_INSIDE
        rows = np.flatnonzero(alive & ~inside)
        if not rows.size:
            break
        push = _push(poses[rows], tips[rows], travel[rows], rows, lab)
        found = simulate(push)
        poses[rows], outcomes[rows] = found.poses, found.outcomes
        clock += float(push.times[:, -1].max()) + HANDLING_S
        _rest(poses, np.flatnonzero(outcomes == Outcome.COMPLETED), lab)
    return poses, outcomes


def _start(lab: _Laboratory) -> Floats:
    """True starts that are seen, up to the task's own errors, where the task has the start."""
    wanted = lab.draws.start
    true = wanted.copy()
    for _ in range(_FIXED_POINT):
        true = true - (lab.seen(true, 0.0) - wanted)
    return true


def _commands(
    rule: MoveRule, poses: Floats, k: int, clock: float, lab: _Laboratory
) -> tuple[Floats, Floats]:
    """(N, P, 2) true tips at the start of a move, and their travel."""
    draws = lab.draws
    sensed = lab.seen(poses, clock) + draws.sensing[:, k]
    commanded = rule.commands(sensed, lab.setup.spacing.mid, draws.misalignment)
    errors = [draws.dual[:, k], draws.dual[:, k], draws.single[:, k]][: commanded.tips.shape[1]]
    drift = lab.physics(np.arange(len(poses))).effects.values.get("probe_drift", {})
    along = np.zeros((len(poses), 2))
    for axis, key in enumerate(("x_um_s", "y_um_s")):
        along[:, axis] = clock * np.asarray(drift.get(key, 0.0))
    return commanded.tips + np.stack(errors, axis=1) + along[:, None], commanded.travel


def _inside(tips: Floats, poses: Floats, lab: _Laboratory) -> Flags:
    """(N,) whether a tip would be lowered onto the part."""
    corners = rectangle(lab.setup)
    table = lab.physics(np.arange(len(poses))).effects.table
    radius = radii(np.array([lab.tip.radius]), table)
    half = 0.5 * np.ptp(corners, axis=0) * stretch(corners, table) + radius
    offset = tips - poses[:, None, :2]
    c, s = np.cos(poses[:, None, 2]), np.sin(poses[:, None, 2])
    x, y = offset[..., 0], offset[..., 1]
    own = np.stack([c * x + s * y, c * y - s * x], axis=-1)
    return np.asarray((np.abs(own) < half[:, None]).all(axis=2).any(axis=1))


def _push(poses: Floats, tips: Floats, travel: Floats, rows: Ints, lab: _Laboratory) -> Push:
    physics = lab.physics(rows)
    felt = physics.effects.without(_MECHANICS)
    pulled = felt.is_on(*PULL_SLOTS)
    waypoints, times = _way(tips, travel, lab, back=pulled)
    return Push(
        vertices=rectangle(lab.setup),
        poses=poses,
        waypoints=waypoints,
        times=times,
        friction=physics.friction,
        support=physics.support,
        effects=felt,
        shapes=(lab.tip,) * tips.shape[1],
        fixture=walls(lab.setup),
        step=_MENISCUS_STEP if pulled else STEP,
    )


def _way(tips: Floats, travel: Floats, lab: _Laboratory, *, back: bool) -> tuple[Floats, Floats]:
    """(N, T, P, 2) waypoints and (N, T) times of a move, and of backing off if tips that leave matter.

    The active tips back off the way they came, the passive one to its own side, at the task's speed.
    """
    speed = lab.task.probe.speed_um_s * units.UM
    far = np.hypot(travel[..., 0], travel[..., 1]).max(axis=1)
    ends = tips + travel
    waypoints, times = [tips, ends], [np.zeros_like(far), np.where(far > 0.0, far / speed, 1.0)]
    if back:
        along = (travel[:, 0] / np.where(far > 0.0, far, 1.0)[:, None])[:, None]
        rests = (travel == 0.0).all(axis=2, keepdims=True)
        reach = _BACK * 2.0 * lab.setup.half_length.mid
        waypoints.append(ends + reach * np.where(rests, along, -along))
        times.append(times[-1] + reach / speed)
    return np.stack(waypoints, axis=1), np.stack(times, axis=1)


def _rest(poses: Floats, rows: Ints, lab: _Laboratory) -> None:
    """What the stage does to parts that nothing touches, until the next move."""
    if not rows.size or not lab.physics(rows).effects.is_on(*FORCE_SLOTS):
        return
    physics = lab.physics(rows)
    far = poses[rows, None, :2] + _FAR
    waiting = Push(
        vertices=rectangle(lab.setup),
        poses=poses[rows],
        waypoints=np.stack([far, far], axis=1),
        times=np.array([[0.0, HANDLING_S]]),
        friction=physics.friction,
        support=physics.support,
        effects=physics.effects.without(_MECHANICS),
        fixture=walls(lab.setup),
        step=STEP,
    )
    poses[rows] = simulate(waiting).poses


def _ending(code: int) -> str:
    if code == STARTS_INSIDE:
        return "a probe would start inside the part"
    return Outcome(code).message
