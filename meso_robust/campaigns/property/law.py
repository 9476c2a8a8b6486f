"""What a property is, and what may come of one example of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, TypeAlias

from hypothesis import strategies as st


@dataclass(frozen=True, slots=True, kw_only=True)
class Breach:
    """An example that breaks the property."""

    what: str
    """Which rule is broken, the same for all examples that break it."""
    detail: str
    """How: the numbers."""
    files: Mapping[str, str] = field(default_factory=dict)
    """Contents of files, by name, that let anybody see it again."""


@dataclass(frozen=True, slots=True)
class Silence:
    """An example that the property says nothing of, such as a plan that is not certified."""

    why: str


Verdict: TypeAlias = Breach | Silence | None
"""None: the example keeps the property."""


class Cost(Enum):
    """About how long an example takes; what follows from it can be changed in a campaign."""

    CHEAP = "some ms"
    MODERATE = "some 10 ms"
    COSTLY = "about 1 s"

    @property
    def chunk(self) -> int:
        """Examples of a chunk: some seconds of work."""
        return {Cost.CHEAP: 1000, Cost.MODERATE: 100, Cost.COSTLY: 5}[self]

    @property
    def shrinking(self) -> int:
        """Examples that may be tried to make a failing one simpler."""
        return {Cost.CHEAP: 2000, Cost.MODERATE: 200, Cost.COSTLY: 30}[self]


@dataclass(frozen=True, slots=True, kw_only=True)
class Property:
    """A law that every example must obey."""

    name: str
    """Lower case with hyphens; also the key of its failing examples in an example database."""
    statement: str
    """The law in words, a sentence."""
    agreement: str
    """``exact``, or the tolerance and where it comes from."""
    examples: st.SearchStrategy[Any]
    """The ``repr`` of an example tells everything about it."""
    check: Callable[[Any], Verdict]
    """A pure function of the example."""
    cost: Cost
