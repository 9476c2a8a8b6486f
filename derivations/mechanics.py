"""Frames, symbols and the quasi-static balance that every derivation starts from.

Frames: world W (x right, y up); part frame at its centre, ``a`` along the pushed edge, ``n`` the
outward normal of that edge::

             n  (outward)             a = (cos theta, sin theta)
             ^                        n = (sin theta, -cos theta)
             |      tip at r = d2 a + d1 n, pushing along -x
       ------+--o------ edge ---> a
       |     d2        |              theta = pi/2: the edge is upright and faces +x
       |   centre      |
       -----------------

The support is a viscous film: wrench = E twist with E = diag(e_x, e_x, rho e_x).
"""

from __future__ import annotations

import sympy as sp
from sympy.logic.boolalg import Boolean

theta = sp.Symbol("theta", real=True)
d1, rho, mu, e_x, d4 = sp.symbols("d1 rho mu e_x d4", positive=True)
d2, beta = sp.symbols("d2 beta", real=True)
v_p = sp.Symbol("v_p", negative=True)
# the paper's part pushed on its long edge: half width 418.5 um, fitted rho 0.3769 mm^2; in um
PAPER = {d1: sp.Rational(837, 2), rho: sp.Integer(376_900), mu: sp.Rational(33, 100)}

a = sp.Matrix([sp.cos(theta), sp.sin(theta)])
n = sp.Matrix([sp.sin(theta), -sp.cos(theta)])


def cross(p: sp.Matrix, q: sp.Matrix) -> sp.Expr:
    """Planar cross product p_x q_y - p_y q_x."""
    return p[0] * q[1] - p[1] * q[0]


def wrench(force: sp.Matrix, arm: sp.Matrix) -> sp.Matrix:
    """Force and its moment about the centre, (f_x, f_y, m)."""
    return sp.Matrix([force[0], force[1], cross(arm, force)])


def film(twist: sp.Matrix) -> sp.Matrix:
    """Drag wrench of the film at ``twist`` = (v_x, v_y, omega)."""
    return sp.diag(e_x, e_x, rho * e_x) * twist


def velocity_at(twist: sp.Matrix, arm: sp.Matrix) -> sp.Matrix:
    """World velocity of the part's point at ``arm`` from the centre."""
    return sp.Matrix([twist[0] - twist[2] * arm[1], twist[1] + twist[2] * arm[0]])


def coulomb(
    normal: sp.Expr, tangential: sp.Expr, slip: sp.Expr, opening: sp.Expr
) -> tuple[Boolean, ...]:
    """Coulomb's law with unilateral contact, complete: sticking, slipping either way, separating.

    Parameters
    ----------
    normal
        Force that presses on the part.
    tangential
        Force on the part along ``a``.
    slip
        Velocity of the part's point relative to the tip, along ``a``.
    opening
        Speed at which the part leaves the tip.
    """
    return (
        normal >= 0,
        tangential <= mu * normal,
        -tangential <= mu * normal,
        opening >= 0,
        sp.Or(sp.Eq(normal, 0), sp.Eq(opening, 0)),
        sp.Or(slip <= 0, sp.Eq(tangential, -mu * normal)),
        sp.Or(slip >= 0, sp.Eq(tangential, mu * normal)),
    )


def by_angle(expression: sp.Expr, angle: sp.Symbol = theta) -> sp.Expr:
    """Collected in cos and sin of ``angle``: every other symbol stands once in each coefficient."""
    return sp.collect(sp.expand(expression), [sp.cos(angle), sp.sin(angle)])
