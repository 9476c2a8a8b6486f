"""From a path to a checked set: read or import, list the problems, repair, list what is left."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from meso_robust.errors import InputError
from meso_robust.recordings.direct.clocks import Stream
from meso_robust.recordings.direct.run import direct_tests
from meso_robust.recordings.direct.stated import misstated
from meso_robust.recordings.document import SET_FILE
from meso_robust.recordings.importers import FORMATS
from meso_robust.recordings.loose import Lines, read_loosely
from meso_robust.recordings.outline import Polygon, Rectangle
from meso_robust.recordings.problem import Problem
from meso_robust.recordings.problems import problems
from meso_robust.recordings.repair import Repair, repairable, repaired
from meso_robust.recordings.summary import Checked
from meso_robust.recordings.usable import usable
from meso_robust.recordings.values import RecordingSet

OWN = "set"
"""Name of the project's own format."""
_PASSES = 5


def checked(
    path: Path, format_name: str | None, repair: bool, outline: Rectangle | Polygon | None = None
) -> Checked:
    """Read a set, check it, and repair it if asked for.

    Parameters
    ----------
    path
        Folder of a set, its ``set.toml``, or a file or folder that an importer knows.
    format_name
        ``set`` or the name of an importer; found out if None.
    repair
        Whether to repair.
    outline
        Of the part, for recordings in a format that does not say it.

    Returns
    -------
    Checked
        The set, its problems, and what was repaired.

    Raises
    ------
    InputError
        Nothing can be read, the format is unknown, or the repair would leave nothing.
    """
    name = _recognised(path) if format_name is None else format_name
    if name == OWN and outline is not None:
        raise InputError(f"--outline: {path} states its part in {SET_FILE}; change it there")
    read = _own(path) if name == OWN else _imported(path, name, outline)
    found = (*read.problems, *problems(read.recordings, read.lines))
    recordings, lines, left = read.recordings, read.lines, found
    repairs: tuple[Repair, ...] = ()
    if repair:
        recordings, repairs, left = _repaired(read, found)
        lines = None
    fit = usable(recordings, left, lines)
    direct = direct_tests(fit.recordings, read.streams)
    wrong = misstated(fit.recordings, direct)
    return Checked(
        source=str(path),
        format=name,
        recordings=recordings,
        found=(*found, *wrong),
        repairs=repairs,
        remaining=(*left, *wrong),
        lines=lines,
        notes=read.notes,
        barring=fit.barring,
        left_out=fit.left_out,
        direct=direct,
    )


def _repaired(
    read: _Read, found: tuple[Problem, ...]
) -> tuple[RecordingSet, tuple[Repair, ...], tuple[Problem, ...]]:
    """The set, what was done, and the problems that are left."""
    mended, repairs = repaired(read.recordings, found, read.lines)
    left = problems(mended)
    for _ in range(_PASSES):  # the noise of what is left may bring out more
        if not any(map(repairable, left)):
            break
        rows = {one.file: read.lines[one.file] for one in mended.recordings} if read.lines else None
        mended, more = repaired(mended, problems(mended, rows), rows)
        repairs, left = (*repairs, *more), problems(mended)
    return mended, repairs, left


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Read:
    recordings: RecordingSet
    lines: Lines | None
    problems: tuple[Problem, ...]
    notes: tuple[str, ...]
    streams: tuple[Stream, ...] = ()


def _recognised(path: Path) -> str:
    if not path.exists():
        raise InputError(f"{path}: does not exist; give the folder of a recording set")
    if path.name == SET_FILE or (path / SET_FILE).exists():
        return OWN
    for name, importer in FORMATS.items():
        if importer.recognises(path):
            return name
    raise InputError(
        f"{path}: no {SET_FILE} in it and no known format; must be a recording set or one of "
        f"{', '.join(FORMATS)}; name it with --format"
    )


def _own(path: Path) -> _Read:
    read = read_loosely(path.parent if path.name == SET_FILE else path)
    return _Read(recordings=read.recordings, lines=read.lines, problems=read.problems, notes=())


def _imported(path: Path, name: str, outline: Rectangle | Polygon | None) -> _Read:
    if name not in FORMATS:
        known = ", ".join([OWN, *FORMATS])
        raise InputError(
            f"--format {name}: must be one of {known}; leave it out to detect the format"
        )
    importer = FORMATS[name]
    read = importer.read(path, outline)
    notes = (importer.note, *map(str, read.left))
    return _Read(
        recordings=read.recordings, lines=None, problems=(), notes=notes, streams=read.streams
    )
