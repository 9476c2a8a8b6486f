"""Pictures of plans on the bench, in Table II's frame: origin top left, y down, um."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.patches import Polygon

from meso_robust.reporting.canvas import AFTER, BEFORE, CERTIFIED, GHOST, INK, MUTED, TIP
from meso_robust.reporting.pages import Figure
from meso_robust.reporting.theme import WALL
from meso_robust.reproduction.bench import Place, Plan, corners
from meso_robust.reproduction.drawing import drawn
from meso_robust.types import Floats
from meso_robust.units import DEG, UM

COLUMNS = 4  # of panels
DOWN = np.array([1.0, -1.0]) / UM


def snapshots(plan: Plan, paths: Sequence[Floats], place: Place, name: str, caption: str) -> Figure:
    """One picture a stroke of the first run.

    Parameters
    ----------
    plan, paths
        Strokes (T, 2), and for each the (N, R, 3) poses on the way.
    place
        The slot.
    name, caption
        As for `drawn`.
    """
    label = "the peg before, during and after each push"
    return drawn(lambda: _snapshots(plan, paths, place), name, caption, label)


def _snapshots(plan: Plan, paths: Sequence[Floats], place: Place) -> Drawing:
    rows = -(-len(plan) // COLUMNS)
    figure = Drawing(figsize=(11.6, 2.9 * rows), layout="constrained")
    panels = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
    for k, (axes, stroke, path) in enumerate(zip(panels, plan, paths, strict=False)):
        _panel(axes, stroke, path[0], place)
        axes.set_title(f"{k + 1}", fontsize=9)
    for axes in panels[len(plan) :]:
        axes.set_axis_off()
    return figure


def _panel(axes: Axes, stroke: Floats, path: Floats, place: Place) -> None:
    for outline in place.fixture.outlines:
        axes.add_patch(Polygon(outline * DOWN, fc=WALL, ec=INK, lw=0.8))
    looks = [(BEFORE, 1.3), *[(GHOST, 0.8)] * (len(path) - 2), (AFTER, 1.5)]
    for outline, (colour, width) in zip(corners(path) * DOWN, looks, strict=True):
        axes.add_patch(Polygon(outline, fc="none", ec=colour, lw=width))
    way = stroke * DOWN
    arrow = {"arrowstyle": "-|>", "color": TIP, "lw": 1.1, "shrinkA": 0, "shrinkB": 0}
    axes.plot(*way.T, color=TIP, lw=1.1)
    axes.annotate("", xy=way[-1], xytext=way[-2], arrowprops=arrow, zorder=7)
    axes.set_xlim(-1150.0, 3450.0)
    axes.set_ylim(2600.0, -200.0)
    axes.set_aspect("equal")
    axes.set_xlabel("x in µm", labelpad=1)
    axes.set_ylabel("y in µm, down", labelpad=1)


def courses(
    times: Floats, paths: dict[str, Floats], knots: Floats, name: str, caption: str
) -> Figure:
    """x, y and θ over time, one line a support.

    Parameters
    ----------
    times
        (R,) s.
    paths
        (R, 3) poses by the support's name.
    knots
        (T,) times between the moves, s.
    name, caption
        As for `drawn`.
    """
    label = "pose of the peg over time on each support"
    return drawn(lambda: _courses(times, paths, knots), name, caption, label)


def _courses(times: Floats, paths: dict[str, Floats], knots: Floats) -> Drawing:
    colours = dict(zip(paths, (CERTIFIED, TIP, MUTED), strict=False))
    figure = Drawing(figsize=(11.6, 3.0), layout="constrained")
    panels = figure.subplots(1, 3)
    words = ("x in µm", "y in µm, down", "θ in deg")
    for k, (axes, word) in enumerate(zip(panels, words, strict=True)):
        for knot in knots:
            axes.axvline(knot, color=GHOST, lw=0.7)
        for support, path in paths.items():
            shown = path[:, k] / (UM, -UM, DEG)[k]
            axes.plot(times, shown, color=colours[support], lw=1.3, label=support)
        axes.set_xlabel("time in s", labelpad=1)
        axes.set_ylabel(word, labelpad=1)
    panels[0].legend(frameon=False)
    return figure
