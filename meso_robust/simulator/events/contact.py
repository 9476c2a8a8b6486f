r"""Geometry of one contact: normal, point, velocity of the obstacle, and gap.

All in the body frame. The tangent is the normal of the force on the part turned by −90°, which
points along the counter-clockwise edge for a tip on an edge.
"""

from typing import TypeAlias

import numpy as np

from meso_robust.simulator.events.fused import inlined, sealed
from meso_robust.simulator.events.outline import AFTER, BEFORE, CONVEX, LENGTH, NX, NY, TIP, VX, VY
from meso_robust.simulator.events.scene import (
    CORNER,
    EDGE,
    FIRST,
    GROUP,
    KIND,
    MOST,
    POINT,
    SECOND,
    TOUCHING,
    WALL,
    Scene,
    Work,
)

Place: TypeAlias = tuple[float, float, float, float]
"""Pose as (x, y, cos θ, sin θ)."""
Frame: TypeAlias = tuple[float, float, float, float, float, float, float, float]


@inlined
def place_of(work: Work) -> Place:
    """The present pose."""
    return work.pose[0], work.pose[1], np.cos(work.pose[2]), np.sin(work.pose[2])


@inlined
def to_body(x: float, y: float, place: Place) -> tuple[float, float]:
    """Turn a vector from the world into the body frame."""
    return place[2] * x + place[3] * y, place[2] * y - place[3] * x


@inlined
def tip_in_body(scene: Scene, i: int, place: Place, clock: float) -> tuple[float, float]:
    """Centre of a tip in the body frame."""
    x = scene.tips[i, 0] + scene.tips[i, 2] * clock - place[0]
    y = scene.tips[i, 1] + scene.tips[i, 3] * clock - place[1]
    return to_body(x, y, place)


@inlined
def frame(scene: Scene, kind: int, i: int, j: int, place: Place, clock: float) -> Frame:
    """Geometry of a contact.

    Returns the direction of the normal force on the part, the point of contact, the velocity of
    the obstacle, and two lengths that are positive while the point is within its edge, or the
    normal between those of the edges at its corner.
    """
    if kind == WALL:
        return _wall_frame(scene, i, j, place)
    cx, cy = tip_in_body(scene, i, place, clock)
    ux, uy = to_body(scene.tips[i, 2], scene.tips[i, 3], place)
    dx, dy = cx - scene.edges[j, VX], cy - scene.edges[j, VY]
    nx, ny = scene.edges[j, NX], scene.edges[j, NY]
    along = nx * dy - ny * dx
    if kind == EDGE:
        r = scene.tips[i, 4]
        return -nx, -ny, cx - r * nx, cy - r * ny, ux, uy, along, scene.edges[j, LENGTH] - along
    if kind == POINT:
        return 1.0, 0.0, cx, cy, ux, uy, 1.0, 1.0
    last = int(scene.edges[j, BEFORE])
    beyond = scene.edges[last, NX] * dy - scene.edges[last, NY] * dx
    far = np.hypot(dx, dy)
    return -dx / far, -dy / far, cx - dx, cy - dy, ux, uy, beyond, -along


@sealed
def _wall_frame(scene: Scene, i: int, j: int, place: Place) -> Frame:
    """Corner i of the part on wall j."""
    nx, ny = to_body(scene.walls[j, NX], scene.walls[j, NY], place)
    px, py = scene.edges[i, VX], scene.edges[i, VY]
    wx = place[0] + place[2] * px - place[3] * py - scene.walls[j, VX]
    wy = place[1] + place[3] * px + place[2] * py - scene.walls[j, VY]
    along = scene.walls[j, NX] * wy - scene.walls[j, NY] * wx
    return nx, ny, px, py, 0.0, 0.0, along, scene.walls[j, LENGTH] - along


@inlined
def friction(scene: Scene, work: Work, kind: int, i: int) -> float:
    """Coefficient of friction of a contact."""
    return float(work.wall_friction if kind == WALL else scene.tips[i, 5])


@sealed
def gap(scene: Scene, kind: int, i: int, j: int, place: Place, clock: float) -> float:
    """Distance between the surfaces of a contact (0 for a point tip on a corner)."""
    if kind == WALL:
        px, py = scene.edges[i, VX], scene.edges[i, VY]
        wx = place[0] + place[2] * px - place[3] * py - scene.walls[j, VX]
        wy = place[1] + place[3] * px + place[2] * py - scene.walls[j, VY]
        return float(scene.walls[j, NX] * wx + scene.walls[j, NY] * wy)
    cx, cy = tip_in_body(scene, i, place, clock)
    dx, dy = cx - scene.edges[j, VX], cy - scene.edges[j, VY]
    if kind == EDGE:
        return float(scene.edges[j, NX] * dx + scene.edges[j, NY] * dy - scene.tips[i, 4])
    if kind == CORNER:
        return float(np.hypot(dx, dy) - scene.tips[i, 4])
    return 0.0


@sealed
def _add(work: Work, kind: int, i: int, j: int, group: int) -> None:
    """Add a contact to the list (silently full at its end; the run then counts them)."""
    c = work.count[TOUCHING]
    if c < MOST:
        work.contact[c, KIND] = kind
        work.contact[c, FIRST] = i
        work.contact[c, SECOND] = j
        work.contact[c, GROUP] = group
        work.count[TOUCHING] = c + 1


@sealed
def list_touching(
    scene: Scene, work: Work, place: Place, clock: float, band: tuple[float, float]
) -> None:
    """List where the part touches; of the band (near, deep) gaps from −deep to near do."""
    work.count[TOUCHING] = 0
    near, deep = band
    for i in range(scene.tips.shape[0]):
        cx, cy = tip_in_body(scene, i, place, clock)
        if cx * cx + cy * cy <= (work.reach + scene.tips[i, 4] + near) ** 2:
            _list_tip(scene, work, i, (cx, cy, near, deep))
    if scene.walls.shape[0] > 0:
        for i in range(scene.edges.shape[0]):
            if scene.edges[i, CONVEX] > 0.0:
                _list_corner(scene, work, i, place, (near, deep))


@sealed
def _list_tip(scene: Scene, work: Work, i: int, point: tuple[float, float, float, float]) -> None:
    """List where a tip touches the part."""
    cx, cy, near, deep = point
    count = scene.edges.shape[0]
    r = scene.tips[i, 4]
    for j in range(count):
        edge = scene.edges[j]
        dx, dy = cx - edge[VX], cy - edge[VY]
        s = edge[NX] * dx + edge[NY] * dy - r
        if s > near:  # off the line of the edge, and farther from its corner than that
            continue
        along = edge[NX] * dy - edge[NY] * dx
        far = np.sqrt(dx * dx + dy * dy)
        convex = edge[CONVEX] > 0.0
        group = -1
        if -deep <= s <= near and -near <= along <= edge[LENGTH] + near:
            after = int(edge[AFTER])
            if convex and along <= near:
                group = i * count + j
            elif scene.edges[after, CONVEX] > 0.0 and along >= edge[LENGTH] - near:
                group = i * count + after
            if _fits(scene, work, i, j, group):
                _add(work, EDGE, i, j, group)
        if convex and -deep <= far - r <= near:
            _list_at_corner(scene, work, i, j, (dx, dy, near))


@sealed
def _list_at_corner(
    scene: Scene, work: Work, i: int, j: int, offset: tuple[float, float, float]
) -> None:
    """List a disc on a corner, or a point tip of its own (not a corner of the fixture)."""
    dx, dy, near = offset
    r = scene.tips[i, 4]
    group = i * scene.edges.shape[0] + j
    if r == 0.0:
        if i < work.movers:
            _add(work, POINT, i, j, group)
        return
    last = int(scene.edges[j, BEFORE])
    along = scene.edges[j, NX] * dy - scene.edges[j, NY] * dx
    before = scene.edges[last, NX] * dy - scene.edges[last, NY] * dx
    if along <= near and before >= -near:
        edge_on = along >= -near or before <= near
        _add(work, CORNER, i, j, group if edge_on else -1)


@sealed
def _fits(scene: Scene, work: Work, i: int, j: int, group: int) -> bool:
    """Whether the edge j of the part can separate it from the fixture at a corner of both."""
    if group < 0 or i < work.movers:
        return True
    cos, sin = np.cos(work.pose[2]), np.sin(work.pose[2])
    nx = cos * scene.edges[j, NX] - sin * scene.edges[j, NY]
    ny = sin * scene.edges[j, NX] + cos * scene.edges[j, NY]
    for f in range(scene.walls.shape[0]):
        if scene.walls[f, TIP] == i - work.movers:
            b = int(scene.walls[f, BEFORE])
            out = nx * -scene.walls[f, NY] + ny * scene.walls[f, NX]
            back = nx * scene.walls[b, NY] - ny * scene.walls[b, NX]
            return bool(out >= -1e-9 and back >= -1e-9)
    return True


@sealed
def _list_corner(scene: Scene, work: Work, i: int, place: Place, band: tuple[float, float]) -> None:
    """List where a corner of the part touches the fixture."""
    near, deep = band
    for f in range(scene.walls.shape[0]):
        s = gap(scene, WALL, i, f, place, 0.0)
        if not -deep <= s <= near:
            continue
        found = _wall_frame(scene, i, f, place)
        along, rest = found[6], found[7]
        if along < -near or rest < -near:
            continue
        group = -1
        end = f if along <= near else int(scene.walls[f, AFTER])
        if (along <= near or rest <= near) and scene.walls[end, CONVEX] > 0.0:
            group = (work.movers + int(scene.walls[end, TIP])) * scene.edges.shape[0] + i
        if group < 0 or _corner_fits(scene, i, f, place):
            _add(work, WALL, i, f, group)


@sealed
def _corner_fits(scene: Scene, i: int, f: int, place: Place) -> bool:
    """Whether the wall f can separate the part at its corner i from the fixture."""
    nx, ny = to_body(scene.walls[f, NX], scene.walls[f, NY], place)
    b = int(scene.edges[i, BEFORE])
    out = nx * -scene.edges[i, NY] + ny * scene.edges[i, NX]
    back = nx * scene.edges[b, NY] - ny * scene.edges[b, NX]
    return bool(out >= -1e-9 and back >= -1e-9)
