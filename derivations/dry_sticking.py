"""One tip that sticks while the part slides on dry points: how fast it turns, and that nothing else can happen.

The supports oppose their own sliding with the force ``f_j``, their share of all dry friction; only
shares matter (``mu-s-has-no-effect``). ``r`` goes from the contact to a support; while the tip
sticks, a support moves with ``v = u + omega J r``, ``u`` the velocity of the tip and ``J`` a quarter
turn.
"""

from __future__ import annotations

import sympy as sp

from derivations._claim import Claim
from derivations._derivation import Derivation, Function
from derivations._statement import as_written, crossed, for_all, identity
from derivations.mechanics import d1, d2, mu, theta

c, s = sp.cos(theta), sp.sin(theta)
omega = sp.Symbol("omega", real=True)
POINTS = tuple(sp.symbols(f"x_{j} y_{j}", real=True) for j in (1, 2, 3))
"""Places of the supports from the centre, along the pushed edge (a) and along its normal (n)."""


def shares() -> tuple[sp.Expr, ...]:
    """The share of the weight that each support carries (``three_point_support``)."""
    (x1, y1), (x2, y2), (x3, y3) = POINTS
    parts = [x2 * y3 - x3 * y2, x3 * y1 - x1 * y3, x1 * y2 - x2 * y1]
    return tuple(part / sum(parts) for part in parts)


def velocities() -> list[tuple[sp.Expr, sp.Expr, sp.Expr, sp.Expr]]:
    """``(r_a, r_n, v_a, v_n)`` of every support per travel of a tip that sticks and moves along -x."""
    found = []
    for x, y in POINTS:
        r_a, r_n = x - d2, y - d1
        found.append((r_a, r_n, -c + omega * r_n, -s - omega * r_a))  # a' = -n, n' = a
    return found


def balance() -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Moment of the supports' friction about the contact (turned round), and the push along a and n."""
    moment = push_a = push_n = sp.Integer(0)
    for share, (r_a, r_n, v_a, v_n) in zip(shares(), velocities(), strict=True):
        speed = sp.sqrt(v_a**2 + v_n**2)
        moment += share * (v_a * r_n - v_n * r_a) / speed
        push_a += share * v_a / speed
        push_n += share * v_n / speed
    return moment, push_a, push_n


def derive() -> Derivation:
    """Derive the rate of the turn and why a tip that can stick does."""
    moment, push_a, push_n = balance()
    places = tuple(entry for place in POINTS for entry in place)
    state = (theta, d1, d2, omega, *places)
    return Derivation(
        name="dry_sticking",
        summary="One-point sticking on three dry support points.",
        claims=(_rate(), _unique(), _pair()),
        functions={
            "shares": Function(
                arguments=places,
                results=shares(),
                unit="1",
                meaning="share of the weight on each support: all positive if the centre is between them",
            ),
            "moment": Function(
                arguments=state,
                results=(moment,),
                unit="m",
                meaning="grows with omega and vanishes at the turn per travel of a tip that sticks, m",
            ),
            "friction_margin": Function(
                arguments=(*state, mu),
                results=(-mu * push_n - push_a, -mu * push_n + push_a),
                unit="1",
                meaning="mu lambda_n -+ lambda_t over all dry friction: both positive where the contact "
                "sticks",
            ),
        },
    )


def _rate() -> Claim:
    """The power of a turn about the contact is convex in its rate."""
    r_x, r_y, u_x, u_y = sp.symbols("r_x r_y u_x u_y", real=True)
    v = (u_x - omega * r_y, u_y + omega * r_x)
    speed = sp.sqrt(v[0] ** 2 + v[1] ** 2)
    slope = (r_x * v[1] - r_y * v[0]) / speed
    f, g = sp.symbols("f_1 f_2", positive=True)
    p, q = sp.symbols("p_1 p_2", real=True)
    return Claim(
        key="dry-points-rate",
        title="How fast one tip turns a part on dry points",
        place="new; Section VI integrates the three-point model only",
        derived=r"While a tip sticks, the moment of all dry friction about the contact, $M(\omega) = "
        r"\sum f_j\, (r_j \times v_j)/|v_j|$ with $v_j = u + \omega J r_j$, vanishes. $M$ grows with "
        r"$\omega$, strictly unless all supports lie on the line through the contact square to $u$, so the "
        r"rate is the only root, and a bound on it is any $\omega$ at which the sign of $M$ is known. The "
        r"part turns counter-clockwise exactly if $M(0) < 0$: if the centre of friction lies to the left "
        r"of the tip's path, seen along $u$ (Mason's rule).",
        steps=(
            r"$M$ is the derivative of the dissipated power $\sum f_j |v_j|$ in $\omega$.",
            r"Its derivative is $\sum f_j (u\cdot r_j)^2/|v_j|^3 \ge 0$.",
        ),
        hypotheses=("the contact sticks", "the push acts at the height of the support plane"),
        checks=(
            identity(
                "derivative of one support's speed: its moment arm",
                sp.Derivative(speed, omega),
                slope,
            ),
            identity(
                "and its own derivative is a square over a cube",
                sp.Derivative(slope, omega),
                (u_x * r_x + u_y * r_y) ** 2 / speed**3,
            ),
            identity(
                "moment arm at rest, times the tip's speed: minus how far left of its path a support is",
                sp.Subs(slope * speed, omega, 0),
                -sp.Matrix([r_x, r_y]).dot(sp.Matrix([-u_y, u_x])),
            ),
            for_all(
                "a sum of such terms is positive if one of them is",
                [sp.Ne(p, 0)],
                f * p**2 + g * q**2 > 0,
            ),
        ),
    )


def _unique() -> Claim:
    """Sticking excludes slipping, on dry points and on films."""
    F0, F1, w0, w1 = (
        sp.Matrix(sp.symbols(f"{name}_x {name}_y", real=True)) for name in ("F0", "F1", "w0", "w1")
    )
    turn = sp.Symbol("sigma", positive=True)
    normal, slipping = sp.symbols("N_0 N_1", positive=True)
    along, w_a, m_aa, m_an, m_nn = sp.symbols("T_0 w_a m_aa m_an m_nn", real=True)
    w_n = sp.Symbol("w_n", positive=True)
    return Claim(
        key="sticking-excludes-slipping",
        title="A tip that can stick does: no slipping motion exists beside it",
        place="new; sharpens the uniqueness of Section IX-C for one contact",
        derived=r"If one tip on one edge can stick with its force strictly inside the cone of friction, no "
        r"motion in which it slips satisfies balance and Coulomb's law: on any film, and on dry points in "
        r"any number, loaded in any way.",
        steps=(
            r"Let $w$ be the velocity of the part's point in contact and $F(w)$ the push that keeps it, its "
            r"moment about the contact zero. On dry points $F(w_0)\cdot w_1 = \sum f_j\, v_{0j}\cdot "
            r"v_{1j}/|v_{0j}|$, which is no larger than $\sum f_j |v_{1j}| = F(w_1)\cdot w_1$, nor than "
            r"that below zero.",
            r"So $(F_0\times F_1)(w_0\times w_1) = (F_0\cdot w_0)(F_1\cdot w_1) - (F_0\cdot w_1)(F_1\cdot "
            r"w_0) \ge 0$: the push turns the same way as the velocity. On a film $F = M w$ with $\det M > "
            r"0$ says the same.",
            r"A part that slips towards $+a$ has $w_1 = w_0 + \sigma a$ and its push on the edge of the cone "
            r"towards $-a$: the push would have turned the other way.",
        ),
        hypotheses=(
            "one contact",
            "the tip moves into the part",
            "the force of the sticking motion is strictly inside the cone",
        ),
        checks=(
            identity(
                "product of the two cross products",
                as_written(lambda: crossed(F0, F1) * crossed(w0, w1)),
                F0.dot(w0) * F1.dot(w1) - F0.dot(w1) * F1.dot(w0),
            ),
            for_all(
                "it is not negative if each push does most work in its own motion",
                [
                    F1.dot(w1) >= F0.dot(w1),
                    F1.dot(w1) >= -F0.dot(w1),
                    F0.dot(w0) >= F1.dot(w0),
                    F0.dot(w0) >= -F1.dot(w0),
                ],
                F0.dot(w0) * F1.dot(w1) - F0.dot(w1) * F1.dot(w0) >= 0,
            ),
            identity(
                "on a film the cross product of the pushes is that of the velocities times det M",
                crossed(
                    list(sp.Matrix([[m_aa, m_an], [m_an, m_nn]]) * w0),
                    list(sp.Matrix([[m_aa, m_an], [m_an, m_nn]]) * w1),
                ),
                (m_aa * m_nn - m_an**2) * crossed(w0, w1),
            ),
            *(
                for_all(
                    rf"but slipping towards ${sign}$ would make it negative, in the frame $(a, n)$",
                    [mu * normal + toward * along > 0],
                    # F0 = (T_0, -N_0), F1 = N_1 (-+mu, -1), w0 = (w_a, -w_n), w1 = w0 +- sigma a
                    crossed([along, -normal], [-toward * mu * slipping, -slipping]).doit()
                    * crossed([w_a, -w_n], [w_a + toward * turn, -w_n]).doit()
                    < 0,
                )
                for toward, sign in ((1, "+a"), (-1, "-a"))
            ),
        ),
    )


def _pair() -> Claim:
    """Two tips that translate the part."""
    f, g = sp.symbols("f_1 f_2", positive=True)
    u_a, u_n, x1, y1, x2, y2 = sp.symbols("u_a u_n x_1 y_1 x_2 y_2", real=True)
    centre = [(f * x1 + g * x2) / (f + g), (f * y1 + g * y2) / (f + g)]
    return Claim(
        key="dry-points-translation",
        title="A translation on dry points is one on a film with its centre at the centre of friction",
        place="new; eq. (9) is derived for the film",
        derived=r"In a translation every support slides with the same velocity $u$, so dry friction is the "
        r"force $-(\sum f_j)\, u/|u|$ through the centre of friction: the conditions for two tips that stick "
        r"are those on a film with its centre of drag there. With the weight's shares as loads the centre of "
        r"friction is the centre of mass.",
        hypotheses=("the part translates", "one coefficient of friction at all supports"),
        checks=(
            identity(
                "moment of two supports, and of their sum at the centre of friction",
                as_written(lambda: f * (x1 * u_n - y1 * u_a) + g * (x2 * u_n - y2 * u_a)),
                (f + g) * crossed(centre, [u_a, u_n]),
            ),
            identity(
                "with the weight's shares it is the centre of mass",
                [
                    sum(share * place[k] for share, place in zip(shares(), POINTS, strict=True))
                    for k in (0, 1)
                ],
                [0, 0],
            ),
        ),
    )
