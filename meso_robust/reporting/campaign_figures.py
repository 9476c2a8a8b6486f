"""Pictures of a campaign: bars on one scale, strips of shades, and the hardest runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from meso_robust import units
from meso_robust.campaigns.kind import Bars, Coverage, Paths
from meso_robust.reporting import canvas
from meso_robust.reporting.pages import Figure as Picture
from meso_robust.reporting.svg import style, to_svg
from meso_robust.types import Floats
from meso_robust.wording import worded

SHADES = (
    ("none", "none"),
    ("s1", "less than ¼"),
    ("s2", "¼ to 0.7"),
    ("s3", "0.7 to 1.4"),
    ("s4", "1.4 to 4"),
    ("s6", "4 or more"),
)
"""Classes of the bins of a strip, from empty to crowded, with what they mean."""
_STEPS = np.array([0.25, 0.7, 1.4, 4.0])
_MOST_OUTLINES = 10  # of a run; more would cover one another
_CLOSE = 0.06  # of the width of a picture, the room that a number takes


@dataclass(frozen=True, slots=True, kw_only=True)
class Scale:
    """Bars as shares of the width that they have."""

    zero: float
    """Where zero is, in %."""
    limit: float | None
    """Where the limit is, in %."""
    bars: tuple[tuple[float, float], ...]
    """Left end and length of each, in %."""
    passes: tuple[bool, ...]
    """Whether each is beyond the limit."""


def scale(view: Bars) -> Scale:
    """All bars and the limit on one linear scale that shows zero."""
    limits = () if view.limit is None else (view.limit,)
    low, high = min((0.0, *view.values, *limits)), max((0.0, *view.values, *limits))
    wide = (high - low) or 1.0

    def at(value: float) -> float:
        return 100.0 * (value - low) / wide

    return Scale(
        zero=at(0.0),
        limit=None if view.limit is None else at(view.limit),
        bars=tuple((at(min(value, 0.0)), 100.0 * abs(value) / wide) for value in view.values),
        passes=tuple(view.limit is not None and value > view.limit for value in view.values),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Strip:
    """How the runs are spread over the range of one quantity."""

    label: str
    counts: tuple[int, ...]
    shades: tuple[str, ...]
    """Class of each bin."""


def strips(view: Coverage) -> tuple[Strip, ...]:
    """A strip for every quantity, shaded by the runs in a bin over the even share of a bin."""
    return tuple(
        Strip(label=label, counts=counts, shades=_shades(counts))
        for label, counts in zip(view.labels, view.counts, strict=True)
    )


def _shades(counts: tuple[int, ...]) -> tuple[str, ...]:
    even = max(sum(counts), 1) / max(len(counts), 1)
    levels = 1 + np.searchsorted(_STEPS, np.array(counts) / even, side="right")
    return tuple(
        SHADES[level if number else 0][0] for number, level in zip(counts, levels, strict=True)
    )


def drawings(view: Paths, most: int, name: str) -> list[Picture]:
    """The hardest runs, each with its title, and a last picture of where they end.

    Parameters
    ----------
    view
        What to draw.
    most
        How many runs are drawn.
    name
        Prefix of all ids.
    """
    runs = [(label, _finite(np.array(poses))) for label, poses in view.runs[:most]]
    body = np.array(view.part_um) * units.UM
    seen = np.concatenate([_corners(pose, body) for _, poses in runs for pose in poses])
    seen = np.concatenate([seen, _corners(np.array(view.goal), body)])
    found = []
    with style():
        for number, (label, poses) in enumerate(runs, start=1):
            figure = path_figure(view, poses, seen)
            svg = to_svg(figure, f"{name}-run{number}", f"Outlines of the part along run {number}")
            found.append(Picture(svg=svg, title=worded(f"{number}. {label}"), wide=False))
        figure = ends_figure(view, np.array([poses[-1] for _, poses in runs]))
        svg = to_svg(figure, f"{name}-ends", "Last poses of the runs beside the goal's tolerance")
    return [*found, Picture(svg=svg, title="Where they end", wide=False)]


def path_figure(view: Paths, poses: Floats, seen: Floats) -> Figure:
    """One run: outlines along its way and the goal.

    Parameters
    ----------
    view
        Part and goal.
    poses
        (N, 3) um, um, deg.
    seen
        (M, 2) points that the picture must hold, um; the same for all runs to be compared.
    """
    figure, axes = canvas.panel(4.3, 3.5)
    body = np.array(view.part_um) * units.UM
    middle = np.unique(np.linspace(0, len(poses) - 1, _MOST_OUTLINES).round().astype(int))[1:-1]
    for pose in poses[middle]:
        _outline(axes, pose, body, edgecolor=canvas.GHOST, lw=0.8)
    _outline(axes, np.array(view.goal), body, edgecolor=canvas.GOAL, lw=1.6, ls="--")
    _outline(axes, poses[0], body, edgecolor=canvas.BEFORE, lw=1.2)
    _outline(axes, poses[-1], body, edgecolor=canvas.AFTER, lw=1.6)
    axes.plot(*poses[:, :2].T, "-", color=canvas.CERTIFIED, lw=1.2)
    axes.plot(*poses[0, :2], "o", color=canvas.CERTIFIED, ms=3)
    _goal_box(axes, view, (view.goal[0], view.goal[1]))
    canvas.fit_equal(axes, seen, 0.04)
    return figure


def ends_figure(view: Paths, ends: Floats) -> Figure:
    """Where runs end, from the middle of the goal, and its tolerance.

    Parameters
    ----------
    view
        Goal and tolerance.
    ends
        (N, 3) last poses, um, um, deg.
    """
    figure, axes, strip = canvas.panel_and_strip(4.3, 3.5)
    left = ends - np.array(view.goal)
    left[:, 2] = (left[:, 2] + 180.0) % 360.0 - 180.0
    length, angle = view.tolerance
    _goal_box(axes, view, (0.0, 0.0))
    strip.axvspan(-angle, angle, facecolor=canvas.GOAL_FILL, edgecolor=canvas.GOAL, lw=1.2)
    for x, y, theta in left:
        outside = max(abs(x), abs(y)) > length or abs(theta) > angle
        look = (canvas.MISS, "X") if outside else (canvas.CERTIFIED, "o")
        for one, at in ((axes, (x, y)), (strip, (theta, 0.35))):
            one.plot(*at, look[1], color=look[0], ms=5)
    corners = length * np.array([[-1.0, -1.0], [1.0, 1.0]])
    canvas.fit_equal(axes, np.concatenate([left[:, :2], corners]), 0.12)
    strip.set_xlim(*canvas.padded(np.array([*left[:, 2], -angle, angle])))
    for group in _together(left[:, :2], _CLOSE * np.ptp(axes.get_xlim())):
        _number(axes, group, left[group[0], :2], (5, 4))
    for group in _together(left[:, 2:], _CLOSE * np.ptp(strip.get_xlim())):
        _number(strip, group, np.array([left[group[0], 2], 0.35]), (-3, 5))
    for one, label in ((axes, "x minus goal, µm"), (strip, "θ minus goal, deg")):
        one.set_xlabel(label, labelpad=2)
    axes.set_ylabel("y minus goal, µm", labelpad=2)
    return figure


def _together(points: Floats, near: float) -> list[list[int]]:
    """Indices of points (N, K), those too near to each other to be numbered by themselves as one."""
    groups: list[list[int]] = []
    for index, point in enumerate(points):
        for group in groups:
            if np.abs(points[group[0]] - point).max() < near:
                group.append(index)
                break
        else:
            groups.append([index])
    return groups


def _number(axes: Axes, group: list[int], at: Floats, shift: tuple[int, int]) -> None:
    """Number runs from 1."""
    text = ", ".join(str(index + 1) for index in group)
    axes.annotate(text, (float(at[0]), float(at[1])), xytext=shift, textcoords="offset points")


def _goal_box(axes: Axes, view: Paths, middle: tuple[float, float]) -> None:
    """Where the reference point may end."""
    length = view.tolerance[0]
    axes.add_patch(
        Rectangle(
            (middle[0] - length, middle[1] - length),
            2.0 * length,
            2.0 * length,
            facecolor=canvas.GOAL_FILL,
            edgecolor=canvas.GOAL,
            lw=1.2,
        )
    )


def _finite(poses: Floats) -> Floats:
    """What is known of a way: a run that jams has none from there on."""
    return poses[np.isfinite(poses).all(axis=1)]


def _si(pose: Floats) -> Floats:
    return np.asarray(pose * np.array([units.UM, units.UM, units.DEG]))


def _corners(pose: Floats, body: Floats) -> Floats:
    return canvas.corners(_si(pose), body)


def _outline(axes: Axes, pose: Floats, body: Floats, **look: Any) -> None:
    canvas.outline(axes, _si(pose), body, "", fill=False, **look)
