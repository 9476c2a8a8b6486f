"""Round probe tips: what a radius changes in the sticking contact and in the two-sided rotation.

A tip of radius ``r`` that is held by its probe does not turn. Its centre ``P`` is ``r`` outside the
edge, its contact ``K = P - r n``; both move with the probe's velocity. Part frame as in
``mechanics``: along a turn ``a' = -n``, ``n' = a`` for the derivative in theta. So

- sticking rolls the edge around the tip: ``d2(theta) = d20 - r (theta - theta0)``, while forces and
  velocities are those of a point tip at the contact of the moment;
- between two tips on opposite edges the pair of *centres* is ``T a + W n`` with ``W = d_w + r_a +
  r_p``: the law of the orientation is that of point tips with ``W`` in the place of ``d_w``, and the
  forces, whose arms are those of the contacts, keep ``d_w``.
"""

from __future__ import annotations

import sympy as sp

from derivations._arc import Direction
from derivations._circle import solve_linear
from derivations._claim import Claim
from derivations._derivation import Derivation, Function
from derivations._statement import (
    Finding,
    Point,
    angle,
    as_written,
    crossed,
    for_all,
    identity,
    there_is,
)
from derivations.mechanics import (
    PAPER,
    a,
    d1,
    d2,
    film,
    mu,
    n,
    rho,
    theta,
    velocity_at,
    wrench,
)
from derivations.one_point_sticking import LOWER, UPPER, F, solve_sticking
from derivations.two_sided_rotation import NORMAL_UNIT, T, V, h, sigma, tau_D, tau_S

c, s = sp.cos(theta), sp.sin(theta)
r, r_a, r_p = sp.symbols("r r_a r_p", positive=True)
w = 2 * d1
W = w + r_a + r_p
k = sp.Symbol("k", positive=True)
"""sqrt(1 + mu^2): solvers know it by its square."""
LEVER = d2 * s - d1 * c


def along_the_turn(expression: sp.Expr) -> sp.Expr:
    """Derivative in theta while a tip of radius r sticks: d2 falls by r per radian."""
    return sp.diff(expression, theta) - r * sp.diff(expression, d2)


def derive() -> Derivation:
    """Derive the motion at one round tip, its limits, and the rotation between two."""
    return Derivation(
        name="round_tips",
        summary="Round probe tips.",
        claims=(
            _sticking(),
            _turning(),
            _limits(),
            _two_points(),
            _orientation(),
            _slide(),
            _no_jam(),
            _touch(),
        ),
        functions=_functions(),
    )


direction, dx, dy = sp.symbols("direction dx dy", real=True)
REACH = (dx * s - dy * c - d1 - r) / sp.sin(theta - direction)
"""Travel until a tip touches whose centre is at (dx, dy) from the reference point."""
TOUCHED = (
    dy * sp.cos(direction) - dx * sp.sin(direction) + (d1 + r) * sp.cos(theta - direction)
) / sp.sin(theta - direction)
"""d2 of its contact."""


def _functions() -> dict[str, Function]:
    spacing, upper, lower = sp.symbols("spacing r_upper r_lower", real=True)
    beta, start = sp.symbols("beta theta_start", real=True)
    return {
        "touch": Function(
            arguments=(theta, direction, d1, r, dx, dy),
            results=(REACH, TOUCHED),
            unit="m",
            meaning="m: travel along `direction` until a tip of radius r touches whose centre is at "
            "(dx, dy) from the reference point, and d2 of its contact",
        ),
        "rolled": Function(
            arguments=(theta, start, d2, r),
            results=(d2 - r * (theta - start),),
            unit="m",
            meaning="m: d2 of the contact that was at d2 when the edge was at theta_start",
        ),
        "upper_first": Function(
            arguments=(theta, beta, spacing, upper, lower),
            results=(spacing * sp.cos(theta - beta) / sp.cos(beta) + upper - lower,),
            unit="m",
            meaning="m: how much closer the upper of two tips is to the edge: zero where both touch",
        ),
        "contact_gap": Function(
            arguments=(theta, beta, spacing),
            results=(spacing * sp.sin(theta - beta) / sp.cos(beta),),
            unit="m",
            meaning="m: distance of the two tips along the edge",
        ),
    }


def _touch() -> Claim:
    """Where a tip touches that comes from any direction, and which of two comes first."""
    travel, beta = sp.symbols("xi beta", real=True)
    spacing, upper, lower = sp.symbols("S r_1 r_2", positive=True)
    moved = sp.Matrix([dx, dy]) - travel * sp.Matrix([sp.cos(direction), sp.sin(direction)])
    (reached,) = sp.solve(sp.expand(moved.dot(n)) - d1 - r, travel)
    apart = spacing * sp.Matrix([-sp.tan(beta), 1])
    return Claim(
        key="round-tip-touch",
        title="Where a round tip touches",
        place="new; Section IX-C1 for a tip that comes from any direction",
        derived=r"A tip whose centre is at $(x, y)$ from the reference point and moves along $-(\cos\phi, "
        r"\sin\phi)$ touches the edge after $\xi = (x\sin\theta - y\cos\theta - d_1 - r)/\sin(\theta - "
        r"\phi)$, at $d_2 = (y\cos\phi - x\sin\phi + (d_1 + r)\cos(\theta - \phi))/\sin(\theta - \phi)$. "
        r"Of two tips $S$ apart across the push the upper one is closer to the edge by $S\cos(\theta - "
        r"\beta)/\cos\beta + r_1 - r_2$, and the two are $S\sin(\theta - \beta)/\cos\beta$ apart along it.",
        steps=(
            r"The centre of a tip that touches is $d_1 + r$ from the reference point along $n$.",
        ),
        hypotheses=(r"$\sin(\theta - \phi) > 0$: the tip comes from outside",),
        checks=(
            identity("travel to the touch", reached, REACH),
            identity("place of the touch", moved.subs(travel, REACH).dot(a), TOUCHED),
            identity(
                "the upper tip is closer to the edge, and how far the tips are apart along it",
                [-(apart.dot(n) - upper + lower), apart.dot(a)],
                [
                    spacing * sp.cos(theta - beta) / sp.cos(beta) + upper - lower,
                    spacing * sp.sin(theta - beta) / sp.cos(beta),
                ],
            ),
        ),
    )


def _sticking() -> Claim:
    """The contact rolls, the rest is a point tip's."""
    t, start = sp.Symbol("t", real=True), sp.Symbol("theta_0", real=True)
    turned, offset = sp.Function("theta", real=True)(t), sp.Function("d2", real=True)(t)
    here = {theta: turned, d2: offset}
    outward = (offset * a + (d1 + r) * n).subs(here)
    held = velocity_at(sp.Matrix([0, 0, sp.diff(turned, t)]), (d2 * a + d1 * n).subs(here))
    slip = sp.diff(outward, t) - held  # of the tip over the part
    first = sp.Symbol("d20", real=True)
    rolled = first - r * (theta - start)
    # centre = P0 - travel e_x - d2 a - (d1 + r) n, with d(travel)/d(theta) = F/lever
    centre = -(rolled * a + (d1 + r) * n)
    rate = (F / LEVER).subs(d2, rolled)
    moved = sp.diff(centre, theta) - rate * sp.Matrix([1, 0])
    solved = solve_sticking()
    per_turn = sp.Matrix(solved.twist[:2]) / solved.twist[2]
    return Claim(
        key="round-tip-sticking",
        title="A round tip that sticks",
        place="new; Section IX-C1 takes tips as points",
        derived=r"A tip of radius $r$ that sticks rolls along the edge: $d_2(\theta) = d_{20} - r "
        r"(\theta - \theta_0)$, for either sense of the turn. Forces, velocities and the rate of the "
        r"turn are at each instant those of a point tip at the contact, $\theta' = (d_2 \sin\theta - "
        r"d_1 \cos\theta)/F$ at $d_2(\theta)$; the travel is one quadrature, and the centre is $P_0 - "
        r"\xi e_x - d_2 a - (d_1 + r) n$, with $P_0$ the centre of the tip at the start.",
        steps=(
            r"The centre of the tip is at $d_2 a + (d_1 + r) n$ from the centre of the part and moves "
            r"with the contact: the probe does not turn.",
            r"The part's point under the tip moves with the tip exactly if $d_2' + r\theta' = 0$.",
        ),
        hypotheses=("the contact sticks", "the contact stays on its edge"),
        checks=(
            identity(
                "slip of the tip over the part, and no approach to it",
                sp.Matrix([slip.dot(a.subs(here)), slip.dot(n.subs(here))]),
                [sp.diff(offset, t) + r * sp.diff(turned, t), 0],
            ),
            identity(
                "the rolled contact has no slip",
                sp.Derivative(rolled, theta) + r,
                sp.Integer(0),
            ),
            identity(
                "the centre moves as the balance of a point tip at the contact says",
                moved,
                [entry.subs(d2, rolled) for entry in per_turn],
            ),
        ),
    )


def _turning() -> Claim:
    """The sense of the turn is kept if the tip is smaller than the part is deep."""
    flat: Point = {
        d1: sp.Integer(1),
        d2: sp.Rational(4, 3),
        r: sp.Integer(3),
        **angle(sp.Rational(1, 3), theta),
    }
    change = along_the_turn(LEVER)
    return Claim(
        key="round-tip-turning",
        title="A round tip keeps the sense of the turn",
        place="new; “turning over the arc” for round tips",
        derived=r"While a round tip with $r < d_1$ sticks, the part keeps turning in the sense in "
        r"which it began: where the lever $d_2 \sin\theta - d_1\cos\theta$ vanishes, it grows with "
        r"$\theta$. For a larger tip it may change its sense.",
        hypotheses=("the contact sticks", r"$0 < \theta < \pi$", r"$r < d_1$"),
        checks=(
            identity(
                r"change of the lever along the turn",
                change,
                as_written(lambda: d2 * c + (d1 - r) * s),
            ),
            for_all(
                "where the lever vanishes it grows",
                [s > 0, sp.Eq(d2 * s, d1 * c), r < d1],
                change > 0,
            ),
            there_is(
                "a larger tip: the lever vanishes and falls",
                [s > 0, sp.Eq(d2 * s, d1 * c), change < 0],
                at=flat,
            ),
        ),
    )


def _limits() -> Claim:
    """Where the limits of sticking are crossed one way only."""
    example = {**PAPER, d2: sp.Integer(350)}
    radius = _largest(example)
    return Claim(
        key="round-tip-limits",
        title="The limits of sticking at a round tip",
        place="new; the sticking arc for round tips",
        derived=r"Let $U(d_2)$ be the direction at which sticking ends, upwards or downwards. While a "
        r"round tip sticks, the part's direction passes it in the sense of the turn only, as at a point "
        r"tip, if $|U|^2 + r\,(U \times \partial U/\partial d_2) > 0$ there. For the paper's part "
        rf"at $d_2 = 350$ µm this holds for radii up to {radius} µm.",
        steps=(
            r"The margin to a limit is $U \times (\cos\theta, \sin\theta)$, which the turn changes by "
            r"$U \cdot (\cos\theta, \sin\theta)$ and the rolling contact by $-r\,\partial U/\partial d_2 "
            r"\times (\cos\theta, \sin\theta)$; at the limit the direction is $U$ itself.",
        ),
        hypotheses=("the contact sticks up to the limit",),
        checks=(_change_at("upper", UPPER), _change_at("lower", LOWER)),
    )


def _change_at(name: str, limit: Direction) -> Finding:
    """How the turn changes the margin to a limit where the direction is the limit itself."""
    x, y = limit
    margin = x * s - y * c  # |limit| times the sine of the angle from the limit to theta
    at_limit = {sp.cos(theta): x, sp.sin(theta): y}
    bent = crossed(limit, [sp.diff(entry, d2) for entry in limit])
    return identity(
        f"change of the {name} limit's margin along the turn, at the limit and times its length",
        sp.expand(along_the_turn(margin)).subs(at_limit, simultaneous=True),
        as_written(lambda: x**2 + y**2 + r * bent),
    )


def _largest(at: Point) -> str:
    """The radius up to which neither limit is crossed backwards, in um."""
    bounds = []
    for limit in (UPPER, LOWER):
        bent = (limit[0] * sp.diff(limit[1], d2) - limit[1] * sp.diff(limit[0], d2)).subs(at)
        length = (limit[0] ** 2 + limit[1] ** 2).subs(at)
        if bent < 0:
            bounds.append(-length / bent)
    return f"{float(min(bounds)):.0f}" if bounds else "any size"


def _two_points() -> Claim:
    """Two tips of different radii on one edge."""
    r1, r2, spacing = sp.symbols("r_1 r_2 S", positive=True)
    leaning = sp.Symbol("epsilon", real=True)
    joined = spacing * (sp.cos(leaning) * a + sp.sin(leaning) * n)  # from centre 2 to centre 1
    contacts = joined - (r1 - r2) * n
    at = {sp.sin(leaning): (r1 - r2) / spacing}
    gap = sp.Symbol("G", positive=True)
    return Claim(
        key="round-tips-on-one-edge",
        title="Two round tips on one edge",
        place="new; eq. (9) takes tips as points",
        derived=r"An edge that touches two tips of radii $r_1$, $r_2$, their centres $S$ apart, is at "
        r"$\varepsilon = \sin^{-1}((r_1 - r_2)/S)$ to the line through the centres, and the contacts are "
        r"$G = S \cos\varepsilon$ apart. Equal radii change nothing in eq. (9); unequal ones change "
        r"$\beta$ by $\varepsilon$ and $d_4/\cos\beta$ to $G$.",
        steps=(
            r"Both centres are their radius outside the edge's line: the difference of the centres along "
            r"$n$ is $r_1 - r_2$.",
        ),
        hypotheses=("both tips touch the edge between its vertices",),
        checks=(
            identity(
                "the contacts lie along the edge",
                sp.Matrix([contacts.dot(a), contacts.dot(n)]).subs(at),
                [spacing * sp.cos(leaning), 0],
            ),
            for_all(
                r"contacts closer together than the centres, unless the radii are equal",
                [sp.Eq(gap**2, spacing**2 - (r1 - r2) ** 2), sp.Ne(r1, r2)],
                gap < spacing,
            ),
        ),
    )


def pair_of_centres() -> sp.Matrix:
    """From the passive tip's centre to the moving one's, both tips touching, T apart along a."""
    return T * a + W * n


def _orientation() -> Claim:
    """The law of the orientation with W in the place of d_w."""
    reach, along = sp.sqrt(h**2 + V**2), sp.sqrt(h**2 + V**2 - W**2)
    law = sp.atan2(V, h) + sp.asin(W / reach)
    cosine = h / reach * along / reach - V / reach * W / reach
    sine = V / reach * along / reach + h / reach * W / reach
    return Claim(
        key="round-tips-orientation",
        title="Orientation between two round tips",
        place="new; the orientation law for round tips",
        derived=r"With $(h, V)$ from the centre of the passive to that of the moving tip and $W = d_w + "
        r"r_a + r_p$, the orientation while both touch is $\theta = \mathrm{atan2}(V, h) + \sin^{-1}(W/"
        r"\sqrt{h^2 + V^2})$, $T^2 = h^2 + V^2 - W^2$, $d\theta/d\xi = \sin\theta/T$, $dT/d\xi = -h/T$. "
        "Friction, film and slide do not enter.",
        steps=(
            r"The centres are $d_1 + r_a$ and $d_1 + r_p$ from the middle line of the part, on opposite "
            r"sides: $(h, V) = T a + W n$.",
        ),
        hypotheses=("both tips stay on their edges", r"$V > W$; then $T > 0$"),
        checks=(
            identity(
                "both entries of the pair of centres, from the law",
                sp.Matrix([along * cosine + W * sine, along * sine - W * cosine]),
                [h, V],
            ),
            identity(
                r"$\cos^2 + \sin^2 = 1$",
                as_written(lambda: cosine**2 + sine**2),
                sp.Integer(1),
            ),
            identity(
                r"$d\theta/d\xi = \sin\theta/T$, with $dh/d\xi = -1$",
                -sp.Derivative(law, h),
                sine / along,
            ),
            identity(r"$dT/d\xi = -h/T$", -sp.Derivative(along, h), -h / along),
            for_all(
                r"$V > W$ means $T > 0$",
                [s > 0, sp.Eq(V, sp.Symbol("t", real=True) * s - W * c), V > W],
                sp.Symbol("t", real=True) > 0,
            ),
        ),
    )


def _slide() -> Claim:
    """Forces and slide of the two-sided rotation, from the balance at the contacts."""
    force_D, force_S, rate = sp.symbols("L_D L_S sigma_rate", real=True)
    p_D, p_S = T / 2 - sigma, -T / 2 - sigma
    turn = s / T
    # centre = (P_D + P_S)/2 + sigma a - (r_a - r_p)/2 n, and the middle of the tips moves by half
    along = rate - (r_a - r_p) / 2 * turn
    centre = sp.Matrix([sp.Rational(-1, 2), 0]) + along * a - sigma * turn * n
    twist = sp.Matrix([centre[0], centre[1], turn])
    pushes = wrench(force_D * (-n + tau_D * a), p_D * a + d1 * n)
    pushes += wrench(force_S * (n + tau_S * a), p_S * a - d1 * n)
    balance = film(twist).subs(NORMAL_UNIT) - pushes
    solved = solve_linear(balance, (force_D, force_S, rate))
    grip = T * (T + d1 * (tau_D - tau_S))
    L_D = s * (rho + p_S * (p_S + d1 * tau_S)) / grip
    L_S = s * (rho + p_S * (p_D + d1 * tau_D)) / grip
    slips = [
        (velocity_at(twist, p_D * a + d1 * n) - sp.Matrix([-1, 0])).dot(a),
        velocity_at(twist, p_S * a - d1 * n).dot(a),
    ]
    across = (pair_of_centres() - (r_a + r_p) * n)[0]  # of the contacts, along the push
    return Claim(
        key="round-tips-slide",
        title="Forces and slide between two round tips",
        place="new; Section IX-C3 for round tips",
        derived=r"Forces act at the contacts, so that with $T$ from the law of round tips they are those of "
        r"point tips: the grip is $T + d_1(\tau_D - \tau_S)$, and radii do not enter. The centre slides by "
        r"$\sigma' = \tau_D L_D + \tau_S L_S + \tfrac12\cos\theta + (r_a - r_p)\sin\theta/(2T)$ along the "
        r"edge, $\sigma$ from the middle of the contacts. The tips slip over the edges at rates that differ "
        r"by $h_K/T$, $h_K = h - (r_a + r_p)\sin\theta$ the distance of the contacts along the push.",
        hypotheses=("both tips press", "both tips stay on their edges"),
        checks=(
            identity(
                "normal forces, over $e_x$ and the rate of travel",
                [solved[force_D], solved[force_S]],
                [L_D, L_S],
            ),
            identity(
                "rate of the slide",
                solved[rate],
                tau_D * L_D + tau_S * L_S + c / 2 + (r_a - r_p) * s / (2 * T),
            ),
            identity(
                "difference of the two slips",
                slips[0] - slips[1],
                (pair_of_centres()[0] - (r_a + r_p) * s) / T,
            ),
            identity(r"$h_K = T\cos\theta + d_w\sin\theta$", across, T * c + w * s),
            for_all(
                r"the grip stays open for all friction ratios if $T > \mu d_w$",
                [tau_D <= mu, tau_D >= -mu, tau_S <= mu, tau_S >= -mu, mu * w < T],
                T + d1 * (tau_D - tau_S) > 0,
            ),
        ),
    )


def _no_jam() -> Claim:
    """How far apart round tips must be across the push."""
    both = sp.Symbol("R", positive=True)
    free = sp.Symbol("t", real=True)  # T, of either sign
    geometry = [
        s > 0,
        sp.Eq(V, free * s - (w + both) * c),
        free * c + w * s >= 0,
        free > 0,
        sp.Eq(k**2, 1 + mu**2),
        both < w,
    ]
    apart = V * k > w * k**2 + both
    place = {
        mu: sp.Rational(3, 4),
        k: sp.Rational(5, 4),
        d1: sp.Integer(100),
        both: sp.Integer(25),
        free: sp.Integer(150),
        sp.cos(theta): -sp.Rational(4, 5),
        sp.sin(theta): sp.Rational(3, 5),
        V: sp.Integer(150) * sp.Rational(3, 5) + 225 * sp.Rational(4, 5),
    }
    return Claim(
        key="round-tips-no-jam",
        title="When two round tips cannot jam the part",
        place="new; “no jam” for round tips",
        derived=r"Two tips that approach along the push cannot close their grip before their contacts have "
        r"passed each other if $d_v > d_w\sqrt{1 + \mu^2} + (r_a + r_p)/\sqrt{1 + \mu^2}$ and $r_a + r_p < "
        rf"d_w$. For the paper's part at $\mu = 0.33$: {_threshold(0)} µm for points, "
        rf"{_threshold(5)} µm for tips 5 µm across, {_threshold(25)} µm for 25 µm across. The "
        "bound is sharp: at it the grip closes just where the contacts pass each other.",
        steps=(
            r"The grip closes where $T = \mu d_w$ at the latest; the contacts have not passed each other "
            r"while $h_K = T\cos\theta + d_w\sin\theta \ge 0$.",
            r"With $T \le \mu d_w$ and $h_K \ge 0$, $d_v = T \sin\theta - W\cos\theta$ is largest where both "
            r"hold with equality.",
        ),
        hypotheses=(
            "one friction coefficient at both tips",
            r"the tips stay on their edges",
            r"$r_a + r_p < d_w$",
        ),
        checks=(
            for_all(
                r"$T > \mu d_w$ wherever $h_K \ge 0$",
                [*geometry, apart],
                free > mu * w,
            ),
            there_is(
                "the bound is sharp: at it the grip closes just where the contacts pass each other",
                [
                    *geometry,
                    sp.Eq(V * k, w * k**2 + both),
                    sp.Eq(free, mu * w),
                    sp.Eq(free * c + w * s, 0),
                ],
                at=place,
            ),
        ),
    )


def _threshold(across: int) -> str:
    """The least spacing of the paper's part at mu = 0.33, tips ``across`` um across, in um."""
    root = sp.sqrt(1 + PAPER[mu] ** 2)
    return f"{float(2 * PAPER[d1] * root + across / root):.1f}"
