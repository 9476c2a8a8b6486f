"""``track.json``: what was seen, what was lost and why, and from what."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from meso_robust import __version__
from meso_robust.recordings.rules import DEG, UM
from meso_robust.tracking.calibration import Calibration
from meso_robust.tracking.calibration_document import calibration_values
from meso_robust.wording import counted

if TYPE_CHECKING:
    from meso_robust.tracking.track import Track

_CHUNK = 1 << 20


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, title=None)


class LostDocument(_Section):
    """Frames in a row without a pose."""

    first: int
    """First frame, from 0."""
    last: int
    """Last frame."""
    state: str
    """Whether the part was found in them."""
    reason: str
    """Why, in words."""


class ProbeDocument(_Section):
    """A probe in a video, as seen."""

    name: str
    """The probe, as in the columns of the recording."""
    found: int
    """Frames in which it was found."""
    sigma_px: float | None
    """Root mean square standard deviation of a coordinate."""
    lost: dict[str, int]
    """Frames by the reason for which the probe was not found."""


class VideoDocument(_Section):
    """One video."""

    video: str
    """Path of the video or folder as it was given."""
    sha256: str | None
    """SHA-256 of the file; null for a folder."""
    file: str | None
    """The recording made of it; null if the part was never found."""
    frames: int
    """Frames that were read."""
    promised: int | None
    """Frames that the file's header states; null if it states none."""
    frame_rate_hz: float
    """Frames a second."""
    width_px: int
    """Width of the image, px."""
    height_px: int
    """Height of the image, px."""
    found: int
    """Frames with a pose of the part."""
    lost_share: float
    """Share of the frames without one."""
    states: dict[str, int]
    """Frames by what became of the part."""
    lost: list[LostDocument]
    """Frames without a pose."""
    rms_px: float | None
    """Root mean square standard deviation of the part's x and y, px."""
    rms_um: float | None
    """The same, um."""
    rms_deg: float | None
    """The same of theta, deg."""
    mean_score: float | None
    """Mean score of the match over the frames with a pose."""
    probes: list[ProbeDocument]
    """The probes as seen."""
    notes: list[str]
    """What else was noticed."""


class TrackDocument(_Section):
    """The answer of ``track``."""

    schema_: Literal["meso-robust/track/1"] = Field(
        default="meso-robust/track/1", serialization_alias="schema"
    )
    """Name and version of the format."""
    tracked: bool
    """Whether in every video part and probes were found, in all frames but the stated share."""
    commanded: bool
    """Whether the positions of the probes are the controller's; then none need be seen."""
    most_lost: float
    """Share of frames that may be lost."""
    videos: list[VideoDocument]
    """The videos, in the order given."""
    calibration: dict[str, Any]
    """Content of `calibration.toml`."""
    grid: dict[str, Any] | None
    """What the calibration was fitted to, if it was."""
    provenance: dict[str, Any]
    """Versions, and what was asked."""


def track_document(
    tracks: Sequence[Track],
    files: Sequence[str],
    calibration: Calibration,
    most_lost: float,
    asked: dict[str, Any],
    grid: dict[str, Any] | None = None,
    commanded: bool = False,
) -> TrackDocument:
    """Sum up some tracks.

    Parameters
    ----------
    tracks, files
        And the files of the recordings made of them.
    calibration
        Used for all.
    most_lost
        Largest share of frames that may be lost.
    asked
        Options of the command, for provenance.
    grid
        What the calibration was fitted to.
    commanded
        Whether the tips are where the controller says, so that none need be seen.
    """
    videos = [_video(track, file, calibration) for track, file in zip(tracks, files, strict=True)]
    return TrackDocument(
        tracked=not _failures(videos, most_lost, commanded),
        commanded=commanded,
        most_lost=most_lost,
        videos=videos,
        calibration=calibration_values(calibration),
        grid=grid,
        provenance={"meso_robust": __version__, **_libraries(), "asked": asked},
    )


def lost_in_words(document: TrackDocument) -> str:
    """One line on the first video that was not tracked.

    Parameters
    ----------
    document
        Of a tracking that lost a video.

    Returns
    -------
    str
        File, reason and frame.
    """
    return _failures(document.videos, document.most_lost, document.commanded)[0]


def _failures(videos: Sequence[VideoDocument], most_lost: float, commanded: bool) -> list[str]:
    """What was lost in more frames than allowed, a line each."""
    lines = []
    for video in videos:
        reasons = Counter[str]()
        for run in video.lost:
            reasons[run.reason or run.state] += run.last - run.first + 1
        counts = [("part", video.found, dict(reasons))]
        if not commanded:
            counts += [(probe.name, probe.found, probe.lost) for probe in video.probes]
        lines += [
            f"{video.video}: {_lost(name, found, video.frames, why, most_lost)}"
            for name, found, why in counts
            if not found or video.frames - found > most_lost * video.frames
        ]
    return lines


def _lost(name: str, found: int, frames: int, reasons: dict[str, int], most: float) -> str:
    why = max(reasons, key=lambda reason: reasons[reason]) if reasons else "no frames"
    if not found:
        return f"{name} not found in any of {counted(frames, 'frame')} ({why})"
    return (
        f"{name} lost in {frames - found} of {counted(frames, 'frame')}, {100 * (1 - found / frames):.1f} %, "
        f"more than {100 * most:g} % (most often: {why})"
    )


def _video(track: Track, file: str, calibration: Calibration) -> VideoDocument:
    found = track.found
    spread = track.covariances[found]
    place = _rms(np.trace(spread[:, :2, :2], axis1=1, axis2=2) / 2.0)
    count = len(track.times)
    return VideoDocument(
        video=str(track.frames.path),
        sha256=_digest(track.frames.path),
        file=file if found.any() else None,
        frames=count,
        promised=track.frames.promised,
        frame_rate_hz=track.frames.rate,
        width_px=track.frames.size[0],
        height_px=track.frames.size[1],
        found=int(found.sum()),
        lost_share=float(1.0 - found.mean()),
        states=dict(Counter(track.states)),
        lost=_lost_runs(track),
        rms_px=None if place is None else place / calibration.pixel_size,
        rms_um=None if place is None else place / UM,
        rms_deg=None if place is None else (_rms(spread[:, 2, 2]) or 0.0) / DEG,
        mean_score=float(track.scores[found].mean()) if found.any() else None,
        probes=[_probe(track, p, calibration) for p in range(len(track.names))],
        notes=list(track.notes),
    )


def _rms(variances: Any) -> float | None:
    return float(np.sqrt(np.mean(variances))) if len(variances) else None


def _lost_runs(track: Track) -> list[LostDocument]:
    keys = [
        (state, reason) if not found else None
        for state, reason, found in zip(track.states, track.reasons, track.found, strict=True)
    ]
    runs, at = [], 0
    for key, group in groupby(keys):
        length = len(list(group))
        if key is not None:
            runs.append(LostDocument(first=at, last=at + length - 1, state=key[0], reason=key[1]))
        at += length
    return runs


def _probe(track: Track, p: int, calibration: Calibration) -> ProbeDocument:
    seen = np.isfinite(track.tips[:, p, 0])
    spread = track.tip_covariances[seen, p]
    sigma = _rms(np.trace(spread, axis1=1, axis2=2) / 2.0)
    reasons = Counter(
        row[p] or "a repeated frame"
        for row, good in zip(track.tip_reasons, seen, strict=True)
        if not good
    )
    return ProbeDocument(
        name=track.names[p],
        found=int(seen.sum()),
        sigma_px=None if sigma is None else sigma / calibration.pixel_size,
        lost=dict(reasons),
    )


def _digest(path: Path) -> str | None:
    if path.is_dir():
        return None
    digest = hashlib.sha256()
    with path.open("rb") as stream:
        while chunk := stream.read(_CHUNK):
            digest.update(chunk)
    return digest.hexdigest()


def _libraries() -> dict[str, str]:
    import cv2

    return {"numpy": np.__version__, "opencv": cv2.__version__}
