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
from sympy.logic.boolalg import Boolean

from derivations._circle import solve_linear
from derivations._claim import Claim
from derivations._derivation import Derivation, Function
from derivations._statement import Finding, for_all, identity, require_zero
from derivations.mechanics import (
    a,
    beta,
    coulomb,
    d1,
    d2,
    d4,
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

c, s = sp.cos(beta), sp.sin(beta)
LEVER = d1 * s + d2 * c
"""Height of tip 1 above the centre: the lever of its push along -x."""
GAP = sp.Symbol("gap", real=True)
"""Distance of the tips along the edge."""
TO_BETA = {theta: sp.pi / 2 + beta}


def solve_two_points() -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Normal forces of tips 1 and 2 and the summed tangential force."""
    n1, n2, shear = sp.symbols("lambda_n1 lambda_n2 lambda_t", real=True)
    at = {theta: sp.pi / 2 + beta}
    along, out = a.subs(at), n.subs(at)
    first = d2 * along + d1 * out
    second = (d2 - d4 / sp.cos(beta)) * along + d1 * out
    pushes = wrench(-out * n1 + along * shear, first) + wrench(-out * n2, second)
    balance = film(sp.Matrix([v_p, 0, 0])) - pushes
    solution = solve_linear(balance, (n1, n2, shear))
    return solution[n1], solution[n2], solution[shear]


def derive() -> Derivation:
    """Derive eq. 9 and Lemma 2, and state the conditions to generate."""
    first, second, shear = solve_two_points()
    scale = -e_x * v_p * c / d4
    require_zero(first / scale - (d4 - LEVER), "tip 1 carries the lever of tip 2")
    require_zero(second / scale - LEVER, "tip 2 carries the lever of tip 1")
    require_zero((first + second) / (-e_x * v_p) - c, "both together carry the drag")
    require_zero(shear - e_x * v_p * -s, "the shear carries the rest")
    return Derivation(
        name="two_point_sticking",
        summary="Two-point sticking contact (paper, eq. 9).",
        claims=(*_equation_9(first, second, shear), _lemma_2()),
        functions={
            "normal_forces": Function(
                arguments=(beta, d1, d2, d4),
                results=(d4 - LEVER, LEVER),
                unit="m",
                meaning="lambda_n of tips 1 and 2, times d4/(e_x |v_p| cos(beta)), m: both must be "
                "positive",
            ),
            "friction_margin": Function(
                arguments=(beta, mu),
                results=(mu * c - s, mu * c + s),
                unit="1",
                meaning="mu lambda_n -+ lambda_t over e_x |v_p|: both positive where the pair "
                "sticks",
            ),
        },
    )


def _equation_9(first: sp.Expr, second: sp.Expr, shear: sp.Expr) -> tuple[Claim, ...]:
    steps = (
        r"The part translates with the probe, twist $(v_p, 0, 0)$; its edge lies along the line "
        r"through both tips, $\theta = \pi/2 + \beta$.",
        "Both tangential forces act along the edge, so only their sum enters the balance: three "
        "equations for two normal forces and that sum.",
    )
    printed_1 = e_x * v_p * c * (d1 * s + d2 * c - d4) / d4
    printed_2 = -e_x * v_p * c * (d1 * s + d2 * c) / d4
    within = sp.And(-d1 * s < d2 * c, d2 * c < d4 - d1 * s)
    return (
        Claim(
            key="eq-9-normal-forces",
            title="Normal forces of two-point sticking",
            place="eq. (9), Section IX-C2",
            printed=r"$\lambda_n^1 = e_x v_p \cos\beta\,(d_1\sin\beta + d_2\cos\beta - d_4)/d_4 > "
            r"0$, $\lambda_n^2 = -e_x v_p \cos\beta\,(d_1 \sin\beta + d_2\cos\beta)/d_4 > 0$",
            derived=r"As printed, with $d_4$ the spacing of the tips across the push and $\theta = "
            r"\pi/2 + \beta$. Both are positive exactly if $-d_1\tan\beta < d_2 < d_4/\cos\beta - "
            r"d_1\tan\beta$: the centre lies between the tips, measured across the push.",
            steps=steps,
            hypotheses=(r"$|\beta| < \pi/2$",),
            of_print=(
                identity("tip 1, printed $=$ derived", printed_1, first),
                identity("tip 2, printed $=$ derived", printed_2, second),
            ),
            checks=(
                for_all(
                    r"both positive $\Leftrightarrow$ the centre between the tips",
                    [c > 0],
                    sp.Equivalent(sp.And(d4 - LEVER > 0, LEVER > 0), within),
                ),
            ),
        ),
        Claim(
            key="eq-9-ratio",
            title="Sticking condition of two points",
            place="eq. (9), Section IX-C2",
            printed=r"$|\lambda_n/\lambda_t| = |\tan\theta| = |1/\tan\beta| > 1/\mu$",
            derived=r"$|\tan\beta| < \mu$; $\lambda_n$ and $\lambda_t$ are the sums over both tips",
            steps=steps,
            of_print=(
                identity(
                    r"$((\lambda_n^1 + \lambda_n^2)/\lambda_t)^2 = 1/\tan^2\beta$",
                    ((first + second) / shear) ** 2,
                    1 / sp.tan(beta) ** 2,
                ),
                identity(
                    r"$\tan^2\theta = 1/\tan^2\beta$",
                    sp.tan(theta).subs(TO_BETA) ** 2,
                    1 / sp.tan(beta) ** 2,
                ),
            ),
        ),
    )


def _lemma_2() -> Claim:
    """The part cannot turn, so the conditions do not change; and nothing else can happen."""
    out, along = n.subs(TO_BETA), a.subs(TO_BETA)
    v_x, v_y, omega = sp.symbols("v_x v_y omega", real=True)
    twist = sp.Matrix([v_x, v_y, omega])
    arms = _tips(along, out, d2)
    carried = [
        sp.Eq(component, 0)
        for arm in arms
        for component in velocity_at(twist, arm) - sp.Matrix([v_p, 0])
    ]
    cleared = [sp.Eq(sp.expand(relation.lhs * c), 0) for relation in carried]
    return Claim(
        key="lemma-2",
        title="Lemma 2: two-point sticking lasts",
        place="Lemma 2, Section IX-C2",
        printed="“If the part starts with two-point sticking contact, … then the pushing will stay in "
        "the two-point sticking contact mode.”",
        derived="As printed. Moreover no other motion is possible beside it.",
        steps=(
            r"Two points of the part that move with the probe leave only the translation "
            r"$(v_p, 0, 0)$: the orientation stays, and so do the offsets of both tips.",
            "The conditions (9) depend on orientation and offsets only.",
            "Written out with sticking, slipping and separating of either tip, the contact law has "
            "no second motion where the two-point sticking solution is strict.",
        ),
        of_print=(
            for_all(
                "both tips carry their points along: the part translates with the probe",
                [c > 0, *cleared],
                sp.And(sp.Eq(v_x, v_p), sp.Eq(v_y, 0), sp.Eq(omega, 0)),
            ),
            *_only_motion(),
        ),
    )


def _only_motion() -> tuple[Finding, ...]:
    """Beside strict two-point sticking no second motion: case by case which tips touch."""
    forces, drag, _, _ = _both("")
    others, other_drag, openings, laws = _both("b")
    translates = dict(zip(sp.symbols("u_t u_n", real=True), drag[:2], strict=True))
    strict = [
        forces[0] > 0, forces[2] > 0, sp.Eq(drag[2], 0), GAP > 0,
        *(mu * forces[k] - sign * forces[k + 1] > 0 for k in (0, 2) for sign in (1, -1)),
    ]  # fmt: skip
    beside = [sp.sympify(law).subs(translates) for law in laws]
    same = sp.And(*(sp.Eq(p, q) for p, q in zip(drag, other_drag, strict=True)))
    free = {"tip 1": others[:2], "tip 2": others[2:], "both tips": others}
    return (
        for_all(
            "a part that both tips touch does not turn",
            [GAP > 0, *(sp.Eq(opening, 0) for opening in openings)],
            sp.Eq(other_drag[2], 0),
        ),
        for_all(
            "no second motion that both tips touch",
            [*strict, *beside, sp.Eq(other_drag[2], 0)],
            same,
        ),
        *(
            for_all(
                f"no second motion without force at {which}",
                strict,
                sp.Not(sp.And(*(sp.sympify(law).subs(dict.fromkeys(none, 0)) for law in beside))),
            )
            for which, none in free.items()
        ),
    )


def _tips(along: sp.Matrix, out: sp.Matrix, offset: sp.Expr) -> tuple[sp.Matrix, sp.Matrix]:
    """Arms of both tips."""
    return offset * along + d1 * out, (offset - d4 / c) * along + d1 * out


def _both(
    mark: str,
) -> tuple[tuple[sp.Symbol, ...], tuple[sp.Expr, ...], tuple[sp.Expr, ...], tuple[Boolean, ...]]:
    """Forces of two tips on one edge, the film's drag along, across and about, openings, laws.

    In the edge's frame, for any tip velocity; drag e_x = 1, so the drag is the velocity.
    """
    names = " ".join(f"{kind}_{tip}{mark}" for tip in "12" for kind in "NR")
    N_1, R_1, N_2, R_2 = sp.symbols(names, real=True)
    u_t, u_n = sp.symbols("u_t u_n", real=True)
    edge = {theta: 0}
    along, out = a.subs(edge), n.subs(edge)
    arms = d2 * along + d1 * out, (d2 - GAP) * along + d1 * out
    push = wrench(-out * N_1 + along * R_1, arms[0]) + wrench(-out * N_2 + along * R_2, arms[1])
    drag = film(sp.ones(3, 1))
    twist = sp.Matrix([sp.expand(rho * p * e_x / k) for p, k in zip(push, drag, strict=True)])
    laws: list[Boolean] = []
    openings = []
    for arm, normal, tangential in zip(arms, (N_1, N_2), (R_1, R_2), strict=True):
        moved = velocity_at(twist, arm)
        slip = sp.expand(moved.dot(along) - rho * u_t)
        openings.append(sp.expand(rho * u_n - moved.dot(out)))
        laws += coulomb(normal, tangential, slip, openings[-1])
    force = sp.Matrix(push[:2])
    sums = (force.dot(along), force.dot(out), push[2])
    return (N_1, R_1, N_2, R_2), sums, tuple(openings), tuple(laws)
