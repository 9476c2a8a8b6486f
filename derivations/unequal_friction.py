"""The rotation between two tips of different friction: existence, uniqueness, jam.

Notation of ``two_sided_rotation``; ``mu_D``, ``mu_S`` are the coefficients at the moving and at the
resting tip. ``r`` is the mean of the slips at the tips, which are ``r + g/2`` at D and ``r - g/2`` at
S with ``g = h_K/T``. Coulomb's law allows, in the order of falling ``r`` and while ``h_K > 0``, the
ratios of one walk from ``(-mu_D, -mu_S)`` over ``(-mu_D, mu_S)`` to ``(mu_D, mu_S)``. On each half of
it one ratio moves, and ``r`` is monotone; which way, and whether it passes through infinity, is
decided by ``T`` against ``mu w`` of the *other* tip and by the sign of the grip at the corners.
"""

from __future__ import annotations

import sympy as sp
from sympy.logic.boolalg import Boolean

from derivations._circle import tidy
from derivations._claim import Claim
from derivations._derivation import Derivation
from derivations._statement import Finding, Point, angle, for_all, identity, there_is
from derivations.mechanics import d1, mu, rho, theta
from derivations.rotation_existence import CLOSING, Law, law
from derivations.two_sided_rotation import T, p_S, sigma, tau_D, tau_S, two_contact_balance, w

c, s = sp.cos(theta), sp.sin(theta)
mu_D, mu_S = sp.symbols("mu_D mu_S", positive=True)
r_0, r_1, r_2, g = sp.symbols("r_0 r_1 r_2 g", real=True)
"""Mean slip at the corners of the walk, and h_K/T."""
HALF = {d1: sp.Integer(1)}
PER_TIP = 7  # relations of Coulomb's law at one tip

GRIP = T + d1 * (tau_D - tau_S)
PRESS_D = rho + p_S * (p_S + d1 * tau_S)
PRESS_S = rho + p_S * (p_S + T + d1 * tau_D)
"""What the normal forces at D and S are over sin(theta)/(T GRIP)."""
CORNERS = tuple(
    GRIP.subs({tau_D: at_D * mu_D, tau_S: at_S * mu_S, d1: 1}, simultaneous=True)
    for at_D, at_S in ((-1, -1), (-1, 1), (1, 1))
)
"""The grip at the corners of the walk, half width 1."""
PRESSING = (
    r"both tips press for all ratios: $\rho + p_S(p_S \pm \mu_S d_1) > 0$ and $\rho + p_S(p_D \pm \mu_D "
    r"d_1) > 0$, $p_D, p_S = \pm T/2 - \sigma$"
)
HYPOTHESES = (PRESSING, "even film", "the long edges are parallel, and the tips stay on them")
THREE: Point = {
    d1: sp.Integer(1), T: sp.Rational(6, 5), mu_D: sp.Rational(1, 5), mu_S: sp.Rational(4, 5),
    rho: sp.Rational(1, 2), sigma: -sp.Rational(1, 5), **angle(sp.Rational(29, 10), theta),
}  # fmt: skip
"""A place with three motions; lengths in half widths."""


def mean_slip() -> sp.Expr:
    """From the balance of forces, in ``p_S`` instead of ``sigma``."""
    return two_contact_balance()[2].subs(sigma, -T / 2 - p_S)


def derive() -> Derivation:
    """Derive when a motion exists and when it is the only one."""
    return Derivation(
        name="unequal_friction",
        summary="Rotation between two tips of different friction.",
        claims=(_existence(), _uniqueness(), _jam(), _apart()),
    )


def _states() -> tuple[Boolean, ...]:
    """Which part of the walk holds a motion, from the corners alone (half width 1, h_K >= 0).

    Where the grip is not positive at the middle corner, the mean slip goes to infinity before.
    """
    up, down = g / 2, -g / 2
    first, middle, last = CORNERS
    S_sticks = sp.Or(
        sp.And(middle > 0, sp.Or(sp.And(r_0 < up, r_1 > up), sp.And(r_0 > up, r_1 < up))),
        sp.And(
            middle <= 0,
            first > 0,
            sp.Or(sp.And(2 * mu_D < T, r_0 < up), sp.And(2 * mu_D > T, r_0 > up)),
        ),
    )
    D_sticks = sp.Or(
        sp.And(middle > 0, sp.Or(sp.And(r_1 < down, r_2 > down), sp.And(r_1 > down, r_2 < down))),
        sp.And(
            middle <= 0,
            last > 0,
            sp.Or(sp.And(2 * mu_S < T, r_2 > down), sp.And(2 * mu_S > T, r_2 < down)),
        ),
    )
    return (
        sp.And(first > 0, r_0 >= up),
        S_sticks,
        sp.And(middle > 0, r_1 <= up, r_1 >= down),
        D_sticks,
        sp.And(last > 0, r_2 <= down),
    )


def _monotone() -> tuple[Boolean, ...]:
    """Order of the mean slips at the corners that a positive grip connects (half width 1)."""
    first, middle, last = CORNERS

    def ordered(coefficient: sp.Symbol, end: sp.Expr, before: sp.Expr, after: sp.Expr) -> Boolean:
        rising = sp.And(2 * coefficient < T, before < after)
        falling = sp.And(2 * coefficient > T, before > after)
        level = sp.And(sp.Eq(2 * coefficient, T), sp.Eq(before, after))
        return sp.Or(sp.Not(sp.And(middle > 0, end > 0)), rising, falling, level)

    return ordered(mu_D, first, r_0, r_1), ordered(mu_S, last, r_1, r_2)


STEPS = (
    r"Where the grip $G = T + d_1(\tau_D - \tau_S)$ is positive, both tips press; where it is negative "
    r"both would have to pull.",
    r"Along the first half of the walk the mean slip moves with $\tau_S$ in the sense of $T - \mu_D "
    r"d_w$, along the second with $\tau_D$ in that of $T - \mu_S d_w$; where the grip vanishes on a "
    r"half, the slip goes to infinity on the way, in the same sense.",
    r"By the intermediate value theorem each half holds a sticking motion exactly if the slip at which "
    r"that tip sticks lies between the values at its ends.",
)


def _existence() -> Claim:
    slip = mean_slip()
    scale = s / (T * GRIP**2)
    return Claim(
        key="unequal-friction-no-jam",
        title="Tips of different friction: the smaller one decides the jam",
        place="new; “no jam” for different friction at the tips",
        derived=r"While the contacts approach each other ($h_K \ge 0$) and both tips press, a motion "
        r"exists if $T > \min(\mu_D, \mu_S)\, d_w$: the separation that round tips need (see when two "
        r"round tips cannot jam the part) is that for the smaller coefficient.",
        steps=STEPS,
        hypotheses=HYPOTHESES,
        checks=(
            identity(
                r"slope of the mean slip in $\tau_S$ on the first half",
                sp.Derivative(slip, tau_S),
                scale * (T + w * tau_D) * PRESS_S,
            ),
            identity(
                r"slope of the mean slip in $\tau_D$ on the second half",
                sp.Derivative(slip, tau_D),
                scale * (T - w * tau_S) * PRESS_D,
            ),
            for_all(
                r"some part of the walk holds a motion (half width 1)",
                [g >= 0, *_monotone(), sp.Or(2 * mu_D < T, 2 * mu_S < T)],
                sp.Or(*_states()),
            ),
            *_both_press(),
        ),
    )


def _both_press() -> tuple[Finding, ...]:
    """No motion in which a tip carries no force."""
    problem = _law()
    N_D, R_D, N_S, R_S = problem.forces
    plain = {**HALF, c: sp.Symbol("a_x", real=True), s: sp.Symbol("a_y", real=True)}
    pressing = [
        force.subs({p_S: -T / 2 - sigma, ratio: sign * most}) > 0
        for force, ratio, most in ((PRESS_D, tau_S, mu_S), (PRESS_S, tau_D, mu_D))
        for sign in (1, -1)
    ]
    given = [relation.subs(plain) for relation in (s > 0, *pressing)]
    return tuple(
        for_all(
            f"no motion without force at {name} (half width 1)",
            given,
            sp.Not(sp.And(*(r.subs({**plain, normal: 0, along: 0}) for r in problem.relations))),
        )
        for name, normal, along in (("S", N_S, R_S), ("D", N_D, R_D))
    )


def _law(tag: str = "") -> Law:
    """The complete problem, each tip with its own coefficient."""
    problem = law(tag)
    relations = tuple(
        relation.subs(mu, mu_D if k < PER_TIP else mu_S)
        for k, relation in enumerate(problem.relations)
    )
    return problem._replace(relations=relations)


def _uniqueness() -> Claim:
    """One motion, and where there are three."""
    states = _states()
    exclusive = sp.And(*(sp.Not(sp.And(p, q)) for k, p in enumerate(states) for q in states[:k]))
    common = [g >= 0, *_monotone()]
    first = CORNERS[0]
    slip = mean_slip()
    problems = [_law(tag) for tag in ("1", "2", "3")]
    forces = {
        symbol: value
        for problem, way in zip(problems, ("apart", "D sticks", "down"), strict=True)
        for symbol, value in _mode(problem, way).items()
    }
    motions = [problem.motion[0] for problem in problems]
    L_D, L_S = sp.symbols("L_D L_S", positive=True)
    return Claim(
        key="unequal-friction-unique",
        title="Tips of different friction: when the rotation is unique",
        place="new; uniqueness of the rotation for different friction at the tips",
        derived=r"While $h_K > 0$ and both tips press, the motion is the only one if $T > \max(\mu_D, "
        r"\mu_S)\, d_w$. It is too if $\mu_D \ge \mu_S$, $T > \mu_S d_w$ and $\theta \ge 90°$; and if "
        r"$\mu_S > \mu_D$, $T > \mu_D d_w$ and the mean slip with both ratios at $+\mu$ exceeds "
        r"$-h_K/(2T)$. Without the last condition three motions can exist side by side.",
        steps=(
            *STEPS,
            r"At $\theta \ge 90°$ the mean slip with both ratios at $-\mu$ is not positive: friction "
            r"and the push both act downwards along the edge.",
        ),
        hypotheses=HYPOTHESES,
        checks=(
            for_all(
                r"one motion if $T > \max(\mu_D, \mu_S)\, d_w$ (half width 1)",
                [*common, 2 * mu_D < T, 2 * mu_S < T],
                sp.And(sp.Or(*states), exclusive),
            ),
            for_all(
                r"one motion if $\mu_D \ge \mu_S$ and the tips cannot both slip up (half width 1)",
                [*common, g > 0, mu_D >= mu_S, 2 * mu_S < T, sp.Or(first <= 0, r_0 < g / 2)],
                sp.And(sp.Or(*states), exclusive),
            ),
            identity(
                r"mean slip with both ratios at $-\mu$",
                sp.Subs(slip, (tau_D, tau_S), (-mu_D, -mu_S)),
                -mu_D * _force(PRESS_D, -1) - mu_S * _force(PRESS_S, -1) + c / 2,
            ),
            for_all(
                r"at $\theta \ge 90°$ it stays below $g/2$",
                [c <= 0, g > 0, sp.Eq(r_0, -mu_D * L_D - mu_S * L_S + c / 2)],
                r_0 < g / 2,
            ),
            for_all(
                r"one motion if $\mu_S > \mu_D$ and the tips cannot both slip down (half width 1)",
                [*common, g > 0, mu_S > mu_D, 2 * mu_D < T, r_2 > -g / 2],
                sp.And(sp.Or(*states), exclusive),
            ),
            there_is(
                r"three motions: D slips up and S down; D sticks and S slips down; both slip down",
                [
                    *(relation for problem in problems for relation in problem.relations),
                    CLOSING > 0,
                    mu_D * w < T,
                    mu_S * w > T,
                    *(sp.Ne(p, q) for k, p in enumerate(motions) for q in motions[:k]),
                ],
                at={**THREE, **forces},
            ),
        ),
    )


def _force(numerator: sp.Expr, sign: int) -> sp.Expr:
    """A normal force with both ratios at one end of their cones."""
    ends = {tau_D: sign * mu_D, tau_S: sign * mu_S}
    return (s * numerator / (T * GRIP)).subs(ends, simultaneous=True)


def _mode(problem: Law, way: str) -> dict[sp.Symbol, sp.Expr]:
    """Forces at the witness: D slips up and S down, or D sticks and S slips down, or both slip down."""
    N_D, R_D, N_S, R_S = problem.forces
    friction = {
        "apart": (R_D + mu_D * N_D, R_S - mu_S * N_S),
        "D sticks": (problem.slips[0], R_S - mu_S * N_S),
        "down": (R_D - mu_D * N_D, R_S - mu_S * N_S),
    }[way]
    equations = [
        equation.subs(THREE, simultaneous=True) for equation in (*problem.openings, *friction)
    ]
    (solved,) = sp.solve(equations, problem.forces, dict=True)
    return dict(solved)


def _jam() -> Claim:
    """Below both thresholds: no motion, or two."""
    first, _, last = CORNERS
    states = _states()
    close = [g > 0, 2 * mu_D > T, 2 * mu_S > T]
    stuck = [sp.Or(first <= 0, r_0 < g / 2), sp.Or(last <= 0, r_2 > -g / 2)]
    return Claim(
        key="unequal-friction-jam",
        title="Tips of different friction: the jam",
        place="new; “the part jams” for different friction at the tips",
        derived=r"While $h_K > 0$, both tips press and $T < \min(\mu_D, \mu_S)\, d_w$, no motion exists "
        r"unless the tips could both slip up, or both down: the part jams. So the bound of the no-jam "
        r"condition is sharp.",
        steps=STEPS,
        hypotheses=HYPOTHESES,
        checks=(
            for_all(
                r"no part of the walk holds a motion (half width 1)",
                [*close, *stuck],
                sp.Not(sp.Or(*states)),
            ),
            for_all(
                r"the grip is closed at the middle corner (half width 1)",
                close,
                CORNERS[1] < 0,
            ),
        ),
    )


def _apart() -> Claim:
    """After the contacts have passed each other."""
    up, down = -g / 2, g / 2
    corners = tuple(
        GRIP.subs({tau_D: at_D * mu_D, tau_S: at_S * mu_S, d1: 1}, simultaneous=True)
        for at_D, at_S in ((-1, -1), (1, -1), (1, 1))
    )
    states = (
        r_0 >= up,
        sp.And(r_0 < up, r_1 > up),
        sp.And(r_1 <= up, r_1 >= down),
        sp.And(r_1 < down, r_2 > down),
        r_2 <= down,
    )
    exclusive = (sp.Not(sp.And(p, q)) for k, p in enumerate(states) for q in states[:k])
    slip = mean_slip()
    scale = s / (T * GRIP**2)
    return Claim(
        key="unequal-friction-past",
        title="Tips of different friction, past each other",
        place="new; the second half of the rotation for different friction at the tips",
        derived=r"After the contacts have passed each other ($h_K < 0$), with both tips pressing, "
        r"exactly one motion exists if $T > d_1|\mu_D - \mu_S|$.",
        steps=(
            r"The walk is that from $(-\mu_D, -\mu_S)$ over $(\mu_D, -\mu_S)$ to $(\mu_D, \mu_S)$: D is "
            r"the first to stick.",
        ),
        hypotheses=HYPOTHESES,
        checks=(
            for_all(
                r"the grip is positive at the corners (half width 1)",
                [mu_D - mu_S < T, mu_S - mu_D < T],
                sp.And(*(corner > 0 for corner in corners)),
            ),
            identity(
                r"the mean slip rises with $\tau_D$ on the first half ...",
                sp.Subs(sp.Derivative(slip, tau_D), tau_S, -mu_S),
                tidy((scale * (T + w * mu_S) * PRESS_D).subs(tau_S, -mu_S)),
            ),
            identity(
                r"... and with $\tau_S$ on the second",
                sp.Subs(sp.Derivative(slip, tau_S), tau_D, mu_D),
                tidy((scale * (T + w * mu_D) * PRESS_S).subs(tau_D, mu_D)),
            ),
            for_all(
                "corner slips that rise leave exactly one state",
                [g < 0, r_0 < r_1, r_1 < r_2],
                sp.And(sp.Or(*states), *exclusive),
            ),
        ),
    )
