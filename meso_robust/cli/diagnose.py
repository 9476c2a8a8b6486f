"""``meso-robust diagnose``: says what physics the plain model leaves out of recordings."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from meso_robust.cli.console import INTERRUPTED, NEGATIVE, Reporter, refuse

if TYPE_CHECKING:
    from meso_robust.api.diagnose import Diagnosed

STATE = ".meso-robust-diagnose"
"""Folder in that of the results, for what a run that was interrupted has done."""


def diagnose(
    recordings: Annotated[Path, typer.Argument(help="Recording set (folder).")],
    model: Annotated[str, typer.Option(help="The plain model: viscous …")] = "viscous",
    quick: Annotated[
        bool, typer.Option("--quick", help="Fewer simulated sets and candidates; a coarser answer.")
    ] = False,
    seed: Annotated[int, typer.Option(min=0, help="Seed of everything random.")] = 0,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path(
        "meso-robust-diagnose"
    ),
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the result document only.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print only the result.")] = False,
) -> None:
    """Say what physics a plain model leaves out of recordings: where, what, and how much it helps."""
    from meso_robust.errors import InputError

    say = Reporter(quiet or as_json)
    try:
        found = _found(recordings, out, say, model=model, quick=quick, seed=seed)
    except InputError as error:
        refuse(error)
    except KeyboardInterrupt:
        print("meso-robust: interrupted; run again to go on", file=sys.stderr)
        raise typer.Exit(INTERRUPTED) from None
    if as_json:
        print(found.document.model_dump_json(by_alias=True, indent=2))
    elif not quiet:
        print(found)
        print(f"report: {out / 'report.html'}")
    if not found.explained:
        raise typer.Exit(NEGATIVE)


def _found(recordings: Path, out: Path, say: Reporter, **asked: Any) -> Diagnosed:
    """The diagnosis, written into ``out``."""
    from meso_robust.api.inputs import keep_apart
    from meso_robust.files import check_folder
    from meso_robust.recordings import read_set

    check_folder(out)
    keep_apart(out, recordings)
    read_set(recordings)  # before the imports that take seconds

    from meso_robust.api.diagnose import diagnose as diagnosed
    from meso_robust.diagnosis.store import Store

    found = diagnosed(recordings, store=out / STATE, progress=say, **asked)
    found.save(out, progress=say)
    Store(out / STATE, "").clear()
    return found
