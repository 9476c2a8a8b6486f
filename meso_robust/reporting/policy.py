"""A policy in pictures and words: where it can start, how many moves it needs, where the part goes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure

from meso_robust import units, wording
from meso_robust.policy.cells import Policy
from meso_robust.policy.cover import ends_of
from meso_robust.policy.region import Slice, region_of
from meso_robust.primitives.setup import PoseBox, setup_of
from meso_robust.reporting.canvas import (
    AXIS_NAME,
    COLUMN,
    GOAL,
    INK,
    TIP,
    Coordinate,
    ends,
    rectangle_of,
)
from meso_robust.reporting.svg import style, to_svg
from meso_robust.reporting.theme import FRAME
from meso_robust.types import Floats

PIXELS = 360  # of a map, each way
SCALE = {"x": units.UM, "y": units.UM, "theta": units.DEG}
COLOURS = (
    "#e3f4ea",
    "#d9e7f6",
    "#a9cbee",
    "#74a9dc",
    "#4583c1",
    "#1c5fa8",
    "#15467c",
    "#0d2c4f",
    "#061527",
)
OUTSIDE = "#ffffff"


def draw(policy: Policy, slices: Sequence[Slice]) -> str:
    """The certified starts and a tube through them, as an SVG document.

    Parameters
    ----------
    policy
        What is drawn.
    slices
        The tube from one start; its start also says through which poses the maps are cut.

    Returns
    -------
    str
        The document.
    """
    with style():
        figure = _figure(policy, slices)
        return str(to_svg(figure, "policy", "Certified starts by the number of moves they need"))


def _figure(policy: Policy, slices: Sequence[Slice]) -> Figure:
    figure = Figure(figsize=(9.4, 8.2))
    grid = figure.add_gridspec(
        2, 2, left=0.075, right=0.985, top=0.955, bottom=0.115, hspace=0.30, wspace=0.24
    )
    at = np.array(slices[0].boxes[0].mid)
    goal = np.array(setup_of(policy.task).goal.mid)
    cuts: tuple[tuple[Coordinate, Coordinate, Floats, str], ...] = (
        ("y", "theta", at, f"starts at x = {at[0] / units.UM:.0f} µm"),
        ("x", "theta", at, f"starts at y = {at[1] / units.UM:.0f} µm"),
        ("x", "y", at, f"starts at θ = {at[2] / units.DEG:.0f} deg"),
        ("x", "y", goal, f"starts at θ = {goal[2] / units.DEG:.0f} deg"),
    )
    for k, (across, up, through, title) in enumerate(cuts):
        axes = figure.add_subplot(grid[k // 2, k % 2])
        _map(axes, policy, across, up, through)
        _tube(axes, slices, across, up)
        axes.set_title(title, fontsize=9, loc="left")
    _legend(figure, policy)
    return figure


def _map(axes: Axes, policy: Policy, across: Coordinate, up: Coordinate, through: Floats) -> None:
    """Moves that are needed from the poses of a plane through one pose."""
    low, high = _extent(policy)
    sides = [np.linspace(low[COLUMN[c]], high[COLUMN[c]], PIXELS + 1) for c in (across, up)]
    middles = [0.5 * (side[1:] + side[:-1]) for side in sides]
    poses = np.broadcast_to(through, (PIXELS, PIXELS, 3)).copy()
    poses[..., COLUMN[across]] = middles[0][None, :]
    poses[..., COLUMN[up]] = middles[1][:, None]
    needed = moves_needed(policy, poses.reshape(-1, 3)).reshape(PIXELS, PIXELS)
    most = policy.moves
    axes.pcolormesh(
        sides[0] / SCALE[across],
        sides[1] / SCALE[up],
        np.ma.masked_less(needed, 0),
        cmap=ListedColormap(COLOURS[: most + 1]),
        norm=BoundaryNorm(np.arange(most + 2) - 0.5, most + 1),
        rasterized=True,
    )
    axes.set_facecolor(OUTSIDE)
    axes.set_xlabel(AXIS_NAME[across], labelpad=2)
    axes.set_ylabel(AXIS_NAME[up], labelpad=2)
    axes.add_patch(
        rectangle_of(setup_of(policy.task).goal, across, up, fill=False, edgecolor=GOAL, lw=1.4)
    )


def moves_needed(policy: Policy, poses: Floats) -> npt.NDArray[np.int64]:
    """(N,) bound of the moves from each sensed pose (N, 3); 0 at rest, -1 outside the region."""
    needed = np.full(len(poses), -1)
    answers = [(cell.sensed, cell.moves) for cell in policy.cells]
    if policy.rest is not None:
        answers.insert(0, (policy.rest, 0))
    lows, highs = ends_of([box for box, _ in answers])
    for low, high, (_, moves) in zip(lows, highs, answers, strict=True):
        held = ((low <= poses) & (poses <= high)).all(axis=1)
        needed[held & (needed < 0)] = moves
    return needed


def _extent(policy: Policy) -> tuple[Floats, Floats]:
    lows, highs = ends_of([cell.sensed for cell in policy.cells])
    low, high = lows.min(axis=0), highs.max(axis=0)
    space = 0.03 * (high - low)
    return low - space, high + space


def _tube(axes: Axes, slices: Sequence[Slice], across: Coordinate, up: Coordinate) -> None:
    """The boxes of each stage, numbered by the moves made."""
    for stage in slices:
        for box in stage.boxes:
            axes.add_patch(rectangle_of(box, across, up, fill=False, edgecolor=TIP, lw=1.1))
        right, top = ends(stage.boxes[0], across)[1], ends(stage.boxes[0], up)[1]
        axes.annotate(
            str(stage.moves),
            (right, top),
            (3, 2),
            textcoords="offset points",
            color=TIP,
            fontsize=8,
            fontweight="bold",
        )


def _legend(figure: Figure, policy: Policy) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    names = ["at rest", *(wording.counted(k, "move") for k in range(1, policy.moves + 1))]
    handles: list[Patch | Line2D] = [
        Patch(facecolor=colour, edgecolor=FRAME, lw=0.5, label=name)
        for colour, name in zip(COLOURS, names, strict=False)
    ]
    handles += [
        Line2D([], [], color=GOAL, lw=1.4, label="goal"),
        Line2D(
            [], [], color=TIP, lw=1.1, label="tube from the task's start, after this many moves"
        ),
    ]
    figure.legend(
        handles=handles, loc="lower center", ncol=6, frameon=False, fontsize=8, labelcolor=INK
    )


def summary(policy: Policy, slices: Sequence[Slice], seconds: float) -> str:
    """The policy in a page of Markdown.

    Parameters
    ----------
    policy, slices, seconds
        The policy, the tube from the task's start, and how long it took to build.

    Returns
    -------
    str
        Markdown; starts are rounded inward, poses of the tube outward.
    """
    lines = [
        f"# Certified policy: {policy.task.name}",
        "",
        f"From every start in the region below the part is in the goal after at most N = "
        f"{wording.counted(policy.moves, 'move')}. {wording.counted(len(policy.cells), 'cell')}, built in {seconds:.0f} s.",
        "",
        "## Certified starts",
        "",
        "Sensed poses; the share is that of the hull which the cells fill (estimated).",
        "",
        "| θ near | θ in deg | x in µm | y in µm | share | cells | moves |",
        "|---|---|---|---|---|---|---|",
    ]
    for region in region_of(policy):
        sides = " | ".join(_within(region.extent, side) for side in ("theta", "x", "y"))
        lines.append(
            f"| {region.near / units.DEG:.0f} | {sides} | {wording.down(100.0 * region.share, 0)} % | "
            f"{len(region.cells)} | ≤ {region.moves} |"
        )
    lines += [
        "",
        "## Tube from the task's start",
        "",
        "True poses after each move, whatever the errors and parameters (hull of each box).",
        "",
        "| after move | x in µm | y in µm | θ in deg | moves still needed |",
        "|---|---|---|---|---|",
    ]
    for stage in slices:
        for box in stage.boxes:
            sides = " | ".join(_span(box, side) for side in ("x", "y", "theta"))
            lines.append(f"| {stage.moves} | {sides} | ≤ {stage.to_go} |")
    return "\n".join(lines) + "\n"


def _within(box: PoseBox, side: Coordinate) -> str:
    """Starts that something is promised for, rounded inward."""
    low, high = ends(box, side)
    return f"{wording.up(low, 1)} … {wording.down(high, 1)}"


def _span(box: PoseBox, side: Coordinate) -> str:
    """Where the part is promised to be, rounded outward."""
    low, high = ends(box, side)
    return f"{wording.down(low, 1)} … {wording.up(high, 1)}"
