"""The inequalities that a certificate lists, compared with what the checker required itself.

Each must be the same inequality about the same thing; its box must hold everything that the checker
finds reachable; and over that box it must hold with the stated bound.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from flint import arb

from meso_robust.checker.document import ObligationDocument
from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.ids import Named, Objection, named
from meso_robust.checker.numbers import double, side
from meso_robust.checker.ranges import ZERO, Box, Formula, Side, either, least
from meso_robust.checker.refusal import Refused
from meso_robust.checker.requirement import Part, Requirement, formulas
from meso_robust.checker.statement import Statement
from meso_robust.checker.words import sentence

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
    told = [(one.id, one.about) for one in stated]
    if told != [(one.name.id, one.name.about) for one in wanted]:
        missing = (w for w in wanted if (w.name.id, w.name.about) not in told)
        lacks = next((sentence(w.name) for w in missing), "another order")
        raise Refused(
            named(Objection.OBLIGATIONS_LISTED), f"{len(told)} of them", f"lacks: {lacks}"
        )
    for one, requirement in zip(stated, wanted, strict=True):
        _form(one, requirement)
    for one, requirement in zip(stated, wanted, strict=True):
        _verify(one, requirement)


def _verify(stated: ObligationDocument, requirement: Requirement) -> None:
    """What is stated must be the requirement, or one that serves as well."""
    refused = None
    for wanted in (requirement, *requirement.instead):
        try:
            _reach(stated, wanted)
            _bound(stated, wanted)
        except Refused as refusal:
            refused = refused or refusal
        else:
            return
    if refused is not None:
        raise refused


def _form(stated: ObligationDocument, requirement: Requirement) -> None:
    pairs = (
        ("inequality", stated.inequality, requirement.statement.id),
        ("verdict", stated.verdict, "PROVED"),
    )
    for key, told, own in pairs:
        if told != own:
            raise Refused(requirement.name.value(key), told, own)


def _sides(stated: ObligationDocument, of: Named) -> dict[str, Side]:
    return {key: side(pair, of.value(key)) for key, pair in stated.over.items()}


def _reach(stated: ObligationDocument, requirement: Requirement) -> None:
    """The stated box must hold all that can be."""
    sides = _sides(stated, requirement.name)
    for part in requirement.cover or requirement.parts:
        if set(part.variables) != set(sides):
            raise Refused(requirement.name.value("over"), sorted(sides), sorted(part.variables))
        for key, of in part.variables.items():
            low, high = sides[key]
            room = (abs(low) + abs(high)) * NINE_DIGITS
            if not (
                _at_least(of, part.box, low - room)
                and _at_least(_minus(of), part.box, -high - room)
            ):
                told = f"{float(low):.9g} to {float(high):.9g}"
                raise Refused(requirement.name.value(key), told, "more can be reached")


def _minus(of: Formula) -> Formula:
    return lambda at: -of(at)


def _at_least(of: Formula, box: Box, bound: arb) -> bool:
    return bool(least(lambda at: of(at) - bound, box, above=ZERO, within=0.0) >= 0)


def _bound(stated: ObligationDocument, requirement: Requirement) -> None:
    """The stated bound must be one."""
    what = requirement.name.value("lower_bound")
    if stated.lower_bound is None:
        raise Refused(what, "null", "a number")
    bound = double(stated.lower_bound, what)
    if not _spares(stated, requirement, arb(bound)):
        raise Refused(what, bound, "the inequality has less to spare")


def _spares(stated: ObligationDocument, requirement: Requirement, bound: arb) -> bool:
    if requirement.verify is not None:
        return requirement.verify(_sides(stated, requirement.name), bound)
    where = _where(stated, requirement)
    return all(_holds(requirement.statement, part, bound) for part in where)


def _where(stated: ObligationDocument, requirement: Requirement) -> tuple[Part, ...]:
    if requirement.over_parts:
        return requirement.parts
    box: Mapping[str, Side] = _sides(stated, requirement.name)
    if requirement.stated_box is not None:
        box = requirement.stated_box(box)
    return (Part({key: _variable(key) for key in box}, box),)


def _variable(key: str) -> Callable[[Point], Dual]:
    return lambda at: at[key]


def _holds(statement: Statement, part: Part, bound: arb) -> bool:
    values = formulas(statement, part, bound)
    if statement.any_value:
        return either(values, part.box)
    return all(least(of, part.box, above=ZERO) >= 0 for of in values)
