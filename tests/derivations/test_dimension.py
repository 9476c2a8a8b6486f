"""Units of expressions, and what is refused before code is generated."""

from __future__ import annotations

import sys
from fractions import Fraction
from importlib import import_module
from inspect import isfunction, signature
from pkgutil import iter_modules
from types import ModuleType

import pytest
import sympy as sp
from hypothesis import given, strategies as st

from derivations import generate
from derivations._derivation import Derivation, Function
from derivations._dimension import NUMBER, UNITS, Dimension, check, require_dyadic, unit_of
from derivations._statement import DerivationError
from derivations.mechanics import d1, d2, e_x, mu, rho, theta, v_p
from tests.strategies import REPEATABLE

METRE = Dimension(length=Fraction(1))
c, s = sp.cos(theta), sp.sin(theta)
powers = st.integers(-3, 3).map(Fraction)
dimensions = st.builds(Dimension, powers, powers, powers)


def function(*results: sp.Expr, unit: str) -> Function:
    arguments = sorted(set().union(*(result.free_symbols for result in results)), key=str)
    return Function(arguments=tuple(arguments), results=results, unit=unit, meaning="a sample")


# -- units as text --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "length", "mass", "time"),
    [
        ("1", 0, 0, 0),
        ("m", 1, 0, 0),
        ("m^2", 2, 0, 0),
        ("1/m", -1, 0, 0),
        ("m/s", 1, 0, -1),
        ("N", 1, 1, -2),
        ("N s/m", 0, 1, -1),
        ("kg m/s^2", 1, 1, -2),
        ("1/m/s", -1, 0, -1),
        ("m^-2 s", -2, 0, 1),
    ],
)
def test_units_are_read(text: str, length: int, mass: int, time: int) -> None:
    assert Dimension.parse(text) == Dimension(Fraction(length), Fraction(mass), Fraction(time))


@pytest.mark.parametrize(
    "text", ["", "um", "m*s", "m/", "/m", "N/m s", "m^", "m^x", "2 m", "m  s", "ms", "m "]
)
def test_other_texts_are_no_units(text: str) -> None:
    with pytest.raises(DerivationError, match="is not of the form"):
        Dimension.parse(text)


@REPEATABLE
@given(dimensions)
def test_what_is_printed_can_be_read(dimension: Dimension) -> None:
    assert Dimension.parse(str(dimension)) == dimension


@REPEATABLE
@given(dimensions, dimensions, st.fractions(-3, 3, max_denominator=4))
def test_powers_and_products_of_units(p: Dimension, q: Dimension, power: Fraction) -> None:
    assert (p * q) ** power == p**power * q**power
    assert p * p ** Fraction(-1) == NUMBER
    assert (p == NUMBER) == (str(p) == "1")


# -- units of expressions -------------------------------------------------------------------------

x, y = sp.symbols("x y", real=True)
IN_METRES = {"x": "m", "y": "m"}


@pytest.mark.parametrize(
    ("expression", "unit"),
    [
        (d1 * d2 * c + (rho + d1**2) * s, "m^2"),
        (-e_x * v_p * (d1 * c - d2 * s) / (rho + d1**2), "N/m"),
        (sp.sqrt(d1**2 + d2**2), "m"),
        (d1**2 / rho, "1"),
        ((rho + d1**2) / sp.sqrt(d1**2 + d2**2) * sp.log(d2 / d1), "m"),
        (sp.atan2(d1, d2) + theta, "1"),
        (sp.atan(d1 / d2), "1"),
        (sp.Max(0, d1, d2), "m"),
        (sp.Abs(d2) - d1, "m"),
        (mu**mu + sp.pi - 3, "1"),
        (2**mu, "1"),
        (sp.Rational(7, 3), "1"),
    ],
)
def test_units_follow_from_those_of_the_symbols(expression: sp.Expr, unit: str) -> None:
    assert unit_of(expression) == Dimension.parse(unit)


@pytest.mark.parametrize(
    ("expression", "message"),
    [
        (
            x + x**2,
            "puts together x in m, x\\*\\*2 in m\\^2|puts together x\\*\\*2 in m\\^2, x in m",
        ),
        (x + 1, "puts together"),
        (sp.cos(theta) * x + y**2, "puts together"),
        (sp.sin(x), r"sin\(x\) needs a number, but x is in m"),
        (sp.log(x), "needs a number"),
        (sp.exp(x / y**2), r"needs a number, but x/y\*\*2 is in m\^-1"),
        (2**x, "needs a number, but x is in m"),
        (x**theta, "needs a number, but x is in m"),
        (sp.atan2(x, y**2), "puts together"),
        (sp.Max(x, y**2), "puts together"),
        (sp.sqrt(x) + y, r"sqrt\(x\) in m\^1/2"),
        (sp.Function("f")(x), "no rule for"),
        (sp.Derivative(x * sp.Function("f")(x), x), "no rule for"),
        (x + sp.Symbol("z"), "z has no unit: add it to derivations._dimension._NAMES"),
    ],
)
def test_what_does_not_fit_is_refused(expression: sp.Expr, message: str) -> None:
    with pytest.raises(DerivationError, match=message):
        unit_of(expression, {**IN_METRES, "theta": "1"})


@pytest.mark.parametrize("exponent", [Fraction(1, 2), Fraction(-3, 2), Fraction(4)])
def test_rescaling_gives_the_same_exponent(exponent: Fraction) -> None:
    """Another route: with the metre a factor smaller, a value in m^k grows by factor^k."""
    power = sp.Rational(exponent.numerator, exponent.denominator)
    expression = (x**2 + x * y) ** (power / 2) * sp.cos(x / y)
    value, scaled = (expression.subs({x: 3 * k, y: 5 * k}) for k in (1, 7))
    found = unit_of(expression, IN_METRES)
    assert sp.simplify(scaled / value - 7 ** sp.sympify(str(found.length))) == 0
    assert found == METRE**exponent


# -- functions ------------------------------------------------------------------------------------


def test_a_function_with_the_declared_unit_passes() -> None:
    check(function(d1 * c + d2 * s, d1 - d2, unit="m"))
    check(function(sp.Integer(0), rho - d1 * d2, unit="m^2"))


@pytest.mark.parametrize(
    ("sample", "message"),
    [
        (function(d1 * d2, unit="m"), r"margin: d1\*d2 is in m\^2; declared is m$"),
        (function(d1, d1 * d2, unit="m"), r"margin: d1\*d2 is in m\^2; declared is m$"),
        (function(c / d1, s, unit="1/m"), r"margin: sin\(theta\) is in 1; declared is m\^-1$"),
        (function(d1, unit="metres"), "margin: unit 'metres' is not of the form"),
        (function(rho - d1, unit="m^2"), "margin: .* puts together"),
        (function(sp.Symbol("new") * d1, unit="m"), "margin: new has no unit"),
    ],
)
def test_a_function_with_another_unit_is_refused(sample: Function, message: str) -> None:
    with pytest.raises(DerivationError, match=message):
        check(sample, "margin")


def test_an_argument_that_enters_no_result_needs_a_unit_too() -> None:
    idle = Function(arguments=(d1, sp.Symbol("new")), results=(d1,), unit="m", meaning="idle one")
    with pytest.raises(DerivationError, match="idle one: new has no unit"):
        check(idle)


# -- constants ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "expression",
    [x / 2, 3 * x**2 / 4 - 7, sp.sqrt(x) / 1024, -x, x ** sp.Rational(-3, 2), 2**40 + x],
)
def test_small_dyadic_constants_pass(expression: sp.Expr) -> None:
    require_dyadic(expression)


@pytest.mark.parametrize(
    ("expression", "constant"),
    [
        (x / 3, "1/3"),
        (sp.sin(x + sp.Rational(1, 10)), "1/10"),
        (0.5 * x, "0.50*"),
        (sp.pi * x, "pi"),
        (sp.sqrt(2) * x, r"sqrt\(2\)"),
        (x + sp.log(2), r"log\(2\)"),
        (x ** sp.Rational(1, 3), "1/3"),
        (x / 2048, "1/2048"),
        (x + 2**40 + 1, str(2**40 + 1)),
        (sp.oo + sp.I * x, "oo|I"),
    ],
)
def test_other_constants_are_refused(expression: sp.Expr, constant: str) -> None:
    with pytest.raises(DerivationError, match=rf"the constant ({constant}) is no small dyadic"):
        require_dyadic(expression)


# -- the functions of the package -------------------------------------------------------------------


def generated() -> dict[str, tuple[sp.Expr, ...]]:
    """Results of all generated functions, read back from the code, by ``module.name``."""
    code = import_module("meso_robust._generated").__path__
    return {
        f"{module.name}.{name}": one(sp, *map(sp.Symbol, [*signature(one).parameters][1:]))
        for module in iter_modules(code)
        for name, one in vars(import_module(f"meso_robust._generated.{module.name}")).items()
        if isfunction(one)
    }


def test_the_code_has_a_dimension_throughout() -> None:
    results = generated()
    assert len(results) >= 24
    for expressions in results.values():
        assert all(isinstance(unit_of(expression), Dimension) for expression in expressions)
    assert list(map(unit_of, results["two_sided_rotation.no_jam"])) == [METRE ** Fraction(2)]


def test_a_length_taken_for_a_number_is_noticed() -> None:
    without = {**UNITS, "d1": "1"}
    concerned = [
        expressions
        for expressions in generated().values()
        if any(sp.Symbol("d1") in expression.free_symbols for expression in expressions)
    ]
    assert len(concerned) >= 20
    for expressions in concerned:
        try:
            assert [unit_of(e, without) for e in expressions] != list(map(unit_of, expressions))
        except DerivationError:
            continue


def test_the_code_has_the_units_that_the_derivations_declare(
    derived: tuple[Derivation, ...],
) -> None:
    declared = {
        f"{derivation.name}.{name}": Dimension.parse(function.unit)
        for derivation in derived
        for name, function in derivation.functions.items()
    }
    found = generated()
    assert set(found) == set(declared)
    for name, expressions in found.items():
        assert {unit_of(e) for e in expressions if e != 0} <= {declared[name]}, name


@pytest.mark.parametrize(
    ("sample", "message"),
    [
        (function(d1 * d2, unit="m"), r"sample\.margin: d1\*d2 is in m\^2; declared is m$"),
        (function(d1 / 3, unit="m"), "the constant 1/3 is no small dyadic number"),
    ],
)
def test_code_is_generated_of_checked_functions_only(
    sample: Function, message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = ModuleType("derivations.sample")
    contents = Derivation(name="sample", summary="", claims=(), functions={"margin": sample})
    monkeypatch.setattr(module, "derive", lambda: contents, raising=False)
    monkeypatch.setitem(sys.modules, module.__name__, module)
    with pytest.raises(DerivationError, match=message):
        generate.derive_one("sample")
