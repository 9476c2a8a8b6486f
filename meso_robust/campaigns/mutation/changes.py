"""Changing one value of a document, wherever it stands and whatever it is."""

from __future__ import annotations

import copy
import math
import random
from typing import Any

from meso_robust.campaigns.mutation.places import Document, Place, at, places


def change(
    document: Document, rng: random.Random, *, numbers: bool = False
) -> tuple[str, Document]:
    """A document with one value changed, and the name of the change; its digest may not fit.

    Parameters
    ----------
    document, rng
        What is changed, and the source of chance.
    numbers
        Whether only a number may be changed.
    """
    listed = list(places(document))[1:]
    if numbers:
        listed = [(where, value) for where, value in listed if is_number(value)]
    found = None
    while found is None:
        found = _change(document, listed, rng)
    return found


def _change(
    document: Document, listed: list[tuple[Place, Any]], rng: random.Random
) -> tuple[str, Document] | None:
    # a place by its kind first: neither the many ends of boxes nor the sentences that nobody
    # compares must drown the rest
    groups: dict[str, list[tuple[Place, Any]]] = {}
    for where, value in listed:
        said = where[:1] if where[0] == "reading" else where
        name = ".".join(key for key in said if isinstance(key, str))
        groups.setdefault(name, []).append((where, value))
    where, old = rng.choice(groups[rng.choice(sorted(groups))])
    texts = [value for _, value in listed if isinstance(value, str)]
    kind, new = changed(old, rng, texts)
    if new == old and type(new) in (type(old), float):
        return None
    mutant = copy.deepcopy(document)
    at(mutant, where[:-1])[where[-1]] = new
    return kind, mutant


def changed(value: Any, rng: random.Random, texts: list[str]) -> tuple[str, Any]:
    """The value after a change of some kind, and the kind's name.

    Parameters
    ----------
    value, rng
        What is changed, and the source of chance.
    texts
        What may stand in the place of a text.
    """
    if isinstance(value, bool):
        return "flipped", not value
    if isinstance(value, int | float):
        kind, new = _number(float(value), rng)
        return kind, round(new) if isinstance(value, int) and rng.random() < 0.8 else new
    if is_double(value):
        kind, new = _number(float.fromhex(value), rng)
        return kind, new.hex()
    if isinstance(value, str):
        return _text(value, rng, texts)
    if value is None:
        return "null filled", rng.choice([0.0, "x", [], {}])
    return _container(value, rng)


def is_number(value: Any) -> bool:
    """Whether a value is a number, decimal or a hexadecimal double."""
    return is_double(value) or (isinstance(value, int | float) and not isinstance(value, bool))


def is_double(value: Any) -> bool:
    """Whether a value is a finite hexadecimal double."""
    if not isinstance(value, str) or "0x" not in value:
        return False
    try:
        return math.isfinite(float.fromhex(value))
    except (ValueError, OverflowError):
        return False


def _number(value: float, rng: random.Random) -> tuple[str, float]:
    towards = rng.choice([-1, 1])
    kinds = {
        "sign": -value,
        "neighbour": math.nextafter(value, towards * math.inf),
        "scaled": value * (1.0 + towards * 10.0 ** rng.uniform(-9, 0)),
        "added": value + towards * 10.0 ** rng.uniform(-9, 1),
        "digit": value + towards * 2.0 ** (math.frexp(value)[1] - rng.randint(1, 50)),
        "zero": 0.0,
    }
    kind = rng.choice(sorted(kinds))
    return kind, kinds[kind]


def _text(value: str, rng: random.Random, texts: list[str]) -> tuple[str, str]:
    if value and rng.random() < 0.5:
        place = rng.randrange(len(value))
        return "character", value[:place] + rng.choice("abc019-+ x") + value[place + 1 :]
    return "other text", rng.choice(texts)


def _container(value: Any, rng: random.Random) -> tuple[str, Any]:
    new = copy.deepcopy(value)
    if isinstance(new, list) and new:
        return _list(new, rng)
    if isinstance(new, dict) and new:
        return _mapping(new, rng)
    return "null", None


def _list(new: list[Any], rng: random.Random) -> tuple[str, Any]:
    kind = rng.choice(["dropped", "doubled", "swapped"])
    place = rng.randrange(len(new))
    if kind == "dropped":
        del new[place]
    elif kind == "doubled":
        new.insert(place, copy.deepcopy(new[place]))
    else:
        other = rng.randrange(len(new))
        new[place], new[other] = new[other], new[place]
    return f"item {kind}", new


def _mapping(new: dict[str, Any], rng: random.Random) -> tuple[str, Any]:
    key = rng.choice(sorted(new))
    if rng.random() < 0.5:
        del new[key]
        return "key dropped", new
    other = rng.choice(sorted(new))
    new[key], new[other] = new[other], new[key]
    return "values swapped", new
