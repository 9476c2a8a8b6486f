"""How far out and how long a plan goes: whether it keeps the budget that bounds were computed for."""

from __future__ import annotations

import itertools
import math

import numpy as np

from meso_robust import units
from meso_robust.certificates.chain import Chain
from meso_robust.primitives.obligation import Step
from meso_robust.task import Task
from meso_robust.transfer.inflation import Budget
from meso_robust.transfer.running import HANDLING_S

_ROUNDING = 1.0 + 1e-9  # of lengths and times that are computed in plain doubles


def needed(chain: Chain, task: Task, slender: float) -> Budget:
    """What the certified steps need, with everything that is added to a sensed pose.

    Parameters
    ----------
    chain
        The steps, as far as they go, and all poses on the way.
    task
        The task that they were certified for: its bound of sensing holds all that is added.
    slender
        Of the film, as in `Budget`.
    """
    added = math.sqrt(2.0) * task.uncertainty.sensed_position_um
    radius = max(_farthest(step) for step in chain.steps)
    speed = task.probe.speed_um_s
    seconds = sum(_travel_um(step, chain, task) / speed + HANDLING_S for step in chain.steps)
    return Budget(
        radius_um=(radius + added) * _ROUNDING,
        seconds=seconds * _ROUNDING,
        ratio_um2=largest_ratio(task),
        slender=slender,
    )


def largest_ratio(task: Task) -> float:
    """Of rotational to translational drag that a task allows, um^2."""
    u = task.uncertainty
    return u.film_ratio_um2 * (1.0 + 0.01 * u.film_ratio_percent) * _ROUNDING


def _farthest(step: Step) -> float:
    """Largest distance of the part's centre from the world's origin in a move, um."""
    boxes = [step.pre, *(knot.box for knot in step.tube)] + ([step.post] if step.post else [])
    return max(
        math.hypot(*(units.to_um(max(-side.lo, side.hi)) for side in (box.x, box.y)))
        for box in boxes
    )


def _travel_um(step: Step, chain: Chain, task: Task) -> float:
    """Longest travel of a probe in a move: commands are affine in what is sensed."""
    error = chain.setup.uncertainty.sensed_position
    sides = [(side - error, side + error) for side in (step.pre.x, step.pre.y)]
    corners = itertools.product(*((low.lo, high.hi) for low, high in sides))
    sensed = np.array([(x, y, step.pre.theta.mid) for x, y in corners])
    commands = step.rule.commands(sensed, chain.setup.spacing.mid, np.zeros(len(sensed)))
    return units.to_um(float(np.abs(commands.travel).sum(axis=2).max()))


def enough(budget: Budget, need: Budget) -> bool:
    """Whether a plan keeps within its budget."""
    return need.radius_um <= budget.radius_um and need.seconds <= budget.seconds


def roomier(need: Budget) -> Budget:
    """A budget for another try: a little more than was needed."""
    return Budget(
        radius_um=float(math.ceil(1.02 * need.radius_um)),
        seconds=float(math.ceil(1.05 * need.seconds)),
        ratio_um2=need.ratio_um2,
        slender=need.slender,
    )
