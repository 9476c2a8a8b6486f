"""Success of the plans: side by side with exact intervals, and against one uncertainty at a time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure as Drawing

from meso_robust.reporting.canvas import CERTIFIED, GHOST, MUTED, OPEN
from meso_robust.reporting.pages import Figure
from meso_robust.reproduction.drawing import drawn, pictured
from meso_robust.reproduction.item import success

LOOKS = {
    "RRT": (OPEN, "s", ":"),
    "scripted": (MUTED, "^", "--"),
    "certified": (CERTIFIED, "o", "-"),
}
Shares = Mapping[str, Mapping[str, list[float]]]
"""Successes in % by uncertainty and plan, at each multiple of its stated size."""


@pictured(
    "comparison",
    "Share of runs that end in the goal, with exact 95 % intervals (mostly smaller than the marks); "
    "in grey what the paper prints of its experiments.",
)
def compared(
    cases: Sequence[str],
    hits_of_runs: Mapping[str, Sequence[int]],
    printed: Mapping[str, tuple[float, float]],
) -> Drawing:
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
    canvas = Drawing(figsize=(11.0, 3.4), layout="constrained")
    axes, labels, line = canvas.subplots(), [], 0
    for case in cases:
        for name, (colour, mark, _) in LOOKS.items():
            if f"{name}: {case}" not in hits_of_runs:
                continue
            hits, runs = hits_of_runs[f"{name}: {case}"]
            interval = success(hits, runs)
            axes.plot(printed[name], (line, line), color=GHOST, lw=9, solid_capstyle="butt")
            axes.plot(interval, (line, line), color=colour, lw=2)
            axes.plot(100.0 * hits / runs, line, mark, color=colour, ms=6)
            labels.append(f"{name}; {case.split(':')[0].split(',')[0]}")
            line += 1
    axes.set_yticks(range(line), labels)
    axes.invert_yaxis()
    axes.set_xlim(-2.0, 102.0)
    axes.set_xlabel("runs in the goal, %")
    return canvas


def side_by_side(shares: Shares, scale: float, caption: str) -> Figure:
    """Scripted and certified plan at the largest multiple of each uncertainty, a pair of bars each.

    Parameters
    ----------
    shares, scale
        Successes, and the largest multiple.
    caption
        What is to be seen.
    """
    return drawn(lambda: _pairs(shares, scale), "tolerated", caption)


def _pairs(shares: Shares, scale: float) -> Drawing:
    canvas = Drawing(figsize=(8.0, 2.8), layout="constrained")
    axes = canvas.subplots()
    for k, name in enumerate(("scripted", "certified")):
        at = [line + 0.38 * (k - 0.5) for line in range(len(shares))]
        last = [of[name][-1] for of in shares.values()]
        axes.barh(at, last, height=0.34, color=LOOKS[name][0], label=name)
        for place, share in zip(at, last, strict=True):
            axes.text(share + 1.0, place, f"{share:.0f}", va="center", fontsize=8)
    axes.set_yticks(range(len(shares)), list(shares))
    axes.invert_yaxis()
    axes.set_xlim(0.0, 112.0)
    axes.set_xlabel(f"runs in the goal, %, with that uncertainty alone at {scale:g} times its size")
    axes.legend(frameon=False, fontsize=8, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2)
    return canvas


def one_at_a_time(shares: Shares, scales: Sequence[float], caption: str) -> Figure:
    """One panel for each uncertainty: share of successes in % against multiples of its size."""
    label = "Success against one uncertainty at a time"
    return drawn(lambda: _panels(shares, scales), "uncertainties", caption, label)


def _panels(shares: Shares, scales: Sequence[float]) -> Drawing:
    canvas = Drawing(figsize=(11.0, 2.7), layout="constrained")
    panels = canvas.subplots(1, len(shares), sharey=True)
    for axes, (what, of) in zip(panels, shares.items(), strict=True):
        for name, own in of.items():
            colour, marker, line = LOOKS[name]
            axes.plot(scales, own, color=colour, marker=marker, ls=line, ms=4, label=name)
        axes.set_xscale("log", base=2)
        axes.set_xticks(scales, [f"{scale:g}" for scale in scales])
        axes.set_ylim(-4.0, 104.0)
        axes.set_title(what, fontsize=9.5)
        axes.set_xlabel("times its stated size")
    panels[0].set_ylabel("runs in the goal, %")
    panels[0].legend(frameon=False, fontsize=8, loc="lower left")
    return canvas
