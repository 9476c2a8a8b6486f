"""``meso-robust plan``: the main job, from a task to a certified and cross-checked plan."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from meso_robust.cli.console import NEGATIVE, Reporter, negative, note, refuse
from meso_robust.limits import MOST_SAMPLES

if TYPE_CHECKING:
    from meso_robust.api.plan import Planned

RESULTS = ("plan.json", "certificate.json", "report.html")
"""Files that are always written."""


def plan(  # noqa: PLR0913  # every option of the verb is an argument
    task: Annotated[
        Path | None, typer.Argument(help="Task file (TOML); the paper's task if left out.")
    ] = None,
    model: Annotated[
        Path | None,
        typer.Option(
            help="Fitted model (model.toml): plan the task with its parameters, or report "
            "which premise of the proof it violates; also writes the resulting task and premises.json."
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("meso-robust-plan"),
    samples: Annotated[
        int, typer.Option(min=1, max=MOST_SAMPLES, help="Random runs in the simulator.")
    ] = 1000,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random runs.")] = 0,
    widest: Annotated[
        bool,
        typer.Option(
            "--widest",
            help="Search tip spacing, push offsets and travels for the widest margin (minutes); "
            "also writes the task with that spacing.",
        ),
    ] = False,
    policy: Annotated[
        bool,
        typer.Option(
            "--policy",
            help="Also certify a feedback policy: policy.json for `drive`, region.svg of its starts.",
        ),
    ] = False,
    maps: Annotated[
        bool,
        typer.Option(
            "--maps",
            help="Also draw where each primitive may push, and from which starts (SVG, JSON).",
        ),
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print certificate.json only.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print only the result.")] = False,
) -> None:
    """Find a plan, certify it, cross-check it in the simulator, and write a report."""
    from meso_robust.errors import InputError, NotApplicableError
    from meso_robust.tasks import PAPER

    wanted = {"widest": widest, "policy": policy, "maps": maps}
    try:
        if model is not None and any(wanted.values()):
            raise InputError(
                "--model: cannot be combined with --widest, --policy or --maps, which need only a task; "
                f"plan with the model first, then use {out / 'task.toml'}"
            )
        asked = {"model": model, "samples": samples, "seed": seed, **wanted}
        found = _found(task, out, Reporter(quiet or as_json), **asked)
    except InputError as error:
        refuse(error)
    except NotApplicableError as error:
        unplanned(task or PAPER, out, error, "plan", quiet)
    tell(found, out, as_json, quiet)


def written(*, model: object, widest: bool, policy: bool, maps: bool, **_: object) -> list[str]:
    """Names of the files that will be written (but the drawings of the maps)."""
    names = [*RESULTS]
    names += ["task.toml"] if widest or model is not None else []
    names += ["premises.json"] if model is not None else []
    names += ["policy.json", "policy.md", "region.svg"] if policy else []
    return [*names, "admissible.json"] if maps else names


def _found(task: Path | None, out: Path, say: Reporter, **asked: Any) -> Planned:
    """The judged plan, written into ``out``."""
    from meso_robust.files import check_folder
    from meso_robust.task import load_task
    from meso_robust.tasks import PAPER
    from meso_robust.toml_files import read_toml

    file = task or PAPER
    known = load_task(file)  # before the imports that take seconds
    if asked["model"] is not None:
        known.rectangle("--model")
        read_toml(asked["model"], "give a model.toml")
    check_folder(out, written(**asked), (task, asked["model"]))

    from meso_robust.api.plan import plan as planned

    # the widest margin's task is written as its author wrote the other one
    found = planned(file if asked["widest"] else known, progress=say, **asked)
    found.save(out, progress=say)
    return found


def unplanned(task: Path, out: Path, error: object, verb: str, quiet: bool) -> NoReturn:
    """Write the report of a task that has no plan to judge; ends with exit status 1."""
    from meso_robust.errors import InputError
    from meso_robust.even_film import remarks
    from meso_robust.files import write_all
    from meso_robust.reporting.unplanned import unplanned_report
    from meso_robust.task import load_task

    known = load_task(task)
    if not quiet:  # a ratio of the wrong unit is a reason to find no plan
        for remark in remarks(known):
            note(remark)
    try:
        write_all(out, {"report.html": unplanned_report(known, str(error), verb)})
    except InputError as failed:
        refuse(failed)
    for name in ("plan.json", "certificate.json"):  # of an earlier run: not the answer now
        (out / name).unlink(missing_ok=True)
    negative(f"UNKNOWN: {error} (report: {out / 'report.html'})")


def tell(found: Planned, out: Path, as_json: bool, quiet: bool) -> None:
    """Print the answer; ends with exit status 1 unless PROVED."""
    if not quiet:
        for remark in found.remarks:
            note(remark)
    if as_json:
        print(found.certificate.model_dump_json(by_alias=True, indent=2))
    elif not quiet:
        print(found)
        print(f"report: {out / 'report.html'}")
    if not found.proved:
        raise typer.Exit(NEGATIVE)
