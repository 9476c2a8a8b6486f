"""Success against the size of one uncertainty, a panel for each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from markupsafe import Markup
from matplotlib.figure import Figure

from meso_robust.reporting.canvas import CERTIFIED, MUTED, OPEN
from meso_robust.reporting.svg import style, to_svg
from meso_robust.reproduction.drawing import drawn
from meso_robust.reproduction.item import Figure as Picture

LOOKS = {
    "RRT": (OPEN, "s", ":"),
    "scripted": (MUTED, "^", "--"),
    "certified": (CERTIFIED, "o", "-"),
}


def side_by_side(
    shares: Mapping[str, Mapping[str, list[float]]], scale: float, caption: str
) -> Picture:
    """Scripted and certified plan at the largest multiple of each uncertainty, a pair of bars each.

    Parameters
    ----------
    shares
        Successes in % by uncertainty and plan, at each multiple.
    scale
        The largest multiple.
    caption
        What is to be seen.
    """
    return drawn(lambda: _pairs(shares, scale), "tolerated", caption)


def _pairs(shares: Mapping[str, Mapping[str, list[float]]], scale: float) -> Figure:
    canvas = Figure(figsize=(8.0, 2.8), layout="constrained")
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


def figure(shares: Mapping[str, Mapping[str, list[float]]], scales: Sequence[float]) -> Markup:
    """One panel for each uncertainty: share of successes in % against multiples of its size."""
    with style():
        canvas = Figure(figsize=(11.0, 2.7), layout="constrained")
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
        return to_svg(canvas, "uncertainties", "Success against one uncertainty at a time")
