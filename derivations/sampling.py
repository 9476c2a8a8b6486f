"""Robust push offsets: when the corners of a box suffice, and what sampling misses.

The paper tests sampled offsets at the nominal values and at all combinations of maximal errors. The
three margins of a sticking push that turns the part (towards either end of the sticking arc, and the
lever) are linear in the edge's direction, affine in ``mu`` and ``rho`` and quadratic in the offset
``d2``: corners are a proof in every variable but the last, and in that one on every edge that is not
too long.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import NamedTuple

import sympy as sp
from sympy.logic.boolalg import Boolean

from derivations._claim import Claim
from derivations._derivation import Derivation
from derivations._statement import (
    Finding,
    angle,
    as_written,
    for_all,
    identity,
    positive_by,
    there_is,
)
from derivations._tex import tex
from derivations.mechanics import PAPER, cross, d1, d2, mu, rho
from derivations.symmetries import HALF_LENGTH, Q, q_x, q_y, sticking_at

B = rho + d1**2
LEAST_MU, MOST_MU = sp.Rational(3, 10), sp.Rational(9, 25)
EITHER_WAY = sp.Integer(10)
"""Error of the offset in µm: 5 of sensing and 5 of the probe."""
FINEST = sp.Integer(5)
"""The error of the probe, µm: at this dispersion sampling stops."""
TILT, HALF_ERROR = sp.Rational(681, 5000), sp.Rational(1, 382)
"""Half tangents: an edge tilted by 15.5°, and ±0.3° of sensing."""
PART = {d1: PAPER[d1], rho: PAPER[rho]}
reach = sp.Symbol("reach", positive=True)
"""Largest |d2| considered."""


class Margins(NamedTuple):
    """Positive where a push along -x sticks and turns the part counter-clockwise."""

    from_lo: sp.Expr
    to_hi: sp.Expr
    lever: sp.Expr


def margins() -> Margins:
    """From the balance at one contact, polynomials in the direction of the edge."""
    forces = sticking_at()
    return Margins(
        sp.expand(mu * forces.normal + forces.tangential),
        sp.expand(mu * forces.normal - forces.tangential),
        forces.turning,
    )


def derive() -> Derivation:
    """Decide what the sampling algorithm proves and what it misses."""
    found = margins()
    return Derivation(
        name="sampling",
        summary="Robust push offsets: corners of a box and sampling (paper, Section IX-D).",
        claims=(
            _corners(found),
            _ends_that_count(found),
            _offsets(found),
            _none_found(found),
        ),
    )


def admissible(found: Margins, at: Mapping[sp.Expr, sp.Expr]) -> tuple[Boolean, ...]:
    """The push sticks and turns the part at these values."""
    return tuple(margin.subs(at, simultaneous=True) > 0 for margin in found)


def _corners(found: Margins) -> Claim:
    """Step 2b for one-point sticking."""
    low, high = sp.symbols("d2_lo d2_hi", real=True)
    mu_lo, mu_hi = sp.symbols("mu_lo mu_hi", positive=True)
    turns = [_direction(sp.Symbol(f"theta_{k}", real=True)) for k in (1, 2)]
    at_corners = [
        relation
        for offset, turn, friction in product((low, high), turns, (mu_lo, mu_hi))
        for relation in admissible(found, {d2: offset, **turn, mu: friction})
    ]
    inside = [low < d2, d2 < high]
    limit = _least_reach()
    example = {**PART, mu: LEAST_MU}
    long, short = (float(limit.subs({**example, d1: k})) for k in (PART[d1], HALF_LENGTH))
    return Claim(
        key="corners-one-point",
        title="Corners of the uncertainty set, one-point sticking",
        place="steps (2b), (2c) under Lemma 1; Section IX-D",
        printed="“check whether the push is still sticking when all the combination of maximal "
        "uncertainties are involved; … if the push is always sticking, then this nominal push is "
        "robust”",
        derived=r"For the box of $\theta$, $d_2$, $\mu$, $\rho$ its corners are a proof if $|d_2| "
        rf"< d_2^* = {_latex(limit)}$ throughout and $4\rho > \mu^2 d_1^2$. Paper's part: $d_2^* "
        rf"= {long:.0f}$ µm on the long edge (half of it is 808 µm), {short:.0f} µm on the short one "
        rf"(418.5 µm), at $\mu = 0.30$, more at larger $\mu$: there the rule is sound. Below $\mu "
        r"\approx 0.13$ the long edge reaches beyond $d_2^*$ and corners can miss a slip. For any "
        r"$d_2$ they are a proof if the margins there exceed $|\cos\theta| (\Delta d_2)^2/4$. The "
        r"range of $\theta$ may be that of a whole rotation.",
        steps=(
            r"Three margins must be positive: $\mu N - D$, $\mu N + D$ and the lever. Each is linear "
            r"in $(\cos\theta, \sin\theta)$, affine in $\mu$ and in $\rho$: positive at both ends, "
            "positive between.",
            r"In $d_2$ the lever is affine, $\mu N - D$ has the leading coefficient $-\cos\theta$: "
            r"concave for $\cos\theta \ge 0$. For $\cos\theta < 0$ it is convex with its least value "
            r"at $v = d_1 (\tan\tau + \mu)/2$, $\tan\tau = \sin\theta/|\cos\theta|$.",
            r"If the range of $d_2$ ends before $v$, the margin falls over it and its end decides. "
            r"Otherwise $v \le d_2^*$, and there the least value is $-|\cos\theta| P(v) > 0$ with "
            rf"$P(z) = {_latex(_bound(sp.Symbol('z')))}$, whose larger root is $d_2^*$.",
            r"$\mu N + D$ is the mirror image ($\cos\theta \to -\cos\theta$, $d_2 \to -d_2$).",
        ),
        hypotheses=(
            r"$|d_2| < d_2^*$ at the least $\mu$ and $\rho$ of the box ($d_2^*$ grows with both)",
            r"$4\rho > \mu^2 d_1^2$ at the largest $\mu$ and the least $\rho$",
            r"$0 < \theta < \pi$, range of $\theta$ shorter than $\pi$",
        ),
        added=(r"$|d_2| < d_2^*$", r"$4\rho > \mu^2 d_1^2$"),
        of_print=(
            for_all(
                "all eight corners of a box in $d_2$, $\\theta$, $\\mu$ admissible (672…692 µm, "
                "0.6°, 0.05…0.36): so is every point of it (lengths in µm)",
                [*at_corners, *inside],
                sp.And(*admissible(found, {d2: d2, **turns[0], mu: mu_lo})),
                at=_missed_by_corners(low, high, mu_lo, mu_hi),
            ),
        ),
        with_added=(
            *_linear_in_direction(found),
            *_affine_in_parameters(found),
            *_between_offsets(found),
        ),
        checks=(_dip(found),),
    )


def _direction(turn: sp.Symbol) -> dict[sp.Symbol, sp.Expr]:
    return {q_x: sp.cos(turn), q_y: sp.sin(turn)}


def _missed_by_corners(
    low: sp.Symbol, high: sp.Symbol, mu_lo: sp.Symbol, mu_hi: sp.Symbol
) -> dict[sp.Expr, sp.Rational]:
    """The paper's part in a lubricated contact: margins dip below 0 between two offsets."""
    first, last = (sp.Symbol(f"theta_{k}", real=True) for k in (1, 2))
    return {
        **PART,
        low: sp.Integer(672),
        high: sp.Integer(692),
        d2: sp.Integer(682),
        mu_lo: sp.Rational(1, 20),
        mu_hi: MOST_MU,
        **angle(sp.Rational(135_883, 100_000), first),
        **angle(sp.Rational(13_737, 10_000), last),
    }


def _bound(z: sp.Symbol) -> sp.Expr:
    """P(z): the least value of ``mu N - D`` over d2, at the orientation with vertex z, is -|cos| P."""
    return z**2 - 2 * mu * (B / d1) * z + mu**2 * B - rho


def _least_reach() -> sp.Expr:
    """d2*: beyond it the least value may be negative between two corners."""
    return mu * B / d1 + sp.sqrt(rho * (1 + mu**2 * B / d1**2))


def _linear_in_direction(found: Margins) -> tuple[Finding, ...]:
    """Positive at both ends of an arc shorter than half a turn: positive within."""
    first, last = (sp.Matrix(sp.symbols(f"p_x{k} p_y{k}", real=True)) for k in (1, 2))
    k_x, k_y = sp.symbols("k_x k_y", real=True)

    def value(q: sp.Matrix) -> sp.Expr:
        return k_x * q[0] + k_y * q[1]

    size = sp.Symbol("size", positive=True)
    longer = {q_x: size * q_x, q_y: size * q_y}
    return (
        positive_by(
            r"what is linear in $(\cos\theta, \sin\theta)$ and positive at both ends of a range "
            r"shorter than $\pi$ is positive within",
            value(Q),
            {
                "at_first": value(first),
                "at_last": value(last),
                "since": cross(first, Q),
                "until": cross(Q, last),
                "width": cross(first, last),
            },
            multiplier="width",
            combination="until*at_first + since*at_last",
        ),
        *(
            identity(f"{name} is linear in the direction",
                     margin.subs(longer, simultaneous=True)
                     + margin.subs({q_x: 0}) + margin.subs({q_y: 0}), (size + 1) * margin)
            for name, margin in zip((r"$\mu N - D$", r"$\mu N + D$", "the lever"), found, strict=True)
        ),
    )  # fmt: skip


def _affine_in_parameters(found: Margins) -> tuple[Finding, ...]:
    return tuple(
        identity(
            f"all three margins are affine in ${name}$: second derivatives",
            [sp.Derivative(margin, (parameter, 2)) for margin in found],
            sp.zeros(3, 1),
        )
        for parameter, name in ((mu, r"\mu"), (rho, r"\rho"))
    )


def _between_offsets(found: Margins) -> tuple[Finding, ...]:
    """From the two ends of a range of offsets to every offset between."""
    low, high, v = sp.symbols("d2_lo d2_hi v", real=True)
    z = sp.Symbol("z")

    def value(offset: sp.Expr) -> sp.Expr:
        return found.from_lo.subs(d2, offset)

    ends = {"at_low": value(low), "at_high": value(high), "since": d2 - low, "until": high - d2}
    first = mu * d1 / 2
    turned = {q_y: -q_x * (2 * v / d1 - mu)}
    mirrored = sp.Subs(found.to_hi, (d2, q_x), (-d2, -q_x))
    return (
        positive_by(
            r"$\cos\theta > 0$: $\mu N - D$ between two offsets where it is positive",
            value(d2),
            {**ends, "cos": q_x},
            multiplier="since + until",
            combination="until*at_low + since*at_high + cos*since*until*(since + until)",
        ),
        positive_by(
            r"$\cos\theta < 0$, upper end before $v$: $\mu N - D$ is larger than at that end",
            value(d2),
            {
                "at_high": value(high),
                "until": high - d2,
                "slope": d1 * (q_y - mu * q_x) + q_x * (d2 + high),
            },
            multiplier="1",
            combination="at_high + until*slope",
        ),
        identity(
            r"there the slope is $|\cos\theta| (2v - d_2 - d_2^{hi})$",
            (d1 * (q_y - mu * q_x) + q_x * (d2 + high)).subs(turned),
            -q_x * (2 * v - d2 - high),
        ),
        identity(
            r"$\cos\theta < 0$: $\mu N - D = |\cos\theta| ((d_2 - v)^2 - P(v))$",
            value(d2).subs(turned),
            -q_x * ((d2 - v) ** 2 - _bound(v)),
        ),
        positive_by(
            r"$-P(v) > 0$ for $\mu d_1/2 < v < d_2^*$ ($\sin\theta > 0$ gives the first)",
            -_bound(v),
            {
                "after": v - first,
                "before": reach - v,
                "at_first": rho - mu**2 * d1**2 / 4,
                "at_reach": -_bound(reach),
            },
            multiplier="after + before",
            combination="before*at_first + after*at_reach + after*before*(after + before)",
        ),
        identity(r"$P(d_2^*) = 0$", _bound(z).subs(z, _least_reach()), sp.Integer(0)),
        identity(r"$\mu N + D$ is the mirror image", mirrored, found.from_lo),
        identity(
            "the lever is affine in $d_2$", sp.Derivative(found.lever, (d2, 2)), sp.Integer(0)
        ),
    )


def _dip(found: Margins) -> Finding:
    """How far the margin can lie below both ends of a range of offsets."""
    low, high = sp.symbols("d2_lo d2_hi", real=True)
    at, at_low, at_high = (found.from_lo.subs(d2, offset) for offset in (d2, low, high))
    bend = q_x * (d2 - low) * (high - d2) * (high - low)
    return identity(
        r"$M(d_2) (q - p) = M(p) (q - d_2) + M(q) (d_2 - p) + \cos\theta\, (d_2 - p)(q - d_2)(q - p)$"
        r" for $M = \mu N - D$ between the offsets $p$ and $q$, of any sign of $\cos\theta$",
        at * (high - low),
        at_low * (high - d2) + at_high * (d2 - low) + bend,
    )


def _ends_that_count(found: Margins) -> Claim:
    """Four corners instead of sixteen."""
    larger = sp.Symbol("mu_more", positive=True)
    normal = (found.from_lo + found.to_hi) / (2 * mu)
    return Claim(
        key="corners-that-count",
        title="Which corners decide",
        place="new; thins out “all the combination of maximal uncertainties”",
        derived=r"The least $\mu$ alone decides: sticking there is sticking at every larger $\mu$. "
        r"Of $\rho$ the least value alone decides where $|\cot\theta| < \mu$, that is within the "
        "angle of friction of an upright edge. The lever depends on neither.",
        steps=(
            r"$\partial(\mu N \mp D)/\partial\mu = N$, and $N > 0$ where both margins are positive: "
            r"their sum is $2\mu N$.",
            r"$\partial(\mu N \mp D)/\partial\rho = \mu \sin\theta \mp \cos\theta$.",
        ),
        checks=(
            positive_by(
                r"$\mu N - D$ at a larger $\mu$",
                found.from_lo.subs(mu, larger),
                {
                    "from_lo": found.from_lo,
                    "to_hi": found.to_hi,
                    "more": larger - mu,
                    "mu": mu,
                },
                multiplier="2*mu",
                combination="2*mu*from_lo + more*(from_lo + to_hi)",
            ),
            positive_by(
                r"$\mu N + D$ at a larger $\mu$",
                found.to_hi.subs(mu, larger),
                {
                    "from_lo": found.from_lo,
                    "to_hi": found.to_hi,
                    "more": larger - mu,
                    "mu": mu,
                },
                multiplier="2*mu",
                combination="2*mu*to_hi + more*(from_lo + to_hi)",
            ),
            identity("the slope in $\\mu$ is $N$", sp.Derivative(found.from_lo, mu), normal),
            identity(r"slope in $\rho$", sp.Derivative(found.from_lo, rho), mu * q_y - q_x),
            identity(r"slope in $\rho$, the other margin", sp.Derivative(found.to_hi, rho),
                     mu * q_y + q_x),
            identity("the lever depends on neither: its slopes",
                     [sp.Derivative(found.lever, mu), sp.Derivative(found.lever, rho)], sp.zeros(2, 1)),
        ),
    )  # fmt: skip


def _offsets(found: Margins) -> Claim:
    """The set that the paper samples, in closed form."""
    root = sp.Symbol("root", positive=True)
    end, square = _largest_offset(root)
    at_end = sp.numer(sp.together(found.from_lo.subs(d2, end)))
    quotient, _ = sp.div(sp.expand(at_end), root**2 - square, root)
    low = {**PART, mu: LEAST_MU}
    texts = [
        rf"$\psi = {_degrees(t):.2f}°$, {first:.1f} to {last:.1f} µm"
        for t in (sp.Integer(0), sp.Rational(2, 21))
        for first, last in [admissible_range({**low, **_tilted(t, sp.Integer(0))})]
    ]
    return Claim(
        key="admissible-offsets",
        title="All offsets that stick and turn the part",
        place="new; replaces the sampling of Section IX-D",
        derived=r"At every orientation the admissible offsets form an interval (within $|d_2| < "
        r"d_2^*$), and so do the robust ones, as an intersection of intervals. For an edge tilted "
        r"by $\psi = \pi/2 - \theta \ge 0$: $d_1 \tan\psi < d_2 < d_2^{max}$ with $d_2^{max} = "
        r"2k/(w + \sqrt{w^2 + 4 k \sin\psi})$, $w = d_1 (\cos\psi - \mu \sin\psi)$, $k = \mu (\rho "
        r"+ d_1^2) \cos\psi - \rho \sin\psi$. Paper's part, long edge, $\mu = 0.30$: " + "; ".join(texts)
        + r". The interval is empty from $\tan\psi = \mu$ on.",
        steps=(
            r"$\theta \le \pi/2$: the lever asks for $d_2 > d_1 \cot\theta \ge 0$; then $\mu N + D > "
            r"0$ by itself, and $\mu N - D$, concave in $d_2$, is positive up to its larger root.",
        ),
        checks=(
            identity(r"$\mu N - D = 0$ at $d_2^{max}$: a multiple of $root^2$ less what it stands for",
                     at_end, as_written(lambda: quotient * (root**2 - square))),
            for_all(r"$\cos\theta \ge 0$, lever and $\mu N - D$ positive: so is $\mu N + D$",
                    [q_x >= 0, q_y > 0, found.lever > 0, found.from_lo > 0], found.to_hi > 0),
            positive_by(
                r"admissible at some offset only for $\cot\theta < \mu$",
                mu * q_y - q_x,
                {"sticks": found.from_lo, "lever": found.lever, "cos": q_x, "sin": q_y,
                 "d1": d1, "rho": rho, "d2": d2},
                multiplier="sin*rho + d1*(d2*cos + d1*sin)",
                combination="sin*sticks + lever*(d2*cos + d1*sin)",
            ),
        ),
    )  # fmt: skip


def _largest_offset(root: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """d2 at which ``mu N - D`` vanishes, and the square of the ``root`` that occurs in it."""
    rest = mu * B * q_y - rho * q_x
    width = d1 * (q_y - mu * q_x)
    return 2 * rest / (width + root), sp.expand(width**2 + 4 * q_x * rest)


def admissible_range(at: Mapping[sp.Expr, sp.Expr]) -> tuple[float, float]:
    """Offsets that stick and turn back an edge tilted towards smaller theta, for a text."""
    _, square = _largest_offset(sp.Integer(0))
    end, _ = _largest_offset(sp.sqrt(square))
    return float((d1 * q_x / q_y).subs(at)), float(end.subs(at))


def _tilted(half: sp.Rational, error: sp.Rational) -> dict[sp.Expr, sp.Rational]:
    """Direction of an edge tilted from upright, towards smaller theta, by two angles in turn."""
    (x, y), (u, v) = ((1 - t**2, 2 * t) for t in (half, error))
    size = (x**2 + y**2) * (u**2 + v**2)
    # products of rational points of the circle: size is the square of (1 + half^2)(1 + error^2)
    length = sp.sqrt(size)
    return {q_x: (y * u + x * v) / length, q_y: (x * u - y * v) / length}


def _degrees(half: sp.Rational) -> float:
    return float(sp.deg(2 * sp.atan(half)))


def _robust(found: Margins, offset: sp.Expr) -> tuple[Boolean, ...]:
    """All corners of the neighbourhood of a push are admissible."""
    return tuple(
        relation
        for error, turned, friction in product(
            (-EITHER_WAY, EITHER_WAY), (-HALF_ERROR, HALF_ERROR), (LEAST_MU, MOST_MU)
        )
        for relation in admissible(
            found, {**PART, **_tilted(TILT, turned), mu: friction, d2: offset + error}
        )
    )


def _last_dispersion() -> sp.Rational:
    """Halved from half of the edge until it is at most the probe's error."""
    dispersion = HALF_LENGTH
    while dispersion > FINEST:
        dispersion = dispersion / sp.Integer(2)
    return dispersion


def _none_found(found: Margins) -> Claim:
    """A robust offset between two samples of the last and finest grid."""
    spacing = _last_dispersion()
    robust_at = sp.Integer(129)
    before = sp.floor(robust_at / spacing) * spacing
    samples = (before, before + spacing)
    robust = sp.And(*_robust(found, d2))
    limit = float(_least_reach().subs({**PART, mu: LEAST_MU}))
    first, last = admissible_range({**PART, mu: LEAST_MU, **_tilted(TILT, HALF_ERROR)})
    return Claim(
        key="no-robust-motion",
        title="“No robust motion exists” when sampling stops",
        place="Section IX-D",
        printed="“If no robust motion is found when the algorithm stops, then there exists no robust "
        "motion with respect to the given property under such uncertainties.”",
        derived=r"Robust offsets form an interval; samples miss it if it is shorter than their "
        r"spacing. Paper's part (long edge, offset ±10 µm, $\theta$ ±0.3°, $\mu$ 0.30…0.36), edge "
        rf"tilted by {_degrees(TILT):.2f}°: the robust offsets are {first + EITHER_WAY:.2f} to "
        rf"{last - EITHER_WAY:.2f} µm, the samples "
        rf"beside them {float(samples[0]):.2f} and {float(samples[1]):.2f} µm. The ends of the "
        "interval can be computed, so nothing need be sampled.",
        steps=(
            r"The dispersion starts at 808 µm, half of the edge, and is halved until it is at most "
            rf"5 µm: {tex(spacing)} µm. All samples of all rounds are multiples of it, whether it "
            "is read as spacing or as half the spacing.",
            r"An offset is robust if all corners of its neighbourhood are admissible (here corners "
            rf"are a proof, as $d_2^* = {limit:.0f}$ µm).",
        ),
        of_print=(
            for_all(
                f"if neither {tex(samples[0])} nor {tex(samples[1])} µm is robust, no offset is "
                rf"(edge tilted by $2 \tan^{{-1}} {_latex(TILT)}$, known to $\pm 2 \tan^{{-1}} "
                rf"{_latex(HALF_ERROR)}$)",
                [sp.Not(sp.And(*_robust(found, sample))) for sample in samples],
                sp.Not(robust),
                at={d2: robust_at},
            ),
        ),
        checks=(
            for_all(
                "every other sample lies still farther off: robust offsets are all strictly between "
                "these two",
                [robust],
                sp.And(samples[0] < d2, d2 < samples[1]),
            ),
            there_is(f"{robust_at} µm is robust", [robust], at={d2: robust_at}),
        ),
    )


def _latex(expression: sp.Expr) -> str:
    return tex(expression).strip("$")
