"""Clocks and tables of the benchmarks."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

_T = TypeVar("_T")


@dataclass(frozen=True, slots=True, kw_only=True)
class Clock:
    """Shortest times of a piece of work in s."""

    wall: float
    cpu: float
    """Processor time of all threads: what one thread would take on a machine with nothing else to do."""


def best(work: Callable[[_T], object], setup: Callable[[], _T], repeats: int = 7) -> Clock:
    """Shortest times of a piece of work, the first call (which may compile) left out.

    Parameters
    ----------
    work
        What is timed; it gets what `setup` made for it.
    setup
        Called before each time, not timed.
    repeats
        How often; the shortest wall time and the shortest processor time are kept.
    """
    work(setup())
    walls, cpus = [], []
    for _ in range(repeats):
        item = setup()
        wall, cpu = time.perf_counter(), time.process_time()
        work(item)
        walls.append(time.perf_counter() - wall)
        cpus.append(time.process_time() - cpu)
    return Clock(wall=min(walls), cpu=min(cpus))


def best_of(work: Callable[[], object], repeats: int = 7) -> Clock:
    """Shortest times of a piece of work that needs nothing made for it; see `best`."""
    return best(lambda _: work(), lambda: None, repeats)


def once(work: Callable[[], object]) -> Clock:
    """Times of a piece of work done once, what it may compile included."""
    wall, cpu = time.perf_counter(), time.process_time()
    work()
    return Clock(wall=time.perf_counter() - wall, cpu=time.process_time() - cpu)


def table(title: str, heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Lines of a section with a Markdown table, the first column aligned left."""
    lines = [" | ".join(heads), " | ".join([":--"] + ["--:"] * (len(heads) - 1))]
    lines += [" | ".join(row) for row in rows]
    return [f"## {title}", "", *(f"| {line} |" for line in lines), ""]


def reached(value: float, target: float, most: bool = False) -> tuple[str, str]:
    """Cells of a target and of whether a value reaches it.

    Parameters
    ----------
    value, target
        In the same unit.
    most
        Whether the target is the largest value allowed rather than the least.
    """
    met = value <= target if most else value >= target
    return f"{'≤' if most else '≥'} {number(target)}", "yes" if met else "NO"


def number(value: float) -> str:
    """Three digits, without an exponent from a thousandth to ten millions."""
    if value == 0.0:
        return "0"
    if abs(value) >= 1000.0:
        return f"{value:,.0f}"
    return f"{value:.3g}"
