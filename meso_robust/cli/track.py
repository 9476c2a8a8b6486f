"""``meso-robust track``: from videos or folders of images to a recording set."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from meso_robust.cli.console import Reporter, negative, refuse

if TYPE_CHECKING:
    from meso_robust.api.track import Tracked
    from meso_robust.tracking.job import Job


def track(  # noqa: PLR0913  # every option of the verb is an argument
    videos: Annotated[
        list[Path], typer.Argument(help="Video files, TIFF stacks or folders of images.")
    ],
    task: Annotated[Path | None, typer.Option(help="Task file that states the part.")] = None,
    set_file: Annotated[
        Path | None, typer.Option("--set", help="set.toml that states part and tip radius.")
    ] = None,
    length_um: Annotated[float | None, typer.Option(help="Long side of the part.")] = None,
    width_um: Annotated[float | None, typer.Option(help="Short side of the part.")] = None,
    tip_radius_um: Annotated[float | None, typer.Option(help="Radius of the tips.")] = None,
    calibration: Annotated[Path | None, typer.Option(help="calibration.toml.")] = None,
    pixel_um: Annotated[
        float | None, typer.Option(help="Size of a pixel; read from a TIFF by default.")
    ] = None,
    grid: Annotated[
        Path | None, typer.Option(help="Image of a stage grid (chessboard or dots).")
    ] = None,
    pitch_um: Annotated[float | None, typer.Option(help="Pitch of that grid.")] = None,
    start: Annotated[
        str | None,
        typer.Option(help="Pose in the first frame, x_um,y_um,theta_deg; ,,90 gives theta only."),
    ] = None,
    probe: Annotated[
        list[str] | None,
        typer.Option(
            help="Tip in the first frame, NAME=x_um,y_um; repeatable. Found by its motion by default."
        ),
    ] = None,
    commands: Annotated[
        list[Path] | None,
        typer.Option(
            help="Commanded positions: time_s,<probe>_x_um,<probe>_y_um; a folder has a CSV file of "
            "each video's name."
        ),
    ] = None,
    frame_rate_hz: Annotated[
        float | None, typer.Option(help="Overrides the file's frame rate.")
    ] = None,
    allow_truncated: Annotated[
        bool,
        typer.Option(
            "--allow-truncated",
            help="Accept a truncated video and use the frames before the break.",
        ),
    ] = False,
    most_lost: Annotated[
        float, typer.Option(min=0, max=1, help="Largest share of frames that may be lost.")
    ] = 0.1,
    overlay: Annotated[
        bool, typer.Option(help="Write a video with the tracked poses drawn in.")
    ] = True,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("meso-robust-track"),
    seed: Annotated[int, typer.Option(min=0, help="Recorded only; tracking is not random.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print track.json only.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print only the result.")] = False,
) -> None:
    """Track part and probes in videos; write a recording set with covariances and a report."""
    from meso_robust.errors import InputError
    from meso_robust.tracking.job import Job

    job = Job(
        videos=tuple(videos),
        task=task,
        set_file=set_file,
        length_um=length_um,
        width_um=width_um,
        tip_radius_um=tip_radius_um,
        calibration=calibration,
        pixel_um=pixel_um,
        grid=grid,
        pitch_um=pitch_um,
        start=start,
        probes=tuple(probe or ()),
        commands=tuple(commands or ()),
        frame_rate_hz=frame_rate_hz,
        allow_truncated=allow_truncated,
        most_lost=most_lost,
        seed=seed,
    )
    try:
        found = _found(job, out, overlay, Reporter(quiet or as_json))
    except InputError as error:
        refuse(error)
    if as_json:
        print(found.document.model_dump_json(by_alias=True, indent=2))
    elif not quiet:
        print(found)
        print(f"report: {out / 'report.html'}")
    if not found.tracked:
        from meso_robust.tracking.track_document import lost_in_words

        negative(lost_in_words(found.document))


def _found(job: Job, out: Path, overlay: bool, say: Reporter) -> Tracked:
    """What was seen, written into ``out``."""
    from meso_robust.api.track import keep_videos, tracked
    from meso_robust.files import check_folder

    check_folder(out, *_written_and_read(job))
    keep_videos(out, job)
    found = tracked(job, progress=say)
    found.save(out, overlay=overlay, progress=say)
    return found


def _written_and_read(job: Job) -> tuple[list[str], list[Path | None]]:
    """Names of files that will be written, and the files beside the videos that are read."""
    tables = [f"{video.stem}.csv" for video in job.videos]
    names = ["set.toml", "calibration.toml", "track.json", "report.html", "overlay.avi", *tables]
    logs = [one / table for one in job.commands for table in tables if one.is_dir()]
    return names, [job.task, job.set_file, job.calibration, job.grid, *job.commands, *logs]
