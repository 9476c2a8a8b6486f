"""Searching examples that break a property, and making the first one simpler."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from hypothesis import HealthCheck, Phase, Verbosity, given, seed as seeded, settings
from hypothesis.database import ExampleDatabase
from hypothesis.errors import Unsatisfiable

from meso_robust.campaigns.property.drawing import alone, independent
from meso_robust.campaigns.property.law import Breach, Property, Silence, Verdict


@dataclass(frozen=True, slots=True, kw_only=True)
class Searched:
    """The outcome of some examples of a property."""

    examples: int
    """That passed through the check, those that only served to simplify a failing one left out."""
    silent: Mapping[str, int]
    """Examples that the property says nothing of, by the reason."""
    breach: Breach | None
    """The simplest one found; the search ends at the first example that breaks the property."""
    example: str
    """The example that breaks it, in words; empty if none does."""
    drawn: str
    """SHA-256 of all examples, in their order."""
    entry: bytes | None
    """The failing example as Hypothesis keeps it."""


@dataclass(slots=True)
class _Watched:
    """A check that counts, and that knows each failing example again."""

    of: Property
    examples: int = 0
    silent: Counter[str] = field(default_factory=Counter)
    drawn: Any = field(default_factory=hashlib.sha256)
    sort: str | None = None
    """What the first failing example breaks; a simpler one must break the same."""
    known: dict[str, Verdict] = field(default_factory=dict)

    def breaks(self, example: object) -> bool:
        return self._first(example) if self.sort is None else self._simpler(example)

    def _first(self, example: object) -> bool:
        self.examples += 1
        self.drawn.update(repr(example).encode() + b"\n")
        found = checked(self.of, example)
        if isinstance(found, Silence):
            self.silent[found.why] += 1
        if not isinstance(found, Breach):
            return False
        self.sort = found.what
        self.known[repr(example)] = found
        return True

    def _simpler(self, example: object) -> bool:
        key = repr(example)
        if key not in self.known:
            if len(self.known) > self.of.cost.shrinking:
                return False
            self.known[key] = checked(self.of, example)
        found = self.known[key]
        return isinstance(found, Breach) and found.what == self.sort


def checked(of: Property, example: object) -> Verdict:
    """The verdict on an example; an unexpected exception breaks the property as well."""
    try:
        return of.check(example)
    except Exception as error:
        return Breach(what=f"{of.name}: raises {type(error).__name__}", detail=str(error))


class _BrokenError(Exception):
    """Tells Hypothesis that an example breaks the property."""


class _Shelf(ExampleDatabase):
    """An example database for one property, in memory: its failing examples and nothing else."""

    def __init__(self, *entries: bytes) -> None:
        super().__init__()
        self.entries = set(entries)

    def fetch(self, key: bytes) -> Iterable[bytes]:
        return () if key.endswith(_OTHERS) else tuple(sorted(self.entries))

    def save(self, key: bytes, value: bytes) -> None:
        if not key.endswith(_OTHERS):
            self.entries.add(value)

    def delete(self, key: bytes, value: bytes) -> None:
        if not key.endswith(_OTHERS):
            self.entries.discard(value)


_OTHERS = (b".secondary", b".pareto")  # what Hypothesis keeps beside failing examples


def key_of(of: Property) -> bytes:
    """Under which an example database keeps the failing examples of a property."""
    return b"meso-robust/property/" + of.name.encode()


def search(of: Property, examples: int, seed: int) -> Searched:
    """Check up to ``examples`` examples of a property, drawn from ``seed``."""
    with independent(seed) as backend:
        phases = (Phase.generate, Phase.shrink)
        return _searched(of, _Shelf(), seed, max_examples=examples, backend=backend, phases=phases)


def replayed(of: Property, entry: bytes) -> Searched:
    """Check the example that was kept as ``entry``; there is none if it no longer means one."""
    with alone():
        return _searched(of, _Shelf(entry), 0, max_examples=1, phases=(Phase.reuse,))


def _searched(of: Property, shelf: _Shelf, seed: int, **more: Any) -> Searched:
    watched, last = _Watched(of), ""

    def body(example: object) -> None:
        nonlocal last
        if watched.breaks(example):
            last = repr(example)
            raise _BrokenError

    chosen = settings(
        database=shelf,
        deadline=None,
        print_blob=False,
        report_multiple_bugs=False,
        suppress_health_check=list(HealthCheck),
        verbosity=Verbosity.quiet,
        **more,
    )
    with suppress(_BrokenError, Unsatisfiable):
        # in this order, because a seed alone would do without the database
        chosen(seeded(seed)(given(of.examples)(body)))()
    breach = watched.known.get(last)
    return Searched(
        examples=watched.examples,
        silent=dict(sorted(watched.silent.items())),
        breach=breach if isinstance(breach, Breach) else None,
        example=last,
        drawn=watched.drawn.hexdigest(),
        entry=min(shelf.entries) if last else None,
    )
