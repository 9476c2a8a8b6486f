"""Single-point pushes of a triangle on known support points, one text file many pushes.

The format of J. Zhou, R. Paolini, J. A. Bagnell, M. T. Mason, "A convex polynomial force-motion model
for planar sliding: Identification and application", ICRA 2016,
https://doi.org/10.1109/ICRA.2016.7487155: the number of pushes; for each push the pose of the object
before and after, then the force and the tool pose over time; mm, N, s, quaternions w x y z.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from meso_robust.errors import InputError
from meso_robust.recordings.importers.files import candidates, files_of, one_kind, text_of
from meso_robust.recordings.importers.imported import Imported, Importer, Left, Outline
from meso_robust.recordings.importers.streams import forward, sampled
from meso_robust.recordings.outline import Polygon
from meso_robust.recordings.values import Recording, RecordingSet, SensorInfo
from meso_robust.types import Floats

_LEG = 0.150
CENTRE = np.array([_LEG / 3, _LEG / 3])
"""Centre of area (and of mass) from the corner at the right angle, m; origin of the outline."""
PART = Polygon(corners=np.array([[0.0, 0.0], [_LEG, 0.0], [0.0, _LEG]]) - CENTRE)
TIP_RADIUS = 1.0e-3
FRAME_RATE = 33.0
HOLE = 0.1
"""Longest time between two samples of the force, in s, across which is interpolated."""
TURNED = 1439251200.0
"""Unix time (11 August 2015) from which the sensor sat turned by 45° in the tool."""

_MM = 1e-3
_NUMBER = r"\d+(?:\.\d+)?"
_FOLDER = re.compile(rf"(?:wood_)?(?:patch|{_NUMBER}(?:_{_NUMBER}){{5}})")
_TURN = math.sqrt(0.5) * np.array([[-1.0, -1.0], [-1.0, 1.0]])
_MIRROR = np.diag([1.0, -1.0])

NOTE = (
    "One recording a push. The instants are those of the tool; only two poses of the object are "
    "known, put at the first and the last instant. The force is interpolated onto them, between "
    f"samples of its own at most {HOLE} s apart; its first sample is its offset and taken off. It "
    "is the force on the part in the world frame: the sensor's y axis is mirrored, and from "
    "11 August 2015 it sat turned by 45° with its sign changed (so the forces push into the part; "
    "earlier logs need no turn). Origin of the outline is the centre of area, 50 mm from both "
    "legs. The tip's radius is taken as 1 mm. A push whose stamps stand in a file before is a copy "
    "and left out; if a file ends early, its complete pushes are read."
)


@dataclass(frozen=True, slots=True)
class _Push:
    """A push as stored in the file: mm, N, Unix time."""

    number: int
    poses: Floats  # (2, 7): before and after
    forces: Floats  # (n, 3): t fx fy
    tool: Floats  # (m, 8): t x y z qw qx qy qz


def recognises(path: Path) -> bool:
    """Whether a file stands in, or a folder is, a folder named after support points."""
    return any(_is_mine(file) for file in candidates(path))


def support_points(folder: str) -> Floats | None:
    """(3, 2) support points in m about the centre of area, as the folder's name gives them.

    The name is x1_x2_x3_y1_y2_y3 in mm from the corner. (Read as pairs, 30_90_30_30_30_90 would have
    one point twice, and no triangle to stand on.) None for ``patch``, where the whole face bears.
    """
    numbers = [float(number) for number in re.findall(_NUMBER, folder)]
    return np.reshape(numbers, (2, 3)).T * _MM - CENTRE if len(numbers) == 6 else None


def read(path: Path, outline: Outline | None = None) -> Imported:
    """Read one log or a folder of logs of one arrangement of supports.

    Raises
    ------
    InputError
        An outline is given (all logs are of one triangle), no such file, a file that breaks the format, or no complete push at all.
    """
    if outline is not None:
        raise InputError(
            f"{path}: all logs of this format are of one triangle, whose outline is known; leave "
            "--outline out"
        )
    files = files_of(path, _is_mine, "30_90_30_30_30_90/exp….txt.gz")
    one_kind(path, [file.resolve().parent.name for file in files], "supports")
    left: list[Left] = []
    recordings: list[Recording] = []
    seen: set[float] = set()
    for file in files:
        pushes, missing = _pushes(file)
        copies = tuple(push.number for push in pushes if push.tool[0, 0] in seen)
        new = [push for push in pushes if push.tool[0, 0] not in seen]
        seen.update(push.tool[0, 0] for push in new)
        made = [_recording(file, push) for push in new]
        recordings += [recording for recording, _ in made]
        left += [entry for _, entries in made for entry in entries]
        left += [missing] if missing else []
        if copies:
            reason = "stands in a file before: a copy"
            left.append(Left(file=file.name, place="push", rows=copies, reason=reason))
    if not recordings:
        raise InputError(f"{path}: no complete push; must have one; download the files again")
    return Imported(
        recordings=RecordingSet(
            part=PART,
            tip_radius=TIP_RADIUS,
            position_source="controller",
            sensor=SensorInfo(frame_rate=FRAME_RATE),
            recordings=tuple(recordings),
        ),
        left=tuple(left),
    )


def _is_mine(file: Path) -> bool:
    named = _FOLDER.fullmatch(file.resolve().parent.name)
    return named is not None and file.name.endswith((".txt", ".txt.gz"))


def _recording(file: Path, push: _Push) -> tuple[Recording, list[Left]]:
    name = f"{file.name.removesuffix('.gz').removesuffix('.txt')}_push{push.number:02d}.csv"
    ahead, ahead_force = forward(push.tool[:, 0]), forward(push.forces[:, 0])
    tool, forces = push.tool[ahead], push.forces[ahead_force]
    poses = np.full((len(tool), 3), np.nan)
    poses[[0, -1]] = [_pose(pose) for pose in push.poses]
    sensed = sampled(tool[:, 0], forces[:, 0], forces[:, 1:] - forces[0, 1:], HOLE)
    recording = Recording(
        file=name,
        probe_names=("tip",),
        times=tool[:, 0] - tool[0, 0],
        poses=poses,
        probes=tool[:, None, 1:3] * _MM,
        forces=_in_world(sensed, _yaw(tool[:, 4:]), tool[0, 0] >= TURNED)[:, None],
    )
    wrong = {"tool": ~ahead, "force": ~ahead_force}
    return recording, [
        Left(
            file=file.name,
            place=f"push {push.number}, {stream}",
            rows=tuple(int(row) for row in np.flatnonzero(rows)),
            reason="its stamp is not after those before it",
        )
        for stream, rows in wrong.items()
        if np.any(rows)
    ]


def _in_world(sensed: Floats, yaw: Floats, turned: bool) -> Floats:
    """(T, 2) forces on the part in the world frame from (T, 2) in the sensor's."""
    in_tool = sensed @ (_TURN if turned else _MIRROR).T
    cos, sin = np.cos(yaw), np.sin(yaw)
    x, y = in_tool.T
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)


def _pose(pose: Floats) -> Floats:
    """(3,) x, y of the centre of area in m and θ from a pose of the corner in mm and quaternion."""
    theta = float(_yaw(pose[None, 3:])[0])
    cos, sin = math.cos(theta), math.sin(theta)
    x, y = pose[:2] * _MM + np.array([[cos, -sin], [sin, cos]]) @ CENTRE
    return np.array([x, y, theta])


def _yaw(quaternions: Floats) -> Floats:
    """(T,) rotation about z of (T, 4) quaternions w x y z."""
    w, x, y, z = quaternions.T
    yaw: Floats = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return yaw


def _pushes(file: Path) -> tuple[list[_Push], Left | None]:
    """Complete pushes of a file, and what is missing at its end."""
    lines = text_of(file).split("\n")
    while lines and not lines[-1].strip():
        lines.pop()
    at = 1 if lines and len(lines[0].split()) == 1 else 0
    stated = _count(file, lines, 0) if at else None
    pushes: list[_Push] = []
    while at < len(lines):
        push, end = _one(file, lines, at, len(pushes))
        if push is None:
            reason = f"the file ends within push {len(pushes)}, which is left out"
            rows = tuple(range(at + 1, len(lines) + 1))
            return pushes, Left(file=file.name, place="line", rows=rows, reason=reason)
        pushes.append(push)
        at = end
    if stated is not None and stated != len(pushes):
        reason = f"states {stated} pushes and holds {len(pushes)}"
        return pushes, Left(file=file.name, place="line", rows=(1,), reason=reason)
    return pushes, None


def _one(file: Path, lines: Sequence[str], at: int, number: int) -> tuple[_Push | None, int]:
    """The push that begins at a line, and the line after it; None if the file ends before it."""
    after_poses = at + 2
    if after_poses >= len(lines):
        return None, at
    after_force = after_poses + 1 + _count(file, lines, after_poses)
    if after_force >= len(lines):
        return None, at
    end = after_force + 1 + _count(file, lines, after_force, least=2)  # one for each pose
    if end > len(lines):
        return None, at
    push = _Push(
        number,
        _table(file, lines, at, after_poses, 7),
        _table(file, lines, after_poses + 1, after_force, 3),
        _table(file, lines, after_force + 1, end, 8),
    )
    return push, end


def _count(file: Path, lines: Sequence[str], at: int, least: int = 1) -> int:
    if not lines[at].strip().isascii() or not lines[at].strip().isdecimal():
        raise _wrong(file, lines, at, "a number of lines or pushes")
    count = int(lines[at])
    if not least <= count <= 10**6:
        raise _wrong(file, lines, at, f"a number from {least} to 1000000")
    return count


def _table(file: Path, lines: Sequence[str], start: int, end: int, columns: int) -> Floats:
    rows = []
    for at in range(start, end):
        try:
            row = [float(cell) for cell in lines[at].split()]
        except ValueError:
            row = []
        if len(row) != columns or not all(map(math.isfinite, row)):
            raise _wrong(file, lines, at, f"{columns} finite numbers")
        rows.append(row)
    return np.array(rows)


def _wrong(file: Path, lines: Sequence[str], at: int, rule: str) -> InputError:
    return InputError(
        f"{file}, line {at + 1}: {lines[at][:60]!r}; must be {rule}; download the file again"
    )


IMPORTER = Importer(note=NOTE, recognises=recognises, reader=read)
