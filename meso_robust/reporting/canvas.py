"""Blank axes in um and deg, and the shapes that every picture of the report is made of."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from meso_robust import units
from meso_robust.bounds import Interval
from meso_robust.primitives.setup import PoseBox
from meso_robust.reporting.theme import (
    BLUE,
    BLUE_FILL,
    GHOST as GHOST,
    GREEN,
    GREEN_FILL,
    GRID as GRID,
    INK as INK,
    LAST,
    MUTED as MUTED,
    ORANGE,
    ORANGE_FILL,
    PURPLE,
    VERMILION,
    WAY,
)
from meso_robust.types import Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.patches import Rectangle

Coordinate = Literal["x", "y", "theta"]

BEFORE, AFTER = WAY, LAST
CERTIFIED, CERTIFIED_FILL = BLUE, BLUE_FILL
OPEN, OPEN_FILL = ORANGE, ORANGE_FILL
GOAL, GOAL_FILL = GREEN, GREEN_FILL
TIP, MISS = VERMILION, PURPLE
COLUMN = {"x": 0, "y": 1, "theta": 2}
AXIS_NAME = {"x": "x in µm", "y": "y in µm", "theta": "θ in deg"}


def shown(coordinate: Coordinate, values: Floats) -> Floats:
    """Metres to um, or radians to deg."""
    return np.asarray(values) / (units.DEG if coordinate == "theta" else units.UM)


def poses_shown(poses: Floats) -> Floats:
    """(..., 3) poses in m and rad to um and deg.

    Parameters
    ----------
    poses
        (..., 3) x, y in m, θ in rad.

    Returns
    -------
    Floats
        (..., 3) x, y in um, θ in deg.
    """
    return np.asarray(poses) / np.array([units.UM, units.UM, units.DEG])


def ends(box: PoseBox, coordinate: Coordinate) -> tuple[float, float]:
    """Ends of one side of a box, um or deg.

    Parameters
    ----------
    box, coordinate
        The box, and which of its sides.

    Returns
    -------
    tuple of float
        Lower and upper end, um or deg.
    """
    side: Interval = getattr(box, coordinate)
    low, high = shown(coordinate, np.array([side.lo, side.hi]))
    return float(low), float(high)


def rectangle_of(box: PoseBox, across: Coordinate, up: Coordinate, **look: Any) -> Rectangle:
    """A face of a box of poses, um and deg."""
    from matplotlib.patches import Rectangle

    (left, right), (low, high) = ends(box, across), ends(box, up)
    return Rectangle((left, low), right - left, high - low, **look)


def corners(pose: Floats, body: Floats) -> Floats:
    """(4, 2) corners of the part in um.

    Parameters
    ----------
    pose
        (3,) x, y, theta in m and rad.
    body
        (4, 2) corners in the part's own frame, m.

    Returns
    -------
    Floats
        (4, 2) x, y in the world, um.
    """
    c, s = np.cos(pose[2]), np.sin(pose[2])
    turned = body @ np.array([[c, s], [-s, c]])
    return np.asarray((turned + pose[:2]) / units.UM)


def outline(axes: Axes, pose: Floats, body: Floats, label: str, **look: Any) -> None:
    """Draw the part at a pose.

    Parameters
    ----------
    axes
        Where; in um.
    pose, body
        As for `corners`.
    label, look
        What it is called, and how matplotlib is to draw it.
    """
    from matplotlib.patches import Polygon

    axes.add_patch(Polygon(corners(pose, body), closed=True, label=label, **look))


def panel(width: float, height: float) -> tuple[Figure, Axes]:
    """A figure with one pair of axes that fills it, sizes in inches.

    Parameters
    ----------
    width, height
        Of the figure, inches.

    Returns
    -------
    tuple of Figure and Axes
        The axes are x and y in um; the margins leave room for their names only.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height))
    left, bottom, right, top = 0.66, 0.46, 0.10, 0.10
    axes = figure.add_axes(
        (
            left / width,
            bottom / height,
            (width - left - right) / width,
            (height - bottom - top) / height,
        )
    )
    name(axes, "x", "y")
    return figure, axes


def panel_and_strip(width: float, height: float) -> tuple[Figure, Axes, Axes]:
    """A figure with axes for x and y, and a strip for theta under them, sizes in inches."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height))
    left, across = 0.66 / width, (width - 0.76) / width
    bottom = 0.46 + 0.42 + 0.56
    axes = figure.add_axes((left, bottom / height, across, (height - bottom - 0.1) / height))
    strip = figure.add_axes((left, 0.46 / height, across, 0.42 / height))
    name(axes, "x", "y")
    strip.set_xlabel(AXIS_NAME["theta"], labelpad=2)
    strip.set_yticks([])
    strip.set_ylim(-0.12, 1.12)
    return figure, axes, strip


def name(axes: Axes, across: Coordinate, up: Coordinate) -> None:
    """Name the axes."""
    axes.set_xlabel(AXIS_NAME[across], labelpad=2)
    axes.set_ylabel(AXIS_NAME[up], labelpad=2)


def fit_equal(axes: Axes, points: Floats, pad: float) -> None:
    """Show all points at one scale in both directions, filling the axes.

    Parameters
    ----------
    axes, points
        Where, and (N, 2) what, um.
    pad
        Free space on every side as a share of the larger extent.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    size = (high - low) + 2.0 * pad * max(float((high - low).max()), 1.0)
    wide, tall = axes.bbox.width, axes.bbox.height
    scale = max(size[0] / wide, size[1] / tall)  # um a pixel
    middle = 0.5 * (low + high)
    axes.set_xlim(middle[0] - 0.5 * scale * wide, middle[0] + 0.5 * scale * wide)
    axes.set_ylim(middle[1] - 0.5 * scale * tall, middle[1] + 0.5 * scale * tall)
    axes.set_aspect("equal", adjustable="box")


def padded(values: Floats, pad: float = 0.07) -> tuple[float, float]:
    """Limits that show all values with some space around them."""
    low, high = float(values.min()), float(values.max())
    space = pad * (high - low) if high > low else max(abs(high), 1.0) * pad
    return low - space, high + space
