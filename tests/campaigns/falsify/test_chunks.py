"""Chunks: what they are, that they cover what was asked, and that each is always the same."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections import Counter
from typing import Any

import numpy as np
import pytest

from meso_robust.campaigns.encoding import part_text, result_of, result_text
from meso_robust.campaigns.falsify.draws import drawn
from meso_robust.campaigns.falsify.kind import FALSIFY
from meso_robust.campaigns.falsify.methods import SEARCHES
from meso_robust.campaigns.falsify.section import (
    DRAWS,
    METHODS,
    Bisection,
    Bulk,
    FalsifySection,
    Search,
    Wanted,
    work_of,
)
from meso_robust.campaigns.falsify.totals import Totals
from meso_robust.errors import InputError
from meso_robust.laboratory.replay import limits
from tests.campaigns.falsify.parts import ROOT, paper_ready, part_of
from tests.nightly import at_night

DRAWN_ANEW = """
import sys
from meso_robust.campaigns.encoding import part_of, result_text
from meso_robust.campaigns.falsify.kind import FALSIFY
from meso_robust.campaigns.falsify.methods import SEARCHES
part = part_of(sys.stdin.read())
ready = FALSIFY.prepare(part)
for chunk in map(int, sys.argv[1:]):
    print(result_text(FALSIFY.execute(ready, part, chunk)))
"""
SMALL: dict[str, Any] = {
    "methods": ("adversarial", "cma-es", "face-walk", "splitting"),
    "executions": 150,
    "chunk": 100,
    "restarts": 1,
    "evaluations": 200,
}


def test_chunks_cover_what_was_asked_exactly_once() -> None:
    part = part_of(executions=107, chunk=25, restarts=2)
    targets = part.given["targets"]

    works = [work_of(part, k) for k in range(FALSIFY.count(part))]

    bulks = [one for one in works if isinstance(one, Bulk)]
    assert [one.runs for one in bulks] == [25, 25, 25, 25, 7]
    assert [one.method for one in bulks] == [*DRAWS, DRAWS[0]]
    searches = Counter(one for one in works if isinstance(one, Search))
    assert set(searches.values()) == {1}
    assert len(searches) == 5 * 2 * len(targets)
    assert {one.target for one in searches} == set(targets)
    assert [one.wanted for one in works if isinstance(one, Bisection)] == list(Wanted)
    with pytest.raises(IndexError):
        work_of(part, len(works))


def test_targets_are_all_that_can_be_raised() -> None:
    """Four moves: a start each, three that stick, one grasp; four boxes and the goal; four tubes."""
    assert len(part_of().given["targets"]) == 4 + 3 + 1 + 6 * 5 + 4
    assert len(part_of(factor=1.5).given["targets"]) == 4 + 3 + 1 + 6


def test_what_is_not_asked_for_is_not_done() -> None:
    only = part_of(methods=("mixed", "threshold"), executions=10)
    none = part_of(methods=("cma-es",), restarts=1)

    assert [work_of(only, k) for k in range(FALSIFY.count(only))] == [
        Bulk(method="mixed", runs=10),
        *(Bisection(wanted=wanted) for wanted in Wanted),
    ]
    assert FALSIFY.count(none) == len(none.given["targets"])
    assert work_of(none, 0) == Search(method="cma-es", target=none.given["targets"][0], restart=0)


def test_a_chunk_is_of_a_size_that_suits_its_engine() -> None:
    assert work_of(part_of(), 0) == Bulk(method="uniform", runs=20_000)
    assert work_of(part_of(engine="stepper"), 0) == Bulk(method="uniform", runs=1_000)


@pytest.mark.parametrize(
    "wrong", [{"methods": ()}, {"methods": ("guessing",)}, {"executions": 0}, {"evaluations": 3}]
)
def test_what_breaks_a_rule_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        part_of(**wrong)


def test_a_plan_of_bare_moves_is_refused(tmp_path: Any) -> None:
    values = json.loads((ROOT / "reports/paper_task/plan.json").read_text(encoding="utf-8"))
    values["policy"] = []
    bare = tmp_path / "bare.json"
    bare.write_text(json.dumps(values), encoding="utf-8")
    section = FalsifySection.model_validate({"name": "a", "kind": "falsify", "plan": str(bare)})

    with pytest.raises(InputError, match=r"part 'a': key plan = .*must state a policy"):
        FALSIFY.given(section, ROOT)


@at_night
def test_a_chunk_is_the_same_again_in_another_order_and_in_a_fresh_process() -> None:
    part = part_of(**SMALL)
    targets = len(part.given["targets"])
    chunks = [0, 1, 2 + 8, 2 + targets + 9, 2 + 2 * targets + 10]
    ready = FALSIFY.prepare(part)

    once = {k: result_text(FALSIFY.execute(ready, part, k)) for k in chunks}
    again = {k: result_text(FALSIFY.execute(ready, part, k)) for k in reversed(chunks)}
    fresh = subprocess.run(
        [sys.executable, "-c", DRAWN_ANEW, *map(str, chunks)],
        input=part_text(part),
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=True,
    ).stdout.splitlines()

    assert once == again
    assert [once[k] for k in chunks] == fresh
    assert len(set(once.values())) == len(chunks)
    found = [result_of(once[k]) for k in chunks]
    assert [one.values["method"] for one in found] == [
        "adversarial",
        "adversarial",
        "face-walk",
        "cma-es",
        "splitting",
    ]
    assert not any(one.failed for one in found)
    assert all(len(text) < 20_000 for text in fresh)


def test_draws_fill_the_box_as_they_are_named() -> None:
    low, high = limits(paper_ready().player)
    seeds = 0.75 * low[None] + 0.25 * high[None]
    rng = np.random.default_rng(1)

    rows = {how: drawn(how, 400, (low, high), seeds, rng) for how in DRAWS}

    assert all(((r >= low) & (r <= high)).all() for r in rows.values())
    at_end = {how: float(((r == low) | (r == high)).mean()) for how, r in rows.items()}
    assert at_end["corners"] == 1.0
    assert at_end["uniform"] == 0.0
    assert 0.45 < at_end["mixed"] < 0.55
    kept = rows["adversarial"] == seeds
    assert 0.5 < kept.mean() < 0.9
    assert kept.any(axis=0).all()
    assert (~kept).any(axis=0).all()


def test_totals_add_up_to_those_of_all_rows() -> None:
    """Two chunks' totals together: counts add, extremes widen, corners unite."""
    part = part_of(methods=("corners", "uniform"), executions=120, chunk=60)
    ready = paper_ready()

    other, one = (FALSIFY.execute(ready, part, k).values["totals"] for k in range(2))
    both = Totals(**one).plus(Totals(**other))

    assert both.runs == 120
    assert both.failed == 0
    # 4 moves x (start, contacts, withdrawal, box, tube), whether it can be carried out, the goal
    assert list(both.broken.values()) == [0] * 22
    for k, ends in enumerate(both.after):
        assert ends is not None
        each = np.array([one["after"][k], other["after"][k]])
        assert ends[0] == each[:, 0].min(axis=0).tolist()
        assert ends[1] == each[:, 1].max(axis=0).tolist()
    assert np.array(both.covered).sum(axis=1).tolist() == [120] * len(both.covered)
    assert other["corners"] == 0
    assert 0 < both.corners == one["corners"] < 2**64
    assert both.corners.bit_count() <= 60
    assert Totals().plus(both) == both == both.plus(Totals())


def test_all_methods_have_a_name_and_a_place() -> None:
    part = part_of(executions=100, chunk=25, restarts=1)
    done = [work_of(part, k) for k in range(FALSIFY.count(part))]

    names = {getattr(one, "method", "threshold") for one in done}

    assert names == set(METHODS) == {*DRAWS, *SEARCHES, "threshold"}


def test_every_method_of_drawing_has_its_turn_however_few_the_executions() -> None:
    part = part_of(methods=("uniform", "corners", "mixed"), executions=50, chunk=1000)
    works = [work_of(part, k) for k in range(FALSIFY.count(part))]
    assert {work.method for work in works if isinstance(work, Bulk)} == {
        "uniform",
        "corners",
        "mixed",
    }
    assert sum(work.runs for work in works if isinstance(work, Bulk)) == 50
