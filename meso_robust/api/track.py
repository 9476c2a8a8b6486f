"""``track``: from videos or folders of images to a recording set."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from meso_robust.api.call import call
from meso_robust.api.inputs import path_of
from meso_robust.api.options import Folder, Option, Share, StrPath
from meso_robust.api.progress import SILENT, Progress
from meso_robust.api.result import Result
from meso_robust.errors import InputError

if TYPE_CHECKING:
    from meso_robust.recordings import RecordingSet
    from meso_robust.tracking.job import Found, Job
    from meso_robust.tracking.track_document import TrackDocument


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Tracked(Result):
    """What was seen in videos.

    Attributes
    ----------
    found
        Everything that was found out.
    """

    found: Found

    @property
    def document(self) -> TrackDocument:
        """The content of ``track.json``."""
        return self.found.answer

    @property
    def recordings(self) -> RecordingSet | None:
        """The recordings of the videos in which the part was found; None if it was found in none."""
        return self.found.recordings

    @property
    def positive(self) -> bool:
        """Whether the part was found in all frames of all videos, except the share that may be lost."""
        return self.document.tracked

    tracked = positive

    @property
    def why_not(self) -> str:
        """What was lost, of the first video that was not tracked."""
        from meso_robust.tracking.track_document import lost_in_words

        return "" if self.tracked else lost_in_words(self.document)

    @property
    def brief(self) -> str:
        """In how many frames of all videos the part was found."""
        videos = self.document.videos
        found, frames = (sum(getattr(one, key) for one in videos) for key in ("found", "frames"))
        return f"part found in {found} of {frames} frames"

    def __str__(self) -> str:
        from meso_robust.wording import counted

        lines = []
        for video in self.document.videos:
            lines.append(
                f"{video.video}: part found in {video.found} of {counted(video.frames, 'frame')}"
            )
            lines += [f"  {note}" for note in video.notes]
        return "\n".join(lines)

    def __repr__(self) -> str:
        from meso_robust.wording import counted

        videos = self.document.videos
        found, frames = sum(one.found for one in videos), sum(one.frames for one in videos)
        return f"<Tracked {counted(len(videos), 'video')}: part found in {found} of {counted(frames, 'frame')}>"

    def _repr_html_(self) -> str:
        from meso_robust.reporting.cards import tracked_card

        return tracked_card(self.found, str(self))

    def files(self) -> dict[str, str]:
        """The texts of the recording set, covariances, camera and report by name; without overlays."""
        from meso_robust.reporting.tracking import tracking_report
        from meso_robust.tracking.job import texts

        scene = self.found.ready.scene
        page = tracking_report(self.document, self.found.tracks, self.recordings, scene)
        return texts(self.found, page)

    def to_frame(self) -> Any:
        """A ``pandas.DataFrame`` with a row for every frame: pose, tips, standard deviations, state.

        Raises
        ------
        InputError
            Pandas is not installed: it comes with the extra ``tables``.
        """
        from meso_robust.tracking.tables import columns, frame

        return frame(columns(self.found.tracks, self.found.ready.files))

    def check_folder(self, folder: Path) -> None:
        """Refuse a folder in which a result could overwrite a video.

        Raises
        ------
        InputError
            There is such a video.
        """
        keep_videos(folder, self.found.ready.job)

    @call
    def save(
        self,
        folder: Folder,
        *,
        overlay: bool = True,
        tables: Literal["parquet", "hdf5"] | None = None,
        progress: Progress = SILENT,
    ) -> None:
        """Write the recording set, covariances, camera, report, and overlay videos.

        Parameters
        ----------
        folder
            Made if needed.
        overlay
            Write a video with the tracked poses drawn in.
        tables
            Also write one table of everything: track.parquet or track.h5.
        progress
            Shows what is being done.

        Raises
        ------
        InputError
            Something cannot be written (nothing is left half written), or the folder holds a video.
        """
        from meso_robust.tracking.job import write

        self.check_folder(Path(folder))
        counting = progress.counting if overlay else None
        write(Path(folder), self.found, self.files(), counting, tables)


@call
def track(  # noqa: PLR0913  # everything that can be stated about videos is an argument
    videos: Annotated[
        StrPath | Sequence[StrPath],
        Option(words="Video files, TIFF stacks or folders of images."),
    ],
    *,
    task: StrPath | None = None,
    set_file: Annotated[StrPath, Option(flag="set")] | None = None,
    length_um: float | None = None,
    width_um: float | None = None,
    tip_radius_um: float | None = None,
    calibration: StrPath | None = None,
    pixel_um: float | None = None,
    grid: StrPath | None = None,
    pitch_um: float | None = None,
    start: tuple[float | None, float | None, float | None] | None = None,
    probes: Annotated[Mapping[str, tuple[float, float]], Option(flag="probe")] | None = None,
    commands: StrPath | Sequence[StrPath] | None = None,
    frame_rate_hz: float | None = None,
    allow_truncated: bool = False,
    interlaced: Literal["top", "bottom"] | None = None,
    most_lost: Share = 0.1,
    progress: Progress = SILENT,
) -> Tracked:
    """Track part and probes in videos.

    Parameters
    ----------
    videos
        A video file, TIFF stack or folder of images, or several.
    task
        Task file that states the part.
    set_file
        ``set.toml`` that states part and tip radius.
    length_um
        Long side of the part.
    width_um
        Short side of the part.
    tip_radius_um
        Radius of the tips.
    calibration
        ``calibration.toml``.
    pixel_um
        Size of a pixel; read from a TIFF by default.
    grid
        Image of a stage grid (chessboard or dots).
    pitch_um
        Pitch of that grid.
    start
        What is known of the pose in the first frame (um, um, deg): ``(None, None, 90.0)``.
    probes
        Tips in the first frame by name, um; found by their motion if left out.
    commands
        Commanded positions: ``time_s,<probe>_x_um,<probe>_y_um``; a folder has a CSV file of each
        video's name.
    frame_rate_hz
        Overrides the file's frame rate.
    allow_truncated
        Accept a truncated video and use the frames before the break.
    interlaced
        Field of an interlaced camera that was exposed first; frames are split.
    most_lost
        Largest share of frames that may be lost.
    progress
        Shows what is being done.

    Returns
    -------
    Tracked
        A result even if the part was lost.

    Raises
    ------
    InputError
        A file or a value breaks a rule, or a video cannot be read.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import numpy as np
    >>> import meso_robust as mr
    >>> from meso_robust.microscope import Part, Probe, Scene, film
    >>> sides = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * [808e-6, 418.5e-6]
    >>> scene = Scene(part=Part(outline=sides), probes=(Probe(tip_radius=12.5e-6),))
    >>> times, tip = np.arange(3) / 30.0, np.array([[[0.0, 700e-6]]] * 3)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     video = Path(folder) / "push.avi"
    ...     _ = film(video, scene, times, np.zeros((3, 3)), tip, np.random.default_rng(0))
    ...     tracked = mr.track(
    ...         video,
    ...         length_um=1616.0,
    ...         width_um=837.0,
    ...         tip_radius_um=12.5,
    ...         pixel_um=5.26,
    ...         start=(None, None, 0.0),
    ...         probes={"left": (0.0, 700.0)},
    ...     )
    >>> tracked
    <Tracked 1 video: part found in 3 of 3 frames>
    >>> bool(np.abs(tracked.recordings.recordings[0].poses[:, :2]).max() < 5e-6)  # a pixel
    True
    """
    several = _paths(videos)
    if not several:
        raise InputError("videos: none are given; give a video or a folder of images")

    from meso_robust.tracking.job import Job

    job = Job(
        videos=several,
        task=path_of(task),
        set_file=path_of(set_file),
        length_um=length_um,
        width_um=width_um,
        tip_radius_um=tip_radius_um,
        calibration=path_of(calibration),
        pixel_um=pixel_um,
        grid=path_of(grid),
        pitch_um=pitch_um,
        start=None if start is None else _listed("start", start, 3),
        probes=tuple(
            f"{name}={_listed(f'probes[{name!r}]', at, 2)}" for name, at in (probes or {}).items()
        ),
        commands=() if commands is None else _paths(commands),
        frame_rate_hz=frame_rate_hz,
        allow_truncated=allow_truncated,
        interlaced=interlaced,
        most_lost=most_lost,
    )
    return tracked(job, progress=progress)


def _paths(given: StrPath | Sequence[StrPath]) -> tuple[Path, ...]:
    several = [given] if isinstance(given, str | PathLike) else given
    return tuple(Path(one) for one in several)


def tracked(job: Job, *, progress: Progress = SILENT) -> Tracked:
    """Do a job that is stated already; see :func:`track`.

    Parameters
    ----------
    job
        What to track.
    progress
        Shows what is being done.

    Returns
    -------
    Tracked
        A result even if the part was lost.
    """
    from meso_robust.tracking.job import prepared, run

    return Tracked(found=run(prepared(job), progress.counting))


def keep_videos(folder: Path, job: Job) -> None:
    """Refuse a folder in which a result could overwrite a video.

    Parameters
    ----------
    folder
        For the results.
    job
        Names the videos.

    Raises
    ------
    InputError
        There is such a video.
    """
    for video in job.videos:
        if folder.resolve() in (video.resolve().parent, video.resolve()):
            raise InputError(
                f"--out {folder}: holds {video.name}, which must not be overwritten; give another "
                "folder"
            )


def check_tables(form: Literal["parquet", "hdf5"] | None) -> None:
    """Refuse a table that could not be written, before the work is begun.

    Parameters
    ----------
    form
        As for :meth:`Tracked.save`.

    Raises
    ------
    InputError
        What writes it is not installed.
    """
    if form is not None:
        from meso_robust.tracking.tables import WRITERS, needed

        needed(WRITERS[form], f"--tables {form}")


def _listed(name: str, values: Any, count: int) -> str:
    """Values as on the command line; what is not known is left empty."""
    try:
        if isinstance(values, str) or len(values) != count:
            raise ValueError
        return ",".join("" if value is None else repr(float(value)) for value in values)
    except (TypeError, ValueError) as error:
        from meso_robust.reading import shown

        like = "(None, None, 90.0)" if name == "start" else "(0.0, 700.0)"
        raise InputError(
            f"{name} = {shown(values)}: must be {count} numbers; give a tuple such as {like}"
        ) from error
