"""Outlines of solids: tables of their edges, and the checks of what a user gives.

An outline is a simple polygon with the solid on the left of its edges: counter-clockwise for a
solid body, clockwise for a solid with a hole that is the free space (a playpen). A corner is convex
where the solid takes less than half the plane; only such a corner can touch something first.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NoReturn

import numpy as np

from meso_robust.types import Floats

EDGE = 9
"""Columns of a table of edges; see `edge_table`."""

_ROUNDED = 0.02  # of the size of the outline: an edge this short belongs to a rounded corner
_FLAT = 1e-9  # of the size of the outline: a corner this flat is no corner


def refuse(argument: str, value: str, rule: str, advice: str) -> NoReturn:
    """Raise a ValueError that names the argument, its value, the rule and what to do."""
    raise ValueError(f"{argument}: {value}; {rule}; {advice}")


def edge_table(vertices: Floats, first: int = 0) -> Floats:
    """Tabulate the edges of an outline.

    Parameters
    ----------
    vertices
        (V, 2) corners in m, the solid on the left of the edges; or (N, V, 2) of N outlines.
    first
        Row of the first edge in the table that this one becomes part of.

    Returns
    -------
    ndarray
        (V, 9) or (N, V, 9) rows ``v_x, v_y, N_x, N_y, b, length, before, after, convex``: first corner, outward
        unit normal, offset ``b = N · v``, length in m, the rows of the edges before and after, and
        whether the first corner is convex.
    """
    if vertices.ndim > 2 and len(vertices) > 1:
        table = _edges_of(vertices, first)
        # as that of one part is, which is kept: for another type the kernels are made again
        table.flags.writeable = False
        return table
    corners = np.ascontiguousarray(vertices, dtype=np.float64).tobytes()
    return _edge_table(corners, first).reshape(*vertices.shape[:-1], EDGE)


@lru_cache(maxsize=256)
def _edge_table(corners: bytes, first: int) -> Floats:
    """Table of corners given as bytes, to be looked up: a single push is as short as making it."""
    table = _edges_of(np.frombuffer(corners).reshape(-1, 2), first)
    table.flags.writeable = False
    return table


def _edges_of(vertices: Floats, first: int) -> Floats:
    """Table of corners (..., V, 2)."""
    edge, last = np.roll(vertices, -1, axis=-2) - vertices, vertices - np.roll(vertices, 1, axis=-2)
    length = np.hypot(edge[..., 0], edge[..., 1])
    normal = np.stack([edge[..., 1], -edge[..., 0]], axis=-1) / length[..., None]
    rows = np.arange(vertices.shape[-2])
    table = np.empty((*length.shape, EDGE))
    table[..., :2], table[..., 2:4], table[..., 5] = vertices, normal, length
    table[..., 4] = np.sum(normal * vertices, axis=-1)
    table[..., 6], table[..., 7] = np.roll(rows, 1) + first, np.roll(rows, -1) + first
    table[..., 8] = last[..., 0] * edge[..., 1] - last[..., 1] * edge[..., 0] > 0.0
    return table


def check_outline(name: str, vertices: Floats) -> None:
    """Refuse corners that do not make a simple polygon.

    Parameters
    ----------
    name
        Argument to name in messages.
    vertices
        (V, 2) corners in m.

    Raises
    ------
    ValueError
        If there are fewer than three corners, a corner is not finite, repeats or lies on the line
        through its neighbours, or if two edges cross.
    """
    if vertices.ndim != 2 or vertices.shape[1] != 2:
        refuse(name, f"shape {vertices.shape}", "must be (V, 2)", "give x and y of each corner")
    if not np.all(np.isfinite(vertices)):
        where = int(np.argwhere(~np.isfinite(vertices))[0, 0])
        refuse(name, f"corner {where} is {vertices[where]}", "must be finite", "correct the value")
    if len(vertices) < 3:
        refuse(name, f"{len(vertices)} corners", "must be at least 3", "give the whole outline")
    advice = "give the corners of a simple outline in order, each once"
    flat = _FLAT * float(np.max(np.ptp(vertices, axis=0)))
    edge = np.roll(vertices, -1, axis=0) - vertices
    length = np.hypot(edge[:, 0], edge[:, 1])
    for corner in np.flatnonzero(length <= flat):
        refuse(name, f"corner {corner} and the next coincide", "must differ", advice)
    last = np.roll(edge, 1, axis=0)
    bend = (last[:, 0] * edge[:, 1] - last[:, 1] * edge[:, 0]) / np.roll(length, 1)
    for corner in np.flatnonzero(np.abs(bend) <= flat):
        value = f"corner {corner} lies on the line through its neighbours"
        refuse(name, value, "must bend the outline", "leave the corner out")
    _check_crossings(name, vertices, edge, advice)


def _check_crossings(name: str, vertices: Floats, edge: Floats, advice: str) -> None:
    count = len(vertices)
    for i in range(count):
        for j in range(i + 2, count if i else count - 1):
            if _meet(vertices[i], edge[i], vertices[j], edge[j]):
                refuse(name, f"edges {i} and {j} meet", "must not touch or cross", advice)


def _meet(a: Floats, u: Floats, b: Floats, v: Floats) -> bool:
    """Whether the segments from a along u and from b along v have a point in common."""

    def side(origin: Floats, way: Floats, point: Floats) -> float:
        d = point - origin
        return float(way[0] * d[1] - way[1] * d[0])

    s1, s2 = side(a, u, b), side(a, u, b + v)
    s3, s4 = side(b, v, a), side(b, v, a + u)
    if s1 == s2 == 0.0:  # on one line: apart unless their spans overlap
        spans = sorted(
            [sorted([0.0, float(u @ u)]), sorted([float(u @ (b - a)), float(u @ (b + v - a))])]
        )
        return spans[1][0] <= spans[0][1]
    return s1 * s2 <= 0.0 and s3 * s4 <= 0.0


def area(vertices: Floats) -> float:
    """Signed area in m², positive for corners in counter-clockwise order."""
    x, y = vertices[:, 0], vertices[:, 1]
    return float(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def check_part(vertices: Floats) -> None:
    """Refuse corners that are not those of a part about its reference point.

    Parameters
    ----------
    vertices
        (V, 2) corners in m, body frame.

    Raises
    ------
    ValueError
        As `check_outline`; also if the corners are in clockwise order or if the origin lies
        outside the convex hull.
    """
    check_outline("vertices", vertices)
    size = area(vertices)
    if size <= 0.0:
        value = f"area {1e12 * size:g} µm²"
        refuse("vertices", value, "must be counter-clockwise", "reverse the order of the corners")
    angle = np.sort(np.arctan2(vertices[:, 1], vertices[:, 0]))
    gap = float(np.max(np.diff(np.append(angle, angle[0] + 2 * np.pi))))
    if gap >= np.pi:
        refuse(
            "vertices",
            f"all corners lie within {np.degrees(2 * np.pi - gap):.4g} deg as seen from the origin",
            "must surround the reference point, the origin of the body frame",
            "subtract the centre of the part from the corners",
        )


def check_parts(outlines: Floats) -> None:
    """Refuse outlines (N, V, 2), m, that are not those of parts of one shape.

    Raises
    ------
    ValueError
        As `check_part` of the first; also if another turns at a corner where the first does not.
    """
    _check_known(np.ascontiguousarray(outlines[0]).tobytes())
    if len(outlines) == 1:
        return
    table = edge_table(outlines)
    differs = (table[..., 8] != table[0, :, 8]) | ~(table[..., 5] > 0.0)
    for run, corner in np.argwhere(differs):
        value = f"corner {corner} of run {run} is not as that of run 0"
        refuse("vertices", value, "must be parts of one shape", "push them separately")


@lru_cache(maxsize=256)
def _check_known(corners: bytes) -> None:
    """As `check_part`; an outline that has passed is not asked again."""
    check_part(np.frombuffer(corners).reshape(-1, 2))


def thickness(vertices: Floats) -> float:
    """Least distance of a corner of an outline from an edge that it does not belong to, m.

    Corners close to each other, such as those of a rounding, count as one.

    Parameters
    ----------
    vertices
        (V, 2) m; kept for outlines that were measured before.

    Returns
    -------
    float
        In m.
    """
    return _thickness(np.ascontiguousarray(vertices, dtype=np.float64).tobytes())


@lru_cache(maxsize=256)
def _thickness(corners: bytes) -> float:
    vertices = np.frombuffer(corners).reshape(-1, 2)
    side = np.linalg.norm(np.roll(vertices, 1, axis=0) - vertices, axis=1)
    long = side > _ROUNDED * float(np.max(np.ptp(vertices, axis=0)))
    vertices = vertices[long] if long.sum() >= 3 else vertices
    least = np.inf
    count = len(vertices)
    for row, edge in enumerate(edge_table(vertices)):
        others = [k for k in range(count) if k not in (row, (row + 1) % count)]
        offset = vertices[others] - edge[:2]
        along = np.clip(edge[2] * offset[:, 1] - edge[3] * offset[:, 0], 0.0, edge[5])
        gap = offset - np.outer(along, [-edge[3], edge[2]])
        least = min(least, float(np.hypot(gap[:, 0], gap[:, 1]).min()))
    return least


def quadrature(vertices: Floats, order: int = 3) -> Floats:
    """Points and weights that integrate over the area of an outline.

    The outline is cut by a grid over its bounding box; each piece is replaced by four points with its
    area, centroid and second moments.

    Parameters
    ----------
    vertices
        (V, 2) corners in m, counter-clockwise.
    order
        Grid cells along the longer side of the bounding box; the shorter side in proportion.

    Returns
    -------
    ndarray
        (Q, 3) x, y in m and weight; the weights add up to one. Read-only: kept for outlines of before.
    """
    return _quadrature(np.ascontiguousarray(vertices, dtype=np.float64).tobytes(), order)


@lru_cache(maxsize=256)
def _quadrature(corners: bytes, order: int) -> Floats:
    vertices = np.frombuffer(corners).reshape(-1, 2)
    low, span = vertices.min(axis=0), np.ptp(vertices, axis=0)
    cells = np.maximum(1, np.rint(order * span / span.max())).astype(int)
    rows = []
    for i in range(cells[0]):
        for j in range(cells[1]):
            corner = low + span * [i / cells[0], j / cells[1]]
            piece = clip_to_box(vertices, corner, corner + span / cells)
            if len(piece) >= 3 and area(piece) > 0.0:
                rows.append(_moments(piece))
    table = np.concatenate(rows)
    table[:, 2] /= table[:, 2].sum()
    table.flags.writeable = False
    return table


def clip_to_box(vertices: Floats, low: Floats, high: Floats) -> Floats:
    """Corners of the part of an outline inside a box (Sutherland-Hodgman)."""
    for axis, bound, sign in ((0, low[0], 1), (0, high[0], -1), (1, low[1], 1), (1, high[1], -1)):
        kept: list[Floats] = []
        for a, b in zip(vertices, np.roll(vertices, -1, axis=0), strict=True):
            in_a, in_b = sign * (a[axis] - bound) >= 0, sign * (b[axis] - bound) >= 0
            if in_a:
                kept.append(a)
            if in_a != in_b:
                kept.append(a + (b - a) * (bound - a[axis]) / (b[axis] - a[axis]))
        vertices = np.array(kept).reshape(-1, 2)
        if len(vertices) < 3:
            break
    return vertices


def _moments(piece: Floats) -> Floats:
    """(2, 3) or (4, 3) points with the area, centroid and second moments of a polygon."""
    x, y = piece[:, 0], piece[:, 1]
    xn, yn = np.roll(x, -1), np.roll(y, -1)
    cross = x * yn - y * xn
    size = 0.5 * cross.sum()
    centre = np.array([((x + xn) * cross).sum(), ((y + yn) * cross).sum()]) / (6.0 * size)
    xx = (cross * (x * x + x * xn + xn * xn)).sum() / (12.0 * size) - centre[0] ** 2
    yy = (cross * (y * y + y * yn + yn * yn)).sum() / (12.0 * size) - centre[1] ** 2
    xy = (cross * (x * yn + 2 * x * y + 2 * xn * yn + xn * y)).sum() / (24.0 * size)
    xy -= centre[0] * centre[1]
    spread, turn = np.linalg.eigh(np.array([[xx, xy], [xy, yy]]))
    way = turn * np.sqrt(np.maximum(spread, 0.0))
    points = centre + np.array([way[:, 0], -way[:, 0], way[:, 1], -way[:, 1]]) * np.sqrt(2.0)
    return np.column_stack([points, np.full(4, size / 4.0)])
