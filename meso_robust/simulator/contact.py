"""Which features of the part and of an obstacle face each other, with gap, normal and point.

An obstacle is a point, a disc or a polygon: a probe's tip, or a wall of the fixture. Corners of
the obstacle are held against the edges and corners of the part, and corners of the part against the
edges of the obstacle; two edges that face each other give the two contacts at the ends of their
overlap. All is local: a corner matters only to the two edges beside it, so that neither solid need
be convex.

A point beside an edge, ``0 ≤ along ≤ length``, has the gap ``s = N · c − b``. Beyond the end of an
edge at a re-entrant corner the line of the edge runs into the solid and still holds the point off.
Beyond the ends of both edges at a convex corner the corner is nearest. A step needs one half-plane
for each contact. The one across the line from corner to point would stop a point that only grazes
past, so where the point can reach the corner within the step it is held off by the edge whose line
it crosses last, as in ray casting; of two corners, the edges of both are candidates, each if the
other solid lies wholly on its far side (the separating axes of two wedges).
"""

import numpy as np

from meso_robust.kernels import sealed
from meso_robust.simulator.tables import CONTACTS, MARKS
from meso_robust.types import Floats, Ints

_PARALLEL = (
    0.1  # rad, above the largest turn of a step: edges this close may lie on each other after it
)
_GRAZE = 0.05  # of a step: a point this deep behind an edge, or that will be, slides along it
AT_CORNER = 1_000_000
"""Added to the feature of a contact at a corner of the part."""
PER_CORNER = 2_000_000
"""Step of features from one corner of a polygonal obstacle to the next."""


@sealed
def _add(
    raw: Floats,
    keys: Ints,
    count: int,
    gap: float,
    nx: float,
    ny: float,
    px: float,
    py: float,
    key: int,
) -> int:
    """Append a contact; one too many is counted but not written."""
    if count < raw.shape[0]:
        raw[count, CONTACTS.gap], raw[count, CONTACTS.nx], raw[count, CONTACTS.ny] = gap, nx, ny
        raw[count, CONTACTS.px], raw[count, CONTACTS.py] = px, py
        keys[count, MARKS.feature] = key
    return count + 1


@sealed
def beside_edges(
    edges: Floats,
    rows: tuple[int, int],
    point: tuple[float, float],
    radius: float,
    wedge: tuple[float, float, float, float],
    bounds: tuple[float, float],
    raw: Floats,
    keys: Ints,
    count: int,
) -> int:
    """Contacts of a disc with the edges of an outline.

    Parameters
    ----------
    edges
        (E, 9) table of `edge_table`.
    rows
        First and last (exclusive) row of the outline.
    point
        Centre of the disc in m, frame of the outline.
    radius
        Radius in m, zero for a point.
    wedge
        Outward normals of the edges before and after, if the point is a corner of a polygon, in the
        frame of the outline; zeros for a disc. A corner faces an edge only if its solid lies wholly
        on the far side.
    bounds
        Reach, the largest gap that matters, and depth, the deepest penetration, in m.
    raw, keys
        Tables of contacts and marks; receive gap, normal outward from the outline, the point of the
        outline, and the feature.
    count
        Contacts there so far.

    Returns
    -------
    int
        The new count.
    """
    cx, cy = point
    reach, depth = bounds
    for i in range(rows[0], rows[1]):
        s = edges[i, 2] * cx + edges[i, 3] * cy - edges[i, 4]
        if not -depth <= s <= reach + radius or not _clears(edges[i, 2], edges[i, 3], wedge):
            continue
        along = edges[i, 2] * (cy - edges[i, 1]) - edges[i, 3] * (cx - edges[i, 0])
        before, after = int(edges[i, 6]), int(edges[i, 7])
        if along < 0.0 or along > edges[i, 5]:
            end = i if along < 0.0 else after
            over = -along if along < 0.0 else along - edges[i, 5]
            # At a re-entrant corner the free space is the wedge between both lines.
            if edges[end, 8] > 0.0 or over > reach:
                continue
        elif s < 0.0 and (
            _shallower(edges, before, edges[i, 8], s, cx, cy)
            or _shallower(edges, after, edges[after, 8], s, cx, cy)
        ):
            continue
        nx, ny = edges[i, 2], edges[i, 3]
        count = _add(raw, keys, count, s - radius, nx, ny, cx - s * nx, cy - s * ny, i)
    return count


@sealed
def _shallower(edges: Floats, i: int, convex: float, s: float, cx: float, cy: float) -> bool:
    """Whether the neighbour across a convex corner is the nearer way out."""
    return convex > 0.0 and edges[i, 2] * cx + edges[i, 3] * cy - edges[i, 4] > s


@sealed
def lies_beyond(edges: Floats, i: int, cx: float, cy: float) -> bool:
    """Whether a point lies beyond the ends of both edges at the first corner of edge i, if convex."""
    if edges[i, 8] <= 0.0:
        return False
    b = int(edges[i, 6])
    dx, dy = cx - edges[i, 0], cy - edges[i, 1]
    return bool(edges[i, 2] * dy - edges[i, 3] * dx < 0.0 < edges[b, 2] * dy - edges[b, 3] * dx)


@sealed
def at_corner(
    edges: Floats,
    corner: int,
    disc: tuple[float, float, float],
    step: tuple[float, float, float],
    wedge: tuple[float, float, float, float],
    raw: Floats,
    keys: Ints,
    count: int,
    reach: float,
) -> int:
    """Contact of a disc or of the corner of an obstacle with a convex corner of an outline.

    Parameters
    ----------
    edges
        (E, 9) table of `edge_table`.
    corner
        Row of the edge that starts at the corner.
    disc
        Centre x, y and radius in m, frame of the outline.
    step
        Displacement of the centre relative to the corner that is expected of this step, and the
        largest that is possible, m.
    wedge
        Outward normals of the obstacle's edges before and after its corner, in the frame of the
        outline; zeros for a point or disc.
    raw, keys, count, reach
        As in `beside_edges`.

    Returns
    -------
    int
        The new count.
    """
    cx, cy, radius = disc
    vx, vy = edges[corner, 0], edges[corner, 1]
    gx, gy = cx - vx, cy - vy
    square = gx * gx + gy * gy
    if square > (reach + radius) ** 2:
        return count
    key = AT_CORNER + corner
    if step[2] * step[2] >= square:
        s, nx, ny = _last_crossed(edges, corner, gx, gy, step, wedge)
        if nx * nx + ny * ny > 0.0:
            return _add(raw, keys, count, s - radius, nx, ny, vx, vy, key)
    distance = np.sqrt(square)
    if distance == 0.0:
        return count
    gx, gy = gx / distance, gy / distance
    return _add(raw, keys, count, distance - radius, gx, gy, vx, vy, key)


@sealed
def _last_crossed(
    edges: Floats,
    corner: int,
    gx: float,
    gy: float,
    step: tuple[float, float, float],
    wedge: tuple[float, float, float, float],
) -> tuple[float, float, float]:
    """Gap and normal of the separating edge that is crossed last, or never; no normal if none."""
    graze = _GRAZE * step[2]
    best, nx, ny = 0.0, 0.0, 0.0
    latest = -np.inf
    before = int(edges[corner, 6])
    bx, by, fx, fy = wedge
    for side in range(4):
        if side < 2:
            row = before if side == 0 else corner
            ax, ay = edges[row, 2], edges[row, 3]
            valid = _clears(ax, ay, wedge)
        else:
            ax, ay = (-bx, -by) if side == 2 else (-fx, -fy)
            own = (edges[before, 2], edges[before, 3], edges[corner, 2], edges[corner, 3])
            valid = ax * ax + ay * ay > 0.0 and _clears(-ax, -ay, own)
        s = ax * gx + ay * gy
        if not valid or s < -graze:
            continue
        closing = -(ax * step[0] + ay * step[1])
        # An edge that is never crossed ranks above all crossings, and among such edges the one
        # that the point is farther out of; an edge that the point is behind cannot hold it off.
        # One that it slides along is not crossed by what rounding and linear steps leave.
        time = max(s, 0.0) / closing if closing > s + graze else 2.0 + s
        if time > latest:
            latest, best, nx, ny = time, s, ax, ay
    return best, nx, ny


@sealed
def _clears(ax: float, ay: float, wedge: tuple[float, float, float, float]) -> bool:
    """Whether a wedge with normals b (before) and f (after) lies on the far side of normal a.

    The edges leave its corner along ``(−f_y, f_x)`` and ``(b_y, −b_x)``.
    """
    bx, by, fx, fy = wedge
    return -ax * fy + ay * fx >= -_PARALLEL and ax * by - ay * bx >= -_PARALLEL
