"""A plan as something to be run: each run is a row of numbers, one for everything uncertain.

A plan with a policy is run as a feedback policy, one without as the moves it states. Both take the
same rows and give the same kind of result, so that sampling, searching and showing need not know
which is which.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from meso_robust.bounds import Interval
from meso_robust.laboratory.draws import Draws, draw, is_open, nominal
from meso_robust.laboratory.engines import Engine
from meso_robust.laboratory.running import STEP, PlanRun, run
from meso_robust.planning.document import NAMES, names_of
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import Setup
from meso_robust.types import Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """Something uncertain."""

    name: str
    """Name with its SI unit, such as ``friction`` or ``move 2 dtp x_m``."""
    low: float
    high: float
    mid: float


class Player(Protocol):
    """A plan that can be run."""

    @property
    def setup(self) -> Setup:
        """The task."""

    @property
    def primitives(self) -> tuple[str, ...]:
        """Name of each move's primitive."""

    @property
    def probes(self) -> tuple[tuple[str, ...], ...]:
        """Names of each move's probes."""

    @property
    def columns(self) -> tuple[Column, ...]:
        """Everything uncertain, in the order of a row."""

    def draw(self, runs: int, rng: np.random.Generator) -> Floats:
        """(N, D) random rows: the first half uniform over the box, the second half at corners."""

    def run(self, rows: Floats, *, record: int = 0, step: float = STEP) -> PlanRun:
        """Run the plan once for every row; see ``laboratory.running.run``."""


def nominal_row(player: Player) -> Floats:
    """The run without errors as a row.

    Parameters
    ----------
    player
        The plan.

    Returns
    -------
    Floats
        (1, D) every error zero and every range at its middle.
    """
    return np.array([[column.mid for column in player.columns]])


def limits(player: Player) -> tuple[Floats, Floats]:
    """The box of everything uncertain.

    Parameters
    ----------
    player
        The plan.

    Returns
    -------
    tuple
        (D,) lower and (D,) upper ends, SI.
    """
    columns = player.columns
    return np.array([c.low for c in columns]), np.array([c.high for c in columns])


@dataclass(frozen=True, slots=True, kw_only=True)
class Slot:
    """A column, and the number of the draws that it is."""

    column: Column
    field: str
    """Of ``Draws``."""
    at: tuple[int, ...] = ()
    """Where in a run's part of the field."""


def slots_of_a_run(setup: Setup) -> tuple[Slot, ...]:
    """What is constant during a run; of friction, film and misalignment also what is exact."""
    s, u = setup.start, setup.uncertainty
    found = [
        _slot("start x_m", s.x, "start", 0),
        _slot("start y_m", s.y, "start", 1),
        _slot("start theta_rad", s.theta, "start", 2),
    ]
    if setup.friction_common or not is_open(u.friction):
        found.append(_slot("friction", u.friction, "friction"))
    found.append(_slot("film_ratio_m2", u.film_ratio, "film_ratio"))
    found.append(_slot("misalignment_rad", u.misalignment, "misalignment"))
    rest = [_slot("tip_spacing_m", u.tip_spacing, "spacing")]
    radii = (u.tip_radius, u.tip_radius, u.passive_tip_radius)
    for tip, (name, range_) in enumerate(zip(NAMES, radii, strict=True)):
        rest.append(_slot(f"{name} radius_m", range_, "radii", tip))
    for edge in range(len(setup.outline.corners)):
        rest.append(_slot(f"edge {edge + 1} out_m", u.size, "edges", edge, 0))
        rest.append(_slot(f"edge {edge + 1} turned_rad", u.squareness, "edges", edge, 1))
    for axis, name in enumerate("xy"):
        rest.append(_slot(f"drag_centre {name}_m", u.drag_centre, "drag_centre", axis))
    for axis, name in enumerate(("along", "across")):
        rest.append(_slot(f"drag_anisotropy {name}", u.drag_anisotropy, "lay", axis))
    if is_open(u.drag_anisotropy):
        rest.append(_slot("drag_anisotropy of_stage", Interval(0.0, 1.0), "lay", 2))
    return (*found, *(slot for slot in rest if _is_open(slot)))


def slots_of_a_move(setup: Setup, k: int, names: tuple[str, ...], legs: int) -> tuple[Slot, ...]:
    """What may be uncertain of the ways and contacts of move ``k``, with tips of these names."""
    u, move = setup.uncertainty, f"move {k + 1}"
    rest = [_slot(f"{move} direction_rad", u.travel_direction, "direction", k)]
    rest.append(_slot(f"{move} scale", u.travel_scale, "scale", k))
    for leg in range(legs + 1):
        rest += of_a_point(f"{move} wander {leg}", u.probe_wander, "wander", k, leg)
    if not setup.friction_common:
        for leg in range(legs):
            rest += [
                _slot(f"{move} friction {leg + 1} {name}", u.friction, "tip_friction", k, leg, tip)
                for tip, name in enumerate(NAMES)
                if name in names
            ]
    return tuple(slot for slot in rest if _is_open(slot))


def _is_open(slot: Slot) -> bool:
    return slot.column.high > slot.column.low


def _slot(name: str, range_: Interval, field: str, *at: int) -> Slot:
    """One number that lies in ``range_``."""
    column = Column(name=name, low=range_.lo, high=range_.hi, mid=range_.mid)
    return Slot(column=column, field=field, at=at)


def of_a_point(name: str, range_: Interval, field: str, *at: int) -> list[Slot]:
    """The error of a position."""
    return [_slot(f"{name} {axis}_m", range_, field, *at, n) for n, axis in enumerate("xy")]


def rows_of(slots: Sequence[Slot], draws: Draws) -> Floats:
    """(N, D) draws as rows, number for number."""
    return np.column_stack([getattr(draws, s.field)[(slice(None), *s.at)] for s in slots])


def draws_of(slots: Sequence[Slot], rows: Floats, draws: Draws) -> Draws:
    """Draws into which the rows are written; what has no column stays."""
    for slot, values in zip(slots, rows.T, strict=True):
        getattr(draws, slot.field)[(slice(None), *slot.at)] = values
    return draws


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Feedback:
    """A policy: before each move the pose is sensed, and the commands follow from it."""

    rules: tuple[MoveRule, ...]
    setup: Setup
    engine: Engine = "stepper"
    """Which engine of the simulator makes the moves."""

    @property
    def primitives(self) -> tuple[str, ...]:
        """Name of each move's primitive."""
        return tuple(rule.primitive for rule in self.rules)

    @property
    def probes(self) -> tuple[tuple[str, ...], ...]:
        """Names of each move's probes."""
        return tuple(map(names_of, self.rules))

    @property
    def slots(self) -> tuple[Slot, ...]:
        """What bears on the runs; not the first sensing error, which follows from the start."""
        u, found = self.setup.uncertainty, list(slots_of_a_run(self.setup))
        legs = nominal(self.setup, 1).legs
        for k, names in enumerate(self.probes):
            if k > 0:
                at = f"move {k + 1} sensing"
                found += of_a_point(at, u.sensed_position, "sensing", k)
                found.append(_slot(f"{at} theta_rad", u.sensed_orientation, "sensing", k, 2))
            found += of_a_point(f"move {k + 1} dtp", u.probe_position, "dual", k)
            if NAMES[2] in names:
                found += of_a_point(f"move {k + 1} stp", u.probe_position, "single", k)
            found += slots_of_a_move(self.setup, k, names, legs)
        return tuple(found)

    @property
    def leading(self) -> int:
        """How many columns, the first ones, are start, friction, film ratio and misalignment."""
        fields = ("start", "friction", "film_ratio", "misalignment")
        return sum(slot.field in fields for slot in self.slots)

    @property
    def columns(self) -> tuple[Column, ...]:
        """The same without where it is kept."""
        return tuple(slot.column for slot in self.slots)

    def draw(self, runs: int, rng: np.random.Generator) -> Floats:
        """(N, D) the rows of ``laboratory.draws.draw``, so that a seed means the same everywhere."""
        return self.rows_of(draw(self.setup, len(self.rules), runs, rng))

    def run(self, rows: Floats, *, record: int = 0, step: float = STEP) -> PlanRun:
        """Run the policy once for every row."""
        draws = self.draws_of(rows)
        return run(self.rules, self.setup, draws, record=record, step=step, engine=self.engine)

    def rows_of(self, draws: Draws) -> Floats:
        """(N, D) draws as rows, number for number."""
        return rows_of(self.slots, draws)

    def draws_of(self, rows: Floats) -> Draws:
        """Rows as draws; errors of a probe that is not there are zero."""
        draws = draws_of(self.slots, rows, nominal(self.setup, len(self.rules), len(rows)))
        # the first pose is sensed as the task states it
        draws.sensing[:, 0] = np.array(self.setup.start.mid) - draws.start
        return draws


def miss(runs: PlanRun, setup: Setup) -> Floats:
    """How far runs end from the middle of the goal.

    Parameters
    ----------
    runs, setup
        N runs, and their task.

    Returns
    -------
    Floats
        (N,) largest of the three coordinates' distances in tolerances; within 1 is a hit, and NaN is a
        run that ended early.
    """
    low, high = setup.goal.ends
    away = np.abs(runs.final - 0.5 * (low + high)) / (0.5 * (high - low))
    return np.where(runs.completed, away.max(axis=1), np.nan)
