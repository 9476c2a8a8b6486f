"""Round probe tips.

Generated from derivations/round_tips.py by `meso-robust derive`; do not edit.
Every function takes `ops`, the arithmetic to use (casadi, numpy, ...), and returns a tuple.
"""

from __future__ import annotations

from typing import Any


def touch(ops: Any, theta: Any, direction: Any, d1: Any, r: Any, dx: Any, dy: Any) -> tuple[Any, ...]:
    """Return m: travel along `direction` until a tip of radius r touches whose centre is at (dx, dy) from the reference point, and d2 of its contact."""
    x0 = direction - theta
    x1 = 1/ops.sin(x0)
    x2 = d1 + r
    return (
        -x1*(dx*ops.sin(theta) - dy*ops.cos(theta) - x2),
        -x1*(-dx*ops.sin(direction) + dy*ops.cos(direction) + x2*ops.cos(x0)),
    )


def rolled(ops: Any, theta: Any, theta_start: Any, d2: Any, r: Any) -> tuple[Any, ...]:
    """Return m: d2 of the contact that was at d2 when the edge was at theta_start."""
    return (
        d2 - r*(theta - theta_start),
    )


def upper_first(ops: Any, theta: Any, beta: Any, spacing: Any, r_upper: Any, r_lower: Any) -> tuple[Any, ...]:
    """Return m: how much closer the upper of two tips is to the edge: zero where both touch."""
    return (
        -r_lower + r_upper + spacing*ops.cos(beta - theta)/ops.cos(beta),
    )


def contact_gap(ops: Any, theta: Any, beta: Any, spacing: Any) -> tuple[Any, ...]:
    """Return m: distance of the two tips along the edge."""
    return (
        -spacing*ops.sin(beta - theta)/ops.cos(beta),
    )
