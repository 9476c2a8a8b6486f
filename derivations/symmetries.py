"""Complete conditions of a contact on a film, and the maps that carry them into themselves.

The conditions are the balance, the motion of the contact relative to its tip and Coulomb's law with
unilateral contact. A map that leaves all of them as they are carries every motion into a motion:
whatever is proved for one case holds for its images. The maps act contact by contact, so they serve
one tip, two tips on one edge and tips on opposite edges alike.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import sympy as sp

from derivations._claim import Claim
from derivations._derivation import Derivation
from derivations._statement import (
    Circles,
    Finding,
    combined,
    crossed,
    for_all,
    identity,
    positive_by,
    require_zero,
)
from derivations._tex import tex
from derivations.mechanics import (
    PAPER,
    a,
    coulomb,
    cross,
    d1,
    d2,
    d4,
    e_x,
    film,
    mu,
    n,
    rho,
    theta,
    velocity_at,
    wrench,
)

c, s = sp.cos(theta), sp.sin(theta)
q_x, q_y = sp.symbols("q_x q_y", real=True)
Q = sp.Matrix([q_x, q_y])
"""Direction of the pushed edge, of any length: only its sense counts in the conditions."""
F = rho + d1**2 + d2**2
BETA = sp.symbols("cos_beta sin_beta", real=True)
LEFTWARDS = sp.Matrix([-1, 0])
HALF_LENGTH, HALF_WIDTH = sp.Integer(808), sp.Rational(837, 2)
"""Of the paper's part, in µm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Contact:
    """One tip at one edge: place, tip velocity and force."""

    edge: sp.Matrix
    """Cosine and sine of the edge's direction."""
    depth: sp.Expr
    """Distance of the edge's line from the centre (d1)."""
    offset: sp.Expr
    """Along the edge (d2)."""
    tip: sp.Matrix
    """Velocity of the tip."""
    normal: sp.Expr
    tangential: sp.Expr

    def directions(self) -> tuple[sp.Matrix, sp.Matrix]:
        """Along the edge, and outward."""
        turned = {c: self.edge[0], s: self.edge[1]}
        return a.subs(turned, simultaneous=True), n.subs(turned, simultaneous=True)

    def arm(self) -> sp.Matrix:
        """From the centre to the contact."""
        along, out = self.directions()
        return self.offset * along + self.depth * out

    def push(self) -> sp.Matrix:
        """Wrench of the contact on the part."""
        along, out = self.directions()
        return wrench(-out * self.normal + along * self.tangential, self.arm())

    def relative(self, twist: sp.Matrix) -> tuple[sp.Expr, sp.Expr]:
        """Slip along the edge and opening, of the part relative to the tip."""
        along, out = self.directions()
        moving = velocity_at(twist, self.arm()) - self.tip
        return moving.dot(along), -moving.dot(out)


class Image(NamedTuple):
    """What a map makes of a motion."""

    contact: Contact
    on_twists: sp.Matrix
    """Matrix that acts on twists."""
    on_wrenches: sp.Matrix
    """Matrix that acts on wrenches."""
    slip_sign: int
    rho: sp.Expr = rho


class Forces(NamedTuple):
    """Of a sticking contact, over ``e_x |v_p| / F``; and the turn, over ``|v_p| / F``."""

    normal: sp.Expr
    tangential: sp.Expr
    turning: sp.Expr


def general_contact() -> Contact:
    """A contact about which nothing is assumed."""
    u_x, u_y, normal, tangential = sp.symbols("u_x u_y lambda_n lambda_t", real=True)
    return Contact(
        edge=Q,
        depth=d1,
        offset=d2,
        tip=sp.Matrix([u_x, u_y]),
        normal=normal,
        tangential=tangential,
    )


def mirror(contact: Contact) -> Image:
    """World mirrored in the x axis: counter-clockwise becomes clockwise."""
    flip = sp.diag(1, -1)
    image = Contact(
        edge=sp.Matrix([-contact.edge[0], contact.edge[1]]),  # theta -> pi - theta
        depth=contact.depth,
        offset=-contact.offset,
        tip=flip * contact.tip,
        normal=contact.normal,
        tangential=-contact.tangential,
    )
    both = sp.diag(1, -1, -1)
    return Image(image, both, both, slip_sign=-1)


def turn_world(contact: Contact, cosine: sp.Expr, sine: sp.Expr) -> Image:
    """World turned by any angle: pushes in any direction."""
    turn = sp.Matrix([[cosine, -sine], [sine, cosine]])
    image = Contact(
        edge=turn * contact.edge,
        depth=contact.depth,
        offset=contact.offset,
        tip=turn * contact.tip,
        normal=contact.normal,
        tangential=contact.tangential,
    )
    both = sp.diag(turn, 1)
    return Image(image, both, both, slip_sign=1)


def enlarge(contact: Contact, factor: sp.Expr) -> Image:
    """All lengths of the part times a factor, ``rho`` times its square, tips as fast as before."""
    image = Contact(
        edge=contact.edge,
        depth=factor * contact.depth,
        offset=factor * contact.offset,
        tip=contact.tip,
        normal=contact.normal,
        tangential=contact.tangential,
    )
    return Image(
        image,
        on_twists=sp.diag(1, 1, 1 / factor),
        on_wrenches=sp.diag(1, 1, factor),
        slip_sign=1,
        rho=factor**2 * rho,
    )


def carried(name: str, image: Image, on: Circles = ()) -> tuple[Finding, ...]:
    """Whether a map carries the complete conditions into themselves; ``on``: its cosine and sine."""
    contact = general_contact()
    twist = sp.Matrix(sp.symbols("v_x v_y omega", real=True))
    moved = image.on_twists * twist
    slip, opening = contact.relative(twist)
    slip_after, opening_after = image.contact.relative(moved)
    drag_after = film(moved).subs(rho, image.rho)
    return (
        identity(f"{name}: drag of the image = image of the drag", drag_after,
             sp.MatMul(image.on_wrenches, film(twist)), on=on),
        identity(f"{name}: wrench of the image of a contact = image of its wrench",
             image.contact.push(), image.on_wrenches * contact.push(), on=on),
        identity(f"{name}: slip and opening at the image",
             sp.Matrix([slip_after, opening_after]),
             sp.Matrix([image.slip_sign * slip, opening]), on=on),
        *_law_carried(name, contact, image),
    )  # fmt: skip


def _law_carried(name: str, contact: Contact, image: Image) -> tuple[Finding, ...]:
    """Coulomb's law holds of the image's forces and velocities exactly if it held before.

    There is nothing to decide where the image has the same forces, slip and opening.
    """
    slip, opening = sp.symbols("slip opening", real=True)
    before = coulomb(contact.normal, contact.tangential, slip, opening)
    forces = image.contact.normal, image.contact.tangential
    after = coulomb(*forces, image.slip_sign * slip, opening)
    if after == before:
        return ()
    return (
        for_all(
            f"{name}: Coulomb's law with unilateral contact holds of both or of neither",
            [],
            sp.Equivalent(sp.And(*before), sp.And(*after)),
        ),
    )


def on_circle(expression: sp.Expr, x: sp.Symbol, y: sp.Symbol) -> sp.Expr:
    """Polynomial in x, y with every ``x^2`` written as ``1 - y^2``."""
    terms = sp.Poly(expression, x).terms()
    return sp.expand(sum(k * x ** (m % 2) * (1 - y**2) ** (m // 2) for (m,), k in terms))


def sticking(contact: Contact) -> Forces:
    """Forces of a contact that sticks to a tip of unit speed, from the contact's mobility.

    The film answers a wrench with a twist; sticking asks that the part's point move with the tip: two
    equations, linear in the two forces.
    """

    def unit(expression: sp.Expr) -> sp.Expr:
        return on_circle(sp.expand(expression), q_x, q_y)

    unknowns = sp.symbols("lambda_n lambda_t", real=True)
    loaded = replace(contact, normal=unknowns[0], tangential=unknowns[1])
    twist = twist_under(loaded)
    system, right = sp.linear_eq_to_matrix([unit(p) for p in loaded.relative(twist)], unknowns)
    scale = (rho + contact.depth**2 + contact.offset**2) / sp.factor(unit(system.det()))
    forces = system.adjugate() * right * scale
    turn = twist[2].subs(dict(zip(unknowns, forces, strict=True)), simultaneous=True)
    return Forces(*(unit(sp.cancel(part)) for part in (*forces, turn)))


def twist_under(contact: Contact) -> sp.Matrix:
    """Twist with which the film answers the contact's forces, ``e_x`` being 1."""
    drag = film(sp.ones(3, 1)) / e_x
    return sp.Matrix([p / k for p, k in zip(contact.push(), drag, strict=True)])


def edge_contact(edge: sp.Matrix, depth: sp.Expr = d1, offset: sp.Expr = d2) -> Contact:
    """A contact pushed along -x, its forces still to be found."""
    zero = sp.Integer(0)
    return Contact(
        edge=edge, depth=depth, offset=offset, tip=LEFTWARDS, normal=zero, tangential=zero
    )


def sticking_at(direction: sp.Matrix = Q) -> Forces:
    """Forces and turn at an edge of this direction, pushed along -x; linear in the direction.

    Found in the edge's own frame, where the push comes from the direction ``(c, s)``.
    """
    own = edge_contact(sp.Matrix([1, 0]))
    along, out = edge_contact(direction).directions()
    own_along, own_out = own.directions()
    seen = own_along * LEFTWARDS.dot(along) + own_out * LEFTWARDS.dot(out)
    return sticking(replace(own, tip=seen))


def limits() -> tuple[sp.Matrix, sp.Matrix]:
    """Directions between which the contact sticks, ``theta_lo`` and ``theta_hi``."""
    forces = sticking_at()
    from_lo = sp.expand(mu * forces.normal + forces.tangential)
    to_hi = sp.expand(mu * forces.normal - forces.tangential)
    lo = sp.Matrix([from_lo.coeff(q_y), -from_lo.coeff(q_x)])
    hi = sp.Matrix([-to_hi.coeff(q_y), to_hi.coeff(q_x)])
    require_zero(cross(lo, Q) - from_lo, "lower limit")
    require_zero(cross(Q, hi) - to_hi, "upper limit")
    return lo, hi


def derive() -> Derivation:
    """Prove the symmetries and list the cases that follow from Section IX-C."""
    lo, hi = limits()
    return Derivation(
        name="symmetries",
        summary="Cases that follow from one another: sense of turning, direction of push, edge, size.",
        claims=(
            _mirror_claim(),
            _direction_claim(),
            _scale_claim(lo, hi),
            _other_cases(lo, hi),
            _clockwise(lo, hi),
            _left_hand(lo, hi),
            _short_edge(lo, hi),
            _two_points(),
            _two_sided(),
        ),
    )


def _mirror_claim() -> Claim:
    steps = sp.symbols("u_a u_n", real=True)
    along, out = general_contact().directions()
    leaving = replace(general_contact(), tip=along * steps[0] + out * steps[1])
    return Claim(
        key="symmetry-mirror",
        title="Counter-clockwise and clockwise motions are mirror images",
        place="new; what “clockwise” rests on in Section IX-C",
        derived=r"$y \to -y$ carries the complete conditions of any set of contacts into "
        r"themselves, with $\theta \to \pi - \theta$, $d_2 \to -d_2$, $v_\theta \to -v_\theta$, "
        r"$\lambda_n \to \lambda_n$, $\lambda_t \to -\lambda_t$.",
        steps=(
            r"Edge direction and outward normal are $a = (\cos\theta, \sin\theta)$, $n = "
            r"(\sin\theta, -\cos\theta)$. The mirror image of $n$ must be the image's outward normal: "
            r"$\theta' = \pi - \theta$. Then $a'$ is minus the image of $a$: $d_2' = -d_2$, "
            r"$\lambda_t' = -\lambda_t$.",
            r"With $S = \mathrm{diag}(1, -1, -1)$: drag and contact wrenches are multiplied by $S$, "
            "so the balance holds again; slip changes its sign, opening does not.",
            r"Coulomb's law is even: it holds of $(\lambda_n, -\lambda_t)$ and $-$slip whenever it "
            r"holds of $(\lambda_n, \lambda_t)$ and slip.",
        ),
        hypotheses=("a film with the same drag in both directions",),
        checks=(
            identity(
                "sense of slip and opening: at a part at rest, a tip that moves by $(u_a, u_n)$ along "
                "$a$ and $n$ slips by $-u_a$ and opens by $u_n$",
                sp.Matrix(leaving.relative(sp.zeros(3, 1))),
                sp.Matrix([-steps[0], steps[1]]),
                on=[(q_x, q_y)],
            ),
            *carried("mirror", mirror(general_contact())),
        ),
    )


def _direction_claim() -> Claim:
    turned = sp.symbols("cos_delta sin_delta", real=True)
    return Claim(
        key="symmetry-direction",
        title="The direction of the push does not matter",
        place="new; what “the left side” rests on in Section IX-C",
        derived=r"A turn of the world by any angle $\delta$ carries the complete conditions of any "
        r"set of contacts into themselves: $\theta \to \theta + \delta$ and tip velocities turned; "
        r"$d_2$, $v_\theta$ and all contact forces stay. $\delta = \pi$ is the push along $+x$ from "
        "the left.",
        steps=(
            r"The film's drag has no preferred direction: $R E R^T = E$ because $e_y = e_x$.",
            "Arms, normals and tip velocities turn alike; moments, slip and opening are left as they "
            "are.",
        ),
        hypotheses=(r"$e_y = e_x$",),
        checks=carried(r"turn by $\delta$", turn_world(general_contact(), *turned), on=[turned]),
    )


def _scale_claim(lo: sp.Matrix, hi: sp.Matrix) -> Claim:
    factor = sp.Symbol("k", positive=True)
    grown = {d1: factor * d1, d2: factor * d2, rho: factor**2 * rho}
    return Claim(
        key="symmetry-scale",
        title="Size does not matter",
        place="new; Section XI speaks of smaller parts",
        derived=r"Sticking, slipping and the sense of turning depend on $d_2/d_1$, $\rho/d_1^2$, "
        r"$\mu$ and $\theta$ only. A part $k$ times as large with $\rho$ times $k^2$ (as for a film "
        r"of even thickness) follows the same motion, $k$ times as large. What does not scale is "
        "the uncertainty: the same ±5 µm weigh $1/k$ times as much.",
        steps=(
            r"Arms times $k$, $v_\theta$ times $1/k$, forces as they are: drag and contact moments "
            r"are both multiplied by $k$; velocities at the contacts stay.",
        ),
        checks=(
            *carried("enlarged $k$ times", enlarge(general_contact(), factor)),
            identity(r"both ends of the sticking arc keep their directions, $\theta_{lo}$",
                 lo.subs(grown, simultaneous=True), factor**2 * lo),
            identity(r"$\theta_{hi}$", hi.subs(grown, simultaneous=True), factor**2 * hi),
        ),
    )  # fmt: skip


def _other_cases(lo: sp.Matrix, hi: sp.Matrix) -> Claim:
    """The paper's sentence, for everything that Section IX-C then does."""
    half_turn = turn_world(general_contact(), sp.Integer(-1), sp.Integer(0))
    return Claim(
        key="other-cases",
        title="Short edge, left side, clockwise: the cases left out",
        place="Section IX-C1",
        printed=r"“Only the case in which $\theta \in (0, \pi)$ and the probe pushes on the long "
        "edge … However, other cases, such as pushing on the short edge or the left side of the "
        "part, can be analyzed similarly.”",
        derived=r"They need no analysis of their own. With $\theta$ the direction of the pushed "
        r"edge, $d_1$ its distance from the centre and $d_2$ along it: any edge, the same formulas; "
        r"push along $+x$: $\theta - \pi$ for $\theta$; clockwise: $\pi - \theta$ for $\theta$ and "
        r"$-d_2$ for $d_2$. The arc $(\theta_{lo}(d_2), \theta_{hi}(d_2))$ is its own mirror image.",
        steps=(
            r"Long edge facing $+x$ of a part at orientation $\theta$: direction $\theta$. The short "
            r"edge that faces $+x$ after a quarter turn has direction $\theta - \pi/2$ and $d_1$ = "
            "half the long side. Nothing in the conditions knows which edge it is.",
            "Half turn and mirror carry the complete conditions into themselves.",
        ),
        of_print=(
            *carried("half turn", half_turn),
            identity(
                "half turn: a push along $-x$ becomes one along $+x$",
                sp.MatMul(half_turn.on_twists, LEFTWARDS.col_join(sp.zeros(1, 1))),
                [1, 0, 0],
            ),
            *carried("mirror", mirror(general_contact())),
            _short_edge_is_a_case(),
        ),
        sharper=(
            identity(
                r"$\theta_{hi}(d_2) = \pi - \theta_{lo}(-d_2)$, as directions", hi, _mirrored(lo)
            ),
            identity(
                r"$\theta_{lo}(d_2) = \pi - \theta_{hi}(-d_2)$, as directions", lo, _mirrored(hi)
            ),
        ),
    )


def _mirrored(direction: sp.Matrix) -> sp.MatrixExpr:
    """Direction at ``-d2``, mirrored: angle -> pi - angle."""
    return sp.MatMul(sp.diag(-1, 1), direction.subs(d2, -d2))


def _short_edge_is_a_case() -> Finding:
    """A tip on the short edge, its place written in the part's frame, is a contact with that d1."""
    half_length, across = sp.Symbol("half_length", positive=True), sp.Symbol("t", real=True)
    # the short edge at the end -a of the part: outward normal -a, t measured along n
    quarter = {theta: theta - sp.pi / 2}
    contact = edge_contact(a.subs(quarter), half_length, across)
    return identity(
        r"tip on the short edge: $-\ell a + t n$ is $d_2 a' + d_1 n'$ with $\theta' = \theta - "
        r"\pi/2$, $d_1 = \ell$, $d_2 = t$",
        contact.arm(),
        combined((-half_length, a), (across, n)),
    )


def _clockwise(lo: sp.Matrix, hi: sp.Matrix) -> Claim:
    """Lemma 1 for the other sense of turning, proved directly and not by the mirror."""
    start = sp.Matrix(sp.symbols("p_x p_y", real=True))
    lever = {q: -sticking_at(q).turning for q in map(sp.ImmutableMatrix, (start, Q))}
    at_start, now = lever.values()
    example = {**PAPER, d2: sp.Integer(-350)}
    return Claim(
        key="lemma-1-clockwise",
        title="Lemma 1, clockwise",
        place="new; Section IX-C claims the property for “counter clockwise (or clockwise) rotation”",
        derived=r"A part pushed along $-x$ that sticks and turns clockwise ($d_1 \cos\theta > d_2 "
        r"\sin\theta$) keeps doing so exactly until $\theta_{lo} = \mathrm{atan2}(C - \mu A,\ \mu B "
        r"- A)$, the mirror image of $\theta_{hi}(-d_2)$. Example ($d_1 = 418.5$, $d_2 = -350$ µm, "
        rf"$\rho = 0.3769$ mm², $\mu = 0.33$): down to {degrees(lo, example)}°, where "
        rf"counter-clockwise $d_2 = 350$ µm reaches {degrees(hi, {**PAPER, d2: sp.Integer(350)})}°.",
        steps=(
            r"Directions: $q_0$ the start, $q$ a later one, $q \times q_0 > 0$ as the part turns "
            "clockwise.",
            r"$(q_0 \times hi)\,(lo \times q)$ and the margin at the other end follow from sums of "
            "positive products; so does the lever.",
        ),
        checks=(
            positive_by(
                r"sticking between the start and $\theta_{lo}$: the upper margin",
                cross(Q, hi),
                {
                    "lo_start": cross(lo, start),
                    "start_hi": cross(start, hi),
                    "lo_now": cross(lo, Q),
                    "later": cross(Q, start),
                    "width": cross(lo, hi),
                },
                multiplier="lo_start",
                combination="lo_now*start_hi + width*later",
            ),
            identity(r"$lo \times hi = 2 \mu \rho F$, positive", cross(lo, hi), 2 * mu * rho * F),
            positive_by(
                "clockwise between the start and $0$",
                now,
                {
                    "sin_start": start[1],
                    "sin_now": q_y,
                    "lever_start": at_start,
                    "later": cross(Q, start),
                    "d1": d1,
                },
                multiplier="sin_start",
                combination="sin_now*lever_start + d1*later",
            ),
        ),
    )


def _left_hand(lo: sp.Matrix, hi: sp.Matrix) -> Claim:
    """Push along +x on the edge that faces -x, in terms of the part's own orientation."""
    height = sp.Symbol("e", real=True)  # of the tip, along a: up, while the part is upright
    left = edge_contact(-Q, offset=-height)
    example = {**PAPER, d2: sp.Integer(-350)}
    return Claim(
        key="left-hand-push",
        title="Push from the left",
        place="new; Section IX-E: “Ideally, there will be two DTP …, one on each side of the part”",
        derived=r"A tip that pushes along $+x$ on the left long edge, $e$ above the centre (along "
        r"the long axis of a part at orientation $\theta$), sticks exactly for $\theta_{lo}(-e) < "
        r"\theta < \theta_{hi}(-e)$ and turns the part counter-clockwise where $-e \sin\theta > d_1 "
        r"\cos\theta$: below the centre, where the right-hand tip must be above. Example ($e = 350$ "
        rf"µm above the centre, $\mu = 0.33$): sticks from {degrees(lo, example)}° to "
        f"{degrees(hi, example)}° and turns the part clockwise.",
        steps=(
            r"The left edge has direction $\theta + \pi$, its own coordinate runs downwards: $d_2 = "
            r"-e$. Half a turn of the world makes it an edge of direction $\theta$ pushed along $-x$.",
        ),
        checks=(
            identity(r"the place is $e a - d_1 n$", left.arm(),
                     combined((height, Q), (-d1, sp.Matrix([q_y, -q_x])))),
            identity("forces and turn, solved for this contact, are those of the right-hand push at "
                     "$d_2 = -e$", sticking(replace(left, tip=-LEFTWARDS)),
                     [sp.Subs(force, d2, -height) for force in sticking_at()]),
            identity("lever", sp.Subs(sticking_at().turning, d2, -height),
                     crossed((-height, d1), Q)),
        ),
    )  # fmt: skip


def _short_edge(lo: sp.Matrix, hi: sp.Matrix) -> Claim:
    """Numbers of both edges, and the offsets at which an upright edge may be pushed at all."""
    upright = sp.Matrix([0, 1])
    b = rho + d1**2
    reach = mu * b / d1
    long_edge = {**PAPER, d2: sp.Integer(200)}
    short_edge = {**long_edge, d1: HALF_LENGTH}
    low = {**long_edge, mu: sp.Rational(3, 10)}
    least = 2 * mu * sp.sqrt(rho)
    return Claim(
        key="sticking-upright-edge",
        title="Where an upright edge can be pushed: long and short edge",
        place="new; for Steps 1, 3 and 4",
        derived=r"An upright edge pushed along $-x$ sticks exactly for $|d_2| < \mu (\rho + d_1^2)"
        rf"/d_1$, whatever its length; this is never less than $2 \mu \sqrt{{\rho}}$. Paper's part, "
        rf"$\mu = 0.30$: {_number(reach, low)} µm on the long edge ($d_1 = 418.5$ µm), "
        rf"{_number(reach, {**low, d1: HALF_LENGTH})} µm on the short one ($d_1 = 808$ µm). Arc at "
        rf"$d_2 = 200$ µm, $\mu = 0.33$: {degrees(lo, long_edge)}° to {degrees(hi, long_edge)}° on "
        rf"the long edge, {degrees(lo, short_edge)}° to {degrees(hi, short_edge)}° on the short one.",
        steps=(
            rf"At $\theta = \pi/2$ the two margins are {tex(sp.factor(cross(lo, upright)))} and "
            rf"{tex(sp.factor(cross(upright, hi)))}.",
            r"$(\rho + d_1^2)^2 - 4 \rho d_1^2 = (\rho - d_1^2)^2 \ge 0$.",
        ),
        checks=(
            for_all(
                r"both margins positive exactly for $|d_2| < \mu(\rho + d_1^2)/d_1$",
                [],
                sp.Equivalent(
                    sp.And(cross(lo, upright) > 0, cross(upright, hi) > 0),
                    sp.And(d1 * d2 < d1 * reach, -d1 * d2 < d1 * reach),
                ),
            ),
            identity("least reach, squared: the difference is a square",
                     (reach**2 - least**2) * d1**2, mu**2 * (rho - d1**2) ** 2),
        ),
    )  # fmt: skip


def _two_points() -> Claim:
    """Eq. 9 under the mirror: which tip is the upper one changes over."""
    x, y = BETA
    upper, lower, shear = forces = two_points(d2)
    places = {d2: d4 / x - d2, y: -y}
    mirrored = [force.subs(places, simultaneous=True) for force in forces]
    return Claim(
        key="two-points-mirrored",
        title="Two-point sticking, mirrored and on other edges",
        place="new; eq. (9) and Lemma 2 for the cases left out",
        derived=r"Mirrored, a dual tip with misalignment $\beta$ and upper tip at $d_2$ is one with "
        r"$-\beta$ and upper tip at $d_4/\cos\beta - d_2$: the normal forces of the two tips change "
        r"places, the tangential force its sign, the conditions $|\tan\beta| < \mu$, $0 < d_1 "
        r"\sin\beta + d_2 \cos\beta < d_4$ are carried into themselves. The half turn leaves them "
        "as they are; on the short edge $d_1$ is half the long side.",
        steps=(
            "The balance of a part that translates with the tips gives both normal forces and the "
            "sum of the tangential ones.",
            r"The lever $d_1 \sin\beta + d_2 \cos\beta$ becomes $d_4$ minus the lever.",
        ),
        checks=(
            identity("the tips of the image change places, the tangential force its sign",
                 sp.Matrix(mirrored), sp.Matrix([lower, upper, -shear])),
            identity(r"lower tip: $\lambda_n^2 d_4 = e_x |v_p| \cos\beta\, (d_1 \sin\beta + d_2 "
                     r"\cos\beta)$", lower * d4, x * (d1 * y + d2 * x)),
            identity(r"upper tip: $d_4$ minus the lever", upper * d4,
                     x * (d4 - d1 * y - d2 * x)),
            identity(r"tangential force: the drag along the edge, $e_x |v_p| \sin\beta$",
                     sp.MatMul(LEFTWARDS.T, sp.Matrix([-y, x])), shear),
        ),
    )  # fmt: skip


def two_points(top: sp.Expr) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Normal forces of the upper and lower tip and the summed shear, over ``e_x |v_p|``.

    The edge lies along both tips, ``theta = pi/2 + beta`` with ``BETA`` the cosine and sine of beta.
    Written in the edge's own frame, where the part moves along ``(sin beta, cos beta)``.
    """
    upper, lower, shear = unknowns = sp.symbols("lambda_1 lambda_2 lambda_t", real=True)
    x, y = BETA
    first = edge_contact(sp.Matrix([1, 0]), d1, top)
    second = edge_contact(sp.Matrix([1, 0]), d1, top - d4 / x)
    along, out = first.directions()
    pushes = wrench(-out * upper + along * shear, first.arm()) + wrench(-out * lower, second.arm())
    velocity = along * LEFTWARDS.dot(sp.Matrix([-y, x])) + out * LEFTWARDS.dot(sp.Matrix([x, y]))
    balance = film(velocity.col_join(sp.zeros(1, 1))) / e_x - pushes
    (solved,) = sp.solve(list(balance), unknowns, dict=True)
    first_force, second_force, sum_t = (sp.cancel(solved[force]) for force in unknowns)
    return first_force, second_force, sum_t


def _two_sided() -> Claim:
    """The rotation between tips on opposite edges: four cases from one."""
    h, v, t = sp.symbols("h V T", real=True)
    w = 2 * d1
    pair = t * a + w * n
    joint = pair - sp.Matrix([h, v])
    below = joint.subs({theta: sp.pi - theta, t: -t, v: -v}, simultaneous=True)
    rate_t, rate = sp.symbols("T_rate theta_rate", real=True)
    moving = rate_t * a + rate * (t * a.diff(theta) + w * n.diff(theta)) - LEFTWARDS
    (rates,) = sp.solve([moving.dot(n), moving.dot(a)], (rate, rate_t), dict=True)
    nearing = -(t * c + w * s) / t  # -h/T
    return Claim(
        key="two-sided-mirrored",
        title="Two-sided rotation: moving tip above or below, left or right",
        place="new; Section IX-C3 asks for an orientation “close to 0 or π”",
        derived=r"With $(h, V)$ from the passive to the moving tip and $V > d_w$ the part turns "
        r"counter-clockwise, towards $\pi$; with $V < -d_w$ (moving tip below) clockwise, towards "
        r"$0$, through $\pi - \theta(h, |V|)$. A moving tip on the left that pushes along $+x$ has "
        r"$(-h, -V)$ for $(h, V)$: it turns the part counter-clockwise from below.",
        steps=(
            r"While both tips touch, $(h, V) = T a + d_w n$ with $T$ the distance of the contacts "
            r"along the edges; differentiated with $h' = -1$, $V' = 0$ and multiplied by $n$: "
            r"$\theta' = \sin\theta/T$.",
            r"$T \sin\theta = V + d_w \cos\theta$, which has the sign of $V$ as $|V| > d_w$.",
        ),
        hypotheses=("both tips touch their edges",),
        checks=(
            identity(r"$\theta' = \sin\theta/T$", rates[rate], s / t),
            identity(r"$T' = -h/T$", rates[rate_t], nearing),
            identity(r"$T a + d_w n = (h, V)$ in components", combined((t, a), (w, n)), pair),
            for_all(r"$V > d_w$ gives $T \sin\theta > 0$", [v > w, c**2 <= 1], v + w * c > 0),
            for_all(r"$V < -d_w$ gives $T \sin\theta < 0$", [v < -w, c**2 <= 1], v + w * c < 0),
            identity("moving tip below: the mirrored relation", below,
                     sp.MatMul(sp.diag(1, -1), joint)),
            identity("moving tip on the left: the turned relation",
                     [sp.Subs(entry, theta, theta + sp.pi) for entry in pair], -pair),
        ),
    )  # fmt: skip


def degrees(direction: sp.Matrix, at: dict[sp.Symbol, sp.Expr]) -> str:
    """Angle of a direction at a point, in degrees with two decimals."""
    x, y = (sp.sympify(entry).subs(at) for entry in direction)
    return f"{float(sp.deg(sp.atan2(y, x)).evalf(20)):.2f}"


def _number(expression: sp.Expr, at: dict[sp.Symbol, sp.Expr]) -> str:
    return f"{float(expression.subs(at)):.1f}"
