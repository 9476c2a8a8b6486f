"""A part pushed along a slot: when its walls turn it back, and when it cannot jam between them.

Two tips push the rear edge of a part whose front is in a slot. Where the part leans by ``phi`` off the slot's
axis, its front up, only the upper tip touches, ``d2`` above the middle of the rear edge, and of the walls
either the slot's lower edge, on the part's lower side ``p`` ahead of the centre, or the upper wall, at the
part's upper front corner::

      -------------------- upper wall
          front ________
               |   o    | <- upper tip, d2 above the middle, d1 behind the centre
               |________|
      -----------o lower edge of the slot, p ahead of the centre (here negative)

Frame of the part as in ``mechanics``: ``a`` up along the pushed edge, ``-n`` ahead. ``R`` is the rate at which
the lean grows, minus the turn counter-clockwise.
"""

from __future__ import annotations

import sympy as sp
from sympy.logic.boolalg import Boolean

from derivations._circle import solve_linear
from derivations._claim import Claim
from derivations._derivation import Derivation, Function
from derivations._statement import Finding, Point, angle, for_all, identity, there_is
from derivations.mechanics import a, d1, d2, e_x, film, mu, n, rho, theta, velocity_at, wrench

EDGE = {theta: 0}
UP, AHEAD = a.subs(EDGE), -n.subs(EDGE)
b = sp.Symbol("b", positive=True)
"""Half the part's width: distance of its sides from the centre."""
mu_w = sp.Symbol("mu_w", positive=True)
p, tau, kappa = sp.symbols("p tau kappa", real=True)
"""Place of the slot's edge ahead of the centre; friction ratios at the tip (up) and at the wall (against the push)."""
push, N = sp.symbols("F N", real=True)
rate = sp.Symbol("R", real=True)
phi, psi = sp.symbols("phi psi", real=True)
"""Lean; and lean plus the angle by which the tip's path is off the slot's axis, downwards."""
engaged, room = sp.symbols("engaged room", positive=True)
"""Length of the part's side within the slot; width of the slot."""

TURN = d2 + tau * (d1 + p - kappa * b)
"""What the rate falls with, where the part bears on the slot's edge."""
STIFF = rho + p**2 - kappa * b * p
BEARS = d2 - mu * (d1 + p - mu_w * b), d2 + mu * (d1 + p - mu_w * b)
FREE = d2 * sp.cos(psi) - d1 * sp.sin(psi)
NO_JAM = sp.cos(phi) * (1 - mu * mu_w) - sp.sin(phi) * (mu + mu_w)
CORNER = sp.cos(phi) * (d1 - mu_w * b) - sp.sin(phi) * (mu_w * d1 + b)
ONE_WALL = room - 2 * b * sp.cos(phi) - engaged * sp.sin(phi)
COULOMB = (tau <= mu, tau >= -mu)
EVEN = "even film; a rectangle with exact right angles"
ONE = "the part leans with its front up, and only the upper tip touches (the other case is its mirror image)"


def derive() -> Derivation:
    """Derive what a slot's walls do to a part that is pushed along it."""
    arguments = (d1, d2, p, b, mu, mu_w)
    return Derivation(
        name="slot_walls",
        summary="A part pushed along a slot whose walls it may touch.",
        claims=(
            _bearing(),
            _turns_back(),
            _turns_away(),
            _free(),
            _one_wall(),
            _no_jam(),
            _pivot(),
        ),
        functions={
            "bears": Function(
                arguments=arguments,
                results=BEARS,
                unit="m",
                meaning="what d2 of the tip has to spare, m, for the slot's edge p ahead of the centre to "
                "turn back a part that bears on it with its side, half a width from the centre",
            ),
            "stiff": Function(
                arguments=(rho, b, mu_w),
                results=(4 * rho - mu_w**2 * b**2,),
                unit="m^2",
                meaning="positive, m^2, where friction at the slot's edge cannot turn the part against the film",
            ),
            "steers": Function(
                arguments=(d1, d2, psi),
                results=(FREE,),
                unit="m",
                meaning="positive, m, where the part turns back though no slot's edge holds it; psi: angle "
                "between the part and the tip's path",
            ),
            "corner": Function(
                arguments=(d1, b, mu_w, phi),
                results=(CORNER,),
                unit="m",
                meaning="positive, m, where the wall's force on a front corner turns a part back that leans by "
                "up to phi; d1: the least distance of its ends from the centre",
            ),
            "one_wall": Function(
                arguments=(b, room, engaged, phi),
                results=(ONE_WALL,),
                unit="m",
                meaning="what a slot of width room has to spare, m, for a part that leans by phi not to "
                "touch both walls, where its side is within the slot over this length",
            ),
            "no_jam": Function(
                arguments=(mu, mu_w, phi),
                results=(NO_JAM,),
                unit="1",
                meaning="positive where tips and one wall cannot hold the part between them",
            ),
        },
    )


def _twist(force: sp.Expr, ratio: sp.Expr, bearing: sp.Expr, resist: sp.Expr) -> sp.Matrix:
    """Motion under a tip on the rear edge and the slot's lower edge, axes (up, behind)."""
    tip = wrench(force * (AHEAD + ratio * UP), d2 * UP - d1 * AHEAD)
    edge = wrench(bearing * (UP - resist * AHEAD), p * AHEAD - b * UP)
    drag = film(sp.ones(3, 1))
    return sp.Matrix([(x + y) / k for x, y, k in zip(tip, edge, drag, strict=True)])


def _bearing() -> Claim:
    """Force and turn in closed form."""
    twist = _twist(push, tau, N, kappa)
    moved = velocity_at(twist, p * AHEAD - b * UP).dot(UP)
    force = solve_linear([moved], [N])[N]
    lean = -twist[2].subs(N, force)
    return Claim(
        key="slot-edge-turn",
        title="A part that bears on the slot's edge: force and turn",
        place="new; Section XI, contact with the fixture",
        derived=r"Pushed with force $F$ at friction ratio $\tau$, the part presses on the slot's edge with $N = F "
        r"(p d_2 - \tau(\rho - p d_1))/(\rho + p^2 - \kappa b p)$, and its lean grows at the rate $R = -F (d_2 + "
        r"\tau(d_1 + p - \kappa b))/(e_x(\rho + p^2 - \kappa b p))$, $\kappa$ being the friction ratio at the "
        r"edge, against the push. The film's $\rho$ decides how fast it turns, not which way.",
        steps=(
            "Balance of the tip, the slot's edge and the film.",
            "The part's point on the edge does not move across the part's side, which gives $N$.",
        ),
        hypotheses=(EVEN, ONE, "the part bears on the slot's edge and on no wall"),
        checks=(
            identity(
                "force on the slot's edge", force, push * (p * d2 - tau * (rho - p * d1)) / STIFF
            ),
            identity("rate of the lean", lean, -push * TURN / (e_x * STIFF)),
            for_all(
                r"$\rho + p^2 - \kappa b p > 0$ where friction at the wall is less than $2\sqrt\rho/b$",
                [kappa**2 * b**2 < 4 * rho],
                STIFF > 0,
            ),
        ),
    )


def _ahead(arm: sp.Matrix) -> sp.Expr:
    """Speed ahead of a point of a part whose lean grows at the rate R."""
    return velocity_at(sp.Matrix([*sp.symbols("v_u v_n", real=True), -rate]), arm).dot(AHEAD)


def _turns_back() -> Claim:
    """The condition for the sign of the turn."""
    depth = 2 * d1 - mu_w * b - d2 / mu
    return Claim(
        key="slot-edge-turns-back",
        title="From what depth on the slot's edge turns the part back",
        place="new; “the slot aligns the peg as it is inserted”, Section XI",
        derived=r"A part that bears on the slot's edge and slides inwards over it turns back, whatever the tip's "
        r"friction, sticking or slipping, if $d_2 > \mu|d_1 + p - \mu_w b|$. With a front as far from the centre "
        r"as the rear edge, $p = d_1 - e$: from the depth $e^* = 2 d_1 - \mu_w b - d_2/\mu$ on. For the paper's "
        r"part with tips 580 µm apart, $\mu = 0.36$ and $\mu_w = 0.3$ that is 685 µm, and from the first touch "
        r"on only if $\mu < d_2/(2 d_1 - \mu_w b) = 0.194$.",
        steps=(
            "See force and turn of a part that bears on the slot's edge: the sign of the turn is that of a "
            r"function affine in $\tau$, least at $\tau = \mp\mu$.",
            r"A part whose lean grows moves inwards at the edge, so that friction there is $\mu_w$, against it.",
        ),
        hypotheses=(EVEN, ONE, r"$\mu_w b < 2\sqrt\rho$"),
        checks=(
            for_all(
                r"$d_2 + \tau(d_1 + p - \mu_w b) > 0$ for every ratio in the cone",
                [*COULOMB, *(margin > 0 for margin in BEARS)],
                TURN.subs(kappa, mu_w) > 0,
            ),
            for_all(
                "then the lean falls",
                [push > 0, TURN > 0, STIFF > 0, sp.Eq(rate * STIFF, -push * TURN)],
                rate < 0,
            ),
            identity(
                "how much faster the part moves inwards at the slot's edge than at the tip",
                _ahead(p * AHEAD - b * UP) - _ahead(d2 * UP - d1 * AHEAD),
                (b + d2) * rate,
            ),
            for_all(
                r"deeper than $e^*$ the condition holds as long as $d_1 + p \ge \mu_w b$",
                [sp.Eq(engaged, d1 - p), engaged > depth, d1 + p >= mu_w * b],
                sp.And(*(margin > 0 for margin in BEARS)),
            ),
        ),
    )


AWAY: Point = {
    d1: sp.Integer(808), d2: sp.Integer(290), b: sp.Rational(837, 2), rho: sp.Integer(376_900),
    mu: sp.Rational(36, 100), mu_w: sp.Rational(3, 10), p: sp.Integer(508),
}  # fmt: skip
"""The paper's part, 300 um deep, um."""


def _turns_away() -> Claim:
    """A motion that turns the part away."""
    steep = angle(sp.Rational(1, 10), phi)
    place = {**AWAY, **steep}
    ahead, up = sp.cos(phi), -sp.sin(phi)  # the tip's path along the slot's axis
    twist = _twist(push, tau, N, mu_w)
    moved = velocity_at(twist, p * AHEAD - b * UP).dot(UP)
    at_tip = velocity_at(twist, d2 * UP - d1 * AHEAD)
    sticking = [moved, at_tip.dot(AHEAD) - ahead, at_tip.dot(UP) - up]
    force, across = sp.symbols("force across", real=True)
    linear = [one.subs(tau, across / push).expand() for one in sticking]
    solved = solve_linear([one.subs(push, force) for one in linear], [force, across, N])
    exact = {key: sp.nsimplify(value.subs({e_x: 1}).subs(place)) for key, value in solved.items()}
    found = {push: exact[force], tau: exact[across] / exact[force], N: exact[N], e_x: sp.Integer(1)}
    lean = -twist[2]
    return Claim(
        key="slot-edge-turns-away",
        title="Short of that depth the slot's edge can turn the part away",
        place="new; why a part that leans in the mouth jams",
        derived=r"The condition is not too strong: at a depth of 300 µm the paper's part, leaning by 11.4° on "
        r"the slot's edge, is turned away from the axis by a tip that sticks 290 µm above the middle ($\mu = "
        r"0.36$), until its front bears on the other wall.",
        steps=(
            "Sticking tip, slot's edge slipping inwards: balance and Coulomb's law hold at the witness.",
        ),
        hypotheses=(EVEN, ONE),
        checks=(
            there_is(
                "a motion in which the lean grows, the tip sticks and both contacts press",
                [
                    *(sp.Eq(one, 0) for one in sticking),
                    push > 0,
                    N > 0,
                    *COULOMB,
                    velocity_at(twist, p * AHEAD - b * UP).dot(AHEAD) > 0,
                    lean > 0,
                ],
                at={**place, **found},
            ),
        ),
    )


def _free() -> Claim:
    """No slot's edge holds the part; the wall may press on its front corner."""
    W, U, slip = sp.symbols("W U slip", real=True)
    S, C = sp.symbols("S C", real=True)
    c, s = sp.cos(phi), sp.sin(phi)
    leaning = [c > 0, s >= 0, CORNER > 0, kappa <= mu_w, kappa >= -mu_w]
    of_wall = {S: s + kappa * c, C: c - kappa * s}
    balance = [
        sp.Eq(U, push - N * S),
        sp.Eq(W, push * tau - N * C),
        sp.Eq(rho * rate, -push * (d1 * tau + d2) - N * (d1 * C - b * S)),
    ]
    inward = [sp.cos(psi) > 0, sp.Eq(U - d2 * rate, sp.cos(psi))]
    sliding = [sp.Eq(slip, W - d1 * rate + sp.sin(psi))]
    return Claim(
        key="slot-wall-turns-back",
        title="A part free of the slot's edge turns back",
        place="new; self-alignment in the slot",
        derived=r"Where no slot's edge bears on the part, the wall may press on its front corner or not, the part "
        r"turns back if $\tan\psi < d_2/d_1$, $\psi$ being the angle between the part and the tip's path.",
        steps=(
            r"If the ratio at the tip exceeds $-d_2/d_1$, the push turns the part back, and so does the wall.",
            r"If not, friction at the tip acts downwards, so the part's point under it does not slip down; "
            r"but the push carries the centre down faster than the tip's path leads up. Unit: $e_x$ and the "
            r"tip's speed are 1; $(S, C)$ is the direction of the wall's force, turned by less than a right "
            r"angle from straight down.",
        ),
        hypotheses=(EVEN, ONE, r"$\cos\varphi(d_1 - \mu_w b) > \sin\varphi(\mu_w d_1 + b)$"),
        checks=(
            for_all(
                "whatever friction at the wall, its force turns the part back ...",
                leaning,
                (d1 * C - b * S).subs(of_wall) > 0,
            ),
            for_all(
                "... and does not lift it",
                [*leaning, d2 > 0, d2 <= b],
                (d1 * C + d2 * S).subs(of_wall) >= 0,
            ),
            for_all(
                r"ratio above $-d_2/d_1$: the lean falls",
                [push > 0, N >= 0, d1 * C > b * S, d2 + d1 * tau > 0, balance[2]],
                rate < 0,
            ),
            for_all(
                r"ratio below: if the lean does not fall, the centre moves ahead at $\cos\psi$ at least",
                [rate >= 0, d2 > 0, *inward],
                sp.cos(psi) <= U,
            ),
            for_all(
                r"... and then down by $d_2/d_1$ of that at least",
                [
                    push > 0,
                    N >= 0,
                    d2 > 0,
                    d2 + d1 * tau <= 0,
                    C * d1 + S * d2 >= 0,
                    U > 0,
                    *balance[:2],
                ],
                d1 * W <= -d2 * U,
            ),
            for_all(
                r"... so that $\tan\psi < d_2/d_1$ lets the point under the tip slip down, against friction",
                [rate >= 0, FREE > 0, sp.cos(psi) <= U, d1 * W <= -d2 * U, d2 > 0, *sliding],
                slip < 0,
            ),
        ),
    )


def _one_wall() -> Claim:
    """A leaning part spans less than the slot."""
    y = sp.Symbol("y", real=True)
    corner = y + d1 * sp.sin(phi) + b * sp.cos(phi)
    on_edge = y + p * sp.sin(phi) - b * sp.cos(phi)
    return Claim(
        key="slot-one-wall",
        title="When a leaning part cannot touch both walls",
        place="new; clearance of the slot",
        derived=r"A part that leans by $\varphi$ spans $2 b\cos\varphi + e\sin\varphi$ between the slot's edge and "
        r"the wall across, $e$ being the length of its side in the slot. As long as that is less than the "
        r"slot's width, it touches one wall at a time.",
        steps=("Heights of the front corner and of the side at the mouth.",),
        hypotheses=("the front is in the slot, the rear is not",),
        checks=(
            identity(
                "what the part spans",
                corner - on_edge,
                (2 * b * sp.cos(phi) + engaged * sp.sin(phi)).subs(engaged, d1 - p),
            ),
            for_all(
                "both walls cannot be touched",
                [ONE_WALL > 0, sp.Eq(engaged, d1 - p), corner >= room / 2],
                on_edge > -room / 2,
            ),
        ),
    )


def _no_jam() -> Claim:
    """Tips and one wall cannot hold the part."""
    side, normal, across = sp.symbols("W_n N_t R_t", real=True)
    along = sp.Symbol("W_t", real=True)
    c, s = sp.cos(phi), sp.sin(phi)
    cones = [normal >= 0, across <= mu * normal, -across <= mu * normal,
             side >= 0, along <= mu_w * side, -along <= mu_w * side]  # fmt: skip

    def held(name: str, turned: tuple[sp.Expr, sp.Expr]) -> Finding:
        """The wall's normal is turned from straight up by these cosine and sine, towards the push or against it."""
        cosine, sine = turned
        balanced = [
            sp.Eq(normal + side * sine - along * cosine, 0),
            sp.Eq(across + side * cosine + along * sine, 0),
        ]
        return for_all(
            f"no forces of tips and one wall balance each other ({name})",
            [c > 0, s >= 0, NO_JAM > 0, *cones, *balanced],
            _and(sp.Eq(normal, 0), sp.Eq(side, 0)),
        )

    return Claim(
        key="slot-no-jam",
        title="Between tips and one wall the part does not jam",
        place="new; “no jam” with the fixture",
        derived=r"Tips that push the rear edge and one wall cannot hold the part between them if $\cos\varphi(1 - "
        r"\mu\mu_w) > \sin\varphi(\mu + \mu_w)$, that is if both friction angles and the lean make less than "
        r"a right angle together. Without such inner forces the complementarity problem of quasi-static "
        r"motion has a solution: the part moves.",
        steps=(
            "All tips push along one normal, so their forces add up to one in the same cone, and so do those of "
            "one wall: the mouth's edge presses along the part's side, the wall on a corner along its own normal.",
            "Two forces that balance each other are opposite; the cones' axes are a right angle apart, but for "
            "the lean.",
            "Existence: the matrix of the problem is copositive, and of forces without resultant none does work "
            "(Cottle, Pang, Stone, The Linear Complementarity Problem, theorem 3.8.6).",
        ),
        hypotheses=("drag that is linear and positive definite", "one wall is touched at a time"),
        checks=(
            held("the slot's edge on the part's side", (sp.Integer(1), sp.Integer(0))),
            held("the wall on a corner, leaning one way", (c, s)),
            held("... and the other way", (c, -s)),
        ),
    )


def _and(*relations: Boolean) -> Boolean:
    return sp.And(*relations)


def _pivot() -> Claim:
    """The slot's edge in the place of the passive tip."""
    width, beyond, apart = sp.symbols("width beyond apart", positive=True)
    return Claim(
        key="slot-pivot-width",
        title="A quarter turn about the slot's edge",
        place="new; “the top of the fixture is used to pivot the part around”, Section XI",
        derived=r"An upright part that lies against the slot's edge and is pushed beyond it turns as between two "
        r"tips, the edge being the passive one: without a jam if tip and edge are more than $d_w\sqrt{1 + \mu^2}$ "
        r"apart across the push. The tip must be on the part, and the part beside the other wall before it turns. So "
        r"the slot must be wider than $d_w\sqrt{1 + \mu^2}$: 890 µm for the paper's part at $\mu = 0.36$, whose slot of "
        r"976 µm leaves 86 µm of room for part and tip together.",
        steps=(
            "See when the rotation between two tips exists; the edge is a tip without radius.",
            "The upright part must not reach the other wall, or it lies against that as well.",
        ),
        hypotheses=(
            "the part is turned by one push that passes the edge",
            r"one $\mu$ at tip and edge (else the smaller one)",
        ),
        checks=(
            for_all(
                r"wider than $d_w\sqrt{1 + \mu^2}$",
                [apart**2 > width**2 * (1 + mu**2), apart < beyond, beyond < room],
                room**2 > width**2 * (1 + mu**2),
            ),
            there_is(
                "room in the paper's slot: the part reaches 933 µm beyond the edge, the tip pushes 895 µm beyond it",
                [apart**2 > width**2 * (1 + mu**2), apart < beyond, beyond < room],
                at={
                    width: sp.Integer(837),
                    mu: sp.Rational(36, 100),
                    apart: sp.Integer(895),
                    beyond: sp.Integer(933),
                    room: sp.Integer(976),
                },
            ),
        ),
    )
