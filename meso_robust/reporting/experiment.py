"""Planned pushes as a page with drawings, for the person at the microscope."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from meso_robust import units
from meso_robust.identification.design import Design, Interval, shrinking
from meso_robust.identification.experiment import Experiment, PlannedPush
from meso_robust.identification.models import Model
from meso_robust.provenance import made_with
from meso_robust.reporting import pages
from meso_robust.reporting.canvas import BEFORE, GHOST, GRID, TIP, outline
from meso_robust.reporting.svg import style, to_svg
from meso_robust.reporting.words import number, significant
from meso_robust.wording import counted

_COLUMNS = 4  # of panels
_LEAST_TIP = 20.0  # um: a smaller tip is drawn larger, or nobody would see it


def experiment_page(
    experiment: Experiment, found: Design | None = None, model: Model | None = None
) -> str:
    """A self-contained HTML page on pushes to be made.

    Parameters
    ----------
    experiment
        The pushes.
    found, model
        The design that they come from and its model, if they do; what is expected of it is shown.

    Returns
    -------
    str
        The page; it asks for nothing from outside.
    """
    bench = experiment.bench
    times = "time" if bench.trials == 1 else "times"
    sections = [_pushes(experiment)]
    if found and model:
        sections.append(_expected(found, model))
    if experiment.left_out:
        rows = [(pages.code(name), why) for name, why in experiment.left_out]
        unused = pages.table("Points that are not used", " | ", rows, named=False)
        sections.append(pages.Section("unused", "Not used", (unused,)))
    again = f"meso-robust identify --{f'design {len(experiment.pushes)}' if found else 'plan'}"
    return pages.page(
        pages.Report(
            banner=pages.Banner(
                verb="identify",
                subject=counted(len(experiment.pushes), "push", "pushes"),
                about=f"{bench.trials} {times} each",
                word="Designed pushes" if found else "Pushes that identify the part",
                colour="NEUTRAL",
                meaning="Lay the part down as drawn, bring the tip to its start (free of contact), "
                f"start the recording, make the travel, draw the tip back by {number(bench.back / units.UM)} µm, "
                f"lift it. Before, between and after let the camera run for {number(bench.rest)} s.",
                figures=(
                    ("pushes", str(len(experiment.pushes))),
                    ("trials of each", str(bench.trials)),
                    (
                        "speed",
                        ", ".join(f"{_um(rate * bench.speed)} µm/s" for rate in bench.rates),
                    ),
                    ("radius of the tip", f"{number(bench.tip_radius / units.UM)} µm"),
                ),
            ),
            sections=sections,
            made=pages.made(again, after=" with the same part and options", using=made_with()),
        )
    )


def _pushes(experiment: Experiment) -> pages.Section:
    picture = pages.Figure(
        svg=drawing(experiment),
        title="Start of every push",
        caption="The field of view; the arrow is the tip's travel.",
    )
    words = pages.html(
        "<p>µm and deg; the origin is the middle of the field, x to the right, y up. A place is "
        "measured from the middle of its edge, counter-clockwise; none is nearer to a corner than "
        "{} µm.</p>",
        number(experiment.bench.corner_margin / units.UM),
    )
    heads = "push | ~part x, y, θ | ~tip | ~travel | ~µm/s | ~place | "
    speeds = [experiment.bench.speed_of(k) for k in range(len(experiment.pushes))]
    rows = [_row(push, speed) for push, speed in zip(experiment.pushes, speeds, strict=True)]
    return pages.Section(
        "pushes",
        "The pushes",
        (pages.figure(picture), words, pages.table("Pushes", heads, rows, named=False)),
    )


def _expected(design: Design, model: Model) -> pages.Section:
    words = pages.html(
        "<p>Intervals of 90 % by the normal approximation at the values taken for the truth, starts "
        "unknown; chosen by: {}.</p>",
        design.criterion,
    )
    heads = "parameter | ~taken for the truth | ~before | ~after | times shorter"
    rows = [
        (
            pages.code(parameter.key),
            significant(before.value / parameter.to_si),
            _ends(before, parameter.to_si),
            _ends(after, parameter.to_si),
            significant(1.0 / shrinking(before, after), 3) if before.informed else "—",
        )
        for before, after, parameter in zip(
            design.before, design.after, model.parameters, strict=True
        )
    ]
    return pages.Section(
        "expected",
        "What is to be expected",
        (words, pages.table("Expected intervals", heads, rows, named=False)),
    )


def drawing(experiment: Experiment) -> Markup:
    """Every push at its start, in the field of view, as an ``<svg>`` element."""
    rows = -(-len(experiment.pushes) // _COLUMNS)
    wide, high = np.array(experiment.bench.field) / units.UM
    with style():
        drawn = Figure(figsize=(9.4, 0.35 + rows * (0.3 + 2.2 * high / wide)))
        grid = drawn.add_gridspec(rows, _COLUMNS, wspace=0.06, hspace=0.28)
        grid.update(left=0.01, right=0.99, top=1.0 - 0.09 / rows, bottom=0.01)
        for k, push in enumerate(experiment.pushes):
            axes = drawn.add_subplot(grid[k // _COLUMNS, k % _COLUMNS])
            _panel(axes, experiment, push)
        return to_svg(drawn, "pushes", "Start of every push: part, tip and travel")


def _panel(axes: Axes, experiment: Experiment, push: PlannedPush) -> None:
    wide, high = np.array(experiment.bench.field) / units.UM
    axes.add_patch(Rectangle((-wide / 2, -high / 2), wide, high, facecolor="none", edgecolor=GRID))
    body = experiment.part.outline
    outline(axes, np.array(push.start), body, "part", facecolor=GHOST, edgecolor=BEFORE, lw=0.8)
    x, y = np.array(push.tip) / units.UM
    dx, dy = np.array(push.travel) / units.UM
    radius = max(experiment.bench.tip_radius / units.UM, _LEAST_TIP)
    axes.add_patch(Circle((x, y), radius, color=TIP))
    arrow = {"arrowstyle": "->", "color": TIP, "lw": 1.2, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (x + dx, y + dy), (x, y), arrowprops=arrow)
    axes.set_title(push.name, fontsize=9 if len(push.name) < 4 else 6.5, loc="left", pad=2)
    axes.set_xlim(-0.51 * wide, 0.51 * wide)
    axes.set_ylim(-0.51 * high, 0.51 * high)
    axes.set_aspect("equal")
    axes.set_axis_off()


def _row(push: PlannedPush, speed: float) -> tuple[str, ...]:
    """Cells of a push, um and deg; its speed in m/s."""
    x, y, theta = push.start
    note = ""
    if push.moved_from_corner > 0.0:
        asked, moved = push.asked / units.UM, push.moved_from_corner / units.UM
        note = f"asked for {number(asked)}, at the corner; moved inwards by {number(moved)}"
    return (
        pages.code(push.name),
        f"{_um(x)}, {_um(y)}, {number(theta / units.DEG)}°",
        f"{_um(push.tip[0])}, {_um(push.tip[1])}",
        f"{_um(push.travel[0])}, {_um(push.travel[1])}",
        _um(speed),
        f"edge {push.edge}, {_um(push.place)}",
        pages.html('<span class="muted">{}</span>', note),
    )


def _ends(interval: Interval, unit: float) -> str:
    if not interval.informed:
        return "its range only"
    return f"{significant(interval.low / unit)} … {significant(interval.high / unit)}"


def _um(value: float) -> str:
    return number(value / units.UM)
