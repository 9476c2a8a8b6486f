"""Closed-form motion under one-point sticking, and contact geometry.

Generated from derivations/sticking_motion.py by `meso-robust derive`; do not edit.
Every function takes `ops`, the arithmetic to use (casadi, numpy, ...), and returns a tuple.
"""

from __future__ import annotations

from typing import Any


def travel(ops: Any, theta_start: Any, theta_end: Any, d1: Any, d2: Any, rho: Any) -> tuple[Any, ...]:
    """Return m: travel of the tip in sticking contact that turns the part from start to end."""
    x0 = d1**2 + d2**2
    x1 = ops.sqrt(x0)
    x2 = ops.cos(theta_start)
    x3 = ops.sin(theta_start)
    x4 = ops.cos(theta_end)
    x5 = ops.sin(theta_end)
    x6 = -x1
    return (
        (rho + x0)*ops.log((-d1*x2 + d2*x3)*(-d1*x5 - d2*x4 - x6)/((-d1*x4 + d2*x5)*(-d1*x3 - d2*x2 - x6)))/x1,
    )


def arm(ops: Any, theta: Any, d1: Any, d2: Any) -> tuple[Any, ...]:
    """Return m: contact point minus centre, world axes."""
    x0 = ops.sin(theta)
    x1 = ops.cos(theta)
    return (
        d1*x0 + d2*x1,
        -d1*x1 + d2*x0,
    )


def contact_offset(ops: Any, theta: Any, d1: Any, rise: Any) -> tuple[Any, ...]:
    """Return m: offset d2 along the edge of a tip that is `rise` above the centre."""
    return (
        (d1*ops.cos(theta) + rise)/ops.sin(theta),
    )


def contact_reach(ops: Any, theta: Any, d1: Any, rise: Any) -> tuple[Any, ...]:
    """Return m: how far right of the centre a tip that is `rise` above it meets the edge."""
    return (
        (d1 + rise*ops.cos(theta))/ops.sin(theta),
    )


def shortening(ops: Any, theta: Any, d1: Any, d2: Any, rho: Any) -> tuple[Any, ...]:
    """Return m^2: where positive, a contact further up the edge (d2) needs less travel to turn the part counter-clockwise, more to turn it clockwise."""
    return (
        2*d1*d2*ops.cos(theta) + (d1**2 - d2**2 + rho)*ops.sin(theta),
    )


def lift(ops: Any, theta_start: Any, theta_end: Any, d1: Any, d2: Any) -> tuple[Any, ...]:
    """Return m: rise of the centre while the part turns from start to end about the contact."""
    return (
        d1*(ops.cos(theta_end) - ops.cos(theta_start)) + d2*(-ops.sin(theta_end) + ops.sin(theta_start)),
    )


def clearance(ops: Any, theta: Any, d1: Any, dx: Any, dy: Any) -> tuple[Any, ...]:
    """Return m: distance from the edge's line of a point (dx, dy) from the centre."""
    return (
        -d1 + dx*ops.sin(theta) - dy*ops.cos(theta),
    )


def beside(ops: Any, theta: Any, d2: Any, half: Any, dx: Any, dy: Any, side: Any) -> tuple[Any, ...]:
    """Return m: how far the second tip, (dx, dy) from the touching one, is off the edge's line and beyond its end; it is clear of the part where either is positive."""
    x0 = ops.sin(theta)
    x1 = ops.cos(theta)
    return (
        dx*x0 - dy*x1,
        d2*side + dx*side*x1 + dy*side*x0 - half,
    )
