"""All contacts between the part and the obstacles at one instant."""

from typing import NamedTuple

import numpy as np

from meso_robust.kernels import sealed
from meso_robust.simulator.contact import PER_CORNER, at_corner, beside_edges, lies_beyond
from meso_robust.simulator.tables import CONTACTS, MARKS, OBSTACLES, PART
from meso_robust.types import Floats, Ints


class Scene(NamedTuple):
    """Geometry of one run as the kernels see it."""

    part: Floats
    """(V, 9) edges of the part, body frame."""
    edges: Floats
    """(E, 9) edges of all obstacles one after the other, each about its own origin; a point or
    disc has one row, a corner without edges."""
    size: float
    """Largest distance of a corner of the part from its reference point, m."""
    depth: float
    """Deepest penetration that is taken for one, m; what lies deeper is another side of the part."""


@sealed
def find_contacts(
    scene: Scene,
    obstacles: Floats,
    pose: Floats,
    body: Floats,
    reach: float,
    contacts: Floats,
    marks: Ints,
) -> int:
    """Write all contacts within reach.

    Parameters
    ----------
    scene
        Geometry.
    obstacles
        (O, OBSTACLE) table of `tables`.
    pose
        (3,) x, y in m and θ in rad.
    body
        (BODY,) vector of the part.
    reach
        Largest gap that matters, m.
    contacts, marks
        Tables of `tables`; receive gap, normal, point and displacement, obstacle and feature.

    Returns
    -------
    int
        Number of contacts; more than there are rows were not all written.
    """
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    most = contacts.shape[0]
    count = int(np.int64(0))  # of a fixed type, not to compile for a literal
    for k in range(obstacles.shape[0]):
        wx, wy = obstacles[k, OBSTACLES.move_x], obstacles[k, OBSTACLES.move_y]
        dx, dy = (
            body[PART.cos] * wx + body[PART.sin] * wy,
            body[PART.cos] * wy - body[PART.sin] * wx,
        )
        start = count
        if obstacles[k, OBSTACLES.last] - obstacles[k, OBSTACLES.first] == 1.0:
            x, y = obstacles[k, OBSTACLES.x] - pose[0], obstacles[k, OBSTACLES.y] - pose[1]
            far = scene.size + obstacles[k, OBSTACLES.radius] + reach
            if x * x + y * y <= far * far:
                disc = (cos * x + sin * y, cos * y - sin * x, obstacles[k, OBSTACLES.radius])
                wedge = (0.0, 0.0, 0.0, 0.0)
                count = _disc(scene, disc, wedge, dx, dy, body, reach, contacts, marks, count)
        else:
            where = (obstacles[k, OBSTACLES.x], obstacles[k, OBSTACLES.y], cos, sin)
            rows = (int(obstacles[k, OBSTACLES.first]), int(obstacles[k, OBSTACLES.last]))
            count = _corners_of_obstacle(
                scene, rows, where, pose, dx, dy, body, reach, contacts, marks, count
            )
            bounds = (reach, obstacles[k, OBSTACLES.depth])
            count = _corners_of_part(scene, rows, where, pose, bounds, contacts, marks, count)
        for c in range(start, min(count, most)):
            contacts[c, CONTACTS.dx], contacts[c, CONTACTS.dy] = dx, dy
            marks[c, MARKS.who] = k
        if count > most:
            return count
    return count


@sealed
def _disc(
    scene: Scene,
    disc: tuple[float, float, float],
    wedge: tuple[float, float, float, float],
    dx: float,
    dy: float,
    body: Floats,
    reach: float,
    contacts: Floats,
    marks: Ints,
    count: int,
) -> int:
    """Contacts of a disc, or of a corner of an obstacle, with the part."""
    cx, cy, radius = disc
    part = scene.part
    first = int(np.int64(0))  # of a fixed type, not to compile for a literal
    rows, bounds = (first, part.shape[0]), (reach, scene.depth)
    count = beside_edges(part, rows, (cx, cy), radius, wedge, bounds, contacts, marks, count)
    for i in range(rows[1]):
        if lies_beyond(part, i, cx, cy):
            # Relative to the part, if this goes on as in the last step.
            px, py = (
                body[PART.moved] - body[PART.moved + 2] * cy,
                body[PART.moved + 1] + body[PART.moved + 2] * cx,
            )
            most = np.hypot(dx, dy) + np.hypot(px, py)
            step = (dx - px, dy - py, most)
            count = at_corner(part, i, disc, step, wedge, contacts, marks, count, reach)
    return count


@sealed
def _corners_of_obstacle(
    scene: Scene,
    rows: tuple[int, int],
    where: tuple[float, float, float, float],
    pose: Floats,
    dx: float,
    dy: float,
    body: Floats,
    reach: float,
    contacts: Floats,
    marks: Ints,
    count: int,
) -> int:
    """Contacts of the convex corners of a polygonal obstacle with the part."""
    edges = scene.edges
    ox, oy, cos, sin = where
    far = scene.size + reach
    for i in range(rows[0], rows[1]):
        x, y = ox + edges[i, 0] - pose[0], oy + edges[i, 1] - pose[1]
        if edges[i, 8] <= 0.0 or x * x + y * y > far * far:
            continue
        b = int(edges[i, 6])
        wedge = (
            cos * edges[b, 2] + sin * edges[b, 3],
            cos * edges[b, 3] - sin * edges[b, 2],
            cos * edges[i, 2] + sin * edges[i, 3],
            cos * edges[i, 3] - sin * edges[i, 2],
        )
        start = count
        disc = (cos * x + sin * y, cos * y - sin * x, 0.0)
        count = _disc(scene, disc, wedge, dx, dy, body, reach, contacts, marks, count)
        for c in range(start, min(count, contacts.shape[0])):
            marks[c, MARKS.feature] += PER_CORNER * (i + 1)
    return count


@sealed
def _corners_of_part(
    scene: Scene,
    rows: tuple[int, int],
    where: tuple[float, float, float, float],
    pose: Floats,
    bounds: tuple[float, float],
    contacts: Floats,
    marks: Ints,
    count: int,
) -> int:
    """Contacts of the convex corners of the part with the edges of a polygonal obstacle."""
    part = scene.part
    ox, oy, cos, sin = where
    for v in range(part.shape[0]):
        if part[v, 8] <= 0.0:
            continue
        x = pose[0] + cos * part[v, 0] - sin * part[v, 1] - ox
        y = pose[1] + sin * part[v, 0] + cos * part[v, 1] - oy
        b = int(part[v, 6])
        wedge = (
            cos * part[b, 2] - sin * part[b, 3],
            cos * part[b, 3] + sin * part[b, 2],
            cos * part[v, 2] - sin * part[v, 3],
            cos * part[v, 3] + sin * part[v, 2],
        )
        start = count
        count = beside_edges(scene.edges, rows, (x, y), 0.0, wedge, bounds, contacts, marks, count)
        for c in range(start, min(count, contacts.shape[0])):
            nx, ny = contacts[c, CONTACTS.nx], contacts[c, CONTACTS.ny]
            contacts[c, CONTACTS.nx], contacts[c, CONTACTS.ny] = (
                -(cos * nx + sin * ny),
                -(cos * ny - sin * nx),
            )
            contacts[c, CONTACTS.px], contacts[c, CONTACTS.py] = part[v, 0], part[v, 1]
            marks[c, MARKS.feature] = -marks[c, MARKS.feature] - PER_CORNER * (v + 1)
    return count


@sealed
def smallest_gap(contacts: Floats, count: int) -> float:
    """Smallest gap of the first `count` contacts, m; infinite without any."""
    least = np.inf
    for c in range(count):
        least = min(least, contacts[c, CONTACTS.gap])
    return least
