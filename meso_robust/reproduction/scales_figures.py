"""Margin and success over the part's size."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure as Drawing

from meso_robust.reporting.canvas import INK, MUTED
from meso_robust.reporting.theme import BLUE, GREEN, VERMILION
from meso_robust.reproduction.drawing import pictured
from meso_robust.reproduction.shrunk import Certified, Errors

COLOURS = (BLUE, GREEN, VERMILION)


@dataclass(frozen=True, slots=True, kw_only=True)
class AtSize:
    """Everything at one size."""

    length_um: float
    certified: Mapping[Errors, Certified]
    free: Mapping[Errors, float]
    """Share of runs that end in the goal without adhesion."""
    held: Mapping[str, float]
    """The same with adhesion, all errors shrunk with the part, by the name of the pull."""


@pictured(
    "scales",
    "Left: factor on all uncertainties at which the shrunk task is still proved; below the line at 1 "
    "there is no certificate (hollow). Right: share of simulated runs that end in the goal. Lines: "
    "without adhesion, by what happens to the errors. Dashed: with adhesion, all errors shrunk. "
    "Certificates are about the model without adhesion.",
)
def figure(sizes: Sequence[AtSize]) -> Drawing:
    """Both panels; the lengths in um on a logarithmic axis."""
    length = [at.length_um for at in sizes]
    canvas = Drawing(figsize=(9.6, 4.2), layout="constrained")
    left, right = canvas.subplots(1, 2)
    for colour, errors in zip(COLOURS, sizes[0].certified, strict=False):
        margin = [at.certified[errors].margin for at in sizes]
        left.plot(length, margin, color=colour, lw=1.2, label=f"errors: {errors}")
        for at in sizes:
            one = at.certified[errors]
            inside = colour if one.proved else "white"
            left.plot(at.length_um, one.margin, marker="o", ms=5, mec=colour, mfc=inside)
        free = [100.0 * at.free[errors] for at in sizes]
        right.plot(length, free, color=colour, lw=1.4, marker="o", ms=3.5)
    for k, name in enumerate(sizes[0].held):
        held = [100.0 * at.held[name] for at in sizes]
        shade = str(0.65 - 0.3 * k)
        right.plot(length, held, color=shade, lw=1.4, ls="--", marker="s", ms=3.5, label=name)
    left.axhline(1.0, color=INK, lw=0.8)
    left.set_ylabel("factor that is proved")
    right.set_ylabel("runs in the goal in %")
    for axes in (left, right):
        axes.set_xscale("log")
        axes.set_xticks([100, 200, 400, 800, 1600], ["100", "200", "400", "800", "1600"])
        axes.set_xticks([], minor=True)
        axes.set_xlabel("length of the part in µm", color=MUTED)
        axes.legend(frameon=False, fontsize=8.0, loc="best")
    return canvas
