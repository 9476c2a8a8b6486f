"""Executions of the paper's certified plan a second: ``python -m reports.benchmarks.executions``.

By one process and by two at the same time, one thread each, with rows of their own: by both engines,
plain (the poses between the moves) and held against every claim of the certificate. Medians of
several repetitions; it asserts nothing about time.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import statistics
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path
from threading import Barrier

import numpy as np

from meso_robust.files import write_all
from meso_robust.kernels import one_thread
from meso_robust.laboratory.claims import Claims
from meso_robust.laboratory.engines import Engine
from meso_robust.laboratory.judging import judge
from meso_robust.laboratory.replay import Feedback
from reports.benchmarks.timing import number, reached, table
from tests.laboratory.paper import paper_claims, paper_player

REPEATS = 7
ROWS: dict[Engine, int] = {"events": 20_000, "stepper": 2_000}
TARGETS: dict[Engine, float] = {"events": 3e4, "stepper": 300.0}
NAMES: dict[Engine, str] = {"events": "event-driven", "stepper": "time stepper"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Spell:
    """What one process did: the clock at its start and end, and its processor time, s."""

    start: float
    end: float
    cpu: float


@cache
def _prepared(engine: Engine) -> tuple[Feedback, Claims]:
    return replace(paper_player(), engine=engine), paper_claims()


def _spell(engine: Engine, held: bool, seed: int, together: Barrier) -> Spell:
    """Execute the plan for rows of its own, after a few that warm up."""
    player, claims = _prepared(engine)
    rows = player.draw(ROWS[engine], np.random.default_rng(seed))
    work = partial(judge, player, claims) if held else player.run
    with one_thread():
        work(rows[:10])
        together.wait()
        start, cpu = time.perf_counter(), time.process_time()
        work(rows)
        return Spell(start=start, end=time.perf_counter(), cpu=time.process_time() - cpu)


def rates(processes: int, engine: Engine, held: bool) -> tuple[float, float]:
    """Median executions a second of all processes: by the wall clock, and by processor time."""
    context = multiprocessing.get_context("spawn")
    walls, cpus = [], []
    with context.Manager() as manager, ProcessPoolExecutor(processes, context) as pool:
        together = manager.Barrier(processes)
        for repeat in range(REPEATS):
            seeds = [processes * repeat + k for k in range(processes)]
            jobs = [pool.submit(_spell, engine, held, seed, together) for seed in seeds]
            spells = [job.result() for job in jobs]
            rows = processes * ROWS[engine]
            walls.append(rows / (max(s.end for s in spells) - min(s.start for s in spells)))
            cpus.append(processes * rows / sum(s.cpu for s in spells))
    return statistics.median(walls), statistics.median(cpus)


def _row(engine: Engine, held: bool) -> list[str]:
    """One line: an engine, with or without the claims."""
    (one, one_cpu), (two, two_cpu) = (rates(n, engine, held) for n in (1, 2))
    name = f"{NAMES[engine]}, {'held against the claims' if held else 'plain'}"
    speeds = [number(rate) for rate in (one, one_cpu, two, two_cpu)]
    return [name, *speeds, f"{100 * two / (2 * one):.0f} %", *reached(two, TARGETS[engine])]


def main() -> None:
    """Print the table, or write it as a page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path)
    out = parser.parse_args().out
    load = f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f} before the start"
    heads = (
        "executions a second", "1 process", "by processor time", "2 processes",
        "by processor time", "efficiency", "target of 2", "reached",
    )  # fmt: skip
    rows = [_row(engine, held) for engine in ROWS for held in (False, True)]
    text = "\n".join([load, "", *table("Executions of the paper's plan", heads, rows)])
    if out is None:
        print(text)
        return
    command = f"`python -m reports.benchmarks.executions --out {out}`"
    page = f"# Executions of a plan a second\n\n{command}: {text}\n"
    write_all(out.parent, {out.name: page})


if __name__ == "__main__":
    main()
