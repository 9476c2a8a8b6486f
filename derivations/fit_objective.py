"""The objective that the parameters were fitted with (eqs. 3 and 4, Section VI).

For one trial the error along each axis is a root mean square over the ``T`` samples, and ``f`` is
the largest of the three; ``F`` is the mean of ``f`` over the trials.
"""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp
from sympy.logic.boolalg import Boolean

from derivations._claim import Claim
from derivations._derivation import Derivation
from derivations._dimension import Dimension
from derivations._statement import Finding, for_all, identity, there_is, together
from derivations.invariances import math, twist_at_ratio
from derivations.mechanics import d1, d2, mu, rho, theta, v_p

AXES = ("x", "y", "theta")
UNIT_OF = {"x": "m", "y": "m", "theta": "1", "l": "m"}
l_c, k = sp.symbols("l_c k", positive=True)
"""Characteristic length that theta is multiplied with; ratio of two units of length."""


def derive() -> Derivation:
    """Units, zeros and shape of the objective."""
    return Derivation(
        name="fit_objective",
        summary="The objective of the parameter fit (eqs. 3 and 4).",
        claims=(
            _units(),
            _characteristic_length(),
            _zeros(),
            _worst_axis(),
            _nonsmooth(),
        ),
    )


def errors(tag: str) -> tuple[sp.Symbol, ...]:
    """Root mean square errors of a trial along x, y and theta; theta in radians."""
    return sp.symbols(f"r_x{tag} r_y{tag} r_theta{tag}", real=True)


def better(first: Sequence[sp.Expr], second: Sequence[sp.Expr]) -> Boolean:
    """max(first) < max(second), as polynomial relations."""
    return sp.Or(*(sp.And(*(p < q for p in first)) for q in second))


def in_unit(values: Sequence[sp.Expr], theta_is_length: bool) -> list[sp.Expr]:
    """The three errors in a unit of length that is k times smaller."""
    powers = [Dimension.parse(UNIT_OF[axis]).length for axis in AXES]
    if theta_is_length:
        powers[2] += Dimension.parse(UNIT_OF["l"]).length
    return [
        value * k ** sp.Integer(int(power)) for value, power in zip(values, powers, strict=True)
    ]


def _ranking() -> Finding:
    """Whether the ranking of two parameter vectors is the same in every unit of length."""
    first, second = errors("1"), errors("2")
    return for_all(
        "the better of two parameter vectors is the better one in every unit of length, with "
        r"$\theta$ scaled by a length",
        [better(first, second)],
        better(in_unit(first, True), in_unit(second, True)),
    )


def _formula_alone() -> Finding:
    """Without the scaling the ranking depends on the unit."""
    first, second = errors("1"), errors("2")
    um = sp.Rational(1, 10**6)  # in m; k = 10^6 takes m to µm
    values = (5 * um, 0, sp.Rational(1, 1000), 2 * um, 0, sp.Rational(1, 100))
    at = dict(zip((*first, *second), map(sp.sympify, values), strict=True))
    return there_is(
        r"without the scaling: better in metres, worse in micrometres ($k = 10^6$)",
        [better(first, second), better(in_unit(second, False), in_unit(first, False))],
        {**at, k: sp.Integer(10**6)},
    )


def _units() -> Claim:
    """Dimension of f."""
    mixed = [Dimension.parse(UNIT_OF[axis]) for axis in AXES]
    scaled = [*mixed[:2], mixed[2] * Dimension.parse(UNIT_OF["l"])]
    exponent = sp.Symbol("exponent", real=True)
    return Claim(
        key="fit-units",
        title="Eq. (3): a norm over metres and radians",
        place="eq. (3), Section VI",
        printed=r"$f = \|\sqrt{\frac{1}{T}\sum_t (x_i(t) - s_i(p, t))^2}\|_\infty$ “(with $\theta$ "
        "scaled by the characteristic length of the part to normalize)”",
        derived=r"With the sentence in the text the three entries are all lengths and the ranking of "
        r"parameter vectors does not depend on the unit. The formula alone puts the units "
        rf"{', '.join(str(unit) for unit in mixed)} into one maximum: an error of 30 µm would count "
        "as much as one of 0.00003 rad in metres and as 30 rad in micrometres.",
        steps=(
            r"A unit that is $k$ times smaller multiplies lengths by $k$ and leaves radians alone: "
            r"the maximum is multiplied by $k$ only if all entries are lengths.",
            "Witness for the formula alone: errors of 5 µm and 0.001 rad against 2 µm and 0.01 rad; "
            "the first is better in metres, the second in micrometres.",
        ),
        hypotheses=(r"$\theta$ is multiplied by a length before the maximum is taken, as printed",),
        of_print=(
            together(
                "the three entries have one dimension (exponent of length)",
                *(sp.Eq(exponent, sp.Integer(int(unit.length))) for unit in scaled),
            ),
            _ranking(),
        ),
        checks=(_formula_alone(),),
    )


def _characteristic_length() -> Claim:
    """The length is not given, and it matters."""
    first, second = (errors(tag) for tag in "12")
    short, long = sp.symbols("l_short l_long", positive=True)
    values = (30, 20, sp.Rational(35, 2000), 20, 20, sp.Rational(35, 1000))
    at = dict(zip((*first, *second), map(sp.sympify, values), strict=True))
    at |= {short: sp.Integer(837), long: sp.Integer(1616)}

    def scaled(entries: Sequence[sp.Symbol], by: sp.Symbol) -> list[sp.Expr]:
        return [entries[0], entries[1], by * entries[2]]

    middle = {**at, short: sp.Integer(837), long: sp.Integer(1000)}
    switch = values[0] / values[5]
    return Claim(
        key="fit-characteristic-length",
        title="The characteristic length decides which parameters are better",
        place=r"new; eq. (3), “scaled by the characteristic length of the part”",
        derived="The length is not given (the text calls 1 mm the characteristic length of the peg "
        "elsewhere). Errors of 30 µm and 1° against 20 µm and 2°, both within the reported range: "
        "with the short side, 837 µm, the second is better, with 1 mm or the long side, 1616 µm, the "
        rf"first. They change places at {float(switch):.0f} µm. A fit must state the length.",
        steps=(r"$f = \max(r_x, r_y, l_c r_\theta)$ with 1° and 2° as 0.0175 and 0.035 rad.",),
        checks=(
            there_is(
                "second better with 837 µm, first better with 1616 µm",
                [
                    better(scaled(second, short), scaled(first, short)),
                    better(scaled(first, long), scaled(second, long)),
                ],
                at,
            ),
            there_is(
                "first better with 1 mm too",
                [better(scaled(first, long), scaled(second, long))],
                middle,
            ),
        ),
    )


def _zeros() -> Claim:
    """When the objective vanishes."""
    before, error, mean, other = sp.symbols("S e f F", real=True)
    x, y, t_ = sp.symbols("r_x r_y r_theta", real=True)
    known = [x >= 0, y >= 0, t_ >= 0]
    largest = [mean >= x, mean >= y, mean >= l_c * t_]
    attained = sp.Or(sp.Eq(mean, x), sp.Eq(mean, y), sp.Eq(mean, l_c * t_))
    t = sp.Symbol("t", real=True)
    path = t * (1 - t)
    return Claim(
        key="fit-zero",
        title="What a vanishing objective means",
        place="eqs. (3) and (4), Section VI",
        printed=r"$F(p) = \frac{1}{N}\sum_i f(x_i, p)$, the parameter vector “that best explains the "
        "experimental data”",
        derived=r"$f = 0$ exactly if simulated and measured pose agree at all $T$ samples, $F = 0$ "
        "exactly if they do in all trials. It says nothing between the samples, and nothing about "
        r"parameters that do not move the part: $F$ is the same for every $\mu_s$ and every scale of "
        "$E$.",
        steps=(
            r"Adding a square to a sum of squares: the new sum is 0 only if both are; so by "
            r"induction for every $T$, and in the same way for the mean over $N$ trials.",
            "The maximum of three numbers that are not negative is 0 exactly if all are.",
        ),
        of_print=(
            for_all(
                r"one more sample: $S + e^2 = 0$ with $S \ge 0$ means $S = 0$ and $e = 0$",
                [before >= 0, sp.Eq(before + error**2, 0)],
                sp.And(sp.Eq(before, 0), sp.Eq(error, 0)),
            ),
            for_all(
                r"$f = \max(r_x, r_y, l_c r_\theta) = 0$ means that all three are 0",
                [*known, *largest, attained, sp.Eq(mean, 0)],
                sp.And(sp.Eq(x, 0), sp.Eq(y, 0), sp.Eq(t_, 0)),
            ),
            for_all(
                "all three 0 means $f = 0$",
                [*known, *largest, attained, sp.Eq(x, 0), sp.Eq(y, 0), sp.Eq(t_, 0)],
                sp.Eq(mean, 0),
            ),
            for_all(
                r"one more trial: $F + f = 0$ with both not negative means that both are 0",
                [other >= 0, mean >= 0, sp.Eq(other + mean, 0)],
                sp.And(sp.Eq(other, 0), sp.Eq(mean, 0)),
            ),
        ),
        checks=(
            identity(
                "the paths $t(1-t)$ and 0 agree at the sample $t = 0$",
                sp.Subs(path, t, 0),
                sp.Integer(0),
            ),
            identity("and at the sample $t = 1$", sp.Subs(path, t, 1), sp.Integer(0)),
            there_is("but not between", [path > 0], {t: sp.Rational(1, 2)}),
        ),
    )


def _worst_axis() -> Claim:
    """The maximum forgets the other axes."""
    first, second = (errors(tag) for tag in "12")
    scaled = [[e[0], e[1], 1000 * e[2]] for e in (first, second)]
    values = (30, 0, 0, 29, 29, sp.Rational(29, 1000))
    at = dict(zip((*first, *second), map(sp.sympify, values), strict=True))
    return Claim(
        key="fit-worst-axis",
        title="The objective sees the worst axis only",
        place="new; eq. (3)",
        derived=r"A vector that fits two axes exactly and misses one by 30 µm loses against one that "
        r"misses all three by 29 µm. The sum of squares over the axes, scaled by their measurement "
        r"errors, would rank them the other way; with $\pm 5$ µm and $\pm 0.3°$ (Section IX-A) "
        rf"that scaling is a length of {5 / float(sp.rad(sp.Rational(3, 10))):.0f} µm.",
        steps=(r"$\max(30, 0, 0) > \max(29, 29, 29)$, but $30^2 < 3 \cdot 29^2$.",),
        checks=(
            there_is(
                "worse in the maximum, better in the sum of squares (1 mm as the length)",
                [
                    better(scaled[1], scaled[0]),
                    sum(e**2 for e in scaled[0]) < sum(e**2 for e in scaled[1]),
                ],
                at,
            ),
        ),
    )


def turn_rate() -> sp.Expr:
    """Turn per travel of a slipping contact as a function of its coefficient."""
    twist, _ = twist_at_ratio()
    return sp.factor(-twist[2] / v_p)


def _nonsmooth() -> Claim:
    """Kinks and curvature of the motion in its parameters."""
    (tau,) = turn_rate().free_symbols - {d1, d2, rho, theta}
    rate = turn_rate().subs(tau, -mu)  # the tip slips towards smaller d2
    slope = sp.factor(sp.diff(rate, mu))
    expected = -d1 * rho * sp.sin(theta) / (rho + d2**2 - mu * d1 * d2) ** 2
    sticking = (d2 * sp.sin(theta) - d1 * sp.cos(theta)) / (rho + d1**2 + d2**2)
    D = (rho + d2**2) * sp.cos(theta) + d1 * d2 * sp.sin(theta)
    N = d1 * d2 * sp.cos(theta) + (rho + d1**2) * sp.sin(theta)
    r1, r2, target, lever, R = sp.symbols("rho_1 rho_2 kappa ell R", positive=True)
    missed = [target - lever / (value + R**2) for value in (r1, (r1 + r2) / 2, r2)]
    at = {r1: 400_000, r2: 800_000, R: 500, lever: 300, target: sp.Rational(300, 600_000)}
    return Claim(
        key="fit-not-convex-not-smooth",
        title="The motion is neither smooth nor convex in the parameters",
        place="Section VI",
        printed="“the manipulated part's motion is a nonconvex and nonsmooth function of the system "
        "parameters”",
        derived=r"Not smooth: where a contact changes from slip to stick, at $\mu = D/N$, the turn "
        rf"per travel has the slope ${math(expected)}$ in $\mu$ on one side, never 0, and 0 on the "
        r"other. Not convex: the misfit $|\kappa - \ell/(\rho + R^2)|$ of a measured turn rate "
        r"$\kappa$ lies above its chord in $\rho$. Within one mode the motion is smooth, so the "
        "gradient exists there; what forbids plain gradient steps are the changes of mode.",
        steps=(
            r"Slip: $\omega$ from the balance with $\tau = -\mu$; stick: $\omega$ does not depend on "
            r"$\mu$. Both agree at $\mu = D/N$.",
            r"For $\rho$ above the true value the misfit is $\kappa - \ell/(\rho + R^2)$, which is "
            "concave.",
        ),
        hypotheses=("film support, one contact; Section VI uses the three-point model",),
        of_print=(
            identity("slip and stick join where the mode changes", rate.subs(mu, D / N), sticking),
            identity(r"slope of the turn in $\mu$ while slipping", slope, expected),
            for_all(
                "it is not 0",
                [sp.sin(theta) > 0],
                sp.fraction(sp.together(expected))[0] < 0,
            ),
            there_is(
                r"three $\rho$ (µm) at which the turn rate is missed from one side: there the misfit is "
                "without its bars",
                [m >= 0 for m in missed],
                {name: sp.sympify(value) for name, value in at.items()},
            ),
            identity(
                r"the middle one lies above the chord of the others, by half of $\ell (\rho_1 - "
                r"\rho_2)^2 / (p q (p + q))$ with $p = \rho_1 + R^2$, $q = \rho_2 + R^2$",
                2 * missed[1] - missed[0] - missed[2],
                lever * (r1 - r2) ** 2 / ((r1 + R**2) * (r2 + R**2) * (r1 + r2 + 2 * R**2)),
            ),
        ),
    )
