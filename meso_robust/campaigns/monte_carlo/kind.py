"""The kind *monte-carlo*: how often a plan ends in its goal, with an exact interval."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from decimal import ROUND_FLOOR
from typing import Any

import numpy as np
import numpy.typing as npt

from meso_robust.campaigns.coverage import BINS, coverage, histogram
from meso_robust.campaigns.hardest import HARDEST, hardest, hexadecimal, paths, row_of
from meso_robust.campaigns.intervals import ends_told, percent, share_interval
from meso_robust.campaigns.kind import (
    MOST_FAILURES,
    Bars,
    Failure,
    Kind,
    Part,
    Paths,
    Result,
    Table,
    Told,
    Values,
    Verdict,
)
from meso_robust.campaigns.planned import GivenPlan, given_plan, plan_of
from meso_robust.laboratory.draws import at_shares
from meso_robust.laboratory.endings import ending, words
from meso_robust.laboratory.engines import Engine
from meso_robust.laboratory.judging import UNFINISHED
from meso_robust.laboratory.replay import Feedback, Player, limits, miss
from meso_robust.laboratory.running import PlanRun, why
from meso_robust.laboratory.simulation import in_goal
from meso_robust.laboratory.witness_file import replay_files
from meso_robust.simulator import Outcome
from meso_robust.types import Floats
from meso_robust.wording import do

OF = {
    "uniform": ", drawn uniformly from the uncertainty box,",
    "corners": " at corners of the uncertainty box",
}
"""What the executions are a sample of."""
MISSES = 40  # bins of the miss, from 0 to FAR
FAR = 2.0  # tolerances
DRAWN = 24  # intervals of each move of a run that is drawn
CHUNK = {"events": 20_000, "stepper": 1_000}
"""Executions of a chunk, some seconds of work."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Ready:
    given: GivenPlan
    player: Player
    size: int


def _count(part: Part) -> int:
    return -(-int(part.asked["executions"]) // _size(part))


def _size(part: Part) -> int:
    return int(part.asked["chunk"] or CHUNK[part.asked["engine"]])


def _prepare(part: Part) -> _Ready:
    given = plan_of(part)
    engine: Engine = part.asked["engine"]
    return _Ready(given=given, player=given.player(engine), size=_size(part))


def drawn(part: Part, player: Player, chunk: int, size: int) -> Floats:
    """(N, D) rows of a chunk; the last chunk may have fewer than ``size``."""
    rows = min(size, int(part.asked["executions"]) - chunk * size)
    low, high = limits(player)
    share = part.rng(chunk).random((rows, len(low)))
    if part.asked["draws"] == "corners":
        share = np.rint(share)
    return at_shares(share, low, high)


def _execute(ready: _Ready, part: Part, chunk: int) -> Result:
    player = ready.player
    rows = drawn(part, player, chunk, ready.size)
    runs = player.run(rows)
    good, away = in_goal(runs, player.setup), miss(runs, player.setup)
    hard = hardest(away)
    bad = np.flatnonzero(~good & ~np.isin(runs.outcomes, UNFINISHED))
    return Result(
        runs=len(rows),
        failed=int(bad.size),
        failures=tuple(_failure(ready, part, rows, runs, int(row)) for row in bad[:MOST_FAILURES]),
        values={
            "in_goal": int(good.sum()),
            "unfinished": int(np.isin(runs.outcomes, UNFINISHED).sum()),
            "outcomes": _outcomes(runs, good),
            "misses": _misses(away),
            "covered": histogram(rows, *limits(player)),
            "hardest": [[away[row].item().hex(), hexadecimal(rows[row])] for row in hard],
        },
    )


def _outcomes(runs: PlanRun, good: npt.NDArray[np.bool_]) -> dict[str, int]:
    """Runs by how they ended; a code of the simulator by its number, named when reported."""
    codes, counts = np.unique(runs.outcomes[~good], return_counts=True)
    return {str(code): int(n) for code, n in zip(codes, counts, strict=True)}


def _misses(away: Floats) -> list[int]:
    """(MISSES + 1,) runs by their miss; the last bin has all that are farther."""
    known = np.minimum(away[~np.isnan(away)] * (MISSES / FAR), MISSES).astype(int)
    return [int(n) for n in np.bincount(known, minlength=MISSES + 1)]


def _failure(ready: _Ready, part: Part, rows: Floats, runs: PlanRun, row: int) -> Failure:
    how, player = _how(ready.player, runs, row), ready.player
    alone = player.run(rows[row][None])
    if in_goal(alone, player.setup)[0]:
        # the stepper's steps depend on the longest travel of a batch
        detail = f"{how}; run by itself it ends in the goal: too close to call for this engine"
        return Failure(what=how, detail=detail, files={})
    return Failure(
        what=how,
        detail=f"{how}; replay it with the files beside the report",
        files=replay_files(
            ready.given.task,
            ready.given.plan,
            ready.player,
            rows[row],
            factor=ready.given.factor,
            engine=player.engine if isinstance(player, Feedback) else "stepper",
            breaks=(how,),
        ),
    )


def _how(player: Player, runs: PlanRun, row: int) -> str:
    end = ending(player, runs, row)
    if end.move is None:
        return "the last pose misses the goal"
    return f"move {end.move + 1}: {words(end.outcome, end.touching)}"


def _total(part: Part, results: Iterable[Result]) -> Values:
    """Sums of counts; the hardest runs of all, the first of equals."""
    runs, good, unfinished = 0, 0, 0
    outcomes: dict[str, int] = {}
    misses = np.zeros(MISSES + 1, dtype=np.int64)
    covered = np.zeros((0, BINS), dtype=np.int64)
    hard: list[Any] = []
    for one in results:
        values = one.values
        runs, good = runs + one.runs, good + values["in_goal"]
        unfinished += values["unfinished"]
        for code, count in values["outcomes"].items():
            outcomes[code] = outcomes.get(code, 0) + count
        misses += np.array(values["misses"])
        found = np.array(values["covered"])
        covered = covered + found if len(covered) else found
        hard = sorted([*hard, *values["hardest"]], key=lambda h: -float.fromhex(h[0]))
        hard = hard[:HARDEST]
    return {
        "executions": runs,
        "in_goal": good,
        "unfinished": unfinished,
        "outcomes": dict(sorted(outcomes.items())),
        "misses": misses.tolist(),
        "covered": covered.tolist(),
        "hardest": hard,
    }


def _tell(part: Part, totals: Values) -> Told:
    runs, good = int(totals["executions"]), int(totals["in_goal"])
    if runs == 0:
        return Told(verdict="measured", answer="No chunk was done.", figures=(), views=())
    unfinished, wanted = int(totals["unfinished"]), part.asked["at_least"]
    low = share_interval(good, runs, part.confidence)[0]
    # what the engine could not finish may have ended in the goal or not
    high = share_interval(good + unfinished, runs, part.confidence)[1]
    ends = ends_told(low, high)
    answer = (
        f"{good:,} of {runs:,} execution{'s' * (runs != 1)}{OF[part.asked['draws']]} {do(runs, 'end')} in the goal: "
        f"{percent(good / runs, ROUND_FLOOR)} ({100 * part.confidence:g} % interval {' to '.join(ends)})."
    )
    if unfinished:
        answer += (
            f" The engine could not finish {unfinished:,}; the interval allows for either end."
        )
    verdict, word = _judged(low, high, wanted)
    if wanted is not None:
        answer += f" Success of at least {percent(wanted)} {word}."
    ready = _prepare(part)
    names = tuple(column.name for column in ready.player.columns)
    return Told(
        verdict=verdict,
        answer=answer,
        figures=(
            ("success", percent(good / runs, ROUND_FLOOR)),
            ("exact interval", " … ".join(ends)),
        ),
        views=(
            _endings(totals, runs, part.confidence),
            *_pictures(ready, totals),
            coverage(names, totals["covered"]),
        ),
    )


def _judged(low: float, high: float, wanted: float | None) -> tuple[Verdict, str]:
    """What an interval says of a demanded share, and in words."""
    if wanted is None:
        return "measured", ""
    if low >= wanted:
        return "held", "is shown"
    return (
        ("broken", "is refuted") if high < wanted else ("open", "is not shown: take more of them")
    )


def _endings(totals: Values, runs: int, confidence: float) -> Table:
    """How executions ended, each with its exact interval."""
    counts = [("in the goal", int(totals["in_goal"]))]
    for code, count in totals["outcomes"].items():
        missed = int(code) == Outcome.COMPLETED
        ending = "completed, the last pose misses the goal" if missed else why(int(code))
        counts.append((ending, int(count)))
    rows = []
    for name, count in counts:
        low, high = share_interval(count, runs, confidence)
        rows.append((name, f"{count:,}", *ends_told(low, high)))
    return Table(
        title="How executions ended",
        head=("ending", "executions", "at least", "at most"),
        rows=tuple(rows),
        note=f"Exact (Clopper–Pearson) {100 * confidence:g} % intervals of the share.",
    )


def _pictures(ready: _Ready, totals: Values) -> tuple[Bars | Paths, ...]:
    """How far the runs ended from the middle of the goal, and the hardest of them drawn."""
    per = MISSES // 10
    counts = np.array(totals["misses"])
    tenths = [int(n) for n in np.add.reduceat(counts, range(0, MISSES + 1, per))]
    width = FAR / (len(tenths) - 1)
    labels = [f"{k * width:.1f} … {(k + 1) * width:.1f}" for k in range(len(tenths) - 1)]
    spread = Bars(
        title="Distance of the last pose from the middle of the goal, in tolerances",
        unit="executions",
        labels=(*labels, f"farther than {FAR:g}"),
        values=tuple(float(n) for n in tenths),
        note="Up to 1 is in the goal; the largest of the three coordinates counts.",
    )
    return (spread, *_hardest_drawn(ready, totals))


def _hardest_drawn(ready: _Ready, totals: Values) -> tuple[Paths, ...]:
    if not totals["hardest"]:
        return ()
    rows = np.array([row_of(row) for _, row in totals["hardest"]])
    runs = ready.player.run(rows, record=DRAWN)
    labels = [f"{float.fromhex(away):.3f} tolerances" for away, _ in totals["hardest"]]
    return (paths("Hardest executions", ready.player, runs, labels),)


MONTE_CARLO = Kind(
    name="monte-carlo",
    unit="executions",
    given=given_plan,
    count=_count,
    prepare=_prepare,
    execute=_execute,
    total=_total,
    tell=_tell,
)
