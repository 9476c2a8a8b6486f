"""Pictures of what is certified, with what was simulated inside it."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from meso_robust.pipeline import Planned
from meso_robust.primitives.setup import PoseBox
from meso_robust.reporting.canvas import (
    CERTIFIED,
    CERTIFIED_FILL,
    COLUMN,
    GOAL,
    GOAL_FILL,
    INK,
    MISS,
    OPEN,
    OPEN_FILL,
    Coordinate,
    ends,
    fit_equal,
    name,
    padded,
    panel,
    panel_and_strip,
    poses_shown,
    rectangle_of,
)
from meso_robust.reporting.reading import Standing, standings, thinned, through
from meso_robust.types import Floats

Look = dict[str, Any]

PATHS = 24  # simulated ones that are drawn through a tube
PANEL = (5.6, 3.9)  # inches
GOLDEN = 0.5 * (5.0**0.5 - 1.0)  # multiples modulo one spread dots evenly, and alike every time
CERTIFIED_LOOK: Look = {"fc": CERTIFIED_FILL, "ec": CERTIFIED, "lw": 1.3, "label": "certified box"}
OPEN_LOOK: Look = {
    "fc": OPEN_FILL,
    "ec": OPEN,
    "lw": 1.3,
    "ls": (0, (3, 2)),
    "label": "unproved box",
}
GOAL_LOOK: Look = {"fc": GOAL_FILL, "ec": GOAL, "lw": 1.2, "label": "goal box"}


def spread_figure(result: Planned, index: int) -> Figure:
    """Simulated poses after one move, and the box that must hold them.

    Parameters
    ----------
    result
        The plan.
    index
        Which move, from 0.
    """
    check, steps = result.check, result.chain.steps
    poses = poses_shown(check.sampled.moves[index].after[through(check, index)])
    post = steps[index].post if index < len(steps) else None
    figure, axes, strip = panel_and_strip(*PANEL)
    if post is not None:
        look = _look(result, index)
        axes.add_patch(rectangle_of(post, "x", "y", **look))
        strip.add_patch(_band(post, look))
    _dots(axes, strip, thinned(poses), INK)
    _limits(axes, strip, poses, [] if post is None else [post])
    return figure


def final_figure(result: Planned) -> Figure:
    """The last poses in the certified box in the goal."""
    check, goal, end = result.check, result.setup.goal, result.chain.end
    done = check.sampled.completed
    figure, axes, strip = panel_and_strip(PANEL[0], 5.4)
    axes.add_patch(rectangle_of(goal, "x", "y", **GOAL_LOOK))
    strip.add_patch(_band(goal, GOAL_LOOK))
    if end is not None:
        look = _look(result, len(result.found.rules) - 1)
        axes.add_patch(rectangle_of(end, "x", "y", **look))
        strip.add_patch(_band(end, look))
    final = poses_shown(check.sampled.final)
    _dots(axes, strip, thinned(final[done & check.in_goal]), INK)
    _dots(axes, strip, thinned(final[done & ~check.in_goal]), MISS)
    _limits(axes, strip, final[done], [goal] if end is None else [goal, end])
    points = np.array([[*axes.get_xlim()], [*axes.get_ylim()]]).T
    fit_equal(axes, points, 0.0)
    return figure


def tube_figure(result: Planned, index: int, up: Coordinate) -> Figure:
    """The certified tube of one move, slice by slice, and simulated paths through it.

    Parameters
    ----------
    result, index
        The plan, and which move, from 0.
    up
        What is drawn over x: ``"y"`` (um) or ``"theta"`` (deg).
    """
    check, step = result.check, result.chain.steps[index]
    figure, axes = panel(*PANEL)
    name(axes, "x", up)
    for knot in step.tube:
        slice_ = {"fc": CERTIFIED_FILL, "ec": "none", "label": "tube slice"}
        axes.add_patch(rectangle_of(knot.box, "x", up, **slice_))
    for box in (step.pre, step.post):
        if box is not None:
            look = {"fc": "none", "ec": CERTIFIED, "lw": 1.3, "label": "box", "zorder": 5}
            axes.add_patch(rectangle_of(box, "x", up, **look))
    paths = poses_shown(thinned_paths(check.sampled.moves[index].path[through(check, index)]))
    lines = paths[:, :, [0, COLUMN[up]]]
    axes.add_collection(LineCollection(list(lines), colors=INK, lw=0.45, alpha=0.55, zorder=4))
    boxes = [knot.box for knot in step.tube] + [step.pre]
    axes.set_xlim(padded(_all(lines[..., 0], [ends(box, "x") for box in boxes])))
    axes.set_ylim(padded(_all(lines[..., 1], [ends(box, up) for box in boxes])))
    return figure


def thinned_paths(paths: Floats) -> Floats:
    """(PATHS, T, 3) evenly chosen paths, or all if there are fewer."""
    if len(paths) <= PATHS:
        return paths
    return paths[np.linspace(0, len(paths) - 1, PATHS).astype(np.int64)]


def has_tube(result: Planned, index: int) -> bool:
    """Whether the proof of a move kept more than one slice for drawing."""
    steps = result.chain.steps
    sound = standings(result.chain, len(result.found.rules))[index] is Standing.CERTIFIED
    return sound and len(steps[index].tube) > 1


def _look(result: Planned, index: int) -> Look:
    sound = standings(result.chain, len(result.found.rules))[index] is Standing.CERTIFIED
    return dict(CERTIFIED_LOOK if sound else OPEN_LOOK)


def _band(box: PoseBox, look: Look) -> Rectangle:
    low, high = ends(box, "theta")
    return Rectangle((low, -0.06), high - low, 1.12, **look)


def _dots(axes: Axes, strip: Axes, poses: Floats, colour: str) -> None:
    """Scatter of x and y, and of theta with heights that only keep the dots apart."""
    look: Look = {"marker": "o", "ls": "none", "ms": 1.7, "mew": 0, "color": colour, "alpha": 0.6}
    heights = np.modf(GOLDEN * np.arange(1, len(poses) + 1))[0]
    axes.plot(poses[:, 0], poses[:, 1], label="runs", zorder=4, **look)
    strip.plot(poses[:, 2], heights, label="runs", zorder=4, **look)


def _limits(axes: Axes, strip: Axes, poses: Floats, boxes: list[PoseBox]) -> None:
    """Show all runs and boxes; empty axes say that no run got so far."""
    if not len(poses):
        axes.text(0.5, 0.5, "no run completed this move", transform=axes.transAxes, ha="center")
    if not len(poses) and not boxes:
        return
    axes.set_xlim(padded(_all(poses[:, 0], [ends(box, "x") for box in boxes])))
    axes.set_ylim(padded(_all(poses[:, 1], [ends(box, "y") for box in boxes])))
    strip.set_xlim(padded(_all(poses[:, 2], [ends(box, "theta") for box in boxes])))


def _all(values: Floats, sides: list[tuple[float, float]]) -> Floats:
    return np.concatenate([values.ravel(), np.array(sides, dtype=np.float64).ravel()])
