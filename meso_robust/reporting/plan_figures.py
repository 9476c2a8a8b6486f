"""Pictures of the plan: one panel a move, and the whole way from start to goal."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon

from meso_robust import units
from meso_robust.laboratory.making import outline as outline_of_part
from meso_robust.laboratory.running import MoveRun
from meso_robust.pipeline import Planned
from meso_robust.planning.document import names_of
from meso_robust.reporting.canvas import (
    AFTER,
    BEFORE,
    CERTIFIED,
    GHOST,
    GOAL,
    GOAL_FILL,
    INK,
    MUTED,
    OPEN,
    TIP,
    corners,
    fit_equal,
    outline,
    panel,
    poses_shown,
    rectangle_of,
)
from meso_robust.reporting.reading import Standing, standings
from meso_robust.reporting.theme import WALL
from meso_robust.types import Floats

GHOSTS = 4  # outlines between the first and the last
PANEL = (5.6, 4.3)  # inches
WIDE = (11.6, 4.9)


def ghost_rows(length: int) -> tuple[int, ...]:
    """Rows of a recorded path at which the part is drawn, evenly spaced, both ends left out."""
    return tuple(int(row) for row in np.linspace(0, length - 1, GHOSTS + 2).round()[1:-1])


def goal_pose(result: Planned) -> Floats:
    """(3,) middle of the goal, m and rad."""
    return np.array(result.setup.goal.mid)


def move_figure(result: Planned, index: int) -> Figure:
    """One move of the nominal run, in um.

    Parameters
    ----------
    result
        The plan.
    index
        Which move, from 0.
    """
    move, body = result.check.nominal.moves[index], outline_of_part(result.setup)
    last = index + 1 == len(result.found.rules)
    path = move.path[0]
    figure, axes = panel(*PANEL)
    if last:
        _goal(axes, result, body)
    outline(axes, move.before[0], body, "before", fc="none", ec=BEFORE, lw=1.3)
    for row in ghost_rows(len(path)):
        outline(axes, path[row], body, "ghost", fc="none", ec=GHOST, lw=0.8)
    outline(axes, move.after[0], body, "after", fc="none", ec=AFTER, lw=1.5)
    _centre_path(axes, path)
    _box_after(axes, result, index)
    tips = _tips(axes, move)
    drawn = [corners(pose, body) for pose in (move.before[0], *path, move.after[0])]
    if last:
        drawn.append(corners(goal_pose(result), body))
    extent = np.concatenate([*drawn, tips])
    room = _room_for_names(move, extent)
    fit_equal(axes, np.concatenate([extent, room]), 0.06)
    _name_tips(axes, move, names_of(result.found.rules[index]))
    return figure


def overview_figure(result: Planned) -> Figure:
    """The way of the part from the start to the goal, in um."""
    body, moves = outline_of_part(result.setup), result.check.nominal.moves
    figure, axes = panel(*WIDE)
    _goal(axes, result, body)
    _slot(axes, result)
    poses = [moves[0].before[0], *(move.after[0] for move in moves)]
    strength = np.linspace(0.4, 1.0, len(poses))
    for number, (pose, alpha) in enumerate(zip(poses, strength, strict=True)):
        outline(axes, pose, body, f"pose {number}", fc="none", ec=AFTER, lw=1.2, alpha=alpha)
    _centre_path(axes, np.concatenate([move.path[0] for move in moves]))
    for number, pose in enumerate(poses):
        x, y, _ = poses_shown(pose)
        axes.annotate(
            str(number),
            (x, y),
            ha="center",
            va="center",
            color="white",
            fontsize=8,
            fontweight="bold",
            bbox={"boxstyle": "circle,pad=0.25", "fc": INK, "ec": "white", "lw": 0.8},
            zorder=6,
        )
    drawn = [corners(pose, body) for pose in (*poses, goal_pose(result))]
    fit_equal(axes, np.concatenate(drawn), 0.03)
    return figure


def _slot(axes: Axes, result: Planned) -> None:
    """The walls, as far as the picture goes."""
    if result.task.slot is not None:
        corners_um = np.array(result.task.slot.outline_um, dtype=np.float64)
        axes.add_patch(Polygon(corners_um, fc=WALL, ec=INK, lw=1.0, label="slot", zorder=2))


def _goal(axes: Axes, result: Planned, body: Floats) -> None:
    outline(
        axes,
        goal_pose(result),
        body,
        "goal outline",
        fc="none",
        ec=GOAL,
        lw=1.7,
        ls=(0, (4, 3)),
        zorder=3,
    )
    look = {"fc": GOAL_FILL, "ec": GOAL, "lw": 1.0, "label": "goal box"}
    axes.add_patch(rectangle_of(result.setup.goal, "x", "y", **look))


def _centre_path(axes: Axes, path: Floats) -> None:
    points = poses_shown(path)
    axes.plot(points[:, 0], points[:, 1], color=MUTED, lw=1.0, label="centre", zorder=4)


def _box_after(axes: Axes, result: Planned, index: int) -> None:
    """The box of poses after the move at the part's centre, if the proof got so far."""
    steps = result.chain.steps
    post = steps[index].post if index < len(steps) else None
    if post is None:
        return
    sound = standings(result.chain, len(result.found.rules))[index] is Standing.CERTIFIED
    colour, label = (CERTIFIED, "certified box") if sound else (OPEN, "unproved box")
    style = "-" if sound else (0, (3, 2))
    axes.add_patch(
        rectangle_of(post, "x", "y", fc="none", ec=colour, lw=1.4, ls=style, label=label, zorder=5)
    )


def _tips(axes: Axes, move: MoveRun) -> Floats:
    """Draw the tips and their travel; (N, 2) all their points, um."""
    starts, ends = move.tips[0] / units.UM, (move.tips[0] + move.travel[0]) / units.UM
    for start, end, radius in zip(starts, ends, move.radii[0] / units.UM, strict=True):
        active = bool((start != end).any())
        axes.add_patch(Circle(tuple(start), radius, fc="none", ec=TIP, lw=0.8, zorder=8))
        if active:
            arrow = {"arrowstyle": "-|>", "color": TIP, "lw": 1.1, "shrinkA": 0, "shrinkB": 0}
            axes.annotate("", xy=end, xytext=start, arrowprops=arrow, zorder=7)
        axes.plot(
            *start,
            marker="o",
            ms=5.5,
            ls="none",
            mfc=TIP if active else "white",
            mec=TIP,
            mew=1.4,
            label="active tip" if active else "passive tip",
            zorder=8,
        )
    return np.concatenate([starts, ends])


def _ahead(move: MoveRun) -> npt.NDArray[np.bool_]:
    """(P,) whether a tip starts on the side of the part that the probe comes from."""
    return np.asarray(move.tips[0, :, 0] > move.before[0, 0])


def _room_for_names(move: MoveRun, extent: Floats) -> Floats:
    """Points, um, that a panel must also show so that the tips' names fit into it."""
    reach = 0.2 * float(np.ptp(extent, axis=0).max())
    outward = np.where(_ahead(move), reach, -reach)
    return move.tips[0] / units.UM + np.stack([outward, np.zeros_like(outward)], axis=1)


def _name_tips(axes: Axes, move: MoveRun, names: tuple[str, ...]) -> None:
    """Name each tip on the side that faces away from the part."""
    for name, ahead, place in zip(names, _ahead(move), move.tips[0] / units.UM, strict=True):
        axes.annotate(
            name,
            place,
            xytext=(7 if ahead else -7, 0),
            textcoords="offset points",
            ha="left" if ahead else "right",
            va="center",
            color=TIP,
            fontsize=8.5,
            bbox={"fc": "white", "ec": "none", "alpha": 0.85, "pad": 0.6},
            zorder=9,
        )
