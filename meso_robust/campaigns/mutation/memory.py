"""A prover with a memory: the same move from the same box is proved once.

Of certificates that differ in one value most is the same. The functions that are remembered are
pure, so an answer does not depend on what was asked before.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from flint import arb

from meso_robust.checker.document import ObligationDocument, RuleDocument
from meso_robust.checker.ids import Named
from meso_robust.checker.inputs import Channel, Given, PoseBox
from meso_robust.checker.outline import Edge, Neighbour, Polygon, Rectangle
from meso_robust.checker.passage import Memory, Passage
from meso_robust.checker.prover import PLAIN, Prover
from meso_robust.checker.refusal import Refused
from meso_robust.checker.requirement import Requirement
from meso_robust.checker.scene import Scene

Store = dict[Hashable, Any]


@dataclass(frozen=True, slots=True, eq=False)
class Remembered:
    """What has been proved or refused so far.

    All questions must be asked at the same precision of the balls, as the checker does.
    """

    moves: Store = field(default_factory=dict)
    lists: Store = field(default_factory=dict)

    @property
    def prover(self) -> Prover:
        """The checker's prover, asked only what is new."""
        return Prover(move=self._move, compare=self._compare)

    def copy(self) -> Remembered:
        """The same knowledge, to be added to apart."""
        return Remembered(dict(self.moves), dict(self.lists))

    def _move(
        self, rule: RuleDocument, pre: PoseBox, given: Given, memory: Memory | None
    ) -> tuple[Scene, Passage]:
        key = (rule.model_dump_json(), _key(pre), _key(given), _Same(memory))
        found: tuple[Scene, Passage] = _once(
            self.moves, key, lambda: PLAIN.move(rule, pre, given, memory)
        )
        return found

    def _compare(
        self, stated: tuple[ObligationDocument, ...], found: tuple[Requirement, ...]
    ) -> None:
        key = (tuple(one.model_dump_json() for one in stated), _Same(found))
        _once(self.lists, key, lambda: PLAIN.compare(stated, found))


@dataclass(frozen=True, slots=True, eq=False)
class _Same:
    """A key that is equal only for the very same object, which it keeps alive."""

    what: object

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and self.what is other.what

    def __hash__(self) -> int:
        return id(self.what)


def _once(store: Store, key: Hashable, ask: Callable[[], Any]) -> Any:
    if key not in store:
        try:
            store[key] = ask()
        except Refused as refused:
            # a new one each time: an exception that is raised again grows a traceback
            store[key] = _No((refused.name, refused.stated, refused.found))
    found = store[key]
    if isinstance(found, _No):
        raise Refused(*found.why)
    return found


@dataclass(frozen=True, slots=True)
class _No:
    why: tuple[Named, str, str]


def _key(value: Any) -> Hashable:
    """A key that is equal only for equal inputs."""
    if isinstance(value, arb):
        return (str(value.mid().man_exp()), str(value.rad().man_exp()))
    if isinstance(value, tuple):
        return tuple(map(_key, value))
    if isinstance(value, PoseBox | Given | Channel | Rectangle | Polygon | Edge | Neighbour):
        return tuple(_key(getattr(value, name)) for name in value.__slots__)
    if isinstance(value, str | int | float | Fraction | None):
        return value
    raise TypeError(f"no key for {type(value).__name__}")
