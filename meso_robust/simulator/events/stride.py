"""One step of the Runge-Kutta pair of order 8 while contacts slip or several of them act."""

import numpy as np

from meso_robust.simulator.events.balance import velocity
from meso_robust.simulator.events.channel import glide
from meso_robust.simulator.events.fused import inlined, sealed
from meso_robust.simulator.events.scene import Scene, Work
from meso_robust.simulator.events.tableau import ERROR_3, ERROR_5, NODES, RESULT, STAGES, WEIGHTS

_TOLERANCE = 1e-12  # of a step, in scaled lengths and radians


@sealed
def stride(scene: Scene, work: Work, clock: float, step: float) -> None:
    """Step from the present pose; the first slope must be there.

    Writes the other slopes and the trial pose.
    """
    if work.channel[0] > 0.0:
        glide(scene, work, step)
        return
    slope = work.slope
    for s in range(1, STAGES):
        dx, dy, dt = 0.0, 0.0, 0.0
        for k in range(s):
            weight = WEIGHTS[s, k]
            dx += weight * slope[k, 0]
            dy += weight * slope[k, 1]
            dt += weight * slope[k, 2]
        theta = work.pose[2] + step * dt
        place = (
            work.pose[0] + step * dx,
            work.pose[1] + step * dy,
            np.cos(theta),
            np.sin(theta),
        )
        slope[s, 0], slope[s, 1], slope[s, 2] = velocity(
            scene, work, place, clock + NODES[s] * step
        )
    for m in range(3):
        total = 0.0
        for k in range(STAGES):
            total += RESULT[k] * slope[k, m]
        work.trial[m] = work.pose[m] + step * total


@sealed
def error_of(work: Work, step: float) -> float:
    """Error of the last step in units of the tolerance."""
    five, three = 0.0, 0.0
    if work.channel[0] > 0.0:
        for k in range(STAGES):
            five += ERROR_5[k] * work.slide[k]
            three += ERROR_3[k] * work.slide[k]
        return _in_tolerances(step, 3.0 * five * five, 3.0 * three * three)
    for m in range(3):
        e5, e3 = 0.0, 0.0
        for k in range(STAGES):
            e5 += ERROR_5[k] * work.slope[k, m]
            e3 += ERROR_3[k] * work.slope[k, m]
        five += e5 * e5
        three += e3 * e3
    return _in_tolerances(step, five, three)


@inlined
def _in_tolerances(step: float, five: float, three: float) -> float:
    """Error from the squares of the differences to the results of order 5 and 3."""
    if five == 0.0 and three == 0.0:
        return 0.0
    return float(abs(step) * five / np.sqrt(3.0 * (five + 0.01 * three)) / _TOLERANCE)
