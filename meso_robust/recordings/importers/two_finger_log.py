"""Pushes by two round fingers side by side, one CSV file without header a run of pushes.

The format of the execution logs of J. Zhou and M. T. Mason, "Pushing Revisited: Differential
Flatness, Trajectory Planning and Stabilization", ISRR 2017: time, pose of the object, pose of the
pusher, number of the push action; s, mm, rad.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

import numpy as np

from meso_robust.errors import InputError
from meso_robust.recordings.importers.files import candidates, files_of, one_kind, text_of
from meso_robust.recordings.importers.imported import Imported, Importer, Left, Outline
from meso_robust.recordings.importers.streams import forward
from meso_robust.recordings.outline import Polygon, Rectangle
from meso_robust.recordings.values import Recording, RecordingSet, SensorInfo
from meso_robust.types import Flags, Floats, Indices

_LONG, _SHORT = 58.0e-3, 27.5e-3  # legs of the right-angled triangle
_BLOCK = Rectangle(length=0.050, width=0.035)
PARTS: Mapping[str, Rectangle | Polygon] = MappingProxyType(
    {
        "bigrect_3pts": _BLOCK,
        "bigrect_ridge": _BLOCK,
        "tri": Polygon(
            corners=np.array(
                [
                    [-2 * _LONG / 3, -_SHORT / 3],
                    [_LONG / 3, -_SHORT / 3],
                    [_LONG / 3, 2 * _SHORT / 3],
                ]
            )
        ),
    }
)
"""Outlines about the centre of area, by the beginning of the folder's name."""
TIP_RADIUS = 2.5e-3
SPACING = 24.0e-3
"""Distance of the fingers' centres in m."""
FRAME_RATE = 30.0
HOLE = 0.5
"""Longest time between two rows of one push in s; the robot needs more to take a new place."""
PROBES = ("left", "right")
"""The fingers, as seen along the pusher's θ."""

_MM = 1e-3
_COLUMNS = 8

NOTE = (
    "One recording a push: a log is split where more than "
    f"{HOLE} s pass between two rows, the robot then takes a new place. The first row of a log is "
    "left out: its pose can be that of the run before. An all-zero pose means that the camera did "
    "not find the object; it is left empty. A pose that repeats the one before to the last digit "
    "stays as it is. The pusher's pose is the middle of two round fingers, radius 2.5 mm, 24 mm "
    "apart on a line at right angles to its θ (at θ itself they would stand inside the part). "
    "Stamps are printed to 10 ms; the camera's delay is not corrected. Outlines are about the "
    "centre of area; the camera's reference point can lie a millimetre or two off it."
)


def recognises(path: Path) -> bool:
    """Whether the first line of a file, or of one in a folder, has eight numbers and a Unix time."""
    return any(_is_mine(file) for file in candidates(path))


def read(path: Path, outline: Outline | None = None) -> Imported:
    """Read one log or a folder of logs of one part.

    Parameters
    ----------
    path
        File or folder.
    outline
        Of the part about the reference point of the poses, where the folder's name does not tell it
        or tells it wrongly.

    Raises
    ------
    InputError
        No such file, an unknown part without an outline, or a file that breaks the format.
    """
    files = files_of(path, _is_mine, "log….txt")
    part = outline or PARTS[one_kind(path, [_shape(file) for file in files], "parts")]
    logs = [_log(file) for file in files]
    return Imported(
        recordings=RecordingSet(
            part=part,
            tip_radius=TIP_RADIUS,
            position_source="controller",
            sensor=SensorInfo(frame_rate=FRAME_RATE),
            recordings=tuple(push for pushes, _ in logs for push in pushes),
        ),
        left=tuple(left for _, lefts in logs for left in lefts),
    )


def _is_mine(file: Path) -> bool:
    if file.suffix not in {".txt", ".csv"}:
        return False
    try:
        with file.open(encoding="utf-8") as lines:
            row = _numbers(lines.readline(4096))
    except (OSError, UnicodeDecodeError):
        return False
    return row is not None and len(row) == _COLUMNS and row[0] > 1e9


def _shape(file: Path) -> str:
    folder = file.resolve().parent.name
    for shape in PARTS:
        if folder.startswith(f"{shape}_") or folder == shape:
            return shape
    raise InputError(
        f"{file}: folder {folder}; must begin with one of {', '.join(PARTS)}, whose outline is "
        "known; give the part's with --outline"
    )


def _log(file: Path) -> tuple[list[Recording], list[Left]]:
    rows = _rows(file)
    ahead = forward(rows[:, 0])
    first = np.arange(len(rows)) == 0
    lost = np.all(rows[:, 1:4] == 0.0, axis=1)
    kept = ahead & ~first
    if not np.any(kept):
        raise InputError(f"{file}: one row; must have more, the first is not used; leave it out")
    left = [
        _left(file, first, "the pose can be that of the run before"),
        _left(file, ~ahead, "its stamp is not after those before it"),
        _left(file, kept & lost, "the camera did not find the object; its pose is left empty"),
    ]
    poses = np.where(lost[:, None], np.nan, rows[:, 1:4] * (_MM, _MM, 1.0))
    pushes = np.split(np.flatnonzero(kept), _ends(rows[kept, 0]))
    recordings = [
        Recording(
            file=f"{file.stem}_push{k + 1}.csv",
            probe_names=PROBES,
            times=rows[push, 0] - rows[push[0], 0],
            poses=poses[push],
            probes=fingers(rows[push, 4:7] * (_MM, _MM, 1.0)),
        )
        for k, push in enumerate(pushes)
    ]
    return recordings, [entry for entry in left if entry.rows]


def fingers(pusher: Floats) -> Floats:
    """(T, 2, 2) centres of the fingers in m from (T, 3) poses of the pusher in m and rad."""
    across = np.stack([-np.sin(pusher[:, 2]), np.cos(pusher[:, 2])], axis=-1)
    sides = np.array([0.5, -0.5])[:, None] * SPACING
    return pusher[:, None, :2] + sides * across[:, None]


def _ends(times: Floats) -> Indices:
    return np.flatnonzero(np.diff(times) > HOLE) + 1


def _left(file: Path, rows: Flags, reason: str) -> Left:
    lines = tuple(int(row) + 1 for row in np.flatnonzero(rows))
    return Left(file=file.name, place="line", rows=lines, reason=reason)


def _rows(file: Path) -> Floats:
    """(T, 8) numbers of a log."""
    rows = []
    for number, line in enumerate(text_of(file).splitlines(), start=1):
        row = _numbers(line)
        if row is None or len(row) != _COLUMNS:
            raise InputError(
                f"{file}, line {number}: {line[:60]!r}; must be eight finite numbers with commas; "
                "correct the line or leave it out"
            )
        rows.append(row)
    return np.array(rows)


def _numbers(line: str) -> Sequence[float] | None:
    try:
        row = [float(cell) for cell in line.split(",")]
    except ValueError:
        return None
    return row if all(map(math.isfinite, row)) else None


IMPORTER = Importer(note=NOTE, recognises=recognises, reader=read)
