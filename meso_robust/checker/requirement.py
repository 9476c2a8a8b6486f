"""What a move must fulfil: an inequality at every point of its variables.

A requirement that the certificate states as well (an obligation) is compared with it elsewhere
(``obligations.py``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from flint import arb

from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.ids import Named
from meso_robust.checker.ranges import ZERO, Box, Formula, either, least, point_of, positive
from meso_robust.checker.refusal import Refused
from meso_robust.checker.statement import Statement

Variables = Mapping[str, Formula]


@dataclass(frozen=True, slots=True)
class Part:
    """Some of the states of a move."""

    variables: Variables
    """What the names of an inequality are, as functions of the variables of the box."""
    box: Box


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirement:
    """An inequality over everything that a move can be like."""

    name: Named
    statement: Statement
    parts: tuple[Part, ...]
    stated: bool = True
    """Whether the certificate lists it as an obligation."""
    cover: tuple[Part, ...] | None = None
    """What the stated box must hold; None: all parts."""
    stated_box: Callable[[Box], Box] | None = None
    """Turns the stated box into one of the inequality's variables; None: it is one already."""
    over_parts: bool = False
    """Whether the stated bound is one over the checker's own parts (a tube), not the stated box."""
    instead: tuple[Requirement, ...] = ()
    """Others that serve as well: the certificate may state any one of them."""
    shown: bool = False
    """Whether it is proved already, or nothing rests on it."""
    optional: bool = False
    """Whether the certificate may leave it out."""
    verify: Callable[[Box, arb], bool] | None = None
    """Whether a stated bound holds over the stated box and all else that it is about; None: the
    inequality is one of a few numbers, which ``statement`` and ``parts`` give."""


def formulas(statement: Statement, part: Part, above: arb = ZERO) -> tuple[Formula, ...]:
    """What must be positive, as functions of the variables of a move.

    Left out is what is seen to be positive at a glance, unless one positive value is enough.
    """

    def all_values(at: Point) -> tuple[Dual, ...]:
        return statement.of({name: of(at) for name, of in part.variables.items()}, above)

    at_a_glance = all_values(point_of(part.box))
    return tuple(
        lambda at, k=k: all_values(at)[k]
        for k, value in enumerate(at_a_glance)
        if statement.any_value or not value.value > 0
    )


def holds(statement: Statement, part: Part, above: arb = ZERO) -> bool:
    """Whether an inequality is proved to exceed ``above`` over a part."""
    values = formulas(statement, part, above)
    if statement.any_value:
        return either(values, part.box)
    return all(positive(of, part.box) for of in values)


def prove(requirement: Requirement) -> None:
    """Prove a requirement over all of its parts.

    Raises
    ------
    Refused
        It does not follow.
    """
    for part in () if requirement.shown else requirement.parts:
        if not holds(requirement.statement, part):
            found = ", ".join(_bounds(requirement.statement, part))
            raise Refused(requirement.name, "more than 0", f"a bound of {found}")


def _bounds(statement: Statement, part: Part) -> Iterator[str]:
    for of in formulas(statement, part):
        yield f"{float(least(of, part.box)):.4g}"
