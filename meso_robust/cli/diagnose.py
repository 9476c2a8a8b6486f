"""``meso-robust diagnose``: says what physics the plain model leaves out of recordings."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from meso_robust.cli.console import INTERRUPTED, NEGATIVE, Reporter, refuse

if TYPE_CHECKING:
    from meso_robust.diagnosis.diagnose import Diagnosis
    from meso_robust.diagnosis.document import DiagnosisDocument
    from meso_robust.recordings import RecordingSet

STATE = ".state"
"""Folder in that of the results, for what a run that was interrupted has done."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Asked:
    """What the user asked for."""

    recordings: Path
    model: str
    quick: bool
    seed: int
    out: Path
    as_json: bool
    quiet: bool


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
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but the result.")] = False,
) -> None:
    """Say what physics a plain model leaves out of recordings: where, what, and how much it helps."""
    from meso_robust.errors import InputError

    asked = _Asked(
        recordings=recordings,
        model=model,
        quick=quick,
        seed=seed,
        out=out,
        as_json=as_json,
        quiet=quiet,
    )
    try:
        _diagnose(asked, Reporter(quiet or as_json))
    except InputError as error:
        refuse(error)
    except KeyboardInterrupt:
        print("meso-robust: interrupted; run again to go on", file=sys.stderr)
        raise typer.Exit(INTERRUPTED) from None


def _diagnose(asked: _Asked, say: Reporter) -> None:
    from meso_robust import __version__
    from meso_robust.recordings import read_set

    recordings = read_set(asked.recordings)
    _check_out(asked)

    from meso_robust.diagnosis.answer import document as documented
    from meso_robust.identification.usable import warnings_of

    with say.doing("checking the recordings"):
        warnings = warnings_of(recordings)
    found = _found(asked, recordings, say)
    document = documented(found, __version__, warnings)
    text = document.model_dump_json(by_alias=True, indent=2) + "\n"
    with say.doing("writing the results"):
        _write(asked, found, document, text)
    _tell(asked, document, text, warnings)
    if document.verdict not in ("consistent", "named"):
        raise typer.Exit(NEGATIVE)


def _found(asked: _Asked, recordings: RecordingSet, say: Reporter) -> Diagnosis:
    """The diagnosis, with a bar for each of its stages."""
    from meso_robust.diagnosis.diagnose import diagnose as diagnosed

    with say.following() as told:
        return diagnosed(
            recordings,
            model=asked.model,
            quick=asked.quick,
            seed=asked.seed,
            store=asked.out / STATE,
            told=told,
        )


def _write(asked: _Asked, found: Diagnosis, document: DiagnosisDocument, text: str) -> None:
    import shutil

    from meso_robust import __version__
    from meso_robust.diagnosis.document import FILE
    from meso_robust.diagnosis.model_file import model_toml
    from meso_robust.diagnosis.pictures import evidence
    from meso_robust.files import write_all
    from meso_robust.reporting.diagnosis import diagnosis_report

    page = diagnosis_report(document, evidence(found), str(asked.recordings))
    write_all(
        asked.out, {FILE: text, "model.toml": model_toml(found, __version__), "report.html": page}
    )
    shutil.rmtree(asked.out / STATE, ignore_errors=True)


def _tell(asked: _Asked, document: DiagnosisDocument, text: str, warnings: tuple[str, ...]) -> None:
    from meso_robust.reporting.diagnosis_words import summary

    if asked.as_json:
        print(text, end="")
    elif not asked.quiet:
        print(summary(document))
        for line in warnings:
            print(f"  {line}")
        print(f"report: {asked.out / 'report.html'}")


def _check_out(asked: _Asked) -> None:
    """A folder that can be written to, and not the recordings'."""
    from meso_robust.errors import InputError
    from meso_robust.files import check_folder

    check_folder(asked.out)
    if asked.out.resolve() == asked.recordings.resolve():
        raise InputError(f"--out {asked.out}: is the folder of the recordings; give another folder")
