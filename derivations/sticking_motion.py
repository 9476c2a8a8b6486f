"""The motion under one-point sticking in closed form, and the geometry of a contact.

``d(theta)/d(travel) = (R/F) sin(theta - delta)`` with ``R^2 = d1^2 + d2^2`` and
``delta = atan2(d1, d2)`` integrates to ``tan((theta-delta)/2) = k0 exp(R travel/F)``, so the travel
that turns the part from one angle to another is ``(F/R) log(k1/k0)``.
"""

from __future__ import annotations

import sympy as sp

from derivations._claim import Claim
from derivations._derivation import Derivation, Function
from derivations._statement import identity, require_zero
from derivations.mechanics import a, by_angle, d1, d2, n, rho, theta, v_p
from derivations.one_point_sticking import F, solve_sticking


def half_angle(angle: sp.Symbol) -> sp.Expr:
    """tan((angle - delta)/2) = (1 - cos)/sin, written without the inverse tangent."""
    R = sp.sqrt(d1**2 + d2**2)
    return (R - (d2 * sp.cos(angle) + d1 * sp.sin(angle))) / (
        d2 * sp.sin(angle) - d1 * sp.cos(angle)
    )


def derive() -> Derivation:
    """Derive the travel law and the geometry of the contact."""
    start, end = sp.symbols("theta_start theta_end", real=True)
    R = sp.sqrt(d1**2 + d2**2)
    travel = F / R * sp.log(half_angle(end) / half_angle(start))
    rate = -solve_sticking().twist[2] / v_p  # turn per unit of travel along -x
    require_zero(sp.diff(travel, end) * rate.subs(theta, end) - 1, "d(travel)/d(theta) = 1/rate")
    require_zero(travel.subs(end, start), "no travel, no turn")

    arm = d2 * a + d1 * n
    rise = sp.Symbol("rise", real=True)  # height of the tip above the centre
    offset = (rise + d1 * sp.cos(theta)) / sp.sin(theta)
    require_zero(arm[1].subs(d2, offset) - rise, "the tip's height fixes its place on the edge")
    reach = (d1 + rise * sp.cos(theta)) / sp.sin(theta)
    require_zero(arm[0].subs(d2, offset) - reach, "the tip's height fixes where it meets the edge")

    # travel = integral of F/lever over the turn: its slope in d2 has one sign along the path when
    # `shortening` has, and then the longest and the shortest travel lie at the ends of d2
    lever = d2 * sp.sin(theta) - d1 * sp.cos(theta)
    require_zero(rate - lever / F, "the turning rate is lever/F")
    shortening = F * sp.sin(theta) - 2 * d2 * lever
    require_zero(sp.diff(F / lever, d2) * lever**2 + shortening, "slope of the travel in d2")

    dx, dy, half, side = sp.symbols("dx dy half side", real=True)
    other_n = (sp.Matrix([dx, dy]).T * n)[0]
    other_a = d2 + (sp.Matrix([dx, dy]).T * a)[0]
    start_arm, end_arm = (arm[1].subs(theta, angle) for angle in (start, end))
    return Derivation(
        name="sticking_motion",
        summary="Closed-form motion under one-point sticking, and contact geometry.",
        claims=(_closed_form(rate),),
        functions={
            "travel": Function(
                arguments=(start, end, d1, d2, rho),
                results=(travel,),
                unit="m",
                meaning="m: travel of the tip in sticking contact that turns the part from start to end",
            ),
            "arm": Function(
                arguments=(theta, d1, d2),
                results=(by_angle(arm[0]), by_angle(arm[1])),
                unit="m",
                meaning="m: contact point minus centre, world axes",
            ),
            "contact_offset": Function(
                arguments=(theta, d1, rise),
                results=(offset,),
                unit="m",
                meaning="m: offset d2 along the edge of a tip that is `rise` above the centre",
            ),
            "contact_reach": Function(
                arguments=(theta, d1, rise),
                results=(reach,),
                unit="m",
                meaning="m: how far right of the centre a tip that is `rise` above it meets the edge",
            ),
            "shortening": Function(
                arguments=(theta, d1, d2, rho),
                results=(by_angle(shortening),),
                unit="m^2",
                meaning="m^2: where positive, a contact further up the edge (d2) needs less travel to turn "
                "the part counter-clockwise, more to turn it clockwise",
            ),
            "lift": Function(
                arguments=(start, end, d1, d2),
                results=(sp.collect(sp.expand(start_arm - end_arm), [d1, d2]),),
                unit="m",
                meaning="m: rise of the centre while the part turns from start to end about the contact",
            ),
            "clearance": Function(
                arguments=(theta, d1, dx, dy),
                results=(by_angle(other_n - d1),),
                unit="m",
                meaning="m: distance from the edge's line of a point (dx, dy) from the centre",
            ),
            "beside": Function(
                arguments=(theta, d2, half, dx, dy, side),
                results=(by_angle(other_n), by_angle(side * other_a - half)),
                unit="m",
                meaning="m: how far the second tip, (dx, dy) from the touching one, is off the edge's line "
                "and beyond its end; it is clear of the part where either is positive",
            ),
        },
    )


def _closed_form(rate: sp.Expr) -> Claim:
    """The travel law, by differentiation along the motion."""
    start, xi = sp.Symbol("theta_0", real=True), sp.Symbol("xi", real=True)
    R, delta = sp.sqrt(d1**2 + d2**2), sp.Symbol("delta", real=True)
    half = sp.tan((start - delta) / 2) * sp.exp(R * xi / F)  # tan((theta - delta)/2)
    motion = 2 * sp.atan(half)  # theta - delta
    return Claim(
        key="closed-form-motion",
        title="Motion under one-point sticking in closed form",
        place="new; the paper integrates numerically",
        derived=r"While the contact sticks, $d\theta/d\xi = (R/F) \sin(\theta - \delta)$ with $\xi$ "
        r"the travel, $R^2 = d_1^2 + d_2^2$, $\delta = \mathrm{atan2}(d_1, d_2)$, so "
        r"$\tan\frac{\theta - \delta}{2} = \tan\frac{\theta_0 - \delta}{2}\, e^{R\xi/F}$. The "
        "centre follows from the contact, which moves with the tip. Friction does not enter.",
        steps=(
            r"The turning rate per travel is the lever $d_2\sin\theta - d_1\cos\theta$ over $F$.",
            r"Separating variables gives the travel $\xi = \frac{F}{R}\ln\frac{\tan((\theta - "
            r"\delta)/2)}{\tan((\theta_0 - \delta)/2)}$, without time stepping.",
        ),
        hypotheses=("the contact sticks (exact sticking interval)",),
        checks=(
            identity(
                r"rate: $R\sin(\theta - \delta)$ is the lever, with $\cos\delta = d_2/R$, "
                r"$\sin\delta = d_1/R$",
                (R * sp.expand_trig(sp.sin(theta - delta))).subs(
                    {sp.cos(delta): d2 / R, sp.sin(delta): d1 / R}
                ),
                d2 * sp.sin(theta) - d1 * sp.cos(theta),
            ),
            identity(
                r"the rate is the one derived from the balance",
                rate,
                (d2 * sp.sin(theta) - d1 * sp.cos(theta)) / F,
            ),
            identity(
                r"the law solves the equation, $\sin$ from the half tangent",
                sp.Derivative(motion, xi),
                R / F * 2 * half / (1 + half**2),
            ),
            identity(
                r"and starts at $\theta_0$",
                sp.Subs(half, xi, 0),
                sp.tan(start / 2 - delta / 2),
            ),
        ),
    )
