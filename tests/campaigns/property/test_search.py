"""Searching and shrinking: counts, purity, and what the simplest failing example is."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import strategies as st

from meso_robust.campaigns.property.law import Breach, Cost, Property, Silence, Verdict
from meso_robust.campaigns.property.search import replayed, search
from tests.nightly import at_night

ROOT = Path(__file__).parents[3]
Pair = tuple[float, int]
PAIRS = st.tuples(st.floats(0.0, 10.0), st.integers(0, 10))


def law(check: Callable[[Pair], Verdict], cost: Cost = Cost.CHEAP) -> Property:
    return Property(
        name="a-law", statement="", agreement="", examples=PAIRS, check=check, cost=cost
    )


def sums_stay_small(pair: Pair) -> Verdict:
    return Breach(what="too large", detail=f"{sum(pair)}") if sum(pair) > 15 else None


@pytest.mark.parametrize("examples", [1, 2, 37, 500])
def test_a_budget_is_spent_to_the_last_example(examples: int) -> None:
    seen: list[Pair] = []
    found = search(law(lambda pair: seen.append(pair)), examples, 3)
    assert found.examples == len(seen) == examples
    assert found.breach is None
    assert found.entry is None


def test_examples_are_spread_over_the_range_and_reach_its_ends() -> None:
    seen: list[Pair] = []
    search(law(lambda pair: seen.append(pair)), 2000, 3)
    numbers = [x for x, _ in seen[1:]]
    assert seen[0] == (0.0, 0)
    for low in range(10):  # a tenth of the range has 9 % and, at an end, 5 % more
        share = sum(low <= x <= low + 1 for x in numbers) / 1999
        assert share == pytest.approx(0.14 if low in (0, 9) else 0.09, abs=0.025)
    assert {k for _, k in seen} == set(range(11))
    assert len(set(numbers)) > 1700


def test_the_search_ends_at_the_first_failure_which_is_made_simple() -> None:
    first = next(
        k
        for k, pair in enumerate(_drawn(200, 5), start=1)
        if isinstance(sums_stay_small(pair), Breach)
    )
    found = search(law(sums_stay_small), 200, 5)
    assert found.examples == first
    assert found.example == "(6.0, 10)"
    assert found.breach == Breach(what="too large", detail="16.0")


def _drawn(examples: int, seed: int) -> list[Pair]:
    seen: list[Pair] = []
    search(law(lambda pair: seen.append(pair)), examples, seed)
    return seen


def test_a_simpler_example_must_break_the_same() -> None:
    def check(pair: Pair) -> Verdict:
        if pair[0] > 9.0:
            return Breach(what="large", detail="")
        return Breach(what="small", detail="") if pair[0] < 2.0 and pair[1] > 0 else None

    seeds = {search(law(check), 100, seed).breach.what: seed for seed in range(8)}  # type: ignore[union-attr]
    assert set(seeds) == {"large", "small"}
    assert search(law(check), 100, seeds["large"]).example == "(10.0, 0)"
    assert search(law(check), 100, seeds["small"]).example == "(0.0, 1)"


def test_shrinking_stops_after_its_budget() -> None:
    seen: list[Pair] = []

    def check(pair: Pair) -> Verdict:
        seen.append(pair)
        return sums_stay_small(pair)

    found = search(law(check, Cost.COSTLY), 200, 5)
    assert found.breach is not None
    assert len(seen) - found.examples <= Cost.COSTLY.shrinking


def test_silence_is_counted_by_its_reason() -> None:
    found = search(law(lambda pair: Silence("even") if pair[1] % 2 == 0 else None), 100, 1)
    even = sum(k % 2 == 0 for _, k in _drawn(100, 1))
    assert found.silent == {"even": even}


def test_an_unexpected_exception_breaks_the_property() -> None:
    def check(pair: Pair) -> Verdict:
        raise ZeroDivisionError("by nothing")

    found = search(law(check), 10, 1)
    assert found.breach == Breach(what="a-law: raises ZeroDivisionError", detail="by nothing")


def test_a_kept_example_is_tried_again_by_itself() -> None:
    found = search(law(sums_stay_small), 200, 5)
    assert found.entry is not None
    again = replayed(law(sums_stay_small), found.entry)
    assert (again.examples, again.breach, again.example) == (1, found.breach, found.example)
    assert replayed(law(lambda pair: None), found.entry).breach is None


PROGRAM = """
import json, sys
{before}
from hypothesis import strategies as st
from meso_robust.campaigns.property.registry import PROPERTIES
from meso_robust.campaigns.property.laws import convergence
from meso_robust.campaigns.property.search import search
from dataclasses import replace
from meso_robust.campaigns.property.law import Breach
drawn = search(replace(PROPERTIES["certified-is-kept"], check=lambda x: None), 60, 11).drawn
lengths = st.sampled_from([3, 0, 1, 2, 4]).flatmap(
    lambda n: st.lists(st.floats(20.0, 500.0), min_size=n, max_size=n)
)
tried = []
def check(numbers):
    tried.append(numbers)
    odd = sum(numbers) % 1.0 > 0.05 and len(numbers) != 3
    return Breach(what="odd", detail="") if odd and len(numbers) > 1 else None
shrunk = search(replace(convergence.CONVERGENCE, examples=lengths, check=check), 60, 12)
print(json.dumps([tried, drawn, shrunk.drawn, shrunk.example, shrunk.entry.hex(), shrunk.examples]))
"""
BUSY = """
import random
import matplotlib, meso_robust.cli, meso_robust.reporting.plan
import own_module
from hypothesis import HealthCheck, given, settings, strategies as st
@settings(database=None, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.floats(0.0, 1.0), st.floats(20.0, 500.0), st.integers(0, 150), st.lists(st.floats()))
def other(a, b, c, d): random.random()
other()
random.seed(7)
"""


@at_night
def test_a_search_is_the_same_in_any_process_whatever_ran_before(tmp_path: Path) -> None:
    """One process is fresh; the other has more modules with constants, and ran Hypothesis before."""
    (tmp_path / "own_module.py").write_text("A = (123.456, 250.25, 0.125, 101, 149, 333333)\n")
    found = []
    for before in ("", BUSY):
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM.format(before=before)],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": f"{ROOT}:{tmp_path}", "PYTHONHASHSEED": "random"},
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stderr
        found.append(json.loads(done.stdout))
        if not before:
            assert not (tmp_path / ".hypothesis").exists()
    assert found[0] == found[1]
