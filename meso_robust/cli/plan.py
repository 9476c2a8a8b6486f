"""``meso-robust plan``: the main job, from a task to a certified and cross-checked plan."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from meso_robust.cli.console import NEGATIVE, Reporter, negative, refuse


def plan(
    task: Annotated[
        Path | None, typer.Argument(help="Task file (TOML); the paper's task if left out.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("meso-robust-plan"),
    samples: Annotated[int, typer.Option(min=1, help="Random runs in the simulator.")] = 1000,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random runs.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print certificate.json only.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but the result.")] = False,
) -> None:
    """Find a plan, certify it, cross-check it in the simulator, and write a report."""
    from meso_robust.errors import InputError, NotApplicableError

    say = Reporter(quiet or as_json)
    try:
        _plan(task, out, samples, seed, as_json, quiet, say)
    except InputError as error:
        refuse(error)
    except NotApplicableError as error:
        negative(f"UNKNOWN: {error}")


def _plan(
    task_file: Path | None,
    out: Path,
    samples: int,
    seed: int,
    as_json: bool,
    quiet: bool,
    say: Reporter,
) -> None:
    from meso_robust.files import check_folder, write_all
    from meso_robust.task import load_task
    from meso_robust.tasks import PAPER

    task = load_task(task_file or PAPER)
    check_folder(out)

    from meso_robust.job import make
    from meso_robust.reporting.page import report

    result = make(task, samples, seed, say.doing)
    with say.doing("writing the report"):
        page = report(result)
    certificate = result.certificate.model_dump_json(by_alias=True, indent=2) + "\n"
    write_all(
        out,
        {
            "plan.json": result.plan.model_dump_json(by_alias=True, indent=2) + "\n",
            "certificate.json": certificate,
            "report.html": page,
        },
    )
    if as_json:
        print(certificate, end="")
    elif not quiet:
        print(result.summary)
        print(f"report: {out / 'report.html'}")
    if result.certificate.verdict != "PROVED":
        raise typer.Exit(NEGATIVE)
