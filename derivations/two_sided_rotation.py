"""Rotation between a moving and a passive tip on opposite edges: kinematics, forces, motion.

What follows from it for the paper's eqs. 10, 11 and its remarks is in ``rotation_existence.py``.

``D`` (moving along -x) touches the upper/right edge, ``S`` (at rest) the opposite one, the part is
``w = 2 d1`` wide. With ``(h, V)`` the vector from S to D, ``T`` its component along ``a``::

    (h, V) = T a + w n,      T^2 = h^2 + V^2 - w^2,      dh/d(travel) = -1

so the orientation is kinematic. What is left is the slide ``sigma`` of the centre along ``a`` from
the middle of the pair; it follows from the balance with friction ratios ``tau_D, tau_S`` in
[-mu, mu] (force along ``a`` over normal force). The denominator of every force is
``T + d1 (tau_D - tau_S) >= T - mu w``: it stays positive exactly when ``V^2 > w^2 (1 + mu^2)`` -
the grasp cannot close and the motion cannot jam.
"""

from __future__ import annotations

import sympy as sp

from derivations._circle import solve_linear
from derivations._claim import Claim
from derivations._derivation import Derivation, Function
from derivations._statement import for_all, identity, require_zero
from derivations.mechanics import a, d1, d2, film, mu, n, rho, theta, velocity_at, wrench

h, sigma, tau, tau_D, tau_S, p_S = sp.symbols("h sigma tau tau_D tau_S p_S", real=True)
V, T = sp.symbols("V T", positive=True)
w = 2 * d1
NORMAL_UNIT = {sp.Symbol("e_x", positive=True): 1}  # forces in units of the film's drag e_x


def kinematics() -> tuple[sp.Expr, sp.Expr, sp.Expr, sp.Expr]:
    """cos, sin of the orientation and the rates of theta and T per unit of travel of D."""
    c, s = sp.symbols("c s", real=True)
    along, out = sp.Matrix([c, s]), sp.Matrix([s, -c])
    (angle,) = sp.solve(list(T * along + w * out - sp.Matrix([h, V])), (c, s), dict=True)
    theta_rate, T_rate = sp.symbols("theta_rate T_rate", real=True)
    spin = theta_rate * (T * -out + w * along)  # d(T a + w n) = T' a + theta' (-T n + w a)
    (rates,) = sp.solve(
        list(T_rate * along + spin - sp.Matrix([-1, 0])), (theta_rate, T_rate), dict=True
    )
    unit = {c**2: 1 - s**2}
    theta_rate_cs = sp.simplify(sp.simplify(rates[theta_rate]).subs(unit))
    require_zero(theta_rate_cs - s / T, "theta' = sin(theta)/T")
    T_rate_cs = sp.simplify(sp.simplify(rates[T_rate]).subs(unit))
    require_zero(T_rate_cs.subs(angle) + h / T, "T' = -h/T")
    return sp.simplify(angle[c]), sp.simplify(angle[s]), theta_rate_cs, -h / T


def two_contact_balance() -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Normal forces at D and S (over e_x) and the slide rate, from the balance of forces."""
    c, s = sp.cos(theta), sp.sin(theta)
    force_D, force_S, rate = sp.symbols("L_D L_S sigma_rate", real=True)
    p_D, p_S = T / 2 - sigma, -T / 2 - sigma
    at_D, at_S = p_D * a + d1 * n, p_S * a - d1 * n
    theta_rate = s / T
    # centre = middle + sigma a, the middle moves with half the speed of D
    centre = sp.Matrix([sp.Rational(-1, 2), 0]) + rate * a + sigma * theta_rate * -n
    twist = sp.Matrix([centre[0], centre[1], theta_rate])
    pushes = wrench(force_D * (-n + tau_D * a), at_D) + wrench(force_S * (n + tau_S * a), at_S)
    balance = film(twist).subs(NORMAL_UNIT) - pushes
    solved = solve_linear(balance, (force_D, force_S, rate))
    grip = T * (T + d1 * (tau_D - tau_S))
    L_D = s * (rho + p_S * (p_S + d1 * tau_S)) / grip
    L_S = s * (rho + p_S * (p_D + d1 * tau_D)) / grip
    require_zero(solved[force_D] - L_D, "force at D")
    require_zero(solved[force_S] - L_S, "force at S")
    slide = tau_D * L_D + tau_S * L_S + c / 2
    require_zero(solved[rate] - slide, "slide rate")
    for ratio in (tau_D, tau_S):  # Moebius in either ratio, hence monotone in it
        require_zero(sp.diff(sp.expand(slide * grip), ratio, 2), f"slide rate in {ratio}")
    return L_D, L_S, slide


def corner_rate(slide: sp.Expr, at_D: int, at_S: int) -> sp.Expr:
    """Slide rate at friction ratios ``at_D mu`` and ``at_S mu``: the denominator T -+ mu w cancels."""
    rate = slide.subs({tau_D: at_D * mu, tau_S: at_S * mu}, simultaneous=True)
    c, s = sp.cos(theta), sp.sin(theta)
    p_S = -T / 2 - sigma
    if at_D == at_S:
        simple = at_D * mu * s * (2 * rho + p_S * (w * at_D * mu - 2 * sigma)) / T**2 + c / 2
    else:
        simple = -at_D * mu * s * p_S / T + c / 2
    require_zero(rate - simple, f"slide rate at the corner ({at_D}, {at_S}) of both cones")
    return simple


def one_contact_motion() -> tuple[sp.Expr, sp.Expr, sp.Expr, sp.Expr]:
    """Twist per travel while only D touches, and how fast S's side closes on S.

    Whatever the contact does, its force lies in the cone: friction ratio ``tau`` in [-mu, mu].
    """
    v_x, v_y, omega, force = sp.symbols("v_x v_y omega L", real=True)
    arm = d2 * a + d1 * n
    twist = sp.Matrix([v_x, v_y, omega])
    balance = film(twist).subs(NORMAL_UNIT) - wrench(force * (-n + tau * a), arm)
    follows = (velocity_at(twist, arm) - sp.Matrix([-1, 0])).dot(n)
    solved = solve_linear([*balance, follows], (v_x, v_y, omega, force))
    stiff = rho + d2**2 + d1 * d2 * tau
    c, s = sp.cos(theta), sp.sin(theta)
    motion = (
        -rho * s * (s - tau * c) / stiff,
        rho * s * (c + tau * s) / stiff,
        s * (d2 + d1 * tau) / stiff,
    )
    for symbol, closed in zip((v_x, v_y, omega), motion, strict=True):
        require_zero(solved[symbol] - closed, f"{symbol} of one-contact motion")
    solved_twist = sp.Matrix([solved[v_x], solved[v_y], solved[omega]])
    closing = velocity_at(solved_twist, p_S * a - d1 * n).dot(-n)
    closed = s * (rho + p_S * (d2 + d1 * tau)) / stiff
    require_zero(closing - closed, "closing speed at S")
    return (*motion, closed)


def derive() -> Derivation:
    """Derive the orientation law, the slide rate and the functions to generate."""
    c_h, s_h, theta_rate, T_rate = kinematics()
    _L_D, L_S, slide = two_contact_balance()
    v_x, v_y, omega, closing = one_contact_motion()
    length = sp.sqrt(h**2 + V**2 - w**2)

    def of_h(expression: sp.Expr) -> sp.Expr:
        return expression.subs({sp.cos(theta): c_h, sp.sin(theta): s_h}).subs(T, length)

    require_zero((c_h**2 + s_h**2 - 1).subs(T, length), "cos^2 + sin^2 = 1")
    T_of_theta = (V + w * sp.cos(theta)) / sp.sin(theta)
    pair = T_of_theta * a + w * n
    require_zero(pair[1] - V, "T of theta keeps the separation V")
    corners = tuple(corner_rate(slide, at_D, at_S) for at_D in (-1, 1) for at_S in (-1, 1))
    return Derivation(
        name="two_sided_rotation",
        summary="Rotation between a moving and a passive tip on opposite edges (eqs. 10, 11).",
        claims=(_orientation_law(of_h(c_h), of_h(s_h), theta_rate),),
        functions={
            "orientation": Function(
                arguments=(h, V, d1),
                results=(of_h(c_h), of_h(s_h)),
                unit="1",
                meaning="cos and sin of theta while both tips touch; (h, V): from S to D, m",
            ),
            "pair_position": Function(
                arguments=(theta, V, d1),
                results=(pair[0],),
                unit="m",
                meaning="h, m, at which both tips touch a part of orientation theta",
            ),
            "slide_rates": Function(
                arguments=(h, V, d1, sigma, rho, mu),
                results=(*map(of_h, corners), of_h(T_rate / 2)),
                unit="1",
                meaning="d(sigma)/d(travel) at friction ratios (tau_D, tau_S) = mu (-1, -1), "
                "mu (-1, 1), mu (1, -1), mu (1, 1), and half of dT/d(travel)",
            ),
            "pair": Function(
                arguments=(h, V, d1),
                results=(length,),
                unit="m",
                meaning="T, m: distance of the contacts along a",
            ),
            "passive_force": Function(
                arguments=(h, V, d1, sigma, rho, tau_D, tau_S),
                results=(of_h(L_S),),
                unit="1",
                meaning="normal force at S over e_x and travel rate; where positive for all "
                "ratios, D alone would press the part on S",
            ),
            "no_jam": Function(
                arguments=(V, d1, mu),
                results=(V**2 - w**2 * (1 + mu**2),),
                unit="m^2",
                meaning="m^2: positive where the grasp cannot close",
            ),
            "one_contact_motion": Function(
                arguments=(theta, d1, d2, rho, tau),
                results=(v_x, v_y),
                unit="1",
                meaning="velocity of the centre per travel while D alone pushes with friction "
                "ratio tau",
            ),
            "one_contact_turning": Function(
                arguments=(theta, d1, d2, rho, tau),
                results=(omega,),
                unit="1/m",
                meaning="turn per travel while D alone pushes with friction ratio tau",
            ),
            "closing": Function(
                arguments=(theta, d1, d2, p_S, rho, tau),
                results=(closing,),
                unit="1",
                meaning="speed per travel at which the far edge closes on S at offset p_S, D alone "
                "pushing",
            ),
        },
    )


def _orientation_law(c_h: sp.Expr, s_h: sp.Expr, theta_rate: sp.Expr) -> Claim:
    """The angle law in closed form has the derived cosine and sine."""
    reach = sp.sqrt(h**2 + V**2)
    reached = sp.Symbol("T", real=True)
    cos_1, sin_1 = h / reach, V / reach
    sin_2, cos_2 = w / reach, sp.sqrt(h**2 + V**2 - w**2) / reach
    return Claim(
        key="orientation-law",
        title="Orientation during two-sided rotation",
        place="new; Section IX-C3 argues about the final orientation only",
        derived=r"While both tips touch the two long edges the orientation is kinematic: with "
        r"$(h, V)$ from the passive to the moving tip, $\theta = \mathrm{atan2}(V, h) + "
        r"\sin^{-1}(d_w/\sqrt{h^2 + V^2})$ and $d\theta/d\xi = \sin\theta/T$, $T^2 = h^2 + V^2 - "
        r"d_w^2$. Friction, film and slide do not enter.",
        steps=(
            r"Both contacts hold: $(h, V) = T a + d_w n$ with $a = (\cos\theta, \sin\theta)$, "
            r"$n = (\sin\theta, -\cos\theta)$.",
            r"Differentiating with $dh/d\xi = -1$ gives $d\theta/d\xi = \sin\theta/T$ and "
            r"$dT/d\xi = -h/T$.",
        ),
        hypotheses=(
            "both tips stay on their edges",
            r"$d_v > d_w$; the moving tip is then ahead along the edge, $T > 0$",
        ),
        checks=(
            for_all(
                r"$d_v > d_w$ means $T > 0$",
                [sp.sin(theta) > 0, sp.Eq(V, reached * sp.sin(theta) - w * sp.cos(theta)), w < V],
                reached > 0,
            ),
            identity("cosine of the law", cos_1 * cos_2 - sin_1 * sin_2, c_h),
            identity("sine of the law", sin_1 * cos_2 + cos_1 * sin_2, s_h),
            identity(
                r"$d\theta/d\xi = \sin\theta/T$",
                -sp.diff(sp.atan2(V, h) + sp.asin(w / reach), h),
                theta_rate.subs(sp.Symbol("s", real=True), s_h).subs(
                    T, sp.sqrt(h**2 + V**2 - w**2)
                ),
            ),
        ),
    )
