"""The report on tracked videos as one HTML page that needs nothing else."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from shlex import quote
from typing import Any

import numpy as np
from markupsafe import Markup
from matplotlib.figure import Figure

from meso_robust.provenance import commit
from meso_robust.recordings import RecordingSet
from meso_robust.reporting.canvas import CERTIFIED, OPEN, TIP
from meso_robust.reporting.recording_figures import recording_figure
from meso_robust.reporting.skeleton import Banner, code, page, versions
from meso_robust.reporting.svg import style, to_svg
from meso_robust.tracking.track import Track
from meso_robust.tracking.track_document import TrackDocument, VideoDocument, lost_in_words
from meso_robust.wording import counted

MOST_PICTURES = 8
"""Videos that are drawn."""
MOST_ROWS = 300
"""Rows of one table."""
UM, DEG = 1e-6, math.pi / 180.0


@dataclass(frozen=True, slots=True)
class _Picture:
    title: str
    caption: str
    svg: Markup


@dataclass(frozen=True, slots=True)
class _Lost:
    video: str
    frames: str
    state: str
    reason: str


def tracking_report(
    answer: TrackDocument, tracks: Sequence[Track], recordings: RecordingSet | None
) -> str:
    """One self-contained HTML page: whether the part was tracked, how well, and where it was lost.

    Parameters
    ----------
    answer
        The result document.
    tracks
        What was seen, in the order of the document.
    recordings
        The set made of those in which the part was found, or None if there is none.
    """
    with style():
        pictures = [] if recordings is None else _pictures(answer, tracks, recordings)
    count = len(answer.videos)
    banner = Banner(
        verb="track",
        subject=", ".join(video.video for video in answer.videos),
        about=counted(count, "video"),
        word="TRACKED" if answer.tracked else "LOST",
        colour="PROVED" if answer.tracked else "REFUTED",
        meaning=_meaning(answer),
        figures=tuple(_figures(answer)),
    )
    return page(
        "tracking.html.j2",
        banner,
        _made(answer),
        answer=answer,
        lost=[row for video in answer.videos for row in _lost(video)],
        most=MOST_ROWS,
        camera=_camera(answer),
        pictures=pictures,
        number=_number,
    )


def _made(answer: TrackDocument) -> list[tuple[str, str]]:
    """What the recordings were made from, and how to make them again."""
    names = " ".join(quote(video.video) for video in answer.videos)
    found = {key: value for key, value in answer.provenance.items() if isinstance(value, str)}
    hashes = [
        (f"SHA-256 of {video.video}", code(video.sha256)) for video in answer.videos if video.sha256
    ]
    asked = answer.provenance.get("asked", {})
    return [
        ("to reproduce", code(f"meso-robust track {names}", " with the options below")),
        ("options", ", ".join(f"{key} {value}" for key, value in asked.items()) or "none"),
        *hashes,
        versions({**found, "commit": commit()}),
    ]


def _meaning(answer: TrackDocument) -> str:
    share = f"{100 * answer.most_lost:g} %"
    if answer.tracked:
        return f"In every video part and probes were found in all frames except {share} at most."
    return f"{lost_in_words(answer)}."


def _figures(answer: TrackDocument) -> list[tuple[str, str]]:
    frames = sum(video.frames for video in answer.videos)
    found = sum(video.found for video in answer.videos)
    places = [video.rms_um for video in answer.videos if video.rms_um is not None]
    angles = [video.rms_deg for video in answer.videos if video.rms_deg is not None]
    return [
        ("frames", f"{frames}"),
        ("with a pose", f"{100 * found / max(frames, 1):.1f} %"),
        ("largest σ of x, y of a video", f"{_number(max(places, default=None), 2)} µm"),
        ("largest σ of θ of a video", f"{_number(max(angles, default=None), 4)} deg"),
    ]


def _lost(video: VideoDocument) -> list[_Lost]:
    return [
        _Lost(
            video.video,
            f"{run.first}" if run.first == run.last else f"{run.first} … {run.last}",
            run.state,
            run.reason,
        )
        for run in video.lost
    ]


def _camera(answer: TrackDocument) -> list[tuple[str, str]]:
    values = answer.calibration
    half: dict[str, Any] = values.get("interval", {})

    def shown(key: str, unit: str) -> str:
        given = f" ± {half[key]:.3g}" if key in half else ""
        return f"{values[key]:.6g}{given}{unit}"

    rows = [
        ("pixel", shown("pixel_um", " µm")),
        ("rotation against the stage", shown("rotation_deg", " deg")),
        ("radial distortion k1, half a diagonal out", shown("k1", "")),
    ]
    if answer.grid is not None:
        rows.append(("from", ", ".join(f"{key} {value}" for key, value in answer.grid.items())))
    if half:
        rows.append(("intervals", "95 %"))
    return rows


def _pictures(
    answer: TrackDocument, tracks: Sequence[Track], recordings: RecordingSet
) -> list[_Picture]:
    by_file = {recording.file: recording for recording in recordings.recordings}
    pictures: list[_Picture] = []
    for k, (video, track) in enumerate(zip(answer.videos, tracks, strict=True)):
        if video.file is None or len(pictures) >= 2 * MOST_PICTURES:
            continue
        recording = by_file[video.file]
        title = f"{video.video}: the way"
        figure = recording_figure(recordings, recording, frozenset(), ())
        caption = "Outlines of the part on its way, tips, and x, y, θ over time; orange: not seen."
        pictures.append(_Picture(title, caption, to_svg(figure, f"way{k}", title)))
        title = f"{video.video}: standard deviations"
        caption = "As the tracker states them for each frame; gaps are lost frames."
        pictures.append(_Picture(title, caption, to_svg(_spread(track), f"spread{k}", title)))
    return pictures


def _spread(track: Track) -> Figure:
    """Standard deviations over time."""
    figure = Figure(figsize=(11.6, 2.6))
    place = figure.add_axes((0.057, 0.19, 0.41, 0.77))
    angle = figure.add_axes((0.56, 0.19, 0.43, 0.77))
    names = (("x", CERTIFIED, 0), ("y", OPEN, 1))
    for name, colour, axis in names:
        sigma = np.sqrt(track.covariances[:, axis, axis]) / UM
        place.plot(track.times, sigma, color=colour, lw=1.0, label=f"part, {name}")
    for p, name in enumerate(track.names):
        spread = np.trace(track.tip_covariances[:, p], axis1=1, axis2=2) / 2.0
        line = "-" if p == 0 else "--"
        place.plot(track.times, np.sqrt(spread) / UM, line, color=TIP, lw=1.0, label=name)
    place.set_ylabel("σ in µm")
    place.legend(frameon=False, fontsize=8)
    angle.plot(track.times, np.sqrt(track.covariances[:, 2, 2]) / DEG, color=CERTIFIED, lw=1.0)
    angle.set_ylabel("σ of θ in deg")
    for axes in (place, angle):
        axes.set_xlabel("time in s", labelpad=2)
        axes.set_ylim(bottom=0.0)
    return figure


def _number(value: float | None, digits: int) -> str:
    return "unknown" if value is None else f"{value:.{digits}f}"
