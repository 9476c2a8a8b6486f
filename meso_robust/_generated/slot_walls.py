"""A part pushed along a slot whose walls it may touch.

Generated from derivations/slot_walls.py by `meso-robust derive`; do not edit.
Every function takes `ops`, the arithmetic to use (casadi, numpy, ...), and returns a tuple.
"""

from __future__ import annotations

from typing import Any


def bears(ops: Any, d1: Any, d2: Any, p: Any, b: Any, mu: Any, mu_w: Any) -> tuple[Any, ...]:
    """Return what d2 of the tip has to spare, m, for the slot's edge p ahead of the centre to turn back a part that bears on it with its side, half a width from the centre."""
    x0 = mu*(-b*mu_w + d1 + p)
    return (
        d2 - x0,
        d2 + x0,
    )


def stiff(ops: Any, rho: Any, b: Any, mu_w: Any) -> tuple[Any, ...]:
    """Return positive, m^2, where friction at the slot's edge cannot turn the part against the film."""
    return (
        -b**2*mu_w**2 + 4*rho,
    )


def steers(ops: Any, d1: Any, d2: Any, psi: Any) -> tuple[Any, ...]:
    """Return positive, m, where the part turns back though no slot's edge holds it; psi: angle between the part and the tip's path."""
    return (
        -d1*ops.sin(psi) + d2*ops.cos(psi),
    )


def corner(ops: Any, d1: Any, b: Any, mu_w: Any, phi: Any) -> tuple[Any, ...]:
    """Return positive, m, where the wall's force on a front corner turns a part back that leans by up to phi; d1: the least distance of its ends from the centre."""
    return (
        -(b + d1*mu_w)*ops.sin(phi) + (-b*mu_w + d1)*ops.cos(phi),
    )


def one_wall(ops: Any, b: Any, room: Any, engaged: Any, phi: Any) -> tuple[Any, ...]:
    """Return what a slot of width room has to spare, m, for a part that leans by phi not to touch both walls, where its side is within the slot over this length."""
    return (
        -2*b*ops.cos(phi) - engaged*ops.sin(phi) + room,
    )


def no_jam(ops: Any, mu: Any, mu_w: Any, phi: Any) -> tuple[Any, ...]:
    """Return positive where tips and one wall cannot hold the part between them."""
    return (
        -(mu + mu_w)*ops.sin(phi) + (-mu*mu_w + 1)*ops.cos(phi),
    )
