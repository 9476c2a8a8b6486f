"""Places of a document, what differs between two of them, and the digest that makes one whole."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from meso_robust.checker.reading import digest

Document = dict[str, Any]
Place = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class Difference:
    """A value that is another one, or a list or mapping that holds others."""

    where: Place
    old: Any
    new: Any

    def told(self) -> str:
        """In a line."""
        return f"{dotted(self.where)}: {_short(self.old)} -> {_short(self.new)}"


def dotted(where: Place) -> str:
    """A place in words, as ``steps.1.pre_exact.x_m.0``."""
    return ".".join(map(str, where))


def places(value: Any, where: Place = ()) -> Iterator[tuple[Place, Any]]:
    """Every value of a document, and every list and mapping before what it holds."""
    yield where, value
    for key, item in _items(value):
        yield from places(item, (*where, key))


def _items(value: Any) -> Iterator[tuple[str | int, Any]]:
    if isinstance(value, dict):
        yield from value.items()
    elif isinstance(value, list):
        yield from enumerate(value)


def at(document: Document, where: Place) -> Any:
    """The value at a place."""
    found: Any = document
    for key in where:
        found = found[key]
    return found


def differences(old: Any, new: Any, where: Place = ()) -> Iterator[Difference]:
    """What is not the same; lists of other lengths and mappings of other keys as a whole."""
    if _alike(old, new):
        for key, item in _items(old):
            yield from differences(item, new[key], (*where, key))
    elif type(old) is not type(new) or old != new:
        yield Difference(where, old, new)


def _alike(old: Any, new: Any) -> bool:
    if isinstance(old, dict) and isinstance(new, dict):
        return old.keys() == new.keys()
    return isinstance(old, list) and isinstance(new, list) and len(old) == len(new)


def sealed(document: Document) -> Document:
    """The document with the digest that its values have."""
    return {**document, "digest": digest(document)}


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
