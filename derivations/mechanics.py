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

theta = sp.Symbol("theta", real=True)
d1, rho, mu, e_x, d4 = sp.symbols("d1 rho mu e_x d4", positive=True)
d2, beta = sp.symbols("d2 beta", real=True)
v_p = sp.Symbol("v_p", negative=True)

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


def by_angle(expression: sp.Expr, angle: sp.Symbol = theta) -> sp.Expr:
    """Collected in cos and sin of ``angle``: every other symbol stands once in each coefficient."""
    return sp.collect(sp.expand(expression), [sp.cos(angle), sp.sin(angle)])
