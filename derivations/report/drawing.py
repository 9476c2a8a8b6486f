"""Arrows, dimensions and parts for drawings without axes, and the three drawings of the notation.

Every length is in µm, every drawing to scale except that the angles are larger than in use.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from meso_robust.reporting.canvas import CERTIFIED, CERTIFIED_FILL, INK, MUTED, TIP
from meso_robust.reporting.theme import FORCE

Floats = npt.NDArray[np.float64]

HALF_LENGTH, HALF_WIDTH = 808.0, 418.5
"""Half sides of the paper's part."""
PANEL = (3.7, 4.0)  # inches
TIP_RADIUS = 34.0
LETTERS = 11.0
EAST, NORTH = np.array([1.0, 0.0]), np.array([0.0, 1.0])


def one_point() -> Figure:
    """One tip pushes the long edge along -x: a, n, theta, d1, d2, forces on the part."""
    axes = _sheet((-760, 1180), (-950, 1150))
    centre, a, n = _frame(106.0)
    _part(axes, centre, a, n)
    _axis_pair(axes, np.array([-640.0, -840.0]))
    foot, contact = centre + HALF_WIDTH * n, centre + HALF_WIDTH * n + 480.0 * a
    _line(axes, centre, centre + 420.0 * EAST)
    _arc(axes, centre, 190.0, 0.0, 106.0, r"$\theta$", at=52.0)
    _arrow(axes, centre, centre + 420.0 * a, INK, r"$a$", 45.0 * n - 40.0 * a)
    _arrow(axes, foot, foot + 260.0 * n, INK, r"$n$", -62.0 * a)
    _dimension(axes, centre - 330.0 * a, foot - 330.0 * a, r"$d_1$", -55.0 * a)
    _line(axes, centre, centre - 360.0 * a)
    _dimension(axes, foot - 80.0 * n, contact - 80.0 * n, r"$d_2$", -70.0 * n)
    _arrow(axes, contact, contact - 330.0 * n, FORCE, r"$\lambda_n$", 65.0 * a + 20.0 * n)
    _arrow(axes, contact, contact + 260.0 * a, FORCE, r"$\lambda_t$", 85.0 * n)
    _tip(axes, contact, n, "", r"$v_p$")
    return _of(axes)


def two_points() -> Figure:
    """Both tips of the active probe on the long edge: beta, d2, d4, the two normal forces."""
    beta = 12.0
    axes = _sheet((-760, 1180), (-950, 1150))
    centre, a, n = _frame(90.0 + beta)
    _part(axes, centre, a, n)
    foot = centre + HALF_WIDTH * n
    first = foot + 400.0 * a
    second = first - 640.0 / np.cos(np.radians(beta)) * a
    _arrow(axes, centre, centre + 380.0 * a, INK, r"$a$", -70.0 * n)
    _arrow(axes, foot, foot + 230.0 * n, INK, r"$n$", 66.0 * a)
    _line(axes, second, second + 900.0 * NORTH)
    _arc(axes, second, 770.0, 90.0, 90.0 + beta, r"$\beta$", at=90.0 + 0.5 * beta)
    _dimension(axes, foot - 80.0 * n, first - 80.0 * n, r"$d_2$", -70.0 * n)
    right = 1050.0
    for point in (first, second):
        _line(axes, np.array([980.0, point[1]]), np.array([right + 40.0, point[1]]))
    _dimension(
        axes, np.array([right, second[1]]), np.array([right, first[1]]), r"$d_4$", 70.0 * EAST
    )
    for point, number in ((first, 1), (second, 2)):
        _arrow(axes, point, point - 300.0 * n, FORCE, rf"$\lambda_n^{number}$", 75.0 * a)
        _tip(axes, point, n, str(number), r"$v_p$")
    return _of(axes)


def two_sided() -> Figure:
    """A moving tip D and a passive tip S on opposite long edges: V, h, w."""
    axes = _sheet((-1080, 1080), (-1120, 1160))
    centre, a, n = _frame(128.0)
    _part(axes, centre, a, n)
    above = centre + HALF_WIDTH * n + 300.0 * a
    below = centre - HALF_WIDTH * n - 300.0 * a
    _line(axes, centre, centre + 360.0 * EAST)
    _arc(axes, centre, 170.0, 0.0, 128.0, r"$\theta$", at=64.0)
    _arrow(axes, centre, centre + 430.0 * a, INK, r"$a$", -60.0 * n - 30.0 * a)
    corner = np.array([above[0], below[1]])
    level = -330.0 * NORTH
    _line(axes, below, below + 1.1 * level)
    _line(axes, above, corner + 1.1 * level)
    _dimension(axes, below + level, corner + level, r"$h$", -62.0 * NORTH)
    side = 760.0 * EAST
    _line(axes, below, corner + side + 40.0 * EAST)
    _line(axes, above, above + side + 40.0 * EAST)
    _dimension(axes, corner + side, above + side, r"$V$", 62.0 * EAST)
    end = -560.0 * a
    _dimension(axes, end - HALF_WIDTH * n, end + HALF_WIDTH * n, r"$w$", -62.0 * a)
    _tip(axes, above, n, "D", r"$v_p$")
    _tip(axes, below, -n, "S", "")
    return _of(axes)


def _sheet(across: tuple[float, float], up: tuple[float, float]) -> Axes:
    axes = Figure(figsize=PANEL).add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(across)
    axes.set_ylim(up)
    axes.set_aspect("equal", adjustable="box")
    return axes


def _of(axes: Axes) -> Figure:
    figure = axes.get_figure(root=True)
    if figure is None:
        raise ValueError("axes without a figure")
    return figure


def _frame(theta: float) -> tuple[Floats, Floats, Floats]:
    """Centre, a and n of a part at the origin, theta in deg."""
    c, s = np.round([np.cos(np.radians(theta)), np.sin(np.radians(theta))], 9)
    return np.zeros(2), np.array([c, s]), np.array([s, -c])


def _part(axes: Axes, centre: Floats, a: Floats, n: Floats) -> None:
    signs = [(1, 1), (1, -1), (-1, -1), (-1, 1)]
    around = np.array([centre + i * HALF_LENGTH * a + j * HALF_WIDTH * n for i, j in signs])
    axes.add_patch(Polygon(around, closed=True, fc=CERTIFIED_FILL, ec=CERTIFIED, lw=1.4))
    axes.plot(*centre, marker="o", ms=4.0, color=INK)


def _axis_pair(axes: Axes, origin: Floats) -> None:
    _arrow(axes, origin, origin + 240.0 * EAST, MUTED, r"$x$", -58.0 * NORTH)
    _arrow(axes, origin, origin + 240.0 * NORTH, MUTED, r"$y$", -52.0 * EAST)


def _tip(axes: Axes, contact: Floats, outward: Floats, name: str, speed: str) -> None:
    """A tip that touches at ``contact``; with a ``speed`` it travels along -x."""
    middle = contact + TIP_RADIUS * outward
    look = {"fc": TIP if speed else "white", "ec": TIP, "lw": 1.4, "zorder": 8}
    angles = np.linspace(0.0, 2.0 * np.pi, 37)[:-1]
    ring = np.round(middle + TIP_RADIUS * np.stack([np.cos(angles), np.sin(angles)], axis=1), 4)
    axes.add_patch(Polygon(ring, closed=True, **look))
    if speed:
        start = middle + 430.0 * EAST
        _arrow(axes, start, middle + (TIP_RADIUS + 10.0) * EAST, TIP, "", 0.0 * EAST)
        _text(axes, start - 150.0 * EAST + 62.0 * NORTH, speed, TIP)
    below = -1.0 if name.isdigit() else np.sign(outward[1])
    _text(axes, middle + 95.0 * np.array([np.sign(outward[0]) * 0.8, below]), name, TIP)


def _arrow(
    axes: Axes, start: Floats, end: Floats, colour: str, label: str, aside: npt.ArrayLike
) -> None:
    look = {"arrowstyle": "-|>", "color": colour, "lw": 1.5, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", xy=tuple(end), xytext=tuple(start), arrowprops=look, zorder=7)
    _text(axes, end + np.asarray(aside), label, colour)


def _dimension(axes: Axes, start: Floats, end: Floats, label: str, aside: npt.ArrayLike) -> None:
    look = {"arrowstyle": "<|-|>", "color": MUTED, "lw": 0.9, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", xy=tuple(end), xytext=tuple(start), arrowprops=look, zorder=6)
    _text(axes, 0.5 * (start + end) + np.asarray(aside), label, INK)


def _line(axes: Axes, start: Floats, end: npt.ArrayLike) -> None:
    x, y = np.round(np.stack([start, np.asarray(end)], axis=1), 4)
    axes.plot(x, y, color=MUTED, lw=0.8, ls=(0, (4, 3)), zorder=3)


def _arc(
    axes: Axes, centre: Floats, radius: float, start: float, end: float, label: str, at: float
) -> None:
    angles = np.radians(np.linspace(start, end, 41))
    ring = centre + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    axes.plot(*np.round(ring, 4).T, color=INK, lw=1.0, zorder=4)
    where = np.radians(at)
    place = centre + (radius + 72.0) * np.array([np.cos(where), np.sin(where)])
    _text(axes, np.round(place, 4), label, INK)


def _text(axes: Axes, place: npt.ArrayLike, label: str, colour: str) -> None:
    look: dict[str, Any] = {"fontsize": LETTERS, "ha": "center", "va": "center"}
    x, y = np.asarray(place)
    axes.text(x, y, label, color=colour, zorder=9, **look)
