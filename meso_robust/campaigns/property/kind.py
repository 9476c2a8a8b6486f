"""The kind *property*: laws of the package, each at a budget of random examples."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from meso_robust.campaigns.kind import Kind, Part, Result, Values
from meso_robust.campaigns.property.kept import entries_of, failure_of, keep, replay
from meso_robust.campaigns.property.law import Property
from meso_robust.campaigns.property.registry import PROPERTIES
from meso_robust.campaigns.property.search import key_of, search
from meso_robust.campaigns.property.section import PropertySection
from meso_robust.campaigns.property.summary import tell


def _given(section: PropertySection, folder: Path) -> Values:
    """No file is named."""
    return {}


def _size(part: Part, of: Property) -> int:
    return int(part.asked["chunk"] or of.cost.chunk)


def _chunks(part: Part) -> list[int]:
    """Chunks of each property."""
    budget = int(part.asked["examples"])
    return [-(-budget // _size(part, PROPERTIES[name])) for name in part.asked["properties"]]


def _count(part: Part) -> int:
    return sum(_chunks(part))


def _at(part: Part, chunk: int) -> tuple[Property, int]:
    """Which property a chunk is about, and the number of its examples."""
    ends = list(itertools.accumulate(_chunks(part)))
    which = next(k for k, end in enumerate(ends) if chunk < end)
    of = PROPERTIES[part.asked["properties"][which]]
    done = (chunk - (ends[which - 1] if which else 0)) * _size(part, of)
    return of, min(_size(part, of), int(part.asked["examples"]) - done)


def _prepare(part: Part) -> None:
    """Nothing: what is slow to make is made when a law first needs it."""


def _execute(_: Any, part: Part, chunk: int) -> Result:
    """Search one property, with randomness that follows from part and chunk alone."""
    of, examples = _at(part, chunk)
    found = search(of, examples, int(part.rng(chunk).integers(2**63)))
    failure = failure_of(of, found)
    key, entry = key_of(of).hex(), found.entry
    return Result(
        runs=found.examples,
        failed=0 if failure is None else 1,
        failures=() if failure is None else (failure,),
        values={
            "property": of.name,
            "silent": found.silent,
            "drawn": found.drawn,
            "example": found.example,
            "entries": [] if entry is None else [[key, entry.hex()]],
        },
    )


def _total(part: Part, results: Iterable[Result]) -> Values:
    """Counts of each property, and all failing examples."""
    counts: dict[str, dict[str, Any]] = {
        name: {"examples": 0, "chunks": 0, "failed": 0, "silent": {}, "simplest": ""}
        for name in part.asked["properties"]
    }
    entries: list[list[str]] = []
    for one in results:
        count = counts[one.values["property"]]
        count["examples"] += one.runs
        count["chunks"] += 1
        count["failed"] += one.failed
        for why, number in one.values["silent"].items():
            count["silent"][why] = count["silent"].get(why, 0) + number
        example = one.values["example"]
        count["simplest"] = min(
            filter(None, (count["simplest"], example)), key=_size_of, default=""
        )
        entries = entries_of(({"entries": entries}, one.values))
    return {"properties": counts, "entries": entries}


def _size_of(example: str) -> tuple[int, str]:
    return len(example), example


PROPERTY = Kind(
    name="property",
    unit="examples",
    given=_given,
    count=_count,
    prepare=_prepare,
    execute=_execute,
    total=_total,
    tell=tell,
    keep=keep,
    replay=replay,
)
