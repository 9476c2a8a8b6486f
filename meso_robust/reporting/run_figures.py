"""Small pictures for notebooks: what a certificate states, how runs end, how many fail."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from meso_robust import units
from meso_robust.campaigns.answer import PartAnswer
from meso_robust.checker.document import BoxDocument, Certificate
from meso_robust.laboratory.making import outline as outline_of_part
from meso_robust.laboratory.simulation import Simulated, in_goal
from meso_robust.primitives.setup import PoseBox, setup_of
from meso_robust.reporting.canvas import (
    AFTER,
    BEFORE,
    CERTIFIED,
    CERTIFIED_FILL,
    GOAL,
    GOAL_FILL,
    INK,
    MISS,
    MUTED,
    OPEN,
    OPEN_FILL,
    corners,
    fit_equal,
    outline,
    panel,
    poses_shown,
    rectangle_of,
)
from meso_robust.reporting.reading import thinned
from meso_robust.task import Task
from meso_robust.types import Floats

WIDE = (11.6, 4.4)  # inches
_LONGEST = 34  # letters of a part's name beside its bar


def certificate_figure(certificate: Certificate, task: Task, *, holds: bool) -> Figure:
    """The part at the start and in the goal, and every box that the certificate states, in um.

    Parameters
    ----------
    certificate, task
        As read.
    holds
        Whether the check confirmed the boxes.
    """
    setup = setup_of(task)
    body, start, goal = outline_of_part(setup), np.array(setup.start.mid), np.array(setup.goal.mid)
    figure, axes = panel(*WIDE)
    outline(axes, start, body, "start", fc="none", ec=BEFORE, lw=1.3)
    _goal(axes, setup.goal, body)
    look = {"fc": CERTIFIED_FILL, "ec": CERTIFIED} if holds else {"fc": OPEN_FILL, "ec": OPEN}
    steps = certificate.steps
    boxes = [
        one for one in (*(step.pre for step in steps[:1]), *(step.post for step in steps)) if one
    ]
    for number, box in enumerate(boxes):
        axes.add_patch(_face(box, number, lw=1.4, zorder=5, **look))
        _numbered(axes, number, box)
    fit_equal(axes, np.concatenate([corners(pose, body) for pose in (start, goal)]), 0.05)
    return figure


def _face(box: BoxDocument, number: int, **look: Any) -> Rectangle:
    (left, right), (low, high) = box.x_um, box.y_um
    label = f"box {number}"
    return Rectangle((left, low), right - left, high - low, label=label, **look)


def _numbered(axes: Axes, number: int, box: BoxDocument) -> None:
    (left, right), high = box.x_um, box.y_um[1]
    axes.annotate(
        str(number),
        (0.5 * (left + right), high),
        xytext=(0, 4),
        textcoords="offset points",
        ha="center",
        color=INK,
        fontsize=8.5,
        zorder=6,
    )


def runs_figure(found: Simulated) -> Figure:
    """The nominal run from start to end, and the last poses of the sampled runs, in um."""
    setup, nominal = found.player.setup, found.nominal.runs
    body = outline_of_part(setup)
    moves = [move for k, move in enumerate(nominal.moves) if k <= int(nominal.failed_in[0])]
    figure, axes = panel(*WIDE)
    _goal(axes, setup.goal, body)
    poses = [moves[0].before[0], *(move.after[0] for move in moves)]
    for pose, shade in zip(poses, np.linspace(0.72, 0.2, len(poses)), strict=True):
        outline(axes, pose, body, "nominal", fc="none", ec=str(shade), lw=1.2)
    path = poses_shown(np.concatenate([move.path[0] for move in moves]))
    axes.plot(path[:, 0], path[:, 1], color=MUTED, lw=1.0, label="centre", zorder=4)
    hit, completed = in_goal(found.sampled, setup), found.sampled.completed
    _ends(axes, found.sampled.final[hit], AFTER, "o")
    _ends(axes, found.sampled.final[completed & ~hit], MISS, "x")
    drawn = [corners(pose, body) for pose in (*poses, np.array(setup.goal.mid))]
    fit_equal(axes, np.concatenate(drawn), 0.03)
    return figure


def _ends(axes: Axes, poses: Floats, colour: str, marker: str) -> None:
    at = thinned(poses) / np.array([units.UM, units.UM, units.DEG])
    axes.plot(at[:, 0], at[:, 1], marker, color=colour, ms=2.6, mew=0.8, ls="none", zorder=7)


def _goal(axes: Axes, goal: PoseBox, body: Floats) -> None:
    look: dict[str, Any] = {"fc": "none", "ec": GOAL, "lw": 1.7, "ls": (0, (4, 3)), "zorder": 3}
    outline(axes, np.array(goal.mid), body, "goal outline", **look)
    face: dict[str, Any] = {"fc": GOAL_FILL, "ec": GOAL, "lw": 1.0, "label": "goal box"}
    axes.add_patch(rectangle_of(goal, "x", "y", **face))


def shares_figure(parts: Sequence[PartAnswer]) -> Figure:
    """A bar for the share of each part's runs that failed, with both numbers beside it."""
    tall = 0.75 + 0.34 * len(parts)
    figure = Figure(figsize=(11.6, tall))
    axes = figure.add_axes((0.24, 0.46 / tall, 0.58, 1.0 - 0.56 / tall))
    shares = [100.0 * one.failed / max(one.runs, 1) for one in parts]
    with matplotlib.rc_context({"text.parse_math": False}):  # names of parts are no formulas
        for row, (one, share) in enumerate(zip(parts, shares, strict=True)):
            axes.barh(row, share, height=0.6, color=MISS if one.failed else GOAL)
            axes.text(-0.01, row, _short(one.part.name), ha="right", va="center", transform=axes.get_yaxis_transform())  # fmt: skip
            said = f"{one.failed:,} of {one.runs:,} {one.unit}"
            axes.text(1.01, row, said, va="center", transform=axes.get_yaxis_transform())
    axes.set_yticks([])
    axes.set_ylim(len(parts) - 0.4, -0.6)
    axes.set_xlim(0.0, max(1.0, *shares) * 1.04)
    axes.set_xlabel("runs that failed, in %", labelpad=2)
    return figure


def _short(name: str) -> str:
    return name if len(name) <= _LONGEST else f"{name[: _LONGEST - 1]}…"
