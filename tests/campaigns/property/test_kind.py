"""The kind *property*: chunks, totals, the example database, and what is told."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import strategies as st
from pydantic import ValidationError
from scipy.stats import binom

from meso_robust.campaigns.encoding import result_of, result_text
from meso_robust.campaigns.kind import Part, Result
from meso_robust.campaigns.property import kept, kind, registry, section, summary
from meso_robust.campaigns.property.kept import keep, replay
from meso_robust.campaigns.property.kind import PROPERTY
from meso_robust.campaigns.property.law import Breach, Cost, Property, Silence, Verdict
from meso_robust.campaigns.property.section import PropertySection

NUMBERS = st.integers(0, 10**6)


def _small(number: int) -> Verdict:
    return (
        Breach(what="large", detail=f"{number}", files={"n.txt": f"{number}"})
        if number > 1e5
        else None
    )


def _odd(number: int) -> Verdict:
    return Silence("even") if number % 2 == 0 else None


def _law(name: str, check: Callable[[int], Verdict], cost: Cost) -> Property:
    return Property(
        name=name,
        statement=f"{name}!",
        agreement="exact",
        examples=NUMBERS,
        check=check,
        cost=cost,
    )


LAWS = {
    one.name: one
    for one in (
        _law("holds", lambda number: None, Cost.CHEAP),
        _law("small", _small, Cost.MODERATE),
        _law("odd", _odd, Cost.COSTLY),
    )
}


@pytest.fixture(autouse=True)
def laws(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (kind, kept, summary, registry, section):
        monkeypatch.setattr(module, "PROPERTIES", LAWS)


def part(**more: object) -> Part:
    asked = {"name": "p", "kind": "property", "properties": list(LAWS), "examples": 25, "chunk": 10}
    return Part(
        name="p", kind="property", seed=9, confidence=0.95, asked={**asked, **more}, given={}
    )


def done(of: Part) -> list[Result]:
    ready = PROPERTY.prepare(of)
    return [PROPERTY.execute(ready, of, chunk) for chunk in range(PROPERTY.count(of))]


def test_chunks_go_through_the_properties_and_spend_the_budget_of_each() -> None:
    of = part(properties=["holds", "odd"])
    found = done(of)
    assert [(one.values["property"], one.runs) for one in found] == [
        (name, runs) for name in ("holds", "odd") for runs in (10, 10, 5)
    ]
    assert len({one.values["drawn"] for one in found}) == 6


def test_without_a_size_a_chunk_takes_some_seconds_of_its_property() -> None:
    of = part(chunk=None, examples=1200)
    assert PROPERTY.execute(None, of, 1).runs == 200  # after a chunk of 1000
    assert PROPERTY.execute(None, of, 14).values["property"] == "odd"
    assert PROPERTY.count(of) == 2 + 12 + 240


def test_a_chunk_gives_the_same_result_again_and_it_is_json() -> None:
    of = part()
    for chunk in (4, 0, 8, 4):
        one, other = (PROPERTY.execute(None, of, chunk) for _ in range(2))
        assert one == other
        assert result_of(result_text(one)) == one


def test_another_seed_draws_other_examples() -> None:
    one, other = part(), replace(part(), seed=10)
    drawn = [PROPERTY.execute(None, of, 0).values["drawn"] for of in (one, other)]
    assert drawn[0] != drawn[1]


def test_a_failing_example_is_told_simplest_with_its_files() -> None:
    failing = [one for one in done(part()) if one.failed]
    assert failing
    for one in failing:
        (failure,) = one.failures
        assert failure.what == "large"
        assert failure.files == {"n.txt": "100001"}
        assert failure.detail == "small: 100001; example: 100001"
        assert one.runs <= 10


def test_totals_add_up_and_chunks_may_be_missing() -> None:
    of = part()
    found = done(of)
    totals = PROPERTY.total(of, found)
    assert totals["properties"]["holds"]["examples"] == 25
    assert totals["properties"]["odd"]["chunks"] == 3
    small = [one for one in found if one.values["property"] == "small"]
    assert totals["properties"]["small"]["failed"] == sum(one.failed for one in small)
    assert totals["properties"]["small"]["simplest"] == "100001"
    assert len(totals["entries"]) == 1
    fewer = PROPERTY.total(of, found[1:])
    assert fewer["properties"]["holds"]["examples"] == 15
    assert json.loads(json.dumps(totals)) == totals


def test_kept_examples_are_replayed_and_stay(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    of = part()
    totals = PROPERTY.total(of, done(of))
    assert replay(of, tmp_path / "examples").runs == 0
    for _ in range(2):
        keep(tmp_path / "examples", totals)
    again = replay(of, tmp_path / "examples")
    assert (again.runs, again.failed) == (1, 1)
    assert again.failures[0].files == {"n.txt": "100001"}
    assert again.values["replayed"] == {"small": [1, 1]}
    mended = {**LAWS, "small": replace(LAWS["small"], check=lambda number: None)}
    monkeypatch.setattr(kept, "PROPERTIES", mended)
    for _ in range(2):
        assert replay(of, tmp_path / "examples").values["replayed"] == {"small": [1, 0]}
    assert replay(part(properties=["odd"]), tmp_path / "examples").runs == 0


def test_what_is_told() -> None:
    of = part()
    told = PROPERTY.tell(of, PROPERTY.total(of, done(of)))
    assert told.verdict == "broken"
    assert told.answer.startswith("Broken: small; 2 of 3 properties held in ")
    held = part(properties=["holds", "odd"], examples=200, chunk=50)
    totals = PROPERTY.total(held, done(held))
    told = PROPERTY.tell(held, totals)
    assert told.verdict == "held"
    assert told.answer == "2 of 2 properties held in 400 examples."
    rows = {row[0]: row for row in told.views[0].rows}  # type: ignore[union-attr]
    even = totals["properties"]["odd"]["silent"]["even"]
    assert 70 < even < 135
    assert rows["holds"][1:3] == ("200", "0")
    for name, said in (("holds", 196), ("odd", 196 - even)):
        limit = 0.01 * float(rows[name][3].removeprefix("below ").removesuffix(" %"))
        # at the bound, that nothing was found has the probability that is left
        assert binom.pmf(0, said, limit) == pytest.approx(0.05, rel=0.05)


def test_examples_that_say_nothing_are_not_taken_for_success() -> None:
    of = part(properties=["odd"], examples=1)
    told = PROPERTY.tell(of, PROPERTY.total(of, done(of)))
    assert "Nothing was said by the examples of odd" in told.answer
    assert told.verdict == "open"
    assert told.answer.startswith("0 of 1 properties held")


def test_what_was_not_done_is_told() -> None:
    of = part()
    assert PROPERTY.tell(of, PROPERTY.total(of, [])).answer == "No chunk was done."
    told = PROPERTY.tell(of, PROPERTY.total(of, done(of)[:1]))
    assert told.answer == (
        "1 of 1 properties held in 10 examples. No chunk was done of small, odd."
    )


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (
            {"properties": ["holds", "unheard-of"]},
            "'unheard-of' is not a property; must be one of holds",
        ),
        ({"properties": ["odd", "odd"]}, "property 'odd' is given twice"),
        ({"properties": []}, "at least 1 item"),
        ({"examples": 0}, "greater than or equal to 1"),
        ({"examples": 10**9 + 1}, "less than or equal to 1000000000"),
    ],
)
def test_bad_sections_are_refused(values: dict[str, object], message: str) -> None:
    stated = {"name": "p", "kind": "property", "examples": 5, **values}
    with pytest.raises(ValidationError, match=message):
        PropertySection.model_validate_json(json.dumps(stated))
