"""Directions in the plane and arcs between them, without inverse functions.

A direction is a vector of any length. ``turn(p, q)`` is positive where ``q`` lies less than half a
turn counter-clockwise of ``p``; so "theta lies between two limits" is a pair of polynomial
inequalities in its cosine and sine.
"""

from __future__ import annotations

import sympy as sp

Direction = tuple[sp.Expr, sp.Expr]


def turn(p: Direction, q: Direction) -> sp.Expr:
    """Cross product: |p| |q| times the sine of the angle from ``p`` to ``q``."""
    return sp.expand(p[0] * q[1] - p[1] * q[0])


def degrees(p: Direction, at: dict[sp.Symbol, sp.Expr]) -> str:
    """Angle of a direction at a point, in degrees with two decimals, for a text."""
    x, y = (sp.sympify(entry).subs(at) for entry in p)
    return f"{float(sp.deg(sp.atan2(y, x)).evalf(20)):.2f}"
