"""Witnesses and certificates as a reader wants them: typeset names, exact and decimal values."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache

import sympy as sp

CIRCLE = re.compile(r"(cos|sin)(?:\((\w+)\)|_(?:\d+_)?(\w+))")
CERTIFICATE = re.compile(
    r"checked exactly: goal(?: \* \((.+?)\))? = (.+?) with (.+) all positive", re.DOTALL
)
NAME = re.compile(r"[A-Za-z_]\w*")
KNOWN = {"cos": sp.cos, "sin": sp.sin, "sqrt": sp.sqrt, "Rational": sp.Rational}


@dataclass(frozen=True, slots=True)
class Value:
    """One line of a witness."""

    name: str
    """LaTeX between dollar signs, or plain text."""
    exact: str
    decimal: str
    """Empty if the exact value is short enough."""


@dataclass(frozen=True, slots=True)
class Certificate:
    """A certificate of positivity; texts hold LaTeX between dollar signs."""

    equation: str
    given: tuple[tuple[str, str], ...]
    """(name, what it stands for)."""


def values(witness: Mapping[str, str]) -> list[Value]:
    """The lines of a witness: first the angles, in degrees beside their cosine and sine."""
    angles: dict[str, dict[str, str]] = {}
    for name in witness:
        if found := CIRCLE.fullmatch(name):
            angles.setdefault(found[2] or found[3], {})[found[1]] = name
    whole = {symbol: point for symbol, point in angles.items() if len(point) == 2}
    lines = [_angle(symbol, point, witness) for symbol, point in whole.items()]
    spent = {name for point in whole.values() for name in point.values()}
    rest = [(name, exact) for name, exact in witness.items() if name not in spent]
    return [*lines, *(Value(_name(name), exact, _decimal(exact)) for name, exact in rest)]


@cache
def certificate(how: str) -> Certificate | None:
    """The certificate in the words of a finding; nothing if they cannot be read.

    Parameters
    ----------
    how
        As written by ``positive_by``, without the name of the route.
    """
    found = CERTIFICATE.fullmatch(how)
    if found is None:
        return None
    multiplier, combination, meanings = found.groups()
    try:
        left = r"\text{goal}" + (rf" \cdot ({_latex(multiplier, 'dot')})" if multiplier else "")
        equation = f"${left} = {_latex(combination, 'dot')}$"
        given = tuple((_name(name), f"${_latex(text)}$") for name, text in _given(meanings))
    except (sp.SympifyError, SyntaxError, TypeError):
        return None
    return Certificate(equation, given)


def _given(meanings: str) -> Iterator[tuple[str, str]]:
    for part in re.split(r", (?=\w+ = )", meanings):
        name, _, text = part.partition(" = ")
        yield name, text


def _latex(text: str, times: str | None = None) -> str:
    names = {name: sp.Symbol(name) for name in re.findall(r"[A-Za-z_]\w*\b(?!\()", text)}
    letters = {symbol: _letter(name) for name, symbol in names.items()}
    expression = sp.sympify(text, locals={**KNOWN, **names})
    return str(sp.latex(expression, symbol_names=letters, mul_symbol=times))


def _letter(name: str) -> str:
    """LaTeX of a name: a letter with its indices, or a word upright."""
    latex = str(sp.latex(sp.Symbol(name)))
    is_word = re.match(r"[A-Za-z]{2}", name) and not latex.startswith("\\")
    return rf"\text{{{name.replace('_', ' ')}}}" if is_word else latex


def _angle(symbol: str, point: Mapping[str, str], witness: Mapping[str, str]) -> Value:
    c, s = witness[point["cos"]], witness[point["sin"]]
    numbers = _number(c), _number(s)
    shown = ""
    if numbers[0] is not None and numbers[1] is not None:
        shown = f"{math.degrees(math.atan2(numbers[1], numbers[0])):.2f}°"
    letter = _letter(symbol)
    return Value(rf"$(\cos {letter}, \sin {letter})$", f"({c}, {s})", shown)


def _name(name: str) -> str:
    found = CIRCLE.fullmatch(name)
    if found:
        return rf"$\{found[1]} {_letter(found[2] or found[3])}$"
    return f"${_letter(name)}$" if NAME.fullmatch(name) else name


def _number(exact: str) -> Fraction | None:
    try:
        return Fraction(exact)
    except ValueError:
        return None


def _decimal(exact: str) -> str:
    number = _number(exact)
    return "" if number is None or number.denominator == 1 else f"{float(number):.6g}"
