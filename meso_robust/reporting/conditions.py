"""The conditions of a proof as formulas, each with where it is derived.

A formula is that of the generated code that was bounded: its functions are run on symbols instead of
intervals, so that the page cannot say anything else than what was proved.
"""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import Any

from markupsafe import Markup

_LONGEST = 2200  # characters of MathML that still stand in one row of a table


@dataclass(frozen=True, slots=True, kw_only=True)
class Condition:
    """A generated function that has to be positive."""

    name: str
    anchor: str
    """Of its derivation, in the page."""
    module: str
    """What the file that derives it is about."""
    file: str
    meaning: str
    formulas: tuple[Markup, ...]
    """MathML of each value."""

    @property
    def short(self) -> tuple[Markup, ...]:
        """The formulas, if they are short enough to stand in a row of a table."""
        return self.formulas if sum(map(len, self.formulas)) < _LONGEST else ()


def condition(inequality: str) -> Condition | None:
    """The function that an inequality of a certificate is about; None if it is about none.

    Parameters
    ----------
    inequality
        As a certificate names it: ``module.function``, or a name without a dot.
    """
    module, dot, name = inequality.partition(".")
    return _condition(module, name) if dot else None


def conditions(inequalities: Iterable[str]) -> tuple[Condition, ...]:
    """All functions that some inequalities are about, each once, in their order."""
    named = {item.name: item for one in inequalities if (item := condition(one)) is not None}
    return tuple(named.values())


@cache
def _condition(module: str, name: str) -> Condition | None:
    try:
        source = importlib.import_module(f"meso_robust._generated.{module}")
        function = getattr(source, name)
    except (ImportError, AttributeError):
        return None
    said = inspect.getdoc(function) or ""
    return Condition(
        name=f"{module}.{name}",
        anchor=f"derivation-{module}-{name}",
        module=(inspect.getdoc(source) or "").split("\n")[0],
        file=f"derivations/{module}.py",
        meaning=said.removeprefix("Return "),
        formulas=tuple(_mathml(value) for value in _values(function)),
    )


def _values(function: Any) -> tuple[Any, ...]:
    """The values of a generated function, of symbols."""
    import sympy

    names = list(inspect.signature(function).parameters)[1:]
    symbols = {name: sympy.Symbol(_LETTERS.get(name, name), positive=True) for name in names}
    turns = [of(symbols["theta"]) for of in (sympy.sin, sympy.cos) if "theta" in symbols]
    values = [sympy.nsimplify(value) for value in function(sympy, *symbols.values())]
    return tuple(sympy.collect(sympy.expand(value), turns) if turns else value for value in values)


_LETTERS = {"dx": "delta_x", "dy": "delta_y", "side": "s", "half": "l"}
"""Symbols for names of several letters; `LETTERS_SAID` says so on the page."""
LETTERS_SAID = "In formulas δx, δy, s and l stand for dx, dy, side and half."


def _mathml(value: Any) -> Markup:
    from sympy.printing.mathml import mathml

    text = mathml(value, printer="presentation")
    for plain, sign in (("&InvisibleTimes;", "&#8290;"), ("<mo>-</mo>", "<mo>−</mo>")):
        text = text.replace(plain, sign)
    return Markup(f"<math><mrow>{text}<mo>&gt;</mo><mn>0</mn></mrow></math>")
