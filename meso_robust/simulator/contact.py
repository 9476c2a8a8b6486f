"""Gap and normal of a point tip at a convex polygon, in the body frame.

For the edges ``N_i · x = b_i`` with outward unit normals ``N_i``, a point ``c`` has the signed
distances ``s_i = N_i · c − b_i``. Inside, the gap is the largest ``s_i`` (negative). Outside, if
the foot on an edge is the nearest point of the part, that edge has the largest ``s_i``; if the
foot on the edge with the largest ``s_i`` falls beyond its ends, the nearest point is a corner.

A step needs one half-plane for each tip. Near a corner the one across the line from corner to tip
would stop a tip that only grazes past, so a tip that can reach the corner within the step is held
off by the edge whose line it crosses last, as in ray casting.
"""

import numpy as np
import numpy.typing as npt
from numba import njit

_F = npt.NDArray[np.float64]


def polygon_faces(vertices: _F) -> _F:
    """Tabulate the edges of a convex polygon.

    Parameters
    ----------
    vertices
        (V, 2) corners in m, body frame, counter-clockwise.

    Returns
    -------
    ndarray
        (V, 6) rows ``v_x, v_y, N_x, N_y, b, length``: first corner, outward unit normal, offset
        ``b = N · v`` and length in m of the edge from corner i to corner i + 1.
    """
    edge = np.roll(vertices, -1, axis=0) - vertices
    length = np.hypot(edge[:, 0], edge[:, 1])
    normal = np.column_stack([edge[:, 1], -edge[:, 0]]) / length[:, None]
    offset = np.sum(normal * vertices, axis=1)
    return np.ascontiguousarray(np.column_stack([vertices, normal, offset, length]))


@njit(cache=True, error_model="numpy")
def locate(
    faces: _F, cx: float, cy: float, dx: float, dy: float
) -> tuple[float, float, float, float, float]:
    """Gap, outward normal and contact point of a tip.

    Parameters
    ----------
    faces
        (V, 6) table from `polygon_faces`.
    cx, cy
        Tip in m, body frame.
    dx, dy
        Displacement of the tip in this step with the part at rest, in m, body frame. It only
        matters near a corner.

    Returns
    -------
    tuple of float
        ``gap`` (m, negative inside), ``n_x, n_y`` (unit, outward from the part), ``p_x, p_y``
        (m, the point of the part that faces the tip).
    """
    best = 0
    gap = -np.inf
    for i in range(faces.shape[0]):
        s = faces[i, 2] * cx + faces[i, 3] * cy - faces[i, 4]
        if s > gap:
            gap = s
            best = i
    nx, ny = faces[best, 2], faces[best, 3]
    along = nx * (cy - faces[best, 1]) - ny * (cx - faces[best, 0])
    if gap <= 0.0 or 0.0 <= along <= faces[best, 5]:
        return gap, nx, ny, cx - gap * nx, cy - gap * ny
    return _locate_corner(faces, cx, cy, dx, dy)


@njit(cache=True, error_model="numpy")
def _locate_corner(
    faces: _F, cx: float, cy: float, dx: float, dy: float
) -> tuple[float, float, float, float, float]:
    """Gap of a tip whose nearest point of the part is a corner."""
    best = 0
    square = np.inf
    for i in range(faces.shape[0]):
        r2 = (cx - faces[i, 0]) ** 2 + (cy - faces[i, 1]) ** 2
        if r2 < square:
            square = r2
            best = i
    px, py = faces[best, 0], faces[best, 1]
    gap = np.sqrt(square)
    if dx * dx + dy * dy < square:
        return gap, (cx - px) / gap, (cy - py) / gap, px, py
    edge = _last_crossed(faces, cx, cy, dx, dy)
    s = faces[edge, 2] * cx + faces[edge, 3] * cy - faces[edge, 4]
    return s, faces[edge, 2], faces[edge, 3], px, py


@njit(cache=True, error_model="numpy")
def _last_crossed(faces: _F, cx: float, cy: float, dx: float, dy: float) -> int:
    """Edge whose line an outside tip crosses last, or never, on its way through the step."""
    best = 0
    latest = -np.inf
    for i in range(faces.shape[0]):
        s = faces[i, 2] * cx + faces[i, 3] * cy - faces[i, 4]
        closing = -(faces[i, 2] * dx + faces[i, 3] * dy)
        # An edge that is never crossed ranks above all crossings, and among such edges the one
        # that the tip is farther out of; an edge that the tip is behind cannot hold it off.
        time = s / closing if closing > s else 2.0 + s
        if s >= 0.0 and time > latest:
            latest = time
            best = i
    return best
