"""Existence and uniqueness of the two-sided rotation (paper, eq. 10 and the remark below it).

``T`` is the distance of the two contacts along the edges, ``w`` the width of the part. Write the
forces as ``L_D, L_S`` with friction ratios ``tau_D, tau_S`` in [-mu, mu]; both forces carry the
denominator ``T + d1 (tau_D - tau_S)``, whose least value is ``T - mu w``. The slide rate ``r`` of
the centre is monotone in each ratio as long as the denominator does not vanish. Walking the ratios
from (-mu, -mu) over a middle corner to (mu, mu) passes every combination that Coulomb's law allows,
in the order in which ``r`` passes the rates at which a tip sticks: existence is the intermediate
value theorem on that walk, uniqueness its monotony.
"""

from __future__ import annotations

from typing import NamedTuple

import sympy as sp
from sympy.logic.boolalg import Boolean

from derivations._circle import solve_linear, tidy
from derivations._claim import Claim
from derivations._derivation import Derivation
from derivations._statement import (
    Finding,
    Point,
    angle,
    for_all,
    identity,
    there_is,
    together,
)
from derivations.mechanics import (
    PAPER,
    a,
    coulomb,
    d1,
    e_x,
    film,
    mu,
    n,
    rho,
    theta,
    velocity_at,
    wrench,
)
from derivations.two_sided_rotation import (
    T,
    V,
    h,
    sigma,
    tau_D,
    tau_S,
    two_contact_balance,
    w,
)

c, s = sp.cos(theta), sp.sin(theta)
CLOSING = T * c + w * s  # this is h: positive while the tips approach each other
SEPARATION = sp.Integer(857)
"""Of the tips across the push, um: what eq. 10 asks for with errors of 5 um."""
ALONG_AND_AHEAD = sp.Integer(480)
"""T + h, um: the instant at which the line through the contacts has just entered both cones."""
WEDGED = {
    d1: sp.Integer(1), rho: sp.Integer(1), mu: sp.Rational(1, 2), T: sp.Rational(9, 10),
    sigma: sp.Integer(0), **angle(sp.Rational(9, 2), theta),
}  # fmt: skip
"""Lengths in half widths; separation 2.19, which eq. 10 allows."""


class Law(NamedTuple):
    """Forces of both tips and all that must hold of them."""

    forces: tuple[sp.Symbol, ...]
    """(normal at D, tangential at D, normal at S, tangential at S)"""
    motion: tuple[sp.Expr, ...]
    """The part's twist in the edge's frame, times the drag."""
    slips: tuple[sp.Expr, sp.Expr]
    openings: tuple[sp.Expr, sp.Expr]
    relations: tuple[Boolean, ...]


def law(tag: str = "") -> Law:
    """The complete quasi-static problem of part, film, moving tip D and resting tip S."""
    names = " ".join(f"{kind}_{tip}{tag}" for tip in "DS" for kind in ("N", "R"))
    N_D, R_D, N_S, R_S = sp.symbols(names, real=True)
    edge = {theta: 0}
    along, out = a.subs(edge), n.subs(edge)
    at_D = (T / 2 - sigma) * along + d1 * out
    at_S = (-T / 2 - sigma) * along - d1 * out
    push = wrench(-out * N_D + along * R_D, at_D) + wrench(out * N_S + along * R_S, at_S)
    drag = film(sp.ones(3, 1))
    twist = sp.Matrix([p * e_x / k for p, k in zip(push, drag, strict=True)])
    speed_D = -c * along - s * out  # one unit along -x, seen from the edge
    moved_D, moved_S = velocity_at(twist, at_D) - speed_D, velocity_at(twist, at_S)
    slips = tuple(sp.expand(rho * moved.dot(along)) for moved in (moved_D, moved_S))
    openings = sp.expand(-rho * moved_D.dot(out)), sp.expand(rho * moved_S.dot(out))
    relations = (
        *coulomb(N_D, R_D, slips[0], openings[0]),
        *coulomb(N_S, R_S, slips[1], openings[1]),
    )
    return Law((N_D, R_D, N_S, R_S), tuple(twist), (slips[0], slips[1]), openings, relations)


def derive() -> Derivation:
    """Derive when a motion exists and when it is the only one."""
    balance = _Balance.derived()
    existence = _existence(balance)
    return Derivation(
        name="rotation_existence",
        summary="Existence and uniqueness of the two-sided rotation (eq. 10 and its remark).",
        claims=(
            _pointed_cone(),
            _equation_10(),
            existence,
            _jam(balance),
            _uniqueness(existence),
        ),
    )


def _pointed_cone() -> Claim:
    """The printed condition for pointed cones, and the derived one."""
    forces = _inner_forces()
    place = _configuration()
    along = dict(zip(forces.symbols, (w, -T, w, T), strict=True))  # the line through both contacts
    wedge = {force: value.subs(place) for force, value in along.items()}
    return Claim(
        key="remark-pointed-cone",
        title="Pointed cone, needed for existence",
        place="remark under eq. (11), Section IX-C3",
        printed=r"“In order to guarantee existence, the pointed cone assumption requires $d_v \ge "
        r"d_w \tan\sigma$, where $\sigma = \tan^{-1}\mu$ is the angle of the friction cone. This is "
        r"clearly satisfied by (10).”",
        derived=r"The cones are pointed exactly where $T > \mu d_w$, $T$ being the distance of the "
        r"contacts along the edges; while the tips pass each other $T$ falls to "
        r"$\sqrt{d_v^2 - d_w^2}$, so the whole push needs $d_v > d_w \sqrt{1 + \mu^2}$. The print "
        r"puts $d_v$ in the place of $T$.",
        steps=(
            "Two forces without resultant act along the line through both contacts, $T a + d_w n$.",
            r"That line lies inside both friction cones exactly if $T \le \mu d_w$.",
            r"$T^2 = h^2 + d_v^2 - d_w^2$ is least when the tips pass each other, $h = 0$.",
        ),
        of_print=(
            for_all(
                r"$d_v \ge \mu d_w$ excludes inner forces (lengths in µm; $d_v = 857$, the paper's "
                f"part, tips {float(place[h]):.1f} µm before they pass)",
                [mu * w <= V, *forces.balanced, *forces.in_cones],
                forces.vanish,
                at={**place, **wedge},
            ),
        ),
        checks=(
            for_all(
                r"$T > \mu d_w$ excludes inner forces",
                [mu * w < T, *forces.balanced, *forces.in_cones],
                forces.vanish,
            ),
            for_all(
                r"$T \le \mu d_w$ allows them: forces $(d_w, T)$ along the line through both contacts",
                [mu * w >= T],
                sp.And(*(r.subs(along) for r in (*forces.balanced, *forces.in_cones))),
            ),
            for_all(
                r"$d_v > d_w\sqrt{1 + \mu^2}$ gives $T > \mu d_w$ at every $h$",
                [sp.Eq(T**2, h**2 + V**2 - w**2), w**2 * (1 + mu**2) < V**2],
                mu * w < T,
            ),
            for_all(
                r"otherwise $T \le \mu d_w$ where the tips pass",
                [sp.Eq(T**2, V**2 - w**2), w**2 * (1 + mu**2) >= V**2],
                mu * w >= T,
            ),
        ),
    )


class _Inner(NamedTuple):
    symbols: tuple[sp.Symbol, ...]
    balanced: tuple[Boolean, ...]
    in_cones: tuple[Boolean, ...]
    vanish: Boolean


def _inner_forces() -> _Inner:
    """Forces of both tips that balance each other without any drag."""
    problem = law()
    N_D, R_D, N_S, R_S = problem.forces
    cones = (
        N_D >= 0, N_S >= 0, mu * N_D >= R_D, mu * N_D >= -R_D, mu * N_S >= R_S, mu * N_S >= -R_S
    )  # fmt: skip
    none = tuple(sp.Eq(sp.numer(sp.together(component)), 0) for component in problem.motion)
    return _Inner(problem.forces, none, cones, sp.And(sp.Eq(N_D, 0), sp.Eq(N_S, 0)))


def _configuration() -> Point:
    """The paper's part between the tips: T, h and orientation that belong to the separation."""
    width = 2 * PAPER[d1]
    difference = (SEPARATION**2 - width**2) / ALONG_AND_AHEAD  # T - h
    along, ahead = (ALONG_AND_AHEAD + difference) / 2, (ALONG_AND_AHEAD - difference) / 2
    square = along**2 + width**2
    return {
        **PAPER,
        sigma: sp.Integer(0),
        T: along,
        V: SEPARATION,
        h: ahead,
        c: (along * ahead - width * SEPARATION) / square,
        s: (width * ahead + along * SEPARATION) / square,
    }


def _equation_10() -> Claim:
    """At the printed separation the problem has no solution."""
    problem = law()
    place = _configuration()
    numbers = [relation.subs(place, simultaneous=True) for relation in problem.relations]
    limit = float(2 * PAPER[d1] * sp.sqrt(1 + PAPER[mu] ** 2))
    return Claim(
        key="eq-10",
        title="Separation that guarantees the rotation",
        place="eq. (10), Section IX-C3",
        printed=r"$d_v \ge d_w + 2 s_x^u + 2 c_{\tilde u}^u$ guarantees “the intended rotation "
        r"under sensing and control uncertainties”",
        derived=r"The motion exists throughout if $d_v > d_w\sqrt{1 + \mu^2}$ (see the existence "
        rf"theorem). At $d_w = 837$ µm and $\mu = 0.33$ that is {limit:.1f} µm; eq. (10) with "
        "errors of 5 µm gives 857 µm, and there the part jams: no contact mode has a solution.",
        steps=(
            "Balance, unilateral contact and Coulomb's law of both tips are written out for the "
            "paper's part at the printed separation, at the instant at which the line through both "
            r"contacts has just entered both friction cones ($T$ slightly below $\mu d_w$).",
            "No forces satisfy them: every combination of sticking, slipping and separating is "
            "excluded at once.",
        ),
        of_print=(
            together(
                rf"a motion exists at $d_v = 857$ µm, $h = {float(place[h]):.1f}$ µm, $\rho = 0.3769$ "
                r"mm², $\mu = 0.33$, part centred between the tips",
                *numbers,
            ),
        ),
        checks=(
            there_is(
                r"the configuration is one that (10) allows, and $d_v < d_w\sqrt{1 + \mu^2}$",
                [
                    w + 20 <= V,
                    w**2 * (1 + mu**2) > V**2,
                    sp.Eq(h, T * c + w * s),
                    sp.Eq(V, T * s - w * c),
                ],
                at=place,
            ),
        ),
    )


class _Balance(NamedTuple):
    """Numerators of the two forces, and the slide rate, as functions of both friction ratios."""

    active: sp.Expr
    """L_D T (T + d1 (tau_D - tau_S)) / sin(theta)"""
    passive: sp.Expr
    rate: sp.Expr
    grip: sp.Expr

    @classmethod
    def derived(cls) -> _Balance:
        """From the balance of forces."""
        L_D, L_S, slide = two_contact_balance()
        grip = T + d1 * (tau_D - tau_S)
        active, passive = (tidy(L * T * grip / s) for L in (L_D, L_S))
        return cls(active, passive, slide, grip)

    def at(self, expression: sp.Expr, ratio_D: sp.Expr, ratio_S: sp.Expr) -> sp.Expr:
        """An expression at given ratios."""
        return expression.subs({tau_D: ratio_D, tau_S: ratio_S}, simultaneous=True)

    def pressing(self) -> tuple[Boolean, ...]:
        """Both numerators positive for all ratios; they are affine in the ratios."""
        return tuple(
            self.at(force, sign * mu, sign * mu) > 0
            for force in (self.active, self.passive)
            for sign in (1, -1)
        )


PRESSING = (
    r"both tips press for all ratios: $\rho + p_S(p_S \pm \mu d_1) > 0$ and $\rho + p_S (p_D \pm "
    r"\mu d_1) > 0$, $p_D, p_S = \pm T/2 - \sigma$"
)
WALK = (
    r"Balance gives $L_D = \sin\theta\,(\rho + p_S(p_S + d_1\tau_S))/(T g)$, $L_S = \sin\theta\,"
    r"(\rho + p_S(p_D + d_1\tau_D))/(T g)$ with $g = T + d_1(\tau_D - \tau_S) \ge T - \mu d_w$.",
    r"The slips at the tips are $r \pm h/(2T)$, $r$ the slide rate of the centre; so the tips "
    r"cannot both stick unless $h = 0$, and while $h > 0$ the slip at D is the larger one.",
    r"Coulomb's law then allows, in the order of falling $r$: both slip up $(-\mu, -\mu)$; S "
    r"sticks $(-\mu, \tau_S)$; D slips up and S down $(-\mu, \mu)$; D sticks $(\tau_D, \mu)$; "
    r"both slip down $(\mu, \mu)$: one walk through the ratios. For $h < 0$ the middle corner is "
    r"$(\mu, -\mu)$.",
)


def _states(r_0: sp.Symbol, r_m: sp.Symbol, r_e: sp.Symbol, g: sp.Symbol) -> tuple[Boolean, ...]:
    """Which state of the walk holds, from the slide rates at its corners; they stick at +-g/2."""
    up, down = g / 2, -g / 2
    return (
        r_0 >= up,
        sp.Or(sp.And(r_0 < up, r_m > up), sp.And(r_0 > up, r_m < up)),
        sp.And(r_m <= up, r_m >= down),
        sp.Or(sp.And(r_m < down, r_e > down), sp.And(r_m > down, r_e < down)),
        r_e <= down,
    )


def _walk_is_continuous(balance: _Balance) -> tuple[Finding, ...]:
    inside = [tau_D <= mu, tau_D >= -mu, tau_S <= mu, tau_S >= -mu]
    return (
        for_all(
            r"$T > \mu d_w$: the denominator is positive for all ratios",
            [mu * w < T, *inside],
            balance.grip > 0,
        ),
        for_all(
            r"while the tips draw apart ($h < 0$) it is positive on the walk, whatever $T$",
            [*inside, sp.Or(sp.Eq(tau_S, -mu), sp.Eq(tau_D, mu))],
            balance.grip > 0,
        ),
    )


def _both_press(balance: _Balance) -> tuple[Finding, ...]:
    """No motion in which a tip carries no force: pressing tips stay in contact."""
    problem = law()
    N_D, R_D, N_S, R_S = problem.forces
    unit = {d1: sp.Integer(1)}
    # directions of any length, so that the circle does not burden the solver
    plain = {**unit, c: sp.Symbol("a_x", real=True), s: sp.Symbol("a_y", real=True)}
    approaching = [r.subs(plain) for r in (s > 0, *balance.pressing())]
    return tuple(
        for_all(
            f"no motion without force at {name} (half width 1)",
            approaching,
            sp.Not(sp.And(*(r.subs({**plain, normal: 0, along: 0}) for r in problem.relations))),
        )
        for name, normal, along in (("S", N_S, R_S), ("D", N_D, R_D))
    )


def _existence(balance: _Balance) -> Claim:
    """Existence, and uniqueness, of the motion between two tips."""
    r_0, r_m, r_e = sp.symbols("r_0 r_m r_e", real=True)
    g = sp.Symbol("g", real=True)  # h/T
    states = _states(r_0, r_m, r_e, g)
    exclusive = [sp.Not(sp.And(p, q)) for k, p in enumerate(states) for q in states[:k]]
    first = balance.at(balance.rate, -mu, mu) - balance.at(balance.rate, -mu, -mu)
    last = balance.at(balance.rate, mu, mu) - balance.at(balance.rate, -mu, mu)
    scale = 2 * mu * s / T**2
    return Claim(
        key="no-jam",
        title="The rotation exists, and is unique, if the tips are far enough apart",
        place="new; replaces eq. (10) and both remarks below it",
        derived=r"If $d_v > d_w\sqrt{1 + \mu^2}$ and both tips press, then at every instant of the "
        "two-sided rotation exactly one motion satisfies balance and Coulomb's law: no jam and no "
        r"choice. After the tips have passed each other ($h < 0$) a motion exists for every $d_v$.",
        steps=(
            *WALK,
            "The rate is continuous along the walk where the denominator stays positive; whichever "
            "values it has at the three corners, some state holds (intermediate value theorem).",
            r"Along the walk the rate changes by $\frac{2\mu\sin\theta}{T^2}$ times the numerators "
            "of the two forces, which are positive: it increases, and then exactly one of the five "
            "states holds.",
        ),
        hypotheses=(r"$d_v > d_w\sqrt{1 + \mu^2}$", PRESSING, "the same $\\mu$ at both tips"),
        checks=(
            *_walk_is_continuous(balance),
            for_all(
                r"one of the five states holds, whatever the corner rates ($h \ge 0$)",
                [g >= 0],
                sp.Or(*states),
            ),
            *_both_press(balance),
            identity(
                r"$r(-\mu, \mu) - r(-\mu, -\mu)$ is a positive multiple of $L_S$'s numerator",
                first,
                scale * balance.at(balance.passive, -mu, -mu),
            ),
            identity(
                r"$r(\mu, \mu) - r(-\mu, \mu)$ is a positive multiple of $L_D$'s numerator",
                last,
                scale * balance.at(balance.active, mu, mu),
            ),
            identity(
                r"$h < 0$: $r(\mu, -\mu) - r(-\mu, -\mu)$, likewise with $L_D$",
                balance.at(balance.rate, mu, -mu) - balance.at(balance.rate, -mu, -mu),
                scale * balance.at(balance.active, -mu, -mu),
            ),
            identity(
                r"$h < 0$: $r(\mu, \mu) - r(\mu, -\mu)$, likewise with $L_S$",
                balance.at(balance.rate, mu, mu) - balance.at(balance.rate, mu, -mu),
                scale * balance.at(balance.passive, mu, mu),
            ),
            for_all(
                "corner rates that increase leave exactly one state",
                [r_0 < r_m, r_m < r_e, g >= 0],
                sp.And(*exclusive),
            ),
            identity(
                "slip at D less slip at S is $h/T$",
                _slip_difference(),
                CLOSING / T,
            ),
        ),
    )


def _slip_difference() -> sp.Expr:
    """Slip at D less slip at S, per travel, from the velocities of a rigid part on both tips."""
    problem = law()
    solved = solve_linear(problem.openings, (problem.forces[0], problem.forces[2]))
    return ((problem.slips[0] - problem.slips[1]) / rho).subs(solved)


def _jam(balance: _Balance) -> Claim:
    """Closer together, the part jams before the tips pass."""
    rate, past = sp.symbols("r g", real=True)  # g = h/T
    slip_D, slip_S = rate + past / 2, rate - past / 2
    grip = balance.grip
    numerator = sp.expand(tidy(2 * balance.rate * T * grip))
    corner = sp.expand(tidy(2 * balance.at(balance.rate, mu, mu) * T**2)) + CLOSING * T
    both = (
        *coulomb(sp.Integer(1), tau_D, slip_D, sp.Integer(0)),
        *coulomb(sp.Integer(1), tau_S, slip_S, sp.Integer(0)),
    )
    situation = (
        T > 0, s > 0, past > 0, sp.Eq(past * T, CLOSING), mu * w > T, corner > 0,
        *balance.pressing(), sp.Eq(2 * rate * T * grip, numerator), *both,
    )  # fmt: skip
    # all is homogeneous in (cos, sin, r, g), so any vector along the edge will do for (cos, sin)
    plain = {d1: sp.Integer(1), **dict(zip((c, s), sp.symbols("a_x a_y", real=True), strict=True))}
    return Claim(
        key="jam",
        title="The part jams between tips that are too close",
        place="new; what happens at the separation of eq. (10)",
        derived=r"While the tips approach each other ($h > 0$) and $T < \mu d_w$, no contact mode "
        "has a solution if both tips press and D would slip up even with both friction forces "
        r"driving the part up along the edge. For $d_v < d_w\sqrt{1 + \mu^2}$ there is such a "
        r"stretch $T < \mu d_w$, $h > 0$; a push that satisfies the conditions in it jams where it "
        r"enters it. Where $\rho + \sigma^2 > d_1^2(1 + \mu^2)$, as for the paper's part, the slip at D "
        "is up wherever a push enters the stretch: with both tips pressing it jams. A part for which "
        "that is not so need not jam: two motions can exist there (see the uniqueness of the rotation).",
        steps=(
            *WALK[:2],
            r"For $T < \mu d_w$ the denominator vanishes inside the allowed ratios; on one side of "
            "it the forces would have to pull, on the other the slips have the wrong sense.",
        ),
        hypotheses=(
            PRESSING,
            r"$r(\mu, \mu) + h/(2T) > 0$, the slip at D with both ratios at $\mu$",
            r"$h > 0$, $T < \mu d_w$",
        ),
        checks=(
            *_both_press(balance),
            for_all(
                "ratios within the cones that fit their slips need a tip to pull (half width 1)",
                [relation.subs(plain) for relation in situation],
                sp.Not(sp.And(balance.active * grip > 0, balance.passive * grip >= 0)).subs(plain),
            ),
            for_all(
                r"D slips up where a push enters the stretch, $T = \mu d_w$, if $\rho + \sigma^2 > d_1^2"
                r"(1 + \mu^2)$",
                [sp.Eq(T, mu * w), s > 0, CLOSING >= 0, rho + sigma**2 > d1**2 * (1 + mu**2)],
                corner > 0,
            ),
            for_all(
                r"so it does for every slide of the paper's part, $\mu \le 0.36$ (µm)",
                [sp.Eq(d1, PAPER[d1]), sp.Eq(rho, PAPER[rho]), mu <= sp.Rational(36, 100)],
                rho + sigma**2 > d1**2 * (1 + mu**2),
            ),
            there_is(
                r"the two motions of the uniqueness remark are in a stretch where this fails",
                [mu * w > T, CLOSING > 0, rho + sigma**2 < d1**2 * (1 + mu**2)],
                at=WEDGED,
            ),
        ),
    )


def _uniqueness(existence: Claim) -> Claim:
    """What the paper could not guarantee, and what can be."""
    first, second = law("1"), law("2")
    forces = {
        **_mode(first, WEDGED, stick_D=True),
        **_mode(second, WEDGED, stick_D=False),
    }
    rates = [twist.subs(WEDGED).subs(forces) for twist in (first.motion[0], second.motion[0])]
    return Claim(
        key="remark-uniqueness",
        title="Uniqueness of the two-sided rotation",
        place="remark under eq. (11), Section IX-C3",
        printed="“for this motion, one cannot guarantee uniqueness of the resulting trajectory”",
        derived=r"So it is at separations that (10) allows: two motions can exist side by side. "
        r"But for $d_v > d_w\sqrt{1 + \mu^2}$ and tips that press the motion is unique at every "
        "instant (see the existence theorem): uniqueness can be guaranteed.",
        steps=(
            "At the witness the tips still approach each other: with D sticking and S slipping, "
            "and with both slipping, all conditions hold; the part slides at "
            f"${sp.latex(rates[0])}$ or ${sp.latex(rates[1])}$ of the push speed along its edge.",
        ),
        hypotheses=(r"for uniqueness: $d_v > d_w\sqrt{1 + \mu^2}$", PRESSING),
        of_print=(
            there_is(
                r"two different motions at a separation that (10) allows (half width 1, $\rho = "
                r"1$, $\mu = 1/2$)",
                [
                    *first.relations,
                    *second.relations,
                    T * s - w * c > sp.Rational(857, 837) * w,
                    sp.Ne(first.motion[0], second.motion[0]),
                ],
                at={**WEDGED, **forces},
            ),
        ),
        sharper=existence.checks,
    )


def _mode(problem: Law, at: Point, *, stick_D: bool) -> dict[sp.Symbol, sp.Expr]:
    """Forces at a point with D sticking, or slipping down, and S slipping down."""
    N_D, R_D, N_S, R_S = problem.forces
    friction_D = problem.slips[0] if stick_D else R_D - mu * N_D
    equations = [*problem.openings, friction_D, R_S - mu * N_S]
    (solved,) = sp.solve(
        [equation.subs(at, simultaneous=True) for equation in equations],
        problem.forces,
        dict=True,
    )
    return dict(solved)
