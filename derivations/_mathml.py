"""Generated functions as MathML, for the pages that show what was proved."""

from __future__ import annotations

import inspect
from typing import Any

import sympy as sp
from sympy.printing.mathml import mathml

LETTERS = {"dx": "delta_x", "dy": "delta_y", "side": "s", "half": "l"}
"""Symbols for arguments of several letters; the pages say so."""


def positive(code: str, name: str) -> list[str]:
    """That each value of a generated function is positive.

    Parameters
    ----------
    code
        The generated module. Its function is run on symbols instead of intervals, so that a page
        cannot say anything else than what was proved.
    name
        The function.

    Returns
    -------
    list
        A ``<math>`` element a value.
    """
    space: dict[str, Any] = {}
    exec(compile(code, name, "exec"), space)
    names = list(inspect.signature(space[name]).parameters)[1:]
    symbols = {name: sp.Symbol(LETTERS.get(name, name), positive=True) for name in names}
    turns = [of(symbols["theta"]) for of in (sp.sin, sp.cos) if "theta" in symbols]
    values = [sp.nsimplify(value) for value in space[name](sp, *symbols.values())]
    collected = (sp.collect(sp.expand(value), turns) if turns else value for value in values)
    return [_element(value) for value in collected]


def _element(value: sp.Expr) -> str:
    text = mathml(value, printer="presentation")
    for plain, sign in (("&InvisibleTimes;", "&#8290;"), ("<mo>-</mo>", "<mo>−</mo>")):
        text = text.replace(plain, sign)
    return f"<math><mrow>{text}<mo>&gt;</mo><mn>0</mn></mrow></math>"
