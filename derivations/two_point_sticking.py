"""Two-point sticking contact of a dual-tip probe (paper, eq. 9).

The part translates with the probe and the edge lies along the line through both tips,
``theta = pi/2 + beta``: a positive misalignment puts the upper tip ahead. (Eq. 9 holds as printed in
this sense of beta; the second inequality of eq. 12, ``beta + theta < pi/2``, uses the other one.)
Tip 1 is the upper one at offset ``d2``, tip 2 lies ``d4/cos(beta)`` below it along the edge
(``d4``: spacing across the push). The tangential forces act along one line, so
only their sum enters; the three balance equations give both normal forces and that sum.
"""

from __future__ import annotations

import sympy as sp

from derivations._derivation import Derivation, Statement, require_zero, verdict
from derivations.mechanics import a, beta, d1, d2, d4, e_x, film, mu, n, theta, v_p, wrench


def solve_two_points() -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Normal forces of tips 1 and 2 and the summed tangential force."""
    n1, n2, shear = sp.symbols("lambda_n1 lambda_n2 lambda_t", real=True)
    at = {theta: sp.pi / 2 + beta}
    along, out = a.subs(at), n.subs(at)
    first = d2 * along + d1 * out
    second = (d2 - d4 / sp.cos(beta)) * along + d1 * out
    pushes = wrench(-out * n1 + along * shear, first) + wrench(-out * n2, second)
    balance = film(sp.Matrix([v_p, 0, 0])) - pushes
    (solution,) = sp.solve(list(balance), (n1, n2, shear), dict=True)
    first_force, second_force, sum_t = (sp.simplify(solution[key]) for key in (n1, n2, shear))
    return first_force, second_force, sum_t


def derive() -> Derivation:
    """Derive eq. 9, compare with the print, and state the conditions to generate."""
    first, second, shear = solve_two_points()
    c, s = sp.cos(beta), sp.sin(beta)
    lever = d1 * s + d2 * c
    scale = -e_x * v_p * c / d4
    require_zero(first / scale - (d4 - lever), "tip 1 carries the lever of tip 2")
    require_zero(second / scale - lever, "tip 2 carries the lever of tip 1")
    require_zero((first + second) / (-e_x * v_p) - c, "both together carry the drag")
    require_zero(shear**2 - (e_x * v_p * s) ** 2, "the shear carries the rest")
    return Derivation(
        name="two_point_sticking",
        summary="Two-point sticking contact (paper, eq. 9).",
        statements=(
            Statement(
                place="eq. 9, lambda_n^1",
                text="lambda_n1 = e_x v_p cos(beta) (d1 sin(beta) + d2 cos(beta) - d4)/d4",
                status=verdict(first - e_x * v_p * c * (lever - d4) / d4),
            ),
            Statement(
                place="eq. 9, lambda_n^2",
                text="lambda_n2 = -e_x v_p cos(beta) (d1 sin(beta) + d2 cos(beta))/d4",
                status=verdict(second + e_x * v_p * c * lever / d4),
            ),
            Statement(
                place="eq. 9, ratio",
                text="|lambda_n/lambda_t| = |1/tan(beta)|: sticking needs |tan(beta)| < mu",
                status=verdict(((first + second) / shear) ** 2 - 1 / sp.tan(beta) ** 2),
            ),
        ),
        functions={
            "normal_forces": (
                (beta, d1, d2, d4),
                (d4 - lever, lever),
                "lambda_n of tips 1 and 2, times d4/(e_x |v_p| cos(beta)), m: both must be positive",
            ),
            "friction_margin": (
                (beta, mu),
                (mu * c - s, mu * c + s),
                "mu lambda_n -+ lambda_t over e_x |v_p|: both positive where the pair sticks",
            ),
        },
    )
