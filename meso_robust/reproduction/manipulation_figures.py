"""Pictures, to scale, of the task of Fig. 1 and of the tests of Fig. 3."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon

from meso_robust import units
from meso_robust.identification.experiment import PlannedPush
from meso_robust.reporting.canvas import (
    BEFORE,
    CERTIFIED,
    GHOST,
    GOAL,
    INK,
    MISS,
    OPEN,
    TIP,
    corners,
    fit_equal,
    outline,
    panel,
)
from meso_robust.reporting.theme import WALL
from meso_robust.reproduction.drawing import pictured
from meso_robust.reproduction.eight_tests import SUPPORTS, TESTS
from meso_robust.reproduction.printed import PART, TIP_RADIUS
from meso_robust.simulator import PushResult
from meso_robust.task import load_task
from meso_robust.tasks import SLOT
from meso_robust.types import Floats

COLOURS = dict(zip(SUPPORTS, (CERTIFIED, MISS, OPEN), strict=True))
"""Colour of each support, in every picture of the tests."""


@pictured(
    "task",
    "The task of Fig. 1 to scale: the part from A into the slot (B), which is 139 µm wider.",
    "The part before and in the slot",
)
def task_figure() -> Drawing:
    """The part at its start A and in the slot B, to scale."""
    task, body = load_task(SLOT), PART.outline
    places = {"A": task.start, "B": task.goal}
    poses = {
        name: np.array([place.x_um * units.UM, place.y_um * units.UM, place.theta_deg * units.DEG])
        for name, place in places.items()
    }
    walls = np.array(task.slot.outline_um if task.slot else [], dtype=np.float64)
    picture, axes = panel(9.4, 4.3)
    axes.add_patch(Polygon(walls, fc=WALL, ec=INK, lw=1.0))
    outline(axes, poses["A"], body, "A", fc="none", ec=BEFORE, lw=1.6)
    outline(axes, poses["B"], body, "B", fc="none", ec=GOAL, lw=1.6)
    for name, pose in poses.items():
        x, y = pose[:2] / units.UM
        axes.text(x, y, name, ha="center", va="center", fontsize=13)
    _size(axes, (poses["A"][:2] / units.UM) + [-418.5, -900.0], (837.0, 0.0), "837 µm")
    _size(axes, (poses["A"][:2] / units.UM) + [500.0, -808.0], (0.0, 1616.0), "1616 µm")
    width = float(task.slot.width_um if task.slot else 0.0)
    _size(axes, np.array([380.0, -0.5 * width]), (0.0, width), f"{width:g} µm")
    room = np.array([[3060.0, -1000.0]])  # for the sizes
    points = [walls, room, *(corners(pose, body) for pose in poses.values())]
    fit_equal(axes, np.concatenate(points), 0.04)
    return picture


def _size(axes: Axes, at: Floats, along: tuple[float, float], words: str) -> None:
    """An arrow with both heads and its length."""
    arrow = {"arrowstyle": "<->", "color": INK, "lw": 0.9, "shrinkA": 0, "shrinkB": 0}
    end = at + np.array(along)
    axes.annotate("", xy=tuple(end), xytext=tuple(at), arrowprops=arrow)
    upright = along[0] == 0.0
    axes.annotate(
        words,
        tuple(0.5 * (at + end)),
        xytext=(6, 0) if upright else (0, -10),
        textcoords="offset points",
        ha="left" if upright else "center",
        va="center",
    )


@pictured(
    "tests",
    "The tests of Fig. 3 to scale: start grey, ends on the film and on the points of "
    "Table I, and the path of the tip.",
    "Start and end of the eight manipulation tests",
)
def tests_figure(pushes: Mapping[str, PlannedPush], results: Mapping[str, PushResult]) -> Drawing:
    """Start and ends of every test, to scale."""
    picture = Drawing(figsize=(11.6, 6.3))
    for k, test in enumerate(TESTS):
        axes = picture.add_subplot(2, 4, k + 1)
        _test(axes, pushes[test], {name: each.poses[k] for name, each in results.items()})
    handles = [
        Line2D([], [], color=GHOST, lw=5, label="start"),
        *(Line2D([], [], color=COLOURS[name], label=f"end, {name}") for name in SUPPORTS),
        Line2D([], [], color=TIP, marker="o", ms=4, label="tip and its path"),
    ]
    picture.legend(handles=handles, loc="lower center", ncols=5, frameon=False)
    picture.subplots_adjust(left=0.01, right=0.99, top=0.95, bottom=0.07, wspace=0.04)
    return picture


def _test(axes: Axes, push: PlannedPush, ends: Mapping[str, Floats]) -> None:
    body, start = PART.outline, np.array(push.start)
    outline(axes, start, body, "start", fc=GHOST, ec=BEFORE, lw=0.8, alpha=0.6)
    for name, pose in ends.items():
        outline(axes, pose, body, name, fc="none", ec=COLOURS[name], lw=1.2)
    x, y = np.array(push.tip) / units.UM
    dx, dy = np.array(push.travel) / units.UM
    arrow = {"arrowstyle": "-|>", "color": TIP, "lw": 1.1, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", xy=(x + dx, y + dy), xytext=(x, y), arrowprops=arrow, zorder=5)
    axes.add_patch(Circle((x, y), 2.0 * TIP_RADIUS / units.UM, color=TIP, zorder=5))
    axes.set_title(push.name, loc="left", pad=2)
    axes.set_xlim(-1450.0, 1350.0)
    axes.set_ylim(-1300.0, 1300.0)
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
