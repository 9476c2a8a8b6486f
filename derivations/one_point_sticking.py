"""One-point sticking contact: forces, turning and the sticking conditions (paper, eqs. 5 to 8).

Balance ``E v = w_n lambda_n + w_t lambda_t`` together with "the contact point moves with the tip"
is a linear system of five equations for the twist and the two forces; everything follows from its
solution. With ``A = d1 d2``, ``B = rho + d1^2``, ``C = rho + d2^2``, ``F = rho + d1^2 + d2^2``:
``lambda_n ~ N = A cos + B sin`` and ``lambda_t ~ D = C cos + A sin``.
"""

from __future__ import annotations

from typing import NamedTuple

import sympy as sp

from derivations._arc import Direction, degrees, turn
from derivations._circle import solve_linear, tidy
from derivations._claim import Claim
from derivations._derivation import Derivation, Function
from derivations._statement import (
    angle,
    as_written,
    crossed,
    for_all,
    identity,
    positive_by,
    require_zero,
    there_is,
)
from derivations._tex import tex
from derivations.mechanics import (
    PAPER,
    a,
    by_angle,
    coulomb,
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

A, B, C = d1 * d2, rho + d1**2, rho + d2**2
F = rho + d1**2 + d2**2
c, s = sp.cos(theta), sp.sin(theta)
HERE: Direction = (c, s)


def upper(A: sp.Expr, B: sp.Expr, C: sp.Expr) -> Direction:
    """Where sticking ends while the part turns counter-clockwise."""
    return -(A + mu * B), C + mu * A


def lower(A: sp.Expr, B: sp.Expr, C: sp.Expr) -> Direction:
    """Where sticking ends while the part turns clockwise."""
    return mu * B - A, C - mu * A


UPPER, LOWER = upper(A, B, C), lower(A, B, C)
LETTERS = sp.symbols("A B C")
STILL: Direction = (d2, d1)
"""Where the push goes through the centre and turns nothing."""
EXAMPLE = {**PAPER, d2: sp.Integer(350)}
IN_UM = "lengths in µm"


class Sticking(NamedTuple):
    """The solution of one-point sticking."""

    twist: sp.Matrix
    """(v_x, v_y, omega)"""
    normal: sp.Expr
    tangential: sp.Expr


def solve_sticking() -> Sticking:
    """Twist and contact forces of one-point sticking, from the balance alone."""
    v_x, v_y, omega, force_n, force_t = sp.symbols("v_x v_y omega lambda_n lambda_t", real=True)
    arm = d2 * a + d1 * n
    twist = sp.Matrix([v_x, v_y, omega])
    balance = film(twist) - wrench(-n * force_n + a * force_t, arm)
    moves_with_tip = velocity_at(twist, arm) - sp.Matrix([v_p, 0])
    unknowns = (v_x, v_y, omega, force_n, force_t)
    solution = solve_linear([*balance, *moves_with_tip], unknowns)
    *motion, normal, tangential = (solution[symbol] for symbol in unknowns)
    return Sticking(sp.Matrix(motion), normal, tangential)


class Scaled(NamedTuple):
    """Forces over ``e_x |v_p| / F`` and turn over ``|v_p| / F``: polynomials in cos and sin."""

    normal: sp.Expr
    tangential: sp.Expr
    turning: sp.Expr


def scaled(solved: Sticking) -> Scaled:
    """Free of drag and speed; the scale is positive because tips push along -x."""
    scale = -e_x * v_p / F
    return Scaled(
        by_angle(tidy(solved.normal / scale)),
        by_angle(tidy(solved.tangential / scale)),
        by_angle(tidy(-solved.twist[2] * F / v_p)),
    )


def derive() -> Derivation:
    """Derive eq. 5, compare with the print, and state the conditions to generate."""
    solved = solve_sticking()
    normal, tangential, turning = forces = scaled(solved)
    side = sp.Symbol("side", real=True)
    return Derivation(
        name="one_point_sticking",
        summary="One-point sticking contact (paper, eq. 5).",
        claims=(
            *_equation_5(solved),
            _sentence_under_5(forces),
            *_derivatives(solved),
            sticking_arc(forces),
            turning_over_the_arc(turning),
            _signs_before_6(solved),
            _lemma_1(forces),
            _uniqueness(),
        ),
        functions={
            "normal_force": Function(
                arguments=(theta, d1, d2, rho),
                results=(normal,),
                unit="m^2",
                meaning="lambda_n F / (e_x |v_p|), m^2: the tip pushes where it is positive",
            ),
            "friction_margin": Function(
                arguments=(theta, d1, d2, rho, mu),
                results=(by_angle(mu * normal - tangential), by_angle(mu * normal + tangential)),
                unit="m^2",
                meaning="mu lambda_n -+ lambda_t, same scale, m^2: "
                "both positive where the contact sticks",
            ),
            "stick_ratio": Function(
                arguments=(theta, d1, d2, rho),
                results=(tangential / normal,),
                unit="1",
                meaning="lambda_t/lambda_n of the sticking solution; the contact's own ratio is "
                "this one, clipped to [-mu, mu], wherever `only_solution` and `normal_force` are "
                "positive",
            ),
            "turning": Function(
                arguments=(theta, d1, d2, side),
                results=(side * turning,),
                unit="m",
                meaning="side F d(theta)/d(travel), m: positive where the part turns "
                "counter-clockwise (side = 1) or clockwise (side = -1)",
            ),
            "only_solution": Function(
                arguments=(d1, d2, rho, mu),
                results=(C - mu * A, C + mu * A),
                unit="m^2",
                meaning="m^2: both positive where a sticking solution excludes every slipping one",
            ),
        },
    )


def _equation_5(solved: Sticking) -> tuple[Claim, ...]:
    """Forces and turn as printed, with e_theta = rho e_x."""
    e_theta = rho * e_x
    f_d = e_theta + (d2**2 + d1**2) * e_x
    printed_n = -e_x * v_p * (d1 * d2 * e_x * c + (e_theta + d1**2 * e_x) * s) / f_d
    printed_t = -e_x * v_p * ((e_theta + d2**2 * e_x) * c + d1 * d2 * e_x * s) / f_d
    printed_turn = e_x * v_p * (d1 * c - d2 * s) / f_d
    steps = (
        r"Balance of the film's drag and the contact: $E v = w_n \lambda_n + w_t \lambda_t$, with "
        "the contact point at $d_2 a + d_1 n$ from the centre.",
        "Sticking: the part's point at the contact moves with the tip, $(v_p, 0)$. Five linear "
        "equations give $v_x, v_y, v_\\theta, \\lambda_n, \\lambda_t$.",
    )
    forces = scaled(solved)
    return (
        Claim(
            key="eq-5-normal-force",
            title="Normal force of one-point sticking",
            place="eq. (5), Section IX-C1",
            printed=r"$\lambda_n = -e_x v_p (d_1 d_2 e_x \cos\theta + (e_\theta + d_1^2 e_x) "
            r"\sin\theta)/f_d$, $f_d = e_\theta + (d_1^2 + d_2^2) e_x$",
            derived=rf"$\lambda_n = -e_x v_p N/F$ with $N = {_latex(forces.normal)}$ and "
            f"$F = {_latex(F)}$",
            steps=steps,
            of_print=(identity("printed $=$ derived", printed_n, solved.normal),),
        ),
        Claim(
            key="eq-5-turning",
            title="Turning of one-point sticking",
            place="eq. (5), Section IX-C1",
            printed=r"$v_\theta = e_x v_p (d_1 \cos\theta - d_2 \sin\theta)/f_d$",
            derived=rf"$v_\theta = -v_p\,({_latex(forces.turning)})/F$",
            steps=steps,
            of_print=(identity("printed $=$ derived", printed_turn, solved.twist[2]),),
        ),
        Claim(
            key="eq-5-ratio",
            title="Sticking condition of one point",
            place="eq. (5), Section IX-C1",
            printed=r"$|\lambda_n/\lambda_t| = |N/D| > 1/\mu$ and $\lambda_n > 0$",
            derived=rf"$|D| < \mu N$ with $D = {_latex(by_angle(-forces.tangential))}$; where $D = 0$ the "
            "printed quotient has no value and the contact sticks",
            steps=steps,
            of_print=(
                identity(
                    "printed ratio $=$ derived ratio, squared",
                    (printed_n / printed_t) ** 2,
                    (solved.normal / solved.tangential) ** 2,
                ),
                for_all(
                    r"with $\lambda_n > 0$ and $\lambda_t \ne 0$: $(\lambda_n/\lambda_t)^2 > "
                    r"1/\mu^2$ exactly where the force is inside Coulomb's cone",
                    [forces.normal > 0, sp.Ne(forces.tangential, 0)],
                    sp.Equivalent(
                        mu**2 * forces.normal**2 > forces.tangential**2, sp.And(*_inside(forces))
                    ),
                ),
            ),
        ),
    )


def _inside(forces: Scaled) -> tuple[sp.Basic, ...]:
    """The force lies strictly inside Coulomb's cone."""
    return (
        forces.normal > 0,
        mu * forces.normal - forces.tangential > 0,
        mu * forces.normal + forces.tangential > 0,
    )


def _sentence_under_5(forces: Scaled) -> Claim:
    """The sentence that turns the inequality round."""
    less = mu**2 * forces.normal**2 < forces.tangential**2
    # a push 1 um off the centre of an upright edge: nearly all force is normal
    push = {**PAPER, d2: sp.Integer(1), **angle(sp.Integer(1), theta)}
    return Claim(
        key="sentence-under-eq-5",
        title="Sense of the sticking condition",
        place="text under eq. (5), Section IX-C1",
        printed=r"“In order to form a sticking contact, the ratio of $\lambda_n/\lambda_t$ must be "
        r"less than $1/\mu$”",
        derived=r"The ratio must be greater than $1/\mu$, as eq. (5) itself says.",
        steps=(
            r"A force inside Coulomb's cone has $|\lambda_t| < \mu \lambda_n$; dividing by "
            r"$\mu |\lambda_t|$ gives $|\lambda_n/\lambda_t| > 1/\mu$.",
        ),
        of_print=(
            for_all(
                rf"every sticking contact has $|\lambda_n/\lambda_t| < 1/\mu$ ({IN_UM})",
                _inside(forces),
                less,
                at=push,
            ),
        ),
        checks=(
            for_all(
                "no sticking contact has the ratio that the sentence asks for",
                _inside(forces),
                sp.Not(less),
            ),
        ),
    )


def _derivatives(solved: Sticking) -> tuple[Claim, ...]:
    """Equations 7 and 8."""
    e_theta = rho * e_x
    below = (e_theta + d2**2 * e_x) * c + d1 * d2 * e_x * s
    printed_7 = e_theta * (e_theta + (d1**2 + d2**2) * e_x) / below**2
    printed_8 = -e_x * v_p * (d2 * c + d1 * s) / (e_theta + (d1**2 + d2**2) * e_x)
    ratio = -solved.normal / solved.tangential
    return (
        Claim(
            key="eq-7",
            title="Derivative of the force ratio",
            place="eq. (7), proof of Lemma 1",
            printed=r"$\partial(\lambda_n/\lambda_t)/\partial\theta = e_\theta (e_\theta + (d_1^2 "
            r"+ d_2^2) e_x) / ((e_\theta + d_2^2 e_x)\cos\theta + d_1 d_2 e_x \sin\theta)^2$",
            derived=r"$\partial(N/D)/\partial\theta = \rho F/D^2$, from $B C - A^2 = \rho F$; "
            "positive on each side of the pole $D = 0$, and $N/D$ jumps from $+\\infty$ to "
            "$-\\infty$ there",
            steps=(r"$N' D - N D' = B C - A^2$ because $N' = B c - A s$, $D' = A c - C s$.",),
            of_print=(identity("printed $=$ derived", printed_7, sp.diff(ratio, theta)),),
            checks=(identity(r"$B C - A^2 = \rho F$", B * C - A**2, rho * F),),
        ),
        Claim(
            key="eq-8",
            title="Derivative of the turning rate",
            place="eq. (8), proof of Lemma 1",
            printed=r"$\partial v_\theta/\partial\theta = -e_x v_p (d_2 \cos\theta + d_1 "
            r"\sin\theta)/(e_\theta + (d_1^2 + d_2^2) e_x)$",
            derived=rf"$\partial v_\theta/\partial\theta = {_latex(_compact_slope(solved))}$",
            of_print=(identity("printed $=$ derived", printed_8, sp.diff(solved.twist[2], theta)),),
        ),
    )


def _compact_slope(solved: Sticking) -> sp.Expr:
    return sp.factor(tidy(sp.diff(solved.twist[2], theta)))


def sticking_arc(forces: Scaled) -> Claim:
    """The exact set of orientations at which a contact sticks: an open arc between two directions."""
    from_lo, to_hi = turn(LOWER, HERE), turn(HERE, UPPER)
    return Claim(
        key="sticking-arc",
        title="Exact sticking interval of one point",
        place="new; replaces eq. (6)",
        derived=r"The contact sticks exactly for $\theta_{lo} < \theta < \theta_{hi}$ with "
        rf"$\theta_{{hi}} = \pi - {_atan2(-upper(*LETTERS)[0], upper(*LETTERS)[1])}$ and "
        rf"$\theta_{{lo}} = {_atan2(*lower(*LETTERS))}$, where $A = d_1 d_2$, $B = \rho + d_1^2$, "
        r"$C = \rho + d_2^2$. The arc is never empty and always shorter than $\pi$. Example "
        rf"($2 d_1 = 837$, $d_2 = 350$ µm, $\rho = 0.3769$ mm², $\mu = 0.33$): "
        f"{degrees(LOWER, EXAMPLE)}° to {degrees(UPPER, EXAMPLE)}°.",
        steps=(
            r"$\mu\lambda_n - |\lambda_t| > 0$ is a pair of inequalities linear in "
            r"$(\cos\theta, \sin\theta)$: two half planes through the origin.",
            rf"Their edges are the directions $({_latex(LOWER[0])}, {_latex(LOWER[1])})$ and "
            rf"$({_latex(UPPER[0])}, {_latex(UPPER[1])})$.",
            r"The cross product of the two is $2\mu\rho F > 0$, so the half planes meet in an arc "
            "that goes counter-clockwise from the first to the second, by less than half a turn.",
        ),
        hypotheses=(
            r"$\rho, d_1, \mu > 0$; $d_2$ of either sign",
            r"the tip moves towards the edge, $0 < \theta < \pi$: then no other motion exists "
            "(uniqueness under one contact)",
        ),
        checks=(
            identity(
                r"$\mu N + \lambda_t F/(e_x|v_p|)$ is the turn from $\theta_{lo}$ to $\theta$",
                mu * forces.normal + forces.tangential,
                from_lo,
            ),
            identity(
                r"$\mu N - \lambda_t F/(e_x|v_p|)$ is the turn from $\theta$ to $\theta_{hi}$",
                mu * forces.normal - forces.tangential,
                to_hi,
            ),
            identity(
                r"turn from $\theta_{lo}$ to $\theta_{hi}$ is $2\mu\rho F$",
                turn(LOWER, UPPER),
                2 * mu * rho * F,
            ),
            for_all(
                r"both turns positive imply $\lambda_n > 0$",
                [from_lo > 0, to_hi > 0],
                forces.normal > 0,
            ),
        ),
    )


def turning_over_the_arc(turning: sp.Expr) -> Claim:
    """In which sense the part turns within the sticking arc."""
    q = sp.symbols("q_x q_y", real=True)
    within = [turn(LOWER, q) > 0, turn(q, UPPER) > 0]
    lever = turning.subs({c: q[0], s: q[1]}, simultaneous=True)

    def at(direction: Direction) -> sp.Expr:
        return sp.expand(lever.subs({q[0]: direction[0], q[1]: direction[1]}, simultaneous=True))

    return Claim(
        key="turning-over-the-arc",
        title="Sense of turning while sticking",
        place="new",
        derived=r"While the contact sticks the part turns counter-clockwise throughout if $d_2 "
        r"\ge \mu d_1$ and clockwise throughout if $d_2 \le -\mu d_1$. For $|d_2| < \mu d_1$ the "
        r"sense changes at $\theta = \mathrm{atan2}(d_1, d_2)$, where the push goes through the "
        "centre and from which the part turns away on either side.",
        steps=(
            rf"The turning lever ${_latex(turning)}$ is linear in $(\cos\theta, \sin\theta)$; at "
            r"the ends of the arc it is $F (d_2 - \mu d_1)$ and $F (d_2 + \mu d_1)$, up to the "
            "positive length of the two directions.",
            "A linear function that is positive at both ends of an arc shorter than half a turn is "
            "positive within.",
        ),
        checks=(
            identity(r"lever at $\theta_{lo}$", at(LOWER), F * (d2 - mu * d1)),
            identity(r"lever at $\theta_{hi}$", at(UPPER), F * (d2 + mu * d1)),
            for_all(
                r"counter-clockwise in the whole arc if $d_2 \ge \mu d_1$",
                [*within, d2 >= mu * d1],
                lever > 0,
            ),
            for_all(
                r"clockwise in the whole arc if $d_2 \le -\mu d_1$",
                [*within, d2 <= -mu * d1],
                lever < 0,
            ),
            for_all(
                r"for $|d_2| < \mu d_1$ the direction $(d_2, d_1)$ lies in the arc",
                [d2 < mu * d1, -d2 < mu * d1],
                sp.And(turn(LOWER, STILL) > 0, turn(STILL, UPPER) > 0),
            ),
            identity("the lever is the turn from that direction", lever, crossed(STILL, q)),
        ),
    )


def _signs_before_6(solved: Sticking) -> Claim:
    """The proof's "both derivatives are strictly positive before theta reaches (6)"."""
    slope = d2 * c + d1 * s  # of v_theta, up to a positive factor
    require_zero(sp.diff(solved.twist[2], theta) * F / -v_p - slope, "slope of v_theta")
    place = {**PAPER, d2: sp.Integer(700), **angle(sp.Rational(12, 5), theta)}
    return Claim(
        key="proof-of-lemma-1",
        title="Where the derivatives (7) and (8) are positive",
        place="proof of Lemma 1, under eq. (8)",
        printed=r"“both derivatives are strictly positive before $\theta$ reaches (6)”, "
        r"$\pi - \max\{\tan^{-1}(d_1/d_2),\ \tan^{-1}(d_1 d_2 e_x/(e_\theta + d_1^2 e_x))\}$",
        derived=r"(8) is positive up to $\pi - \tan^{-1}(d_2/d_1)$: the quotient in (6) stands "
        r"upside down. It is not needed: $v_\theta$ itself stays positive up to $\pi + "
        r"\tan^{-1}(d_1/d_2)$. The second term of (6) is where $\lambda_n$ vanishes, $N = 0$; "
        r"the magnitude of the ratio falls from $D = 0$ on, $\theta = \pi - \tan^{-1}(C/A)$.",
        steps=(
            r"$d_2 \cos\theta + d_1 \sin\theta = R \cos(\theta - \delta)$ with $\delta = "
            r"\mathrm{atan2}(d_1, d_2)$ is positive for $\theta < \delta + \pi/2$.",
        ),
        of_print=(
            for_all(
                f"(8) is positive before (6) ({IN_UM})",
                [d2 > 0, s > 0, *_before_6()],
                slope > 0,
                at=place,
            ),
        ),
        checks=(
            identity(
                r"(8) is the turn from $\theta$ to $\pi - \tan^{-1}(d_2/d_1)$",
                as_written(lambda: sp.Derivative(solved.twist[2], theta) * F / -v_p),
                crossed(HERE, (-d1, d2)),
            ),
            identity(
                r"$\lambda_n$ is the turn from $\theta$ to $\pi - \tan^{-1}(A/B)$",
                scaled(solved).normal,
                turn(HERE, (-B, A)),
            ),
            identity(
                r"$\lambda_t$ is the turn from $\theta$ to $\pi - \tan^{-1}(C/A)$",
                -scaled(solved).tangential,
                turn(HERE, (-A, C)),
            ),
            identity(
                r"$v_\theta$ is the turn from $\tan^{-1}(d_1/d_2)$ to $\theta$",
                scaled(solved).turning,
                crossed(STILL, HERE),
            ),
        ),
    )


def _before_6() -> tuple[sp.Basic, ...]:
    """``theta < pi - atan(p/q)`` for both terms of (6): ``q sin + p cos > 0`` in the upper half."""
    return (d2 * s + d1 * c > 0, B * s + A * c > 0)


def _lemma_1(forces: Scaled) -> Claim:
    """Lemma 1 as printed, the exact witness against it, and what replaces it."""
    start = sp.Symbol("theta_0", real=True)
    begun = [r.subs(theta, start) for r in (*_inside(forces), forces.turning > 0, s > 0)]
    first: Direction = (sp.cos(start), sp.sin(start))
    later = turn(first, HERE)
    q0, q1 = sp.symbols("p_x p_y", real=True), sp.symbols("q_x q_y", real=True)
    slipping = {**EXAMPLE, **angle(sp.Integer(1), start), **angle(sp.Rational(48, 25), theta)}
    example = {"d1": "418.5", "d2": "350"}
    printed_limit = degrees((-d2, d1), EXAMPLE)
    return Claim(
        key="lemma-1",
        title="Lemma 1: sticking and turning until (6)",
        place="Lemma 1 and eq. (6), Section IX-C1",
        printed=r"A part that starts to turn counter-clockwise with sticking contact keeps doing "
        r"so until $\theta$ reaches $\pi - \max\{\tan^{-1}(d_1/d_2),\ \tan^{-1}(d_1 d_2 e_x/"
        r"(e_\theta + d_1^2 e_x))\}$",
        derived=r"It keeps sticking and turning exactly until $\theta_{hi} = \pi - "
        rf"{_atan2(-upper(*LETTERS)[0], upper(*LETTERS)[1])}$ (or until $\pi$, where the tip no "
        r"longer moves towards the edge); the turning never ends first. "
        rf"Example ($d_1 = {example['d1']}$, $d_2 = {example['d2']}$ "
        rf"µm, $\rho = 0.3769$ mm², $\mu = 0.33$): printed {printed_limit}°, exact "
        f"{degrees(UPPER, EXAMPLE)}°.",
        steps=(
            r"$|N/D|$ does grow with $\theta$, (7), but only up to the pole at $D = 0$; beyond it "
            r"$N/D$ grows from $-\infty$, so $|N/D|$ falls, and sticking is lost where $-D = \mu N$.",
            r"The sticking orientations are an arc (see the exact sticking interval), so a part "
            "inside it stays inside until it reaches the end that it turns towards.",
            r"The turning lever is linear in the direction, positive at the start and, as "
            r"$F (d_2 + \mu d_1)$, at the far end; so it is positive in between.",
        ),
        of_print=(
            for_all(
                f"a part that sticks and turns at $\\theta_0$ sticks at every later $\\theta$ "
                f"before (6) ({IN_UM})",
                [d2 > 0, *begun, s > 0, later > 0, *_before_6()],
                sp.And(*_inside(forces)),
                at=slipping,
            ),
        ),
        checks=(
            positive_by(
                r"sticking between the start and $\theta_{hi}$, lower limit",
                turn(LOWER, q1),
                {
                    "lo_start": turn(LOWER, q0),
                    "start_hi": turn(q0, UPPER),
                    "later": turn(q0, q1),
                    "to_hi": turn(q1, UPPER),
                    "width": turn(LOWER, UPPER),
                },
                multiplier="start_hi",
                combination="lo_start*to_hi + width*later",
            ),
            for_all(
                r"a part that sticks and turns counter-clockwise has $d_2 + \mu d_1 > 0$",
                [turn(LOWER, q0) > 0, turn(q0, UPPER) > 0, turn(STILL, q0) > 0],
                d2 + mu * d1 > 0,
            ),
            positive_by(
                r"turning between the start and $\theta_{hi}$",
                turn(STILL, q1),
                {
                    "start_hi": turn(q0, UPPER),
                    "to_hi": turn(q1, UPPER),
                    "later": turn(q0, q1),
                    "lever_start": turn(STILL, q0),
                    "beyond": d2 + mu * d1,
                    "F": F,
                },
                multiplier="start_hi",
                combination="lever_start*to_hi + F*beyond*later",
            ),
            identity(
                "the lever of the certificate is the one derived",
                forces.turning,
                crossed(STILL, HERE),
            ),
        ),
    )


def _uniqueness() -> Claim:
    """At most one motion under one Coulomb contact, whatever the tip does."""
    first, second = _contact("1"), _contact("2")
    u_t, u_n = sp.symbols("u_t u_n", real=True)
    clear = [C - mu * A > 0, C + mu * A > 0]
    same = sp.And(*(sp.Eq(p, q) for p, q in zip(first[0], second[0], strict=True)))
    # mu = 2 and an offset beyond the centre: a wedge; one solution sticks, in the other the part leaves
    double = {
        d1: 1, d2: -1, rho: sp.Rational(1, 4), mu: 2, u_t: sp.Rational(7, 2), u_n: 1,
    }  # fmt: skip
    forces = {first[0][0]: 1, first[0][1]: sp.Rational(3, 2), second[0][0]: 0, second[0][1]: 0}
    return Claim(
        key="uniqueness-one-contact",
        title="Uniqueness of the motion under one contact",
        place="new; the paper's remark on uniqueness concerns two contacts",
        derived=r"Under one Coulomb contact on a film there is at most one motion if the tip moves "
        r"towards the edge, whatever friction and film. If it moves along the edge or away, the same "
        r"holds if $\rho + d_2^2 > \mu d_1 |d_2|$; otherwise two motions can exist.",
        steps=(
            "In the edge's own frame the balance gives the part's velocity at the contact as a "
            "linear function of the two forces; with Coulomb's law and unilateral contact written "
            "out, two different solutions are shown to be impossible.",
        ),
        hypotheses=(
            r"for tips that do not move towards the edge: $\rho + d_2^2 > \mu d_1 |d_2|$, which holds "
            r"for all $d_2$ if $4\rho > \mu^2 d_1^2$",
        ),
        checks=(
            for_all(
                "a tip that moves towards the edge: two solutions of the complete law are equal",
                [u_n < 0, *first[1], *second[1]],
                same,
            ),
            for_all(
                "under the hypothesis, any tip: two solutions of the complete law are equal",
                [*clear, *first[1], *second[1]],
                same,
            ),
            there_is(
                "without the hypothesis two solutions exist side by side",
                [*first[1], *second[1], sp.Not(same)],
                at={**double, **forces},
            ),
            for_all(
                r"$4\rho > \mu^2 d_1^2$ implies the hypothesis",
                [4 * rho > mu**2 * d1**2],
                sp.And(*clear),
            ),
        ),
    )


def _contact(tag: str) -> tuple[tuple[sp.Expr, sp.Expr], tuple[sp.Basic, ...]]:
    """Forces of one contact and all that holds of them, in the edge's frame; drag e_x = 1."""
    u_t, u_n = sp.symbols("u_t u_n", real=True)
    normal, tangential = sp.symbols(f"lambda_n{tag} lambda_t{tag}", real=True)
    edge = {theta: 0}
    arm = (d2 * a + d1 * n).subs(edge)
    along, out = a.subs(edge), n.subs(edge)
    push = wrench(-out * normal + along * tangential, arm)
    twist = film(sp.eye(3)[:, 0] + sp.eye(3)[:, 1] + sp.eye(3)[:, 2])  # drag of unit velocities
    moved = sp.Matrix([p * e_x / drag for p, drag in zip(push, twist, strict=True)])
    velocity = velocity_at(moved, arm)
    slip = sp.expand(rho * (velocity.dot(along) - u_t))
    opening = sp.expand(-rho * (velocity.dot(out) - u_n))
    return (normal, tangential), coulomb(normal, tangential, slip, opening)


def _atan2(cosine: sp.Expr, sine: sp.Expr) -> str:
    return rf"\mathrm{{atan2}}({_latex(sine)},\ {_latex(cosine)})"


def _latex(expression: sp.Expr) -> str:
    return tex(expression).strip("$")
