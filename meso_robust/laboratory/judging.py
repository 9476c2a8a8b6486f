"""Runs by either engine held against the claims, each engine with the accuracy that it has."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from meso_robust.laboratory.claim_ids import Claim
from meso_robust.laboratory.claims import Accuracy, Claims, broken
from meso_robust.laboratory.draws import some
from meso_robust.laboratory.replay import Feedback
from meso_robust.laboratory.running import STEP, PlanRun
from meso_robust.simulator import Outcome
from meso_robust.types import Flags, Floats

INSTANTS = 16  # intervals of each move at which its tube is looked at
ROUNDING = 1e-12  # m and rad: pose error of the event-driven engine
EXACT_SLIP = 1e-12  # m; a contact slips by as little if its friction is short by a thousandth
STEPPED_SLIP = 0.25  # steps: a step in which a contact closes also slips a little
HALVINGS = 5  # of the step, for a run that seems to break a claim
UNFINISHED = (Outcome.SOLVER_FAILURE, Outcome.OUT_OF_RANGE, Outcome.NON_UNIQUE)
"""Outcomes in which the engine gave up, which says nothing of the plan."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Judged:
    """N runs, and the claims that they break."""

    runs: PlanRun
    broken: dict[Claim, Flags]
    """(N,) by claim; see ``claims.broken``."""
    repeated: int
    """Runs of the stepper that were repeated at half the step before they were judged."""
    stuck: Flags
    """(N,) runs that seemed to break a claim and could not be finished at a finer step."""

    @property
    def unfinished(self) -> Flags:
        """(N,) runs that their engine could not finish, which says nothing of the plan."""
        return np.isin(self.runs.outcomes, UNFINISHED) | self.stuck

    @property
    def any_broken(self) -> Flags:
        """(N,) whether a run breaks any claim."""
        none = np.zeros(len(self.runs.outcomes), dtype=bool)
        return np.logical_or.reduce([none, *self.broken.values()])


def judge(player: Feedback, claims: Claims, rows: Floats, step: float = STEP) -> Judged:
    """Run a plan and hold the runs against what is claimed of them.

    Parameters
    ----------
    player
        The plan and its engine.
    claims
        What is claimed.
    rows
        (N, D) what is uncertain in each run.
    step
        Longest probe displacement of a step of the stepper, m.

    Returns
    -------
    Judged
        The runs, and which claims each of them breaks.

    Notes
    -----
    A run of the stepper that seems to break a claim is repeated at half the step, with the change of
    its own poses as their accuracy, and so on: it breaks the claim if it still does so after
    ``HALVINGS``. Some certified boxes are as tight as rounding allows, and the error of a step leaves
    them; that error need not shrink with every halving, as it depends on where in its step a contact
    closes.
    """
    moves, none = len(player.rules), np.zeros(len(rows), dtype=bool)
    exact = (np.full((1, 3), ROUNDING),) * moves
    if player.engine == "events":
        found = player.run(rows, record=INSTANTS)
        accuracy = Accuracy(slip=EXACT_SLIP, pose=exact)
        return Judged(runs=found, broken=broken(found, claims, accuracy), repeated=0, stuck=none)
    found = player.run(rows, record=INSTANTS, step=step)
    accuracy = Accuracy(slip=STEPPED_SLIP * step, pose=exact)
    first = Judged(runs=found, broken=broken(found, claims, accuracy), repeated=0, stuck=none)
    suspects = np.flatnonzero(first.any_broken)
    flags, repeated, coarse = first.broken, suspects.size, _of(found, suspects)
    stuck = none.copy()
    for _ in range(HALVINGS):
        if not suspects.size:
            break
        step = 0.5 * step
        fine = player.run(rows[suspects], record=INSTANTS, step=step)
        accuracy = Accuracy(slip=STEPPED_SLIP * step, pose=_changes(coarse, fine))
        again = broken(fine, claims, accuracy)
        flags = {claim: np.zeros(len(rows), dtype=bool) for claim in again}
        for claim, breaks in again.items():
            flags[claim][suspects] = breaks
        stuck[suspects] = np.isin(fine.outcomes, UNFINISHED)
        left = np.logical_or.reduce(list(again.values()))
        suspects, coarse = suspects[left], _of(fine, np.flatnonzero(left))
    return replace(first, broken=flags, repeated=int(repeated), stuck=stuck)


def _changes(coarse: PlanRun, fine: PlanRun) -> tuple[Floats, ...]:
    """Per move (N, 3) the largest change of any pose of a run, and rounding."""
    return tuple(
        ROUNDING + np.abs(new.path - old.path).max(axis=1)
        for new, old in zip(fine.moves, coarse.moves, strict=True)
    )


def _of(runs: PlanRun, rows: npt.NDArray[np.int64]) -> PlanRun:
    """Some of the runs."""
    return PlanRun(
        moves=tuple(some(move, rows) for move in runs.moves),
        outcomes=runs.outcomes[rows],
        failed_in=runs.failed_in[rows],
    )
