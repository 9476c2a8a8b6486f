"""The conditions of a proof as formulas, each with where it is derived.

A formula is that of the generated code that was bounded: the derivations write both, the formula by
running the code on symbols, so that the page cannot say anything else than what was proved.
"""

from __future__ import annotations

import importlib
import inspect
import json
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from importlib import resources

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
    formulas = _formulas().get(f"{module}.{name}")
    if formulas is None:
        return None
    source = importlib.import_module(f"meso_robust._generated.{module}")
    said = inspect.getdoc(getattr(source, name)) or ""
    return Condition(
        name=f"{module}.{name}",
        anchor=f"derivation-{module}-{name}",
        module=(inspect.getdoc(source) or "").split("\n")[0],
        file=f"derivations/{module}.py",
        meaning=said.removeprefix("Return "),
        formulas=tuple(map(Markup, formulas)),
    )


@cache
def _formulas() -> dict[str, list[str]]:
    """MathML of every function that a proof can rest on, as the derivations wrote it."""
    text = resources.files("meso_robust._generated").joinpath("conditions.json").read_text("utf-8")
    found: dict[str, list[str]] = json.loads(text)
    return found


LETTERS_SAID = "In formulas δx, δy, s and l stand for dx, dy, side and half."
