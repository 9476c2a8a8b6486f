"""The checker with a memory: the same move from the same box is proved once.

Many certificates that differ in one value are checked; what does not depend on that value need not
be computed anew. Both functions that remember are pure.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from flint import arb

from meso_robust.checker import chain, verdict
from meso_robust.checker.given import Given, PoseBox
from meso_robust.checker.refusal import Refused


def _key(value: Any) -> Any:
    """A key that is equal only for equal inputs."""
    if isinstance(value, arb):
        return (str(value.mid().man_exp()), str(value.rad().man_exp()))
    if isinstance(value, tuple):
        return tuple(map(_key, value))
    if isinstance(value, PoseBox):
        return _key((value.x, value.y, value.theta))
    if isinstance(value, Given):
        return tuple(_key(getattr(value, name)) for name in value.__slots__)
    return value


@contextmanager
def remembered() -> Iterator[None]:
    """Within the block the checker remembers moves and lists of obligations."""
    moves: dict[Any, Any] = {}
    lists: dict[Any, Any] = {}
    verify, compare = chain.verify_move, verdict.compare

    def once(store: dict[Any, Any], key: Any, function: Any, *arguments: Any) -> Any:
        if key not in store:
            try:
                store[key] = function(*arguments)
            except Refused as refused:
                store[key] = refused
        if isinstance(store[key], Refused):
            raise store[key]
        return store[key]

    def verify_once(rule: Any, pre: Any, given: Any, memory: Any) -> Any:
        key = (rule.model_dump_json(), _key(pre), _key(given), id(memory))
        return once(moves, key, verify, rule, pre, given, memory)

    def compare_once(stated: Any, found: Any) -> Any:
        key = (tuple(one.model_dump_json() for one in stated), id(found))
        return once(lists, key, compare, stated, found)

    chain.verify_move, verdict.compare = verify_once, compare_once
    try:
        yield
    finally:
        chain.verify_move, verdict.compare = verify, compare
