"""Success against the size of one uncertainty, a panel for each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from markupsafe import Markup
from matplotlib.figure import Figure

from meso_robust.reporting.canvas import CERTIFIED, MUTED, OPEN
from meso_robust.reporting.svg import style, to_svg

LOOKS = {
    "RRT": (OPEN, "s", ":"),
    "scripted": (MUTED, "^", "--"),
    "certified": (CERTIFIED, "o", "-"),
}


def figure(shares: Mapping[str, Mapping[str, list[float]]], scales: Sequence[float]) -> Markup:
    """One panel for each uncertainty: share of successes in % against multiples of its size."""
    with style():
        drawn = Figure(figsize=(11.0, 2.7), layout="constrained")
        panels = drawn.subplots(1, len(shares), sharey=True)
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
        return to_svg(drawn, "uncertainties", "Success against one uncertainty at a time")
