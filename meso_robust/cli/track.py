"""``meso-robust track``: from videos or folders of images to a recording set."""

from __future__ import annotations

from typing import Annotated

import typer

from meso_robust.api.track import Tracked, check_tables, keep_videos, track as call, tracked
from meso_robust.cli.verb import Run, verb

RESULTS = ("set.toml", "calibration.toml", "track.json", "report.html", "overlay.avi")
"""Files that are written beside the tables."""


@verb(call, Tracked.save, out="meso-robust-track", document="track.json")
def track(
    run: Run,
    start: Annotated[
        str | None,
        typer.Option(help="Pose in the first frame, x_um,y_um,theta_deg; ,,90 gives theta only."),
    ] = None,
    probes: Annotated[
        list[str] | None,
        typer.Option(
            "--probe",
            help="Tip in the first frame, NAME=x_um,y_um; repeatable. Found by its motion by default.",
        ),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Recorded only; tracking is not random.")] = 0,
) -> Tracked:
    """Track part and probes in videos; write a recording set with covariances and a report."""
    from meso_robust.tracking.job import Job

    # a call takes numbers for start and probes; the job keeps the texts, which track.json repeats
    stated = run.of(call, start=None, probes=None)
    job = Job(
        **stated
        | {
            "videos": tuple(stated["videos"]),
            "commands": tuple(stated["commands"] or ()),
            "start": start,
            "probes": tuple(probes or ()),
            "seed": seed,
        }
    )
    tables = [f"{video.stem}.csv" for video in job.videos]
    logs = [folder / table for folder in job.commands for table in tables if folder.is_dir()]
    run.check_folder([*RESULTS, *tables], logs)
    keep_videos(run.out, job)
    check_tables(run.given["tables"])
    seen = tracked(job, progress=run.say)
    given = {name: run.given[name] for name in ("overlay", "tables")}
    seen.save(run.out, **given, progress=run.say)
    return seen
