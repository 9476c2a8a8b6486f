"""One recording in pictures: the way of part and tips to scale, and x, y, θ over time."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup

from meso_robust.recordings import Recording, RecordingSet, unwrapped
from meso_robust.recordings.phases import Phase
from meso_robust.recordings.rules import DEG, UM
from meso_robust.reporting.plot import Area, equal, limits, picture
from meso_robust.reporting.theme import (
    BLUE,
    BLUE_FILL,
    GHOST,
    LAST,
    ORANGE,
    PURPLE,
    VERMILION,
    WAY,
)
from meso_robust.types import Floats, Indices

WIDTH, HEIGHT = 835.0, 302.0  # pt
MOST_POINTS = 400  # of one line
GHOSTS = 4  # outlines between the first and the last
_NAMES = ("x in µm", "y in µm", "θ in deg")


def recording_svg(
    recordings: RecordingSet,
    recording: Recording,
    marked: frozenset[int],
    phases: tuple[Phase, ...],
    label: str,
) -> Markup:
    """Draw one recording, in um, deg and s.

    Parameters
    ----------
    recordings
        Its set.
    recording
        What to draw; a line is broken where a pose was not seen or rows are missing.
    marked
        Rows with a problem, drawn in purple.
    phases
        Contact is shaded.
    label
        What the picture shows, for readers who do not see it.

    Returns
    -------
    Markup
        An ``<svg>`` element.
    """
    return picture(
        WIDTH,
        HEIGHT,
        label,
        [
            *_plane(recordings, recording, sorted(marked)),
            *_rows(recordings, recording, marked, phases),
        ],
    )


def _rows(
    recordings: RecordingSet,
    recording: Recording,
    marked: frozenset[int],
    phases: tuple[Phase, ...],
) -> list[str]:
    """x, y and θ over time."""
    parts = []
    times = recording.times
    poses = unwrapped(recording).poses / [UM, UM, DEG]
    space = 0.01 * (times[-1] - times[0]) or 1.0
    kept, at = _thinned(times.size, marked), np.array(sorted(marked), dtype=np.intp)
    for row, name in enumerate(_NAMES):
        x = (float(times[0] - space), float(times[-1] + space))
        area = Area(420.0, 8.0 + 90.0 * row, 408.0, 78.0, x, limits(poses[:, row]))
        for phase in phases:
            if phase.name == "contact":
                parts.append(area.band(phase.start, phase.end, BLUE_FILL))
        for start, end in _holes(recording, recordings.sensor.frame_rate):
            parts.append(area.band(start, end, ORANGE, 0.35))
        last = row == len(_NAMES) - 1
        parts += [
            area.frame("time in s" if last else "", name, numbers=last),
            area.line(times[kept], poses[kept, row], BLUE),
            area.dots(times[at], poses[at, row], PURPLE),
        ]
    return parts


def _plane(recordings: RecordingSet, recording: Recording, marked: list[int]) -> list[str]:
    """Outlines of the part on its way, and the ways of its reference point and of the tips."""
    poses = recording.poses
    seen = np.flatnonzero(~np.any(np.isnan(poses), axis=1)).tolist()
    good = [k for k in seen if k not in set(marked)] or seen
    chosen = (
        [good[int(k)] for k in np.linspace(0, len(good) - 1, GHOSTS + 2).round()] if good else []
    )
    shapes = [_outline(recordings.part.outline, poses[k]) for k in chosen]
    tips = recording.probes / UM
    points = np.concatenate([tips.reshape(-1, 2), *shapes, poses[marked, :2] / UM])
    points = points[~np.any(np.isnan(points), axis=1)]
    wide, tall = 300.0, 262.0
    x, y = equal(points, wide, tall) if len(points) else ((0.0, 1.0), (0.0, 1.0))
    area = Area(50.0, 8.0, wide, tall, x, y)
    kept = _thinned(recording.times.size, frozenset(marked))
    parts = [area.frame(*_NAMES[:2])]
    parts += [area.line(shape[:, 0], shape[:, 1], GHOST, 0.8) for shape in shapes[1:-1]]
    if shapes:
        parts.append(area.line(shapes[0][:, 0], shapes[0][:, 1], WAY, 1.2, dash="4 2"))
        parts.append(area.line(shapes[-1][:, 0], shapes[-1][:, 1], LAST, 1.4))
    parts.append(area.line(poses[kept, 0] / UM, poses[kept, 1] / UM, BLUE))
    parts += [area.line(tip[kept, 0], tip[kept, 1], VERMILION) for tip in tips.transpose(1, 0, 2)]
    return [*parts, area.dots(poses[marked, 0] / UM, poses[marked, 1] / UM, PURPLE)]


def _outline(body: Floats, pose: Floats) -> Floats:
    """(V + 1, 2) closed outline of the part at a pose, um."""
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    corners = body @ np.array([[cos, sin], [-sin, cos]]) + pose[:2]
    return np.asarray(np.vstack([corners, corners[:1]]) / UM)


def _thinned(rows: int, marked: frozenset[int]) -> Indices:
    """Rows to draw: evenly chosen, and all that have a problem."""
    even = np.linspace(0, rows - 1, min(rows, MOST_POINTS)).round().astype(np.intp)
    return np.union1d(even, np.array(sorted(marked), dtype=np.intp))


def _holes(recording: Recording, rate: float) -> list[tuple[float, float]]:
    """Stretches of time in which more than one frame in a row has no pose."""
    seen = recording.times[~np.any(np.isnan(recording.poses), axis=1)]
    long = np.flatnonzero(np.diff(seen) > 2.5 / rate)
    return [(float(seen[k]), float(seen[k + 1])) for k in long]
