"""``meso-robust identify``: fits a model to recordings, plans and designs the pushes for it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from meso_robust.cli.console import NEGATIVE, Reporter, refuse

if TYPE_CHECKING:
    from meso_robust.api.identify import Identified, StandardTests


def identify(  # noqa: PLR0913  # every option of the verb is an argument
    recordings: Annotated[
        Path, typer.Argument(help="Recording set (folder); with --plan also a task file.")
    ],
    model: Annotated[str, typer.Option(help="viscous, three_point …")] = "viscous",
    starts: Annotated[
        int, typer.Option(min=1, max=10_000, help="Random starts of the search.")
    ] = 20,
    objective: Annotated[
        str,
        typer.Option(help="likelihood, with intervals; printed: the paper's objective alone."),
    ] = "likelihood",
    confidence: Annotated[
        float, typer.Option(min=0.5, max=0.999, help="Probability of the intervals.")
    ] = 0.9,
    plan: Annotated[
        bool, typer.Option("--plan", help="Only write the paper's tests A-H for this part.")
    ] = False,
    design: Annotated[
        int,
        typer.Option(min=0, max=100, help="Also propose this many of the most informative pushes."),
    ] = 0,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random starts.")] = 0,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path(
        "meso-robust-identify"
    ),
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the result document only.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print only the result.")] = False,
) -> None:
    """Fit a model to recorded pushes: values, intervals, and what cannot be known from them."""
    from meso_robust.errors import InputError

    say = Reporter(quiet or as_json)
    asked = {
        "model": model,
        "starts": starts,
        "objective": objective,
        "confidence": confidence,
        "design": design,
        "seed": seed,
    }
    try:
        if plan:
            _tell_tests(_planned(recordings, out, say), out, as_json, quiet)
            return
        found = _found(recordings, out, say, **asked)
    except InputError as error:
        refuse(error)
    if as_json:
        print(found.document.model_dump_json(by_alias=True, indent=2))
    elif not quiet:
        print(found)
        print(f"report: {out / 'report.html'}")
    if not found.positive:
        raise typer.Exit(NEGATIVE)


def _found(recordings: Path, out: Path, say: Reporter, **asked: Any) -> Identified:
    """The fitted model, written into ``out``."""
    from meso_robust.api.inputs import keep_apart
    from meso_robust.files import check_folder
    from meso_robust.recordings import read_set

    check_folder(out)
    keep_apart(out, recordings)
    read_set(recordings)  # before the imports that take seconds

    from meso_robust.api.identify import identify as identified

    found = identified(recordings, progress=say, **asked)
    found.save(out, progress=say)
    return found


def _planned(source: Path, out: Path, say: Reporter) -> StandardTests:
    """The tests A-H, written into ``out``."""
    from meso_robust.api.inputs import keep_apart
    from meso_robust.files import check_folder
    from meso_robust.recordings import read_set
    from meso_robust.task import load_task

    check_folder(out)
    keep_apart(out, source)
    (read_set if source.is_dir() else load_task)(source)  # before the imports that take seconds

    from meso_robust.api.identify import standard_tests

    with say.doing("planning the tests"):
        found = standard_tests(source)
        found.save(out)
    return found


def _tell_tests(found: StandardTests, out: Path, as_json: bool, quiet: bool) -> None:
    if as_json:
        print(found.files()["experiment.json"], end="")
    elif not quiet:
        print(found)
        print(f"drawing: {out / 'experiment.html'}")
