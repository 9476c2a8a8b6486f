"""Where the part ends: the box of Step 4, and the tilt that Step 2 may leave.

A pair of tips that pushes along -x brings the edge in line with itself, ``theta = pi/2 + beta``; the
centre then lies at the upper tip less ``d2 a + d1 n``. Before that the edge is tilted by ``psi``,
``theta = pi/2 - psi``, and the upper tip has to turn it back without slipping.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product

import sympy as sp
from sympy.logic.boolalg import Boolean

from derivations._claim import Claim
from derivations._derivation import Derivation
from derivations._statement import (
    DerivationError,
    Finding,
    angle,
    as_written,
    combined,
    crossed,
    for_all,
    identity,
    positive_by,
    there_is,
    together,
)
from derivations.mechanics import PAPER, a, beta, cross, d1, d2, mu, n, rho, theta
from derivations.sampling import LEAST_MU, admissible_range
from derivations.symmetries import (
    BETA,
    HALF_LENGTH,
    HALF_WIDTH,
    edge_contact,
    limits,
    on_circle,
    q_x,
    q_y,
    sticking_at,
)

p_x, p_y = sp.symbols("p_x p_y", real=True)
TIP = sp.Matrix([p_x, p_y])
psi = sp.Symbol("psi", real=True)
d3, eps_p, c_p, r_max = sp.symbols("d3 eps_p c_p r_max", positive=True)
length, width, V, T = sp.symbols("l w V T", positive=True)
h = sp.Symbol("h", real=True)
TILTED = sp.Matrix([sp.sin(psi), sp.cos(psi)])
"""Direction of an edge tilted by psi."""
MAGNITUDE = sp.Symbol("beta_max", real=True)
SHORT_EDGE = {d1: HALF_LENGTH, rho: PAPER[rho]}
PAPER_TOLERANCE = {eps_p: sp.Integer(76), c_p: sp.Integer(5)}
IN_UM = "lengths in µm"


def centre(offset: sp.Expr = d2) -> sp.Matrix:
    """Of the part, when both tips touch: from the upper tip."""
    x, y = BETA
    return TIP - edge_contact(sp.Matrix([-y, x]), d1, offset).arm()


def _written(edge: sp.Matrix, offset: sp.Expr) -> sp.MatrixExpr:
    """The same, as it is written: from the upper tip back along an edge and its normal."""
    along, out = edge_contact(edge).directions()
    return combined((1, TIP), (-offset, along), (-d1, out))


def derive() -> Derivation:
    """Derive the final pose and the admissible tilt, and compare."""
    lo, hi = limits()
    return Derivation(
        name="final_pose",
        summary="Final pose of the part and the tilt before it (paper, Steps 2 and 4).",
        claims=(
            _box(),
            _two_angles(),
            _orientation(),
            _tolerance(),
            _errors(),
            _largest_tilt(lo, hi),
            _tilt_and_push(),
            _step_2(lo),
        ),
    )


def _reading(sign_x: int, sign_y: int, swapped: bool, sense: int) -> sp.Matrix:
    """Centre by one reading of the print: signs, quotient under atan in gamma, sense of beta."""
    x, y = BETA[0], sense * BETA[1]
    r_cos, r_sin = (d2, d1) if swapped else (d1, d2)  # r cos(gamma), r sin(gamma)
    return TIP + sp.Matrix([sign_x * (r_cos * x - r_sin * y), sign_y * (r_sin * x + r_cos * y)])


def _box() -> Claim:
    """Centre of the final box."""
    found = centre()
    readings = {key: _reading(*key) for key in product((1, -1), (1, -1), (False, True), (1, -1))}
    fits = {
        key: all(on_circle(sp.expand(part), *BETA) == 0 for part in reading - found)
        for key, reading in readings.items()
    }
    right = [key for key, fit in fits.items() if fit]
    point = _at_beta({**SHORT_EDGE, d2: sp.Integer(200), p_x: 0, p_y: 0})
    with_plus = [_equal(r, found) for key, r in readings.items() if key[0] == 1]
    others = [_equal(r, found) for key, r in readings.items() if key not in right]
    if len(right) != 1:
        raise DerivationError(f"readings of Step 4 that give the centre: {right}")
    signs = ["−" if sign < 0 else "+" for sign in right[0][:2]]
    quotient = "d_1/d_2" if right[0][2] else "d_2/d_1"
    return Claim(
        key="step-4-centre",
        title="Centre of the final box",
        place="Step 4, Section IX-E",
        printed=r"$X \in [p^x + r\cos(\gamma + \beta) \ldots c_p^u,\ p^x + r\cos(\gamma + \beta) + "
        r"c_p^u]$, $Y \in [p^y \ldots r\sin(\gamma + \beta) \ldots c_p^u,\ p^y \ldots r\sin(\gamma + "
        r"\beta) + c_p^u]$ (dots: signs lost in the scan)",
        derived=rf"$X = p^x {signs[0]} r\cos(\gamma + \beta)$, $Y = p^y {signs[1]} r\sin(\gamma + "
        rf"\beta)$ with $\gamma = \tan^{{-1}}({quotient})$, $r = \sqrt{{d_1^2 + d_2^2}}$ and $\beta$ "
        rf"positive where the upper tip is ahead: the only one of {len(readings)} readings (two signs, "
        r"two quotients, two senses of $\beta$) that is an identity. The legible sign of the $X$ term is "
        "wrong: a part pushed along $-x$ lies to the left of the tip. It would be right, with the same "
        "$Y$, for a push along $+x$ from the left.",
        steps=(
            r"With both tips in contact the edge lies along them, $\theta = \pi/2 + \beta$, $a = "
            r"(-\sin\beta, \cos\beta)$, $n = (\cos\beta, \sin\beta)$.",
            r"Centre $= p - (d_2 a + d_1 n)$, hence $X = p^x - d_1 \cos\beta + d_2 \sin\beta$, $Y = "
            r"p^y - d_1 \sin\beta - d_2 \cos\beta$.",
        ),
        of_print=(
            for_all(
                f"one of the {len(with_plus)} readings with the printed $+$ in $X$ is the centre "
                f"({IN_UM})",
                [d1 > 0, d2 > 0],
                sp.Or(*with_plus),
                at=point,
            ),
        ),
        checks=(
            identity("the reading above is the centre", readings[right[0]], _written(sp.Matrix([-BETA[1], BETA[0]]), d2)),
            # the left edge runs downwards, so that the upper tip has the offset -d2 along it
            identity("push along $+x$: the reading with $+$ in $X$, $-$ in $Y$ is the centre",
                     readings[1, -1, *right[0][2:]],
                     _written(sp.Matrix([-BETA[1], -BETA[0]]), -d2)),
            there_is(
                f"the other {len(others)} readings are not",
                [sp.Not(equal) for equal in others],
                at=point,
            ),
            identity("the edge of direction $\\pi/2 + \\beta$ has the normal $(\\cos\\beta, \\sin\\beta)$",
                     [sp.Subs(entry, theta, sp.pi / 2 + beta) for entry in n],
                     [sp.cos(beta), sp.sin(beta)]),
        ),
    )  # fmt: skip


def _equal(left: sp.Matrix, right: sp.Matrix) -> Boolean:
    return sp.And(*(sp.Eq(p, q) for p, q in zip(left, right, strict=True)))


def _at_beta(at: Mapping[sp.Symbol, sp.Expr]) -> dict[sp.Expr, sp.Expr]:
    """A point with a misalignment of about 0.25 degrees."""
    values = angle(sp.Rational(1, 458), beta)
    return {**at, BETA[0]: values[sp.cos(beta)], BETA[1]: values[sp.sin(beta)]}


def _two_angles() -> Claim:
    """The angle of the box and the angle of the conditions."""
    tangent, square = sp.symbols("tan_gamma r_squared", positive=True)
    box = [sp.Eq(tangent * d1, d2), sp.Eq(square, d1**2 + d2**2)]
    largest = [sp.Eq(tangent * d3, d1), sp.Eq(square, d1**2 + d3**2)]
    return Claim(
        key="step-4-gamma",
        title=r"Two angles called $\gamma$",
        place="Step 4, Section IX-E",
        printed=r"box with $r$, $\gamma$ of the upper tip; conditions with $\gamma_{max} = "
        r"\tan^{-1}(d_1/d_3)$, $r_{max} = \sqrt{d_1^2 + d_3^2}$",
        derived=r"The box needs $\gamma = \tan^{-1}(d_2/d_1)$. Its largest value, at the largest "
        r"offset $d_3$, is $\tan^{-1}(d_3/d_1)$, the complement of the printed one. With the printed "
        r"quotient $\gamma$ falls while $r$ grows, so that $\gamma_{max}$ and $r_{max}$ would belong "
        "to different offsets.",
        steps=(
            r"At $d_2 = d_3$ the box gives $\tan\gamma = d_3/d_1$, the conditions $d_1/d_3$: equal "
            "only for $d_1 = d_3$.",
        ),
        consistent=(
            together(
                r"$r$, $\gamma$ of the box take the printed largest values at one offset, on an edge "
                r"with $d_1 \ne d_3$",
                *box, *largest, sp.Ne(d1, d3), d2 > 0,
            ),
            together(
                r"$\tan^{-1}(d_1/d_2) \le \tan^{-1}(d_1/d_3)$ at an offset $0 < d_2 < d_3$",
                d2 > 0, d2 < d3, d1 / d2 <= d1 / d3,
            ),
        ),
    )  # fmt: skip


def _orientation() -> Claim:
    """Final orientation of the part from the direction of the pushed short edge."""
    x, y = BETA
    edge = sp.Matrix([-y, x])
    c, s = sp.symbols("c s", real=True)
    at_tail = a.subs(theta, theta - sp.pi / 2).subs({sp.cos(theta): c, sp.sin(theta): s})
    (solved,) = sp.solve(list(at_tail - edge), (c, s), dict=True)
    axis = sp.Matrix([solved[c], solved[s]])
    printed = sp.Matrix(BETA)
    return Claim(
        key="step-4-orientation",
        title="Final orientation",
        place="Step 4, Section IX-E",
        printed=r"$\theta = \beta$",
        derived=r"$\theta = \pi + \beta$ for the part that was turned counter-clockwise to $\pi$ and "
        r"is pushed on the short edge that then faces $+x$; $\theta = \beta$ for one turned clockwise "
        r"to $0$. The goal is $\pi$; the two poses of a rectangle look the same.",
        steps=(
            r"The short edge at the end $-a$ of the long axis has the direction $\theta - \pi/2$ and "
            r"comes to $\pi/2 + \beta$.",
        ),
        added=("orientation counted modulo a half turn",),
        of_print=(
            for_all(r"the long axis points at the angle $\beta$", [], _equal(printed, axis),
                    at=_at_beta({})),
        ),
        with_added=(
            identity(r"long axis parallel to the angle $\beta$", crossed(printed, axis),
                     sp.Integer(0)),
        ),
        checks=(
            identity(r"at $\theta = \pi + \beta$ the short edge $\theta - \pi/2$ lies along both tips",
                     [sp.Subs(entry.subs(theta, theta - sp.pi / 2), theta, sp.pi + beta)
                      for entry in a], [-sp.sin(beta), sp.cos(beta)]),
        ),
    )  # fmt: skip


def _tolerance() -> Claim:
    """The conditions on beta_max, for one sign of beta and for both."""
    x, y = sp.cos(MAGNITUDE), sp.sin(MAGNITUDE)
    by_either_angle = [d3 * x + d1 * y - d3, d1 * x + d3 * y - d1]
    given = [
        *(first + 2 * c_p < eps_p for first in by_either_angle),
        r_max * y + 2 * c_p < eps_p,
        r_max**2 >= d1**2 + d3**2,
        x > 0,
        y > 0,
    ]
    one_sign = [d1 * x >= d3 * y, d2 > 0, d2 <= d3]
    spread_x, spread_y = _spread(sp.Integer(0), MAGNITUDE)
    both_x, both_y = _spread(-MAGNITUDE, MAGNITUDE)
    exact, printed = _largest_magnitudes()
    return Claim(
        key="step-4-tolerance",
        title="Conditions on the misalignment",
        place="Step 4, Section IX-E",
        printed=r"$r_{max}(\cos(\gamma_{max} - \beta_{max}) - \cos\gamma_{max}) + 2 c_p^u < \epsilon_p$, "
        r"$r_{max} \sin\beta_{max} + 2 c_p^u < \epsilon_p$ and $\beta_{max} < \epsilon_\theta$ ensure "
        r"the tolerance, “$\beta_{max}$ is the maximal magnitude for $\beta$”",
        derived=r"They do for $0 \le \beta \le \beta_{max}$; the first then follows from the second. "
        r"For both signs the box is $2 d_1 \sin\beta_{max} + 2 c_p^u$ high, and $2 d_2 \sin\beta_{max} + "
        r"2 c_p^u$ wide if $d_2 \ge d_1 \tan\beta_{max}$ (else $r + d_2 \sin\beta_{max} - d_1 "
        r"\cos\beta_{max} + 2 c_p^u$). Paper's part on its short edge, $\epsilon_p = 76$, $c_p^u = 5$ "
        rf"µm: the print allows $\beta_{{max}}$ up to {printed}°, the exact condition {exact}°.",
        steps=(
            r"$X = p^x - r\cos(\gamma + \beta)$, $Y = p^y - r\sin(\gamma + \beta)$; the tip adds "
            r"$\pm c_p^u$. The box has to be narrower than $\epsilon_p$, as in Step 1.",
            r"From $-\beta_{max}$ to $\beta_{max}$, $Y$ falls by $2 d_1 \sin\beta_{max}$: twice what "
            "the conditions count.",
        ),
        hypotheses=(r"the offset $d_2$ of the upper tip is known", r"$d_1 \ge d_3 \tan\beta_{max}$"),
        added=(r"$\beta \ge 0$: the upper tip is known to be ahead",),
        of_print=(
            for_all(
                r"the conditions (with either meaning of $\gamma_{max}$) bound the height of the box "
                rf"over $|\beta| \le \beta_{{max}}$ by $\epsilon_p$ ({IN_UM})",
                [*given, y < sp.Rational(87, 1000)],
                both_y + 2 * c_p < eps_p,
                at=_three_degrees(),
            ),
        ),
        with_added=(
            for_all(r"height for $0 \le \beta \le \beta_{max}$", [*given, *one_sign],
                    spread_y + 2 * c_p < eps_p),
            for_all(r"width for $0 \le \beta \le \beta_{max}$", [*given, *one_sign],
                    spread_x + 2 * c_p < eps_p),
            for_all("left side of the first condition, with either angle, at most that of the second",
                    [*given[3:], d1 * x >= d3 * y],
                    sp.And(*(first <= r_max * y for first in by_either_angle))),
        ),
        checks=_exact_spreads(both_x, both_y),
    )  # fmt: skip


def _spread(low: sp.Expr, high: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """By how much X rises and Y falls from one misalignment to another."""
    first, last = (
        centre().subs({BETA[0]: sp.cos(end), BETA[1]: sp.sin(end)}) for end in (low, high)
    )
    return as_written(lambda: last[0] - first[0]), as_written(lambda: first[1] - last[1])


def _exact_spreads(both_x: sp.Expr, both_y: sp.Expr) -> tuple[Finding, ...]:
    """Size of the box over both signs of beta."""
    x, y = sp.cos(beta), sp.sin(beta)
    at = centre().subs({BETA[0]: x, BETA[1]: y})
    rise = at.diff(beta)
    return (
        identity(r"height, both signs", both_y, 2 * d1 * sp.sin(MAGNITUDE)),
        identity(r"width, both signs", both_x, 2 * d2 * sp.sin(MAGNITUDE)),
        for_all(r"$Y$ falls with $\beta$ where $d_1 \cos\beta > |d_2 \sin\beta|$",
                [d1 * x > d2 * y, d1 * x > -d2 * y], rise[1] < 0),
        for_all(r"$X$ rises with $\beta$ where $d_2 \cos\beta > |d_1 \sin\beta|$",
                [d2 * x > d1 * y, d2 * x > -d1 * y], rise[0] > 0),
        for_all(r"$X$ rises with $\beta \ge 0$ for $d_2 > 0$",
                [d2 > 0, x > 0, y >= 0], rise[0] > 0),
        for_all(r"$X \ge p^x - r$, attained at $\tan\beta = -d_2/d_1$",
                [r_max**2 >= d1**2 + d2**2], at[0] >= p_x - r_max),
    )  # fmt: skip


def _largest_magnitudes() -> tuple[str, str]:
    """Largest misalignment of the paper's part by the exact and by the printed conditions."""
    room = (eps_p - 2 * c_p).subs(PAPER_TOLERANCE)
    exact = room / (2 * HALF_LENGTH)
    printed = room / sp.sqrt(HALF_LENGTH**2 + HALF_WIDTH**2)
    return _arcsine(exact), _arcsine(printed)


def _arcsine(value: sp.Expr) -> str:
    return f"{float(sp.deg(sp.asin(value))):.2f}"


def _three_degrees() -> dict[sp.Expr, sp.Expr]:
    """The paper's part, tolerance and probe error at a misalignment of up to 3 degrees."""
    return {
        d1: HALF_LENGTH,
        d3: HALF_WIDTH,
        r_max: sp.Integer(910),
        **PAPER_TOLERANCE,
        **angle(sp.Rational(1, 38), MAGNITUDE),
    }


def _errors() -> Claim:
    """Half width of the box when the offset is known from the sensed pose only."""
    sensed, e_y, e_c = sp.symbols("Y_s e_y e_c", real=True)
    x, y = BETA
    height = edge_contact(TILTED).arm()[1]
    law = sp.Eq(height, p_y + e_c - sensed - e_y)
    ended = centre().subs(p_y, p_y + e_c)
    expected = centre(p_y - sensed)
    error = sp.expand(ended - expected)
    small = [e_y**2 <= c_p**2, e_c**2 <= c_p**2, sp.sin(psi) <= sp.Rational(1, 190)]
    aligned = {x: 1, y: 0}
    (tip,) = sp.solve(law, e_c)
    bound = 5 + float(HALF_LENGTH) * float(sp.sin(sp.rad(sp.Rational(3, 10))))
    return Claim(
        key="step-4-errors",
        title="Half widths of the final box",
        place="Step 4, Section IX-E",
        printed=r"$X$ and $Y$ lie within $\pm c_p^u$, the error of the probe, of the centre of the "
        "box",
        derived=r"Within $\pm c_p^u$ of the centre computed with the offset $d_2$ at which the tip "
        r"really sits. Computed from the sensed pose, the error in $Y$ is the sensing error plus $d_1 "
        r"\sin\psi + d_2 (1 - \cos\psi)$ for a part that was tilted by $\psi$ when the tip touched "
        rf"it; the error of the probe drops out. Paper's part on its short edge, ±5 µm and ±0.3°: up "
        rf"to {bound:.1f} µm instead of 5.",
        steps=(
            r"At the first contact the tip is $d_2 \cos\psi - d_1 \sin\psi$ above the centre; while "
            r"it sticks, $d_2$ stays.",
            r"At the end the centre is $d_2$ (aligned tips) below the tip: it has come down by $d_1 "
            r"\sin\psi + d_2 (1 - \cos\psi)$.",
        ),
        hypotheses=("the upper tip touches first and sticks",),
        added=("$d_2$ is the offset at which the upper tip sits, not the one aimed at",),
        of_print=(
            for_all(
                r"$|\Delta Y| \le c_p^u$ for errors of sensing and probe up to $c_p^u$ and a tilt up "
                rf"to 0.3°, aligned tips ({IN_UM})",
                [law, *small, sp.sin(psi) >= 0, sp.cos(psi) > 0],
                error[1].subs(aligned) ** 2 <= c_p**2,
                at=_sensing_errors(sensed, e_y, e_c),
            ),
        ),
        with_added=(
            identity(r"the centre follows the tip", combined((1, ended), (-1, centre())), [0, e_c]),
        ),
        checks=(
            identity(
                r"$\Delta Y = e_Y - d_1 \sin\psi - d_2 (1 - \cos\psi)$, aligned tips",
                error[1].subs(aligned).subs(e_c, tip),
                e_y - d1 * sp.sin(psi) - d2 * (1 - sp.cos(psi)),
            ),
            identity(
                r"$\Delta X = (\Delta d_2) \sin\beta$ besides the tip's own error",
                error[0],
                (d2 - p_y + sensed) * y,
            ),
        ),
    )


def _sensing_errors(sensed: sp.Symbol, e_y: sp.Symbol, e_c: sp.Symbol) -> dict[sp.Expr, sp.Expr]:
    """Sensed 5 um too high, tilted by 0.3 degrees, tip exactly where it should be."""
    tilt = angle(sp.Rational(1, 382), psi)
    offset = sp.Integer(150)
    tip = offset * tilt[sp.cos(psi)] - HALF_LENGTH * tilt[sp.sin(psi)] - 5
    return {
        d1: HALF_LENGTH,
        d2: offset,
        c_p: PAPER_TOLERANCE[c_p],
        e_y: sp.Integer(-5),
        e_c: sp.Integer(0),
        sensed: sp.Integer(12),
        p_y: tip + 12,
        **tilt,
    }


def _largest_tilt(lo: sp.Matrix, hi: sp.Matrix) -> Claim:
    """theta_t2_max of Step 2 from the sticking arc and the lever."""
    start, q = (sp.Matrix(sp.symbols(f"{k}_x {k}_y", real=True)) for k in ("p", "q"))
    upright = sp.Matrix([0, 1])
    lever = sticking_at(TILTED).turning
    size = rho + d1**2 + d2**2
    texts = [f"{k} µm: {_tilt_limit(lo, k):.2f}°" for k in (100, 200, 240, 300, 360)]
    return Claim(
        key="t2-largest-tilt",
        title=r"Largest tilt from which $t^2$ starts: $\theta_{t^2}^{max}$",
        place="Step 2, Section IX-E, which uses it and does not give it",
        derived=r"A push at $d_2 > 0$ straightens an edge tilted by $\psi$ without slipping exactly "
        r"for $\tan\psi < \min\{d_2/d_1,\ (\mu B - A)/(C - \mu A)\}$: the first bound is the sense "
        r"of turning and holds for $d_2 \le \mu d_1$, the second is sticking. Best is $d_2 = \mu "
        r"d_1$, with $\theta_{t^2}^{max} = \tan^{-1}\mu$; no offset does better. Paper's short edge, "
        rf"$\mu = 0.30$: {', '.join(texts)}.",
        steps=(
            r"Margin towards $\theta_{lo}$ at $\theta = \pi/2 - \psi$: $(\mu B - A) \cos\psi - (C - "
            r"\mu A) \sin\psi$; lever: $d_2 \cos\psi - d_1 \sin\psi$.",
            r"$(\mu B - A) d_1 - (C - \mu A) d_2 = (\mu d_1 - d_2) F$ tells which bound is the "
            "smaller.",
            "Positive at the tilt and upright: positive on the way, as the margin is linear in the "
            "direction.",
        ),
        hypotheses=(r"$\mu B > A$: sticks when upright", r"$C > \mu A$"),
        checks=(
            identity("margin at the tilt", crossed(lo, TILTED),
                     lo[0] * sp.cos(psi) - lo[1] * sp.sin(psi)),
            identity("lever at the tilt", lever, crossed((d2, d1), TILTED)),
            for_all(r"the other margin is positive by itself for $d_2 > 0$, $0 \le \psi < \pi/2$",
                    [d2 > 0, sp.sin(psi) >= 0, sp.cos(psi) > 0], cross(TILTED, hi) > 0),
            identity("which bound is the smaller", lo[0] * d1 - lo[1] * d2, (mu * d1 - d2) * size),
            identity(r"at $d_2 = \mu d_1$ both are $\mu$",
                     sp.Subs(lo[0], d2, mu * d1), mu * sp.Subs(lo[1], d2, mu * d1)),
            positive_by(
                "sticking between the tilt and upright",
                cross(lo, q),
                {"at_tilt": cross(lo, start), "at_upright": cross(lo, upright),
                 "since": cross(start, q), "until": cross(q, upright),
                 "width": cross(start, upright)},
                multiplier="width",
                combination="until*at_tilt + since*at_upright",
            ),
            positive_by(
                r"$\tan\psi < \mu$ wherever a push at $d_2 > 0$ sticks and turns the edge back",
                mu * q[1] - q[0],
                {"sticks": cross(lo, q), "lever": d2 * q[1] - d1 * q[0], "sine": q[0],
                 "cosine": q[1], "d1": d1, "rho": rho, "d2": d2},
                multiplier="cosine*rho + d1*(d2*sine + d1*cosine)",
                combination="cosine*sticks + lever*(d2*sine + d1*cosine)",
            ),
        ),
    )  # fmt: skip


def _tilt_limit(lo: sp.Matrix, offset: int) -> float:
    """Degrees, paper's short edge, least friction."""
    at = {**SHORT_EDGE, d2: sp.Integer(offset), mu: LEAST_MU}
    tangent = min((d2 / d1).subs(at), (lo[0] / lo[1]).subs(at))
    return float(sp.deg(sp.atan(tangent)))


def _tilt_and_push() -> Claim:
    """The tilt that a two-sided rotation has left after a push of any length."""
    across, push = _push_for_tilt()
    joint = T * a + width * n
    left = {k: _tilt_after(k) for k in (1100, 1300, 1900)}
    texts = [f"{tilt:.2f}° after {k} µm" for k, tilt in left.items()]
    return Claim(
        key="tilt-after-push",
        title="Tilt that the rotation leaves, and the push for a given tilt",
        place="new; what Step 2 has to ask for",
        derived=r"From upright to a tilt $\psi$ off the horizontal the moving tip travels $d_w (1 - "
        r"\sin\psi) + T \cos\psi$ with $T = (d_v - d_w \cos\psi)/\sin\psi$ the distance of the "
        r"contacts along the part; the tilt falls all the way. $\theta_t$ is its value at $T = d_l$, "
        r"tips at opposite corners, and the least that can be reached. Paper ($d_v = 857$ µm): "
        rf"{', '.join(texts)}; $\theta_t = {_least_tilt():.2f}°$ after {_travel_to_corners():.0f} µm.",
        steps=(
            r"Both tips touch: $(h, d_v) = T a + d_w n$ with $\theta = \pi - \psi$, so $h = d_w "
            r"\sin\psi - T \cos\psi$ and $d_v = T \sin\psi + d_w \cos\psi$; upright $h = d_w$.",
        ),
        hypotheses=("both tips touch the long edges from upright on", r"$d_v > d_w$"),
        checks=(
            identity("closure at the tilt", [sp.Subs(entry, theta, sp.pi - psi) for entry in joint],
                     [width * sp.sin(psi) - T * sp.cos(psi),
                      T * sp.sin(psi) + width * sp.cos(psi)]),
            identity("closure upright", [sp.Subs(entry, theta, sp.pi / 2) for entry in joint],
                     [width, T]),
            identity(r"$T$ satisfies the closure",
                     as_written(lambda: across * sp.sin(psi) + width * sp.cos(psi)), V),
            identity(r"travel falls with the tilt: $d\xi/d\psi = -T/\sin\psi$",
                     sp.diff(push, psi), -across / sp.sin(psi)),
            _least_tilt_is_at_the_corners(),
        ),
    )  # fmt: skip


def _push_for_tilt() -> tuple[sp.Expr, sp.Expr]:
    """Distance of the contacts and travel since upright, at the tilt psi."""
    across = (V - width * sp.cos(psi)) / sp.sin(psi)
    return across, width - (width * sp.sin(psi) - across * sp.cos(psi))


def _least_tilt_is_at_the_corners() -> Finding:
    """A smaller distance of the contacts means a larger tilt."""
    x, y, u, v = sp.symbols("cos_psi sin_psi cos_t sin_t", real=True)
    apart = (V - width * x) / y  # T from the separation
    at_corners = {V: length * v + width * u}
    return positive_by(
        r"contacts nearer than $d_l$, $\tan\theta_t < d_l/d_w$: tilt larger than $\theta_t$",
        y * u - x * v,
        {
            "nearer": y * (length - apart.subs(at_corners)),
            "diagonal": length * v + width * u,
            "turned": 1 - (x * u + y * v),
            "steep": length * u - width * v,
        },
        multiplier="steep",
        combination="nearer + diagonal*turned",
        on=[(x, y), (u, v)],
    )


def _paper_rotation() -> dict[sp.Symbol, sp.Expr]:
    return {V: sp.Integer(857), width: 2 * HALF_WIDTH, length: 2 * HALF_LENGTH}


def _tilt_after(travel: int) -> float:
    """Degrees left after a push of this length, from the vector between the tips."""
    at = _paper_rotation()
    ahead = at[width] - travel
    span = sp.sqrt(ahead**2 + at[V] ** 2)
    turned = sp.atan2(at[V], ahead) + sp.asin(at[width] / span)
    return 180 - float(sp.deg(turned))


def _least_tilt() -> float:
    """theta_t of eq. (11), degrees."""
    at = _paper_rotation()
    diagonal = sp.sqrt(at[width] ** 2 + at[length] ** 2)
    return float(sp.deg(sp.asin(at[V] / diagonal) - sp.atan(at[width] / at[length])))


def _travel_to_corners() -> float:
    tilt = _least_tilt()
    at = {**_paper_rotation(), psi: sp.rad(tilt)}
    return float(_push_for_tilt()[1].subs(at))


def _step_2(lo: sp.Matrix) -> Claim:
    """theta_t < theta_t2_max against the tilt at the actual end of the rotation."""
    first = sp.Symbol("theta_t", real=True)
    least = sp.Matrix([sp.sin(first), sp.cos(first)])
    lever = sticking_at(TILTED).turning
    rotation = [
        sp.Eq(width * sp.sin(psi) - T * sp.cos(psi), h),
        sp.Eq(T * sp.sin(psi) + width * sp.cos(psi), V),
        length > T,
        sp.Eq(length * sp.sin(first) + width * sp.cos(first), V),
    ]
    printed = [cross(lo, least) > 0, sticking_at(least).turning > 0]
    point = _slips_after_rotation()
    travel = float((width - h).subs(point))
    slope = {q_x: point[sp.sin(psi)], q_y: point[sp.cos(psi)]}
    least_offset, largest_offset = admissible_range({**SHORT_EDGE, mu: LEAST_MU, **slope})
    return Claim(
        key="step-2-tilt",
        title=r"$\theta_t < \theta_{t^2}^{max}$ and the $t^2$ push after the rotation",
        place="Step 2, Section IX-E, with eq. (11)",
        printed=r"“To ensure that the final $t^2$ pushing can be robustly applied, it is required that "
        r"… $\theta_t < \theta_{t^2}^{max}$”",
        derived=r"What counts is the tilt $\psi$ at the end of the rotation that was made: $\psi < "
        r"\theta_{t^2}^{max}$. $\theta_t$ is its least possible value, so the printed condition is "
        rf"necessary and not sufficient. Witness: separation {float(point[V]):.2f} µm ($\theta_t = "
        rf"{_degrees(point, first)}°$), push {travel:.2f} µm (the paper reports 1100), tilt "
        rf"{_degrees(point, psi)}°; a $t^2$ push at $d_2 = {point[d2]}$ µm on the short edge, $\mu = "
        rf"0.30$, has $\theta_{{t^2}}^{{max}} = {_tilt_limit(lo, int(point[d2])):.2f}°$ and slips. "
        rf"At this tilt $d_2$ from {least_offset:.0f} to {largest_offset:.0f} µm would do; the paper "
        "does not report its $d_2$.",
        steps=(
            r"$\theta_t$ of eq. (11) solves $d_l \sin\theta_t + d_w \cos\theta_t = d_v$: tips at "
            "opposite corners.",
            "After a shorter push the tips are nearer and the tilt is larger (see the tilt after a "
            "push).",
        ),
        added=(r"the push is long enough for $\psi < \theta_{t^2}^{max}$",),
        of_print=(
            for_all(
                f"the $t^2$ push starts sticking at the tilt that the rotation has left ({IN_UM})",
                [*rotation, *printed],
                cross(lo, TILTED) > 0,
                at=point,
            ),
        ),
        with_added=(
            for_all(
                r"$\tan\psi < \min\{d_2/d_1,\ (\mu B - A)/(C - \mu A)\}$: sticks and turns the edge "
                "back",
                [TILTED[0] > 0, TILTED[1] > 0, lo[1] > 0,
                 TILTED[0] * lo[1] < TILTED[1] * lo[0], TILTED[0] * d1 < TILTED[1] * d2],
                sp.And(cross(lo, TILTED) > 0, lever > 0),
            ),
        ),
        checks=(
            identity(
                r"$\sin(\alpha + \theta_t) = d_v/\sqrt{d_w^2 + d_l^2}$ with $\tan\alpha = d_w/d_l$ is "
                r"$d_l \sin\theta_t + d_w \cos\theta_t = d_v$",
                _printed_sine(first) * sp.sqrt(width**2 + length**2),
                length * sp.sin(first) + width * sp.cos(first),
            ),
            there_is(
                "at the witness the push does turn the edge back, so that slip alone is at fault; "
                "upright it would stick",
                [lever > 0, lo[0] > 0, lo[1] > 0],
                at=point,
            ),
        ),
    )  # fmt: skip


def _printed_sine(first: sp.Symbol) -> sp.Expr:
    """sin(alpha + theta_t) of eq. (11)."""
    alpha = sp.atan(width / length)
    return sp.sin(alpha) * sp.cos(first) + sp.cos(alpha) * sp.sin(first)


def _slips_after_rotation() -> dict[sp.Expr, sp.Expr]:
    """The paper's rotation in exact numbers: separation 857 um, push 1100 um, to 0.1 um."""
    first = sp.Symbol("theta_t", real=True)
    wide, long = 2 * HALF_WIDTH, 2 * HALF_LENGTH
    least = angle(sp.Rational(1, 161), first)
    apart = long * least[sp.sin(first)] + wide * least[sp.cos(first)]
    # T^2 = h^2 + V^2 - w^2: rational if T - h is
    difference = sp.Integer(584)
    total = (apart**2 - wide**2) / difference
    span, ahead = (total + difference) / 2, (total - difference) / 2
    scale = span**2 + wide**2
    return {
        **SHORT_EDGE,
        d2: sp.Integer(360),
        mu: LEAST_MU,
        width: wide,
        length: long,
        V: apart,
        h: ahead,
        T: span,
        **least,
        sp.cos(psi): (wide * apart - ahead * span) / scale,
        sp.sin(psi): (span * apart + ahead * wide) / scale,
    }


def _degrees(at: Mapping[sp.Expr, sp.Expr], turn: sp.Symbol) -> str:
    return f"{float(sp.deg(sp.atan2(at[sp.sin(turn)], at[sp.cos(turn)]))):.2f}"
