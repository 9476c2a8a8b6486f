"""``meso-robust plan``: the main job, from a task to a certified and cross-checked plan."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated

import typer

from meso_robust.cli.console import NEGATIVE, Reporter, negative, refuse

if TYPE_CHECKING:
    from meso_robust.job import Planned


def plan(
    task: Annotated[
        Path | None, typer.Argument(help="Task file (TOML); the paper's task if left out.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("meso-robust-plan"),
    samples: Annotated[int, typer.Option(min=1, help="Random runs in the simulator.")] = 1000,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random runs.")] = 0,
    widest: Annotated[
        bool,
        typer.Option(
            "--widest",
            help="Search tip spacing, push offsets and travels for the widest margin (minutes); "
            "also writes the task with that spacing.",
        ),
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print certificate.json only.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but the result.")] = False,
) -> None:
    """Find a plan, certify it, cross-check it in the simulator, and write a report."""
    from meso_robust.errors import InputError, NotApplicableError

    say = Reporter(quiet or as_json)
    try:
        _plan(task, out, samples, seed, widest, as_json, quiet, say)
    except InputError as error:
        refuse(error)
    except NotApplicableError as error:
        negative(f"UNKNOWN: {error}")


def _plan(
    task_file: Path | None,
    out: Path,
    samples: int,
    seed: int,
    widest: bool,
    as_json: bool,
    quiet: bool,
    say: Reporter,
) -> None:
    from meso_robust.files import check_folder
    from meso_robust.task import load_task, with_spacing
    from meso_robust.tasks import PAPER

    task = load_task(task_file or PAPER)
    check_folder(out)

    from meso_robust.job import make, make_best

    result = (make_best if widest else make)(task, samples, seed, say.doing)
    more = {}
    if widest:
        text = (task_file or PAPER).read_text(encoding="utf-8")
        more["task.toml"] = with_spacing(text, result.task.probe.tip_spacing_um)
    write(result, out, say, more)
    tell(result, out, as_json, quiet)


def write(
    result: Planned, out: Path, say: Reporter, more: Mapping[str, str] = MappingProxyType({})
) -> None:
    """Write plan, certificate, report and ``more`` files (name to text), all or none."""
    from meso_robust.files import write_all
    from meso_robust.reporting.page import report

    with say.doing("writing the report"):
        page = report(result)
    documents = {"plan.json": result.plan, "certificate.json": result.certificate}
    texts = {
        name: document.model_dump_json(by_alias=True, indent=2) + "\n"
        for name, document in documents.items()
    }
    write_all(out, {**texts, "report.html": page, **more})


def tell(result: Planned, out: Path, as_json: bool, quiet: bool) -> None:
    """Print the answer; ends with exit status 1 unless it is PROVED."""
    if as_json:
        print(result.certificate.model_dump_json(by_alias=True, indent=2))
    elif not quiet:
        print(result.summary)
        print(f"report: {out / 'report.html'}")
    if result.certificate.verdict != "PROVED":
        raise typer.Exit(NEGATIVE)
