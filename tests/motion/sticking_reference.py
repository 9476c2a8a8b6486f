"""Turning about a sticking contact, integrated from force balance."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp


def twist(theta: float, depth: float, offset: float, ratio: float) -> tuple[float, float, float]:
    """(v_x, v_y, omega) per travel: the contact moves with the tip, at unit speed along -x."""
    c, s = np.cos(theta), np.sin(theta)
    arm = offset * np.array([c, s]) + depth * np.array([s, -c])
    # unknowns v_x, v_y, omega, f_x, f_y; drag (1, 1, rho) balances the force at the contact
    matrix = np.array(
        [
            [1.0, 0.0, 0.0, -1.0, 0.0],
            [0.0, 1.0, 0.0, 0.0, -1.0],
            [0.0, 0.0, ratio, arm[1], -arm[0]],
            [1.0, 0.0, -arm[1], 0.0, 0.0],
            [0.0, 1.0, arm[0], 0.0, 0.0],
        ]
    )
    v_x, v_y, omega, _, _ = np.linalg.solve(matrix, [0.0, 0.0, 0.0, -1.0, 0.0])
    return float(v_x), float(v_y), float(omega)


def after(
    theta: float, travel: float, depth: float, offset: float, ratio: float
) -> tuple[float, float, float]:
    """Displacement of the centre and angle after ``travel`` of the tip in contact."""
    found = solve_ivp(
        lambda _, pose: twist(pose[2], depth, offset, ratio),
        (0.0, travel),
        [0.0, 0.0, theta],
        rtol=1e-11,
        atol=1e-14,
    )
    x, y, angle = found.y[:, -1]
    return float(x), float(y), float(angle)


def needed(start: float, end: float, depth: float, offset: float, ratio: float) -> float:
    """Travel that turns the part from ``start`` to ``end``."""
    found = solve_ivp(
        lambda angle, _: [1.0 / twist(angle, depth, offset, ratio)[2]],
        (start, end),
        [0.0],
        rtol=1e-11,
        atol=1e-16,
    )
    return float(found.y[0, -1])
