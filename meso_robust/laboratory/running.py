"""The laboratory's loop: sense the pose, decide the move, place the probes, push, withdraw, sense again.

All runs of plans go through `carry_out`, whatever decides their moves and wherever they are made.
Nothing of the proof is used here but the rules.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol, Self, TypeVar

import numpy as np
import numpy.typing as npt

from meso_robust.laboratory.draws import TIPS, Draws
from meso_robust.laboratory.engines import Engine, Pushed, push_all
from meso_robust.laboratory.geometry import gaps_to
from meso_robust.laboratory.making import film_of, true_outlines, true_ways
from meso_robust.planning.document import NAMES, names_of
from meso_robust.primitives.move import Commands, MoveRule
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.simulator import Fixture, Outcome, Push
from meso_robust.simulator.push import leg_times
from meso_robust.simulator.support_models import Film
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
    ways: Floats
    """(N, L + 1, P, 2) true places of the tips' centres at the ends of the legs: upper, lower and, if
    present, passive tip, m."""
    radii: Floats
    """(N, P) of the tips, m."""
    outlines: Floats
    """(N, V, 2) true corners of the part, its own axes, m."""
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
    forces: Floats | None = None
    """(N, record + 1, P, 2) force of each tip on the part during the move, over the mean drag and the
    speed of the fastest tip; the event-driven engine keeps none."""

    @property
    def tips(self) -> Floats:
        """(N, P, 2) true places of the tips' centres at the start, m."""
        return self.ways[:, 0]

    @property
    def ends(self) -> Floats:
        """(N, P, 2) the same at the end of the whole travel."""
        return self.ways[:, -1]

    @property
    def travel(self) -> Floats:
        """(N, P, 2) displacement of the tips, m."""
        return self.ends - self.tips

    def tips_at(self, row: int, shares: Floats) -> Floats:
        """(S, P, 2) where the tips of a run are at shares (S,) of the move, m."""
        way = self.ways[row]
        length = np.hypot(*np.moveaxis(np.diff(way, axis=0), -1, 0)).max(axis=1)
        known = np.append(0.0, np.cumsum(length))
        at = shares * known[-1]
        flat = [np.interp(at, known, column) for column in way.reshape(len(way), -1).T]
        return np.stack(flat, axis=1).reshape(len(shares), *way.shape[1:])


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
    names: npt.NDArray[np.int64]
    """(P,) or (N, P) which tips of the probes these are, by their place in ``NAMES``."""


Decide = Callable[[Floats, Flags], Sequence[Order]]
"""Sensed poses (N, 3) and which runs (N,) go on, to their next moves: a run without one is over."""


class Laboratory(Protocol):
    """Where N runs are made: everything that is uncertain, and the physics."""

    def sense(self, k: int, poses: Floats, going: Flags) -> Floats:
        """(N, 3) sensed poses before round ``k``; needed of the runs that go on."""

    @property
    def outlines(self) -> Floats:
        """(1|N, V, 2) true corners of the parts, their own axes, m."""

    def ways(self, k: int, order: Order) -> Floats:
        """(N, L + 1, P, 2) where the tips really go, m."""

    def radii(self, order: Order) -> Floats:
        """(1|N, P) of the tips, m."""

    def push(
        self, k: int, order: Order, runs: Which, poses: Floats, ways: Floats, record: int
    ) -> Pushed:
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
            move = _made(laboratory, (poses, sensed), k, order, outcomes, record)
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
    k: int,
    order: Order,
    outcomes: npt.NDArray[np.int8],
    record: int,
) -> MoveRun:
    """The move of the runs whose tips are free to start; writes the outcomes."""
    poses, sensed = before
    count, ways = len(poses), laboratory.ways(k, order)
    radii = np.broadcast_to(laboratory.radii(order), (count, ways.shape[2]))
    outlines = laboratory.outlines
    outlines = np.broadcast_to(outlines, (count, *outlines.shape[1:]))
    free = (gaps_to(ways[:, 0], poses, outlines, radii) >= 0.0).all(axis=1)
    outcomes[order.runs & ~free] = STARTS_INSIDE
    pushing = order.runs & free
    after, path = poses, np.broadcast_to(poses[:, None], (count, record + 1, 3))
    modes = np.zeros((count, record + 1, ways.shape[2]), dtype=np.int8)
    phases = np.zeros(count, dtype=np.int64)
    forces = None
    if pushing.any():
        which = slice(None) if pushing.all() else pushing
        pushed = laboratory.push(k, order, which, poses[which], ways[which], record)
        after, outcomes[which] = _over(pushing, pushed.poses, poses), pushed.outcomes
        if record:
            path, modes = _over(pushing, pushed.path, path), _over(pushing, pushed.modes, modes)
            if pushed.forces is not None:
                forces = _over(pushing, pushed.forces, np.zeros((*modes.shape, 2)))
        phases[which] = pushed.phases
    return MoveRun(
        before=poses,
        sensed=sensed,
        ways=ways,
        radii=radii,
        outlines=outlines,
        path=path,
        modes=modes,
        phases=phases,
        after=after,
        forces=forces,
    )


def _over(pushing: Flags, made: _Numbers, before: _Numbers) -> _Numbers:
    """What was made of the runs that are pushed, and what there was before of the others."""
    if pushing.all():
        return made
    whole = before.copy()
    whole[pushing] = made
    return whole


def there_and_back(
    ways: Floats, speed: float, reach: float, speed_back: float
) -> tuple[Floats, Floats]:
    """The way of tips that back off in the plane, where that matters.

    Parameters
    ----------
    ways
        (N, L + 1, P, 2) ends of the legs, m.
    speed, speed_back
        Of the push and of backing off, m/s.
    reach
        How far the tips back off, m: the active ones the way they came, the passive one to its own side.

    Returns
    -------
    tuple
        (N, L + 2, P, 2) waypoints, m, and (N, L + 2) their times, s.
    """
    times = leg_times(np.diff(ways, axis=1), speed)
    travel = ways[:, -1] - ways[:, 0]
    far = np.hypot(travel[..., 0], travel[..., 1]).max(axis=1)
    # a push of no length has no direction
    along = (travel[:, 0] / np.where(far > 0.0, far, 1.0)[:, None])[:, None]
    rests = (travel == 0.0).all(axis=2, keepdims=True)
    back = ways[:, -1] + reach * np.where(rests, along, -along)
    ends = times[:, -1:] + reach / speed_back
    return np.concatenate([ways, back[:, None]], axis=1), np.concatenate([times, ends], axis=1)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bench:
    """The task's own laboratory: its part on its film, between its walls, with errors that were drawn."""

    setup: Setup
    draws: Draws
    film: Film
    outlines: Floats
    """(1|N, V, 2) m."""
    engine: Engine = "stepper"
    step: float = STEP

    @classmethod
    def of(cls, setup: Setup, draws: Draws, **rest: Any) -> Self:
        """With the parts and films that the draws make."""
        film, outlines = film_of(setup, draws), true_outlines(setup, draws)
        return cls(setup=setup, draws=draws, film=film, outlines=outlines, **rest)

    def sense(self, k: int, poses: Floats, going: Flags) -> Floats:
        """(N, 3) true poses plus the errors drawn."""
        return poses + self.draws.sensing[:, k]

    def place(self, k: int, order: Order) -> Floats:
        """(N, P, 2) tips as commanded plus the probes' errors."""
        tips = order.commands.tips
        return np.asarray(tips + self.draws.of_tips(k, tips.shape[1]))

    def ways(self, k: int, order: Order) -> Floats:
        """(N, L + 1, P, 2) the ways that the draws make of the commands."""
        travel = order.commands.travel
        return true_ways(self.setup, self.draws, k, self.place(k, order), travel)

    def radii(self, order: Order) -> Floats:
        """(1|N, P) m."""
        return drawn_radii(self.draws, order)

    def friction(self, k: int, order: Order) -> Floats:
        """(N, 1, 1) of all tips in the whole move, or (N, L, P) of each in each leg."""
        if self.draws.tip_friction is None:
            return self.draws.friction[:, None, None]
        return _of_names(self.draws.tip_friction[:, k], order.names)

    def push(
        self, k: int, order: Order, runs: Which, poses: Floats, ways: Floats, record: int
    ) -> Pushed:
        """Pushes along straight legs by an engine of the simulator."""
        friction, radii, outlines = self.friction(k, order)[runs], self.radii(order), self.outlines
        push = Push.along(
            vertices=outlines[runs] if len(outlines) > 1 else outlines[0],
            poses=poses,
            ways=ways,
            friction=np.broadcast_to(friction, (len(friction), ways.shape[1] - 1, ways.shape[2])),
            radii=radii[runs] if len(radii) > 1 else radii,
            support=self.film.some(runs),
            step=self.step,
            fixture=walls(self.setup),
        )
        return push_all(push, self.engine, record)


def drawn_radii(draws: Draws, order: Order) -> Floats:
    """Radii of the tips that make a move.

    Parameters
    ----------
    draws
        What was drawn.
    order
        The move.

    Returns
    -------
    Floats
        (1|N, P) m.
    """
    if draws.radii is None:
        return np.zeros((1, order.names.shape[-1]))
    return _of_names(draws.radii, order.names)


def _of_names(values: Floats, names: npt.NDArray[np.int64]) -> Floats:
    """(N, ..., P) of the tips of a move what (N, ..., TIPS) says of all."""
    if names.ndim == 1:
        return values[..., names]
    middle = (1,) * (values.ndim - 2)
    return np.take_along_axis(values, names.reshape(len(names), *middle, names.shape[1]), axis=-1)


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


def by_rules(rules: Sequence[MoveRule], setup: Setup, draws: Draws) -> tuple[Decide, ...]:
    """Rounds of a plan whose moves follow from the pose sensed before them.

    Parameters
    ----------
    rules, setup
        The plan and the task.
    draws
        With the true spacing and misalignment of the active probe's two tips in each run.

    Returns
    -------
    tuple
        One round a rule, for `carry_out`.
    """
    return tuple(partial(_by_rule, rule, setup, draws) for rule in rules)


def _by_rule(
    rule: MoveRule, setup: Setup, draws: Draws, sensed: Floats, going: Flags
) -> tuple[Order, ...]:
    commands = rule.commands(sensed, spacing_of(setup, draws), draws.misalignment)
    return (Order(runs=going, commands=commands, names=tips_of(names_of(rule))),)


def spacing_of(setup: Setup, draws: Draws) -> Floats:
    """(1|N,) true distance of the active tips across the push, m."""
    stated = np.array([setup.stated_spacing.mid])
    return stated if draws.spacing is None else stated + draws.spacing


def tips_of(names: Sequence[str]) -> npt.NDArray[np.int64]:
    """(P,) places in ``NAMES``; a probe of another name counts as the single one."""
    return np.array([NAMES.index(name) if name in NAMES else TIPS - 1 for name in names])


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
    bench = Bench.of(setup, draws, engine=engine, step=step)
    return carry_out(by_rules(rules, setup, draws), bench, draws.start, record)


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
