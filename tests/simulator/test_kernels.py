"""A kernel takes half a minute to compile: whatever the push, each engine needs one."""

from __future__ import annotations

from typing import Any, cast

import numpy as np

from meso_robust.simulator import Push, exact, simulate
from meso_robust.simulator.batch import run_range
from meso_robust.simulator.events.engine import _kernel
from meso_robust.types import Floats

SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * 1e-3


def push(vertices: Floats, friction: Floats) -> Push:
    return Push.straight(
        vertices=vertices,
        poses=np.zeros((2, 3)),
        tips=np.full((2, 1, 2), 5e-3),
        travel=np.full((2, 1, 2), 1e-6),
        friction=friction,
        film_ratio=1e-6,
        step=1e-6,
    )


def compiled() -> tuple[set[Any], set[Any]]:
    """Types of arguments for which either engine has been compiled."""
    stepped, events = cast(Any, run_range), cast(Any, _kernel)
    return set(stepped.signatures), set(events.signatures)


def test_parts_and_friction_of_each_run_need_no_other_kernel() -> None:
    alike = push(SQUARE, np.zeros((1, 1)))
    exact(alike)
    simulate(alike)
    before = compiled()

    each = push(np.stack([SQUARE, 1.1 * SQUARE]), np.full((2, 1), 0.3))
    exact(each)
    simulate(each)

    assert compiled() == before
