"""The certified plan of the paper's task, run at any size of its uncertainties."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from types import MappingProxyType

import numpy as np

from meso_robust.bounds import Interval
from meso_robust.certificates.chain import Chain, certify
from meso_robust.laboratory.draws import draw
from meso_robust.laboratory.running import STARTS_INSIDE, PlanRun, run
from meso_robust.laboratory.simulation import in_goal
from meso_robust.planning.compose import compose
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import ALWAYS_STATED, PoseBox, Setup, setup_of
from meso_robust.simulator import Outcome
from meso_robust.task import Task, load_task
from meso_robust.tasks import PAPER
from meso_robust.types import Flags

UNCERTAINTIES = ALWAYS_STATED
"""What is uncertain, by the names that scale factors are given for."""
AS_STATED: Mapping[str, float] = MappingProxyType({})
LARGEST = 8.0
"""Factors beyond it are not tried; friction then reaches 0.09, a probe's error half the goal."""
HALVINGS = 7  # of log(factor): resolves 1.6 %


@dataclass(frozen=True, slots=True, kw_only=True)
class CertifiedPlan:
    """A plan, and what is proved of it."""

    task: Task
    setup: Setup
    rules: tuple[MoveRule, ...]
    chain: Chain


@cache
def certified_plan() -> CertifiedPlan:
    """The plan of the shipped task, planned and certified now; kept for further calls."""
    task = load_task(PAPER)
    rules, setup = compose(task).rules, setup_of(task)
    return CertifiedPlan(task=task, setup=setup, rules=rules, chain=certify(rules, setup))


def scaled(setup: Setup, scales: Mapping[str, float]) -> Setup:
    """The task with each named uncertainty widened about its middle; for runs, not for proofs.

    Raises
    ------
    ValueError
        If a name is none of ``UNCERTAINTIES``, or friction or drag might not be positive.
    """
    unknown = sorted(set(scales) - set(UNCERTAINTIES))
    if unknown:
        raise ValueError(f"scales: {', '.join(unknown)}; must be of {', '.join(UNCERTAINTIES)}")
    u = setup.uncertainty
    for name, factor in scales.items():
        u = u.scaled(factor, name)
    if not (u.friction.lo >= 0.0 and u.film_ratio.lo > 0.0):
        raise ValueError(f"scales: {dict(scales)}; leave a range that is not positive; lower them")
    x, y, theta = (Interval.point(value) for value in setup.start.mid)
    start = PoseBox(
        x=x - u.sensed_position, y=y - u.sensed_position, theta=theta - u.sensed_orientation
    )
    return replace(setup, uncertainty=u, start=start)


def trials(
    rules: Sequence[MoveRule], setup: Setup, runs: int, seed: int, record: int = 0
) -> PlanRun:
    """Run a plan over draws of all uncertainties, half of them uniform and half at corners."""
    draws = draw(setup, len(rules), runs, np.random.default_rng(seed))
    return run(rules, setup, draws, record=record, engine="events")


def certified_successes(runs: int, seed: int, scales: Mapping[str, float] = AS_STATED) -> Flags:
    """(runs,) whether the certified plan ends in the goal, over draws of the uncertainties.

    Parameters
    ----------
    runs, seed
        How many, and the seed of the draws: of the same seed they differ by the scales only.
    scales
        Factors on the ranges of uncertainties by name; 1 for those that are not named.

    Raises
    ------
    ValueError
        As `scaled`.
    """
    plan = certified_plan()
    found = trials(plan.rules, scaled(plan.setup, scales), runs, seed)
    return in_goal(found, plan.setup)


@dataclass(frozen=True, slots=True, kw_only=True)
class Failure:
    """The smallest factor found on one uncertainty at which a run fails."""

    name: str
    factor: float | None
    """None if every run succeeds at ``LARGEST``."""
    why: str
    """How the runs that fail there end."""


def first_failure(name: str, runs: int, seed: int) -> Failure:
    """Widen one uncertainty alone until one of the runs of the certified plan fails.

    Bisection over the factor on the same draws, so the answer is an upper end of what the plan bears:
    other draws may fail earlier.

    Raises
    ------
    ValueError
        As `scaled`; or if runs fail at the stated size already.
    """
    plan = certified_plan()

    def failing(factor: float) -> str:
        setup = scaled(plan.setup, {name: factor})
        return how_runs_fail(trials(plan.rules, setup, runs, seed), plan.setup)

    if failing(1.0):
        raise ValueError(f"{name}: runs fail at the stated uncertainty already")
    bad = failing(LARGEST)
    if not bad:
        return Failure(name=name, factor=None, why="")
    low, high = 0.0, math.log(LARGEST)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        here = failing(math.exp(middle))
        low, high, bad = (low, middle, here) if here else (middle, high, bad)
    return Failure(name=name, factor=math.exp(high), why=bad)


def how_runs_fail(runs: PlanRun, setup: Setup) -> str:
    """How many runs fail, in which move and how; empty if all end in the goal."""
    hit = in_goal(runs, setup)
    kinds = [(int(runs.failed_in[k]), int(runs.outcomes[k])) for k in np.flatnonzero(~hit)]
    return "; ".join(f"{kinds.count(kind)} x {_words(*kind)}" for kind in sorted(set(kinds)))


def _words(move: int, outcome: int) -> str:
    if outcome == Outcome.COMPLETED:
        return "the last pose misses the goal"
    if outcome == STARTS_INSIDE:
        return f"move {move + 1}: a probe would start inside the part"
    return f"move {move + 1}: {Outcome(outcome).name.lower().replace('_', ' ')}"
