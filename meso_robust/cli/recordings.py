"""``meso-robust recordings``: checks a recording set, repairs it, imports other formats."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from meso_robust.cli.console import NEGATIVE, Reporter, refuse


@dataclass(frozen=True, slots=True, kw_only=True)
class _Asked:
    """What the user asked for."""

    path: Path
    format_name: str | None
    repair: bool
    out: Path
    as_json: bool
    quiet: bool


def recordings(
    path: Annotated[Path, typer.Argument(help="Recording set, or recordings in another format.")],
    format_name: Annotated[
        str | None,
        typer.Option("--format", help="set or the name of another format; found out if not given."),
    ] = None,
    repair: Annotated[
        bool, typer.Option("--repair", help="Repair what can be without inventing data.")
    ] = False,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path(
        "meso-robust-recordings"
    ),
    as_json: Annotated[bool, typer.Option("--json", help="Print summary.json only.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but the result.")] = False,
) -> None:
    """Check recordings and list what is wrong; write a report, a repaired or an imported set."""
    from meso_robust.errors import InputError

    asked = _Asked(
        path=path,
        format_name=format_name,
        repair=repair,
        out=out,
        as_json=as_json,
        quiet=quiet,
    )
    try:
        _check(asked, Reporter(quiet or as_json))
    except InputError as error:
        refuse(error)


def _check(asked: _Asked, say: Reporter) -> None:
    import json

    from meso_robust.files import check_folder, write_all
    from meso_robust.recordings import write_set
    from meso_robust.recordings.checking import OWN, checked
    from meso_robust.recordings.summary import answer, document

    check_folder(asked.out)
    with say.doing("reading and checking"):
        found = checked(asked.path, asked.format_name, asked.repair)
    folder = asked.out / "recordings"
    writes = asked.repair or found.format != OWN
    if writes:
        _refuse_own_folder(folder, asked.path)
    text = json.dumps(document(found), indent=2, allow_nan=False) + "\n"
    with say.doing("writing the results"):
        from meso_robust.reporting.recordings import recordings_report

        page = recordings_report(found)
        if writes:
            write_set(folder, found.recordings)
        write_all(asked.out, {"summary.json": text, "report.html": page})
    if asked.as_json:
        print(text, end="")
    elif not asked.quiet:
        print(answer(found))
        print(f"report: {asked.out / 'report.html'}")
        if writes:
            print(f"recording set: {folder}")
    if found.matters:
        raise typer.Exit(NEGATIVE)


def _refuse_own_folder(folder: Path, source: Path) -> None:
    """Recordings as they were made must stay."""
    from meso_robust.errors import InputError

    if folder.resolve() in (source.resolve(), source.resolve().parent):
        raise InputError(
            f"--out {folder.parent}: would write over the recordings in {folder}, which must stay "
            "as they were made; give another folder"
        )
