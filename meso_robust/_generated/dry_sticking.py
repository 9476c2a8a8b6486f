"""One-point sticking on three dry support points.

Generated from derivations/dry_sticking.py by `meso-robust derive`; do not edit.
Every function takes `ops`, the arithmetic to use (casadi, numpy, ...), and returns a tuple.
"""

from __future__ import annotations

from typing import Any


def shares(ops: Any, x_1: Any, y_1: Any, x_2: Any, y_2: Any, x_3: Any, y_3: Any) -> tuple[Any, ...]:
    """Return share of the weight on each support: all positive if the centre is between them."""
    x0 = x_2*y_3 - x_3*y_2
    x1 = x_1*y_3
    x2 = x_1*y_2 - x_2*y_1
    x3 = 1/(x0 - x1 + x2 + x_3*y_1)
    return (
        x0*x3,
        x3*(-x1 + x_3*y_1),
        x2*x3,
    )


def moment(ops: Any, theta: Any, d1: Any, d2: Any, omega: Any, x_1: Any, y_1: Any, x_2: Any, y_2: Any, x_3: Any, y_3: Any) -> tuple[Any, ...]:
    """Return grows with omega and vanishes at the turn per travel of a tip that sticks, m."""
    x0 = x_1*y_2 - x_2*y_1
    x1 = x_1*y_3
    x2 = x_2*y_3 - x_3*y_2
    x3 = 1/(x0 - x1 + x2 + x_3*y_1)
    x4 = -ops.cos(theta)
    x5 = -d1 + y_3
    x6 = omega*x5 + x4
    x7 = ops.sin(theta)
    x8 = -d2 + x_3
    x9 = -omega*x8 - x7
    x10 = -d1 + y_2
    x11 = omega*x10 + x4
    x12 = -d2 + x_2
    x13 = -omega*x12 - x7
    x14 = -d1 + y_1
    x15 = omega*x14 + x4
    x16 = -d2 + x_1
    x17 = -omega*x16 - x7
    return (
        x0*x3*(x5*x6 - x8*x9)/ops.sqrt(x6**2 + x9**2) + x2*x3*(x14*x15 - x16*x17)/ops.sqrt(x15**2 + x17**2) + x3*(-x1 + x_3*y_1)*(x10*x11 - x12*x13)/ops.sqrt(x11**2 + x13**2),
    )


def friction_margin(ops: Any, theta: Any, d1: Any, d2: Any, omega: Any, x_1: Any, y_1: Any, x_2: Any, y_2: Any, x_3: Any, y_3: Any, mu: Any) -> tuple[Any, ...]:
    """Return mu lambda_n -+ lambda_t over all dry friction: both positive where the contact sticks."""
    x0 = ops.sin(theta)
    x1 = -omega*(-d2 + x_1) - x0
    x2 = -ops.cos(theta)
    x3 = omega*(-d1 + y_1) + x2
    x4 = x_1*y_3
    x5 = x_2*y_3 - x_3*y_2
    x6 = x_1*y_2 - x_2*y_1
    x7 = 1/(-x4 + x5 + x6 + x_3*y_1)
    x8 = x5*x7/ops.sqrt(x1**2 + x3**2)
    x9 = -omega*(-d2 + x_2) - x0
    x10 = omega*(-d1 + y_2) + x2
    x11 = x7*(-x4 + x_3*y_1)/ops.sqrt(x10**2 + x9**2)
    x12 = -omega*(-d2 + x_3) - x0
    x13 = omega*(-d1 + y_3) + x2
    x14 = x6*x7/ops.sqrt(x12**2 + x13**2)
    x15 = mu*(x1*x8 + x11*x9 + x12*x14)
    x16 = x10*x11 + x13*x14 + x3*x8
    return (
        -x15 - x16,
        -x15 + x16,
    )
