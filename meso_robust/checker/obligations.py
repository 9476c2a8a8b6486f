"""The inequalities that a certificate lists, compared with what the checker required itself.

Each must be the same inequality about the same thing; its box must hold everything that the checker
finds reachable; and over that box it must hold with the stated bound. A box is one of the variables of
the move (``scene.py``), of which those that are left out have the ranges of the task, or, where it has
exactly the names of the inequality, one of these.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence

from flint import arb

from meso_robust.checker.document import ObligationDocument
from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.ids import Named, Objection, named
from meso_robust.checker.numbers import double, side
from meso_robust.checker.ranges import ZERO, Box, Formula, Side, either, least, shift
from meso_robust.checker.refusal import Refused
from meso_robust.checker.requirement import Part, Requirement, formulas
from meso_robust.checker.statement import Statement
from meso_robust.checker.words import sentence

NINE_DIGITS = arb(1e-9)
"""To what a stated box is compared with the states that are found reachable. Nothing rests on this:
the checker's own proof is over those states, and the stated bound is verified over the stated box."""

CASES = arb("0.05")
"""By which share of it a range of angles may be wider than the checker's own: a matter of form."""


def compare(stated: tuple[ObligationDocument, ...], found: tuple[Requirement, ...]) -> None:
    """Compare the obligations of a move with the checker's own requirements.

    Raises
    ------
    Refused
        One differs, is missing, or claims more than is true.
    """
    wanted = _listed(stated, [requirement for requirement in found if requirement.stated])
    for one, requirement in zip(stated, wanted, strict=True):
        _form(one, requirement)
    for one, requirement in zip(stated, wanted, strict=True):
        _verify(one, requirement)


def _listed(
    stated: tuple[ObligationDocument, ...], found: Sequence[Requirement]
) -> list[Requirement]:
    """The requirements that are listed: all, or of a group the one that stands for all of it."""
    names = [(one.id, one.about) for one in stated]
    wanted: list[Requirement] = []
    for group, members in itertools.groupby(found, key=lambda one: one.group):
        every = list(members)
        if group and names[len(wanted) : len(wanted) + 1] != [
            (every[0].name.id, every[0].name.about)
        ]:
            every = [one for member in every for one in member.instead]
        wanted += every
    if names != [(one.name.id, one.name.about) for one in wanted]:
        missing = (w for w in wanted if (w.name.id, w.name.about) not in names)
        lacks = next((sentence(w.name) for w in missing), "another order")
        raise Refused(
            named(Objection.OBLIGATIONS_LISTED), f"{len(stated)} of them", f"lacks: {lacks}"
        )
    return wanted


def _verify(stated: ObligationDocument, requirement: Requirement) -> None:
    """What is stated must be the requirement, or one that serves as well."""
    refused = None
    for wanted in _meant(stated, requirement):
        try:
            if wanted.verify is None and _of_move(stated, wanted):
                _over_move(stated, wanted)
            else:
                _reach(stated, wanted)
                _bound(stated, wanted)
        except Refused as refusal:
            refused = refused or refusal
        else:
            return
    if refused is not None:
        raise refused


def _meant(stated: ObligationDocument, requirement: Requirement) -> list[Requirement]:
    """The requirements, of those that serve, with the stated inequality."""
    every = (requirement, *requirement.instead)
    return [one for one in every if one.statement.id == stated.inequality]


def _form(stated: ObligationDocument, requirement: Requirement) -> None:
    if not _meant(stated, requirement):
        wanted = requirement.statement.id
        raise Refused(requirement.name.value("inequality"), stated.inequality, wanted)
    if stated.verdict != "PROVED":
        raise Refused(requirement.name.value("verdict"), stated.verdict, "PROVED")


def _of_move(stated: ObligationDocument, requirement: Requirement) -> bool:
    """Whether a box is stated in the variables of the move, not in those of the inequality."""
    listed = requirement.cover or requirement.parts
    return all(set(stated.over) != set(part.variables) for part in listed)


def _over_move(stated: ObligationDocument, requirement: Requirement) -> None:
    """Verify the bound with the stated ranges in the place of the checker's own."""
    bound = _stated_bound(stated, requirement)
    for part in requirement.parts:
        box = dict(part.box)
        for key, (low, high) in _sides(stated, requirement.name).items():
            own = _own_name(key, part.box, requirement)
            if own is None:
                continue
            if own == "theta":  # stated is the part's orientation
                low, high = shift((low, high), -part.box["turn"][0])
            known = part.box[own]
            room = (abs(low) + abs(high)) * NINE_DIGITS
            told = f"{float(low):.9g} to {float(high):.9g}"
            if not (low - room <= known[0] and known[1] <= high + room):
                raise Refused(requirement.name.value(key), told, "more can be reached")
            # angles of a case end where each side encloses the other case's beginning
            wide = room + (known[1] - known[0]) * CASES if own == "theta" else room
            if not (known[0] - wide <= low and high <= known[1] + wide):
                raise Refused(requirement.name.value(key), told, "less can be reached")
            # two names may be one variable here: it has all values of both
            box[own] = (low.min(box[own][0]), high.max(box[own][1]))
        if not _holds(requirement.statement, Part(part.variables, box), bound):
            raise Refused(
                requirement.name.value("lower_bound"),
                float(bound),
                "the inequality has less to spare",
            )


def _own_name(key: str, box: Box, requirement: Requirement) -> str | None:
    """The variable that a certificate means; None: one along a way that this part does not have."""
    plain = key.removesuffix("_now")
    friction = "mu" if plain in {"mu_upper", "mu_lower", "mu_passive"} else plain
    found = next((name for name in (key, plain, friction) if name in box), None)
    if found is None and key != "share":
        raise Refused(requirement.name.value("over"), key, "a variable of the move")
    return found


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
    bound = _stated_bound(stated, requirement)
    if not _spares(stated, requirement, bound):
        what = requirement.name.value("lower_bound")
        raise Refused(what, float(bound), "the inequality has less to spare")


def _stated_bound(stated: ObligationDocument, requirement: Requirement) -> arb:
    what = requirement.name.value("lower_bound")
    if stated.lower_bound is None:
        raise Refused(what, "null", "a number")
    bound = arb(double(stated.lower_bound, what))
    if not bound > 0:  # it says that an inequality holds
        raise Refused(what, float(bound), "more than 0")
    return bound


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
