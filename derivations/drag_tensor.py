"""A point tip that sticks, with any drag that is fixed in the part.

The film's drag is a symmetric positive definite matrix ``D`` in the frame (a, n, turn) of the pushed
edge, about the reference point: it need not be even, and its centre need not be the reference point.
With the contact at ``d2 a + d1 n`` a turn about the contact moves the reference point by
``nu = (-d1, d2, 1)``; the balance of moments about the contact is ``nu . D twist = 0``.
"""

from __future__ import annotations

import sympy as sp

from derivations._circle import tidy
from derivations._claim import Claim
from derivations._derivation import Derivation, Function
from derivations._statement import Finding, for_all, identity
from derivations.mechanics import a, cross, d1, d2, mu, n, rho, theta
from derivations.one_point_sticking import A, B, C, F

c, s = sp.cos(theta), sp.sin(theta)
D_aa, D_nn, D_tt, D_an, D_at, D_nt = sp.symbols("D_aa D_nn D_tt D_an D_at D_nt", real=True)
DRAG = sp.Matrix([[D_aa, D_an, D_at], [D_an, D_nn, D_nt], [D_at, D_nt, D_tt]])
NU = sp.Matrix([-d1, d2, 1])
EVEN = {D_aa: 1, D_nn: 1, D_tt: rho, D_an: 0, D_at: 0, D_nt: 0}
"""The even film, over e_x."""

F_HAT = sp.expand((NU.T * DRAG * NU)[0])
P_HAT, Q_HAT = d2 * D_nn - d1 * D_an + D_nt, d1 * D_aa - d2 * D_an - D_at
A_HAT = F_HAT * D_an + P_HAT * Q_HAT
B_HAT = F_HAT * D_nn - P_HAT**2
C_HAT = F_HAT * D_aa - Q_HAT**2

stretch, shear, bend = sp.symbols("stretch shear bend", real=True)
CENTRED = {D_aa: 1 + stretch, D_nn: 1 - stretch, D_tt: rho, D_an: shear, D_at: 0, D_nt: 0}
"""Any drag about its own centre, over the mean of the two principal drags of a translation."""
FLAT = 1 - stretch**2 - shear**2
"""Determinant of the drag of a translation."""
ALONG, INWARD = c + bend * s, s - bend * c
"""The tip's velocity over its progress along the push, on -a and -n; ``bend`` is the tangent of the
angle by which the path is turned counter-clockwise from the push at this instant."""
ROD = d1**2 * (1 + stretch) - 2 * d1 * d2 * shear + d2**2 * (1 - stretch) + rho
P_CENTRED, Q_CENTRED = d2 * (1 - stretch) - d1 * shear, d1 * (1 + stretch) - d2 * shear
A_CENTRED = rho * shear + FLAT * d1 * d2
B_CENTRED = rho * (1 - stretch) + FLAT * d1**2
C_CENTRED = rho * (1 + stretch) + FLAT * d2**2
"""The hats of `CENTRED`, ``d1`` and ``d2`` from the centre of drag; without differences of products,
so that intervals stay narrow."""
LEVER = P_CENTRED * INWARD - Q_CENTRED * ALONG
slide = sp.Symbol("slide", real=True)
"""How fast the part slides along a over the tip, per progress of the tip."""
start = sp.Symbol("theta_start", real=True)
creep = sp.Symbol("creep", positive=True)
SLIPPED = creep * (sp.cos(start) ** 3 - c**3 + (sp.cos(start) - c) / 256)
"""How far a contact may have slipped since the touch. What makes it slip is that the edge leans: the
slip per turn vanishes some way before the edge is upright, and grows from there about in proportion. The
small second term is for contacts far from the middle, which slip a little on an upright edge too."""
PRESSING = A_CENTRED * ALONG + B_CENTRED * INWARD
TANGENTIAL = -(C_CENTRED * ALONG + A_CENTRED * INWARD)
PAIR_ALONG = -((1 + stretch) * ALONG + shear * INWARD)
PAIR_PRESSING = shear * ALONG + (1 - stretch) * INWARD
"""Force of a pair of tips on the part along a and along -n, per progress, over the mean drag."""


def solve_sticking(along: sp.Expr = c, inward: sp.Expr = s) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Turn, pressing force and force along the edge, from the balance alone: times F_hat, per travel.

    The tip moves by ``along`` on -a and by ``inward`` on -n.
    """
    omega, force_a, force_n = sp.symbols("omega f_a f_n", real=True)
    # in the frame (a, n) a turn omega moves the contact by omega (d1, -d2)
    twist = sp.Matrix([-along - omega * d1, -inward + omega * d2, omega])
    push = sp.Matrix([force_a, force_n, force_a * d1 - force_n * d2])
    (solution,) = sp.solve(list(DRAG * twist - push), (omega, force_a, force_n), dict=True)
    turn, pressing, along = solution[omega], -solution[force_n], solution[force_a]
    return tidy(turn * F_HAT), tidy(pressing * F_HAT), tidy(along * F_HAT)


def derive() -> Derivation:
    """Derive the rate of the turn and the forces, and what keeps its form."""
    return Derivation(
        name="drag_tensor",
        summary="One-point sticking on any drag fixed in the part.",
        claims=(
            _sticking(),
            _motion(),
            _centred(),
            _unique(),
            _slipping(),
            _any_way(),
            _back(),
            _pair(),
        ),
        functions=_functions(),
    )


def _functions() -> dict[str, Function]:
    gap, side = sp.symbols("gap side", real=True)
    tensor = (rho, stretch, shear)
    upper = d2 * PAIR_PRESSING + d1 * PAIR_ALONG
    away = "theta: of the edge less that of the push; d1, d2 from the centre of drag"
    return {
        "travel_rate": Function(
            arguments=(theta, d1, d2, *tensor, bend),
            results=(ROD / LEVER,),
            unit="m",
            meaning=f"m: travel of the tip per radian of the turn while it sticks; {away}",
        ),
        "normal_force": Function(
            arguments=(theta, d1, d2, *tensor, bend),
            results=(PRESSING,),
            unit="m^2",
            meaning=f"pressing force, m^2: the tip pushes where it is positive; {away}",
        ),
        "friction_margin": Function(
            arguments=(theta, d1, d2, *tensor, bend, mu),
            results=(mu * PRESSING - TANGENTIAL, mu * PRESSING + TANGENTIAL),
            unit="m^2",
            meaning="mu times the pressing force -+ the force along the edge, same scale, m^2: both "
            "positive where the contact sticks",
        ),
        "turning": Function(
            arguments=(theta, d1, d2, stretch, shear, bend, side),
            results=(side * LEVER,),
            unit="m",
            meaning="m: positive where the part turns counter-clockwise (side = 1) or clockwise (-1)",
        ),
        "only_solution": Function(
            arguments=(d1, d2, *tensor, mu),
            results=(C_CENTRED + mu * A_CENTRED, C_CENTRED - mu * A_CENTRED),
            unit="m^2",
            meaning="m^2: both positive where a sticking solution excludes every slipping one",
        ),
        "slips_one_way": Function(
            arguments=(theta, d1, d2, *tensor, bend, mu, side),
            results=(
                INWARD * (C_CENTRED + mu * A_CENTRED),
                INWARD * (C_CENTRED - mu * A_CENTRED),
                mu * PRESSING - side * TANGENTIAL,
            ),
            unit="m^2",
            meaning="m^2: all positive where a contact has one motion, in which it presses and, unless it "
            "sticks, the part slides towards a (side = 1) or -a (-1) over the tip",
        ),
        "creeps_less": Function(
            arguments=(theta, d1, d2, *tensor, bend, mu, side, creep),
            results=(
                sp.diff(SLIPPED, theta) * FLAT * INWARD * (side * d2 - mu * d1) - _excess(mu, side),
            ),
            unit="m^2",
            meaning="m^2: positive where a contact that turns the part any way slips that way by less per "
            "turn than `slipped` grows, if at all",
        ),
        "slipped": Function(
            arguments=(theta, start, creep),
            results=(SLIPPED,),
            unit="m",
            meaning="m: how far along a a contact has slipped at most since the edge was at theta_start, "
            "both from the push",
        ),
        "turns_any_way": Function(
            arguments=(d1, d2, mu, side),
            results=(side * d2 - mu * d1,),
            unit="m",
            meaning="m: where positive, one contact alone turns the part counter-clockwise (side = 1) or "
            "clockwise (-1), whether it sticks or slips",
        ),
        "turns_back": Function(
            arguments=(theta, d1, d2, stretch, shear, bend, mu, side),
            results=(side * LEVER, side * d2 + mu * d1, Q_CENTRED),
            unit="m",
            meaning="m: where all are positive, one contact alone turns the part counter-clockwise "
            "(side = 1) or clockwise (-1), whether it sticks or slips",
        ),
        "pair_friction": Function(
            arguments=(theta, stretch, shear, bend, mu),
            results=(
                mu * PAIR_PRESSING - PAIR_ALONG,
                mu * PAIR_PRESSING + PAIR_ALONG,
                1 + stretch - mu * shear,
                1 + stretch + mu * shear,
            ),
            unit="1",
            meaning="the first two positive: two tips on one edge stick; the others: no motion slips",
        ),
        "pair_forces": Function(
            arguments=(theta, d1, d2, gap, stretch, shear, bend),
            results=(gap * PAIR_PRESSING - upper, upper),
            unit="m",
            meaning="pressing forces of the upper tip, at d2, and of the lower one, gap below it, times "
            "the gap, m: both must be positive",
        ),
    }


def _sticking() -> Claim:
    turn, pressing, along = solve_sticking()
    hats = (A_HAT, B_HAT, C_HAT, F_HAT)
    return Claim(
        key="drag-tensor-sticking",
        title="One-point sticking on any drag fixed in the part",
        place="new; the paper's film is even about the centre, $E = \\mathrm{diag}(e_x, e_x, e_\\theta)$",
        derived=r"Let the drag be any symmetric positive definite $D$ in the frame $(a, n, \theta)$ of the "
        r"pushed edge, and $\nu = (-d_1, d_2, 1)$, $\hat F = \nu^T D \nu$, $p = d_2 D_{nn} - d_1 D_{an} + "
        r"D_{n\theta}$, $q = d_1 D_{aa} - d_2 D_{an} - D_{a\theta}$. Eqs. (5) to (8) hold with $\hat A = "
        r"\hat F D_{an} + pq$, $\hat B = \hat F D_{nn} - p^2$, $\hat C = \hat F D_{aa} - q^2$ in the place "
        r"of $A$, $B$, $C$, and the turn per travel is $(p \sin\theta - q\cos\theta)/\hat F$.",
        steps=(
            r"The contact moves with the tip: the twist is $-(\cos\theta, \sin\theta, 0) + \omega\nu$.",
            r"The force acts at the contact, so that its moment about the contact vanishes: $\nu^T D\,"
            r"\mathrm{twist} = 0$ gives $\omega$, and $D\,\mathrm{twist}$ the force.",
        ),
        hypotheses=(
            "the drag is fixed in the part, linear in the twist, symmetric and positive definite",
            "the contact sticks",
        ),
        checks=(
            identity(r"turn per travel, times $\hat F$", turn, P_HAT * s - Q_HAT * c),
            identity(r"pressing force, times $\hat F$", pressing, A_HAT * c + B_HAT * s),
            identity(r"force along the edge, times $\hat F$", along, -(C_HAT * c + A_HAT * s)),
            identity(
                r"$\hat B\hat C - \hat A^2 = \hat F \det D$: positive, as $BC - A^2 = \rho F$",
                B_HAT * C_HAT - A_HAT**2,
                F_HAT * sp.Determinant(sp.ImmutableMatrix(DRAG)),
            ),
            identity(
                "the even film gives the paper's $A$, $B$, $C$, $F$",
                [sp.Subs(hat, tuple(EVEN), tuple(EVEN.values())) for hat in hats],
                [A, B, C, F],
            ),
        ),
    )


def _motion() -> Claim:
    """The half tangent still grows exponentially."""
    start, xi = sp.symbols("theta_0 xi", real=True)
    delta = sp.Symbol("delta", real=True)
    reach = sp.sqrt(P_HAT**2 + Q_HAT**2)
    grown = sp.tan((start - delta) / 2) * sp.exp(reach * xi / F_HAT)  # tan((theta - delta)/2)
    return Claim(
        key="drag-tensor-motion",
        title="Motion under one-point sticking on any drag fixed in the part",
        place="new; “motion in closed form” for any drag",
        derived=r"$\tan\frac{\theta - \hat\delta}{2} = \tan\frac{\theta_0 - \hat\delta}{2}\, e^{\hat R\xi/"
        r"\hat F}$ with $\hat R^2 = p^2 + q^2$, $\hat\delta = \mathrm{atan2}(q, p)$: the closed form of the "
        r"even film, with constants of the drag. With $\hat F > 0$ the part turns counter-clockwise exactly "
        r"where $p\sin\theta > q\cos\theta$.",
        hypotheses=("a point tip that sticks", "the drag is fixed in the part"),
        checks=(
            identity(
                r"rate: $\hat R \sin(\theta - \hat\delta)$ with $\cos\hat\delta = p/\hat R$, $\sin\hat\delta "
                r"= q/\hat R$",
                (reach * sp.expand_trig(sp.sin(theta - delta))).subs(
                    {sp.cos(delta): P_HAT / reach, sp.sin(delta): Q_HAT / reach}
                ),
                P_HAT * s - Q_HAT * c,
            ),
            identity(
                r"the law solves the equation, $\sin$ from the half tangent",
                sp.Derivative(2 * sp.atan(grown), xi),
                reach / F_HAT * 2 * grown / (1 + grown**2),
            ),
            identity(
                r"and starts at $\theta_0$",
                sp.Subs(grown, xi, 0),
                sp.tan(start / 2 - delta / 2),
            ),
            _definite(),
        ),
    )


def _definite() -> Finding:
    """F_hat > 0 from the leading minors, for a drag about its own centre in its own axes."""
    return for_all(
        r"$\hat F > 0$, from the minors of $D$",
        [
            D_aa > 0,
            D_aa * D_nn - D_an**2 > 0,
            sp.expand(DRAG.det()) > 0,
        ],
        F_HAT > 0,
    )


def _centred() -> Claim:
    """About the centre of drag, on a path that is not quite straight."""
    turn, pressing, along = solve_sticking(ALONG, INWARD)
    hats = (A_HAT, B_HAT, C_HAT, F_HAT)
    here = (tuple(CENTRED), tuple(CENTRED.values()))
    angle_ = sp.Symbol("epsilon", real=True)
    turned = sp.Matrix([[sp.cos(angle_), -sp.sin(angle_)], [sp.sin(angle_), sp.cos(angle_)]])
    push = turned * sp.Matrix([-1, 0]) / sp.cos(angle_)
    edge, out = sp.Matrix([c, s]), sp.Matrix([s, -c])
    return Claim(
        key="drag-tensor-bent-path",
        title="One-point sticking about the centre of drag, on a bent path",
        place="new; the paper's tip moves along a straight line",
        derived=r"Let $d_1$, $d_2$ be from the centre of drag and the drag of a translation have the "
        r"entries $1 \pm \gamma$ and the shear $\varsigma$ over its mean, $\Delta = 1 - \gamma^2 - "
        r"\varsigma^2$. Then $\hat A = \rho\varsigma + \Delta d_1 d_2$, $\hat B = \rho(1 - \gamma) + "
        r"\Delta d_1^2$, $\hat C = \rho(1 + \gamma) + \Delta d_2^2$. Where the path is turned from the "
        r"push by an angle of tangent $e$, all hold per progress along the push with $\cos\theta + e"
        r"\sin\theta$, $\sin\theta - e\cos\theta$ in the place of $\cos\theta$, $\sin\theta$.",
        steps=(
            r"The tip moves by $-(1, e)$ per progress: $-(\cos\theta + e\sin\theta)$ along $a$ and "
            r"$-(\sin\theta - e\cos\theta)$ along $n$; the balance is linear in both.",
        ),
        hypotheses=("the contact sticks", "as for any drag fixed in the part, at this instant"),
        checks=(
            identity(
                "the hats about the centre of drag",
                [sp.Subs(hat, *here) for hat in hats],
                [A_CENTRED, B_CENTRED, C_CENTRED, ROD],
            ),
            identity(
                "velocity of the tip per progress, path turned by epsilon",
                [push.dot(edge), push.dot(out)],
                [
                    sp.Subs(-ALONG, bend, sp.tan(angle_)),
                    sp.Subs(-INWARD, bend, sp.tan(angle_)),
                ],
            ),
            identity(r"turn, times $\hat F$", sp.Subs(turn, *here), LEVER),
            identity(r"pressing force, times $\hat F$", sp.Subs(pressing, *here), PRESSING),
            identity(r"force along the edge, times $\hat F$", sp.Subs(along, *here), TANGENTIAL),
            for_all(
                r"$\hat F > 0$ with $\Delta > 0$, $|\gamma| < 1$",
                [FLAT > 0, stretch < 1, stretch > -1],
                sp.expand(ROD) > 0,
            ),
        ),
    )


def _unique() -> Claim:
    """No slipping motion beside a sticking one."""
    slip, size = sp.Symbol("u", real=True), sp.Symbol("F", positive=True)
    inward, along = sp.symbols("v_n v_a", real=True)
    at_rest = {D_at: 0, D_nt: 0}
    moving = solve_sticking(
        along - slip, inward
    )  # the part's point moves by u along a over the tip
    held = solve_sticking(along, inward)
    normal, tangential = sp.symbols("N T", real=True)
    a_hat, c_hat = sp.symbols("A C", real=True)
    opposed = [
        slip > 0,
        sp.Eq(tangential + c_hat * slip / size, -mu * (normal - a_hat * slip / size)),
    ]
    return Claim(
        key="drag-tensor-unique",
        title="Sticking excludes slipping on any drag",
        place="new; “only solution” for any drag fixed in the part",
        derived=r"Slipping at a rate $u$ along the edge adds $\hat C u/\hat F$ to the force along it and "
        r"takes $\hat A u/\hat F$ off the pressing force. So where $\hat C \pm \mu\hat A > 0$ a contact "
        "that can stick cannot slip.",
        steps=(
            r"For $u > 0$ friction is $-\mu$ times the pressing force: $(\lambda_t + \mu\lambda_n)\hat F + "
            r"(\hat C - \mu\hat A) u = 0$, both terms positive. For $u < 0$ the same mirrored.",
        ),
        hypotheses=("one contact, Coulomb friction", "the sticking solution is inside its cone"),
        checks=(
            identity(
                "what slipping adds to both forces",
                [(moving[k] - held[k]).subs(at_rest) for k in (1, 2)],
                [-A_HAT.subs(at_rest) * slip, C_HAT.subs(at_rest) * slip],
            ),
            for_all(
                "no slip along the edge",
                [tangential + mu * normal > 0, c_hat - mu * a_hat > 0],
                sp.Not(sp.And(*opposed)),
            ),
        ),
    )


def _excess(ratio: sp.Expr, side: sp.Expr) -> sp.Expr:
    """What is missing at this ratio of friction for the contact not to slip towards side a."""
    return -(ratio * PRESSING + side * TANGENTIAL)


def _stiff(ratio: sp.Expr, side: sp.Expr) -> sp.Expr:
    return C_CENTRED - side * ratio * A_CENTRED


def _sliding(ratio: sp.Expr, side: sp.Expr) -> sp.Expr:
    """How fast the part slides towards side a while friction, at this ratio, holds it back."""
    return _excess(ratio, side) / _stiff(ratio, side)


def _slipping() -> Claim:
    """The motion of one contact that sticks or slips."""
    tau = sp.Symbol("tau", real=True)
    turn, pressing, along = solve_sticking(ALONG - slide, INWARD)
    here = (tuple(CENTRED), tuple(CENTRED.values()))
    at_ratio = {slide: _sliding(-tau, sp.Integer(1))}
    room = INWARD * FLAT * rho * ROD
    a_hat, c_hat, n_hat, t_hat, inward = sp.symbols("A C N T v_n", real=True)
    grows, other, excess = sp.symbols("m w X", real=True)
    return Claim(
        key="drag-tensor-slipping",
        title="One contact that sticks or slips, on any drag",
        place="new; Section IX-C takes contacts that stick",
        derived=r"While the part slides by $u$ along $a$ over the tip, per progress of the tip, the turn is "
        r"$(\ell + q u)/\hat F$ with $\ell$ that of a contact that sticks. With the ratio $\tau$ of the "
        r"force along the edge to the pressing one, $u$ grows with $\tau$. So if $\hat C \pm \mu\hat A > 0$ "
        r"and the tip comes from outside there is one motion, and the contact presses in it: it sticks, or "
        r"slips towards $+a$ with $\tau = -\mu$ where $u(-\mu) > 0$, or towards $-a$ with $\tau = \mu$ where "
        r"$u(\mu) < 0$. It slides the farther, per travel, the smaller $\mu$ is. Per turn it slips by $u' = "
        r"\hat F u/(\ell + q u) = X/(\Delta (\sin\theta - e\cos\theta)(d_2 - \mu d_1))$ with $X = -(\mu\hat "
        r"N + \hat T)$ of a contact that sticks. If $m'\Delta(\sin\theta - e\cos\theta)(d_2 - \mu d_1) > X$ "
        r"for $m = k(\cos^3\theta_0 - \cos^3\theta + \tfrac{\cos\theta_0 - \cos\theta}{256})$, wherever it has slipped by $m$, it never slips by more.",
        steps=(
            r"The tip moves by less along $-a$ than the part's point under it: $u$ is taken off "
            r"that velocity in the balance of a contact that sticks.",
            r"$u(\tau)$ is continuous and grows, so that exactly one of $u(-\mu) > 0$, $u(\mu) < 0$ and "
            r"$u(\tau) = 0$ for one $|\tau| \le \mu$ is the case.",
            r"$m$ grows along the turn. Where $X < 0$ the contact sticks; where $X \ge 0$, $d_2 - \mu d_1$ is "
            r"positive and it slips by less per turn than $m$ grows: the slip cannot come to pass $m$.",
        ),
        hypotheses=("one contact, Coulomb friction", "the drag at this instant, about its centre"),
        checks=(
            identity(
                r"turn, times $\hat F$",
                sp.Subs(turn, *here),
                LEVER + Q_CENTRED * slide,
            ),
            identity(
                r"force along the edge, times $\hat F$",
                sp.Subs(along, *here),
                TANGENTIAL + C_CENTRED * slide,
            ),
            identity(
                r"pressing force, times $\hat F$",
                sp.Subs(pressing, *here),
                PRESSING - A_CENTRED * slide,
            ),
            for_all(
                r"their ratio is $\tau$ at $u(\tau)$",
                [
                    sp.Eq(slide * (c_hat + tau * a_hat), tau * n_hat - t_hat),
                    sp.Ne(n_hat - a_hat * slide, 0),
                ],
                sp.Eq(t_hat + c_hat * slide, tau * (n_hat - a_hat * slide)),
            ),
            identity(
                r"pressing force at $u(\tau)$, times $\hat F$ and what $u$ is divided by",
                sp.Subs(pressing, *here).doit().subs(at_ratio) * (C_CENTRED + tau * A_CENTRED),
                room,
            ),
            identity(
                r"change of $u$ with $\tau$",
                sp.diff(at_ratio[slide], tau) * (C_CENTRED + tau * A_CENTRED) ** 2,
                room,
            ),
            for_all(
                r"$\hat C + \tau\hat A$ is positive for all $|\tau| \le \mu$, and the tip comes from outside",
                [
                    c_hat > 0,
                    inward * (c_hat + mu * a_hat) > 0,
                    inward * (c_hat - mu * a_hat) > 0,
                    tau <= mu,
                    tau >= -mu,
                ],
                sp.And(inward > 0, c_hat + tau * a_hat > 0),
            ),
            identity(
                r"turn of a contact that slips, times $\hat F$ and what its pressing force is divided by",
                LEVER * _stiff(mu, sp.Integer(1)) + Q_CENTRED * _excess(mu, sp.Integer(1)),
                ROD * FLAT * INWARD * (d2 - mu * d1),
            ),
            for_all(
                "slip per turn",
                [grows >= 0, excess >= 0, grows * other > excess],
                sp.And(other > 0, excess < grows * other),
            ),
            identity(
                "change of the bound along the turn",
                sp.Derivative(SLIPPED, theta),
                creep * s * (3 * c**2 + sp.Rational(1, 256)),
            ),
        ),
    )


def _any_way() -> Claim:
    """Which way a contact turns the part, sticking or slipping."""
    tau, normal = sp.symbols("tau N", real=True)
    moment = cross(d2 * a + d1 * n, normal * (tau * a - n))
    return Claim(
        key="drag-tensor-turns-any-way",
        title="Which way one contact turns the part, sticking or slipping",
        place="new; the sense of the turn in Section IX-C1 is that of a contact that sticks",
        derived=r"A single contact whose force along the edge is $\tau$ times the pressing force $N$ turns "
        r"the part by $N (d_2 + \tau d_1)/\rho$, whatever the drag of a translation. So it turns the part "
        r"counter-clockwise for every $|\tau| \le \mu$ if $d_2 > \mu d_1$ and clockwise if $-d_2 > \mu d_1$.",
        hypotheses=(
            "one contact",
            "the drag has no coupling of turn and translation about its centre",
        ),
        checks=(
            identity("moment about the centre of drag", moment, normal * (d2 + tau * d1)),
            for_all(
                "counter-clockwise",
                [normal > 0, tau <= mu, tau >= -mu, d2 - mu * d1 > 0],
                normal * (d2 + tau * d1) > 0,
            ),
            for_all(
                "clockwise",
                [normal > 0, tau <= mu, tau >= -mu, -d2 - mu * d1 > 0],
                normal * (d2 + tau * d1) < 0,
            ),
        ),
    )


def _back() -> Claim:
    """Which way a contact turns the part, sticking or slipping."""
    tau, normal, lever, q = sp.symbols("tau N l q", real=True)
    moment = cross(d2 * a + d1 * n, normal * (tau * a - n))
    return Claim(
        key="drag-tensor-turns-back",
        title="One contact that slips turns the part as one that sticks",
        place="new; the sense of the turn in Section IX-C1 is that of a contact that sticks",
        derived=r"If a contact that sticks turns the part counter-clockwise, $\ell > 0$, and $q > 0$, $d_2 + "
        r"\mu d_1 > 0$, then one that slips does so, too: towards $+a$ it turns the part even faster per "
        r"travel, and towards $-a$ its force has a moment of that sense. Clockwise the same with $-\ell$, "
        r"$-d_2$.",
        steps=(
            r"A single contact whose force along the edge is $\tau$ times the pressing force $N$ has the "
            r"moment $N (d_2 + \tau d_1)$ about the centre of drag, and the turn has its sign.",
            r"Slipping towards $+a$ at $u > 0$ the turn is $(\ell + q u)/\hat F$; towards $-a$, $\tau = \mu$.",
        ),
        hypotheses=(
            "one contact",
            "the drag has no coupling of turn and translation about its centre",
        ),
        checks=(
            identity("moment about the centre of drag", moment, normal * (d2 + tau * d1)),
            for_all(
                "counter-clockwise, towards $+a$ and $-a$",
                [lever > 0, q > 0, slide >= 0, normal > 0, d2 + mu * d1 > 0],
                sp.And(lever + q * slide > 0, normal * (d2 + mu * d1) > 0),
            ),
            for_all(
                "clockwise, towards $-a$ and $+a$",
                [-lever > 0, q > 0, slide <= 0, normal > 0, -d2 + mu * d1 > 0],
                sp.And(lever + q * slide < 0, normal * (d2 - mu * d1) < 0),
            ),
        ),
    )


def _pair() -> Claim:
    """Two tips on one edge: the part moves with the probe."""
    gap = sp.Symbol("gap", positive=True)
    first, second, force_a = sp.symbols("N_1 N_2 f_a", real=True)
    flat = sp.Matrix([[1 + stretch, shear], [shear, 1 - stretch]])
    drag = flat * sp.Matrix([-ALONG, -INWARD])  # of the translation, on a and n
    # moments about the centre of drag: a force (f_a, -N) at (d2, d1) in (a, n) turns by d2 N + d1 f_a
    moment = d2 * first + (d2 - gap) * second + d1 * force_a
    (solved,) = sp.solve(
        [force_a - drag[0], -(first + second) - drag[1], moment],
        (first, second, force_a),
        dict=True,
    )
    slip = sp.Symbol("u", positive=True)
    pressing, along = sp.symbols("N T", real=True)
    slipped = [
        sp.Eq(along + (1 + stretch) * slip, -mu * (pressing - shear * slip)),
    ]
    upper = d2 * PAIR_PRESSING + d1 * PAIR_ALONG
    return Claim(
        key="drag-tensor-pair",
        title="Two tips on one edge, on any drag",
        place="new; eq. (9) for any drag of a translation",
        derived=r"While the part moves with two tips on one edge, the forces are those of a drag $1 \pm "
        r"\gamma$, $\varsigma$ without a moment about its centre. Both tips stick if the force along the "
        r"edge is less than $\mu$ times the pressing one, $\mu$ the smaller coefficient, and no motion "
        r"along the edge is possible beside it if $1 + \gamma > \mu|\varsigma|$.",
        steps=(
            r"Slipping at a rate $u$ along the edge, without a turn, adds $(1 + \gamma) u$ to the force "
            r"along it and takes $\varsigma u$ off the pressing one.",
        ),
        hypotheses=("both tips stay on the edge",),
        checks=(
            identity(
                "pressing forces of both tips, times their gap",
                [solved[first] * gap, solved[second] * gap],
                [gap * PAIR_PRESSING - upper, upper],
            ),
            identity("force along the edge", solved[force_a], PAIR_ALONG),
            for_all(
                "no slip along the edge",
                [along + mu * pressing > 0, 1 + stretch - mu * shear > 0],
                sp.Not(sp.And(*slipped)),
            ),
        ),
    )
