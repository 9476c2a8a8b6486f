"""The planned task drawn like Fig. 15 (pose over time) and Fig. 16 (snapshots)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing

from meso_robust.laboratory.running import PlanRun, rectangle
from meso_robust.primitives.move import MoveRule
from meso_robust.reporting.canvas import (
    AFTER,
    AXIS_NAME,
    BEFORE,
    CERTIFIED,
    CERTIFIED_FILL,
    GOAL,
    MUTED,
    TIP,
    corners,
    ends,
    fit_equal,
    outline,
    poses_shown,
)
from meso_robust.reporting.pages import Figure
from meso_robust.reproduction.certified import CertifiedPlan
from meso_robust.reproduction.drawing import drawn
from meso_robust.types import Floats
from meso_robust.units import UM

NAMES = {
    ("y_translation", "tilt"): "Y: tilt",
    ("y_translation", "straighten"): "Y: t²",
    ("rotation", "rotate"): "rotation",
    ("x_translation", "straighten"): "X: t²",
}


def figures(plan: CertifiedPlan, nominal: PlanRun, sampled: PlanRun) -> tuple[Figure, ...]:
    """Both figures; the runs must hold paths."""
    count = len(sampled.outcomes)
    return (
        drawn(
            lambda: _over_time(plan, nominal, sampled),
            "planned-task-time",
            "The part's pose over the moves, as in Fig. 15: nominal run (line), from smallest to "
            f"largest of {count} runs over all stated uncertainties (band), the goal (green). The "
            "pauses between moves are left out.",
        ),
        drawn(
            lambda: _snapshots(plan, nominal),
            "planned-task-snapshots",
            "Snapshots as in Fig. 16: the part before (grey) and after (black) each move, the tips "
            "where the move ends, and how they got there; the goal dashed.",
        ),
    )


def _name(rule: MoveRule) -> str:
    return NAMES.get((rule.primitive, rule.action), rule.action)


def move_times(plan: CertifiedPlan, nominal: PlanRun) -> Floats:
    """(M + 1,) instants between the moves of the nominal run, s."""
    speed = plan.task.probe.speed_um_s * UM
    ways = [np.hypot(*move.travel[0].T).max() / speed for move in nominal.moves]
    return np.concatenate([[0.0], np.cumsum(ways)])


def _over_time(plan: CertifiedPlan, nominal: PlanRun, sampled: PlanRun) -> Drawing:
    at = move_times(plan, nominal)
    canvas = Drawing(figsize=(8.6, 6.2), layout="constrained")
    axes = canvas.subplots(3, 1, sharex=True)
    for k, (one, every) in enumerate(zip(nominal.moves, sampled.moves, strict=True)):
        time = np.linspace(at[k], at[k + 1], one.path.shape[1])
        line, band = poses_shown(one.path[0]), poses_shown(every.path)
        for c, panel in enumerate(axes):
            low, high = band[..., c].min(axis=0), band[..., c].max(axis=0)
            panel.fill_between(time, low, high, color=CERTIFIED_FILL, ec=CERTIFIED, lw=0.4)
            panel.plot(time, line[:, c], color=CERTIFIED, lw=1.2)
            panel.axvline(at[k + 1], color=MUTED, lw=0.5, ls=":")
        axes[0].annotate(
            _name(plan.rules[k]),
            (0.5 * (at[k] + at[k + 1]), 1.02),
            xycoords=("data", "axes fraction"),
            ha="center",
            color=MUTED,
            fontsize=8.5,
        )
    _goal_bands(plan, axes, (float(at[-1]) * 0.9, float(at[-1]) * 1.03))
    axes[2].set_xlabel("time in s")
    axes[2].set_xlim(0.0, float(at[-1]) * 1.03)
    return canvas


def _goal_bands(
    plan: CertifiedPlan, axes: npt.NDArray[np.object_], span: tuple[float, float]
) -> None:
    for panel, name in zip(axes, ("x", "y", "theta"), strict=True):
        low, high = ends(plan.setup.goal, name)  # type: ignore[arg-type]
        panel.fill_between(span, low, high, color=GOAL, alpha=0.25, lw=0.0)
        panel.set_ylabel(AXIS_NAME[name])


def _snapshots(plan: CertifiedPlan, nominal: PlanRun) -> Drawing:
    body = rectangle(plan.setup)
    goal = np.array(plan.setup.goal.mid)
    canvas = Drawing(figsize=(8.6, 6.6), layout="constrained")
    axes = np.ravel(canvas.subplots(2, 2))
    points = [corners(goal, body)]
    for k, (panel, move) in enumerate(zip(axes, nominal.moves, strict=False)):
        outline(panel, goal, body, "goal", fc="none", ec=GOAL, lw=1.2, ls=(0, (4, 3)))
        outline(panel, move.before[0], body, "before", fc="none", ec=BEFORE, lw=1.2)
        outline(panel, move.after[0], body, "after", fc="none", ec=AFTER, lw=1.5)
        tips = np.stack([move.tips[0], move.tips[0] + move.travel[0]]) / UM
        _tips(panel, tips)
        panel.set_title(f"{k + 1}. {_name(plan.rules[k])}", fontsize=9.0, loc="left")
        points += [corners(move.before[0], body), corners(move.after[0], body), *tips]
    canvas.draw_without_rendering()
    for panel in axes:
        fit_equal(panel, np.concatenate(points), 0.03)
        panel.set_xlabel("x in µm", labelpad=2)
        panel.set_ylabel("y in µm", labelpad=2)
    return canvas


def _tips(panel: Axes, tips: Floats) -> None:
    """Tips (2, P, 2) at start and end, um."""
    for start, end in zip(tips[0], tips[1], strict=True):
        panel.plot(*np.stack([start, end]).T, color=TIP, lw=0.8)
        moved = bool((start != end).any())
        panel.plot(*end, marker="o", ms=4.5, mfc=TIP if moved else "white", mec=TIP, ls="none")
