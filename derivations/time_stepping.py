"""The time-stepping scheme of eq. (2), measured on the closed-form motion of one sticking contact.

While one contact sticks, ``phi = theta - delta`` with ``delta = atan2(d1, d2)`` obeys ``d phi/d xi =
L sin(phi)``, ``L = R/F``, ``R^2 = d1^2 + d2^2``, where ``xi`` is the travel of the tip. The solution
is ``tan(phi/2) = k0 exp(L xi)``; every error below is measured against it.
"""

from __future__ import annotations

import sympy as sp

from derivations._claim import Claim
from derivations._derivation import Derivation
from derivations._statement import (
    Finding,
    combined,
    for_all,
    identity,
    there_is,
)
from derivations._tex import tex
from derivations.invariances import math
from derivations.mechanics import a, d1, d2, n, rho, theta, v_p, velocity_at
from derivations.one_point_sticking import F, solve_sticking

L, k0, h, R = sp.symbols("L k_0 h R", positive=True)
xi, phi = sp.symbols("xi phi", real=True)
SOLUTION = 2 * sp.atan(k0 * sp.exp(L * xi))
"""phi after the travel xi, in closed form."""
FRAME_UM = sp.Rational(140, 30)
"""Travel between two camera frames at the fastest printed speed: 140 µm/s at 30 Hz."""
EXAMPLE = {d1: sp.Rational(837, 2), d2: sp.Integer(350), rho: sp.Integer(376_900)}


def derive() -> Derivation:
    """Consistency and error of the scheme."""
    return Derivation(
        name="time_stepping",
        summary="The time-stepping scheme of eq. (2).",
        claims=(_kinematic_matrix(), _error_of_a_step(), _error_of_a_push(), _contact_drift()),
    )


def _rotation(by: sp.Expr) -> sp.Matrix:
    return sp.Matrix([[sp.cos(by), -sp.sin(by)], [sp.sin(by), sp.cos(by)]])


def _rates_are_the_twist() -> Finding:
    """World velocity of a point of the part: from the pose, and from the twist."""
    t = sp.Symbol("t", real=True)
    pose = [sp.Function(name)(t) for name in ("x", "y", "q")]
    twist = sp.Matrix(sp.symbols("v_x v_y omega", real=True))
    body = sp.Matrix(sp.symbols("b_x b_y", real=True))
    moved = sp.diff(sp.Matrix(pose[:2]) + _rotation(pose[2]) * body, t)
    rates = {sp.diff(entry, t): v for entry, v in zip(pose, twist, strict=True)}
    return identity(
        r"$\dot q$ taken as the world twist gives every point of the part its velocity",
        list(moved.subs(rates).subs(pose[2], theta)),
        list(velocity_at(twist, _rotation(theta) * body)),
    )


def _kinematic_matrix() -> Claim:
    """G(q) of a planar part."""
    v_x, v_y, omega = sp.symbols("v_x v_y omega", real=True)
    G = sp.diag(_rotation(theta), 1)
    lengths = G.T * G - sp.eye(3)
    body = [*(_rotation(theta).T * sp.Matrix([v_x, v_y])), omega]
    return Claim(
        key="equation-2",
        title="Eq. (2): the kinematic matrix",
        place="eq. (2), Section V-A",
        printed=r"$q^{l+1} - q^l = h G(q) \nu^{l+1}$",
        derived=r"With $q = (x, y, \theta)$ of the part's centre and $\nu = (v_x, v_y, \omega)$ in "
        r"world axes $G$ is the identity, at every pose. In the part's own axes $G = "
        r"\mathrm{diag}(R(\theta), 1)$, a rotation. It is never singular, so the scheme has no "
        "preferred pose.",
        steps=(
            r"A point $b$ of the part is at $(x, y) + R(\theta) b$. Its velocity is that of the "
            r"twist $(\dot x, \dot y, \dot\theta)$ about the centre: $\dot q = \nu$.",
        ),
        of_print=(
            _rates_are_the_twist(),
            identity(
                r"the world twist from the twist in the part's axes: $G = \mathrm{diag}(R, 1)$",
                list(G * sp.Matrix(body)),
                [v_x, v_y, omega],
            ),
        ),
        sharper=(identity(r"$G^T G = 1$", list(lengths), [sp.Integer(0)] * 9),),
    )


def _reduced_motion() -> tuple[Finding, ...]:
    """From the balance to ``d phi/d xi = L sin(phi)``, and its solution."""
    rate = -solve_sticking().twist[2] / v_p
    tangent = k0 * sp.exp(L * xi)
    sine = 2 * tangent / (1 + tangent**2)  # of twice the arc tangent
    return (
        identity(
            r"from the balance: $d\theta/d\xi = (d_2 \sin\theta - d_1 \cos\theta)/F$",
            [rate],
            [(d2 * sp.sin(theta) - d1 * sp.cos(theta)) / F],
        ),
        identity(
            r"$R \sin(\theta - \delta) = d_2 \sin\theta - d_1 \cos\theta$ with $R\cos\delta = d_2$, "
            r"$R\sin\delta = d_1$",
            [sp.sin(theta) * d2 - sp.cos(theta) * d1],
            [
                R
                * sp.expand_trig(sp.sin(theta - phi)).subs(
                    {sp.cos(phi): d2 / R, sp.sin(phi): d1 / R}
                )
            ],
        ),
        identity(
            r"$\tan(\phi/2) = k_0 e^{L\xi}$ solves $d\phi/d\xi = L \sin\phi$",
            sp.Derivative(SOLUTION, xi),
            L * sine,
        ),
    )


def taylor() -> tuple[sp.Expr, sp.Expr]:
    """First and second coefficient in xi of the closed form, in terms of k0."""
    first = sp.diff(SOLUTION, xi).subs(xi, 0)
    second = sp.diff(SOLUTION, xi, 2).subs(xi, 0) / 2
    return sp.factor(first), sp.factor(sp.simplify(second))


def _by_half_tangent(expression: sp.Expr) -> sp.Expr:
    """Cosine and sine of phi in terms of k0 = tan(phi/2)."""
    circle = {sp.cos(phi): (1 - k0**2) / (1 + k0**2), sp.sin(phi): 2 * k0 / (1 + k0**2)}
    return expression.subs(circle)


def _error_of_a_step() -> Claim:
    """Local error on the closed form."""
    first, second = taylor()
    exact = L**2 * sp.sin(phi) * sp.cos(phi) / 2
    ended = phi + h * L * sp.sin(phi) + 2 * exact * h**2
    late = ended - phi - h * L * sp.sin(ended)  # a step whose rate is taken at its end
    largest = sp.Rational(1, 4)
    s = sp.sin(phi)
    return Claim(
        key="time-step-error",
        title="Error of one time step",
        place="new; eq. (2), and the “inaccuracies of the time-stepping model” of Section VII",
        derived=r"A step over the travel $h = |v_p| \Delta t$ with the rate taken at its start turns "
        rf"the part by $hL\sin\phi$; the exact turn is $hL\sin\phi + h^2\,{math(exact)} + O(h^3)$, "
        r"$\phi = \theta - \delta$, $L = R/F$. The scheme is consistent and of first order, not of "
        rf"second unless $\sin 2\phi = 0$. With the rate taken at the end the error is the same with "
        r"the opposite sign. One step errs by at most $L^2 h^2/4$.",
        steps=(
            r"Balance and kinematics give $d\phi/d\xi = L\sin\phi$ with the solution "
            r"$\tan(\phi/2) = k_0 e^{L\xi}$.",
            rf"Taylor coefficients of the solution at $\xi = 0$: {tex(first)} and {tex(second)}.",
            r"By Taylor's theorem the error is $\frac{h^2}{2} L^2 \sin\phi\cos\phi$ at some point of "
            r"the step, and $|\sin\phi\cos\phi| \le 1/2$.",
            "Only the travel of a step matters, not its duration: the path does not depend on speed.",
        ),
        hypotheses=("film support, one contact that sticks; each step's LCP solved exactly",),
        checks=(
            *_reduced_motion(),
            identity(
                "the first coefficient is that of the scheme",
                sp.Subs(sp.Derivative(SOLUTION, xi), xi, 0),
                _by_half_tangent(L * s),
            ),
            identity(
                rf"the second coefficient is {tex(exact)}, that of the scheme is 0",
                second,
                _by_half_tangent(exact),
            ),
            there_is(
                r"it is not 0 at $\tan(\phi/2) = 1/2$",
                [sp.Ne(second, 0)],
                {k0: sp.Rational(1, 2), L: sp.Rational(1, 1236)},
            ),
            identity(
                "rate taken at the end: the same first coefficient and twice the exact second one solve "
                "the step to second order",
                [sp.Subs(sp.Derivative(late, (h, order)), h, 0) for order in (0, 1, 2)],
                sp.zeros(3, 1),
            ),
            for_all(
                r"$|\sin\phi\cos\phi| \le 1/2$",
                [],
                sp.And(exact <= largest * L**2, exact >= -largest * L**2),
            ),
        ),
    )


def push_error(travel: sp.Expr, step: sp.Expr, at: dict[sp.Symbol, sp.Expr]) -> float:
    """Bound on the error of the orientation after a push, in degrees."""
    rate = (sp.sqrt(d1**2 + d2**2) / F).subs(at)
    return float(sp.deg(step * rate / 4 * (sp.exp(rate * travel) - 1)))


def _error_of_a_push() -> Claim:
    """Global error."""
    steps = sp.Symbol("m", positive=True)
    q = 1 + h * L
    bound = h * L / 4 * (q**steps - 1)
    shown = push_error(sp.Integer(600), FRAME_UM, EXAMPLE)
    coarse = 1 / push_error(sp.Integer(600), sp.Integer(1), EXAMPLE)
    return Claim(
        key="time-stepping-error",
        title="Error of a whole push by time stepping",
        place="new; eq. (2), and the “inaccuracies of the time-stepping model” of Section VII",
        derived=r"After the travel $\xi$ the orientation is off by at most $\frac{hL}{4}(e^{L\xi} - "
        rf"1)$. One step per camera frame at 140 µm/s ($h = {float(FRAME_UM):.2f}$ µm), 600 µm of "
        rf"push, $d_2 = 350$ µm: {shown:.3f}°. Steps of {coarse:.0f} µm would be needed for 1°; the "
        "closed form has no such error at all.",
        steps=(
            r"Errors of two successive steps: $E_{m+1} \le (1 + hL) E_m + L^2h^2/4$, because "
            r"$|L\sin\phi_1 - L\sin\phi_2| \le L|\phi_1 - \phi_2|$.",
            rf"Solved: $E_m \le {math(bound)}$, and $(1 + hL)^m \le e^{{L\xi}}$ with $\xi = mh$.",
        ),
        hypotheses=("film support, one contact that sticks throughout",),
        checks=(
            identity(
                "the bound satisfies the recursion with equality",
                sp.Subs(bound, steps, steps + 1),
                q * bound + L**2 * h**2 / 4,
            ),
            identity("and starts from 0", sp.Subs(bound, steps, 0), sp.Integer(0)),
        ),
    )


def drift(turn: sp.Expr) -> sp.MatrixExpr:
    """How far a step moves the touched point of the part away from the tip, over R: along r, and across."""
    r, across = sp.Matrix([1, 0]), sp.Matrix([0, 1])
    # tip and centre move by the linear step
    return combined((1, _rotation(turn) * r), (-1, r), (-turn, across))


def _gap(turn: sp.Expr) -> sp.Expr:
    """Distance of the tip from the edge's line after the step."""
    frame = {theta: 0}
    arm = (d2 * a + d1 * n).subs(frame)
    tip = arm + turn * sp.Matrix([-arm[1], arm[0]])  # relative to the moved centre
    return (_rotation(turn) * n.subs(frame)).dot(tip) - d1


def _contact_drift() -> Claim:
    """The touched point leaves the tip."""
    alpha = sp.Symbol("alpha", real=True)
    leading = sp.series(_gap(alpha), alpha, 0, 3).removeO()
    c, s = sp.cos(alpha), sp.sin(alpha)
    rate = (sp.sqrt(d1**2 + d2**2) / F).subs(EXAMPLE)
    turn = FRAME_UM * rate
    opened = float(_gap(alpha).subs(EXAMPLE).subs(alpha, turn) * 1000)
    return Claim(
        key="time-stepping-drift",
        title="Drift of the contact in a time step",
        place="new; eq. (2)",
        derived=r"A step that turns the part by $\alpha$ moves the touched point by $R\,(\cos\alpha - "
        r"1)$ towards the centre and $R\,(\sin\alpha - \alpha)$ across: it no longer lies at the tip. "
        rf"Between tip and edge a gap of {tex(leading)} $+\ O(\alpha^3)$ opens: the contact is lost "
        "unless the next step's gap condition closes it; the part is never penetrated at this "
        rf"order. Example (4.67 µm of travel, $d_2 = 350$ µm): at most {opened:.1f} nm.",
        steps=(
            r"The centre and the tip move by the linear step, the touched point by the rotation: the "
            r"difference is $R(\alpha) r - r - \alpha\, e_z \times r$.",
            r"The gap is the distance of the tip from the turned edge: $d_1(\cos\alpha + \alpha"
            r"\sin\alpha - 1) + d_2(\sin\alpha - \alpha\cos\alpha)$.",
        ),
        hypotheses=("film support, one contact that sticks; a step that only uses velocities",),
        checks=(
            identity("towards the centre, and across", drift(alpha), [c - 1, s - alpha]),
            identity(
                "square of the drift over $R^2$",
                (c - 1) ** 2 + (s - alpha) ** 2,
                2 - 2 * c - 2 * alpha * s + alpha**2,
            ),
            identity(
                "gap between tip and edge",
                _gap(alpha),
                d1 * (c + alpha * s - 1) + d2 * (s - alpha * c),
            ),
            identity(
                "its first derivatives at 0: the leading term opens",
                [
                    sp.Subs(sp.Derivative(_gap(alpha), (alpha, order)), alpha, 0)
                    for order in (0, 1, 2)
                ],
                [0, 0, d1],
            ),
        ),
    )
