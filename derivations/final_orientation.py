"""How far the two-sided rotation turns the part (paper, eq. 11 and Table IV)."""

from __future__ import annotations

import sympy as sp
from sympy.logic.boolalg import Boolean

from derivations._claim import Claim
from derivations._derivation import Derivation
from derivations._statement import Point, angle, for_all, identity, require_zero, there_is, together
from derivations.mechanics import PAPER, a, d1, mu, n, theta
from derivations.two_sided_rotation import T, V, h, w

psi, psi_end = sp.symbols("psi psi_end", real=True)  # tilt pi - theta
length = sp.Symbol("d_l", positive=True)
LEAST = sp.Symbol("d_v0", positive=True)
"""What eq. 10 asks for at least, d_w + 2 s + 2 c."""
PART = {d1: PAPER[d1], length: sp.Integer(1616)}
EQ_10 = (LEAST - w > 20, LEAST - w < 21)
"""Errors of 5 um each, and the fraction of a micrometre that makes a witness rational."""
NO_JAM = 2 * PAPER[d1] * sp.sqrt(1 + PAPER[mu] ** 2)


def pair(tilt: sp.Symbol, apart: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """(h, V) of two tips that touch opposite edges ``apart`` from each other along them."""
    vector = (apart * a + w * n).subs(theta, sp.pi - tilt)
    return sp.expand(vector[0]), sp.expand(vector[1])


def passed(tilt: sp.Symbol, apart: sp.Expr, across: sp.Expr) -> tuple[Boolean, ...]:
    """Both tips touch, ``across`` from each other across the push, and have passed each other."""
    ahead, separation = pair(tilt, apart)
    return sp.Eq(across, separation), ahead < 0, sp.cos(tilt) > 0, sp.sin(tilt) > 0


def derive() -> Derivation:
    """Derive the tilt that is left and compare with eq. 11 and Table IV."""
    return Derivation(
        name="final_orientation",
        summary="Tilt left by the two-sided rotation (eq. 11).",
        claims=(_equation_11(), _table_4()),
    )


def _short_push() -> Point:
    """The paper's part after a push of 1100 um, with (10) satisfied, in exact numbers.

    theta_t is chosen rational (tan(theta_t/2) = 1/161, 0.712 deg), which gives d_v = 857.01 um; with
    T + h = 58 um the rest follows, a push of 1100 um from the upright part.
    """
    at_end = angle(sp.Rational(1, 161), psi_end)
    separation = pair(psi_end, PART[length])[1].subs({**at_end, **PART})
    width = 2 * PART[d1]
    along = (58 + (separation**2 - width**2) / 58) / 2
    ahead = 58 - along
    square = along**2 + width**2
    return {
        **PART, **at_end, V: separation, LEAST: separation, T: along, h: ahead,
        sp.cos(psi): (width * separation - along * ahead) / square,
        sp.sin(psi): (along * separation + width * ahead) / square,
    }  # fmt: skip


def _degrees(place: Point, tilt: sp.Symbol) -> float:
    return float(sp.deg(sp.atan2(place[sp.sin(tilt)], place[sp.cos(tilt)])).evalf(15))


def _equation_11() -> Claim:
    place = _short_push()
    push = float(2 * PART[d1] - place[h])
    needed = float(2 * PART[d1] + sp.sqrt(PART[length] ** 2 + (2 * PART[d1]) ** 2 - place[V] ** 2))
    # the print's form of the tilt at T, with alpha the slope of the line through both contacts
    reach = sp.sqrt(T**2 + w**2)
    separation = pair(psi, T)[1]
    sine = separation / reach * T / reach - w / reach * _cosine_of_slope(separation, reach)
    # theta_t is the tilt at T = d_l of tips as far apart as (10) asks for at least
    end, now = passed(psi_end, length, LEAST), passed(psi, T, V)
    return Claim(
        key="eq-11",
        title="Final orientation of the two-sided rotation",
        place="eq. (11), Section IX-C3",
        printed=r"The final orientation is within $\theta_t = \sin^{-1}\frac{d_w + 2 s_x^u + "
        r"2 c_{\tilde u}^u}{\sqrt{d_w^2 + d_l^2}} - \alpha$ of $\pi$ ($\alpha$ is not defined in "
        r"the text; $\tan\alpha = d_w/d_l$ makes $\theta_t$ vanish without errors)",
        derived=r"Once the tips have passed each other the tilt is $\psi = \sin^{-1}(d_v/\sqrt{T^2 + "
        r"d_w^2}) - \tan^{-1}(d_w/T)$. It equals $\theta_t$ only for the least separation that (10) "
        r"allows and contacts a full edge apart, $T = d_l$; it is larger for a larger $d_v$ and "
        r"before. From the upright part $T = d_l$ takes a push of $d_w + \sqrt{d_l^2 + d_w^2 - "
        rf"d_v^2}}$ ({needed:.0f} µm here). After the reported 1100 µm the tilt is "
        f"{_degrees(place, psi):.2f}°, not {_degrees(place, psi_end):.2f}°. With the paper's errors "
        r"and friction the print says nothing: what makes it true, equality in (10), and what lets the "
        f"part pass exclude each other. The separation that avoids the jam ({NO_JAM:.0f} µm at $\\mu = 0.33$) leaves at least {_least_tilt():.2f}°.",
        steps=(
            r"Both tips touch: $(h, d_v) = T a + d_w n$, at $\theta = \pi - \psi$: $d_v = T "
            r"\sin\psi + d_w \cos\psi$.",
            r"$T \sin\psi + d_w\cos\psi = \sqrt{T^2 + d_w^2}\,\sin(\psi + \tan^{-1}(d_w/T))$, "
            "which is the printed form with $T$ in the place of $d_l$.",
            r"Once the tips have passed each other, $T$ grows with the push and $\psi$ falls; $T$ cannot "
            r"exceed $d_l$.",
        ),
        hypotheses=("both tips stay on their edges until the end",),
        added=(
            r"the push is $d_w + \sqrt{d_l^2 + d_w^2 - d_v^2}$ at least and the part centred, so that "
            r"$T = d_l$ is reached",
            r"$d_v = d_w + 2 s_x^u + 2 c_{\tilde u}^u$: (10) holds with equality",
            r"$d_v > d_w\sqrt{1 + \mu^2}$, or the paper's part jams",
        ),
        of_print=(
            for_all(
                f"the tilt after a push of {push:.1f} µm is at most $\\theta_t$ (lengths in µm, "
                rf"$d_v = {float(place[V]):.2f}$, equality in (10))",
                [*now, *end, sp.Eq(h, pair(psi, T)[0]), length > T, *EQ_10, V >= LEAST],
                sp.sin(psi) <= sp.sin(psi_end),
                at=place,
            ),
        ),
        with_added=(
            for_all(
                r"where $T = d_l$ is reached, with equality in (10), the tilt is $\theta_t$",
                [*now, *end, sp.Eq(T, length), sp.Eq(V, LEAST)],
                sp.And(sp.Eq(sp.sin(psi), sp.sin(psi_end)), sp.Eq(sp.cos(psi), sp.cos(psi_end))),
            ),
        ),
        checks=(
            identity(r"$\sin\psi$ of the printed form, with $T$ for $d_l$", sine, sp.sin(psi)),
            for_all(
                r"the tilt falls while $T$ grows: before $T = d_l$ it is larger",
                [*now, *end, length > T, sp.Eq(V, LEAST), w < V],
                sp.sin(psi) > sp.sin(psi_end),
            ),
            for_all(
                r"a larger separation leaves a larger tilt at $T = d_l$",
                [*now, *end, sp.Eq(T, length), V > LEAST],
                sp.sin(psi) > sp.sin(psi_end),
            ),
        ),
        compatible=(
            together(
                "equality in (10) with the paper's errors of 5 µm, and no jam at any friction that it "
                r"reports, $\mu \ge 0.30$ (lengths in µm)",
                sp.Eq(d1, PAPER[d1]),
                sp.Eq(V, LEAST),
                *EQ_10,
                mu >= sp.Rational(3, 10),
                w**2 * (1 + mu**2) < V**2,
            ),
        ),
    )


def _least_tilt() -> float:
    """Tilt at T = d_l for the separation at which the part just does not jam, in degrees."""
    reach = sp.sqrt(PART[length] ** 2 + (2 * PART[d1]) ** 2)
    tilt = sp.asin(NO_JAM / reach) - sp.atan(2 * PART[d1] / PART[length])
    return float(sp.deg(tilt).evalf(15))


def _cosine_of_slope(separation: sp.Expr, reach: sp.Expr) -> sp.Expr:
    """cos(asin(V/reach)) as a polynomial: the other leg of the triangle, h towards the right."""
    leg = -pair(psi, T)[0]
    require_zero(leg**2 + separation**2 - reach**2, "legs of the line through both contacts")
    return leg / reach


def _table_4() -> Claim:
    """The simulated 90 degrees after 1100 um."""
    place = _short_push()
    turned = 90 - _degrees(place, psi)
    pushed = w - h
    half_degree = sp.Rational(1, 114)  # sin(0.5 deg) = 1/114.59
    return Claim(
        key="table-iv-rotation",
        title="Simulated rotation of 90° after 1100 µm",
        place="Table IV and text, Section X-C",
        printed="“the separation distance is determined from (10) … pushes the part … for a "
        "distance of about 1100 µm”; simulated rotation 90°",
        derived=f"At $d_v = {float(place[V]):.0f}$ µm, which (10) asks for with errors of 5 µm, a push "
        f"of 1100 µm turns a rigid part that starts in contact by {turned:.1f}°. A tilt below half a "
        "degree cannot be reached at that separation by any push: not even with the tips a full edge "
        "apart.",
        steps=(
            r"While both tips touch, the orientation depends on $h$ and $d_v$ only (orientation "
            "law).",
            r"$d_v = T\sin\psi + d_w\cos\psi$ with $T \le d_l$ leaves $\psi \ge \theta_t$.",
        ),
        consistent=(
            together(
                "a tilt of at most 0.5° at a separation that satisfies (10), tips at most a full edge "
                "apart (lengths in µm)",
                sp.Eq(d1, PART[d1]),
                sp.Eq(V, pair(psi, T)[1]),
                w + 20 <= V,
                PART[length] >= T,
                sp.cos(psi) > 0,
                sp.sin(psi) <= half_degree,
            ),
        ),
        checks=(
            there_is(
                "the push from the upright part is about 1100 µm",
                [pushed >= 1100, pushed < 1101],
                at={key: value for key, value in place.items() if not key.has(psi_end)},
            ),
        ),
    )
