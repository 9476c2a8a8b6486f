"""``meso-robust reproduce``: the paper's tables and figures, side by side with the printed values."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from meso_robust.cli.console import INTERRUPTED, Reporter, refuse

if TYPE_CHECKING:
    from meso_robust.api.reproduce import Reproduced


def reproduce(
    item: Annotated[
        str | None, typer.Argument(help="One of them, such as table-1 or rrt; all by default.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path(
        "meso-robust-reproduce"
    ),
    quick: Annotated[bool, typer.Option("--quick", help="Fewer runs, for a first look.")] = False,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random runs.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print reproduction.json only.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print only the result.")] = False,
) -> None:
    """Make the paper's tables and figures again; write them beside the printed values."""
    from meso_robust.errors import InputError

    try:
        found = _found(item, out, Reporter(quiet or as_json), quick=quick, seed=seed)
    except InputError as error:
        refuse(error)
    except KeyboardInterrupt:
        print("meso-robust: interrupted; nothing was written", file=sys.stderr)
        raise typer.Exit(INTERRUPTED) from None
    if as_json:
        print(found.text(), end="")
    elif not quiet:
        print(found)
        print(f"report: {out / 'index.html'}")


def _found(item: str | None, out: Path, say: Reporter, **asked: Any) -> Reproduced:
    """The items, written into ``out``."""
    from meso_robust.api.reproduce import reproduce as reproduced
    from meso_robust.files import check_folder

    check_folder(out)
    found = reproduced(item, progress=say, **asked)
    found.save(out)
    return found
