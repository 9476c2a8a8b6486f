"""Balls hold exact values, at the precision asked for, from arguments meant exactly."""

from __future__ import annotations

import ast
import subprocess
import sys
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from flint import arb, ctx
from hypothesis import given, strategies as st

from meso_robust.campaigns.property.laws.routes import NAMES
from meso_robust.conditions import balls
from meso_robust.conditions.ball import _off_zero
from meso_robust.conditions.formula import formula, inputs
from tests.conditions.functions import source_of
from tests.strategies import REPEATABLE

RATIONAL = [
    ("two_sided_rotation", "no_jam"),
    ("one_point_sticking", "only_solution"),
]
"""Formulas of sums and products only: Python's fractions evaluate them exactly."""

fractions = st.fractions(-100, 100, max_denominator=10**9)
LARGEST_TERM = 4 * 100**4


def exactly(number: arb) -> Fraction:
    """A ball of radius 0 as a fraction."""
    mantissa, exponent = number.man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def holds(ball: arb, value: Fraction) -> bool:
    """Whether the ball holds the value, decided in fractions: Arb would round the value first."""
    return abs(value - exactly(ball.mid())) <= exactly(ball.rad())


@pytest.mark.parametrize(("module", "name"), RATIONAL)
@REPEATABLE
@given(st.lists(fractions, min_size=4, max_size=4), st.integers(20, 300))
def test_a_ball_holds_the_exact_value(
    module: str, name: str, numbers: list[Fraction], bits: int
) -> None:
    point = dict(zip(inputs(module, name), numbers, strict=False))
    expected = formula(module, name)(None, **point)
    for ball, value in zip(balls(module, name)(**point, bits=bits), expected, strict=True):
        assert holds(ball, value)
        assert exactly(ball.rad()) <= LARGEST_TERM * Fraction(2) ** (6 - bits)


@pytest.mark.parametrize(
    ("given_", "meant"),
    [
        ("0.1", Fraction(1, 10)),
        ("1e-3", Fraction(1, 1000)),
        ("-7/3", Fraction(-7, 3)),
        (0.1, Fraction(0.1)),
        (np.float64(0.1), Fraction(0.1)),
        (Fraction(1, 3), Fraction(1, 3)),
        (Decimal("0.3"), Fraction(3, 10)),
        (3**200, Fraction(3**200)),
        (np.int64(7), Fraction(7)),
        (arb(0.75), Fraction(3, 4)),
    ],
)
def test_arguments_are_meant_exactly(given_: str, meant: Fraction) -> None:
    (ball,) = balls("two_sided_rotation", "no_jam")(V=given_, d1=0, mu=0, bits=200)
    assert holds(ball, meant**2)
    assert exactly(ball.rad()) <= meant**2 / 2**190


@pytest.mark.parametrize("wrong", ["0.1 +/- 1", "x", None, "nan"])
def test_other_arguments_are_refused(wrong: str) -> None:
    with pytest.raises((TypeError, ValueError)):
        balls("two_sided_rotation", "no_jam")(V=wrong, d1=0, mu=0)


def test_the_precision_is_given_back_after_a_result_and_after_an_error() -> None:
    before = ctx.prec
    no_jam = balls("two_sided_rotation", "no_jam")
    no_jam(V=1, d1=1, mu=1, bits=300)
    assert ctx.prec == before
    with pytest.raises(TypeError, match="missing"):
        no_jam(V=1, bits=300)
    assert ctx.prec == before


@REPEATABLE
@given(st.floats(1e-6, 1e3), st.fractions(-1, 1))
def test_an_argument_centred_at_zero_has_powers(radius: float, part: Fraction) -> None:
    only = balls("one_point_sticking", "only_solution")
    point = part * Fraction(radius)
    for ball, value in zip(
        only(d1=1, d2=arb(0, radius), rho=1, mu=1),
        (1 + point**2 - point, 1 + point**2 + point),
        strict=True,
    ):
        assert holds(ball, value)
        assert ball.rad() <= 1.001 * (radius + radius**2)


@REPEATABLE
@given(st.floats(1e-300, 1e300))
def test_an_argument_centred_at_zero_keeps_its_ends(radius: float) -> None:
    whole = arb(0, radius)
    moved, end = _off_zero(whole), exactly(whole.rad())
    assert moved.mid() != 0
    assert holds(moved, end)
    assert holds(moved, -end)
    assert exactly(moved.rad()) <= end * (1 + Fraction(1, 10**5))


def test_a_ball_where_the_formula_is_undefined_is_not_finite() -> None:
    pair = balls("two_sided_rotation", "pair")
    for V in (1, arb(2, 0.1)):
        assert not pair(h=0, V=V, d1=1)[0].is_finite()
    assert pair(h=0, V=arb(3, 0.1), d1=1)[0].is_finite()
    assert not balls("sticking_motion", "contact_offset")(theta=0, d1=1, rise=1)[0].is_finite()


# -- constants of the generated code --------------------------------------------------------------


def rounded_constants(source: str) -> list[str]:
    """Constants of a formula that a double does not hold exactly: quotients, and decimals."""
    parts = [part for line in ast.parse(source).body for part in ast.walk(line)]
    found = [
        ast.unparse(part)
        for part in parts
        if isinstance(part, ast.BinOp)
        and not any(isinstance(leaf, ast.Name) for leaf in ast.walk(part))
        and Fraction(eval(ast.unparse(part))) != quotient(part)
    ]
    return found + [
        repr(part.value)
        for part in parts
        if isinstance(part, ast.Constant) and isinstance(part.value, float | complex)
    ]


def quotient(node: ast.BinOp) -> Fraction:
    assert isinstance(node.op, ast.Div)
    top, bottom = (Fraction(ast.literal_eval(part)) for part in (node.left, node.right))
    return top / bottom


@pytest.mark.parametrize(("module", "name"), NAMES, ids=map(".".join, NAMES))
def test_the_code_holds_no_rounded_constant(module: str, name: str) -> None:
    assert rounded_constants(source_of(module, name)) == []


def test_a_rounded_constant_would_be_noticed() -> None:
    assert rounded_constants("y = 1/2*x - 3/4*x**2") == []
    assert rounded_constants("y = -1/3*x + x**(1/5)") == ["-1 / 3", "1 / 5"]
    assert rounded_constants("y = 0.1*x") == ["0.1"]


# -- imports --------------------------------------------------------------------------------------


def test_arrays_and_balls_need_no_casadi() -> None:
    program = (
        "import sys\n"
        "from meso_robust.conditions import balls, values\n"
        "assert 'flint' not in sys.modules\n"
        "values('two_sided_rotation', 'no_jam')(V=1.0, d1=1.0, mu=1.0)\n"
        "balls('two_sided_rotation', 'no_jam')(V=1.0, d1=1.0, mu=1.0)\n"
        "assert not {'casadi', 'numba'} & set(sys.modules), 'heavy imports'\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
