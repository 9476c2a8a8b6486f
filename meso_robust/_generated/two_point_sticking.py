"""Two-point sticking contact (paper, eq. 9).

Generated from derivations/two_point_sticking.py by `meso-robust derive`; do not edit.
Every function takes `ops`, the arithmetic to use (casadi, numpy, ...), and returns a tuple.
"""

from __future__ import annotations

from typing import Any


def normal_forces(ops: Any, beta: Any, d1: Any, d2: Any, d4: Any) -> tuple[Any, ...]:
    """Return lambda_n of tips 1 and 2, times d4/(e_x |v_p| cos(beta)), m: both must be positive."""
    x0 = d1*ops.sin(beta) + d2*ops.cos(beta)
    return (
        d4 - x0,
        x0,
    )


def friction_margin(ops: Any, beta: Any, mu: Any) -> tuple[Any, ...]:
    """Return mu lambda_n -+ lambda_t over e_x |v_p|: both positive where the pair sticks."""
    x0 = mu*ops.cos(beta)
    x1 = ops.sin(beta)
    return (
        x0 - x1,
        x0 + x1,
    )
