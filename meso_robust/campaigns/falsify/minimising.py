"""Making a failing run small: as little as possible away from the middle of its range.

Delta debugging (Zeller and Hildebrandt 2002, doi:10.1109/32.988498) by greedy steps in bulk: at the
end no further coordinate can be put to its middle without losing the failure.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from meso_robust.types import Flags, Floats

Breaks = Callable[[Floats], Flags]
"""(N, D) rows to (N,) whether they fail in the same way."""

PARTS = 16  # into which the way to the middle is cut
ROUNDS = 3  # each looks closer at one part: to 1 / PARTS ** ROUNDS of the way


def minimal(row: Floats, middle: Floats, breaks: Breaks) -> Floats:
    """(D,) a row that still fails, with few coordinates off their middle, and those only as needed.

    Parameters
    ----------
    row
        (D,) one that fails.
    middle
        (D,)
    breaks
        Tells which rows fail in the same way.
    """
    found = _fewer(row, middle, breaks)
    # a failure may need the coordinates less once others are nearer
    return _nearer(found, middle, breaks)


def _fewer(row: Floats, middle: Floats, breaks: Breaks) -> Floats:
    while True:
        off = np.flatnonzero(row != middle)
        single = _reset(row, middle, [off[k : k + 1] for k in range(off.size)])
        free = off[breaks(single)] if off.size else off
        if not free.size:
            return row
        # all that can be put to the middle alone, as many as can be together
        together = _reset(row, middle, [free[: k + 1] for k in range(free.size)])
        still = np.flatnonzero(breaks(together))
        if not still.size:  # alone it failed only in the company of other rows of its batch
            return row
        row = together[still[-1]]


def _reset(row: Floats, middle: Floats, sets: list[npt.NDArray[np.int64]]) -> Floats:
    """(S, D) the row with each set of coordinates put to the middle."""
    rows = np.repeat(row[None], len(sets), axis=0)
    for one, which in zip(rows, sets, strict=True):
        one[which] = middle[which]
    return rows


def _nearer(row: Floats, middle: Floats, breaks: Breaks) -> Floats:
    for k in np.flatnonzero(row != middle):
        near, far = middle[k], row[k]
        for _ in range(ROUNDS):
            tried = np.repeat(row[None], PARTS - 1, axis=0)
            tried[:, k] = near + (far - near) * np.arange(1, PARTS) / PARTS
            ends = np.array([near, *tried[:, k], far])
            still = int(np.argmax([*breaks(tried), True]))
            near, far = ends[still], ends[still + 1]
        row = np.where(np.arange(len(row)) == k, far, row)
    return row
