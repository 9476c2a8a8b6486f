"""One-point sticking on any drag fixed in the part.

Generated from derivations/drag_tensor.py by `meso-robust derive`; do not edit.
Every function takes `ops`, the arithmetic to use (casadi, numpy, ...), and returns a tuple.
"""

from __future__ import annotations

from typing import Any


def travel_rate(ops: Any, theta: Any, d1: Any, d2: Any, rho: Any, stretch: Any, shear: Any, bend: Any) -> tuple[Any, ...]:
    """Return m: travel of the tip per radian of the turn while it sticks; theta: of the edge less that of the push; d1, d2 from the centre of drag."""
    x0 = d1*shear
    x1 = stretch + 1
    x2 = 1 - stretch
    x3 = ops.cos(theta)
    x4 = ops.sin(theta)
    return (
        (d1**2*x1 + d2**2*x2 - 2*d2*x0 + rho)/((-bend*x3 + x4)*(d2*x2 - x0) - (bend*x4 + x3)*(d1*x1 - d2*shear)),
    )


def normal_force(ops: Any, theta: Any, d1: Any, d2: Any, rho: Any, stretch: Any, shear: Any, bend: Any) -> tuple[Any, ...]:
    """Return pressing force, m^2: the tip pushes where it is positive; theta: of the edge less that of the push; d1, d2 from the centre of drag."""
    x0 = ops.cos(theta)
    x1 = ops.sin(theta)
    x2 = -shear**2 - stretch**2 + 1
    return (
        (-bend*x0 + x1)*(d1**2*x2 + rho*(1 - stretch)) + (bend*x1 + x0)*(d1*d2*x2 + rho*shear),
    )


def friction_margin(ops: Any, theta: Any, d1: Any, d2: Any, rho: Any, stretch: Any, shear: Any, bend: Any, mu: Any) -> tuple[Any, ...]:
    """Return mu times the pressing force -+ the force along the edge, same scale, m^2: both positive where the contact sticks."""
    x0 = ops.cos(theta)
    x1 = ops.sin(theta)
    x2 = bend*x1 + x0
    x3 = -shear**2 - stretch**2 + 1
    x4 = d1*d2*x3 + rho*shear
    x5 = -bend*x0 + x1
    x6 = x2*x4 + x5*(d1**2*x3 + rho*(1 - stretch))
    x7 = x2*(d2**2*x3 + rho*(stretch + 1)) + x4*x5
    return (
        mu*x6 + x7,
        mu*x6 - x7,
    )


def turning(ops: Any, theta: Any, d1: Any, d2: Any, stretch: Any, shear: Any, bend: Any, side: Any) -> tuple[Any, ...]:
    """Return m: positive where the part turns counter-clockwise (side = 1) or clockwise (-1)."""
    x0 = ops.cos(theta)
    x1 = ops.sin(theta)
    return (
        side*((-bend*x0 + x1)*(-d1*shear + d2*(1 - stretch)) - (bend*x1 + x0)*(d1*(stretch + 1) - d2*shear)),
    )


def only_solution(ops: Any, d1: Any, d2: Any, rho: Any, stretch: Any, shear: Any, mu: Any) -> tuple[Any, ...]:
    """Return m^2: both positive where a sticking solution excludes every slipping one."""
    x0 = -shear**2 - stretch**2 + 1
    x1 = mu*(d1*d2*x0 + rho*shear)
    x2 = d2**2*x0 + rho*(stretch + 1)
    return (
        x1 + x2,
        -x1 + x2,
    )


def slips_one_way(ops: Any, theta: Any, d1: Any, d2: Any, rho: Any, stretch: Any, shear: Any, bend: Any, mu: Any, side: Any) -> tuple[Any, ...]:
    """Return m^2: all positive where a contact has one motion, in which it presses and, unless it sticks, the part slides towards a (side = 1) or -a (-1) over the tip."""
    x0 = ops.cos(theta)
    x1 = ops.sin(theta)
    x2 = -bend*x0 + x1
    x3 = -shear**2 - stretch**2 + 1
    x4 = d1*d2*x3 + rho*shear
    x5 = mu*x4
    x6 = d2**2*x3 + rho*(stretch + 1)
    x7 = bend*x1 + x0
    return (
        x2*(x5 + x6),
        x2*(-x5 + x6),
        mu*(x2*(d1**2*x3 + rho*(1 - stretch)) + x4*x7) - side*(-x2*x4 - x6*x7),
    )


def creeps_less(ops: Any, theta: Any, d1: Any, d2: Any, rho: Any, stretch: Any, shear: Any, bend: Any, mu: Any, side: Any, creep: Any) -> tuple[Any, ...]:
    """Return m^2: positive where a contact that turns the part any way slips that way by less per turn than `slipped` grows, if at all."""
    x0 = ops.cos(theta)
    x1 = ops.sin(theta)
    x2 = -bend*x0 + x1
    x3 = -shear**2 - stretch**2 + 1
    x4 = bend*x1 + x0
    x5 = d1*d2*x3 + rho*shear
    return (
        creep*x2*x3*(-d1*mu + d2*side)*(3*x0**2*x1 + (1/256)*x1) + mu*(x2*(d1**2*x3 + rho*(1 - stretch)) + x4*x5) + side*(-x2*x5 - x4*(d2**2*x3 + rho*(stretch + 1))),
    )


def slipped(ops: Any, theta: Any, theta_start: Any, creep: Any) -> tuple[Any, ...]:
    """Return m: how far along a a contact has slipped at most since the edge was at theta_start, both from the push."""
    x0 = ops.cos(theta)
    x1 = ops.cos(theta_start)
    return (
        creep*(-x0**3 - 1/256*x0 + x1**3 + (1/256)*x1),
    )


def turns_any_way(ops: Any, d1: Any, d2: Any, mu: Any, side: Any) -> tuple[Any, ...]:
    """Return m: where positive, one contact alone turns the part counter-clockwise (side = 1) or clockwise (-1), whether it sticks or slips."""
    return (
        -d1*mu + d2*side,
    )


def turns_back(ops: Any, theta: Any, d1: Any, d2: Any, stretch: Any, shear: Any, bend: Any, mu: Any, side: Any) -> tuple[Any, ...]:
    """Return m: where all are positive, one contact alone turns the part counter-clockwise (side = 1) or clockwise (-1), whether it sticks or slips."""
    x0 = ops.cos(theta)
    x1 = ops.sin(theta)
    x2 = d1*(stretch + 1) - d2*shear
    return (
        side*(-x2*(bend*x1 + x0) + (-bend*x0 + x1)*(-d1*shear + d2*(1 - stretch))),
        d1*mu + d2*side,
        x2,
    )


def pair_friction(ops: Any, theta: Any, stretch: Any, shear: Any, bend: Any, mu: Any) -> tuple[Any, ...]:
    """Return the first two positive: two tips on one edge stick; the others: no motion slips."""
    x0 = ops.cos(theta)
    x1 = ops.sin(theta)
    x2 = bend*x1 + x0
    x3 = -bend*x0 + x1
    x4 = shear*x2 + x3*(1 - stretch)
    x5 = stretch + 1
    x6 = shear*x3 + x2*x5
    x7 = mu*shear
    return (
        mu*x4 + x6,
        mu*x4 - x6,
        x5 - x7,
        x5 + x7,
    )


def pair_forces(ops: Any, theta: Any, d1: Any, d2: Any, gap: Any, stretch: Any, shear: Any, bend: Any) -> tuple[Any, ...]:
    """Return pressing forces of the upper tip, at d2, and of the lower one, gap below it, times the gap, m: both must be positive."""
    x0 = ops.cos(theta)
    x1 = ops.sin(theta)
    x2 = bend*x1 + x0
    x3 = -bend*x0 + x1
    x4 = shear*x2 + x3*(1 - stretch)
    x5 = d1*(-shear*x3 - x2*(stretch + 1)) + d2*x4
    return (
        gap*x4 - x5,
        x5,
    )
