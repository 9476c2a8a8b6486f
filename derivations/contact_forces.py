"""Bounds of contact forces: one tip that sticks, two on one edge, two on opposite edges.

Forces are over the film's drag ``e_x`` and the rate of travel. Of one tip that sticks nothing needs to
be known but the drag of a translation: a part that may turn is easier to move than one that may not.
"""

from __future__ import annotations

import sympy as sp

from derivations._claim import Claim
from derivations._derivation import Derivation, Function
from derivations._statement import as_written, for_all, identity
from derivations.drag_tensor import F_HAT, P_HAT, Q_HAT, D_aa, D_an, D_nn, solve_sticking
from derivations.mechanics import d1, mu, rho, theta
from derivations.two_sided_rotation import T, V, p_S, sigma, tau_D, tau_S, two_contact_balance, w

c, s = sp.cos(theta), sp.sin(theta)
stretch, shear = sp.symbols("stretch shear", real=True)
W, T_0 = sp.symbols("W T_0", positive=True)
"""Between the tips' centres across the edges; T where the contacts are level."""
most = sp.Symbol("m", positive=True)
"""Largest principal drag."""


def derive() -> Derivation:
    """Derive the bounds."""
    return Derivation(
        name="contact_forces",
        summary="Bounds of contact forces.",
        claims=(_one_tip(), _two_on_one_edge(), _two_sided()),
        functions={
            "carrying_force": Function(
                arguments=(stretch, shear),
                results=(1 + sp.sqrt(stretch**2 + shear**2),),
                unit="1",
                meaning="most that one sticking tip, or two on one edge together, press on a part, "
                "over e_x and the speed of the probe",
            ),
        },
    )


def _one_tip() -> Claim:
    """The force of a sticking tip is at most that of carrying the part without a turn."""
    _, pressing, along = solve_sticking()
    F = sp.Symbol("F", positive=True)
    P, Q, K_aa, K_an, K_nn = sp.symbols("p q K_aa K_an K_nn", real=True)
    across = (Q_HAT * c - P_HAT * s) / F_HAT
    left = ((most - 1 - stretch + Q**2 / F), (most - 1 + stretch + P**2 / F))
    both = -shear - P * Q / F
    return Claim(
        key="one-tip-force",
        title="The force of a tip that sticks",
        place="new; a cap on contact forces",
        derived=r"A tip that sticks presses with at most the largest principal drag of a translation: for "
        r"the drag $\left[\begin{smallmatrix} 1 + e_1 & e_2 \\ e_2 & 1 - e_1 \end{smallmatrix}\right]$ "
        r"over $e_x$ the force is at most $(1 + \sqrt{e_1^2 + e_2^2})\, e_x v$, whatever the drag of a "
        r"turn, the centre of the drag and the place of the contact.",
        steps=(
            r"The force is $K$ times the velocity of the tip with $K = D_{tt} - b b^T/\hat F$, $b = (q, "
            r"-p)$: the drag of a translation less what the turn gives way.",
            r"$K$ is positive definite ($\hat B\hat C - \hat A^2 = \hat F \det D$), and not more than $m = "
            r"1 + \sqrt{e_1^2 + e_2^2}$ in any direction; so $|K v| \le m |v|$.",
        ),
        hypotheses=(
            "the contact sticks",
            "the drag is linear in the twist, symmetric and positive definite",
        ),
        checks=(
            identity(
                r"force along $-a$ and $-n$: $K (\cos\theta, \sin\theta)$",
                [-along / F_HAT, pressing / F_HAT],
                [
                    D_aa * c + D_an * s - Q_HAT * across,
                    D_an * c + D_nn * s + P_HAT * across,
                ],
            ),
            for_all(
                r"$m - K$ has no negative direction",
                [sp.Eq((most - 1) ** 2, stretch**2 + shear**2), most >= 1],
                sp.And(left[0] >= 0, left[1] >= 0, left[0] * left[1] - both**2 >= 0),
            ),
            for_all(
                r"$|K v| \le m$ for $|v| = 1$, from $0 \le K \le m$",
                [
                    K_aa >= 0,
                    K_nn >= 0,
                    K_aa * K_nn >= K_an**2,
                    most >= K_aa,
                    most >= K_nn,
                    (most - K_aa) * (most - K_nn) >= K_an**2,
                ],
                (K_aa * c + K_an * s) ** 2 + (K_an * c + K_nn * s) ** 2 <= most**2,
            ),
        ),
    )


def _two_on_one_edge() -> Claim:
    N_1, N_2 = sp.symbols("N_1 N_2", positive=True)
    R_1, F_a = sp.symbols("R_1 F_a", real=True)
    return Claim(
        key="two-on-one-edge-force",
        title="The forces of two tips on one edge",
        place="new; a cap on contact forces",
        derived=r"Of two tips that carry a part along, each presses with at most $\sqrt{1 + \mu^2}\,(1 + "
        r"\sqrt{e_1^2 + e_2^2})\, e_x v$.",
        steps=(
            r"Together they press with the drag of the translation; both normal forces are positive, so "
            r"neither exceeds their sum, and friction adds at most $\mu$ times the normal force.",
        ),
        hypotheses=("both tips press on one edge and stick", "the part does not turn"),
        checks=(
            for_all(
                "force of one tip",
                [(N_1 + N_2) ** 2 + F_a**2 <= most**2, mu * N_1 >= R_1, mu * N_1 >= -R_1],
                (1 + mu**2) * most**2 >= N_1**2 + R_1**2,
            ),
        ),
    )


def _two_sided() -> Claim:
    """A bound that needs no more than the separation."""
    L_D, L_S, _ = (expression.subs(sigma, -T / 2 - p_S) for expression in two_contact_balance())
    arm = sp.Symbol("P", positive=True)  # |p_S|
    apart = sp.Symbol("q", positive=True)  # sqrt(V^2 - W^2)
    numerator, grip, bound = sp.symbols("Z G Z_m", positive=True)
    geometry = [s > 0, sp.Eq(V, T * s - W * c), w <= W]
    inside = [tau_D <= mu, tau_D >= -mu, tau_S <= mu, tau_S >= -mu]
    other = T + p_S  # p_D
    return Claim(
        key="two-sided-force",
        title="The forces between two round tips",
        place="new; a cap on contact forces",
        derived=r"While two tips turn the part between them, the normal force at either is at most $\frac{2}"
        r"{V + \sqrt{V^2 - W^2}}\,\frac{\max(\rho + p_S^2, \rho + p_S p_D) + \mu d_1 |p_S|}{T_* - \mu "
        r"d_w}\, e_x v$, and the whole force at most $\sqrt{1 + \mu^2}$ times that, with $T_*$ any lower "
        r"bound of $T$ above $\mu d_w$: $\sqrt{V^2 - W^2}$, or, until the contacts have passed each other, "
        r"the positive root of $(T_*^2 + W d_w)^2 = V^2(T_*^2 + d_w^2)$ if $W < 2 d_w$. "
        r"The forces differ by $L_D - L_S = -p_S \sin\theta/T$.",
        steps=(
            r"$L_D = \frac{\sin\theta}{T}\,\frac{\rho + p_S(p_S + d_1\tau_S)}{G}$, $L_S = \frac{\sin"
            r"\theta}{T}\,\frac{\rho + p_S(p_D + d_1\tau_D)}{G}$ with $G = T + d_1(\tau_D - \tau_S)$.",
            r"The factor $\sin\theta/T = \sin^2\theta/(V + W\cos\theta)$ is largest where $W\cos\theta = "
            r"\sqrt{V^2 - W^2} - V$.",
        ),
        hypotheses=(
            "even film, parallel edges",
            r"$V > W$, both tips press and stay on their edges",
            r"both friction coefficients are at most $\mu$",
        ),
        checks=(
            identity(
                r"$L_D - L_S$",
                as_written(lambda: L_D - L_S),
                -p_S * s / T,
            ),
            for_all(
                r"$\sin\theta/T \le 2/(V + \sqrt{V^2 - W^2})$",
                [*geometry, W < V, sp.Eq(apart**2, V**2 - W**2)],
                s * (V + apart) <= 2 * T,
            ),
            for_all(
                r"$T \ge \sqrt{V^2 - W^2}$",
                [*geometry, W < V, sp.Eq(apart**2, V**2 - W**2)],
                apart <= T,
            ),
            for_all(
                r"$T \ge T_*$ while $h_K = T\cos\theta + d_w\sin\theta \ge 0$ (half width 1)",
                [
                    *(relation.subs(d1, 1) for relation in geometry),
                    T * c + 2 * s >= 0,
                    W < 4,
                    sp.Eq((T_0**2 + 2 * W) ** 2, V**2 * (T_0**2 + 4)),
                ],
                T >= T_0,
            ),
            for_all(
                r"numerator of $L_D$",
                [*inside[2:], arm >= p_S, arm >= -p_S],
                rho + p_S * (p_S + d1 * tau_S) <= rho + p_S**2 + mu * d1 * arm,
            ),
            for_all(
                r"numerator of $L_S$",
                [*inside[:2], arm >= p_S, arm >= -p_S],
                rho + p_S * (other + d1 * tau_D) <= rho + p_S * other + mu * d1 * arm,
            ),
            for_all(
                r"the grip",
                [*inside, T >= T_0],
                T + d1 * (tau_D - tau_S) >= T_0 - mu * w,
            ),
            for_all(
                r"the quotient",
                [numerator <= bound, grip >= T_0 - mu * w, mu * w < T_0],
                numerator * (T_0 - mu * w) <= bound * grip,
            ),
        ),
    )
