"""Unions of boxes of poses: what they cover, decided by comparisons of doubles alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Literal

import numpy as np

from meso_robust.bounds import Interval
from meso_robust.primitives.setup import PoseBox
from meso_robust.types import Flags, Floats

Ends = tuple[Floats, Floats]
"""(N, 3) lower and upper ends of boxes, m and rad."""
Room = tuple[Interval, Interval]
"""A rectangle in x and y, m."""

THIN_ANGLE = 1e-5  # rad: thinner is not worth a cell; proposes only, `covered` has no such limit
SIDES: tuple[Literal["x", "y", "theta"], ...] = ("x", "y", "theta")


def meet(one: PoseBox, other: PoseBox) -> bool:
    """Whether two closed boxes have a pose in common."""
    return all(
        getattr(one, side).lo <= getattr(other, side).hi
        and getattr(other, side).lo <= getattr(one, side).hi
        for side in SIDES
    )


def covered(box: PoseBox, boxes: Sequence[PoseBox]) -> bool:
    """Whether every pose of ``box`` lies in one of ``boxes``.

    What a box leaves over is cut into boxes and looked for in the others. The parts that are left
    keep the faces that were covered already, so the answer errs to False alone.
    """
    near = [other for other in boxes if meet(box, other)]
    if not near:
        return False
    first, *others = near
    return all(covered(part, others) for part in _left_over(box, first))


def _left_over(box: PoseBox, other: PoseBox) -> Iterator[PoseBox]:
    """Boxes that hold everything of ``box`` outside of ``other``, which meets it."""
    for side in SIDES:
        own, cut = getattr(box, side), getattr(other, side)
        if own.lo < cut.lo:
            yield replace(box, **{side: Interval(own.lo, cut.lo)})
        if cut.hi < own.hi:
            yield replace(box, **{side: Interval(cut.hi, own.hi)})
        inside = Interval(max(own.lo, cut.lo), min(own.hi, cut.hi))
        box = replace(box, **{side: inside})


def left_over(box: PoseBox, boxes: Ends, thinnest: float) -> PoseBox | None:
    """About what ``boxes`` leave of ``box``: the hull of the parts, None if there are none.

    Parts thinner than ``thinnest`` (m) or ``THIN_ANGLE`` do not count: this proposes, it does not
    prove.
    """
    low, high = box.ends[:, None]
    met = ((boxes[0] < high) & (low < boxes[1])).all(axis=1)
    lows, highs = boxes[0][met], boxes[1][met]
    shared = np.minimum(highs, high) - np.maximum(lows, low)
    for k in np.argsort(-shared.prod(axis=1)):
        low, high = _cut(low, high, lows[k], highs[k], thinnest)
        if not len(low):
            return None
    (x0, y0, t0), (x1, y1, t1) = low.min(axis=0).tolist(), high.max(axis=0).tolist()
    return PoseBox(x=Interval(x0, x1), y=Interval(y0, y1), theta=Interval(t0, t1))


def ends_of(boxes: Sequence[PoseBox]) -> Ends:
    """Boxes of poses as arrays.

    Parameters
    ----------
    boxes
        World frame.

    Returns
    -------
    tuple
        (N, 3) lower and (N, 3) upper ends, m and rad.
    """
    low, high = np.array([box.ends for box in boxes]).reshape(-1, 2, 3).swapaxes(0, 1)
    return low, high


def _cut(
    low: Floats, high: Floats, cut_low: Floats, cut_high: Floats, thinnest: float
) -> tuple[Floats, Floats]:
    """(M, 3) corners of the parts that one box leaves of N boxes."""
    met = ((low < cut_high) & (cut_low < high)).all(axis=1)
    lows, highs = [low[~met]], [high[~met]]
    low, high = low[met].copy(), high[met].copy()
    for side in range(3):
        below, above = high.copy(), low.copy()
        below[:, side] = np.minimum(cut_low[side], high[:, side])
        above[:, side] = np.maximum(cut_high[side], low[:, side])
        lows += [low.copy(), above]
        highs += [below, high.copy()]
        low[:, side] = np.maximum(low[:, side], cut_low[side])
        high[:, side] = np.minimum(high[:, side], cut_high[side])
    every_low, every_high = np.concatenate(lows), np.concatenate(highs)
    thick = (every_high - every_low > (thinnest, thinnest, THIN_ANGLE)).all(axis=1)
    return every_low[thick], every_high[thick]


def rooms(boxes: Sequence[PoseBox], theta: Interval) -> list[Room]:
    """The largest rectangles whose every position is covered at every orientation in ``theta``.

    A box of positions is covered, at all of ``theta``, exactly when it lies in one of them.
    """
    near = [box for box in boxes if box.theta.lo <= theta.hi and theta.lo <= box.theta.hi]
    if not near:
        return []
    x, y = _ends([box.x for box in near]), _ends([box.y for box in near])
    inner = {end for box in near for end in (box.theta.lo, box.theta.hi) if end in theta}
    slices = list(pairwise(sorted(inner | {theta.lo, theta.hi}))) or [(theta.lo, theta.hi)]
    full = np.ones((len(x) - 1, len(y) - 1), dtype=bool)
    for low, high in slices:
        over = [box for box in near if box.theta.lo <= low and high <= box.theta.hi]
        full &= _painted(over, x, y)
    return [
        (Interval(x[left], x[right]), Interval(y[low], y[high]))
        for left, right, low, high in _largest(full)
    ]


def _ends(sides: Sequence[Interval]) -> list[float]:
    return sorted({end for side in sides for end in (side.lo, side.hi)})


def _painted(boxes: Sequence[PoseBox], x: list[float], y: list[float]) -> Flags:
    """Which elements of the grid of ends the boxes cover."""
    grid = np.zeros((len(x) - 1, len(y) - 1), dtype=bool)
    for box in boxes:
        columns = slice(x.index(box.x.lo), x.index(box.x.hi))
        grid[columns, y.index(box.y.lo) : y.index(box.y.hi)] = True
    return grid


def _largest(full: Flags) -> Iterator[tuple[int, int, int, int]]:
    """Rectangles of True elements that no other one holds: first and past-the-last index twice."""
    wide = len(full)
    for left in range(wide):
        column = full[left].copy()
        for right in range(left + 1, wide + 1):
            column &= full[right - 1]
            if not column.any():
                break
            for low, high in _runs(column):
                grows_left = left > 0 and full[left - 1, low:high].all()
                grows_right = right < wide and full[right, low:high].all()
                if not grows_left and not grows_right:
                    yield left, right, low, high


def _runs(column: Flags) -> list[tuple[int, int]]:
    """First and past-the-last index of each run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], column.astype(np.int8), [0]])))
    return [(int(low), int(high)) for low, high in zip(edges[::2], edges[1::2], strict=True)]
