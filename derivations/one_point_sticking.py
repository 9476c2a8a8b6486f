"""One-point sticking contact: forces, turning and the sticking conditions (paper, eq. 5).

Balance ``E v = w_n lambda_n + w_t lambda_t`` together with "the contact point moves with the tip"
is a linear system of five equations for the twist and the two forces; everything follows from its
solution. With ``A = d1 d2``, ``B = rho + d1^2``, ``C = rho + d2^2``, ``F = rho + d1^2 + d2^2``:
``lambda_n ~ N = A cos + B sin`` and ``lambda_t ~ D = C cos + A sin``.
"""

from __future__ import annotations

import sympy as sp

from derivations._derivation import Derivation, Statement, Status, require_zero, verdict
from derivations.mechanics import (
    a,
    by_angle,
    d1,
    d2,
    e_x,
    film,
    mu,
    n,
    rho,
    theta,
    v_p,
    velocity_at,
    wrench,
)

F = rho + d1**2 + d2**2


def solve_sticking() -> dict[str, sp.Expr]:
    """Twist and contact forces of one-point sticking, from the balance alone."""
    v_x, v_y, omega, force_n, force_t = sp.symbols("v_x v_y omega lambda_n lambda_t", real=True)
    arm = d2 * a + d1 * n
    twist = sp.Matrix([v_x, v_y, omega])
    balance = film(twist) - wrench(-n * force_n + a * force_t, arm)
    moves_with_tip = velocity_at(twist, arm) - sp.Matrix([v_p, 0])
    unknowns = (v_x, v_y, omega, force_n, force_t)
    (solution,) = sp.solve([*balance, *moves_with_tip], unknowns, dict=True)
    return {str(symbol): sp.simplify(solution[symbol]) for symbol in unknowns}


def derive() -> Derivation:
    """Derive eq. 5, compare with the print, and state the conditions to generate."""
    solved = solve_sticking()
    scale = -e_x * v_p / F  # positive: tips push along -x
    normal = by_angle(sp.simplify(solved["lambda_n"] / scale))
    tangential = by_angle(sp.simplify(solved["lambda_t"] / scale))
    turning = by_angle(sp.simplify(-solved["omega"] * F / v_p))
    c, s, side = sp.cos(theta), sp.sin(theta), sp.Symbol("side", real=True)
    A, B, C = d1 * d2, rho + d1**2, rho + d2**2
    require_zero(normal - (A * c + B * s), "normal force is A cos + B sin")
    printed_normal = -e_x * v_p * (A * e_x * c + (rho * e_x + d1**2 * e_x) * s) / (F * e_x)
    printed_turn = e_x * v_p * (d1 * c - d2 * s) / (F * e_x)
    printed_ratio = (A * c + B * s) / (C * c + A * s)
    return Derivation(
        name="one_point_sticking",
        summary="One-point sticking contact (paper, eq. 5).",
        statements=(
            Statement(
                place="eq. 5, lambda_n",
                text="lambda_n = -e_x v_p N/F with N = d1 d2 cos + (rho + d1^2) sin",
                status=verdict(solved["lambda_n"] - printed_normal),
            ),
            Statement(
                place="eq. 5, v_theta",
                text="v_theta = v_p (d1 cos - d2 sin)/F",
                status=verdict(solved["omega"] - printed_turn),
            ),
            Statement(
                place="eq. 5, ratio",
                text="|lambda_n/lambda_t| = |N/D| with D = (rho + d2^2) cos + d1 d2 sin",
                status=verdict((solved["lambda_n"] / solved["lambda_t"]) ** 2 - printed_ratio**2),
            ),
            Statement(
                place="text under eq. 5",
                text="sticking needs |lambda_n/lambda_t| greater, not less, than 1/mu: |D| < mu N",
                status=_sense_of_the_sentence(normal, tangential),
            ),
            uniqueness(solved),
        ),
        functions={
            "normal_force": (
                (theta, d1, d2, rho),
                (normal,),
                "lambda_n F / (e_x |v_p|), m^2: the tip pushes where it is positive",
            ),
            "friction_margin": (
                (theta, d1, d2, rho, mu),
                (by_angle(mu * normal - tangential), by_angle(mu * normal + tangential)),
                "mu lambda_n -+ lambda_t, same scale, m^2: both positive where the contact sticks",
            ),
            "stick_ratio": (
                (theta, d1, d2, rho),
                (tangential / normal,),
                "lambda_t/lambda_n of the sticking solution; the contact's own ratio is this one, "
                "clipped to [-mu, mu], wherever `only_solution` and `normal_force` are positive",
            ),
            "turning": (
                (theta, d1, d2, side),
                (side * turning,),
                "side F d(theta)/d(travel), m: positive where the part turns counter-clockwise "
                "(side = 1) or clockwise (side = -1)",
            ),
            "only_solution": (
                (d1, d2, rho, mu),
                (C - mu * A, C + mu * A),
                "m^2: both positive where a sticking solution excludes every slipping one",
            ),
        },
    )


def _sense_of_the_sentence(normal: sp.Expr, tangential: sp.Expr) -> Status:
    """Refute "less than 1/mu" by a push through the centre of an upright edge, which sticks."""
    upright = {theta: sp.pi / 2, d2: 0}
    force_n, force_t = normal.subs(upright), tangential.subs(upright)
    sticks = sp.simplify(force_t) == 0 and force_n.is_positive
    return Status.REFUTED if sticks else Status.CONFIRMED  # the ratio is infinite there


def uniqueness(solved: dict[str, sp.Expr]) -> Statement:
    """Show that K_tt : K_nt = C : +-A, the entries that decide whether slip can coexist.

    If f_s is strictly inside the cone and f a slip solution with slip kappa >= 0, then
    f - f_s = -kappa K e_t, and f on the cone's edge gives
    f_s,t - mu f_s,n = kappa (K_tt - mu K_nt): the left side is negative, so K_tt > mu |K_nt|
    leaves no slip solution. If f_s lies outside the cone, the same equation leaves kappa > 0 for the
    nearer edge of the cone only: the ratio of the contact is that of f_s, clipped to [-mu, mu].
    """
    # the stiffness column for a tangential tip velocity is the sticking force of such a motion
    at = {theta: 0, v_p: -1}  # a = x axis: a tip moving along -x moves along -a
    k_tt, k_nt = solved["lambda_t"].subs(at), solved["lambda_n"].subs(at)
    C, A = rho + d2**2, d1 * d2
    require_zero((k_tt * A) ** 2 - (k_nt * C) ** 2, "K_tt : K_nt = C : +-A")
    return Statement(
        place="uniqueness of one-point sticking",
        text="a strictly sticking solution is the only one if rho + d2^2 > mu d1 |d2|",
        status=Status.DERIVED,
    )
