"""The motion under one-point sticking in closed form, and the geometry of a contact.

``d(theta)/d(travel) = (R/F) sin(theta - delta)`` with ``R^2 = d1^2 + d2^2`` and
``delta = atan2(d1, d2)`` integrates to ``tan((theta-delta)/2) = k0 exp(R travel/F)``, so the travel
that turns the part from one angle to another is ``(F/R) log(k1/k0)``.
"""

from __future__ import annotations

import sympy as sp

from derivations._derivation import Derivation, Statement, Status, require_zero
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
    rate = -solve_sticking()["omega"] / v_p  # turn per unit of travel along -x
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
        statements=(
            Statement(
                place="closed form of one-point sticking",
                text="tan((theta-delta)/2) = tan((theta0-delta)/2) exp(R travel/F)",
                status=Status.DERIVED,
            ),
        ),
        functions={
            "travel": (
                (start, end, d1, d2, rho),
                (travel,),
                "m: travel of the tip in sticking contact that turns the part from start to end",
            ),
            "arm": (
                (theta, d1, d2),
                (by_angle(arm[0]), by_angle(arm[1])),
                "m: contact point minus centre, world axes",
            ),
            "contact_offset": (
                (theta, d1, rise),
                (offset,),
                "m: offset d2 along the edge of a tip that is `rise` above the centre",
            ),
            "contact_reach": (
                (theta, d1, rise),
                (reach,),
                "m: how far right of the centre a tip that is `rise` above it meets the edge",
            ),
            "shortening": (
                (theta, d1, d2, rho),
                (by_angle(shortening),),
                "m^2: where positive, a contact further up the edge (d2) needs less travel to turn "
                "the part counter-clockwise, more to turn it clockwise",
            ),
            "lift": (
                (start, end, d1, d2),
                (sp.collect(sp.expand(start_arm - end_arm), [d1, d2]),),
                "m: rise of the centre while the part turns from start to end about the contact",
            ),
            "clearance": (
                (theta, d1, dx, dy),
                (by_angle(other_n - d1),),
                "m: distance from the edge's line of a point (dx, dy) from the centre",
            ),
            "beside": (
                (theta, d2, half, dx, dy, side),
                (by_angle(other_n), by_angle(side * other_a - half)),
                "m: how far the second tip, (dx, dy) from the touching one, is off the edge's line "
                "and beyond its end; it is clear of the part where either is positive",
            ),
        },
    )
