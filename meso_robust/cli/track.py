"""``meso-robust track``: from videos or folders of images to a recording set."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from meso_robust.cli.console import Reporter, negative, refuse

if TYPE_CHECKING:
    from meso_robust.tracking.job import Job


def track(  # noqa: PLR0913  # every option of the verb is an argument
    videos: Annotated[list[Path], typer.Argument(help="Video files or folders of images.")],
    task: Annotated[Path | None, typer.Option(help="Task file that states the part.")] = None,
    set_file: Annotated[
        Path | None, typer.Option("--set", help="set.toml that states part and tip radius.")
    ] = None,
    length_um: Annotated[float | None, typer.Option(help="Long side of the part.")] = None,
    width_um: Annotated[float | None, typer.Option(help="Short side of the part.")] = None,
    tip_radius_um: Annotated[float | None, typer.Option(help="Radius of the tips.")] = None,
    calibration: Annotated[Path | None, typer.Option(help="calibration.toml.")] = None,
    pixel_um: Annotated[float | None, typer.Option(help="Size of a pixel.")] = None,
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
        typer.Option(help="Tip in the first frame, NAME=x_um,y_um; repeat it. Else by motion."),
    ] = None,
    commands: Annotated[
        list[Path] | None,
        typer.Option(
            help="Commanded positions: time_s,<probe>_x_um,<probe>_y_um; a folder has a CSV file of "
            "each video's name."
        ),
    ] = None,
    frame_rate_hz: Annotated[
        float | None, typer.Option(help="Frame rate, instead of the file's.")
    ] = None,
    allow_truncated: Annotated[
        bool, typer.Option("--allow-truncated", help="Use the frames before a video's break.")
    ] = False,
    most_lost: Annotated[
        float, typer.Option(min=0, max=1, help="Largest share of frames that may be lost.")
    ] = 0.1,
    overlay: Annotated[bool, typer.Option(help="Write a video with what was seen.")] = True,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("meso-robust-track"),
    seed: Annotated[int, typer.Option(min=0, help="Recorded; nothing here is random.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print track.json only.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but the result.")] = False,
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
        _track(job, out, overlay, Reporter(quiet or as_json), as_json, quiet)
    except InputError as error:
        refuse(error)


def _track(job: Job, out: Path, overlay: bool, say: Reporter, as_json: bool, quiet: bool) -> None:
    from meso_robust.files import check_folder
    from meso_robust.tracking.job import prepared, run, write
    from meso_robust.tracking.track_document import lost_in_words

    check_folder(out)
    _keep_apart(job, out)
    found = run(prepared(job), say.counting)
    from meso_robust.reporting.tracking import tracking_report

    page = tracking_report(found.answer, found.tracks, found.recordings)
    write(out, found, page, say.counting if overlay else None)
    answer = found.answer
    if as_json:
        print(answer.model_dump_json(by_alias=True, indent=2))
    elif not quiet:
        for video in answer.videos:
            print(f"{video.video}: part found in {video.found} of {video.frames} frames")
            for note in video.notes:
                print(f"  {note}")
        print(f"report: {out / 'report.html'}")
    if not answer.tracked:
        negative(lost_in_words(answer))


def _keep_apart(job: Job, out: Path) -> None:
    """Refuse a folder in which a result could be written over a video."""
    from meso_robust.errors import InputError

    for video in job.videos:
        if video.resolve().parent == out.resolve() or video.resolve() == out.resolve():
            raise InputError(
                f"--out {out}: holds {video.name}, which must not be written over; give another "
                "folder"
            )
