"""Pictures of the tests of Fig. 14: the set-up above, trials over time below."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing

from meso_robust import units
from meso_robust.laboratory.running import MoveRun
from meso_robust.reporting.canvas import (
    AFTER,
    CERTIFIED,
    GHOST,
    GOAL,
    MISS,
    MUTED,
    OPEN,
    TIP,
    corners,
    fit_equal,
    outline,
)
from meso_robust.reproduction.drawing import pictured
from meso_robust.reproduction.printed import PART, SPEED
from meso_robust.reproduction.robust_trials import RECORD, Trial, seen

_COLOURS = (CERTIFIED, MISS, OPEN, GOAL, MUTED)
_TITLES = ("Test 1: robust, two tips", "Test 2: not robust, two tips", "Test 3: robust, one tip")
_SHOWN = np.array([units.UM, units.UM, 1.0])
_NAMES = ("X in µm", "Y in µm", "θ in rad")


@pictured(
    "fig14",
    "Fig. 14: set-up (start grey, end dark, tips and their travel) and five trials of each "
    "test with the paper's errors; lines: the part, dots: as the camera sees "
    "it. In test 3 the upper tip passes by.",
    "Set-up and trials of the three tests",
)
def tests_figure(trials: Sequence[Trial], moves: Sequence[MoveRun], seed: int) -> Drawing:
    """Set-up, X, Y and θ of the tests, a column each: Fig. 14."""
    picture = Drawing(figsize=(11.6, 9.6))
    grid = picture.subplots(4, len(trials), gridspec_kw={"height_ratios": (1.7, 1, 1, 1)})
    for column, (trial, move) in enumerate(zip(trials, moves, strict=True)):
        grid[0][column].set_title(_TITLES[column])
        _trials([grid[row][column] for row in (1, 2, 3)], trial, move, seed)
        if column == 0:
            for row, name in enumerate(_NAMES):
                grid[row + 1][0].set_ylabel(name)
    picture.subplots_adjust(left=0.07, right=0.99, top=0.97, bottom=0.06, hspace=0.25)
    for column, move in enumerate(moves):
        _set_up(grid[0][column], move)
    return picture


def _trials(panels: Sequence[Axes], trial: Trial, move: MoveRun, seed: int) -> None:
    times = np.linspace(0.0, trial.travel_um * units.UM / SPEED, RECORD + 1)
    some = len(move.path) // 2  # the others have their errors at the corners
    dots = seen(move.path[:some], seed)
    for k, axes in enumerate(panels):
        for colour, path, dotted in zip(_COLOURS, move.path, dots, strict=False):
            axes.plot(times[::3], path[::3, k] / _SHOWN[k], color=colour, lw=0.9)
            axes.plot(
                times[::6], dotted[::6, k] / _SHOWN[k], color=colour, ls="none", marker=".", ms=2.5
            )
    panels[-1].set_xlabel("time in s")


def _set_up(axes: Axes, move: MoveRun) -> None:
    start, end = move.before[0], move.after[0]
    body = PART.outline
    outline(axes, start, body, "start", fc=GHOST, ec=MUTED, lw=0.8, alpha=0.6)
    outline(axes, end, body, "end", fc="none", ec=AFTER, lw=1.3)
    arrow = {"arrowstyle": "-|>", "color": TIP, "lw": 1.1, "shrinkA": 0, "shrinkB": 0}
    for tip, way in zip(move.tips[0], move.travel[0], strict=True):
        at, to = tip / units.UM, (tip + way) / units.UM
        axes.annotate("", xy=tuple(to), xytext=tuple(at), arrowprops=arrow, zorder=5)
        axes.plot(*at, marker="o", ms=4, color=TIP, zorder=5)
    tips = np.concatenate([move.tips[0], move.tips[0] + move.travel[0]]) / units.UM
    fit_equal(axes, np.concatenate([corners(start, body), corners(end, body), tips]), 0.05)
