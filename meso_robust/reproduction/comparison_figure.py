"""Success of the plans side by side, with exact intervals and what the paper prints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure as Canvas

from meso_robust.campaigns.intervals import share_interval
from meso_robust.reporting.canvas import CERTIFIED, MUTED, OPEN
from meso_robust.reproduction.drawing import drawn
from meso_robust.reproduction.item import Figure

LOOKS = {"RRT": (OPEN, "s"), "scripted": (MUTED, "^"), "certified": (CERTIFIED, "o")}
_CAPTION = (
    "Share of runs that end in the goal, with exact 95 % intervals (mostly smaller than the marks); "
    "in grey what the paper prints of its experiments."
)


Hits = Mapping[str, Sequence[int]]
Printed = Mapping[str, tuple[float, float]]


def figure(cases: Sequence[str], hits_of_runs: Hits, printed: Printed) -> Figure:
    """One line for every plan under every set of errors.

    Parameters
    ----------
    cases
        The errors in words.
    hits_of_runs
        Successes and runs by ``plan: errors``.
    printed
        Success in % by plan, from and to.
    """
    return drawn(lambda: _canvas(cases, hits_of_runs, printed), "comparison", _CAPTION)


def _canvas(cases: Sequence[str], hits_of_runs: Hits, printed: Printed) -> Canvas:
    canvas = Canvas(figsize=(11.0, 3.4), layout="constrained")
    axes, labels, line = canvas.subplots(), [], 0
    for case in cases:
        for name, (colour, mark) in LOOKS.items():
            if f"{name}: {case}" not in hits_of_runs:
                continue
            hits, runs = hits_of_runs[f"{name}: {case}"]
            low, high = share_interval(hits, runs)
            axes.plot(printed[name], (line, line), color="#cbd2d9", lw=9, solid_capstyle="butt")
            axes.plot((100.0 * low, 100.0 * high), (line, line), color=colour, lw=2)
            axes.plot(100.0 * hits / runs, line, mark, color=colour, ms=6)
            labels.append(f"{name}; {case.split(':')[0].split(',')[0]}")
            line += 1
    axes.set_yticks(range(line), labels)
    axes.invert_yaxis()
    axes.set_xlim(-2.0, 102.0)
    axes.set_xlabel("runs in the goal, %")
    return canvas
