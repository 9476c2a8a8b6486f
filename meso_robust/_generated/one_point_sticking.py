"""One-point sticking contact (paper, eq. 5).

Generated from derivations/one_point_sticking.py by `meso-robust derive`; do not edit.
Every function takes `ops`, the arithmetic to use (casadi, numpy, ...), and returns a tuple.
"""

from __future__ import annotations

from typing import Any


def normal_force(ops: Any, theta: Any, d1: Any, d2: Any, rho: Any) -> tuple[Any, ...]:
    """Return lambda_n F / (e_x |v_p|), m^2: the tip pushes where it is positive."""
    return (
        d1*d2*ops.cos(theta) + (d1**2 + rho)*ops.sin(theta),
    )


def friction_margin(ops: Any, theta: Any, d1: Any, d2: Any, rho: Any, mu: Any) -> tuple[Any, ...]:
    """Return mu lambda_n -+ lambda_t, same scale, m^2: both positive where the contact sticks."""
    x0 = ops.cos(theta)
    x1 = d1*d2
    x2 = d2**2 + rho
    x3 = ops.sin(theta)
    x4 = d1**2*mu + mu*rho
    return (
        x0*(mu*x1 + x2) + x3*(x1 + x4),
        x0*(d1*d2*mu - x2) + x3*(-x1 + x4),
    )


def stick_ratio(ops: Any, theta: Any, d1: Any, d2: Any, rho: Any) -> tuple[Any, ...]:
    """Return lambda_t/lambda_n of the sticking solution; the contact's own ratio is this one, clipped to [-mu, mu], wherever `only_solution` and `normal_force` are positive."""
    x0 = ops.cos(theta)
    x1 = d1*d2
    x2 = ops.sin(theta)
    return (
        (x0*(-d2**2 - rho) - x1*x2)/(x0*x1 + x2*(d1**2 + rho)),
    )


def turning(ops: Any, theta: Any, d1: Any, d2: Any, side: Any) -> tuple[Any, ...]:
    """Return side F d(theta)/d(travel), m: positive where the part turns counter-clockwise (side = 1) or clockwise (side = -1)."""
    return (
        side*(-d1*ops.cos(theta) + d2*ops.sin(theta)),
    )


def only_solution(ops: Any, d1: Any, d2: Any, rho: Any, mu: Any) -> tuple[Any, ...]:
    """Return m^2: both positive where a sticking solution excludes every slipping one."""
    x0 = d1*d2*mu
    x1 = d2**2 + rho
    return (
        -x0 + x1,
        x0 + x1,
    )
