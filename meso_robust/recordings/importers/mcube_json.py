"""Single pushes by a robot arm, one JSON file a push, three streams with a clock each.

The format of K.-T. Yu, M. Bauza, N. Fazeli, A. Rodriguez, "More than a Million Ways to Be Pushed",
IROS 2016, https://doi.org/10.1109/IROS.2016.7758091: ``object_pose`` and ``tip_pose`` as
[t, x, y, θ], ``ft_wrench`` as [t, fx, fy, torque]; s, m, rad, N.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from meso_robust.errors import InputError
from meso_robust.reading import json_values
from meso_robust.recordings.direct.clocks import Stream
from meso_robust.recordings.importers.files import candidates, files_of, one_kind, text_of
from meso_robust.recordings.importers.imported import Imported, Importer, Left, Outline
from meso_robust.recordings.importers.streams import forward, sampled
from meso_robust.recordings.outline import Rectangle
from meso_robust.recordings.values import Recording, RecordingSet, SensorInfo
from meso_robust.types import Flags, Floats

PARTS: Mapping[str, Rectangle] = MappingProxyType({"rect1": Rectangle(length=0.090, width=0.090)})
"""Outlines by the name that the file's name gives."""
TIP_RADIUS = 4.75e-3
FRAME_RATE = 250.0
HOLE = 0.025
"""Longest time between two samples, in s, across which tip and force are interpolated."""
_UNFILLED = 1e-12  # N; a real sensor shows noise far above it

_NAME = re.compile(r"motion_surface=(?P<surface>[^_]+)_shape=(?P<shape>[^_]+)_.*\.json")
_STREAMS = ("object_pose", "tip_pose", "ft_wrench")

NOTE = (
    "One recording a push. The instants are those of the object's stream; tip and force are "
    f"interpolated onto them, between two samples of their own at most {HOLE} s apart, and are "
    "empty elsewhere. The three clocks are taken to agree. Where a stream's stamps run backwards "
    "its rows are left out until they go on. The wrench is that on the pusher, in the world frame: "
    "it is negated to become the force on the part. It is not freed of its offset. The outline is "
    "known from the shape in the file's name, the tip's radius is 4.75 mm; times count from the "
    "first pose of the object."
)


def recognises(path: Path) -> bool:
    """Whether a file, or one in a folder, has a name of this format."""
    return any(_is_mine(file) for file in candidates(path))


def read(path: Path, outline: Outline | None = None) -> Imported:
    """Read one push or a folder of pushes of one part on one surface.

    Parameters
    ----------
    path
        File or folder.
    outline
        Of the part about the reference point of the poses, where the shape's name does not tell it.

    Raises
    ------
    InputError
        No such file, several parts or surfaces, an unknown part without an outline, or a file that breaks the format.
    """
    files = files_of(path, _is_mine, "motion_surface=…_shape=rect1_….json")
    shape = one_kind(path, [_named(file)["shape"] for file in files], "shapes")
    one_kind(path, [_named(file)["surface"] for file in files], "surfaces")
    part = PARTS.get(shape) if outline is None else outline
    if part is None:
        raise InputError(
            f"{files[0]}: shape = {shape}; must be one of {', '.join(PARTS)}, whose outline is "
            "known; give the part's with --outline"
        )
    pushes = [_push(file) for file in files]
    return Imported(
        recordings=RecordingSet(
            part=part,
            tip_radius=TIP_RADIUS,
            position_source="controller",
            sensor=SensorInfo(frame_rate=FRAME_RATE),
            recordings=tuple(recording for recording, _, _ in pushes),
        ),
        left=tuple(left for _, lefts, _ in pushes for left in lefts),
        streams=tuple(stream for _, _, streams in pushes for stream in streams),
    )


def _is_mine(file: Path) -> bool:
    return _NAME.fullmatch(file.name) is not None


def _named(file: Path) -> dict[str, str]:
    match = _NAME.fullmatch(file.name)
    return match.groupdict() if match else {}


def _push(file: Path) -> tuple[Recording, list[Left], list[Stream]]:
    streams = _streams(file)
    ahead = {name: forward(rows[:, 0]) for name, rows in streams.items()}
    started = np.any(np.abs(streams["ft_wrench"][:, 1:]) > _UNFILLED, axis=1)
    left = [
        *(
            _left(file, name, ~ahead[name], "its stamp is not after those before it")
            for name in _STREAMS
        ),
        _left(file, "ft_wrench", ~started, "all zero: the sensor had not begun"),
    ]
    poses = streams["object_pose"][ahead["object_pose"]]
    tip = streams["tip_pose"][ahead["tip_pose"]]
    wrench = streams["ft_wrench"][ahead["ft_wrench"] & started]
    instants = poses[:, 0]
    recording = Recording(
        file=f"{file.stem}.csv",
        probe_names=("tip",),
        times=instants - instants[0],
        poses=poses[:, 1:],
        probes=sampled(instants, tip[:, 0], tip[:, 1:3], HOLE)[:, None],
        forces=-sampled(instants, wrench[:, 0], wrench[:, 1:3], HOLE)[:, None],
    )
    clocks = [
        Stream(file=recording.file, name="part", times=instants, values=poses[:, 1:3]),
        Stream(file=recording.file, name="tip", times=tip[:, 0], values=tip[:, 1:3]),
        Stream(file=recording.file, name="force", times=wrench[:, 0], values=np.zeros((0, 2))),
    ]
    return recording, [entry for entry in left if entry.rows], clocks


def _left(file: Path, name: str, rows: Flags, reason: str) -> Left:
    return Left(
        file=file.name,
        place=name,
        rows=tuple(int(row) for row in np.flatnonzero(rows)),
        reason=reason,
    )


def _streams(file: Path) -> dict[str, Floats]:
    values = json_values(text_of(file), str(file))
    if not isinstance(values, dict):
        raise InputError(f"{file}: must be one JSON object with {', '.join(_STREAMS)}")
    return {name: _stream(file, name, values.get(name)) for name in _STREAMS}


def _stream(file: Path, name: str, rows: Any) -> Floats:
    """(N, 4) of one stream."""
    rule = "must be a list of rows of four finite numbers, at least one row"
    if not isinstance(rows, list) or not rows:
        found = "missing" if rows is None else "no list or empty"
        raise InputError(f"{file}: key {name} is {found}; {rule}; leave the file out")
    for k, row in enumerate(rows):
        if not (isinstance(row, list) and len(row) == 4 and all(map(_is_number, row))):
            shown = repr(row)[:60]
            raise InputError(
                f"{file}: key {name}[{k}] = {shown}; {rule}; correct the row or leave it out"
            )
    return np.array(rows, dtype=np.float64)


def _is_number(value: Any) -> bool:
    plain = isinstance(value, int | float) and not isinstance(value, bool)
    return plain and abs(value) < 1e300  # neither endless, nor NaN, nor too long for a double


IMPORTER = Importer(note=NOTE, recognises=recognises, reader=read)
