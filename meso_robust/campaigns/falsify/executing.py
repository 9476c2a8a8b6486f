"""Doing a chunk: draws in bulk, a search, or a threshold."""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Any

import numpy as np

from meso_robust.campaigns.coverage import histogram
from meso_robust.campaigns.falsify.budgeted_search import Problem, Rare, search
from meso_robust.campaigns.falsify.draws import drawn
from meso_robust.campaigns.falsify.failures import failures
from meso_robust.campaigns.falsify.methods import SEARCHES
from meso_robust.campaigns.falsify.ready import Ready
from meso_robust.campaigns.falsify.section import Bisection, Bulk, Search, work_of
from meso_robust.campaigns.falsify.targets import failing, scorer
from meso_robust.campaigns.falsify.threshold import LARGEST, threshold
from meso_robust.campaigns.falsify.totals import counts, totals
from meso_robust.campaigns.hardest import hardest, hexadecimal
from meso_robust.campaigns.kind import Part, Result, Values
from meso_robust.campaigns.planned import largest_factor
from meso_robust.certificates.margin import margin
from meso_robust.laboratory.judging import judge
from meso_robust.laboratory.replay import limits, miss
from meso_robust.laboratory.running import PlanRun
from meso_robust.primitives.setup import setup_of
from meso_robust.types import Floats


def execute(ready: Ready, part: Part, chunk: int) -> Result:
    """Do a chunk; see ``Kind.execute``."""
    work, rng = work_of(part, chunk), part.rng(chunk)
    if isinstance(work, Bulk):
        return _bulk(ready, work, rng)
    if isinstance(work, Search):
        return _search(ready, work, rng, int(part.asked["evaluations"]))
    return _threshold(ready, work, part.seed)


def _bulk(ready: Ready, work: Bulk, rng: np.random.Generator) -> Result:
    """Draws, each run held against every claim."""
    low, high = limits(ready.player)
    rows = drawn(work.method, work.runs, (low, high), ready.seeds, rng)
    judged = judge(ready.player, ready.claims, rows)
    shares = _problem(ready, ready.targets[0].name).shares(rows)
    leading = shares[:, : ready.player.leading]
    found = totals(judged, ready.claims, histogram(rows, low, high), leading)
    return Result(
        runs=found.runs,
        failed=found.failed,
        failures=failures(ready, judged, rows, f"{work.method} draws"),
        values={
            "does": "draws",
            "method": work.method,
            "totals": asdict(found),
            "reached": _reached(ready, judged.runs, rows),
            "hardest": _hardest(ready, judged.runs, rows),
        },
    )


def _reached(ready: Ready, runs: PlanRun, rows: Floats) -> dict[str, float | str | None]:
    """Highest value of every target that looks at no path."""
    draws = ready.player.draws_of(rows)
    return {
        target.name: finite(float(failing(runs, target.measure(runs, draws)).max()))
        for target in ready.targets
        if not target.record
    }


def _hardest(ready: Ready, runs: PlanRun, rows: Floats) -> list[list[Any]]:
    """Completed runs that end farthest from the middle of the goal: tolerances, and the row."""
    away = miss(runs, ready.player.setup)
    return [[float(away[k]), hexadecimal(rows[k])] for k in hardest(away)]


def _problem(ready: Ready, name: str) -> Problem:
    target, (low, high) = ready.target(name), limits(ready.player)
    score = scorer(ready.player, target)
    return Problem(score=score, low=low, high=high, limit=target.limit)


def _search(ready: Ready, work: Search, rng: np.random.Generator, budget: int) -> Result:
    """One search; where it ends is run by itself and held against every claim."""
    problem = _problem(ready, work.target)
    summit, rare = search(SEARCHES[work.method], problem, rng, budget)
    rows = summit.row[None]
    judged = judge(ready.player, ready.claims, rows)
    how = f"{work.method} towards {work.target!r}"
    return Result(
        runs=summit.evaluations + 1,
        failed=int(judged.any_broken.sum()),
        failures=failures(ready, judged, rows, how),
        values={
            "does": "search",
            "method": work.method,
            "target": work.target,
            "highest": finite(summit.value),
            "row": hexadecimal(summit.row),
            "evaluations": summit.evaluations,
            "broken": counts(judged),
            "unfinished": int(judged.unfinished.sum()),
            "rare": None if rare is None else _rare(rare),
            "hardest": _hardest(ready, judged.runs, rows),
        },
    )


def _rare(rare: Rare) -> Values:
    return {name: finite(value) for name, value in asdict(rare).items()}


def _threshold(ready: Ready, work: Bisection, seed: int) -> Result:
    """One threshold; the event-driven engine, whatever the part's, and at factors of its own.

    What is broken at a larger factor than the part's breaks nothing that is claimed.
    """
    player, task = ready.plan.feedback, ready.plan.task
    found = threshold(
        replace(player, engine="events"),
        lambda factor: setup_of(task, factor),
        work.wanted,
        seed=seed,
        largest=min(LARGEST, largest_factor(task)),
    )
    at = found.breaking
    return Result(
        runs=found.executions,
        failed=0,
        failures=(),
        values={
            "does": "threshold",
            "wanted": work.wanted.value,
            "certified": margin(player.rules, task).factor,
            "holds": found.holds,
            "breaks": None if at is None else at.factor,
            "claims": [] if at is None else [claim.words for claim in at.claims],
            "row": [] if at is None else hexadecimal(at.row),
        },
    )


def finite(value: float) -> float | str | None:
    """A value for JSON: minus infinity says nothing, plus infinity is a word."""
    if value == np.inf:
        return "inf"
    return None if value == -np.inf else value


def value_of(told: float | str | None) -> float:
    """The inverse of :func:`finite`."""
    return -np.inf if told is None else float(told)
