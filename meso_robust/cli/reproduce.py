"""``meso-robust reproduce``: the paper's tables and figures, side by side with the printed values."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from meso_robust.cli.console import INTERRUPTED, Reporter, refuse


def reproduce(
    item: Annotated[
        str | None, typer.Argument(help="One of them, such as table-1 or rrt; all by default.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path(
        "meso-robust-reproduce"
    ),
    quick: Annotated[bool, typer.Option("--quick", help="Fewer runs: a first look.")] = False,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random runs.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print reproduction.json only.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but the result.")] = False,
) -> None:
    """Make the paper's tables and figures again; write them beside the printed values."""
    from meso_robust.errors import InputError

    try:
        _reproduce(item, out, (quick, seed), as_json=as_json, quiet=quiet)
    except InputError as error:
        refuse(error)
    except KeyboardInterrupt:
        print("meso-robust: interrupted; nothing was written", file=sys.stderr)
        raise typer.Exit(INTERRUPTED) from None


def _reproduce(
    item: str | None, out: Path, how: tuple[bool, int], *, as_json: bool, quiet: bool
) -> None:
    from meso_robust.files import check_folder, write_all
    from meso_robust.reproduction.document import document, text
    from meso_robust.reproduction.item import Setting
    from meso_robust.reproduction.items import asked
    from meso_robust.reproduction.reproduce import reproduced

    names = asked(item)
    check_folder(out)
    say = Reporter(quiet or as_json)
    with say.following() as told:
        setting = Setting(quick=how[0], seed=how[1], told=told)
        made = reproduced(names, setting)

    from meso_robust.reproduction.page import reproduction_report

    written = text(document(made, setting))
    write_all(out, {"reproduction.json": written, "index.html": reproduction_report(made, setting)})
    if as_json:
        print(written, end="")
    elif not quiet:
        for one in made.values():
            print(f"{one.name}: {one.found.answer}")
        print(f"report: {out / 'index.html'}")
