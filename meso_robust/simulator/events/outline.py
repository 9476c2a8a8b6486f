r"""Outlines of the part and of the fixture, and the distance of a point from them.

A polygon of solid has its corners counter-clockwise; with its corners clockwise the solid is
outside (a playpen). In both cases the outward normal of an edge is its direction turned by −90°.
"""

from collections.abc import Sequence

import numpy as np

from meso_robust.simulator.events.fused import inlined
from meso_robust.types import Flags, Floats

VX, VY, NX, NY, LENGTH, CONVEX, BEFORE, AFTER, TIP = range(9)
"""Columns of the table of edges; see `edge_table`."""

_SAME = 1e-9  # relative difference of squared distances that are those of one corner


def edge_table(polygons: Sequence[Floats]) -> Floats:
    """Tabulate the edges of polygons.

    Parameters
    ----------
    polygons
        Arrays (..., K, 2) of corners, any unit of length; the edge i of a polygon starts at corner
        i. All have the same leading lengths: those of as many scenes.

    Returns
    -------
    ndarray
        (..., F, 9), one row for each edge of each polygon: first corner (2), outward unit normal (2),
        length, 1 if the solid is convex at the first corner, rows of the edges before and after,
        and the number of the first corner among the convex corners (-1 if it is not convex).
    """
    if not polygons:
        return np.zeros((0, 9))
    table = np.ascontiguousarray(np.concatenate([_edges(corners) for corners in polygons], axis=-2))
    first = 0
    for corners in polygons:
        count = corners.shape[-2]
        rows = np.arange(count)
        table[..., first : first + count, BEFORE] = first + (rows - 1) % count
        table[..., first : first + count, AFTER] = first + (rows + 1) % count
        first += count
    convex = table[..., CONVEX] > 0
    table[..., TIP] = np.where(convex, np.cumsum(convex, axis=-1) - 1, -1)
    return table


def _edges(corners: Floats) -> Floats:
    """Tabulate one polygon, without the columns of numbers."""
    edge = np.roll(corners, -1, axis=-2) - corners
    length = np.hypot(edge[..., 0], edge[..., 1])
    before = np.roll(edge, 1, axis=-2)
    table = np.zeros((*length.shape, 9))
    table[..., VX], table[..., VY] = corners[..., 0], corners[..., 1]
    table[..., NX], table[..., NY] = edge[..., 1] / length, -edge[..., 0] / length
    table[..., LENGTH] = length
    table[..., CONVEX] = before[..., 0] * edge[..., 1] - before[..., 1] * edge[..., 0] > 0
    return table


@inlined
def distance(table: Floats, px: float, py: float) -> float:
    """Signed distance of a point from the solid, negative inside.

    The nearest edge gives the sign; of two edges that meet in the nearest corner it is the one
    whose line is farther off.
    """
    best = np.inf
    side = 0.0
    for i in range(table.shape[0]):
        dx, dy = px - table[i, VX], py - table[i, VY]
        s = table[i, NX] * dx + table[i, NY] * dy
        square = _square(table[i, NX] * dy - table[i, NY] * dx, table[i, LENGTH], s)
        if square < best * (1.0 - _SAME):
            best = square
            side = s
        elif square <= best * (1.0 + _SAME):
            best = min(best, square)
            side = s if abs(s) > abs(side) else side
    return np.copysign(np.sqrt(best), side)


@inlined
def distance_without(table: Floats, left_out: Flags, px: float, py: float) -> float:
    """Distance of a point from the nearest edge that is not left out, never negative."""
    best = np.inf
    for i in range(table.shape[0]):
        if not left_out[i]:
            dx, dy = px - table[i, VX], py - table[i, VY]
            s = table[i, NX] * dx + table[i, NY] * dy
            best = min(best, _square(table[i, NX] * dy - table[i, NY] * dx, table[i, LENGTH], s))
    return float(np.sqrt(best))


@inlined
def _square(along: float, length: float, s: float) -> float:
    """Squared distance from an edge of a point `along` it and `s` beside it."""
    if along < 0.0:
        return along * along + s * s
    if along > length:
        return (along - length) * (along - length) + s * s
    return s * s


@inlined
def leave_out(table: Floats, left_out: Flags, edge: int) -> None:
    """Leave out an edge and the neighbours that meet it in a convex corner."""
    left_out[edge] = True
    if table[edge, CONVEX] > 0.0:
        left_out[int(table[edge, BEFORE])] = True
    after = int(table[edge, AFTER])
    if table[after, CONVEX] > 0.0:
        left_out[after] = True
