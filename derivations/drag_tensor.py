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
from derivations._derivation import Derivation
from derivations._statement import Finding, for_all, identity
from derivations.mechanics import d1, d2, rho, theta
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


def solve_sticking() -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Turn, pressing force and force along the edge, from the balance alone: times F_hat, per travel."""
    omega, force_a, force_n = sp.symbols("omega f_a f_n", real=True)
    # in the frame (a, n): -e_x is -(c, s), and a turn omega moves the contact by omega (d1, -d2)
    twist = sp.Matrix([-c - omega * d1, -s + omega * d2, omega])
    push = sp.Matrix([force_a, force_n, force_a * d1 - force_n * d2])
    (solution,) = sp.solve(list(DRAG * twist - push), (omega, force_a, force_n), dict=True)
    turn, pressing, along = solution[omega], -solution[force_n], solution[force_a]
    return tidy(turn * F_HAT), tidy(pressing * F_HAT), tidy(along * F_HAT)


def derive() -> Derivation:
    """Derive the rate of the turn and the forces, and what keeps its form."""
    return Derivation(
        name="drag_tensor",
        summary="One-point sticking on any drag fixed in the part.",
        claims=(_sticking(), _motion()),
    )


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
