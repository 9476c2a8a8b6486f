"""A task as a notebook shows it: where the part is, where it should go, and what is not known."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from meso_robust.reporting import card as cards
from meso_robust.reporting.theme import GREEN, INK, LAST, WALL
from meso_robust.task import PolygonPart, Pose, Task
from meso_robust.types import Floats


def task_card(task: Task, text: str) -> str:
    """The task: outline of the part at the start and in the goal, and the bounds of the errors.

    Parameters
    ----------
    task, text
        The task, and what is said of it in a line.

    Returns
    -------
    str
        The card, HTML that can stand in any page.
    """
    known, part = task.uncertainty, task.part
    size = (
        f"polygon of {len(part.polygon_um)} corners"
        if isinstance(part, PolygonPart)
        else f"{part.length_um:g} × {part.width_um:g} µm"
    )
    return cards.card(
        word="TASK",
        colour="NEUTRAL",
        about=task.name,
        meaning=f"{text.removeprefix(f'{task.name}: ')}.",
        figures=(
            ("part", size),
            (
                "sensed to ±",
                f"{known.sensed_position_um:g} µm, {known.sensed_orientation_deg:g}°",
            ),
            ("probes to ±", f"{known.probe_position_um:g} µm"),
            ("friction", "{:g} … {:g}".format(*known.friction)),
            ("tips", task.tips),
            ("film ratio", f"{known.film_ratio_um2:g} µm² ± {known.film_ratio_percent:g} %"),
        ),
        picture=cards.picture(lambda: task_figure(task), repr(task), "Start and goal"),
        caption="Solid: the part at the start; dashed: in the middle of the goal"
        + ("." if task.slot is None else "; grey: the walls of the slot."),
        text=text,
    )


def task_figure(task: Task) -> Figure:
    """Start, goal and slot, in um."""
    figure = Figure(figsize=(7.0, 3.4), layout="constrained")
    axes = figure.add_subplot(aspect="equal", xlabel="x in µm", ylabel="y in µm")
    body = _corners(task)
    if task.slot is not None:
        walls = np.array(task.slot.outline_um, dtype=np.float64)
        axes.add_patch(Polygon(walls, fc=WALL, ec=INK, lw=1.0, label="slot"))
    axes.add_patch(Polygon(_at(task.start, body), fc="none", ec=LAST, lw=1.6, label="start"))
    goal = Polygon(_at(task.goal, body), fc="none", ec=GREEN, lw=1.6, ls=(0, (4, 3)), label="goal")
    axes.add_patch(goal)
    axes.plot([task.start.x_um, task.goal.x_um], [task.start.y_um, task.goal.y_um], "+", color=INK)
    axes.autoscale_view()
    return figure


def _corners(task: Task) -> Floats:
    """(N, 2) of the part, um, its own axes."""
    part = task.part
    if isinstance(part, PolygonPart):
        return np.array(part.polygon_um)
    return np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)]) * (part.length_um / 2, part.width_um / 2)


def _at(pose: Pose, body: Floats) -> Floats:
    """The corners of the part at a pose, um."""
    c, s = math.cos(math.radians(pose.theta_deg)), math.sin(math.radians(pose.theta_deg))
    return np.asarray(body @ np.array([[c, s], [-s, c]]) + (pose.x_um, pose.y_um))
