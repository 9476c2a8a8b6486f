"""A recording set from its folder, with a list of what could not be read instead of a refusal."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from meso_robust.errors import InputError
from meso_robust.recordings.document import SET_FILE, load_document
from meso_robust.recordings.problem import Problem
from meso_robust.recordings.reading import assembled, stated
from meso_robust.recordings.table import Fault, Table, read_readable
from meso_robust.recordings.values import RecordingSet

Lines = Mapping[str, tuple[int, ...]]
"""File name to the line of the file that each row of the recording stands on."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Loose:
    """What could be read of a set, the lines it stands on, and what could not."""

    recordings: RecordingSet
    lines: Lines
    problems: tuple[Problem, ...]


def read_loosely(folder: Path) -> Loose:
    """Read what can be read of a recording set.

    Parameters
    ----------
    folder
        Folder with ``set.toml``, which must be in order, and the CSV files named there.

    Returns
    -------
    Loose
        Recordings of which nothing can be read are left out and listed; so are rows and cells, as
        for `read_readable`.

    Raises
    ------
    InputError
        ``set.toml`` cannot be read or breaks a rule, or no recording can be read.
    """
    document = load_document(folder / SET_FILE)
    tables: list[Table] = []
    problems: list[Problem] = []
    for section in document.recording:
        try:
            table = read_readable(folder / section.file, section.probes)
        except InputError as error:
            problems.append(_unreadable(section.file, error, folder))
            continue
        tables.append(replace(table, recording=stated(table.recording, section)))
        problems += [_fault(section.file, fault) for fault in table.faults]
    if not tables:
        raise InputError(
            f"{folder}: no recording can be read; the first problem: {problems[0].value}"
        )
    return Loose(
        recordings=assembled(document, folder, [table.recording for table in tables]),
        lines={table.recording.file: table.lines for table in tables},
        problems=tuple(problems),
    )


def _unreadable(file: str, error: InputError, folder: Path) -> Problem:
    return Problem(
        file=file,
        kind="unreadable",
        severity="error",
        value=str(error).removeprefix(f"{folder / file}").lstrip(":, "),
        rule="every recording of the set must be a file in its format",
        advice="correct the file or leave the recording out of set.toml",
    )


def _fault(file: str, fault: Fault) -> Problem:
    return Problem(
        file=file,
        kind=fault.kind,
        severity="error",
        rows=(fault.line,),
        value=fault.value,
        rule=fault.rule,
        advice=fault.advice,
    )
