"""How a run ended: in which move, why, how far the probes got, and what they touched."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meso_robust.laboratory.geometry import gaps_to
from meso_robust.laboratory.replay import Player
from meso_robust.laboratory.running import (
    STARTS_INSIDE,
    STEP,
    WOULD_START_INSIDE,
    PlanRun,
)
from meso_robust.simulator import Outcome
from meso_robust.types import Floats

FINE = 4000  # instants at which the stop of a jammed move is looked for
NEAR = 2.0 * STEP  # m; the stepper leaves a gap of up to one step


@dataclass(frozen=True, slots=True, kw_only=True)
class Ending:
    """How one run ended."""

    outcome: str
    """``completed``, ``jam``, ``starts inside`` or the simulator's name of its own failure."""
    move: int | None
    """Index of the move that ended early, None if all were completed."""
    share: float
    """Part of that move (0 to 1) after which the probes stopped."""
    touching: tuple[str, ...]
    """Probes that held the part when it jammed."""


def words(outcome: str, touching: Sequence[str]) -> str:
    """What happened in a run, as a phrase.

    Parameters
    ----------
    outcome
        As in `Ending`.
    touching
        Names of the probes that held the part.

    Returns
    -------
    str
        For people; nothing compares it.
    """
    if outcome == "jam":
        return f"the part jammed at {' and '.join(touching) or 'the probes'}"
    if outcome == "starts inside":
        return WOULD_START_INSIDE
    return outcome if outcome == "completed" else f"simulator: {outcome}"


def ending(player: Player, runs: PlanRun, row: int) -> Ending:
    """How one run ended.

    Parameters
    ----------
    player, runs
        What was run, and N runs of it; how far a move got is told best of runs with a recorded path.
    row
        Which run.

    Returns
    -------
    Ending
        Why, in which move, how far into it, and which probes held the part.
    """
    code = int(runs.outcomes[row])
    if code == Outcome.COMPLETED:
        return Ending(outcome="completed", move=None, share=1.0, touching=())
    move = int(runs.failed_in[row])
    if code == STARTS_INSIDE:
        return Ending(outcome="starts inside", move=move, share=0.0, touching=())
    share, gaps = _stop(runs, row, move)
    held = [name for name, gap in zip(player.probes[move], gaps, strict=True) if gap < NEAR]
    return Ending(
        outcome=Outcome(code).word,
        move=move,
        share=share,
        touching=tuple(held) if code == Outcome.JAM else (),
    )


def _stop(runs: PlanRun, row: int, move: int) -> tuple[float, Floats]:
    """Part of the move after which a probe would enter the part where it lies, and all gaps there."""
    one = runs.moves[move]
    shares = np.linspace(0.0, 1.0, FINE + 1)
    shares = shares[shares >= _last_motion(one.path[row])]
    tips, of_all = one.tips_at(row, shares), np.zeros(len(shares), dtype=np.int64) + row
    gaps = gaps_to(tips, one.after[of_all], one.outlines[of_all], one.radii[of_all])
    # the linear steps of the simulator leave a gap of their own; half a step is the next one
    entered = np.flatnonzero((gaps < -0.5 * STEP).any(axis=1))
    at = int(entered[0]) if entered.size else len(shares) - 1
    return float(shares[at]), gaps[at]


def _last_motion(path: Floats) -> float:
    """Part of the move at the last recorded pose that is not yet the final one."""
    moving = np.flatnonzero((path != path[-1]).any(axis=1))
    return float(moving[-1] / (len(path) - 1)) if moving.size and len(path) > 1 else 0.0
