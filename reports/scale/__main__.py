"""How cost grows, and what each verb holds in memory: ``python -m reports.scale [--out FOLDER]``.

Processor time of one thread, so that a busy machine matters little; exponents are slopes over the larger half
of the sizes.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from matplotlib.figure import Figure

from reports.benchmarks.timing import number, table
from reports.scale.curves import CURVES, Curve, exponent

COLUMNS = 4


def measured() -> Iterator[tuple[Curve, list[float]]]:
    """Costs of each curve, s, told as they come."""
    for curve in CURVES:
        costs = curve.costs()
        print(curve.name, [number(cost) for cost in costs], flush=True)
        yield curve, costs


def drawn(found: Sequence[tuple[Curve, list[float]]]) -> Figure:
    """Cost over size, a panel for each."""
    rows = -(-len(found) // COLUMNS)
    chart = Figure(figsize=(3.2 * COLUMNS, 2.9 * rows), layout="constrained")
    for at, (curve, costs) in enumerate(found):
        axes = chart.add_subplot(rows, COLUMNS, at + 1)
        axes.loglog(curve.sizes, costs, "o-", color="#0072b2", markersize=4)
        axes.axvline(curve.usual, color="0.5", linestyle="--", linewidth=1)
        axes.set_title(f"{curve.name}: {exponent(curve.sizes, costs):.2f}", fontsize=8)
        axes.set_xlabel(curve.grows_with, fontsize=8)
        axes.set_ylabel("processor time, s", fontsize=8)
        axes.tick_params(labelsize=7)
        axes.grid(visible=True, which="major", color="0.9")
    return chart


def page(found: Sequence[tuple[Curve, list[float]]], memory: Sequence[tuple[str, float]]) -> str:
    """The page."""
    rows = []
    for curve, costs in found:
        up_to = curve.sizes.index(curve.usual)
        rows.append(
            (
                f"{curve.name}, in {curve.grows_with}",
                f"{curve.usual:,}",
                number(costs[up_to]),
                f"{curve.sizes[-1]:,}",
                number(costs[-1]),
                f"{exponent(curve.sizes, costs):.2f}",
                f"{curve.expected:g}",
            )
        )
    heads = (
        "cost",
        "usual size",
        "s",
        "largest size",
        "s",
        "exponent",
        "at most, by the algorithm",
    )
    text = [
        "# How cost grows", "",
        "Written by `python -m reports.scale`; see the [README](README.md).", "",
        "![Processor time over size, each on logarithmic axes](growth.png)", "",
        *table("Exponents", heads, rows),
        *table("Memory of a verb at its peak", ("verb", "MB"), [(n, f"{m:.0f}") for n, m in memory]),
    ]  # fmt: skip
    return "\n".join(text)


def peaks() -> list[tuple[str, float]]:
    """Megabytes that each verb holds at most, from a process of its own; see `reports.scale.memory`."""
    command = [sys.executable, "-m", "reports.scale.memory"]
    told = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    rows = (line.split("\t") for line in told.splitlines())
    return [(name, float(megabytes)) for name, megabytes in rows]


def main() -> None:
    """Measure, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path(__file__).parent)
    out = parser.parse_args().out
    found = list(measured())
    drawn(found).savefig(out / "growth.png", dpi=110)
    (out / "results.md").write_text(page(found, peaks()), encoding="utf-8")


if __name__ == "__main__":
    main()
