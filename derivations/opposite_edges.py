"""Two round tips on roughly opposite edges of a part: any depths, any drag, edges out of parallel.

``D`` moves along -x (its path may bend), ``S`` rests. Each touches an edge of its own: D's at distance
``d_D`` from the reference point, direction ``a``, outward normal ``n``; S's at distance ``d_S``,
turned by ``kappa`` against it, outward normal ``-n(theta + kappa)``. With ``p_S = -q`` the place of S's
contact along its edge and ``(h, V)`` from the centre of S to that of D::

    (h, V) = T a + W n,   W = d_D + r_D + (d_S + r_S) cos(kappa) - q sin(kappa)

One freedom is left, the slide ``q``. Every twist that keeps both contacts is ``V0 + q' V1``; what the
film takes is carried by the two contact wrenches ``w_D(tau_D)``, ``w_S(tau_S)`` exactly if it is
orthogonal to their cross product ``y``: ``q' = -(y . E V0)/(y . E V1)``. The film is about its centre of
drag, which need not be the reference point, and need not be even.
"""

from __future__ import annotations

from typing import NamedTuple

import sympy as sp

from derivations._claim import Claim
from derivations._derivation import Derivation, Function
from derivations._statement import Finding, as_written, for_all, identity
from derivations.mechanics import a, d1, mu, n, rho, theta
from derivations.two_sided_rotation import T, V, h, sigma, tau_D, tau_S

q, W, kappa, drag_a, drag_n = sp.symbols("q W kappa drag_a drag_n", real=True)
stretch, shear, bend, gap, p_D, tau, total = sp.symbols(
    "stretch shear bend gap p_D tau total", real=True
)
d_D, d_S, r_D, r_S, mu_D, mu_S, radii, width, room, clear = sp.symbols(
    "d_D d_S r_D r_S mu_D mu_S radii width room clear", positive=True
)
along, across = sp.symbols("c s", real=True)
"""Cosine and sine of the direction of D's edge."""
CK, SK = sp.cos(kappa), sp.sin(kappa)
APPROACH = across + bend * along
"""Speed of D against its edge, per travel."""
WIDTH = d_D + r_D + (d_S + r_S) * CK - q * SK
CLEAR = room + 2 * (d_S + r_S) * sp.sin(kappa / 2) ** 2 + q * SK
"""V - W, by the room that V leaves beyond both radii and depths: the difference is small."""
LAW = {along: (h * T - W * V) / (h**2 + V**2), across: (V * T + W * h) / (h**2 + V**2)}


def place_of_D() -> sp.Expr:
    """D's contact along its edge, from the foot of the reference point."""
    return T - q * CK - (d_S + r_S) * SK


def arms() -> tuple[sp.Matrix, sp.Matrix]:
    """D's contact and the centre of drag from S's contact, in the frame (a, n).

    Moments are about S's contact: there the slide enters through the centre of drag only, so that
    intervals put in for it lose little.
    """
    to_D = sp.Matrix([T - r_S * SK, d_D + d_S * CK - q * SK])
    return to_D, sp.Matrix([q * CK + d_S * SK + drag_a, d_S * CK - q * SK + drag_n])


def moved(twist: sp.Matrix, arm: sp.Matrix) -> sp.Matrix:
    """Velocity of a point of the part in the frame (a, n), which is left-handed."""
    return sp.Matrix([twist[0] + twist[2] * arm[1], twist[1] - twist[2] * arm[0]])


def pushes(arm: sp.Matrix, force: sp.Matrix) -> sp.Matrix:
    """Wrench of a force at ``arm`` in the frame (a, n, turn)."""
    return sp.Matrix([force[0], force[1], arm[1] * force[0] - arm[0] * force[1]])


def film(twist: sp.Matrix, centre: sp.Matrix) -> sp.Matrix:
    """What the film takes, over e_x, about S's contact, with its centre of drag there."""
    force = sp.Matrix([[1 + stretch, shear], [shear, 1 - stretch]]) * moved(twist, centre)
    return pushes(centre, force) + sp.Matrix([0, 0, rho * twist[2]])


def wrenches(ratio_D: sp.Expr, ratio_S: sp.Expr, to_D: sp.Matrix) -> tuple[sp.Matrix, sp.Matrix]:
    """Of a unit normal force at either contact, with the given ratios of friction."""
    on_S = sp.Matrix([SK + ratio_S * CK, CK - ratio_S * SK])
    return pushes(to_D, sp.Matrix([ratio_D, -1])), pushes(sp.zeros(2, 1), on_S)


def twists() -> tuple[sp.Matrix, sp.Matrix]:
    """V0 and V1: the twist about S's contact is V0 + q' V1."""
    found = []
    for turn, slide in ((APPROACH / T, sp.Integer(0)), (-SK / T, sp.Integer(1))):
        slip = slide + r_S * turn
        found.append(sp.Matrix([slip * CK, -slip * SK, turn]))
    return found[0], found[1]


def slips(rate: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Of the part over D and S, along +a of either edge, at the slide rate ``rate``."""
    still, sliding = twists()
    twist = still + rate * sliding
    at_D = moved(twist, arms()[0])
    return at_D[0] + along - bend * across, twist[0] * CK - twist[1] * SK


def stick_rates() -> tuple[sp.Expr, sp.Expr]:
    """Slide rates at which D, S stick."""
    across_both = WIDTH - r_D
    at_D = APPROACH * across_both + (along - bend * across) * T
    return -at_D / (T * CK - across_both * SK), -APPROACH * r_S / (T - r_S * SK)


def determinant(*columns: sp.Matrix) -> sp.Expr:
    """Of three columns, expanded in no way."""
    x, y, z = columns
    return x.dot(y.cross(z))


def balance(
    ratio_D: sp.Expr, ratio_S: sp.Expr, to_D: sp.Matrix, centre: sp.Matrix
) -> tuple[sp.Expr, sp.Expr, sp.Expr, sp.Expr]:
    """Slide rate times grip, force at D times grip, force at S times grip, and the grip."""
    on_D, on_S = wrenches(ratio_D, ratio_S, to_D)
    still, sliding = (film(twist, centre) for twist in twists())
    return (
        determinant(on_D, on_S, still),
        -determinant(still, on_S, sliding),
        -determinant(on_D, still, sliding),
        -determinant(on_D, on_S, sliding),
    )


def alone() -> tuple[sp.Matrix, sp.Expr]:
    """Twist while D alone pushes, times a stiffness, and that stiffness, at friction ratio tau.

    The stiffness is rho det(E) n . E^-1 w over e_x^2: the tip's push per normal speed.
    """
    centre = sp.Matrix([drag_a, drag_n])
    arm = sp.Matrix([p_D, d_D]) - centre
    push = pushes(arm, sp.Matrix([tau, -1]))
    plane = 1 - stretch**2 - shear**2
    yields = sp.Matrix(
        [
            rho * ((1 - stretch) * push[0] - shear * push[1]),
            rho * ((1 + stretch) * push[1] - shear * push[0]),
            plane * push[2],
        ]
    )
    return APPROACH * yields, pushes(arm, sp.Matrix([0, -1])).dot(yields)


def at_rest_tip() -> tuple[sp.Expr, sp.Expr]:
    """Place of S along its edge, and T, while S's edge is ``gap`` away and D touches at p_D."""
    far = d_S + r_S + gap
    near = d_D + r_D + far * CK
    place = ((p_D + far * SK) * across - V - near * along) / (across * CK + along * SK)
    return place, p_D - place * CK + far * SK


def pushed_at() -> sp.Matrix:
    """D's contact from the centre of drag."""
    return sp.Matrix([p_D - drag_a, d_D - drag_n])


def goes_along() -> sp.Matrix:
    """Velocity of D per travel, in the frame (a, n)."""
    return sp.Matrix([bend * across - along, -APPROACH])


def rolled(rate: sp.Expr) -> sp.Matrix:
    """Twist about the centre of drag whose contact at D moves with D, of a turn ``rate`` per travel."""
    arm, speed = pushed_at(), goes_along()
    return sp.Matrix([speed[0] - rate * arm[1], speed[1] + rate * arm[0], rate])


def film_about_D(twist: sp.Matrix) -> sp.Expr:
    """Moment of the film about D's contact, over e_x, at a twist about the centre of drag."""
    drag = sp.Matrix([[1 + stretch, shear], [shear, 1 - stretch]])
    force = drag * sp.Matrix(twist[:2])
    return rho * twist[2] - pushed_at()[1] * force[0] + pushed_at()[0] * force[1]


def moment_rolling() -> tuple[sp.Expr, sp.Expr]:
    """Moment of the film about D's contact while that sticks: without turning, and what a turn adds."""
    rate = sp.Symbol("rate", real=True)
    moment = film_about_D(rolled(rate))
    return moment.subs(rate, 0), sp.expand(sp.diff(moment, rate))


def from_centre(place: sp.Expr) -> sp.Matrix:
    """The point under S of an edge on which S is at ``place``, from the centre of drag."""
    return sp.Matrix([place * CK - d_S * SK - drag_a, -place * SK - d_S * CK - drag_n])


def closing(twist: sp.Matrix, place: sp.Expr) -> sp.Expr:
    """Speed at which S's edge closes on S at a twist about the centre of drag."""
    reached = moved(twist, from_centre(place))
    return -(reached[0] * SK + reached[1] * CK)


def closing_rolling(rate: sp.Expr, place: sp.Expr) -> sp.Expr:
    """How much it does so per turn if D's contact moves with D, of a turn ``rate`` per travel."""
    nears = (along - bend * across) * SK + APPROACH * CK
    at_S = from_centre(place) - pushed_at()
    return nears / rate - at_S[1] * SK + at_S[0] * CK


def alone_rates() -> dict[str, sp.Expr]:
    """What D alone does, by the names of the functions."""
    twist, stiff = alone()
    place, _ = at_rest_tip()
    slip = moved(twist, pushed_at())[0] + (along - bend * across) * stiff
    pressing, slip_alone = sp.diff(slip, tau), slip.subs(tau, 0)
    ahead, per_turn = moment_rolling()
    rolls = -ahead / per_turn  # D's contact bears no moment
    return {
        # the speed of D cancels, and with it the bend of its path
        "gap_per_turn": closing(twist / APPROACH, place) / (twist[2] / APPROACH),
        "turn_rolling": rolls,
        "gap_per_rolling": closing_rolling(rolls, place),
        "creep_per_turn": (-slip - r_D * twist[2]) / twist[2],
        "lever": p_D - drag_a + tau * (d_D - drag_n),
        "pressing": pressing,
        "slip_alone": slip_alone,
        "stick_ratio": -slip_alone / pressing,
    }


class Offsets(NamedTuple):
    """Of both contacts from the centre of drag: of S (far) out and, negative, along its edge; of D (near) out."""

    far_out: sp.Expr
    far_along: sp.Expr
    near_out: sp.Expr

    @property
    def near_along(self) -> sp.Expr:
        """D's contact along D's edge."""
        return T - self.far_along * CK - (self.far_out + r_S) * SK

    @property
    def arms(self) -> tuple[sp.Matrix, sp.Matrix]:
        """The same as of :func:`arms`."""
        centre = sp.Matrix(
            [self.far_along * CK + self.far_out * SK, self.far_out * CK - self.far_along * SK]
        )
        return sp.Matrix([T - r_S * SK, self.near_out + centre[1]]), centre


OFFSETS = Offsets(d_S + drag_n * CK + drag_a * SK, q + drag_a * CK - drag_n * SK, d_D - drag_n)
SOME = Offsets(*sp.symbols("G Q H", real=True))
"""Any offsets, for what holds of all."""


def drags() -> tuple[sp.Matrix, sp.Matrix]:
    """What the film takes at unit speed along S's edge, and out of it, in the frame (a, n)."""
    drag = sp.Matrix([[1 + stretch, shear], [shear, 1 - stretch]])
    far_along, far_out = (sp.Matrix(axis) for axis in ([CK, -SK], [SK, CK]))
    return drag * far_along, drag * far_out


class Pair(NamedTuple):
    """What two ratios of friction are worth."""

    reach: sp.Expr
    """The moment balance about S's contact: positive where neither ratio closes the grip of parallel edges."""
    share: sp.Expr
    """Of the sum of both ratios."""
    ratio: sp.Expr
    """That at S in the frame of D's edge."""
    normal: sp.Expr
    """The part of S's push that is normal to D's edge."""
    lag: sp.Expr
    """Place at S's edge where the push meets that at D, from the centre of drag."""


def pair(ratio_D: sp.Expr, ratio_S: sp.Expr, both: sp.Expr, at: Offsets = OFFSETS) -> Pair:
    """Of two ratios with the sum ``both``."""
    far_out, far_along, near_out = at
    tangent, normal = SK + ratio_S * CK, CK - ratio_S * SK
    reach = normal * (T + ratio_D * near_out) - ratio_S * far_out
    return Pair(
        reach=reach + SK * (tangent * far_along - normal * (far_out + r_S)),
        share=both * CK + (1 - ratio_D * ratio_S) * SK,
        ratio=tangent / normal,
        normal=normal,
        lag=far_along - ratio_S * far_out,
    )


def held(of: Pair, at: Offsets = OFFSETS) -> tuple[sp.Expr, sp.Expr]:
    """Slide and turn that balance, to one factor: with nothing that cancels in them."""
    far_out, far_along, _ = at
    turns, slides = (
        of.reach * (column[0] - column[1] * of.ratio) + column[1] * of.lag * of.share / of.normal
        for column in drags()
    )
    return far_along * slides + rho * of.share - (far_out + r_S) * turns, turns


def per_turn(of: Pair, at: Offsets = OFFSETS) -> sp.Expr:
    """The slide per turn: a quotient of these, over the reach.

    What multiplies the share is nothing where the ratios cancel.
    """
    far_out, far_along, _ = at
    uneven = of.share / of.reach
    cross = of.ratio - of.lag * uneven / of.normal
    turns, slides = (column[0] - column[1] * cross for column in drags())
    return (far_along * slides + rho * uneven) / turns - (far_out + r_S)


def sticks() -> tuple[sp.Expr, sp.Expr]:
    """Slides per turn at which D, S stick."""
    forward = along - bend * across
    at_D = T * forward + APPROACH * (WIDTH - r_D)
    return -at_D / (APPROACH * CK + forward * SK), -r_S


def rate(slide: sp.Expr) -> sp.Expr:
    """Slide rate at a slide per turn."""
    return APPROACH * slide / (T + slide * SK)


def above(slide: sp.Expr, other: sp.Expr) -> sp.Expr:
    """By how much one rate is above another."""
    return APPROACH * T * (slide - other) / ((T + slide * SK) * (T + other * SK))


def corner(ratio_D: sp.Expr, ratio_S: sp.Expr) -> tuple[sp.Expr, ...]:
    """Slide rate, and how far it is above those at which D, S stick.

    ``total`` stands for the sum of both ratios, so that intervals put in for them see where they cancel.
    """
    slide = per_turn(pair(ratio_D, ratio_S, total))
    return rate(slide), *(above(slide, other) for other in sticks())


def grip(ratio_D: sp.Expr, ratio_S: sp.Expr, at: Offsets = OFFSETS) -> sp.Expr:
    """The grip, with nothing that cancels in it."""
    slides, turns = held(pair(ratio_D, ratio_S, ratio_D + ratio_S, at), at)
    return turns + SK * slides / T


def force_S(ratio_D: sp.Expr, at: Offsets = OFFSETS) -> sp.Expr:
    """Force at S times grip, with nothing that cancels in it."""
    tangent, plane = drags()[0], 1 - stretch**2 - shear**2
    film_takes = rho * (tangent[0] + ratio_D * tangent[1])
    return (
        APPROACH / T * (film_takes - plane * at.far_along * (at.near_along + ratio_D * at.near_out))
    )


def force_D(ratio_S: sp.Expr, at: Offsets = OFFSETS) -> sp.Expr:
    """Force at D times grip, with nothing that cancels in it."""
    far_out, far_along, _ = at
    tangent, plane = drags()[0], 1 - stretch**2 - shear**2
    film_takes = (CK - ratio_S * SK) * tangent[0] - (SK + ratio_S * CK) * tangent[1]
    return APPROACH / T * (rho * film_takes + plane * far_along * (far_along - ratio_S * far_out))


FORCES = (
    "all of the film's drag is linear in the twist, symmetric and positive definite, in the frame of "
    "D's edge, about a centre of drag that is fixed in the part; it may change from instant to instant"
)


def derive() -> Derivation:
    """Derive the slide between two tips on opposite edges, and the functions to generate."""
    place = sp.Matrix([q * CK + (d_S + r_S) * SK, q * SK - (d_S + r_S) * CK])
    turned = sp.Matrix([[along, -across], [across, along]]) * place
    held = (along, across, T, q, d_D, d_S, r_S, kappa, drag_a, drag_n, rho, stretch, shear, bend)
    pushing: tuple[sp.Symbol, ...] = (
        along,
        across,
        p_D,
        V,
        gap,
        d_D,
        d_S,
        r_D,
        r_S,
        kappa,
        drag_a,
        drag_n,
    )
    pushing += (rho, stretch, shear, bend)
    sticking = (along, across, p_D, d_D, drag_a, drag_n, rho, stretch, shear, bend)
    ratios = [(i * mu_D, j * mu_S) for i in (-1, 1) for j in (-1, 1)]
    stiff = alone()[1]
    rates = alone_rates()
    away, apart = at_rest_tip()
    touch = (along, across, p_D, V, gap, d_D, d_S, r_D, r_S, kappa)
    root = sp.sqrt(1 + mu**2)
    return Derivation(
        name="opposite_edges",
        summary="Two round tips on roughly opposite edges of a part.",
        claims=(_twists(), _balance(), _contact_kept(), _existence(), _no_jam()),
        functions={
            "width": Function(
                arguments=(q, d_D, d_S, r_D, r_S, kappa),
                results=(WIDTH,),
                unit="m",
                meaning="W, m: distance of the centres of both tips across D's edge",
            ),
            "apart": Function(
                arguments=(h, clear, W),
                results=(sp.sqrt(h**2 + clear * (clear + 2 * W)),),
                unit="m",
                meaning="T, m: distance of the centres of both tips along D's edge",
            ),
            "clear": Function(
                arguments=(q, d_S, r_S, kappa, room),
                results=(CLEAR,),
                unit="m",
                meaning="V - W, m, of the distance of the tips across the travel less both radii and depths",
            ),
            "direction": Function(
                arguments=(h, V, W, T),
                results=(LAW[along], LAW[across]),
                unit="1",
                meaning="cos and sin of the direction of D's edge while both tips touch",
            ),
            "active_offset": Function(
                arguments=(T, q, d_S, r_S, kappa),
                results=(place_of_D(),),
                unit="m",
                meaning="p_D, m: contact of D along its edge from the foot of the reference point",
            ),
            "place": Function(
                arguments=(along, across, q, d_S, r_S, kappa),
                results=tuple(turned),
                unit="m",
                meaning="x and y of the reference point minus those of the centre of S, m",
            ),
            "stick_rates": Function(
                arguments=(along, across, T, q, d_D, d_S, r_D, r_S, kappa, bend),
                results=stick_rates(),
                unit="1",
                meaning="dq/d(travel) at which D, S stick; above it the part slips towards +a over the tip",
            ),
            "corner": Function(
                arguments=(*held[:6], r_D, *held[6:], tau_D, tau_S, total),
                results=corner(tau_D, tau_S),
                unit="1",
                meaning="dq/d(travel) at friction ratios tau_D, tau_S, of the sum total; the same less that "
                "at which D, S stick",
            ),
            "corner_forces": Function(
                arguments=(*held, mu_D, mu_S),
                results=(
                    *(force_S(ratio) for ratio in (-mu_D, mu_D)),
                    *(force_D(ratio) for ratio in (-mu_S, mu_S)),
                    force_S(sp.Integer(0)),
                ),
                unit="m",
                meaning="normal force at S, at friction ratios -mu_D and mu_D, then at D, at -mu_S and "
                "mu_S, then at S if D has no friction, over e_x and travel rate, times the grip",
            ),
            "corner_grips": Function(
                arguments=(*held, mu_D, mu_S),
                results=tuple(grip(*ratio) for ratio in ratios),
                unit="m",
                meaning="grip, m, at the same ratios: where positive the tips cannot close on the part",
            ),
            "stiffness": Function(
                arguments=(p_D, d_D, drag_a, drag_n, rho, stretch, shear, tau),
                results=(stiff,),
                unit="m^2",
                meaning="m^2: positive where D alone, at friction ratio tau, presses if it advances",
            ),
            "pressing": Function(
                arguments=sticking,
                results=(rates["pressing"],),
                unit="m^2",
                meaning="m^2: positive where D alone presses if it sticks; what the slip grows by per ratio",
            ),
            "slip_alone": Function(
                arguments=sticking,
                results=(rates["slip_alone"],),
                unit="m^2",
                meaning="m^2: slip towards +a of the part over D that pushes alone without friction, per travel, "
                "times the stiffness",
            ),
            "stick_ratio": Function(
                arguments=sticking,
                results=(rates["stick_ratio"],),
                unit="1",
                meaning="friction ratio at which D alone sticks",
            ),
            "gap_per_turn": Function(
                arguments=(*pushing[:-1], tau),
                results=(rates["gap_per_turn"],),
                unit="m",
                meaning="how much S's edge closes on S per turn while D alone pushes at friction ratio tau, m",
            ),
            "gap_per_rolling": Function(
                arguments=pushing,
                results=(rates["gap_per_rolling"],),
                unit="m",
                meaning="the same while the contact of D sticks, m",
            ),
            "turn_rolling": Function(
                arguments=sticking,
                results=(rates["turn_rolling"],),
                unit="1/m",
                meaning="turn per travel while D alone pushes and its contact sticks, rad/m",
            ),
            "creep_per_turn": Function(
                arguments=(
                    *(along, across, p_D, d_D, r_D, drag_a, drag_n, rho, stretch, shear, bend),
                    tau,
                ),
                results=(rates["creep_per_turn"], rates["lever"]),
                unit="m",
                meaning="change of p_D per turn while D alone pushes at friction ratio tau, m; the lever by "
                "which it turns the part, positive where it does so counter-clockwise, m",
            ),
            "passive_place": Function(
                arguments=touch,
                results=(-away, apart),
                unit="m",
                meaning="q and T, m, while S's edge is gap away from S and D touches at p_D",
            ),
            "no_jam": Function(
                arguments=(V, width, radii, mu),
                results=(V * root - width * root**2 - radii,),
                unit="m",
                meaning="m: positive where two tips on parallel edges, of radii that add up to radii, cannot jam the "
                "part; mu is the smaller one of both tips",
            ),
        },
    )


def _twists() -> Claim:
    """The family of twists keeps both contacts, and q is what its parameter says."""
    rate = sp.Symbol("qdot", real=True)
    still, sliding = twists()
    twist = still + rate * sliding
    t = sp.Symbol("t", real=True)
    angle, slid = sp.Function("theta", real=True)(t), sp.Function("q", real=True)(t)
    x, y = (sp.Function(name, real=True)(t) for name in "xy")
    far = theta + kappa
    edge, out = (sp.expand_trig(part.subs(theta, far)) for part in (a, n))
    edge, out = (part.subs(theta, angle) for part in (edge, out))
    tip = sp.Matrix([x, y]) - slid * edge - (d_S + r_S) * out
    speed = sp.Matrix([sp.diff(x, t), sp.diff(y, t)])
    spin = sp.diff(angle, t)
    arm = -slid * edge - d_S * out
    contact = speed + spin * sp.Matrix([-arm[1], arm[0]])
    motion = sp.diff(tip, t)
    return Claim(
        key="opposite-edges-twists",
        title="Motions of a part that keeps two round tips",
        place="new; Section IX-C3 for round tips, edges of any depth that need not be parallel",
        derived=r"With $q$ the way of the reference point ahead of S's contact along S's edge, $W = d_D + "
        r"r_D + (d_S + r_S)\cos\kappa - q\sin\kappa$ and $(h, V) = T a + W n$, every twist that keeps both "
        r"contacts is $V_0 + q' V_1$, with $\theta' = (\sin\theta + e\cos\theta - q'\sin\kappa)/T$ and "
        r"$q' = s_S - r_S\theta'$, $s_S$ the slip at S, $e$ the bend of D's path.",
        hypotheses=("both tips touch their edges between the vertices", r"$T > 0$"),
        checks=(
            identity(
                r"$V - W$ and $T$ from the room",
                [CLEAR + WIDTH - d_D - d_S - r_D - r_S, clear * (clear + 2 * W)],
                [room, (clear + W) ** 2 - W**2],
            ),
            identity(
                "D's edge moves with D across itself",
                moved(twist, arms()[0])[1],
                -across - bend * along,
            ),
            identity(
                "S's edge does not move across itself under S",
                twist[0] * SK + twist[1] * CK,
                sp.Integer(0),
            ),
            identity(
                r"the slip at S is $q' + r_S\theta'$",
                slips(rate)[1],
                rate + r_S * (across + bend * along - rate * SK) / T,
            ),
            identity(
                "slips at the rates at which D and S stick",
                [slips(stick_rates()[0])[0], slips(stick_rates()[1])[1]],
                [0, 0],
            ),
            identity(
                "from the positions: the tip rests, so the contact slips by q' + r_S theta'",
                sp.Matrix([(contact - motion).dot(edge), (contact - motion).dot(out)]),
                [sp.diff(slid, t) + r_S * spin, 0],
            ),
            identity(
                r"the pair turns so that D has the velocity $(-1, e)$ across $a$",
                as_written(lambda: -T * twist[2] - rate * SK),
                -across - bend * along,
            ),
        ),
    )


def _balance() -> Claim:
    """Slide rate and forces by Cramer's rule; they agree with those of even edges."""
    x, y, z, b = (sp.Matrix(sp.symbols(f"{name}1:4", real=True)) for name in "xyzb")
    scale = determinant(x, y, z)
    solved = (
        determinant(b, y, z) * x + determinant(x, b, z) * y + determinant(x, y, b) * z - scale * b
    )
    even = {
        kappa: 0, drag_a: 0, drag_n: 0, stretch: 0, shear: 0, bend: 0, d_D: d1, d_S: d1,
        across: sp.sin(theta), along: sp.cos(theta), q: sigma + T / 2,
    }  # fmt: skip
    slide, push_D, push_S, opening = (
        part.subs(even, simultaneous=True) for part in balance(tau_D, tau_S, *arms())
    )
    p_S = -T / 2 - sigma
    s, c = sp.sin(theta), sp.cos(theta)
    open_ = T * (T + d1 * (tau_D - tau_S))
    L_D = s * (rho + p_S * (p_S + d1 * tau_S)) / open_
    L_S = s * (rho + p_S * (T / 2 - sigma + d1 * tau_D)) / open_
    middle = tau_D * L_D + tau_S * L_S + c / 2 + (r_D - r_S) * s / (2 * T)
    spread = -(h / T) / 2  # q = sigma + T/2
    on_law = {h: T * c + (2 * d1 + r_D + r_S) * s}
    numerators = balance(tau_D, tau_S, *arms())
    anywhere = balance(tau_D, tau_S, *SOME.arms)
    slides, _ = held(pair(tau_D, tau_S, tau_D + tau_S, SOME), SOME)
    cosine, sine = sp.symbols("x y", real=True)
    short = {CK: cosine, SK: sine, bend: 0}
    some = Pair(*sp.symbols("reach share ratio normal lag", real=True))
    one, other = sp.symbols("y_1 y_2", real=True)
    return Claim(
        key="opposite-edges-slide",
        title="Slide and forces between two tips, any drag",
        place="new; Section IX-C3 for any drag",
        derived=r"With contact wrenches $w_D(\tau_D)$, $w_S(\tau_S)$ and $y = w_D \times w_S$ the balance "
        r"$E(V_0 + q'V_1) = L_D w_D + L_S w_S$ has the solution $q' = -(y\cdot EV_0)/(y\cdot EV_1)$; $L_D$, "
        r"$L_S$ are quotients of determinants with the same denominator, the grip. All are quotients of "
        r"polynomials that are of first degree in either ratio, hence monotone in each where the grip does "
        r"not vanish. For even film and parallel edges they are those of round tips. By the slide per turn "
        r"$y$, $q' = (\sin\theta + e\cos\theta)\,y/(T + y\sin\kappa)$, and about the centre of drag nothing "
        r"cancels in them, so that intervals put in lose little.",
        hypotheses=(FORCES, "both tips touch their edges between the vertices"),
        checks=(
            identity("Cramer's rule for three columns", solved, [0, 0, 0]),
            *(
                identity(
                    f"{name} is of first degree in {ratio}",
                    sp.Derivative(part, (ratio, 2)),
                    sp.Integer(0),
                )
                for name, part in zip(("slide", "grip"), numerators[::3], strict=True)
                for ratio in (tau_D, tau_S)
            ),
            identity(
                "D and the centre of drag from S's contact, by offsets from the centre of drag",
                [*arms()[0], *arms()[1]],
                [*OFFSETS.arms[0], *OFFSETS.arms[1]],
            ),
            *(
                identity(
                    f"{name}, with nothing that cancels in it, at any offsets; s for s + e c",
                    left.subs(short, simultaneous=True),
                    right.subs(short, simultaneous=True),
                    on=[(cosine, sine)],
                )
                for name, left, right in (
                    ("the slide", anywhere[0], APPROACH * slides / T),
                    ("the force at D", anywhere[1], force_D(tau_S, SOME)),
                    ("the force at S", anywhere[2], force_S(tau_D, SOME)),
                    ("the grip", anywhere[3], grip(tau_D, tau_S, SOME)),
                )
            ),
            identity(
                "a slide rate by the slide per turn",
                APPROACH * one / T / (other + SK * one / T),
                rate(one / other),
            ),
            identity(
                "the slide per turn, of any reach, share, ...",
                held(some)[0] / held(some)[1],
                per_turn(some),
            ),
            identity(
                "how far one rate is above another", rate(one) - rate(other), above(one, other)
            ),
            identity(
                "the rates at which D, S stick", list(stick_rates()), [rate(at) for at in sticks()]
            ),
            identity("even: grip", opening, T + d1 * (tau_D - tau_S)),
            identity("even: forces", [push_D / opening, push_S / opening], [L_D, L_S]),
            identity(
                "even: slide rate, the law of T in it",
                slide / opening,
                (middle + spread).subs(on_law),
            ),
        ),
    )


def _contact_kept() -> Claim:
    """The force at S has the sign of the speed at which D alone would close on S."""
    push = sp.Matrix(sp.symbols("w1:4", real=True))
    still, sliding = (sp.Matrix(sp.symbols(f"{name}1:4", real=True)) for name in ("u", "v"))
    entries = sp.symbols("E11 E12 E13 E22 E23 E33", real=True)
    xx, xy, xt, yy, yt, tt = entries
    drag = sp.Matrix([[xx, xy, xt], [xy, yy, yt], [xt, yt, tt]])
    normal = still.cross(sliding)
    slip_0, grows = sp.symbols("slip_0 grows", real=True)
    rates, (pushed, stiff) = alone_rates(), alone()
    slip_alone, pressing = rates["slip_alone"], rates["pressing"]
    turns, place_S = sp.symbols("turns p_S", real=True)
    own_still, own_sliding = twists()
    unit = pushes(sp.zeros(2, 1), sp.Matrix([SK, CK]))
    facing = own_still.cross(own_sliding)
    return Claim(
        key="opposite-edges-contact",
        title="Contact with both tips is kept where both forces are positive",
        place="new; “both tips press” for any drag",
        derived=r"Let both numerators $-|w_D, EV_0, EV_1|$, $-|EV_0, w_S, EV_1|$ and the grip be positive for "
        r"all ratios of friction. Then no motion leaves a tip: D alone would press the part onto S, and S "
        r"alone, which rests, moves nothing while D advances. Of the force at S it is enough to know this at "
        r"the ratios from $-\mu_D$ to 0, if D alone without friction would have the part slip towards $+a$, "
        r"and more so with a larger ratio.",
        steps=(
            r"D alone: $E v = L_D w_D$; the speed of S's edge away from S is $n_S\cdot v = L_D\, n_S\cdot "
            r"E^{-1}w_D$. $V_0$ and $V_1$ keep S's edge on S, so $V_0\times V_1$ is a multiple of $n_S$, "
            r"and $|w_D, EV_0, EV_1| = |E|\,(E^{-1}w_D)\cdot(V_0\times V_1)$.",
            r"S alone: its force does no positive work on the part, as S rests, while the film takes all of "
            r"$v\cdot Ev$; so $v = 0$, and D would enter the part.",
            r"Under a positive ratio the part must not slip towards $+a$; so D alone has none.",
        ),
        hypotheses=(
            FORCES,
            "both tips stay on their edges",
            r"D advances, $\sin\theta + e\cos\theta > 0$",
        ),
        checks=(
            identity(
                r"$|w, EV_0, EV_1| = w\cdot\mathrm{adj}(E)\,(V_0\times V_1)$ for symmetric $E$",
                determinant(push, drag * still, drag * sliding),
                (push.T * drag.adjugate() * normal)[0],
            ),
            identity(
                r"$V_0\times V_1 = \frac{\sin\theta + e\cos\theta}{T}\,n_S$",
                facing,
                list(APPROACH / T * unit),
            ),
            identity(
                "D alone pushes: the film has no moment about its contact, whatever the ratio",
                as_written(lambda: film_about_D(pushed)),
                sp.Integer(0),
            ),
            identity(
                "its contact goes with it but for the slip, which is of first degree in the ratio",
                as_written(lambda: moved(pushed, pushed_at())),
                list(goes_along() * stiff + sp.Matrix([slip_alone + tau * pressing, 0])),
            ),
            identity(
                "while it sticks that moment is of first degree in the turn per travel, which makes it 0",
                film_about_D(rolled(turns)),
                moment_rolling()[0] + turns * moment_rolling()[1],
            ),
            identity(
                "the gap closed per turn while it sticks, wherever S's contact is",
                closing(rolled(turns), place_S) / turns,
                closing_rolling(turns, place_S),
            ),
            for_all(
                "D alone slips towards +a at every positive ratio if it does so at 0 and its slip grows with "
                "the ratio",
                [slip_0 > 0, grows >= 0, tau > 0],
                slip_0 + grows * tau > 0,
            ),
        ),
    )


def _existence() -> Claim:
    """Some state of the walk holds, whatever the rates; any thresholds."""
    first, middle, last, high, low = sp.symbols("r_0 r_m r_e u_high u_low", real=True)
    states = (
        first >= high,
        sp.Or(sp.And(first < high, middle > high), sp.And(first > high, middle < high)),
        sp.And(middle <= high, middle >= low),
        sp.Or(sp.And(middle < low, last > low), sp.And(middle > low, last < low)),
        last <= low,
    )
    f00, f01, f10, f11 = sp.symbols("g_00 g_01 g_10 g_11", real=True)
    i, j = sp.symbols("i j", real=True)
    cut = sp.Symbol("r_c", real=True)
    between = f00 * (1 - i) * (1 - j) + f01 * (1 - i) * j + f10 * i * (1 - j) + f11 * i * j
    return Claim(
        key="opposite-edges-existence",
        title="A motion between two tips exists where the grip is open",
        place="new; “no jam” for any drag, edges out of parallel, a coefficient of friction of its own at "
        "either tip",
        derived=r"If at a state the grip is positive at the four corners of both cones, and so are both "
        r"forces, then some motion satisfies balance and Coulomb's law. Its slide rate is one of: that of "
        r"the corner that its slips demand, or that at which D or S sticks, which then lies between the "
        r"rates at both ends of that tip's cone. Uniqueness is not claimed.",
        steps=(
            r"A tip sticks at one slide rate, $u_D$ or $u_S$; above it the part slips towards $+a$ and the "
            r"ratio is $-\mu$, below it $\mu$. By falling rate Coulomb's law allows: $(-\mu_D, -\mu_S)$ above "
            r"both, then the tip with the larger rate sticks, then the middle corner, then the other tip "
            r"sticks, then $(\mu_D, \mu_S)$ below both: one walk through the ratios.",
            r"The rate is continuous along the walk, as the grip does not vanish on the cones; so by the "
            r"intermediate value theorem some state holds.",
            r"If S is pressed only up to a ratio $\tau_c > 0$ of D, and D alone would slip towards $+a$ there, "
            r"cut D's cone at $\tau_c$: S carries nothing then, so D moves as it would alone, and the rate is "
            r"above that at which it sticks. The walk ends there, and some state before holds.",
        ),
        hypotheses=(FORCES, "both tips stay on their edges"),
        checks=(
            for_all(
                "one of the five states holds, whatever the rates at the corners and the thresholds",
                [high >= low],
                sp.Or(*states),
            ),
            for_all(
                "D's cone is cut, and the rate there is above that at which D sticks, the larger one",
                [high >= low, cut > high],
                sp.Or(states[0], sp.And(first < high, cut > high)),
            ),
            for_all(
                "D's cone is cut, and the rate there is above that at which D sticks, the smaller one",
                [high >= low, cut > low],
                sp.Or(*states[:3], sp.And(middle < low, cut > low)),
            ),
            for_all(
                "what is of first degree in either ratio is positive on the cones if it is at the corners",
                [f00 > 0, f01 > 0, f10 > 0, f11 > 0, i >= 0, i <= 1, j >= 0, j <= 1],
                between > 0,
            ),
        ),
    )


def _no_jam() -> Claim:
    """With a friction coefficient of its own at each tip the smaller one decides."""
    s, c = sp.sin(theta), sp.cos(theta)
    free, k, both = sp.Symbol("t", real=True), sp.Symbol("k", positive=True), radii
    geometry = [
        s > 0,
        sp.Eq(V, free * s - (2 * d1 + both) * c),
        free * c + 2 * d1 * s >= 0,
        free > 0,
        sp.Eq(k**2, 1 + mu**2),
        both < 2 * d1,
        V * k > 2 * d1 * k**2 + both,
    ]
    grip = T + d1 * (tau_D - tau_S)
    return Claim(
        key="opposite-edges-no-jam",
        title="The smaller coefficient of friction decides whether two tips jam the part",
        place="new; “no jam” with a coefficient of friction of its own at either tip",
        derived=r"Let $m = \min(\mu_D, \mu_S)$ on parallel edges $d_w$ apart, $R$ the sum of the radii, even "
        r"film, both tips pressing for all ratios. While the contacts have not passed each other a motion "
        r"exists if $d_v > d_w\sqrt{1 + m^2} + R/\sqrt{1 + m^2}$ and $R < d_w$.",
        steps=(
            r"That distance gives $T > m d_w$ as long as the contacts have not passed each other "
            r"($W = d_w + R$, as for one coefficient).",
            r"Let $\mu_S = m$. The walk ends at $(\mu_D, \mu_S)$; going back from there D sticks with $\tau_S "
            r"= \mu_S$. Either the grip stays open, or it closes at a $\tau_D < -\mu_S$, where both forces "
            r"grow without bound, $\tau_D L_D + \tau_S L_S$ with $L_D - L_S$ bounded is negative, and the "
            r"slide rate falls below every threshold: by the intermediate value theorem a state before it holds.",
            r"Let $\mu_D = m$. The walk begins at $(-\mu_D, -\mu_S)$; S sticks with $\tau_D = -\mu_D$. Either "
            r"the grip stays open, or it closes at a $\tau_S > \mu_D$, the slide rate rises above every "
            r"threshold, and a state before it holds.",
        ),
        hypotheses=("even film", "both tips press for all ratios", r"$R < d_w$"),
        checks=(
            for_all(
                r"$T > m d_w$ while the contacts have not passed", geometry, free > 2 * d1 * mu
            ),
            for_all(
                r"$\mu_S$ smaller: the grip closes, if at all, at $\tau_D + \mu_S < 0$",
                [2 * d1 * mu_S < T, sp.Eq(grip.subs(tau_S, mu_S), 0)],
                tau_D + mu_S < 0,
            ),
            for_all(
                r"$\mu_D$ smaller: the grip closes, if at all, at $\tau_S - \mu_D > 0$",
                [2 * d1 * mu_D < T, sp.Eq(grip.subs(tau_D, -mu_D), 0)],
                tau_S - mu_D > 0,
            ),
            _bounded_difference(),
        ),
    )


def _bounded_difference() -> Finding:
    even = {
        kappa: 0, drag_a: 0, drag_n: 0, stretch: 0, shear: 0, bend: 0, d_D: d1, d_S: d1,
    }  # fmt: skip
    _, push_D, push_S, opening = (part.subs(even) for part in balance(tau_D, tau_S, *arms()))
    return identity(
        r"$L_D - L_S = q\sin\theta/T$ whatever the ratios: bounded",
        (push_D - push_S) / opening,
        q * across / T,
    )
