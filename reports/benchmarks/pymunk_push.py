"""The common push by pymunk, with the support as two joints of limited strength, in mm.

Pymunk is planar and has no friction with the ground. The usual stand-in is a pivot joint, which gives
way at the largest force, and a gear joint, which gives way at the largest torque; the two do not know
of each other, as a limit surface would.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np
import numpy.typing as npt

from reports.benchmarks.one_push import (
    BOX,
    HALF_LONG,
    HALF_SHORT,
    MU,
    OUTPUTS,
    RADIUS,
    TIP,
    TRAVEL,
    Ground,
)
from reports.benchmarks.timing import Clock, best

F = npt.NDArray[np.float64]

_STRENGTH = 300.0  # mm/s² of the unit mass: inertia is small against it
FITTED = 0.22
"""mm, torque limit over force limit with which the rotation comes out about right for four corners."""


def torque_radius(ground: Ground) -> float:
    """Largest torque of the support over its largest force, mm."""
    return float(ground.shares @ np.hypot(*ground.points.T))


def _space(pymunk: Any, radius: float) -> tuple[Any, Any]:
    """Scene and box."""
    space = pymunk.Space()
    space.collision_slop = 1e-4
    box = pymunk.Body(1.0, pymunk.moment_for_box(1.0, (2 * HALF_LONG, 2 * HALF_SHORT)))
    outline = pymunk.Poly(box, [tuple(corner) for corner in BOX])
    tip = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    tip.position, tip.velocity = tuple(TIP), (0.0, TRAVEL)
    ball = pymunk.Circle(tip, RADIUS)
    outline.friction, ball.friction = MU, 1.0  # pymunk multiplies the two
    slide = pymunk.PivotJoint(space.static_body, box, (0.0, 0.0), (0.0, 0.0))
    turn = pymunk.GearJoint(space.static_body, box, 0.0, 1.0)
    slide.max_bias, turn.max_bias = 0.0, 0.0
    slide.max_force, turn.max_force = _STRENGTH, _STRENGTH * radius
    space.add(box, outline, tip, ball, slide, turn)
    return space, box


def _take(scene: tuple[Any, Any], steps: int) -> F:
    """Push for 1 s, and return the poses (x, y in mm, rad) at the outputs."""
    space, box = scene
    path = np.zeros((OUTPUTS, 3))
    for k in range(OUTPUTS):
        for _ in range(steps // OUTPUTS):
            space.step(1.0 / steps)
        path[k] = box.position.x, box.position.y, box.angle
    return path


def pymunk_push(radius: float, steps: int) -> tuple[F, Clock]:
    """End of the push (x, y in mm, θ in deg) and its time.

    Parameters
    ----------
    radius
        Torque limit over force limit, mm.
    steps
        Number of time steps.

    Raises
    ------
    ImportError
        If pymunk is not installed.
    """
    pymunk: Any = import_module("pymunk")
    end = _take(_space(pymunk, radius), steps)[-1]
    clock = best(lambda scene: _take(scene, steps), lambda: _space(pymunk, radius), 5)
    return np.array([end[0], end[1], np.degrees(end[2])]), clock
