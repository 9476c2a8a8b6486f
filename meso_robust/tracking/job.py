"""The whole job of ``track``: what was asked, the videos one by one, the results in a folder."""

from __future__ import annotations

import io
import os
import re
import shutil
import tempfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Literal, TypeAlias

from meso_robust.errors import InputError
from meso_robust.files import write_all
from meso_robust.recordings import Polygon, RecordingSet, Rectangle
from meso_robust.recordings.checks.copies import copy_problems
from meso_robust.recordings.document import SET_FILE
from meso_robust.recordings.rules import file_fault
from meso_robust.recordings.writing import set_files
from meso_robust.tracking.calibration import Calibration
from meso_robust.tracking.calibration_document import calibration_text
from meso_robust.tracking.commands import Commands, read_commands
from meso_robust.tracking.frames import FirstField, Frames, open_frames
from meso_robust.tracking.inputs import stated_camera, stated_part, stated_pose, stated_probes
from meso_robust.tracking.overlay import drawn_overlay
from meso_robust.tracking.scene import Scene
from meso_robust.tracking.track_document import TrackDocument, track_document
from meso_robust.tracking.tracked_set import covariance_file, covariance_text, set_of

if TYPE_CHECKING:
    from meso_robust.tracking.grid_fit import GridFit
    from meso_robust.tracking.track import Track

_SAME_PIXEL = 0.01  # of its size, by which two statements of it may differ

Counting: TypeAlias = Callable[[str, int | None], AbstractContextManager[Callable[[], object]]]
"""What shows progress: made of a text and a number of steps, called after each step."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """What was asked, as on the command line (units in the names)."""

    videos: tuple[Path, ...]
    task: Path | None = None
    set_file: Path | None = None
    length_um: float | None = None
    width_um: float | None = None
    tip_radius_um: float | None = None
    calibration: Path | None = None
    pixel_um: float | None = None
    grid: Path | None = None
    pitch_um: float | None = None
    start: str | None = None
    probes: tuple[str, ...] = ()
    commands: tuple[Path, ...] = ()
    frame_rate_hz: float | None = None
    allow_truncated: bool = False
    interlaced: FirstField | None = None
    most_lost: float = 0.1
    seed: int = 0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ready:
    """A job with everything read and checked but the frames."""

    job: Job
    videos: tuple[Frames, ...]
    files: tuple[str, ...]
    part: Rectangle | Polygon
    scene: Scene
    fit: GridFit | None
    commands: tuple[Commands, ...]
    """One a video, or none."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """What a job found.

    Attributes
    ----------
    ready
        The job.
    tracks
        One a video.
    recordings
        The set of those in which the part was found; None if it was found in none.
    answer
        The result document.
    """

    ready: Ready
    tracks: tuple[Track, ...]
    recordings: RecordingSet | None
    answer: TrackDocument


def prepared(job: Job) -> Ready:
    """Read and check everything that was stated.

    Parameters
    ----------
    job
        As stated.

    Returns
    -------
    Ready
        With every file read, so that tracking does not stop for a bad one.

    Raises
    ------
    InputError
        A file or a value breaks a rule.
    """
    part, radius = stated_part(job.task, job.set_file, job.length_um, job.width_um)
    if job.tip_radius_um is not None:
        radius = 1e-6 * job.tip_radius_um
    if radius is None or not 0.0 < radius < 0.01:
        raise InputError(
            "the tips' radius must be known and positive; give --tip-radius-um (12.5 for a tip of "
            "25 um diameter)"
        )
    videos = tuple(
        open_frames(path, job.frame_rate_hz, job.allow_truncated, job.interlaced)
        for path in job.videos
    )
    for video in videos[1:]:
        if video.size != videos[0].size:
            raise InputError(
                f"{video.path}: {video.size[0]} x {video.size[1]} px, but {videos[0].path} has "
                f"{videos[0].size[0]} x {videos[0].size[1]}; track them separately"
            )
    camera, fit = stated_camera(
        videos[0].size, job.calibration, job.pixel_um, job.grid, job.pitch_um, _own_pixel(videos)
    )
    videos = tuple(_scaled(video, camera) for video in videos)
    scene = Scene(
        outline=part.outline,
        tip_radius=radius,
        calibration=camera,
        pose=stated_pose(job.start),
        probes=stated_probes(job.probes),
    )
    return Ready(
        job=job,
        videos=videos,
        files=_files(job.videos),
        part=part,
        scene=scene,
        fit=fit,
        commands=tuple(read_commands(path) for path in _logs(job)),
    )


def _own_pixel(videos: Sequence[Frames]) -> float | None:
    """The side of a pixel in m that all videos state; None if they do not, or differ."""
    sides = {video.pixel for video in videos}
    return sides.pop() if len(sides) == 1 else None


def _scaled(video: Frames, camera: Calibration) -> Frames:
    """The video with a note on the size of a pixel that it states itself, if it does."""
    if video.pixel is None:
        return video
    stated, used = 1e6 * video.pixel, 1e6 * camera.pixel_size
    note = f"the file states pixels of {stated:.6g} um"
    if abs(stated - used) > _SAME_PIXEL * used:
        note += f"; the camera is taken to have {used:.6g} um, as given"
    return replace(video, notes=(*video.notes, note))


def _logs(job: Job) -> tuple[Path, ...]:
    """Files of commands, one a video; a folder has one of each video's name."""
    if len(job.commands) == 1 and job.commands[0].is_dir():
        return tuple(job.commands[0] / f"{video.stem}.csv" for video in job.videos)
    if job.commands and len(job.commands) != len(job.videos):
        raise InputError(
            f"--commands: {len(job.commands)} files for {len(job.videos)} videos; must be one for each video; "
            "give a folder that has a CSV file of each video's name, or track them separately"
        )
    return job.commands


def run(ready: Ready, counting: Counting) -> Found:
    """Track every video.

    Parameters
    ----------
    ready
        What was read.
    counting
        Shows progress.

    Returns
    -------
    Found
        A track a video, and videos that were lost with the reason.

    Raises
    ------
    InputError
        A video breaks a rule.
    """
    from meso_robust.tracking.track import (
        track,  # not needed to refuse a bad file, and slow to import
    )

    tracks = []
    for video in ready.videos:
        with counting(f"tracking {video.path.name}", video.promised) as each:
            tracks.append(track(video, ready.scene, each))
    kept = [k for k, one in enumerate(tracks) if one.found.any()]
    recordings = None
    if kept:
        recordings = set_of(
            [tracks[k] for k in kept],
            [ready.files[k] for k in kept],
            ready.part,
            ready.scene.tip_radius,
            [ready.commands[k] for k in kept] if ready.commands else None,
        )
        tracks = _with_copies(tracks, ready.files, recordings)
    answer = track_document(
        tracks,
        ready.files,
        ready.scene.calibration,
        ready.job.most_lost,
        _plain(asdict(ready.job)),
        _grid(ready.fit),
        commanded=bool(ready.commands),
    )
    return Found(ready=ready, tracks=tuple(tracks), recordings=recordings, answer=answer)


def _with_copies(
    tracks: Sequence[Track], files: Sequence[str], recordings: RecordingSet
) -> list[Track]:
    """The tracks, with a note where one shows the same push as one before: a video given twice."""
    told = {
        copy.file: f"{copy.value}; {copy.advice}" for copy in copy_problems(recordings.recordings)
    }
    return [
        replace(track, notes=(*track.notes, f"the same push twice: {told[file]}"))
        if file in told
        else track
        for track, file in zip(tracks, files, strict=True)
    ]


def texts(found: Found, report: str) -> dict[str, str]:
    """The texts of the results by the names of their files: the set, covariances, camera and report.

    Parameters
    ----------
    found
        What was found.
    report
        Text of report.html.

    Returns
    -------
    dict
        A text for each name.

    Raises
    ------
    InputError
        A value is beyond the limits of the format of recordings.
    """
    ready = found.ready
    return {
        **(set_files(found.recordings) if found.recordings is not None else {}),
        "calibration.toml": calibration_text(ready.scene.calibration),
        "report.html": report,
        "track.json": found.answer.model_dump_json(by_alias=True, indent=2) + "\n",
        **{
            covariance_file(file): covariance_text(one)
            for one, file in zip(found.tracks, ready.files, strict=True)
        },
    }


def write(
    folder: Path,
    found: Found,
    contents: Mapping[str, str],
    counting: Counting | None,
    tables: Literal["parquet", "hdf5"] | None = None,
) -> None:
    """Write the results with overlay videos.

    Parameters
    ----------
    folder
        Made if needed.
    found
        What the overlays show.
    contents
        See :func:`texts`.
    counting
        Shows the progress of the overlays; None: no overlays.
    tables
        Kind of a file that holds everything in one table; None: none.

    Raises
    ------
    InputError
        Something cannot be written; nothing is left half written.
    """
    with ExitStack() as opened, _Drafts(folder) as drafts:
        if tables is not None:
            from meso_robust.tracking.tables import FILES, columns, packed

            table = columns(found.tracks, found.ready.files)
            drafts.add(FILES[tables], io.BytesIO(packed(table, tables)))
        if counting is not None:
            for name, film in _overlays(folder, found, counting):
                drafts.add(name, opened.enter_context(film))
        if found.recordings is None and (folder / "track.json").exists():
            (folder / SET_FILE).unlink(missing_ok=True)  # of an earlier run: not the answer now
        write_all(folder, contents)
        drafts.place()


class _Drafts:
    """A hidden folder for large files, there only while they are put in place."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._path: Path | None = None

    def __enter__(self) -> _Drafts:
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(
                f"--out {self._folder}: cannot be written ({error.strerror}); give a writable folder"
            ) from error
        return self

    def add(self, name: str, content: IO[bytes]) -> None:
        """Lay a file of this name and content ready."""
        try:
            if self._path is None:
                self._path = Path(tempfile.mkdtemp(dir=self._folder, prefix=".", suffix=".part"))
            content.seek(0)
            with (self._path / name).open("wb") as draft:
                shutil.copyfileobj(content, draft)
        except OSError as error:
            raise InputError(
                f"--out {self._folder}: {name} cannot be written ({error.strerror}); give a writable "
                "folder"
            ) from error

    def place(self) -> None:
        """Move the drafts into the folder."""
        for draft in sorted(self._path.iterdir()) if self._path else ():
            os.replace(draft, self._folder / draft.name)

    def __exit__(self, *_: object) -> None:
        if self._path is not None:
            shutil.rmtree(self._path, ignore_errors=True)


def _overlays(folder: Path, found: Found, counting: Counting) -> list[tuple[str, IO[bytes]]]:
    """Name and content of each overlay; all are drawn before the first takes its name."""
    ready = found.ready
    films = []
    for one, file in zip(found.tracks, ready.files, strict=True):
        stem = file.removesuffix(".csv")
        name = "overlay.avi" if len(found.tracks) == 1 else f"overlay_{stem}.avi"
        with counting(f"drawing {name}", len(one.times)) as each:
            film = drawn_overlay(
                folder,
                one,
                ready.scene.outline,
                ready.scene.tip_radius,
                ready.scene.calibration,
                each,
            )
        films.append((name, film))
    return films


def _files(videos: Sequence[Path]) -> tuple[str, ...]:
    """Names of the recordings, after the videos."""
    names: list[str] = []
    for k, video in enumerate(videos):
        stem = re.sub(r"[^A-Za-z0-9_.-]", "_", video.stem if video.suffix else video.name)
        name = f"{stem}.csv"
        taken = [other.lower() for other in names]
        if file_fault(name) or name.lower() in taken or stem.endswith("_covariance"):
            name = f"push_{k:02d}.csv"
        names.append(name)
    return tuple(names)


def _grid(fit: GridFit | None) -> dict[str, Any] | None:
    if fit is None:
        return None
    return {
        "kind": fit.points.kind,
        "points": int(fit.kept.sum()),
        "left_out": int((~fit.kept).sum()),
        "rms_px": round(fit.rms, 4),
    }


def _plain(values: dict[str, Any]) -> dict[str, Any]:
    """Values that JSON has: paths as texts, what was not given left out."""

    def plain(value: Any) -> Any:
        if isinstance(value, (tuple, list)):
            return [plain(item) for item in value]
        return str(value) if isinstance(value, Path) else value

    return {key: plain(value) for key, value in values.items() if value not in (None, ())}
