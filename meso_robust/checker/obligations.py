"""The inequalities that a certificate lists, compared with what the checker required itself.

Each must be the same inequality about the same thing; its box must hold everything that the checker
finds reachable; and over that box it must hold with the stated bound.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from flint import arb

from meso_robust.checker.document import ObligationDocument
from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.numbers import double, side
from meso_robust.checker.ranges import ZERO, Box, Formula, Side, either, least
from meso_robust.checker.refusal import Refused
from meso_robust.checker.requirement import Part, Requirement, formulas
from meso_robust.checker.statement import Statement

NINE_DIGITS = arb(1e-9)
"""To what a stated box is compared with the states that are found reachable. Nothing rests on this:
the checker's own proof is over those states, and the stated bound is verified over the stated box."""


def compare(stated: tuple[ObligationDocument, ...], found: tuple[Requirement, ...]) -> None:
    """Compare the obligations of a move with the checker's own requirements.

    Raises
    ------
    Refused
        One differs, is missing, or claims more than is true.
    """
    wanted = [requirement for requirement in found if requirement.stated]
    claims = [one.claim for one in stated]
    if claims != [one.claim for one in wanted]:
        missing = next((w.claim for w in wanted if w.claim not in claims), "another order")
        raise Refused("the list of obligations", f"{len(claims)} claims", f"lacks: {missing}")
    for one, requirement in zip(stated, wanted, strict=True):
        _words(one, requirement.statement)
    for one, requirement in zip(stated, wanted, strict=True):
        _reach(one, requirement)
        _bound(one, requirement)


def _words(stated: ObligationDocument, statement: Statement) -> None:
    pairs = (
        ("inequality", stated.inequality, statement.text),
        ("derivation", stated.derivation, statement.derivation),
        ("verdict", stated.verdict, "PROVED"),
    )
    for name, told, own in pairs:
        if told != own:
            raise Refused(f"{stated.claim}: {name}", told, own)


def _sides(stated: ObligationDocument) -> dict[str, Side]:
    return {name: side(pair, f"{stated.claim}: {name}") for name, pair in stated.over.items()}


def _reach(stated: ObligationDocument, requirement: Requirement) -> None:
    """The stated box must hold all that can be."""
    sides = _sides(stated)
    for part in requirement.cover or requirement.parts:
        if set(part.variables) != set(sides):
            raise Refused(
                f"{stated.claim}: names of the box", sorted(sides), sorted(part.variables)
            )
        for name, of in part.variables.items():
            low, high = sides[name]
            room = (abs(low) + abs(high)) * NINE_DIGITS
            if not (
                _at_least(of, part.box, low - room)
                and _at_least(_minus(of), part.box, -high - room)
            ):
                told = f"{float(low):.9g} to {float(high):.9g}"
                raise Refused(f"{stated.claim}: {name}", told, "more can be reached")


def _minus(of: Formula) -> Formula:
    return lambda at: -of(at)


def _at_least(of: Formula, box: Box, bound: arb) -> bool:
    # well below nine digits of the lengths of a part of some 100 um
    return bool(least(lambda at: of(at) - bound, box, above=ZERO, within=1e-15) >= 0)


def _bound(stated: ObligationDocument, requirement: Requirement) -> None:
    """The stated bound must be one."""
    if stated.lower_bound is None:
        raise Refused(f"{stated.claim}: lower_bound", "null", "a number")
    bound = double(stated.lower_bound, f"{stated.claim}: lower_bound")
    if not _spares(stated, requirement, arb(bound)):
        raise Refused(f"{stated.claim}: lower bound", bound, "the inequality has less to spare")


def _spares(stated: ObligationDocument, requirement: Requirement, bound: arb) -> bool:
    if requirement.verify is not None:
        return requirement.verify(_sides(stated), bound)
    where = _where(stated, requirement)
    return all(_holds(requirement.statement, part, bound) for part in where)


def _where(stated: ObligationDocument, requirement: Requirement) -> tuple[Part, ...]:
    if requirement.over_parts:
        return requirement.parts
    box: Mapping[str, Side] = _sides(stated)
    if requirement.stated_box is not None:
        box = requirement.stated_box(box)
    return (Part({name: _variable(name) for name in box}, box),)


def _variable(name: str) -> Callable[[Point], Dual]:
    return lambda at: at[name]


def _holds(statement: Statement, part: Part, bound: arb) -> bool:
    values = formulas(statement, part, bound)
    if statement.any_value:
        return either(values, part.box)
    return all(least(of, part.box, above=ZERO) >= 0 for of in values)
