"""What is reported of a part: nothing but what its chunks found."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from meso_robust.campaigns.encoding import canonical
from meso_robust.campaigns.falsify.adding import total
from meso_robust.campaigns.falsify.executing import execute
from meso_robust.campaigns.falsify.section import Wanted
from meso_robust.campaigns.falsify.summary import tell
from meso_robust.campaigns.falsify.views import pooled
from meso_robust.campaigns.kind import Bars, Coverage, Part, Paths, Result, Table, Told
from tests.campaigns.falsify.parts import claiming, paper_ready, part_of, with_side

PART: dict[str, Any] = {
    "methods": ("uniform", "corners", "corner-walk", "splitting"),
    "executions": 400,
    "chunk": 100,
    "restarts": 2,
    "evaluations": 150,
}
SOUGHT = ("move 2: box, y low", "move 4: sticks", "goal, y high")


def with_targets(part: Part) -> Part:
    """Only some of the targets, so that the searches are few."""
    return replace(part, given={**part.given, "targets": list(SOUGHT)})


@cache
def found() -> tuple[Part, tuple[Result, ...]]:
    part = with_targets(part_of(**PART))
    return part, tuple(execute(paper_ready(), part, k) for k in range(4 + 2 * 2 * 3))


def told(results: tuple[Result, ...] | None = None) -> Told:
    part, whole = found()
    return tell(part, total(part, whole if results is None else results))


def table(of: Told, title: str) -> list[dict[str, str]]:
    one = next(v for v in of.views if isinstance(v, Table) and v.title.startswith(title))
    return [dict(zip(one.head, row, strict=True)) for row in one.rows]


def test_the_answer_leads_with_what_was_looked_for() -> None:
    of = told()

    assert of.verdict == "held"
    assert of.answer.startswith("No counterexample in 400 executions and 12 searches. ")
    figures = dict(of.figures)
    assert figures["executions that break a claim"] == "0 of 400"
    assert figures["searches that end in a broken claim"] == "0 of 12"
    # 200 uniform draws: 1 - 0.05 ** (1 / 200)
    bound = 1.0 - 0.05 ** (1.0 / 200.0)
    said = figures["share of uniform draws that break a claim, 95 % bound"]
    high = float(said.removeprefix("at most ").removesuffix(" %"))
    assert 0.0 <= high - 100.0 * bound < 1e-4


def test_every_claim_is_counted_for_draws_and_searches() -> None:
    rows = table(told(), "Claims")

    assert len(rows) == 22
    assert {row["Broken in draws"] for row in rows} == {"0 of 400"}
    assert {row["Broken where a search ended"] for row in rows} == {"0 of 12"}


def test_the_highest_by_each_method_is_that_of_its_chunks() -> None:
    _, results = found()
    rows = {row["Target"]: row for row in table(told(), "Highest that each method found")}

    for target in SOUGHT:
        for method in ("corner-walk", "splitting"):
            values = [
                one.values["highest"]
                for one in results
                if one.values["method"] == method and one.values.get("target") == target
            ]
            assert len(values) == 2
            assert rows[target][method] == f"{max(values):.6f}"
        draws = [o.values["reached"][target] for o in results if o.values["method"] == "uniform"]
        assert rows[target]["uniform"] == f"{max(draws):.6f}"
        cells = {m: float(rows[target][m]) for m in PART["methods"]}
        assert cells[rows[target]["Highest by"]] == max(cells.values())
    assert rows["move 1: start"]["corner-walk"] == "-"  # nobody searched there
    assert len(rows) == 38


def test_pictures_are_of_what_was_run() -> None:
    of = told()
    bars = next(view for view in of.views if isinstance(view, Bars))
    strips = next(view for view in of.views if isinstance(view, Coverage))
    paths = next(view for view in of.views if isinstance(view, Paths))

    assert bars.limit == 1.0
    assert list(bars.values) == sorted(bars.values, reverse=True)
    assert max(bars.values) <= 1.0
    assert len(strips.labels) == 25
    assert {sum(counts) for counts in strips.counts} == {400}
    # the hardest run's last pose is as far from the goal's middle as its label says
    label, poses = paths.runs[0]
    away = (np.abs(np.array(poses[-1]) - paths.goal) / np.array([76.0, 76.0, 5.0])).max()
    assert float(label.split(" ")[0]) == pytest.approx(away, abs=1e-4)
    assert len(paths.runs) == 4
    hardest = max(away for one in found()[1] for away, _ in one.values["hardest"])
    assert float(label.split(" ")[0]) == pytest.approx(hardest, abs=1e-4)


def test_totals_are_json_and_do_not_depend_on_what_is_missing() -> None:
    part, results = found()

    assert json.loads(canonical(total(part, results))) == json.loads(
        json.dumps(total(part, iter(results)))
    )
    some = told(results[1:5])
    assert some.answer.startswith("No counterexample in 300 executions and 1 search.")
    none = told(())
    assert none.verdict == "measured"
    assert none.answer == "Nothing was executed to break a claim."
    assert dict(told(results[4:]).figures).keys() >= {"searches that end in a broken claim"}


def test_a_broken_claim_is_told_first_and_counted() -> None:
    part, _ = found()
    box = paper_ready().claims.posts[1]
    assert box is not None
    small = with_side(paper_ready(), 1, 1, 0, float(box[:, 1].mean()))

    results = tuple(execute(small, part, k) for k in (0, 1, 4))
    of = tell(part, total(part, results))

    broken = sum(one.failed for one in results[:2])
    assert 0 < broken < 200
    assert of.verdict == "broken"
    assert of.answer == (
        f"{broken} of 200 executions and 1 of 1 search break a claim: move 2: ends in its box."
    )
    alone = tell(part, total(part, results[2:]))
    assert (alone.verdict, alone.answer.split(" a claim")[0]) == ("broken", "1 of 1 search breaks")
    row = next(row for row in table(of, "Claims") if row["Claim"] == "move 2: ends in its box")
    assert row["Broken in draws"] == f"{broken} of 200"
    assert row["Broken where a search ended"] == "1 of 1"


def test_beyond_the_certified_uncertainty_nothing_is_held() -> None:
    part = part_of(factor=1.1, methods=("uniform",), executions=50)

    of = tell(part, total(part, [execute(paper_ready(1.1), part, 0)]))

    assert of.verdict == "measured"
    assert "Nothing is certified at 1.1 times the uncertainty" in of.answer


def test_failures_beyond_the_certified_uncertainty_are_measured_and_within_it_break() -> None:
    for factor, verdict in ((1.5, "measured"), (0.9, "broken")):
        part = part_of(factor=factor, methods=("uniform",), executions=50)
        result = execute(paper_ready(factor), part, 0)
        totals = result.values["totals"]
        name = "the last pose lies in the goal"
        broken = {**totals["broken"], name: totals["broken"][name] + 1}
        wrong = {**totals, "failed": totals["failed"] + 1, "broken": broken}
        failing = replace(result, values={**result.values, "totals": wrong})
        of = tell(part, total(part, [failing]))
        assert of.verdict == verdict
        assert "of 50 executions break" in of.answer
        assert name in of.answer


def test_thresholds_and_rare_failures_have_their_tables() -> None:
    part, results = found()
    threshold = Result(
        runs=10,
        failed=0,
        failures=(),
        values={
            "does": "threshold",
            "wanted": Wanted.ANY_MOTION.value,
            "certified": 1.1875,
            "holds": 1.2,
            "breaks": 1.2125,
            "claims": ["move 4: contacts are as claimed"],
            "row": [],
        },
    )
    rare = replace(
        results[-1],
        values={
            **results[-1].values,
            "rare": {
                "probability": 3e-6,
                "variation": 0.4,
                "level": 0.9,
                "level_probability": 1e-5,
            },
        },
    )

    of = tell(part, total(part, [threshold, rare, rare]))

    at = table(of, "Uncertainty at which")[0]
    assert (at["Certified up to factor"], at["Found at factor"]) == ("1.1875", "1.2125")
    row = table(of, "How likely")[0]
    assert row["Probability"] == "3.00e-06 (± 28 %)"  # 40 % / sqrt(2)
    assert row["Estimates"] == "2"


def test_estimates_are_pooled_by_hand() -> None:
    """Mean of 1 and 3; errors 0.5 and 0.3 add to sqrt(0.34) / 2, a share of the mean."""
    two = [{"probability": 1.0, "variation": 0.5}, {"probability": 3.0, "variation": 0.1}]

    assert pooled(two) == pytest.approx((2.0, 0.34**0.5 / 4.0))
    assert pooled([{"probability": 0.0, "variation": 0.7}]) == (0.0, 0.0)


def test_runs_that_could_not_be_finished_leave_the_answer_open() -> None:
    part, results = found()
    one, totals = results[0], results[0].values["totals"]
    stuck = replace(one, values={**one.values, "totals": {**totals, "unfinished": 2}})

    of = tell(part, total(part, [stuck, *results[1:]]))

    assert of.verdict == "open"
    assert "2 of which the engine could not finish" in of.answer
    ended = next(result for result in results if result.values["does"] == "search")
    search = replace(ended, values={**ended.values, "unfinished": 1})
    assert tell(part, total(part, [search])).verdict == "open"
    assert tell(part, total(part, [ended])).verdict == "held"


def test_a_certificate_of_the_first_moves_only_is_none() -> None:
    ready = paper_ready()
    assert ready.certified
    first = replace(ready.claims, posts=(*ready.claims.posts[:2], None, None))
    assert not claiming(ready, first).certified


def test_a_jam_at_a_coarse_step_is_not_told_as_the_nearest() -> None:
    part, results = found()
    search = next(result for result in results if result.values["does"] == "search")
    target = "move 3: box, theta high"
    inf = replace(search, values={**search.values, "target": target, "highest": "inf"})
    of = tell(part, total(part, [*results, inf]))
    assert "inf" not in of.answer
