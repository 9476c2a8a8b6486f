"""The report on tracked videos as one HTML page that needs nothing else."""

from __future__ import annotations

import math
from base64 import b64encode
from collections.abc import Sequence
from shlex import quote
from typing import Any

import numpy as np
from markupsafe import Markup
from matplotlib.figure import Figure

from meso_robust.errors import InputError
from meso_robust.provenance import commit
from meso_robust.recordings import RecordingSet
from meso_robust.reporting import pages
from meso_robust.reporting.canvas import CERTIFIED, OPEN, TIP
from meso_robust.reporting.recording_figures import recording_svg
from meso_robust.reporting.svg import style, to_svg
from meso_robust.tracking.overlay import MAGNIFIED, stills
from meso_robust.tracking.scene import Scene
from meso_robust.tracking.track import Track
from meso_robust.tracking.track_document import TrackDocument, VideoDocument, lost_in_words
from meso_robust.wording import counted

MOST_PICTURES = 8
"""Videos that are drawn."""
MOST_ROWS = 300
"""pages.Rows of one table."""
UM, DEG = 1e-6, math.pi / 180.0


def tracking_report(
    answer: TrackDocument,
    tracks: Sequence[Track],
    recordings: RecordingSet | None,
    scene: Scene | None = None,
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
    scene
        What was known of the videos; None: no frames are shown.

    Returns
    -------
    str
        The page; it asks for nothing from outside.
    """
    with style():
        pictures = [] if recordings is None else _pictures(answer, tracks, recordings)
    lost = [row for video in answer.videos for row in _lost(video)]
    return pages.page(
        pages.Report(
            banner=_banner(answer),
            sections=(
                pages.Section("videos", "Videos", _videos(answer)),
                pages.Section(
                    "lost",
                    "Lost frames",
                    (
                        pages.html(
                            "<p>Frames that cannot be trusted have no pose: their cells stay empty, "
                            "and nothing is filled in.</p>"
                        ),
                        pages.table(
                            "Lost frames",
                            "video | ~frames | state | reason",
                            lost,
                            most=MOST_ROWS,
                            file="track.json",
                        ),
                    )
                    if lost
                    else (pages.html("<p>None: the part has a pose in every frame.</p>"),),
                ),
                *(
                    []
                    if scene is None
                    else [pages.Section("frames", "Frames", _frames(tracks, scene))]
                ),
                pages.Section("camera", "Camera", (pages.facts(_camera(answer)),)),
                pages.Section("pictures", "Pictures", (pages.figure(*pictures),)),
            ),
            made=_made(answer),
        )
    )


def _banner(answer: TrackDocument) -> pages.Banner:
    frames = sum(video.frames for video in answer.videos)
    with_pose = sum(video.found for video in answer.videos)
    places = [video.rms_um for video in answer.videos if video.rms_um is not None]
    angles = [video.rms_deg for video in answer.videos if video.rms_deg is not None]
    share = f"{100 * answer.most_lost:g} %"
    return pages.Banner(
        verb="track",
        subject=", ".join(video.video for video in answer.videos),
        about=counted(len(answer.videos), "video"),
        word="TRACKED" if answer.tracked else "LOST",
        colour="PROVED" if answer.tracked else "REFUTED",
        meaning=f"In every video, part and probes were found in all but at most {share} of the frames."
        if answer.tracked
        else f"{lost_in_words(answer)}.",
        figures=(
            ("frames", f"{frames}"),
            ("with a pose", f"{100 * with_pose / max(frames, 1):.1f} %"),
            ("largest σ of x, y of a video", f"{_number(max(places, default=None), 2)} µm"),
            ("largest σ of θ of a video", f"{_number(max(angles, default=None), 4)} deg"),
        ),
    )


def _made(answer: TrackDocument) -> pages.Rows:
    names = " ".join(quote(video.video) for video in answer.videos)
    programs = {key: value for key, value in answer.provenance.items() if isinstance(value, str)}
    asked = answer.provenance.get("asked", {})
    return pages.made(
        f"meso-robust track {names}",
        ("options", ", ".join(f"{key} {value}" for key, value in asked.items()) or "none"),
        *(
            (f"SHA-256 of {video.video}", pages.code(video.sha256))
            for video in answer.videos
            if video.sha256
        ),
        after=" with the options below",
        using={**programs, "commit": commit()},
    )


def _videos(answer: TrackDocument) -> tuple[Markup, ...]:
    heads = "video | recording | #frames | #part found | #σ of x, y in px | #in µm | #σ of θ in deg | probes: found, σ in px"
    rows = [
        (
            video.video,
            pages.code(video.file) if video.file else "none",
            video.frames,
            video.found,
            _number(video.rms_px, 3),
            _number(video.rms_um, 2),
            _number(video.rms_deg, 4),
            _probes(video),
        )
        for video in answer.videos
    ]
    notes = [
        pages.html("<h3>Notes on {}</h3>", video.video) + pages.bullets(video.notes)
        for video in answer.videos
        if video.notes
    ]
    return (
        pages.table("Videos", heads, rows),
        pages.html(
            "<p>σ is the root mean square of the standard deviations that the tracker states for "
            "each frame; the covariance of each frame is in "
            "<code>&lt;recording&gt;_covariance.csv</code>.</p>"
        ),
        *notes,
    )


def _probes(video: VideoDocument) -> str:
    lines = [
        Markup('<span class="nowrap">{}: {}, {}</span>').format(
            probe.name, probe.found, _number(probe.sigma_px, 3)
        )
        for probe in video.probes
    ]
    return Markup("<br>").join(lines) or "none"


def _lost(video: VideoDocument) -> list[tuple[str, ...]]:
    """Cells of every run of lost frames."""
    return [
        (
            video.video,
            f"{run.first}" if run.first == run.last else f"{run.first} … {run.last}",
            run.state,
            run.reason,
        )
        for run in video.lost
    ]


def _frames(tracks: Sequence[Track], scene: Scene) -> tuple[Markup, ...]:
    """Frames with what was seen in them: the first, the last, the least certain, and refused ones."""
    shown: list[Markup] = [
        pages.html(
            "<p>Outline and tips as tracked; ellipses are standard deviations, {} times as large.</p>",
            f"{MAGNIFIED:g}",
        )
    ]
    for track in tracks[:MOST_PICTURES]:
        try:
            seen = stills(track, scene.outline, scene.tip_radius, scene.calibration)
        except InputError as error:  # the video is no longer there
            shown.append(
                pages.html("<p>{}: no frames to show: {}</p>", track.frames.path.name, error)
            )
            continue
        for still in seen:
            words = f"{track.frames.path.name}, frame {still.frame}: {still.why}"
            shown.append(
                pages.html(
                    '<figure><img alt="{}" style="max-width:100%" src="data:image/jpeg;base64,{}">'
                    "<figcaption>{}</figcaption></figure>",
                    words,
                    b64encode(still.jpeg).decode(),
                    words,
                )
            )
    return tuple(shown)


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
) -> list[pages.Figure]:
    by_file = {recording.file: recording for recording in recordings.recordings}
    pictures: list[pages.Figure] = []
    for k, (video, track) in enumerate(zip(answer.videos, tracks, strict=True)):
        if video.file is None or len(pictures) >= 2 * MOST_PICTURES:
            continue
        way = f"{video.video}: the way"
        deviations = f"{video.video}: standard deviations"
        pictures += [
            pages.Figure(
                svg=recording_svg(recordings, by_file[video.file], frozenset(), (), way),
                title=way,
                caption="Outlines of the part along its path, tips, and x, y, θ over time; orange: not "
                "seen.",
            ),
            pages.Figure(
                svg=to_svg(_spread(track), f"spread{k}", deviations),
                title=deviations,
                caption="As the tracker states them for each frame; gaps are lost frames.",
            ),
        ]
    return pictures


def _spread(track: Track) -> Figure:
    """Standard deviations over time."""
    drawing = Figure(figsize=(11.6, 2.6))
    place = drawing.add_axes((0.057, 0.19, 0.41, 0.77))
    angle = drawing.add_axes((0.56, 0.19, 0.43, 0.77))
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
    return drawing


def _number(value: float | None, digits: int) -> str:
    return "unknown" if value is None else f"{value:.{digits}f}"
