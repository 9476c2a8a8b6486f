"""The laboratory's loop: sense the pose, decide the move, place the probes, push, withdraw, sense again.

All runs of plans go through `carry_out`, whatever decides their moves and wherever they are made.
Nothing of the proof is used here but the rules.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from meso_robust.laboratory.draws import Draws
from meso_robust.laboratory.engines import Engine, Pushed, push_all
from meso_robust.laboratory.geometry import distances, in_part
from meso_robust.primitives.move import Commands, MoveRule
from meso_robust.primitives.outline import Polygon
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.simulator import Fixture, Outcome, Push
from meso_robust.types import Flags, Floats
from meso_robust.units import UM

_Numbers = TypeVar("_Numbers", Floats, npt.NDArray[np.int8])

STEP = 2e-6  # m, of the probes; its error is measured by a second run at half of it
STARTS_INSIDE = -1  # a run whose probe would start inside the part is not simulated further
WOULD_START_INSIDE = "a probe would start inside the part"
"""The same in words."""

Which = slice | Flags
"""Some of N runs; a slice where it is all of them, because that copies nothing."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MoveRun:
    """One move of N runs; what it says of runs that do not make it is of no account."""

    before: Floats
    """(N, 3) true poses."""
    sensed: Floats
    """(N, 3) sensed poses that the commands follow from."""
    tips: Floats
    """(N, P, 2) true tip positions at the start: upper, lower and, if present, passive tip, m."""
    travel: Floats
    """(N, P, 2) displacement of the tips, m."""
    path: Floats
    """(N, record + 1, 3) poses during the move."""
    modes: npt.NDArray[np.int8]
    """(N, record + 1, P) contact mode of each tip during the move; see `PushResult.modes`.
    ``NOT_RECORDED`` by the event-driven engine."""
    phases: npt.NDArray[np.int64]
    """(N,) intervals of constant contact modes; ``NOT_RECORDED`` by the stepper, 0 for a run that
    had ended before."""
    after: Floats
    """(N, 3) true poses."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlanRun:
    """N runs of a whole plan."""

    moves: tuple[MoveRun, ...]
    outcomes: npt.NDArray[np.int8]
    """(N,) values of ``Outcome``, or STARTS_INSIDE: why a run ended."""
    failed_in: npt.NDArray[np.int64]
    """(N,) index of the move in which the run ended early; the number of moves if it did not."""

    @property
    def final(self) -> Floats:
        """(N, 3) poses at the end."""
        return self.moves[-1].after

    @property
    def completed(self) -> Flags:
        """(N,) whether every move was completed."""
        return self.outcomes == Outcome.COMPLETED


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Order:
    """The next move of those of N runs that make it with as many probes."""

    runs: Flags
    """(N,)"""
    commands: Commands
    """Of N runs; those of other runs are of no account."""


Decide = Callable[[Floats, Flags], Sequence[Order]]
"""Sensed poses (N, 3) and which runs (N,) go on, to their next moves: a run without one is over."""


class Laboratory(Protocol):
    """Where N runs are made: everything that is uncertain, and the physics."""

    def sense(self, k: int, poses: Floats, going: Flags) -> Floats:
        """(N, 3) sensed poses before round ``k``; needed of the runs that go on."""

    def place(self, k: int, order: Order) -> Floats:
        """(N, P, 2) where the tips really start, m."""

    def blocked(self, tips: Floats, poses: Floats) -> Flags:
        """(N,) whether a tip would be lowered onto the part."""

    def push(self, runs: Which, poses: Floats, tips: Floats, travel: Floats, record: int) -> Pushed:
        """Push the parts of some runs, until the probes are out of the plane; poses of these only."""


def carry_out(
    rounds: Sequence[Decide], laboratory: Laboratory, start: Floats, record: int = 0
) -> PlanRun:
    """Carry out N runs side by side: the one loop of the laboratory.

    Parameters
    ----------
    rounds
        What decides the moves: called one after the other, each with the poses sensed then. The runs
        end with the last of them, if not before.
    laboratory
        Where they are made.
    start
        (N, 3) true poses, m and rad.
    record
        Intervals of the path to keep of each move.

    Returns
    -------
    PlanRun
        One `MoveRun` for every order, in the order in which they were carried out.
    """
    poses, going = start, np.ones(len(start), dtype=np.bool_)
    outcomes = np.full(len(start), Outcome.COMPLETED, dtype=np.int8)
    failed_in = np.zeros(len(start), dtype=np.int64)
    moves: list[MoveRun] = []
    for k, decide in enumerate(rounds):
        sensed = laboratory.sense(k, poses, going)
        orders = decide(sensed, going)
        going = np.zeros_like(going)  # a run that gets no order is over
        for order in orders:
            tips = laboratory.place(k, order)
            inside = order.runs & laboratory.blocked(tips, poses)
            outcomes[inside] = STARTS_INSIDE
            move = _made(laboratory, (poses, sensed), order, tips, ~inside, outcomes, record)
            completed = outcomes == Outcome.COMPLETED
            failed_in[order.runs & ~completed] = len(moves)
            going |= order.runs & completed
            poses = move.after
            moves.append(move)
    failed_in[outcomes == Outcome.COMPLETED] = len(moves)
    return PlanRun(moves=tuple(moves), outcomes=outcomes, failed_in=failed_in)


def _made(
    laboratory: Laboratory,
    before: tuple[Floats, Floats],
    order: Order,
    tips: Floats,
    free: Flags,
    outcomes: npt.NDArray[np.int8],
    record: int,
) -> MoveRun:
    """The move of the runs whose tips are free to start; writes their outcomes."""
    (poses, sensed), pushing = before, order.runs & free
    after, path = poses, np.broadcast_to(poses[:, None], (len(poses), record + 1, 3))
    modes = np.zeros((len(poses), record + 1, tips.shape[1]), dtype=np.int8)
    phases = np.zeros(len(poses), dtype=np.int64)
    if pushing.any():
        which = slice(None) if pushing.all() else pushing
        travel = order.commands.travel[which]
        pushed = laboratory.push(which, poses[which], tips[which], travel, record)
        after, outcomes[which] = _over(pushing, pushed.poses, poses), pushed.outcomes
        if record:
            path, modes = _over(pushing, pushed.path, path), _over(pushing, pushed.modes, modes)
        phases[which] = pushed.phases
    return MoveRun(
        before=poses,
        sensed=sensed,
        tips=tips,
        travel=order.commands.travel,
        path=path,
        modes=modes,
        phases=phases,
        after=after,
    )


def _over(pushing: Flags, made: _Numbers, before: _Numbers) -> _Numbers:
    """What was made of the runs that are pushed, and what there was before of the others."""
    if pushing.all():
        return made
    whole = before.copy()
    whole[pushing] = made
    return whole


def there_and_back(
    tips: Floats, travel: Floats, speed: float, reach: float, speed_back: float
) -> tuple[Floats, Floats]:
    """The way of tips that back off in the plane, where that matters.

    Parameters
    ----------
    tips, travel
        (N, P, 2) starts and displacements, m.
    speed, speed_back
        Of the push and of backing off, m/s.
    reach
        How far the tips back off, m: the active ones the way they came, the passive one to its own side.

    Returns
    -------
    tuple
        (N, 3, P, 2) waypoints, m, and (N, 3) their times, s.
    """
    far = np.hypot(travel[..., 0], travel[..., 1]).max(axis=1)
    # a push of no length takes its time too, and has no direction
    there = np.where(far > 0.0, far / speed, 1.0)
    along = (travel[:, 0] / np.where(far > 0.0, far, 1.0)[:, None])[:, None]
    rests = (travel == 0.0).all(axis=2, keepdims=True)
    ends = tips + travel
    waypoints = np.stack([tips, ends, ends + reach * np.where(rests, along, -along)], axis=1)
    return waypoints, np.stack([np.zeros_like(far), there, there + reach / speed_back], axis=1)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bench:
    """The task's own laboratory: its part on its film, between its walls, pushed by point tips."""

    setup: Setup
    friction: Floats
    """(N,)"""
    film_ratio: Floats
    """(N,) m^2."""
    engine: Engine = "stepper"
    step: float = STEP

    def blocked(self, tips: Floats, poses: Floats) -> Flags:
        """(N,) whether a tip would be lowered onto the part."""
        return starts_inside(tips, poses, self.setup)

    def push(self, runs: Which, poses: Floats, tips: Floats, travel: Floats, record: int) -> Pushed:
        """Straight pushes by an engine of the simulator."""
        push = Push.straight(
            vertices=outline(self.setup),
            poses=poses,
            tips=tips,
            travel=travel,
            friction=self.friction[runs],
            film_ratio=self.film_ratio[runs],
            step=self.step,
            fixture=walls(self.setup),
        )
        return push_all(push, self.engine, record)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DrawnBench(Bench):
    """The task's laboratory with errors that were drawn beforehand."""

    draws: Draws

    def sense(self, k: int, poses: Floats, going: Flags) -> Floats:
        """(N, 3) true poses plus the errors drawn."""
        return poses + self.draws.sensing[:, k]

    def place(self, k: int, order: Order) -> Floats:
        """(N, P, 2) tips as commanded plus the probes' errors."""
        tips = order.commands.tips
        return np.asarray(tips + self.draws.of_tips(k, tips.shape[1]))


def why(code: int) -> str:
    """What an outcome means.

    Parameters
    ----------
    code
        From ``PlanRun.outcomes``.

    Returns
    -------
    str
        Why the run ended, in words.
    """
    return WOULD_START_INSIDE if code == STARTS_INSIDE else Outcome(code).message


def by_rules(rules: Sequence[MoveRule], setup: Setup, misalignment: Floats) -> tuple[Decide, ...]:
    """Rounds of a plan whose moves follow from the pose sensed before them.

    Parameters
    ----------
    rules, setup
        The plan and the task.
    misalignment
        (N,) of the active probe's two tips in each run, rad.

    Returns
    -------
    tuple
        One round a rule, for `carry_out`.
    """
    return tuple(partial(_by_rule, rule, setup, misalignment) for rule in rules)


def _by_rule(
    rule: MoveRule, setup: Setup, misalignment: Floats, sensed: Floats, going: Flags
) -> tuple[Order, ...]:
    commands = rule.commands(sensed, setup.spacing.mid, misalignment)
    return (Order(runs=going, commands=commands),)


def run(
    rules: Sequence[MoveRule],
    setup: Setup,
    draws: Draws,
    *,
    record: int = 0,
    step: float = STEP,
    engine: Engine = "stepper",
) -> PlanRun:
    """Run the plan once for every row of ``draws``.

    Parameters
    ----------
    rules, setup
        The plan and the task.
    draws
        What is uncertain.
    record
        Intervals of the path to keep of each move.
    step
        Longest probe displacement of a simulation step, m; the event-driven engine takes none.
    engine
        Which engine of the simulator makes the moves.

    Returns
    -------
    PlanRun
        One `MoveRun` a rule.
    """
    bench = DrawnBench(
        setup=setup,
        friction=draws.friction,
        film_ratio=draws.film_ratio,
        engine=engine,
        step=step,
        draws=draws,
    )
    return carry_out(by_rules(rules, setup, draws.misalignment), bench, draws.start, record)


def walls(setup: Setup) -> Fixture:
    """The walls of the task's slot.

    Parameters
    ----------
    setup
        The task.

    Returns
    -------
    Fixture
        Empty if the task has no slot.
    """
    if setup.slot is None:
        return Fixture()
    outline = np.array(setup.slot.outline_um, dtype=np.float64) * UM
    return Fixture((outline,), setup.slot.friction)


def outline(setup: Setup) -> Floats:
    """The part's corners.

    Parameters
    ----------
    setup
        The task.

    Returns
    -------
    Floats
        (V, 2) body frame, counter-clockwise, m.
    """
    return np.array([[x.mid, y.mid] for x, y in setup.outline.corners])


def rectangle(setup: Setup) -> Floats:
    """The corners of a part that must be a rectangle.

    Parameters
    ----------
    setup
        The task.

    Returns
    -------
    Floats
        (4, 2) as `outline` gives them.

    Raises
    ------
    InputError
        The part is a polygon.
    """
    a, b = setup.half_length.mid, setup.half_width.mid
    return np.array([[-a, -b], [a, -b], [a, b], [-a, b]])


def starts_inside(tips: Floats, poses: Floats, setup: Setup) -> Flags:
    """(N,) whether one of the tips (N, P, 2), m, is inside the part at its pose (N, 3)."""
    own = in_part(tips, poses[:, None])
    if isinstance(setup.outline, Polygon):
        inside = distances(own, outline(setup)) < 0.0
    else:
        inside = np.all(np.abs(own) < [setup.half_length.mid, setup.half_width.mid], axis=2)
    return np.any(inside, axis=1)


def excess(poses: Floats, box: PoseBox) -> Floats:
    """By how much poses lie outside of a box.

    Parameters
    ----------
    poses
        (N, 3), m and rad.
    box
        World frame.

    Returns
    -------
    Floats
        (N, 3) of each coordinate, m, m, rad; 0 inside.
    """
    low, high = box.ends
    return np.maximum(np.maximum(low - poses, poses - high), 0.0)
