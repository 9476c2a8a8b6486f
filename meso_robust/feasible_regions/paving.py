"""Pavings: a rectangle of two choices cut into cells whose verdict is proved.

A cell is CERTIFIED or IMPOSSIBLE only by proof, for all of its points; the rest is UNDECIDED. Only
cells at the border of what is decided are cut further, so the work grows with the length of the
border and not with the area.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import numpy.typing as npt

from meso_robust.bounds import Interval
from meso_robust.copies import shared
from meso_robust.types import Floats, Ints


class Region(IntEnum):
    """What is proved of a cell."""

    UNDECIDED = 0
    """Nothing: the border between the other two, or a gap between what suffices and what breaks."""
    CERTIFIED = 1
    """Every point succeeds for all uncertainties."""
    IMPOSSIBLE = 2
    """At every point some admissible value of the uncertainties breaks the motion."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """One of the two choices."""

    name: str
    """What it is, in words."""
    unit: str
    """``um`` or ``deg``: how it is shown; inside it is in m or rad."""
    low: float
    high: float

    def edges(self, count: int) -> Floats:
        """(count + 1,) ends of equal cells; neighbours share them exactly."""
        return np.linspace(self.low, self.high, count + 1)


Judge = Callable[[Interval, Interval], Region]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Paving:
    """A rectangle, paved."""

    across: Axis
    up: Axis
    count: int
    """The finest cells are 1/count of either side."""
    cells: Ints
    """(N, 4) first and last edge in ``across``, first and last in ``up``; they do not overlap."""
    regions: npt.NDArray[np.int8]
    """(N,) values of ``Region``."""
    judged: int
    """How many cells were judged on the way."""

    def ends(self) -> Floats:
        """(N, 4) low and high ends in ``across``, low and high in ``up``, m or rad, exact doubles."""
        x, y = self.across.edges(self.count), self.up.edges(self.count)
        i = self.cells
        return np.stack([x[i[:, 0]], x[i[:, 1]], y[i[:, 2]], y[i[:, 3]]], axis=1)

    def raster(self) -> npt.NDArray[np.int8]:
        """(count, count) regions of the finest cells, ``across`` first."""
        found = np.zeros((self.count, self.count), dtype=np.int8)
        for (a, b, c, d), region in zip(self.cells, self.regions, strict=True):
            found[a:b, c:d] = region
        return found

    def share(self, region: Region) -> float:
        """Share of the area."""
        return float(np.mean(self.raster() == region))

    def at(self, across: float, up: float) -> set[Region]:
        """Regions of all cells that hold a point; several on a border, none outside."""
        low_x, high_x, low_y, high_y = self.ends().T
        inside = (low_x <= across) & (across <= high_x) & (low_y <= up) & (up <= high_y)
        return {Region(int(code)) for code in self.regions[inside]}


def pave(judge: Judge, across: Axis, up: Axis, *, count: int = 128, coarse: int = 16) -> Paving:
    """Pave a rectangle.

    Parameters
    ----------
    judge
        Decides a closed cell; anything but UNDECIDED must be proved for all of its points.
    across, up
        The sides.
    count, coarse
        Finest and coarsest cells a side; count/coarse is a power of two.

    Raises
    ------
    ValueError
        count is not coarse times a power of two.
    """
    levels = math.log2(count / coarse)
    if levels < 0 or not levels.is_integer():
        raise ValueError(f"count = {count} must be coarse = {coarse} times a power of two")
    x, y = across.edges(count), up.edges(count)
    raster = np.zeros((count, count), dtype=np.int8)
    size = count // coarse
    start = range(0, count, size)
    todo = [(i, j, size) for i in start for j in start]
    open_: list[tuple[int, int, int]] = []
    done: list[tuple[int, int, int, int, int]] = []
    judged = 0

    def column(cells: list[tuple[int, int, int]]) -> list[Region]:
        return [judge(_between(x, i, size), _between(y, j, size)) for i, j, size in cells]

    while todo:
        # a judge may keep what it finds for all cells of a column
        columns = [list(each) for _, each in itertools.groupby(sorted(todo), lambda cell: cell[0])]
        todo = list(itertools.chain.from_iterable(columns))
        regions = itertools.chain.from_iterable(shared(column, columns))
        for (i, j, size), region in zip(todo, regions, strict=True):
            raster[i : i + size, j : j + size] = region
            if region is Region.UNDECIDED:
                open_.append((i, j, size))
            else:
                done.append((i, i + size, j, j + size, region))
        judged += len(todo)
        todo = []
        for i, j, size in open_[:]:
            half = size // 2
            if half and _touches_decided(raster, i, j, size):
                open_.remove((i, j, size))
                todo += [(i + a, j + b, half) for a in (0, half) for b in (0, half)]
    done += [(i, i + size, j, j + size, Region.UNDECIDED) for i, j, size in open_]
    table = np.array(done, dtype=np.int64)
    return Paving(
        across=across,
        up=up,
        count=count,
        cells=table[:, :4],
        regions=table[:, 4].astype(np.int8),
        judged=judged,
    )


def paving_of(raster: npt.NDArray[np.int8], across: Axis, up: Axis, judged: int) -> Paving:
    """A paving of regions that are known.

    Parameters
    ----------
    raster
        (count, count) regions of the finest cells, ``across`` first.
    across, up
        The sides.
    judged
        How many proofs were tried on the way.

    Returns
    -------
    Paving
        Neighbours of one region are joined: upwards, then columns that are alike.
    """
    count = raster.shape[0]
    table: list[tuple[int, int, int, int, int]] = []
    columns = [0, *(k for k in range(1, count) if (raster[k] != raster[k - 1]).any()), count]
    for first, last in itertools.pairwise(columns):
        column = raster[first]
        rows = [0, *(np.flatnonzero(np.diff(column)) + 1).tolist(), count]
        table += [(first, last, a, b, int(column[a])) for a, b in itertools.pairwise(rows)]
    cells = np.array(table, dtype=np.int64)
    return Paving(
        across=across,
        up=up,
        count=count,
        cells=cells[:, :4],
        regions=cells[:, 4].astype(np.int8),
        judged=judged,
    )


def _between(edges: Floats, first: int, size: int) -> Interval:
    return Interval(float(edges[first]), float(edges[first + size]))


def _touches_decided(raster: npt.NDArray[np.int8], i: int, j: int, size: int) -> bool:
    """Whether a cell has a decided neighbour, across a side or a corner."""
    around = raster[max(i - 1, 0) : i + size + 1, max(j - 1, 0) : j + size + 1]
    return bool((around != Region.UNDECIDED).any())


def pave_line(
    judge: Callable[[Interval], Region], low: float, high: float, resolution: float
) -> list[tuple[Interval, Region]]:
    """Pave a line: neighbouring pieces of one region are joined.

    Parameters
    ----------
    judge
        Decides a closed piece, as in :func:`pave`.
    low, high
        The line.
    resolution
        Pieces that stay undecided are cut until they are no longer than this.

    Raises
    ------
    ValueError
        The resolution is not positive, or the line has no length.
    """
    if not (resolution > 0.0 and low < high):
        raise ValueError(
            f"needs resolution > 0 and low < high, got {resolution!r}, {low!r}, {high!r}"
        )
    found: list[tuple[Interval, Region]] = []
    todo = [Interval(low, high)]
    while todo:
        piece = todo.pop()
        region, middle = judge(piece), piece.mid
        if region is Region.UNDECIDED and piece.hi - piece.lo > resolution:
            todo += [Interval(middle, piece.hi), Interval(piece.lo, middle)]
        elif found and found[-1][1] is region:
            found[-1] = (found[-1][0].hull(piece), region)
        else:
            found.append((piece, region))
    return found
