"""Rotation between a moving and a passive tip on opposite edges (eqs. 10, 11).

Generated from derivations/two_sided_rotation.py by `meso-robust derive`; do not edit.
Every function takes `ops`, the arithmetic to use (casadi, numpy, ...), and returns a tuple.
"""

from __future__ import annotations

from typing import Any


def orientation(ops: Any, h: Any, V: Any, d1: Any) -> tuple[Any, ...]:
    """Return cos and sin of theta while both tips touch; (h, V): from S to D, m."""
    x0 = V**2 + h**2
    x1 = 1/x0
    x2 = 2*d1
    x3 = ops.sqrt(-4*d1**2 + x0)
    return (
        x1*(-V*x2 + h*x3),
        x1*(V*x3 + h*x2),
    )


def pair_position(ops: Any, theta: Any, V: Any, d1: Any) -> tuple[Any, ...]:
    """Return h, m, at which both tips touch a part of orientation theta."""
    x0 = ops.sin(theta)
    x1 = 2*d1
    x2 = ops.cos(theta)
    return (
        x0*x1 + x2*(V + x1*x2)/x0,
    )


def slide_rates(ops: Any, h: Any, V: Any, d1: Any, sigma: Any, rho: Any, mu: Any) -> tuple[Any, ...]:
    """Return d(sigma)/d(travel) at friction ratios (tau_D, tau_S) = mu (-1, -1), mu (-1, 1), mu (1, -1), mu (1, 1), and half of dT/d(travel)."""
    x0 = V**2 + h**2
    x1 = 1/x0
    x2 = 2*d1
    x3 = -4*d1**2 + x0
    x4 = ops.sqrt(x3)
    x5 = -V*x2 + h*x4
    x6 = -1/2*x1*x5
    x7 = 2*rho
    x8 = 2*sigma
    x9 = mu*x2
    x10 = -sigma - 1/2*x4
    x11 = mu*x1*(V*x4 + h*x2)
    x12 = x11/x3
    x13 = (1/2)*x1*x5
    x14 = 1/x4
    x15 = x10*x11*x14
    return (
        -x12*(x10*(-x8 - x9) + x7) - x6,
        x13 + x15,
        -x15 - x6,
        x12*(x10*(-x8 + x9) + x7) + x13,
        -1/2*h*x14,
    )


def pair(ops: Any, h: Any, V: Any, d1: Any) -> tuple[Any, ...]:
    """Return T, m: distance of the contacts along a."""
    return (
        ops.sqrt(V**2 - 4*d1**2 + h**2),
    )


def passive_force(ops: Any, h: Any, V: Any, d1: Any, sigma: Any, rho: Any, tau_D: Any, tau_S: Any) -> tuple[Any, ...]:
    """Return normal force at S over e_x and travel rate; where positive for all ratios, D alone would press the part on S."""
    x0 = V**2 + h**2
    x1 = ops.sqrt(-4*d1**2 + x0)
    x2 = (1/2)*x1
    return (
        (rho + (-sigma - x2)*(d1*tau_D - sigma + x2))*(V*x1 + 2*d1*h)/(x0*x1*(d1*(tau_D - tau_S) + x1)),
    )


def no_jam(ops: Any, V: Any, d1: Any, mu: Any) -> tuple[Any, ...]:
    """Return m^2: positive where the grasp cannot close."""
    return (
        V**2 - 4*d1**2*(mu**2 + 1),
    )


def one_contact_motion(ops: Any, theta: Any, d1: Any, d2: Any, rho: Any, tau: Any) -> tuple[Any, ...]:
    """Return velocity of the centre per travel while D alone pushes with friction ratio tau."""
    x0 = ops.cos(theta)
    x1 = ops.sin(theta)
    x2 = rho*x1/(d1*d2*tau + d2**2 + rho)
    return (
        -x2*(-tau*x0 + x1),
        x2*(tau*x1 + x0),
    )


def one_contact_turning(ops: Any, theta: Any, d1: Any, d2: Any, rho: Any, tau: Any) -> tuple[Any, ...]:
    """Return turn per travel while D alone pushes with friction ratio tau."""
    x0 = d1*tau
    return (
        (d2 + x0)*ops.sin(theta)/(d2**2 + d2*x0 + rho),
    )


def closing(ops: Any, theta: Any, d1: Any, d2: Any, p_S: Any, rho: Any, tau: Any) -> tuple[Any, ...]:
    """Return speed per travel at which the far edge closes on S at offset p_S, D alone pushing."""
    x0 = d1*tau
    return (
        (p_S*(d2 + x0) + rho)*ops.sin(theta)/(d2**2 + d2*x0 + rho),
    )
