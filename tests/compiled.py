"""Compiles what no plan calls, for ``make compiled``."""

from __future__ import annotations

import numpy as np

from meso_robust.simulator import Push, exact


def compile_events() -> None:
    """Run the kernel of the event-driven engine once, on a push that touches nothing."""
    exact(
        Push.straight(
            vertices=np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * 1e-3,
            poses=np.zeros((1, 3)),
            tips=np.array([[[5e-3, 0.0]]]),
            travel=np.array([[[1e-6, 0.0]]]),
            friction=np.zeros((1, 1)),
            film_ratio=1e-6,
            step=1e-6,
        )
    )
