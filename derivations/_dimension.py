"""What must hold of a formula before code is generated from it: units that fit, exact constants."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from operator import mul

import sympy as sp

from derivations._derivation import Function
from derivations._statement import DerivationError

_NAMES = {
    "1": "theta theta_0 theta_1 theta_2 theta_start theta_end beta mu tau tau_D tau_S side "
    "direction exterior stretch shear bend f_x f_y c s kappa mu_D mu_S mu_w phi psi total",
    "m": "d1 d2 d2_back d4 h V T sigma p_S rise dx dy half x0 y0 x1 y1 x_1 y_1 x_2 y_2 x_3 y_3 "
    "r r_upper r_lower spacing gap d1_next rounding x y x_f y_f "
    "q W creep p_D d_D d_S r_D r_S p b engaged drag_a drag_n width radii room clear",
    "1/m": "omega",
    "m^2": "rho",
    "N s/m": "e_x",
    "m/s": "v_p",
}
UNITS = {name: unit for unit, names in _NAMES.items() for name in names.split()}
"""Unit of every symbol that may be an argument of a generated function."""

PURE = (
    *(sp.sin, sp.cos, sp.tan, sp.asin, sp.acos, sp.atan, sp.exp, sp.log),
    *(sp.sinh, sp.cosh, sp.tanh, sp.asinh, sp.acosh, sp.atanh),
)
"""Functions from numbers to numbers."""

_FACTOR = r"(m|kg|s|N|1)(?:\^(-?\d+))?"


@dataclass(frozen=True, slots=True)
class Dimension:
    """Exponents of the base units m, kg and s.

    Examples
    --------
    >>> print(Dimension.parse("N s/m"))
    kg s^-1
    """

    length: Fraction = Fraction(0)
    mass: Fraction = Fraction(0)
    time: Fraction = Fraction(0)

    @classmethod
    def parse(cls, unit: str) -> Dimension:
        """Read powers of m, kg, s, N and 1: multiplied with blanks, then divided with slashes.

        Raises
        ------
        DerivationError
            If the unit is written in another way.
        """
        if not re.fullmatch(rf"{_FACTOR}( {_FACTOR})*(/{_FACTOR})*", unit):
            raise DerivationError(f"unit {unit!r} is not of the form 'm^2', '1/m' or 'N s/m'")
        product = NUMBER
        for separator, name, power in re.findall(rf"([ /]?){_FACTOR}", unit):
            product *= _BASE[name] ** (Fraction(power or 1) * (-1 if separator == "/" else 1))
        return product

    def __mul__(self, other: Dimension) -> Dimension:
        """Of a product."""
        return Dimension(self.length + other.length, self.mass + other.mass, self.time + other.time)

    def __pow__(self, exponent: Fraction) -> Dimension:
        """Of a power."""
        return Dimension(self.length * exponent, self.mass * exponent, self.time * exponent)

    def __str__(self) -> str:
        """In base units, as :meth:`parse` reads them."""
        powers = {"kg": self.mass, "m": self.length, "s": self.time}
        shown = (unit if k == 1 else f"{unit}^{k}" for unit, k in powers.items() if k)
        return " ".join(shown) or "1"


NUMBER = Dimension()
_BASE = {
    "1": NUMBER,
    "m": Dimension(length=Fraction(1)),
    "kg": Dimension(mass=Fraction(1)),
    "s": Dimension(time=Fraction(1)),
    "N": Dimension(Fraction(1), Fraction(1), Fraction(-2)),
}


def check(function: Function, name: str = "") -> None:
    """Stop unless every result of a function has the unit that is declared for it.

    Parameters
    ----------
    function
        What is to be generated.
    name
        For the message; the function's meaning stands in for it.

    Raises
    ------
    DerivationError
        Names the function, the expression and both dimensions.
    """
    try:
        declared = Dimension.parse(function.unit)
        for argument in function.arguments:
            unit_of(argument)
        for result in function.results:
            found = unit_of(result)
            if not (result == 0 or found == declared):
                raise DerivationError(f"{result} is in {found}; declared is {declared}")
    except DerivationError as error:
        raise DerivationError(f"{name or function.meaning}: {error}") from None


def unit_of(expression: sp.Expr, units: Mapping[str, str] = UNITS) -> Dimension:
    """Dimension of an expression.

    Parameters
    ----------
    expression
        Sums, products, powers and elementary functions of symbols and numbers.
    units
        Unit of every symbol, by its name.

    Raises
    ------
    DerivationError
        If dimensions do not fit together, or that of a part is not known.
    """
    if expression.is_number:
        return NUMBER
    if expression.is_Symbol:
        _require(str(expression) in units, f"{expression} has no unit: add it to {__name__}._NAMES")
        return Dimension.parse(units[str(expression)])
    parts = [unit_of(part, units) for part in expression.args]
    if expression.is_Mul:
        return reduce(mul, parts)
    if expression.is_Pow and expression.exp.is_Rational:
        return parts[0] ** Fraction(int(expression.exp.p), int(expression.exp.q))
    if isinstance(expression, sp.Add | sp.Max | sp.Min | sp.Abs | sp.atan2):
        common = _common(expression, parts)
        return NUMBER if isinstance(expression, sp.atan2) else common
    if not (expression.is_Pow or isinstance(expression, PURE)):
        raise DerivationError(f"no rule for {expression}")
    for part, unit in zip(expression.args, parts, strict=True):
        if unit != NUMBER:
            raise DerivationError(f"{expression} needs a number, but {part} is in {unit}")
    return NUMBER


def require_dyadic(expression: sp.Expr) -> None:
    """Stop unless every constant is a small dyadic number, which a double holds exactly.

    Generated code is evaluated with error bounds; a rounded constant would make them bounds on
    another formula.

    Raises
    ------
    DerivationError
        Names the constant.
    """
    for part in sp.preorder_traversal(expression):
        if part.is_number:
            exact = part.is_Rational and 1024 % part.q == 0 and abs(part) <= 2**40
            if not exact:  # printing a large expression takes longer than checking it
                raise DerivationError(
                    f"{expression}: the constant {part} is no small dyadic number"
                )


def _common(expression: sp.Expr, parts: list[Dimension]) -> Dimension:
    """The one dimension of all arguments; 0 fits every dimension."""
    found = {unit: part for part, unit in zip(expression.args, parts, strict=True) if part != 0}
    shown = ", ".join(f"{part} in {unit}" for unit, part in found.items())
    _require(len(found) == 1, f"{expression} puts together {shown}")
    return next(iter(found))


def _require(fits: bool, message: str) -> None:
    if not fits:
        raise DerivationError(message)
