"""The paper's task at another size: what is proved of it, and how it runs with and without adhesion."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from meso_robust.bounds import Verdict
from meso_robust.certificates.chain import certify
from meso_robust.certificates.words import words
from meso_robust.laboratory.draws import draw
from meso_robust.laboratory.engines import Pushed, push_all
from meso_robust.laboratory.running import (
    Bench,
    Order,
    Which,
    by_rules,
    carry_out,
    there_and_back,
    walls,
)
from meso_robust.laboratory.simulation import in_goal
from meso_robust.planning.compose import robust_at
from meso_robust.primitives.move import Aim, MoveRule
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.simulator import Effects, Push
from meso_robust.task import Task
from meso_robust.types import Flags, Floats
from meso_robust.units import UM

Errors = Literal["scaled", "camera stays", "camera and probe stay"]

STEP = 2e-6  # m, of the probes at full size
TIME_STEP = 0.02  # s, at full size
SPEED = 75.0 * UM  # m/s of a push; Section V, the middle one of three
WITHDRAWAL = 1.7e-3  # m/s; the manipulator's fastest, Section IV
WAY_BACK = 0.25  # of the part's length
LEAST, LARGEST, HALVINGS = 0.02, 8.0, 9  # of the factor on all uncertainties


def shrunk(task: Task, size: float, errors: Errors) -> Task:
    """The task with every length times ``size`` and the goal's tolerance with it.

    Errors of position either shrink as well, or stay as they are: of the camera, whose pixel stays a
    pixel, or also of the probe, which is placed by that camera. Of a camera that stays, the error of
    the orientation grows as the part shrinks, because it is seen over a shorter edge.
    """
    u, probe, goal, start = task.uncertainty, task.probe, task.goal, task.start
    seen, placed, part = size, size, task.rectangle("another size")
    if errors != "scaled":
        seen = 1.0
    if errors == "camera and probe stay":
        placed = 1.0
    return task.model_copy(
        update={
            "part": part.model_copy(
                update={"length_um": size * part.length_um, "width_um": size * part.width_um}
            ),
            "start": start.model_copy(
                update={"x_um": size * start.x_um, "y_um": size * start.y_um}
            ),
            "goal": goal.model_copy(
                update={
                    "x_um": size * goal.x_um,
                    "y_um": size * goal.y_um,
                    "position_tolerance_um": size * goal.position_tolerance_um,
                }
            ),
            "probe": probe.model_copy(update={"tip_spacing_um": size * probe.tip_spacing_um}),
            "uncertainty": u.model_copy(
                update={
                    "sensed_position_um": seen * u.sensed_position_um,
                    "sensed_orientation_deg": seen / size * u.sensed_orientation_deg,
                    "probe_position_um": placed * u.probe_position_um,
                    "film_ratio_um2": size**2 * u.film_ratio_um2,
                }
            ),
        }
    )


def shrunk_rules(rules: Sequence[MoveRule], size: float) -> tuple[MoveRule, ...]:
    """A plan with all offsets and travels times ``size``."""

    def less(aim: Aim) -> Aim:
        return replace(aim, offset_um=size * aim.offset_um)

    return tuple(
        replace(
            rule,
            dual=replace(rule.dual, x=less(rule.dual.x), y=less(rule.dual.y)),
            dual_end=less(rule.dual_end),
            single=rule.single
            and replace(rule.single, x=less(rule.single.x), y=less(rule.single.y)),
        )
        for rule in rules
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Certified:
    """What is proved at one size."""

    rules: tuple[MoveRule, ...]
    proved: bool
    margin: float
    """Largest factor on all uncertainties at which the plan is proved; 0 if below ``LEAST``."""
    reason: str
    """The first inequality that is open; empty if proved."""


def planned_at(task: Task, size: float, errors: Errors) -> tuple[MoveRule, ...] | None:
    """A robust plan for the shrunk task, if one is found.

    The planner keeps distances of a few um from the part, which it should not at 100 um; so it plans
    at full size with errors that are larger by as much, and its plan is shrunk.
    """
    alike = shrunk(shrunk(task, size, errors), 1.0 / size, "scaled")
    # the errors alone are meant: what rounding has left of the lengths is put back
    alike = task.model_copy(update={"uncertainty": alike.uncertainty})
    found = robust_at(alike, 1.0)
    return None if found is None else shrunk_rules(found, size)


def certified_at(
    task: Task, size: float, errors: Errors, plans: Sequence[Sequence[MoveRule]]
) -> Certified:
    """The one of the plans that bears most, certified on the shrunk task itself.

    Parameters
    ----------
    task, size, errors
        As `shrunk`.
    plans
        Plans for the shrunk task, at least one.
    """
    small = shrunk(task, size, errors)
    margins = [_margin(rules, small) for rules in plans]
    best = int(np.argmax(margins))
    chain = certify(plans[best], setup_of(small))
    proved = chain.verdict is Verdict.PROVED
    step, name, _ = chain.first_open
    return Certified(
        rules=tuple(plans[best]),
        proved=proved,
        margin=max(margins[best], 1.0) if proved else margins[best],
        reason="" if proved else f"{step.rule.action}: {words(name)}",
    )


def _margin(rules: Sequence[MoveRule], task: Task) -> float:
    def proved(factor: float) -> bool:
        found = certify(rules, setup_of(task, factor), whole=False)
        return found.verdict is Verdict.PROVED

    if not proved(LEAST):
        return 0.0
    low, high = math.log(LEAST), math.log(LARGEST)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if proved(math.exp(middle)) else (low, middle)
    return math.exp(low)


def adhering(
    rules: Sequence[MoveRule], setup: Setup, size: float, pull_um_s: float, runs: int, seed: int
) -> Flags:
    """(runs,) whether a plan ends in the goal while the tips pull at the part they touch.

    After each move the tips withdraw the way they came, a quarter of the part's length, at the
    manipulator's fastest, and the pull acts until a meniscus of 2 um at full size breaks.

    Parameters
    ----------
    rules, setup, size
        Plan and task, both shrunk by the size.
    pull_um_s
        Adhesion of one tip over the part's drag; 0 for none.
    runs, seed
        Draws of all uncertainties.
    """
    draws = draw(setup, len(rules), runs, np.random.default_rng(seed))
    bench = _AdheringBench.of(setup, draws, size=size, pull_um_s=pull_um_s)
    done = carry_out(by_rules(rules, setup, draws), bench, draws.start)
    return in_goal(done, setup)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _AdheringBench(Bench):
    """The task's laboratory at another size, with tips that pull at the part they touch."""

    size: float
    pull_um_s: float

    def push(
        self, k: int, order: Order, runs: Which, poses: Floats, ways: Floats, record: int
    ) -> Pushed:
        """There and some way back; the passive tip backs off to its own side."""
        reach = WAY_BACK * 2.0 * self.setup.half_length.mid
        waypoints, times = there_and_back(ways, SPEED, reach, WITHDRAWAL)
        effects = Effects()
        if self.pull_um_s > 0.0:
            meniscus = {"pull_um_s": self.pull_um_s, "range_um": 2.0 * self.size}
            effects = Effects({"tip_adhesion": meniscus})
        push = Push(
            vertices=self.outlines[0],
            poses=poses,
            waypoints=waypoints,
            times=times,
            friction=self.draws.friction[runs],
            support=self.film.some(runs),
            effects=effects,
            fixture=walls(self.setup),
            step=STEP * self.size,
            time_step=TIME_STEP * self.size,
        )
        return push_all(push, self.engine, record)
