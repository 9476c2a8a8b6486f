r"""How fast a tip and the part, or a corner of the part and the fixture, come closer at most.

A tip comes closer to the part along the line to the point that is nearest, and turning about the
tip moves that point across it: so it does no faster than the tip moves against a part that was
large enough to carry it.
"""

from typing import TypeAlias

import numpy as np

from meso_robust.simulator.events.curve import STICKING, fastest_between
from meso_robust.simulator.events.fused import inlined, sealed
from meso_robust.simulator.events.scene import Scene, Work

Bound: TypeAlias = tuple[float, float, float, float, float]
"""Bound of the motion of the part on a curve: place of a point of it at the start and its constant
velocity (world frame), and how fast the part turns about it at most."""
Slopes: TypeAlias = tuple[float, float, float]

_BETWEEN = 0.5  # of the change in a step, by which a speed between its ends may exceed both
_ROUGH = 0.2  # of the fastest point of the part, likewise where the ends are alike
_CORNERS = 1.5  # a corner's speed in a step over the fastest point's at its ends


@sealed
def bound_on_curve(scene: Scene, work: Work, bound: Bound, end: float, clock: float) -> None:
    """Write the speeds on a curve of closed form.

    Parameters
    ----------
    scene, work
        The run.
    bound
        Of the motion of the part.
    end
        Length of the curve on the clock.
    clock
        The clock at its start.
    """
    x, y, vx, vy, turn = bound
    tips = scene.tips
    for i in range(tips.shape[0]):
        own = _length(tips[i, 2] - vx, tips[i, 3] - vy)
        lever = _length(tips[i, 0] + tips[i, 2] * clock - x, tips[i, 1] + tips[i, 3] * clock - y)
        scene.closing[i] = own + turn * (lever + own * end)
    scene.closing[tips.shape[0] :] = _length(vx, vy) + 2.0 * work.reach * turn


@inlined
def speed_between(
    scene: Scene, work: Work, body: int, span: tuple[float, float], clock: float
) -> float:
    """Bound of the speed of a tip in a part of a curve on which another sticks, else infinity.

    Parameters
    ----------
    scene, work
        The run.
    body
        Number of the tip.
    span
        The part of the curve, on the clock from its start.
    clock
        The clock at its start.
    """
    if work.curve[0] != STICKING or body >= scene.tips.shape[0]:
        return np.inf
    curve, tip = work.curve, scene.tips[body]
    ux, uy = tip[2] - curve[4], tip[3] - curve[5]
    dx, dy = tip[0] + tip[2] * clock - curve[1], tip[1] + tip[3] * clock - curve[2]
    start, end = span
    lever = max(_length(dx + start * ux, dy + start * uy), _length(dx + end * ux, dy + end * uy))
    return _length(ux, uy) + fastest_between(work, span) * lever


@sealed
def bound_in_step(scene: Scene, work: Work, step: float, slopes: Slopes, clock: float) -> None:
    """Write the speeds in a step of the integration.

    A step is accurate only if it is short against the changes of speed: what speeds are between its
    ends is near what they are there.

    Parameters
    ----------
    scene, work
        The run; the first slope and the trial pose must be there.
    step
        Length of the step on the clock.
    slopes
        Velocity of the part at the end of the step.
    clock
        The clock at the start of the step.
    """
    start: Slopes = (work.slope[0, 0], work.slope[0, 1], work.slope[0, 2])
    here = _length(start[0], start[1]) + work.reach * abs(start[2])
    there = _length(slopes[0], slopes[1]) + work.reach * abs(slopes[2])
    fastest = max(here, there)
    tips, pose, trial = scene.tips, work.pose, work.trial
    for i in range(tips.shape[0]):
        x, y = tips[i, 0] + tips[i, 2] * clock, tips[i, 1] + tips[i, 3] * clock
        ax = tips[i, 2] - start[0] + start[2] * (y - pose[1])
        ay = tips[i, 3] - start[1] - start[2] * (x - pose[0])
        x, y = x + tips[i, 2] * step, y + tips[i, 3] * step
        bx = tips[i, 2] - slopes[0] + slopes[2] * (y - trial[1])
        by = tips[i, 3] - slopes[1] - slopes[2] * (x - trial[0])
        ends = max(_length(ax, ay), _length(bx, by))
        scene.closing[i] = ends + _BETWEEN * _length(bx - ax, by - ay) + _ROUGH * fastest
    scene.closing[tips.shape[0] :] = _CORNERS * fastest


@inlined
def _length(x: float, y: float) -> float:
    """Length of a vector of order one, in the plainest way."""
    return np.sqrt(x * x + y * y)
