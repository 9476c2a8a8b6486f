"""The job behind ``simulate``: the nominal run, samples, the worst found, a witness replayed."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from meso_robust.laboratory.adversary import search
from meso_robust.laboratory.open_loop import OpenLoop
from meso_robust.laboratory.replay import Feedback, Player, miss, nominal_row
from meso_robust.laboratory.running import PlanRun, excess
from meso_robust.laboratory.witness import Witness
from meso_robust.planning.document import PlanDocument
from meso_robust.planning.rules import rules_of
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.stages import Doing, quietly
from meso_robust.task import Task
from meso_robust.types import Floats
from meso_robust.wording import counted

RECORD = 96  # intervals of each move that are kept of every run
SEEDS = 32  # worst samples that the adversary starts from


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Case:
    """One row of uncertain values, and the outcome of its run."""

    row: Floats
    """(1, D)"""
    runs: PlanRun


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Simulated:
    """Everything that ``simulate`` found out."""

    task: Task
    plan: PlanDocument
    player: Player
    seed: int
    rows: Floats
    """(N, D) what was uncertain in the sampled runs."""
    sampled: PlanRun
    nominal: Case
    worst: Case | None
    evaluations: int
    """Runs of the adversary."""
    witness: Case | None

    @property
    def cases(self) -> tuple[tuple[str, Case], ...]:
        """The runs that were made by themselves, with their names."""
        named = (("nominal", self.nominal), ("worst", self.worst), ("witness", self.witness))
        return tuple((name, case) for name, case in named if case is not None)


def player_of(plan: PlanDocument, setup: Setup) -> Feedback | OpenLoop:
    """A plan as something to be run.

    Parameters
    ----------
    plan, setup
        The plan and its task.

    Returns
    -------
    Feedback or OpenLoop
        Its policy if it has one, else its moves as they are.
    """
    if plan.policy:
        return Feedback(rules=rules_of(plan), setup=setup)
    return OpenLoop(moves=plan.moves, setup=setup)


def simulated(
    task: Task,
    plan: PlanDocument,
    player: Player,
    *,
    samples: int,
    seed: int,
    adversarial: bool = False,
    witness: Witness | None = None,
    doing: Doing = quietly,
) -> Simulated:
    """Run a plan.

    Parameters
    ----------
    task, plan, player
        The task, the plan, and the plan made ready by ``player_of``.
    samples, seed
        Random runs, and the seed of their draws.
    adversarial
        Whether to search for the worst run.
    witness
        A run to be replayed, by the engine that made it.
    doing
        Shows what is being done while a stage runs.

    Returns
    -------
    Simulated
        The nominal run, the random ones, and the worst and the witness if they were asked for.
    """
    rng = np.random.default_rng(seed)
    with doing(
        f"simulating {counted(samples, 'run')} (the first run compiles kernels: about a minute)"
    ):
        nominal = _case(player, nominal_row(player))
        rows = player.draw(samples, rng)
        sampled = player.run(rows, record=RECORD)
    worst = None
    if adversarial:
        with doing("searching for the worst run"):
            worst = search(player, _worst_first(player, rows, sampled)[:SEEDS], rng)
    return Simulated(
        task=task,
        plan=plan,
        player=player,
        seed=seed,
        rows=rows,
        sampled=sampled,
        nominal=nominal,
        worst=None if worst is None else _case(player, worst.row[None]),
        evaluations=0 if worst is None else worst.evaluations,
        witness=None if witness is None else _case(_by(task, player, witness), witness.row),
    )


def _by(task: Task, player: Player, witness: Witness) -> Player:
    """The plan as it was run for a witness: by the same engine, the same uncertainties scaled."""
    setup = player.setup if witness.factor == 1.0 else setup_of(task, witness.factor)
    if isinstance(player, Feedback):
        return replace(player, setup=setup, engine=witness.engine)
    return replace(player, setup=setup)  # type: ignore[type-var]


def _case(player: Player, row: Floats) -> Case:
    return Case(row=row, runs=player.run(row, record=RECORD))


def _worst_first(player: Player, rows: Floats, runs: PlanRun) -> Floats:
    return rows[order(runs, player.setup)]


def order(runs: PlanRun, setup: Setup) -> npt.NDArray[np.int64]:
    """Runs from the worst to the best.

    Parameters
    ----------
    runs, setup
        N runs, and their task.

    Returns
    -------
    npt.NDArray
        (N,) indices: those that ended early first, then by falling miss.
    """
    return np.argsort(-np.nan_to_num(miss(runs, setup), nan=np.inf), kind="stable")


def in_goal(runs: PlanRun, setup: Setup) -> npt.NDArray[np.bool_]:
    """Which runs do what the plan is for.

    Parameters
    ----------
    runs, setup
        N runs, and their task.

    Returns
    -------
    npt.NDArray
        (N,) whether a run was completed and ended in the goal.
    """
    return runs.completed & (excess(runs.final, setup.goal) == 0.0).all(axis=1)
