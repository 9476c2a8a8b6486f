"""What the motion on a viscous film does not depend on, and what a recorded motion can tell.

All statements are about the complete conditions: the balance of the film with the contact forces,
and for every contact Coulomb's law with unilateral contact. A change that carries all of them into
themselves carries every motion into a motion, whatever the modes of the contacts are.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import sympy as sp

from derivations._claim import Claim
from derivations._derivation import Derivation
from derivations._statement import (
    Finding,
    Point,
    angle,
    as_written,
    for_all,
    identity,
    there_is,
)
from derivations._tex import tex
from derivations.mechanics import (
    PAPER,
    a,
    coulomb,
    cross,
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
from derivations.one_point_sticking import F

Numbers = dict[sp.Expr, sp.Rational]
k, k_force, k_speed = sp.symbols("k k_f k_v", positive=True)
tau, phi = sp.symbols("tau phi", real=True)
c, s = sp.cos(theta), sp.sin(theta)
TWIST = sp.Matrix(sp.symbols("v_x v_y omega", real=True))
ARM = d2 * a + d1 * n
ONE_TIP = sp.Matrix([v_p, 0])


class Contact(NamedTuple):
    """A tip that touches the part anywhere and moves in any direction."""

    arm: sp.Matrix
    along: sp.Matrix
    out: sp.Matrix
    tip: sp.Matrix
    """World velocity of the tip; 0 for the passive probe."""
    normal: sp.Expr
    tangential: sp.Expr

    def push(self) -> sp.Matrix:
        """Wrench on the part."""
        return wrench(-self.out * self.normal + self.along * self.tangential, self.arm)

    def slip(self, twist: sp.Matrix) -> sp.Expr:
        """Velocity of the part's point relative to the tip, along the edge."""
        return self.along.dot(velocity_at(twist, self.arm) - self.tip)

    def opening(self, twist: sp.Matrix) -> sp.Expr:
        """Speed at which the part leaves the tip."""
        return -self.out.dot(velocity_at(twist, self.arm) - self.tip)

    def motion(self, twist: sp.Matrix) -> tuple[sp.Basic, ...]:
        """Coulomb's law with unilateral contact; slip and opening are named by their symbols."""
        slip, opening = self.speeds()
        return (
            sp.Eq(slip, self.slip(twist)),
            sp.Eq(opening, self.opening(twist)),
            *coulomb(self.normal, self.tangential, slip, opening),
        )

    def speeds(self) -> tuple[sp.Symbol, sp.Symbol]:
        """Symbols for slip and opening, named after the contact's normal force."""
        tag = str(self.normal).removeprefix("lambda_n")
        slip, opening = sp.symbols(f"slip{tag} opening{tag}", real=True)
        return slip, opening


def contact(tag: str) -> Contact:
    """A contact all of whose data are free: both probes, every edge, both tips of the DTP."""
    x, y, p, q, normal, tangential, at = sp.symbols(
        " ".join(f"{name}_{tag}" for name in ["x", "y", "p", "q", "lambda_n", "lambda_t", "theta"]),
        real=True,
    )
    edge = {theta: at}
    return Contact(
        sp.Matrix([x, y]), a.subs(edge), n.subs(edge), sp.Matrix([p, q]), normal, tangential
    )


def balance(twist: sp.Matrix, contacts: Sequence[Contact]) -> sp.Matrix:
    """Film drag less the pushes; zero for a quasi-static motion."""
    return sum((-one.push() for one in contacts), film(twist))


def math(expression: sp.Basic) -> str:
    """LaTeX without the dollar signs, for use inside a formula."""
    return tex(expression).strip("$")


def parts(twist: sp.Matrix, one: Contact) -> list[sp.Expr]:
    """What a contact adds to the conditions: the drag, its wrench, its slip and its opening.

    The balance is the drag less the sum of the wrenches, so what holds of these holds of any number
    of contacts together.
    """
    return [*film(twist), *one.push(), one.slip(twist), one.opening(twist)]


def law_is_a_cone() -> Finding:
    """Coulomb's law is kept when forces and speeds are multiplied by positive numbers."""
    force, shear, slip, opening = sp.symbols("lambda_n lambda_t slip opening", real=True)
    return for_all(
        r"Coulomb's law with unilateral contact, in all modes, stays true when both forces are "
        r"multiplied by $k_f > 0$ and both speeds by $k_v > 0$ (and back by $1/k_f$, $1/k_v$)",
        coulomb(force, shear, slip, opening),
        sp.And(*coulomb(k_force * force, k_force * shear, k_speed * slip, k_speed * opening)),
    )


def _carried(
    what: str, change: dict[sp.Symbol, sp.Expr], balances: Sequence[sp.Expr], speeds: sp.Expr
) -> Finding:
    """Whether a change multiplies the rows of the balance and the speeds of any contact as said."""
    one = contact("1")
    before = parts(TWIST, one)
    forces = {f: k * f for f in (one.normal, one.tangential)}
    after = [entry.subs({**change, **forces}, simultaneous=True) for entry in before]
    factors = [*balances, *balances, speeds, speeds]
    expected = [factor * entry for factor, entry in zip(factors, before, strict=True)]
    return identity(what, after, expected)


def derive() -> Derivation:
    """Invariances of the film model, and what can be identified."""
    return Derivation(
        name="invariances",
        summary="Invariances of the film model and identifiability of its parameters.",
        claims=(
            _complete_conditions(),
            _film_scale(),
            _rate(),
            _size(),
            _isotropy(),
            _twist_of_one_contact(),
            _identify_from_a_twist(),
            _identify_while_sticking(),
            _nothing_from_straight_pushes(),
            _estimated_constants(),
        ),
    )


# the complete conditions have solutions in every mode


UNIT = {**PAPER, mu: sp.Rational(1, 3), e_x: sp.Integer(1)}


def one_contact(tip: sp.Matrix = ONE_TIP) -> Contact:
    """The contact of eq. (5): at ``d2 a + d1 n``, tip moving along x."""
    return Contact(ARM, a, n, tip, *sp.symbols("lambda_n lambda_t", real=True))


def placed(one: Contact, at: Point) -> Contact:
    """The contact with the numbers of ``at`` put in, its forces left open."""
    arm, along, out, tip = (part.subs(at) for part in (one.arm, one.along, one.out, one.tip))
    return Contact(arm, along, out, tip, one.normal, one.tangential)


def conditions(contacts: Sequence[Contact], at: Point) -> list[sp.Basic]:
    """The complete conditions, with the numbers of ``at`` put in."""
    here = [placed(one, at) for one in contacts]
    rows = [sp.Eq(row.subs(at), 0) for row in balance(TWIST, here)]
    return [*rows, *(relation for one in here for relation in one.motion(TWIST))]


def solved_point(contacts: Sequence[Contact], at: Point, closed: Sequence[sp.Expr]) -> Numbers:
    """Exact numbers for twist, forces and speeds: the balance with the equations of a mode."""
    unknowns = [*TWIST, *(f for one in contacts for f in (one.normal, one.tangential))]
    equations = [entry.subs(at) for entry in (*balance(TWIST, contacts), *closed)]
    (solution,) = sp.solve(equations, unknowns, dict=True)
    for one in contacts:
        moves = (one.slip(TWIST), one.opening(TWIST))
        values = (entry.subs(at).subs(solution) for entry in moves)
        solution |= dict(zip(one.speeds(), values, strict=True))
    return {**at, **solution}


def _mode(what: str, contacts: Sequence[Contact], at: Point, *closed: sp.Expr) -> Finding:
    """The complete conditions at the motion of one mode, in exact arithmetic."""
    return there_is(what, conditions(contacts, at), solved_point(contacts, at, closed))


def _one_contact_modes() -> tuple[Finding, ...]:
    """A push that sticks, one that slips each way, and a tip that leaves."""
    one = one_contact()
    slip, opening = one.slip(TWIST), one.opening(TWIST)
    friction = one.tangential - mu * one.normal, one.tangential + mu * one.normal
    up = {**UNIT, d2: sp.Integer(350), v_p: sp.Integer(-1)}
    left = one_contact(-ONE_TIP)
    return (
        _mode("sticking at 90°", [one], {**up, **angle(1, theta)}, slip, opening),
        _mode(
            "slipping at 77.3°, the tip towards smaller $d_2$",
            [one],
            {**up, **angle(sp.Rational(4, 5), theta)},
            friction[1],
            opening,
        ),
        _mode(
            "slipping at 102.7°, the tip towards larger $d_2$",
            [one],
            {**up, d2: sp.Integer(-350), **angle(sp.Rational(5, 4), theta)},
            friction[0],
            opening,
        ),
        _mode(
            "a tip that moves away: no force, no motion",
            [left],
            {**up, **angle(1, theta)},
            left.normal,
            left.tangential,
        ),
    )


def _two_contact_modes() -> tuple[Finding, ...]:
    """Both tips of the DTP on one edge; and the rotation between DTP and STP."""
    forces = sp.symbols("lambda_n1 lambda_t1 lambda_n2 lambda_t2", real=True)
    d3 = sp.Symbol("d3", real=True)  # offset of the second contact on its edge
    pair = (
        Contact(ARM, a, n, ONE_TIP, *forces[:2]),
        Contact(d3 * a + d1 * n, a, n, ONE_TIP, *forces[2:]),
    )
    between = (pair[0], Contact(d3 * a - d1 * n, a, -n, sp.zeros(2, 1), *forces[2:]))
    upright = {**UNIT, **angle(1, theta), v_p: sp.Integer(-1)}
    tilted = {**upright, **angle(sp.Rational(21, 20), theta)}
    return (
        _mode(
            "both tips of the DTP sticking on an edge at 92.8°, with equal tangential forces",
            pair,
            {**tilted, d2: sp.Integer(250), d3: sp.Integer(-150)},
            forces[1] - forces[3],
            pair[0].slip(TWIST),
            *(one.opening(TWIST) for one in pair),
        ),
        _mode(
            "DTP and resting STP on opposite edges, both slipping",
            between,
            {**upright, d2: sp.Integer(430), d3: sp.Integer(-430)},
            forces[1] + mu * forces[0],
            forces[3] - mu * forces[2],
            *(one.opening(TWIST) for one in between),
        ),
    )


def _complete_conditions() -> Claim:
    """The conditions that the invariances speak of, with an exact motion in each mode."""
    return Claim(
        key="complete-conditions",
        title="The complete conditions have a motion in every mode",
        place="new; what the invariances are statements about (Section IX-B)",
        derived=r"A motion is a twist with forces such that $E v = \sum w_n\lambda_n + "
        r"w_t\lambda_t$ and, for every contact, Coulomb's law with unilateral contact. Sticking, "
        "slipping either way, separating, two tips on one edge and two tips on opposite edges all "
        "occur; each is shown by an exact motion of the paper's part.",
        steps=(
            "Write the equations of a mode, solve the linear system in rational numbers, and put "
            "the solution into all conditions.",
            r"Numbers: lengths in µm, $2 d_1 = 837$, $\rho = 376\,900$, $\mu = 1/3$, "
            r"$e_x = 1$, tip speed 1.",
        ),
        checks=(*_one_contact_modes(), *_two_contact_modes()),
    )


# invariances


def _film_scale() -> Claim:
    """E -> k E."""
    return Claim(
        key="film-scale",
        title="The motion does not depend on the scale of the film",
        place="new; bears on Section X-A",
        derived=r"Multiply $E$ by any $k > 0$: the motions are the same and all contact forces "
        r"are multiplied by $k$. With $k = 1/e_x$: trajectories depend on the film through "
        r"$\rho = e_\theta/e_x$ only, and on friction through $\mu$.",
        steps=(
            r"Under $e_x \to k e_x$, $\lambda \to k\lambda$ every row of the balance is "
            r"multiplied by $k$; slip and opening speeds do not change.",
            "Coulomb's law bounds one force by a multiple of another; multiplying both by $k$ "
            "keeps it, in every mode.",
        ),
        hypotheses=(
            r"$e_y = e_x$ and $E$ diagonal in the part's centre, as printed; only contacts and "
            "film act in the plane",
        ),
        checks=(
            _carried(
                r"$e_x \to k e_x$, $\lambda \to k \lambda$: drag and wrench of any contact times $k$, "
                "its slip and opening unchanged",
                {e_x: k * e_x},
                (k, k, k),
                sp.Integer(1),
            ),
            law_is_a_cone(),
        ),
    )


def _rate() -> Claim:
    """v_p -> k v_p."""
    speeds = {entry: k * entry for entry in TWIST}
    tips = {entry: k * entry for entry in contact("1").tip}
    return Claim(
        key="rate-film",
        title="The path on a film does not depend on the speed of the push",
        place="new; bears on the three probe speeds of Section V",
        derived=r"Multiply the velocities of all tips by any $k > 0$: twist and forces are "
        r"multiplied by $k$, so the path is the same and is run through $k$ times as fast. 140, "
        "75 and 7.4 µm/s must give the same path; a measured difference is physics that the "
        "model lacks.",
        steps=(
            r"Under $v_p \to k v_p$, $v \to k v$, $\lambda \to k\lambda$ every row of the "
            "balance, every slip and every opening is multiplied by $k$.",
            "Coulomb's law looks at signs of speeds and ratios of forces only.",
            r"$k < 0$ is excluded: a tip cannot pull.",
        ),
        hypotheses=("no contact force depends on speed other than through the film",),
        checks=(
            _carried(
                r"tip velocities, twist and $\lambda$ times $k$: drag, wrench, slip and opening of any "
                "contact times $k$",
                {**speeds, **tips},
                (k, k, k),
                k,
            ),
            law_is_a_cone(),
        ),
    )


def _size() -> Claim:
    """Lengths -> k lengths, rho -> k^2 rho."""
    one = contact("1")
    lengths = {entry: k * entry for entry in (*one.arm, *one.tip)}
    change = {**lengths, TWIST[0]: k * TWIST[0], TWIST[1]: k * TWIST[1], rho: k**2 * rho}
    return Claim(
        key="size-invariance",
        title="Parts of the same shape move in the same way at every size",
        place="new; bears on the extension to smaller parts (Note to Practitioners, Section XI)",
        derived=r"Multiply all lengths by $k > 0$ and $\rho$ by $k^2$: orientations are the same "
        r"and displacements are multiplied by $k$. What matters is $\rho/d_1^2$, $d_2/d_1$ and "
        r"$\mu$. A uniform film has $\rho$ proportional to the square of the size, so in this "
        "model a plan scales with the part.",
        steps=(
            r"Arms, tip velocities and $(v_x, v_y)$ times $k$, $\omega$ unchanged, $\rho$ times "
            r"$k^2$, $\lambda$ times $k$: force rows times $k$, moment row times $k^2$, slips and "
            "openings times $k$.",
        ),
        hypotheses=(
            "the model keeps its form at the other size: no adhesion; errors of sensing and "
            "control do not shrink by themselves",
        ),
        checks=(
            _carried(
                r"lengths times $k$, $\rho$ times $k^2$: forces of drag and of any contact times $k$, "
                "moments times $k^2$, slip and opening times $k$",
                change,
                (k, k, k**2),
                k,
            ),
            law_is_a_cone(),
        ),
    )


def rotation(by: sp.Expr) -> sp.Matrix:
    """Turn of a vector in the plane, counter-clockwise."""
    return sp.Matrix([[sp.cos(by), -sp.sin(by)], [sp.sin(by), sp.cos(by)]])


def turned(one: Contact, by: sp.Expr) -> Contact:
    """The same contact with the whole plane turned."""
    R = rotation(by)
    return Contact(R * one.arm, R * one.along, R * one.out, R * one.tip, one.normal, one.tangential)


def _turned_conditions() -> tuple[Finding, ...]:
    """All conditions of any contact in a plane turned by phi."""
    one, spin = contact("1"), sp.diag(rotation(phi), 1)
    image, twist = turned(one, phi), spin * TWIST
    return (
        identity(
            r"turn part, tips and velocities by $\varphi$: the drag and the wrench of any contact "
            "turn along",
            [*film(twist), *image.push()],
            [*(spin * film(TWIST)), *(spin * one.push())],
        ),
        identity(
            "its slip and its opening are unchanged",
            [image.slip(twist), image.opening(twist)],
            [one.slip(TWIST), one.opening(TWIST)],
        ),
    )


def _isotropy() -> Claim:
    """R E R^T = E, and what it means."""
    e_y = sp.Symbol("e_y", positive=True)
    spin = sp.diag(rotation(phi), 1)
    E = sp.Matrix.hstack(*(film(sp.eye(3)[:, j]) for j in range(3)))
    general = sp.diag(E[0, 0], e_y, E[2, 2])
    change = spin * general * spin.T - general
    same = [sp.Eq(sp.expand(entry), 0) for entry in change[:2, :2]]
    return Claim(
        key="film-isotropy",
        title="The film has no preferred direction and no preferred place",
        place=r"new; the printed $e_y = e_x$ and “the support plane is uniform” (Section IX-B)",
        derived=r"$R E R^T = E$ for every rotation $R$, and this holds exactly because $e_y = "
        r"e_x$. So turning part and tips together turns the motion along: the conditions depend "
        r"on the edge's own frame only (the direction of the push against the edge, $d_1$, "
        r"$d_2$, $\rho$, $\mu$), not on where the part is on the slide.",
        steps=(
            rf"With $e_y \ne e_x$ the entry of $R E R^T - E$ off the diagonal would be "
            f"{tex(sp.factor(change[0, 1]))}.",
            "Coulomb's law is written in slip, opening and the two forces, which a rotation does "
            "not change. The position of the part occurs in no condition.",
        ),
        checks=(
            identity(r"$R E R^T = E$", list(spin * E * spin.T), list(E)),
            for_all(
                r"$R E R^T = E$ at one $\varphi$ that is no multiple of $90°$ makes $e_y = e_x$",
                [*same, sp.Ne(sp.sin(phi), 0), sp.Ne(sp.cos(phi), 0)],
                sp.Eq(e_x, e_y),
            ),
            *_turned_conditions(),
        ),
    )


# identifiability


def twist_at_ratio() -> tuple[sp.Matrix, sp.Expr]:
    """Twist and normal force of one contact whose friction ratio ``tau`` is given.

    Solved in the edge's own frame, which the isotropy of the film allows, and turned back.
    """
    edge = {theta: 0}
    normal = sp.Symbol("lambda_n", real=True)
    tip = sp.Matrix([v_p * c, -v_p * s])  # along a, and along -n
    one = Contact(ARM.subs(edge), a.subs(edge), n.subs(edge), tip, normal, tau * normal)
    equations = [*balance(TWIST, [one]), one.opening(TWIST)]
    (solution,) = sp.solve(equations, [*TWIST, normal], dict=True)
    twist = sp.Matrix([sp.factor(solution[v]) for v in TWIST])
    return sp.diag(rotation(theta), 1) * twist, sp.factor(solution[normal])


def _twist_of_one_contact() -> Claim:
    """The twist as a function of the friction ratio; sticking is a special ratio."""
    twist, normal = twist_at_ratio()
    below = rho + d2**2 + d1 * d2 * tau
    per_travel = [sp.factor(sp.cancel(-v * below / v_p)) for v in twist]
    slip = a.dot(velocity_at(twist, ARM) - ONE_TIP)
    D, N = (rho + d2**2) * c + d1 * d2 * s, d1 * d2 * c + (rho + d1**2) * s
    lever = d2 * s - d1 * c
    return Claim(
        key="twist-of-one-contact",
        title="The motion of one contact, sticking or slipping, in one formula",
        place="new; eq. (5) covers sticking only",
        derived=r"With the friction ratio $\tau = \lambda_t/\lambda_n$ the motion per unit of "
        rf"travel is $(v_x, v_y, \omega)/|v_p| = ({', '.join(map(math, per_travel))})$ divided by "
        rf"{tex(below)}. Slipping has $\tau = \pm\mu$; sticking has $\tau = -D/N$ with "
        rf"$D = {math(D)}$ and $N = {math(N)}$.",
        steps=(
            r"Balance (three rows) and “the contact does not open” are four linear equations for "
            r"$v_x, v_y, \omega, \lambda_n$; they are solved in the edge's frame and turned back.",
            r"The part's slip along the edge, with the same divisor, is $|v_p|(\tau N + D)$: zero "
            "where the contact sticks.",
        ),
        hypotheses=(rf"{tex(below)} $> 0$ and $\sin\theta > 0$, which make $\lambda_n > 0$",),
        checks=(
            identity(
                r"the slip is $|v_p|(\tau N + D)$ over the divisor",
                [slip],
                [-v_p * (tau * N + D) / below],
            ),
            identity(
                r"$\lambda_n = e_x |v_p| \rho \sin\theta$ over the divisor",
                as_written(lambda: normal * below),
                -e_x * v_p * rho * s,
            ),
            identity(
                r"at $\tau = -D/N$ the turn per travel is "
                r"$(d_2\sin\theta - d_1\cos\theta)/F$, eq. (5)",
                [twist[2].subs(tau, -D / N)],
                [-v_p * lever / F],
            ),
        ),
    )


def _identify_from_a_twist() -> Claim:
    """Ratio of the force and rho from one observed twist and the place of the contact."""
    twist, _ = twist_at_ratio()
    centre = twist[:2, :]
    ratio, gained = -centre.dot(a) / centre.dot(n), cross(ARM, centre) / twist[2]
    return Claim(
        key="identify-from-a-twist",
        title=r"$\rho$ and the friction ratio from one observed twist",
        place="new; for the fit of Section X-A",
        derived=r"From the direction of motion at one instant, the edge's orientation and the place "
        r"of the contact, in every mode of one contact: $\tau = -(v \cdot a)/(v \cdot n)$ and, if "
        r"the part turns, $\rho = (r \times v)/\omega$, with $v$ the velocity of the centre. No "
        r"force, no speed and no simulation are needed. While slipping $|\tau| = \mu$, so both "
        r"$\rho$ and $\mu$ are found from one twist; while sticking $|\tau| \le \mu$ only "
        "bounds it.",
        steps=(
            r"The film is isotropic, so the centre moves in the direction of the contact force: "
            r"$e_x v = \lambda_n(-n + \tau a)$. Its two components give $\tau$.",
            r"The moment row is $\rho e_x \omega = r \times e_x v$: it gives $\rho$.",
            "Both quotients are unchanged when the twist is multiplied by a number: the path is "
            "enough.",
        ),
        hypotheses=(
            r"one contact, $r = d_2 a + d_1 n$ known; for $\rho$: $\omega \ne 0$, that is $d_2 + "
            r"d_1\tau \ne 0$",
            r"for $\mu$: the contact is known to slip",
        ),
        checks=(
            identity(r"$-(v \cdot a)/(v \cdot n) = \tau$", [ratio], [tau]),
            identity(r"$(r \times v)/\omega = \rho$", [gained], [rho]),
            identity(
                "the same at every speed of the tip: the slopes in $v_p$",
                [sp.Derivative(f, v_p) for f in (ratio, gained)],
                [0, 0],
            ),
            identity(
                r"$\omega$ vanishes with $d_2 + d_1\tau$ only",
                as_written(lambda: twist[2] * (rho + d2**2 + d1 * d2 * tau)),
                -v_p * s * (d2 + d1 * tau),
            ),
        ),
    )


def _identify_while_sticking() -> Claim:
    """Sticking pushes: rho from the turn, a bound on mu and nothing more."""
    turn, lever = sp.Symbol("kappa", real=True), d2 * s - d1 * c
    other = sp.Symbol("mu_other", positive=True)
    force, shear = sp.symbols("lambda_n lambda_t", positive=True)
    sticks = coulomb(force, shear, sp.Integer(0), sp.Integer(0))
    second = sp.Symbol("rho_other", positive=True)
    return Claim(
        key="identify-while-sticking",
        title=r"A sticking push tells $\rho$ and only a bound on $\mu$",
        place="new; for the fit of Section X-A",
        derived=r"The path of a sticking push does not depend on $\mu$: every $\mu \ge |\tau|$ "
        r"explains it. Its turn per travel $\kappa = (d_2\sin\theta - d_1\cos\theta)/F$ gives "
        r"$\rho = (d_2\sin\theta - d_1\cos\theta)/\kappa - d_1^2 - d_2^2$, if the lever "
        r"$d_2\sin\theta - d_1\cos\theta$ is not 0. So a range such as $\mu = 0.30 \sim 0.36$ "
        "can only come from pushes that slip.",
        steps=(
            r"In sticking the twist is fixed by balance and kinematics; $\mu$ only has to be at "
            r"least $|\lambda_t|/\lambda_n$.",
            r"$F = \rho + d_1^2 + d_2^2$ is lever over $\kappa$.",
        ),
        hypotheses=("one contact that sticks",),
        checks=(
            for_all(
                r"a sticking contact keeps Coulomb's law when $\mu$ is raised to any larger $\mu'$",
                [*sticks, other >= mu],
                sp.And(*(relation.subs(mu, other) for relation in sticks)),
            ),
            identity(
                r"the inversion returns $\rho$",
                [(lever / turn - d1**2 - d2**2).subs(turn, _stick_turn())],
                [rho],
            ),
            for_all(
                r"two values of $\rho$ with the same turn are equal, unless the lever is 0",
                [sp.Eq(lever * F.subs(rho, second), lever * F), sp.Ne(lever, 0)],
                sp.Eq(rho, second),
            ),
        ),
    )


def _stick_turn() -> sp.Expr:
    """Turn per travel while the contact sticks."""
    twist, _ = twist_at_ratio()
    slip = sp.fraction(sp.together(a.dot(velocity_at(twist, ARM) - ONE_TIP)))[0]
    stick = -slip.subs(tau, 0) / sp.diff(sp.expand(slip), tau)
    return -twist[2].subs(tau, stick) / v_p


def _nothing_from_straight_pushes() -> Claim:
    """Pushes that translate: through the centre, or with both tips."""
    pair = (contact("1"), contact("2"))
    apart = sp.Or(*(sp.Ne(p, q) for p, q in zip(pair[0].arm, pair[1].arm, strict=True)))
    held = [entry for one in pair for entry in velocity_at(TWIST, one.arm) - ONE_TIP]
    straight = {d2: d1 * c / s}
    twist = twist_at_ratio()[0].subs(tau, -c / s).subs(straight)
    moves = sp.And(sp.Eq(TWIST[0], v_p), sp.Eq(TWIST[1], 0), sp.Eq(TWIST[2], 0))
    sliding = twist_at_ratio()[0].subs(d2, -d1 * tau)
    return Claim(
        key="straight-pushes-tell-nothing",
        title="A push that does not turn the part does not identify the film",
        place="new; for the choice of test pushes (Sections VI and X-A)",
        derived=r"A sticking push through the centre and a two-point sticking push move every part "
        r"with the tip, whatever $\rho$ and $\mu$ are: they identify neither. A slipping push "
        r"whose force goes through the centre ($d_2 = -d_1\tau$) gives $\mu$ but not $\rho$.",
        steps=(
            r"Sticking through the centre: the lever is 0, so $\omega = 0$ and $v = (v_p, 0)$ "
            r"solves balance and kinematics for every $\rho$.",
            "Two sticking points fix the rigid motion by themselves.",
            r"Slipping with $\omega = 0$: $\rho$ cancels from the twist, $\tau$ does not.",
        ),
        checks=(
            identity(
                r"sticking through the centre: the twist is $(v_p, 0, 0)$ for every $\rho$",
                list(twist),
                [v_p, sp.Integer(0), sp.Integer(0)],
            ),
            for_all(
                "any two different points of the part that move with the tips: so does the part",
                [*(sp.Eq(entry, 0) for entry in held), apart],
                moves,
            ),
            identity(
                r"slipping with the force through the centre: $\rho$ has no influence",
                [
                    sp.Derivative(sp.Subs(entry, d2, -d1 * tau), rho)
                    for entry in twist_at_ratio()[0]
                ],
                sp.zeros(3, 1),
            ),
            identity(
                r"there, the direction of motion still gives $\tau$",
                [-a.dot(sliding[:2, :]) / n.dot(sliding[:2, :])],
                [tau],
            ),
        ),
    )


def _estimated_constants() -> Claim:
    """The printed estimate of e_x and e_theta from trajectories."""
    one = one_contact()
    names = (e_x, rho, one.normal, one.tangential)
    others = (
        *sp.symbols("e_x_other rho_other", positive=True),
        *sp.symbols("lambda_n_other lambda_t_other", real=True),
    )
    to_other = dict(zip(names, others, strict=True))
    at = {**PAPER, d2: sp.Integer(350), v_p: sp.Integer(-1), e_x: sp.Rational(16089, 100)}
    at |= angle(1, theta)
    point = solved_point([one], at, [one.slip(TWIST), one.opening(TWIST)])
    scale = {other: point[name] / 1000 for name, other in to_other.items()} | {others[1]: at[rho]}
    place = {name: value for name, value in at.items() if name not in (e_x, rho)}
    first = conditions([one], place)
    both = [*first, *(relation.subs(to_other) for relation in first)]
    rows = [row.subs(theta, 0) for row in balance(TWIST, [one])]
    forced = [
        sp.Eq(r, 0) for row in rows for r in (row, row.subs({e_x: others[0], rho: others[1]}))
    ]
    turned_too = sp.Ne(TWIST[2], 0)
    same = sp.And(sp.Eq(e_x, others[0]), sp.Eq(rho * e_x, others[1] * others[0]))
    return Claim(
        key="estimated-film-constants",
        title=r"$e_x$ and $e_\theta$ from trajectories",
        place="Section X-A",
        printed=r"The diagonal elements of $E$ “are estimated to be” $e_x = e_y = 160.89$ and "
        r"$e_\theta = 60.64$, from the trajectories of test pushes",
        derived=r"Trajectories determine $\rho = e_\theta/e_x$ and (from slip) $\mu$; $e_x$ and "
        r"$e_\theta$ separately never. The witness moves exactly alike with $e_x = 160.89$ and "
        r"with a thousandth of it. What can be reported is $\rho = 0.3769$ in the square of the "
        "unit of length.",
        steps=(
            "The motion does not depend on the scale of the film (see there); the test-bed “cannot "
            "sense the force being applied by the probe” (Section VI).",
            "One measured contact force of a push that turns the part would fix both.",
        ),
        of_print=(
            for_all(
                r"two films that explain the same push of one contact are equal (µm, $d_1 = 418.5$)",
                both,
                same,
                at={**point, **scale},
            ),
        ),
        checks=(
            for_all(
                "with the contact force measured as well, and the part turning, they are equal",
                [*forced, turned_too],
                same,
            ),
        ),
    )
