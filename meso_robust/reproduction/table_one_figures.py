"""Pictures of Table I: the support points, and how far apart the sets move the part."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure as Drawing

from meso_robust import units
from meso_robust.identification.search import Scores
from meso_robust.reporting.canvas import (
    BEFORE,
    GHOST,
    INK,
    MUTED,
    corners,
    fit_equal,
    outline,
    panel,
)
from meso_robust.reproduction.drawing import pictured
from meso_robust.reproduction.eight_tests import TESTS
from meso_robust.reproduction.manipulation_figures import COLOURS
from meso_robust.reproduction.printed import PART, POINTS, three_points

_UPRIGHT = np.array([0.0, 0.0, 0.5 * np.pi])  # as the part stands in Fig. 6
_AREA = 900.0  # of a point that carries all the weight
_AXES = ("x", "y", "θ")


@pictured(
    "points",
    "Fig. 6: support points of p1* and p2* in the frame of Table I. Areas and figures "
    "are the shares of the weight, which the paper does not print.",
    "Support points of both sets in the part",
)
def points_figure() -> Drawing:
    """Both sets in the part, the area of a point by its load: Fig. 6."""
    picture, axes = panel(4.6, 6.2)
    outline(axes, _UPRIGHT, PART.outline, "part", fc="none", ec=BEFORE, lw=1.4)
    axes.plot(0.0, 0.0, marker="+", ms=11, color=INK, ls="none", label="centre of mass")
    for name, own in POINTS.items():
        at, loads = corners(_UPRIGHT, own), three_points(name).loads[0]
        axes.fill(*at.T, fc="none", ec=COLOURS[name], lw=0.9, ls="--")
        axes.scatter(
            at[:, 0], at[:, 1], s=_AREA * loads, color=COLOURS[name], alpha=0.75, label=name
        )
        for place, load in zip(at, loads, strict=True):
            axes.annotate(
                f"{100.0 * load:.1f} %",
                place,
                xytext=(0, 13),
                textcoords="offset points",
                ha="center",
                bbox={"fc": "white", "ec": "none", "alpha": 0.8, "pad": 0.4},
            )
    axes.legend(loc="upper left", bbox_to_anchor=(0.5, 0.88), frameon=False, markerscale=0.5)
    fit_equal(axes, corners(_UPRIGHT, PART.outline), 0.06)
    return picture


@pictured(
    "between",
    "Eq. (3) axis by axis between the two sets, test by test; grey: the errors that the "
    "paper reports of each against experiments.",
    "Differences of the two sets in every test",
)
def errors_figure(between: Scores, length: float) -> Drawing:
    """Root mean squares between the sets in every test, beside what the paper reports."""
    picture = Drawing(figsize=(8.0, 3.0))
    axes = picture.subplots()
    axes.axhspan(20.0, 40.0, color=GHOST, alpha=0.5, lw=0, label="printed errors of a fit")
    axes.axhline(80.0, color=MUTED, lw=1.0, ls="--", label="twice the largest")
    places, width = np.arange(len(TESTS)), 0.26
    shades = (COLOURS["film"], COLOURS["p2*"], INK)
    for k, (name, shade) in enumerate(zip(_AXES, shades, strict=True)):
        label = name if k < 2 else f"θ times {length / units.UM:.0f} µm"
        heights = between.axes[0, :, k] / units.UM
        axes.bar(places + (k - 1) * width, heights, width, color=shade, label=label)
    axes.set_xticks(places, TESTS, color=INK)
    axes.grid(visible=False, axis="x")
    axes.set_ylabel("RMS between p1* and p2* in µm")
    axes.set_ylim(0.0, 110.0)
    axes.legend(frameon=False, ncols=5, loc="upper center", columnspacing=1.0)
    picture.subplots_adjust(left=0.09, right=0.99, top=0.97, bottom=0.1)
    return picture
