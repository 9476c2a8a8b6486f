"""What a change changes, told by hand-made documents and by comparison."""

from __future__ import annotations

import copy
import random
from collections import Counter
from typing import Any

import pytest

from meso_robust.campaigns.mutation.changes import change, is_double
from meso_robust.campaigns.mutation.places import Difference, differences, places, sealed
from meso_robust.checker.reading import digest

SMALL: dict[str, Any] = {
    "a": 1.5,
    "b": [1, 2],
    "c": {"d": "text", "e": None, "f": (0.1).hex()},
    "g": True,
}


def test_every_place_of_a_document_is_listed() -> None:
    assert [where for where, _ in places(SMALL)] == [
        (), ("a",), ("b",), ("b", 0), ("b", 1), ("c",), ("c", "d"), ("c", "e"), ("c", "f"), ("g",),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("key", "value", "where"),
    [
        ("a", 1.25, ("a",)),
        ("a", "1.5", ("a",)),
        ("b", [1, 3], ("b", 1)),
        ("b", [1], ("b",)),
        ("c", {"d": "text", "e": 0.0, "f": (0.1).hex()}, ("c", "e")),
        ("c", {"d": "text"}, ("c",)),
        ("g", 1, ("g",)),
    ],
)
def test_a_difference_is_told_with_its_place(key: str, value: Any, where: Any) -> None:
    (found,) = differences(SMALL, {**SMALL, key: value})
    assert found.where == where


def test_equal_documents_do_not_differ() -> None:
    assert list(differences(SMALL, copy.deepcopy(SMALL))) == []


def test_a_difference_in_a_line() -> None:
    assert Difference(("a", 0, "b"), 1.0, "x").told() == "a.0.b: 1.0 -> 'x'"


@pytest.mark.parametrize(
    ("value", "is_one"),
    [((0.1).hex(), True), ((-3.0).hex(), True), ("0x1.8pp", False), ("0xp", False), ("1.5", False),
     ("inf", False), (1.5, False)],
)  # fmt: skip
def test_a_hexadecimal_double(value: Any, is_one: bool) -> None:
    assert is_double(value) is is_one


def test_a_change_alters_one_place_and_leaves_the_original() -> None:
    """Of exchanged items several may differ; every kind of change has its turn."""
    rng, seen = random.Random(5), Counter[str]()
    before = copy.deepcopy(SMALL)
    for _ in range(600):
        kind, mutant = change(SMALL, rng)
        seen[kind] += 1
        found = list(differences(SMALL, mutant))
        tops = {one.where[:-1] for one in found}
        assert found
        assert len(tops) == 1 or kind in {"item swapped", "values swapped"}
    assert before == SMALL
    assert seen.keys() == {
        "flipped", "sign", "neighbour", "scaled", "added", "digit", "zero", "character",
        "other text", "null filled", "item dropped", "item doubled", "item swapped", "key dropped",
        "values swapped",
    }  # fmt: skip


def test_only_numbers_are_changed_if_only_numbers_may_be() -> None:
    rng = random.Random(6)
    for _ in range(100):
        _, mutant = change(SMALL, rng, numbers=True)
        (found,) = differences(SMALL, mutant)
        assert found.where in {("a",), ("b", 0), ("b", 1), ("c", "f")}
        assert is_double(found.new) or isinstance(found.new, int | float)


def test_a_sealed_document_has_the_digest_of_its_values() -> None:
    found = sealed({**SMALL, "digest": "old"})
    assert found["digest"] == digest(SMALL)
    assert {**found, "digest": ""} == {**SMALL, "digest": ""}
