"""Recordings that are the same push twice, and orientations that were not told from their look-alikes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import numpy as np

from meso_robust.recordings.problem import Problem
from meso_robust.recordings.values import Recording

_FEWEST = 5  # equal rows that no chance makes where a camera has noise
_SHARE = 0.5  # of the rows of the shorter one

Row: TypeAlias = tuple[float, ...]


def copy_problems(recordings: Sequence[Recording]) -> list[Problem]:
    """Recordings whose poses and tips are those of one before, to the last digit.

    Rows before the part moves are left out: of a simulation without noise they may well repeat.

    Parameters
    ----------
    recordings
        Of one set, in its order.

    Returns
    -------
    list of Problem
        One for each recording that repeats an earlier one.
    """
    rows = {one.file: _rows(one) for one in recordings}
    found = ((one, _original(one.file, rows)) for one in recordings)
    return [
        Problem(
            file=one.file,
            kind="copy",
            severity="warning",
            value=f"{shared} of {len(rows[one.file])} rows in which the part has moved are those of "
            f"{file}",
            rule="each recording must be of a push of its own: noise never repeats",
            advice="leave one of the two out, or intervals come out too narrow",
        )
        for one, (file, shared) in found
        if file
    ]


def _original(file: str, rows: Mapping[str, frozenset[Row]]) -> tuple[str, int]:
    """The first recording before one that it repeats, if any, and the number of equal rows."""
    for other, theirs in rows.items():
        if other == file:
            break
        shared = len(rows[file] & theirs)
        if shared >= max(_FEWEST, _SHARE * min(len(rows[file]), len(theirs))):
            return other, shared
    return "", 0


def _rows(recording: Recording) -> frozenset[Row]:
    """Poses and tips of the frames in which the part is seen elsewhere than at first."""
    seen = np.flatnonzero(~np.any(np.isnan(recording.poses), axis=1))
    if not seen.size:
        return frozenset()
    poses = recording.poses[seen]
    moved = np.any(poses != poses[0], axis=1)
    tips = np.nan_to_num(recording.probes[seen].reshape(seen.size, -1), nan=np.inf)
    return frozenset(map(tuple, np.hstack((poses, tips))[moved].tolist()))


def alike_problems(recordings: Sequence[Recording]) -> list[Problem]:
    """Recordings whose orientation was chosen among several in which the part looks the same."""
    return [
        Problem(
            file=one.file,
            kind="alike",
            severity="warning",
            value=f"θ is known up to {360.0 / one.alike_orientations:g}°: the part looks the same in "
            f"{one.alike_orientations} orientations, and none was stated",
            rule="θ must be resolved where the part is less symmetric than its outline",
            advice="track again with --start ,,θ, or leave alike_orientations out of set.toml if θ is "
            "right",
        )
        for one in recordings
        if one.alike_orientations > 1
    ]
