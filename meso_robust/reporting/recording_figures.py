"""One recording in pictures: the way of part and tips to scale, and x, y, θ over time."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from meso_robust import units
from meso_robust.recordings import Recording, RecordingSet, unwrapped
from meso_robust.recordings.phases import Phase
from meso_robust.reporting.canvas import (
    AFTER,
    AXIS_NAME,
    BEFORE,
    CERTIFIED,
    CERTIFIED_FILL,
    GHOST,
    MISS,
    OPEN,
    TIP,
    corners,
    fit_equal,
    outline,
    poses_shown,
)
from meso_robust.types import Floats

SIZE = (11.6, 4.2)  # inches
MOST_POINTS = 400  # of one line
GHOSTS = 4  # outlines between the first and the last


def recording_figure(
    recordings: RecordingSet,
    recording: Recording,
    marked: frozenset[int],
    phases: tuple[Phase, ...],
) -> Figure:
    """Draw one recording, in um, deg and s.

    Parameters
    ----------
    recordings
        Its set.
    recording
        What to draw; a line is broken where a pose was not seen or rows are missing.
    marked
        Rows with a problem, drawn in red.
    phases
        Contact is shaded.
    """
    figure = Figure(figsize=SIZE)
    plane = figure.add_axes((0.057, 0.11, 0.36, 0.86))
    poses = poses_shown(unwrapped(recording).poses)
    _plane(plane, recordings, recording, sorted(marked))
    columns = (("x", 0), ("y", 1), ("theta", 2))
    holes = _holes(recording, recordings.sensor.frame_rate)
    for row, (coordinate, axis) in enumerate(columns):
        axes = figure.add_axes((0.49, 0.11 + 0.3 * (2 - row), 0.50, 0.26))
        for phase in phases:
            if phase.name == "contact":
                axes.axvspan(phase.start, phase.end, color=CERTIFIED_FILL, lw=0)
        for start, end in holes:
            axes.axvspan(start, end, color=OPEN, alpha=0.35, lw=0)
        kept = _thinned(recording.times.size, marked)
        _line(axes, recording.times[kept], poses[kept, axis], CERTIFIED)
        at = [k for k in sorted(marked) if np.isfinite(poses[k, axis])]
        axes.plot(recording.times[at], poses[at, axis], "o", color=MISS, ms=3.2)
        axes.set_ylabel(AXIS_NAME[coordinate], labelpad=2)
        axes.set_xlim(*_limits(recording.times))
        if row < 2:
            axes.set_xticklabels([])
        else:
            axes.set_xlabel("time in s", labelpad=2)
    return figure


def _plane(axes: Axes, recordings: RecordingSet, recording: Recording, marked: list[int]) -> None:
    """Outlines of the part on its way, and the ways of its reference point and of the tips."""
    body, poses = recordings.part.outline, recording.poses
    seen = np.flatnonzero(~np.any(np.isnan(poses), axis=1))
    drawn: list[Floats] = [recording.probes[k] / units.UM for k in range(recording.times.size)]
    points = np.concatenate(drawn) if drawn else np.zeros((0, 2))
    good = [k for k in seen.tolist() if k not in marked] or seen.tolist()
    if good:
        chosen = [good[int(k)] for k in np.linspace(0, len(good) - 1, GHOSTS + 2).round()]
        for k in chosen[1:-1]:
            outline(axes, poses[k], body, "", fill=False, edgecolor=GHOST, lw=0.8)
        outline(axes, poses[chosen[0]], body, "", fill=False, edgecolor=BEFORE, lw=1.2, ls="--")
        outline(axes, poses[chosen[-1]], body, "", fill=False, edgecolor=AFTER, lw=1.4)
        points = np.concatenate([points, *(corners(poses[k], body) for k in chosen)])
    kept = _thinned(recording.times.size, frozenset(marked))
    _line(axes, poses[kept, 0] / units.UM, poses[kept, 1] / units.UM, CERTIFIED)
    for tip in recording.probes.transpose(1, 0, 2):
        _line(axes, tip[kept, 0] / units.UM, tip[kept, 1] / units.UM, TIP)
    at = [k for k in marked if k in set(seen.tolist())]
    axes.plot(*(poses[at, :2].T / units.UM), "o", color=MISS, ms=3.2)
    points = np.concatenate([points, poses[at, :2] / units.UM])
    points = points[~np.any(np.isnan(points), axis=1)]
    if len(points):
        fit_equal(axes, points, 0.05)
    axes.set_xlabel(AXIS_NAME["x"], labelpad=2)
    axes.set_ylabel(AXIS_NAME["y"], labelpad=2)


def _line(axes: Axes, across: Floats, up: Floats, color: str) -> None:
    """A line that is broken at NaN, with a dot where a point stands alone."""
    axes.plot(across, up, "-", color=color, lw=1.0)
    there = np.concatenate(([False], np.isfinite(up), [False]))
    alone = there[1:-1] & ~there[:-2] & ~there[2:]
    axes.plot(across[alone], up[alone], ".", color=color, ms=1.6)


def _thinned(rows: int, marked: frozenset[int]) -> list[int]:
    """Rows to draw: evenly chosen, and all that have a problem."""
    even = np.linspace(0, rows - 1, min(rows, MOST_POINTS)).round().astype(int)
    return sorted({*even.tolist(), *marked})


def _holes(recording: Recording, rate: float) -> list[tuple[float, float]]:
    """Stretches of time in which more than one frame in a row has no pose."""
    seen = recording.times[~np.any(np.isnan(recording.poses), axis=1)]
    long = np.flatnonzero(np.diff(seen) > 2.5 / rate)
    return [(float(seen[k]), float(seen[k + 1])) for k in long]


def _limits(times: Floats) -> tuple[float, float]:
    space = 0.01 * (times[-1] - times[0]) or 1.0
    return float(times[0] - space), float(times[-1] + space)
