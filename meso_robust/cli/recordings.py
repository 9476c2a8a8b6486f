"""``meso-robust recordings``: checks a recording set, repairs it, imports other formats."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from meso_robust.cli.console import NEGATIVE, Reporter, refuse

if TYPE_CHECKING:
    from meso_robust.api.recordings import Recordings


def recordings(
    path: Annotated[Path, typer.Argument(help="Recording set, or recordings in another format.")],
    format_name: Annotated[
        str | None,
        typer.Option("--format", help="set or the name of another format; detected by default."),
    ] = None,
    repair: Annotated[
        bool, typer.Option("--repair", help="Repair what can be repaired without inventing data.")
    ] = False,
    outline: Annotated[
        Path | None,
        typer.Option(
            help="TOML file with [part] as in set.toml, for a format that does not state the outline."
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path(
        "meso-robust-recordings"
    ),
    as_json: Annotated[bool, typer.Option("--json", help="Print summary.json only.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print only the result.")] = False,
) -> None:
    """Check recordings and list what is wrong; write a report, a repaired or an imported set."""
    import json

    from meso_robust.errors import InputError

    try:
        found = _found(path, format_name, repair, outline, out, Reporter(quiet or as_json))
    except InputError as error:
        refuse(error)
    if as_json:
        print(json.dumps(found.document, indent=2, allow_nan=False))
    elif not quiet:
        print(found)
        print(f"report: {out / 'report.html'}")
        if found.rewritten:
            print(f"recording set: {out / 'recordings'}")
    if found.problems:
        raise typer.Exit(NEGATIVE)


def _found(
    path: Path,
    format_name: str | None,
    repair: bool,
    outline: Path | None,
    out: Path,
    say: Reporter,
) -> Recordings:
    """The checked set, with its results written into ``out``."""
    from meso_robust.api.recordings import read_recordings
    from meso_robust.files import check_folder

    check_folder(out)
    found = read_recordings(path, format=format_name, repair=repair, outline=outline, progress=say)
    found.save(out, progress=say)
    return found
