"""Printed equations and generated functions against force balances solved in exact rationals."""

from __future__ import annotations

from fractions import Fraction
from functools import cache

import pytest
import sympy as sp

from derivations.mechanics import d1, d2, d4, e_x, rho, theta, v_p
from derivations.one_point_sticking import solve_sticking
from derivations.two_point_sticking import solve_two_points
from meso_robust._generated import (
    one_point_sticking,
    sticking_motion,
    two_point_sticking,
    two_sided_rotation,
    y_translation,
)
from tests.derivations.exact import (
    Vector,
    arithmetic,
    balance_rows,
    dot,
    force_column,
    moment,
    plus,
    solve,
    velocity_row,
)

C, S = Fraction(3, 5), Fraction(4, 5)
A: Vector = (C, S)  # along the edge
N: Vector = (S, -C)  # outward normal of the pushed edge
INWARD: Vector = (-S, C)
DEPTH, RHO, DRAG, SPEED = Fraction(2), Fraction(7, 2), Fraction(5, 3), Fraction(-3, 4)
ANY = Fraction(0)  # stands for theta: the arithmetic knows its cosine and sine
OPS = arithmetic(C, S)
OFFSETS = [Fraction(1, 3), Fraction(-5, 4), Fraction(0)]


def one_point(offset: Fraction) -> list[Fraction]:
    """v_x, v_y, omega, lambda_n, lambda_t while the contact moves with the tip, by elimination."""
    arm = plus((offset, A), (DEPTH, N))
    rows = balance_rows(DRAG, RHO, [force_column(arm, INWARD), force_column(arm, A)])
    zero = [Fraction(0)] * 2
    rows += [velocity_row(arm, axis) + zero for axis in ((1, 0), (0, 1))]  # type: ignore[arg-type]
    return solve(rows, [*[Fraction(0)] * 3, SPEED, Fraction(0)])


@pytest.mark.parametrize("offset", OFFSETS)
def test_equation_5_as_printed(offset: Fraction) -> None:
    *_, omega, force_n, force_t = one_point(offset)
    F = RHO + DEPTH**2 + offset**2
    normal = DEPTH * offset * C + (RHO + DEPTH**2) * S
    tangential = (RHO + offset**2) * C + DEPTH * offset * S
    assert force_n == -DRAG * SPEED * normal / F
    assert abs(force_t) == abs(DRAG * SPEED * tangential / F)
    assert omega == SPEED * (DEPTH * C - offset * S) / F


@pytest.mark.parametrize("offset", OFFSETS)
def test_derived_sticking_solution_by_hand(offset: Fraction) -> None:
    at = {
        d1: sp.Rational(2),
        d2: sp.Rational(offset.numerator, offset.denominator),
        rho: sp.Rational(7, 2),
        e_x: sp.Rational(5, 3),
        v_p: sp.Rational(-3, 4),
        sp.cos(theta): sp.Rational(3, 5),
        sp.sin(theta): sp.Rational(4, 5),
    }
    derived = [expression.subs(at) for expression in _solved()]
    assert [Fraction(int(x.p), int(x.q)) for x in derived] == one_point(offset)


@cache
def _solved() -> tuple[sp.Expr, ...]:
    """Written in cos and sin of theta itself, so that rational values can be put in."""
    solved = solve_sticking()
    values = (*solved.twist, solved.normal, solved.tangential)
    return tuple(sp.expand_trig(sp.expand(value)) for value in values)


@pytest.mark.parametrize("offset", OFFSETS)
def test_generated_one_point_functions_by_hand(offset: Fraction) -> None:
    *_, omega, force_n, force_t = one_point(offset)
    F = RHO + DEPTH**2 + offset**2
    scale = -DRAG * SPEED / F
    mu = Fraction(1, 3)
    assert one_point_sticking.normal_force(OPS, ANY, DEPTH, offset, RHO) == (force_n / scale,)
    assert one_point_sticking.friction_margin(OPS, ANY, DEPTH, offset, RHO, mu) == (
        (mu * force_n - force_t) / scale,
        (mu * force_n + force_t) / scale,
    )
    assert one_point_sticking.stick_ratio(OPS, ANY, DEPTH, offset, RHO) == (force_t / force_n,)
    for side in (Fraction(1), Fraction(-1)):  # travel is positive along -x
        turning = side * F * omega / -SPEED
        assert one_point_sticking.turning(OPS, ANY, DEPTH, offset, side) == (turning,)


@pytest.mark.parametrize("offset", OFFSETS)
def test_slope_of_the_travel_in_the_offset_by_hand(offset: Fraction) -> None:
    def slowness(at: Fraction) -> Fraction:  # travel per turn
        return -SPEED / one_point(at)[2]

    step = Fraction(1, 10**9)
    slope = (slowness(offset + step) - slowness(offset - step)) / (2 * step)
    lever = offset * S - DEPTH * C
    (shortening,) = sticking_motion.shortening(OPS, ANY, DEPTH, offset, RHO)
    assert float(slope) == pytest.approx(float(-shortening / lever**2), rel=1e-9)


@pytest.mark.parametrize("offset", [Fraction(1, 3), Fraction(5, 2)])
def test_equation_9_by_hand(offset: Fraction) -> None:
    """Edge at angle pi/2 + beta with cos beta = 4/5, sin beta = 3/5."""
    cos_b, sin_b, spacing = S, C, Fraction(7)
    along, out = (-sin_b, cos_b), (cos_b, sin_b)
    inward = (-cos_b, -sin_b)
    first = plus((offset, along), (DEPTH, out))
    second = plus((offset - spacing / cos_b, along), (DEPTH, out))
    assert first[1] - second[1] == spacing
    # unknowns: both normal forces and the summed shear; the part moves with the probe
    columns = [
        force_column(first, inward),
        force_column(second, inward),
        force_column(first, along),
    ]
    rows = [[column[k] for column in columns] for k in range(3)]
    force_1, force_2, shear = solve(rows, [DRAG * SPEED, Fraction(0), Fraction(0)])
    lever = DEPTH * sin_b + offset * cos_b
    assert force_1 == DRAG * SPEED * cos_b * (lever - spacing) / spacing
    assert force_2 == -DRAG * SPEED * cos_b * lever / spacing
    assert abs((force_1 + force_2) / shear) == cos_b / sin_b

    ops = arithmetic(cos_b, sin_b)
    scale = spacing / (-DRAG * SPEED * cos_b)
    found = two_point_sticking.normal_forces(ops, ANY, DEPTH, offset, spacing)
    assert found == (force_1 * scale, force_2 * scale)
    mu, drag = Fraction(1, 2), -DRAG * SPEED
    assert set(two_point_sticking.friction_margin(ops, ANY, mu)) == {
        (mu * (force_1 + force_2) - shear) / drag,
        (mu * (force_1 + force_2) + shear) / drag,
    }
    at = {d1: 2, d2: sp.Rational(offset.numerator, offset.denominator), d4: 7}
    at |= {e_x: sp.Rational(5, 3), v_p: sp.Rational(-3, 4)}
    beta = sp.atan2(3, 4)
    derived = [sp.simplify(f.subs(at).subs(sp.Symbol("beta", real=True), beta)) for f in _pair()]
    assert [Fraction(int(x.p), int(x.q)) for x in derived] == [force_1, force_2, shear]


@cache
def _pair() -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    return solve_two_points()


def two_sided(
    t_D: Fraction, t_S: Fraction, sigma: Fraction, length: Fraction
) -> tuple[list[Fraction], Vector, Vector, Vector]:
    """Twist and normal forces (e_x = 1, D at unit speed along -x) at given friction ratios."""
    along, out = (-C, S), (S, C)  # past upright
    inward = (-out[0], -out[1])
    at_D = plus((length / 2 - sigma, along), (DEPTH, out))
    at_S = plus((-length / 2 - sigma, along), (DEPTH, inward))
    rows = balance_rows(
        Fraction(1),
        RHO,
        [
            force_column(at_D, plus((Fraction(1), inward), (t_D, along))),
            force_column(at_S, plus((Fraction(1), out), (t_S, along))),
        ],
    )
    rows.append([*velocity_row(at_D, out), Fraction(0), Fraction(0)])
    rows.append([*velocity_row(at_S, out), Fraction(0), Fraction(0)])
    solved = solve(rows, [*[Fraction(0)] * 3, -out[0], Fraction(0)])
    return solved, along, at_D, at_S


@pytest.mark.parametrize("sigma", [Fraction(0), Fraction(1, 2), Fraction(-2, 3)])
def test_two_sided_rotation_by_hand(sigma: Fraction) -> None:
    length, mu = Fraction(5), Fraction(1, 4)
    along, out = (-C, S), (S, C)
    h, V = plus((length, along), (2 * DEPTH, out))
    ops = arithmetic(-C, S)
    assert two_sided_rotation.orientation(ops, h, V, DEPTH) == (-C, S)
    assert two_sided_rotation.pair(ops, h, V, DEPTH) == (length,)
    assert two_sided_rotation.pair_position(ops, ANY, V, DEPTH) == (h,)
    rates: list[float] = []
    for t_D in (-mu, mu):
        for t_S in (-mu, mu):
            (v_x, v_y, omega, _, force_S), *_ = two_sided(t_D, t_S, sigma, length)
            # sigma = (centre - middle of the tips) . a; a turns with omega towards -n
            centre_less_middle = (v_x + Fraction(1, 2), v_y)
            rates.append(float(dot(centre_less_middle, along)))
            assert omega == S / length
            (found,) = two_sided_rotation.passive_force(ops, h, V, DEPTH, sigma, RHO, t_D, t_S)
            assert found == pytest.approx(float(force_S), rel=1e-13)  # 1/2 is a float in code
    *found_rates, half_T_rate = two_sided_rotation.slide_rates(ops, h, V, DEPTH, sigma, RHO, mu)
    assert found_rates == pytest.approx(rates, rel=1e-13)
    assert half_T_rate == pytest.approx(float(-h / (2 * length)), rel=1e-13)


@pytest.mark.parametrize("ratio", [Fraction(0), Fraction(1, 3), Fraction(-1, 5)])
def test_one_contact_with_given_friction_ratio_by_hand(ratio: Fraction) -> None:
    offset, far = Fraction(3, 2), Fraction(-7, 4)
    arm = plus((offset, A), (DEPTH, N))
    rows = balance_rows(
        Fraction(1), RHO, [force_column(arm, plus((Fraction(1), INWARD), (ratio, A)))]
    )
    rows.append([*velocity_row(arm, N), Fraction(0)])
    *twist, _ = solve(rows, [Fraction(0), Fraction(0), Fraction(0), -N[0]])
    at = (OPS, ANY, DEPTH, offset, RHO, ratio)
    found = (
        *two_sided_rotation.one_contact_motion(*at),
        *two_sided_rotation.one_contact_turning(*at),
    )
    assert list(found) == twist
    far_arm = plus((far, A), (DEPTH, INWARD))  # the point of the far edge in front of S
    towards_S = velocity_row(far_arm, INWARD)
    speed = sum((k * v for k, v in zip(towards_S, twist, strict=True)), Fraction(0))
    assert two_sided_rotation.closing(OPS, ANY, DEPTH, offset, far, RHO, ratio) == (speed,)


def test_contact_geometry_by_hand() -> None:
    offset = Fraction(4, 3)
    point = plus((offset, A), (DEPTH, N))
    assert sticking_motion.arm(OPS, ANY, DEPTH, offset) == point
    assert sticking_motion.contact_offset(OPS, ANY, DEPTH, point[1]) == (offset,)
    assert sticking_motion.contact_reach(OPS, ANY, DEPTH, point[1]) == (point[0],)
    away = plus((Fraction(1), point), (Fraction(5, 7), N))
    assert sticking_motion.clearance(OPS, ANY, DEPTH, *away) == (Fraction(5, 7),)
    half, gap = Fraction(3), plus((Fraction(2), A), (Fraction(1, 9), N))
    assert sticking_motion.beside(OPS, ANY, offset, half, *gap, Fraction(1)) == (
        Fraction(1, 9),
        offset + 2 - half,
    )
    assert sticking_motion.beside(OPS, ANY, offset, half, *gap, Fraction(-1))[1] == (
        -offset - 2 - half
    )
    assert moment(point, INWARD) == offset  # a unit push turns with lever d2


def test_rise_over_tilt_and_straightening_by_hand() -> None:
    """From upright to cos = -3/5, sin = 4/5 about one offset, back about another."""
    angles = {0: (Fraction(0), Fraction(1)), 1: (-C, S), 2: (Fraction(0), Fraction(1))}

    class Angles:
        def cos(self, k: int) -> Fraction:
            return angles[k][0]

        def sin(self, k: int) -> Fraction:
            return angles[k][1]

    def height(offset: Fraction, k: int) -> Fraction:
        c, s = angles[k]
        return plus((offset, (c, s)), (DEPTH, (s, -c)))[1]

    there, back = Fraction(3, 2), Fraction(-1, 4)
    rise = (height(there, 0) - height(there, 1)) + (height(back, 1) - height(back, 2))
    assert y_translation.gain(Angles(), 0, 1, 2, DEPTH, there, back) == (rise,)
    assert rise == (there - back) * (1 - S)  # l_AB (1 - cos phi) with phi the tilt
    tilt = height(there, 0) - height(there, 1)
    assert sticking_motion.lift(Angles(), 0, 1, DEPTH, there) == (tilt,)
