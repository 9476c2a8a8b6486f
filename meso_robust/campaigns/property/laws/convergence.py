"""The LCP stepper converges to the event-driven engine as its step is halved."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from meso_robust.campaigns.property.law import Breach, Cost, Property, Silence, Verdict
from meso_robust.campaigns.property.laws.moves import UM, Move, moves, push_of
from meso_robust.simulator import Outcome, simulate
from meso_robust.simulator.exact import exact
from meso_robust.types import Floats

PER_STEP = 20.0
"""Largest error of the last pose over the step; 0.03 is common, 1.7 is passed by one move in 1,000, 5 by
one in 10,000 (tips that slide on opposite edges amplify it)."""
COARSE = 0.0625 * UM
HALVINGS = 4
"""How often a step is halved until the error is that small at two steps in succession."""
SHIFT = 0.25 * UM
"""Of the tips across the push, to see whether the motion hangs on so little: on a tip that just meets
or just misses a corner of the part."""
STEADY = 50.0
"""Largest change of the last pose, over the shift, of a motion that does not."""


def apart(one: Floats, other: Floats, size: float) -> float:
    """Distance of two poses, m: of their positions, plus ``size`` times that of their angles."""
    away = one - other
    return float(np.hypot(away[0], away[1]) + size * abs(away[2]))


def check(move: Move) -> Verdict:
    """Halve the step until stepper and event-driven engine agree twice in succession."""
    push = push_of(move)
    found = exact(push)
    wanted = Outcome(int(found.outcomes[0]))
    if wanted is not Outcome.COMPLETED:
        return Silence(f"the event-driven engine ends as {wanted.name}")
    if _hangs_on_little(move, found.poses[0]):
        return Silence("the motion hangs on less than 0.25 um")
    before, seen = False, []
    for halving in range(HALVINGS + 1):
        step = COARSE / 2**halving
        taken = simulate(replace(push, step=step))
        outcome = Outcome(int(taken.outcomes[0]))
        error = apart(taken.poses[0], found.poses[0], move.size) / step
        agrees = outcome == wanted and error <= PER_STEP
        if agrees and before:
            return None
        before = agrees
        seen.append(f"{outcome.name} {error:.3g}")
    return Breach(
        what="convergence: the stepper comes to the event-driven engine's pose",
        detail=f"outcome, and error over the step, as it is halved: {', '.join(seen)}",
    )


def _hangs_on_little(move: Move, pose: Floats) -> bool:
    """Whether tips that are shifted a little, together or apart, move the part quite differently."""
    for one, other in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        found = exact(push_of(_shifted(move, one * SHIFT, other * SHIFT)))
        if found.outcomes[0] != Outcome.COMPLETED:
            return True
        if apart(found.poses[0], pose, move.size) > STEADY * SHIFT:
            return True
    return False


def _shifted(move: Move, one: float, other: float) -> Move:
    """The pushing tip shifted across the push by about ``one``, the passive one by ``other``, m."""
    rest = move.passive
    return replace(
        move,
        height=move.height + one / move.size,
        passive=None if rest is None else replace(rest, height=rest.height + other / move.size),
    )


CONVERGENCE = Property(
    name="stepper-converges",
    statement=(
        "As its step is halved, the LCP stepper comes to complete every move that the event-driven "
        "engine completes, at the same pose."
    ),
    agreement=(
        "first order: at two steps in succession, of 62 nm or smaller down to 4 nm, the pose is off "
        "by at most 20 steps (angles times the part's radius); friction up to 0.5, beyond which motions "
        "between opposite tips are often not unique; nothing is said where tips that are shifted by about "
        "0.25 um move the part quite differently"
    ),
    examples=moves,
    check=check,
    cost=Cost.MODERATE,
)
