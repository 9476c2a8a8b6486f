"""What a process costs: compiling, keeping compiled code on disk, and a second thread."""

import os
import subprocess
import sys
import tempfile
import tracemalloc
from functools import partial

import numpy as np

from meso_robust.simulator import Push, simulate
from reports.benchmarks.timing import best_of, number, table
from tests.simulator.problems import UM, two_sided

RUNS = 10_000
_NOTE = [
    "Threads share all arrays of a batch; nothing is copied for them. The last speed-up is not "
    "measured but inferred: twice the processor time of one thread over that of two threads together.",
    "",
]


def _first_call(cache: str) -> tuple[str, ...]:
    """Times of a fresh process with a given folder for compiled code."""
    done = subprocess.run(
        [sys.executable, "-m", "reports.benchmarks.first_call"],
        env={**os.environ, "NUMBA_CACHE_DIR": cache},
        check=True,
        capture_output=True,
        text=True,
    )
    return tuple(number(float(word)) for word in done.stdout.split())


def compiling() -> list[str]:
    """Lines on the first call of a process, with and without compiled code on disk."""
    with tempfile.TemporaryDirectory() as cache:
        rows = [("nothing compiled yet", *_first_call(cache))]
        rows.append(("compiled code on disk", *_first_call(cache)))
    heads = ("a fresh process, s (wall clock)", "imports", "first push", "first event-driven push")
    return table("Compiling", heads, rows)


def _peak_bytes(push: Push, workers: int) -> int:
    """Most bytes allocated by a batch."""
    tracemalloc.start()
    simulate(push, workers=workers)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak


def threads() -> list[str]:
    """Lines on a batch of many runs by one thread and by two."""
    push = two_sided(np.linspace(900, 1300, RUNS) * UM, 1000 * UM, 5 * UM)
    one, two = (best_of(partial(simulate, push, workers=workers), 6) for workers in (1, 2))
    extra = _peak_bytes(push, 2) - _peak_bytes(push, 1)
    rows = [
        ("1", number(one.wall), number(one.cpu), "", "", ""),
        (
            "2", number(two.wall), number(two.cpu), number(one.wall / two.wall),
            number(2.0 * one.cpu / two.cpu), f"{max(extra, 0):,}",
        ),
    ]  # fmt: skip
    heads = (
        "threads", "s (wall clock)", "s (CPU time)", "speed-up", "inferred on free cores",
        "bytes more than one thread",
    )  # fmt: skip
    lines = table(f"A batch of {RUNS:,} runs of {push.steps} steps", heads, rows)
    return [*lines, *_NOTE]
