"""Pictures of the sensitive push: ways from nearby starts, and its spread beside the other tests."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure as Drawing

from meso_robust import units
from meso_robust.reporting.canvas import AXIS_NAME, INK
from meso_robust.reproduction.drawing import pictured
from meso_robust.reproduction.eight_tests import BENCH, SUPPORTS, TESTS
from meso_robust.reproduction.manipulation_figures import COLOURS
from meso_robust.reproduction.printed import SHOWN
from meso_robust.types import Floats

_DRAWN = 30  # ways in a panel
_EVERY = 5  # record of a drawn way


@pictured(
    "nearby",
    "Test C (Test 1 of Fig. 4) from starts within 5 µm and 0.005° of the nominal one, "
    "part and probe: x hardly differs, y and θ run apart.",
    "Test C from nearby starts over time",
)
def paths_figure(paths: Mapping[str, Floats]) -> Drawing:
    """x, y and θ over time from all starts, a column a support: the manner of Figs. 4 and 5."""
    duration = (BENCH.gap + BENCH.length) / BENCH.speed
    picture = Drawing(figsize=(11.6, 6.6))
    grid = picture.subplots(3, 3, sharex=True, sharey="row")
    for column, name in enumerate(SUPPORTS):
        ways = paths[name][-_DRAWN:, ::_EVERY] / SHOWN
        times = np.linspace(0.0, duration, ways.shape[1])
        for row, axis in enumerate(("x", "y", "theta")):
            axes = grid[row][column]
            axes.plot(times, ways[..., row].T, color=COLOURS[name], lw=0.7, alpha=0.5)
            if column == 0:
                axes.set_ylabel(AXIS_NAME[axis])
        grid[0][column].set_title(name)
        grid[2][column].set_xlabel("time in s")
    picture.subplots_adjust(left=0.07, right=0.99, top=0.95, bottom=0.08, wspace=0.06)
    return picture


@pictured(
    "spread",
    "Spread of θ after each test from the same errors of the start (5 µm, 0.005°).",
    "Spread of the angle in all tests",
)
def compared_figure(compared: Mapping[str, Floats]) -> Drawing:
    """Spread of θ in all tests at the same errors."""
    picture = Drawing(figsize=(8.0, 2.9))
    axes = picture.subplots()
    places, width = np.arange(len(TESTS)), 0.26
    for k, (name, spread) in enumerate(compared.items()):
        at = places + (k - 1) * width
        axes.bar(at, spread[:, 2] / units.DEG, width, color=COLOURS[name], label=name)
    axes.set_xticks(places, TESTS, color=INK)
    axes.grid(visible=False, axis="x")
    axes.set_ylabel("spread of θ in deg")
    axes.legend(frameon=False)
    picture.subplots_adjust(left=0.08, right=0.99, top=0.97, bottom=0.1)
    return picture
