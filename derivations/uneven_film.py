r"""A film whose drag differs from place to place, or from instant to instant.

Every place ``x`` of the area resists its own velocity ``u = v + omega z x x`` with the force ``-k u``;
``k > 0`` may depend on the place, on the time and on the motion itself. At one instant it is a number at
each place, and the drag is that of a centre and a ratio of that instant (``drag_tensor.py``).
"""

from __future__ import annotations

import sympy as sp

from derivations._claim import Claim
from derivations._derivation import Derivation
from derivations._statement import as_written, for_all, identity, there_is
from derivations.opposite_edges import APPROACH, W, across, along, kappa, twists
from derivations.two_sided_rotation import T, V, h

v_x, v_y, omega = sp.symbols("v_x v_y omega", real=True)
X, Y, K = (
    sp.symbols(" ".join(f"{name}_{i}" for i in range(1, 4)), real=True) for name in ("x", "y", "k")
)
m, c_x, c_y, rho_c = sp.symbols("m c_x c_y rho_c", real=True)
z, C = sp.symbols("z C", positive=True)
w_1, w_2, s_1, s_2 = sp.symbols("w_1 w_2 s_1 s_2", positive=True)
t_1, t_2, g_1, g_2, e_1, e_2 = sp.symbols("t_1 t_2 g_1 g_2 e_1 e_2", real=True)
r_1, r_2 = sp.symbols("r_1 r_2", positive=True)
r, R, turn = sp.symbols("r R Omega", positive=True)
drop = sp.Symbol("e", positive=True)
tau, speed, far, half, slope, near = sp.symbols("tau v P a q r_c", positive=True)
low, top, least, most, of = sp.symbols("k_low k_top K_low K_top f", real=True)


def derive() -> Derivation:
    """Derive centre and ratio of any positive drag, and how far a gradient or thinning moves the centre."""
    return Derivation(
        name="uneven_film",
        summary="A film whose drag differs from place to place, at one instant.",
        claims=(_at_an_instant(), _gradient(), _thinning(), _dry()),
    )


def _total(of: list[sp.Expr]) -> sp.Expr:
    return as_written(lambda: sp.Add(*(k * one for k, one in zip(K, of, strict=True))))


def _at_an_instant() -> Claim:
    velocity = [(v_x - omega * y, v_y + omega * x) for x, y in zip(X, Y, strict=True)]
    moments = [x * u[1] - y * u[0] for x, y, u in zip(X, Y, velocity, strict=True)]
    total = sum(K)
    centre = {
        m: total,
        c_x: sum(k * x for k, x in zip(K, X, strict=True)) / total,
        c_y: sum(k * y for k, y in zip(K, Y, strict=True)) / total,
    }
    about = sum(
        k * ((x - centre[c_x]) ** 2 + (y - centre[c_y]) ** 2)
        for k, x, y in zip(K, X, Y, strict=True)
    )
    force = m * (v_x - omega * c_y), m * (v_y + omega * c_x)
    moment = m * rho_c * omega + c_x * force[1] - c_y * force[0]

    def there(of: sp.Expr) -> sp.Expr:
        return of.subs(rho_c, about / total).subs(centre)

    return Claim(
        key="uneven-film-instant",
        title="Any positive drag of the area has a centre and a ratio at each instant",
        place="new; the paper's film is even",
        derived=r"Let each place resist its velocity by $k > 0$ times it, whatever $k$ hangs on. At that "
        r"instant the drag is $m = \int k$ times that of a film with its centre at $c = \int k x / m$, the "
        r"ratio $\rho_c = \int k |x - c|^2 / m$ and the same drag in all directions. A proof for every "
        r"centre and ratio of a range at every instant holds for it if $c$ and $\rho_c$ keep within them.",
        steps=(
            r"Force and moment are sums over the places, linear in the twist; three places show it, as "
            r"both sides are sums over places and pairs of places.",
        ),
        hypotheses=("the force on a place is along its velocity and against it",),
        checks=(
            identity(
                "force",
                [_total([u[0] for u in velocity]), _total([u[1] for u in velocity])],
                [there(one) for one in force],
            ),
            identity("moment about the reference point", _total(moments), there(moment)),
        ),
    )


def _gradient() -> Claim:
    def hyperbolic(of: sp.Expr) -> sp.Expr:
        return of.rewrite(sp.exp)

    pairs = [w_1 + w_2 - 1 <= 0, w_1 + w_2 - 1 >= 0, s_1 >= 1, s_2 >= 1, s_1 <= C, s_2 <= C]
    bounded = [t_1 <= g_1, -g_1 <= t_1, t_2 <= g_2, -g_2 <= t_2, g_1 > 0, g_2 > 0, e_1 > 0, e_2 > 0]
    weight = w_1 * s_1 + w_2 * s_2
    return Claim(
        key="uneven-film-gradient",
        title="How far a gradient of the drag moves its centre",
        place="new",
        derived=r"Let the area be point-symmetric with the mean $\lambda$ of the squares along its long axis, "
        r"$\rho$ the mean of $|x|^2$, and $k$ grow from the centre by $e^{\gamma\cdot x}$ or by $1 + \gamma"
        r"\cdot x$, $|\gamma\cdot x| \le Z < 1$ on it and $C = \cosh Z$. Then $|c| \le |\gamma| \lambda C$ "
        r"and $\rho / C - |c|^2 \le \rho_c \le \rho C$.",
        steps=(
            r"Opposite places $\pm x$ have the mean drag $s$ and differ from it by $\pm t s$: $s = \cosh"
            r"(\gamma\cdot x)$ and $t = \tanh$, or $s = 1$ and $t = \gamma\cdot x$; so $|t| \le |\gamma\cdot "
            r"x|$ and $1 \le s \le C$.",
            r"So a coordinate of $c$ is at most $C$ times the mean of $|\gamma\cdot x|\,|e\cdot x|$, which is "
            r"at most $|\gamma|\lambda$ (Cauchy and Schwarz).",
            r"$\rho_c + |c|^2$ is the mean of $s |x|^2$ over that of $s$.",
        ),
        hypotheses=(
            "k grows from the centre as stated",
            "the area is point-symmetric about the centre of the even film",
        ),
        checks=(
            identity(
                r"$z\cosh z - \sinh z$ vanishes at 0 and grows by $z \sinh z \ge 0$: $\tanh z \le z$",
                hyperbolic(sp.Derivative(z * sp.cosh(z) - sp.sinh(z), z)),
                hyperbolic(z * sp.sinh(z)),
            ),
            for_all(
                "a coordinate of the centre, two pairs: over the sum of the weights, at most C times that "
                "of an even film",
                [*pairs, *bounded],
                w_1 * s_1 * t_1 * e_1 + w_2 * s_2 * t_2 * e_2
                <= C * (w_1 * g_1 * e_1 + w_2 * g_2 * e_2) * weight,
            ),
            for_all(
                "the ratio, two pairs, from above",
                [*pairs, C >= 1],
                w_1 * s_1 * r_1 + w_2 * s_2 * r_2 <= C * (w_1 * r_1 + w_2 * r_2) * weight,
            ),
            for_all(
                "and from below",
                [*pairs, C >= 1],
                C * (w_1 * s_1 * r_1 + w_2 * s_2 * r_2) >= (w_1 * r_1 + w_2 * r_2) * weight,
            ),
            there_is(
                "the centre does move: of two places, the one with the larger drag draws it",
                [K[0] > K[1], K[0] * X[0] + K[1] * X[1] > 0],
                {
                    K[0]: sp.Rational(11, 10),
                    K[1]: sp.Integer(1),
                    X[0]: sp.Integer(1),
                    X[1]: sp.Integer(-1),
                },
            ),
        ),
    )


def _thinning() -> Claim:
    centre = (K[0] * X[0] + K[1] * X[1]) / (K[0] + K[1])
    return Claim(
        key="uneven-film-thinning",
        title="A film that thins as a power of the speed: its centre and ratio hang on the centre of turning alone",
        place="new",
        derived=r"Let a place drag by $k = |u|^{-e}$, $e < 2$. While the part turns about $p$, $k$ is in proportion "
        r"to $|x - p|^{-e}$ over the area, whatever the speed; while it does not turn, $k$ is even. So bounds of "
        r"$c$ and $\rho_c$ over all $p$ hold for every motion. Over a cell of area $\pi R^2$ the mean of $|x - "
        r"p|^{-e}$, $0 \le e < 2$, is at most $2 R^{-e} / (2 - e)$.",
        steps=(
            r"$|u| = |\omega|\,|x - p|$; a factor on all of $k$ cancels in $c$ and in $\rho_c$.",
            r"Of all areas of one size the disc about $p$ has the largest mean of a function that falls with "
            r"$|x - p|$.",
            r"With $k$ between $k_{low}$ and $k_{top}$ at the places of a cell of half side $a$ about $x_0$, the mean of "
            r"$k (x - x_0)$ is at most $(k_{top} - k_{low}) a / 4$ in size, as the mean of $|x - x_0|$ is $a / 2$ and "
            r"that of $x - x_0$ is 0; it is also at most $a$ times the mean of $k$.",
        ),
        hypotheses=(
            "the drag of a place is a power of its speed, and otherwise even",
            "the film lies under a rectangle with its centre at the reference point",
        ),
        checks=(
            identity(
                "a factor on all of the drag moves no centre",
                centre.subs({k: turn**-drop * k for k in K[:2]}, simultaneous=True),
                centre,
            ),
            identity(
                "speed and place are factors of the drag",
                (turn * r) ** -drop,
                turn**-drop * r**-drop,
            ),
            identity(
                r"$2 r^{2 - e} / (2 - e)$, which vanishes at 0, grows as the drag of a ring, $2 r\, r^{-e}$",
                sp.Derivative(2 * r ** (2 - drop) / (2 - drop), r),
                as_written(lambda: 2 * r * r**-drop),
            ),
            for_all(
                "two places of a cell on either side of its middle",
                [low <= K[0], K[0] <= top, low <= K[1], K[1] <= top, of >= 0],
                of * (K[0] - K[1]) <= of * (top - low),
            ),
            for_all(
                "two cells, one that adds to a mean and one that takes from it",
                [
                    *(low >= 0, low <= K[0], K[0] <= top, least > 0, least <= K[1], K[1] <= most),
                    *(X[0] >= 0, X[1] >= 0, of >= 0, top * X[0] - least * X[1] <= of),
                ],
                (K[0] * X[0] - K[1] * X[1]) * (low + least) <= of * (K[0] + K[1]),
            ),
        ),
    )


def _dry() -> Claim:
    still, sliding = twists()
    held = (still + sp.Symbol("rate", real=True) * sliding)[2]
    law = {h: T * along + W * across, V: T * across - W * along}
    place = sp.Symbol("x", real=True)
    velocity = sp.Matrix([v_x, v_y])
    return Claim(
        key="uneven-film-dry",
        title="Dry contact under an even film: its centre and ratio, by the least speed of the part",
        place="new; the paper's film has no dry contact under it",
        derived=r"Let a place of speed $|u|$ drag by $\tau u/|u|$ besides the film, $0 \le \tau \le \hat\tau$ "
        r"(over the film's drag, a speed), with any $\tau$ at each place and instant. Then $1 \le k \le 1 + \hat\tau/|u|$. "
        r"Turning about $p$ while a tip advances against the edge at $v_n$, its contact within $R$ of the centre, "
        r"a place has $\hat\tau/|u| \le \hat\tau (R + |p|)/(v_n |x - p|)$. Between two tips on parallel edges the turn is "
        r"$(\sin\theta + e\cos\theta)/T$ per travel whatever the slide, so that $\hat\tau/|u|$ is at most $\hat\tau$ over the least "
        r"turn rate and $|x - p|$.",
        steps=(
            r"At the contact the part has at least the tip's speed against the edge, $v_n$, whether it sticks or slips: "
            r"$|\omega|\,|x_c - p| \ge v_n$, and $|x_c - p| \le R + |p|$.",
            r"Bounds over all $p$ are those of any $k$ between these two, by cells, as for a film that thins; the mean of "
            r"$|x - p|^{-1}$ over a cell is at most $2/R$ of its disc.",
            r"$T$ is $(V + W\cos\theta)/\sin\theta$, and for $\cos\theta < 0$ the moving tip is no farther ahead than $W\sin\theta$, "
            r"so that $T^2 = h^2 + V^2 - W^2$ is bounded by the least $h$.",
            r"A pressure $1 + q x$ on $|x| \le a$ with its centre at $c$ has $q = 3c/a^2$, and nowhere more than $1 + 3|c|/a$.",
        ),
        hypotheses=(
            "dry contact lies under the film, which is even but for it and under a rectangle with its centre at the "
            "reference point",
            "a tip that touches the part advances at the stated speed from its first touch to its stop",
            "of two tips: parallel edges",
        ),
        checks=(
            identity(
                "the force of a place is a positive drag times its velocity",
                as_written(lambda: velocity + tau / speed * velocity),
                list((1 + tau / speed) * velocity),
            ),
            for_all(
                "how much a place drags beyond the film while one tip turns the part",
                [turn * near >= speed, near <= R + far, of >= 0, sp.Eq(of * turn * r, tau)],
                of * speed * r <= tau * (R + far),
            ),
            identity(
                "the turn between two tips, whatever the slide",
                sp.Subs(held, kappa, 0),
                APPROACH / T,
            ),
            for_all(
                "the least turn",
                [sp.Eq(turn * T, of), of >= least, least > 0, far >= T, T > 0],
                turn * far >= least,
            ),
            for_all(
                "T by the distance of the tips across the travel",
                [sp.Eq(V, law[V]), across > 0, V + W * along <= of * across],
                of >= T,
            ),
            identity(
                "T by both distances",
                law[h] ** 2 + law[V] ** 2 - W**2,
                T**2,
                on=[(along, across)],
            ),
            for_all(
                "the moving tip ahead of the passive one",
                [along < 0, T > 0, sp.Eq(h, law[h])],
                h < W * across,
            ),
            identity(
                "the centre of a pressure that grows along x",
                sp.Integral((1 + slope * place) * place / (2 * half), (place, -half, half)),
                slope * half**2 / 3,
            ),
            for_all(
                "the largest such pressure",
                [place <= half, -place <= half],
                1 + slope * place <= 1 + slope * half,
            ),
        ),
    )
