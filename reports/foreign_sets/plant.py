"""A part with mass, pushed on a film by compliant round tips: the blind benchmark's stepper for a plan.

The implicit step is that of the blind benchmark's kernel, written for another purpose; the film is a
quadrature over nodes as there. Several tips, each with its own radius and its own friction in every leg
of its way, press on a simple polygon by a penalty on their overlap, with a tangential spring that slips
by return mapping. Nothing here is shared with the simulator of the package, which has rigid contacts, no
mass and a complementarity problem. Units are um, s and rad; forces are over the film's drag and hence
speeds.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numba import njit

from reports.blind.kernel import RENEWAL, TANGENTIAL, accelerate, invert, turning

Floats = npt.NDArray[np.float64]

FASTEST = 10.0
"""Over the speed of the tips: no point of a part that is pushed and not yet stuck moves faster."""
DONE, STUCK, INSIDE = 0, 1, 2
"""How a run of a move ends: its travel is made, the tips go into the part, or one starts in it."""


class Grain(NamedTuple):
    """How fine the plant is, and so how far from a rigid part without mass."""

    overlap: float = 0.02
    """um of overlap at a force that drags the part at the speed of the tips."""
    coast: float = 0.02
    """um in which a free part comes to rest from that speed."""
    step: float = 0.3
    """Time step over that of the contact's oscillation, sqrt(overlap coast) over the speed."""
    speed: float = 75.0
    """um/s of the tips."""
    deepest: float = 2.0
    """um of overlap at which the part is taken to be stuck."""


COARSE, FINE = Grain(), Grain(overlap=0.005, coast=0.005)
"""The plant, and the finer one that tells its error."""


@njit(cache=True, nogil=True)
def nearest(outline, x, y):  # type: ignore[no-untyped-def]
    """Distance from a simple polygon, negative inside, its nearest point, and the way there (inward)."""
    best, px, py, ex, ey, inside = np.inf, 0.0, 0.0, 0.0, 0.0, False
    count = len(outline)
    for k in range(count):
        ax, ay = outline[k]
        bx, by = outline[(k + 1) % count]
        dx, dy = bx - ax, by - ay
        if (ay > y) != (by > y) and x < ax + (y - ay) / dy * dx:
            inside = not inside
        share = min(max(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy), 0.0), 1.0)
        qx, qy = ax + share * dx, ay + share * dy
        square = (x - qx) ** 2 + (y - qy) ** 2
        if square < best:
            best, px, py = square, qx, qy
            length = np.sqrt(dx * dx + dy * dy)
            ex, ey = -dy / length, dx / length
            if share == 0.0 or share == 1.0:
                away = max(np.sqrt(square), 1e-12)
                side = -1.0 if inside else 1.0
                ex, ey = side * (qx - x) / away, side * (qy - y) / away
    distance = np.sqrt(best)
    return -distance if inside else distance, px, py, ex, ey


@njit(cache=True, nogil=True)
def press(outline, pose, speed, tip, law, wrench):  # type: ignore[no-untyped-def]
    """Add the wrench of a tip on the part to `wrench`; return the overlap.

    tip: place x and y, speed x and y, radius, tangential force, which is carried on. law: friction,
    stiffness, damping, time step.
    """
    mu, stiff, damping, step = law
    c, s = np.cos(pose[2]), np.sin(pose[2])
    dx, dy = tip[0] - pose[0], tip[1] - pose[1]
    distance, qx, qy, ex, ey = nearest(outline, c * dx + s * dy, c * dy - s * dx)
    overlap = tip[4] - distance
    if overlap <= 0.0:
        tip[5] = 0.0
        return overlap
    nx, ny = c * ex - s * ey, s * ex + c * ey
    rx, ry = c * qx - s * qy, s * qx + c * qy
    ux, uy = speed[0] - speed[2] * ry - tip[2], speed[1] + speed[2] * rx - tip[3]
    normal = max(stiff * overlap - damping * (ux * nx + uy * ny), 0.0)
    limit = mu * normal
    trial = tip[5] - TANGENTIAL * stiff * step * (uy * nx - ux * ny)
    tip[5] = min(max(trial, -limit), limit)
    fx, fy = normal * nx - tip[5] * ny, normal * ny + tip[5] * nx
    wrench[0] += fx
    wrench[1] += fy
    wrench[2] += rx * fy - ry * fx
    return overlap


@njit(cache=True, nogil=True)
def quadrature(nodes, lay, theta, matrix):  # type: ignore[no-untyped-def]
    """Write the drag matrix (3, 3) of a film, stage frame.

    nodes: (Q, 2) of equal weight, part's frame. lay: (4,) deviation of the drag from its mean, along x
    and across, fixed in the part and fixed in the stage.
    """
    c, s = np.cos(theta), np.sin(theta)
    double, twice = c * c - s * s, 2.0 * c * s
    along = lay[0] * double - lay[1] * twice + lay[2]
    across = lay[1] * double + lay[0] * twice + lay[3]
    weight = 1.0 / len(nodes)
    xx, yy, xy = weight * (1.0 + along), weight * (1.0 - along), weight * across
    matrix[:] = 0.0
    for k in range(len(nodes)):
        rx, ry = c * nodes[k, 0] - s * nodes[k, 1], s * nodes[k, 0] + c * nodes[k, 1]
        mx, my = xy * rx - xx * ry, yy * rx - xy * ry
        matrix[0, 0] += xx
        matrix[1, 1] += yy
        matrix[0, 1] += xy
        matrix[0, 2] += mx
        matrix[1, 2] += my
        matrix[2, 2] += rx * my - ry * mx
    matrix[1, 0], matrix[2, 0], matrix[2, 1] = matrix[0, 1], matrix[0, 2], matrix[1, 2]


@njit(cache=True, nogil=True)
def clearance(outline, pose, tips):  # type: ignore[no-untyped-def]
    """Least distance of the part from a tip's surface."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    least = np.inf
    for p in range(len(tips)):
        dx, dy = tips[p, 0] - pose[0], tips[p, 1] - pose[1]
        least = min(least, nearest(outline, c * dx + s * dy, c * dy - s * dx)[0] - tips[p, 4])
    return least


@njit(cache=True, nogil=True)
def go(outline, film, start, way, tips, mu, grain, state):  # type: ignore[no-untyped-def]
    """Take the tips along one leg from `start` by `way` (P, 2); return DONE or STUCK.

    film, tips, mu, grain: as in `push`, tips (P, 6) as in `press`. state: pose and speed (3,), written.
    """
    nodes, lay = film
    pose, speed = state
    length = np.sqrt((way**2).sum(axis=1).max())
    if length == 0.0:
        return DONE
    usual = grain.step * np.sqrt(grain.overlap * grain.coast)
    count = int(np.ceil(length / usual))
    step = length / grain.speed / count
    stiff, mass = grain.speed / grain.overlap, grain.coast / grain.speed
    # the contact is damped about as strongly as makes it settle fastest, so that it does not bounce
    damping = np.sqrt(mass * stiff)
    inertia = mass * np.array([1.0, 1.0, turning(outline)])
    wrench, matrix, inverse = np.zeros(3), np.zeros((3, 3)), np.zeros((3, 3))
    rests = np.zeros(len(tips), np.int64)
    tips[:, 2:4] = way * (grain.speed / length)
    k = 0
    while k < count:
        tips[:, :2] = start + way * (k / count)
        if k % 64 == 0 and np.abs(speed).max() < 1e-9 * grain.speed:
            # nothing touches the part, which is at rest: the tips go on through the air
            free = int((clearance(outline, pose, tips) - 1.0) / (grain.speed * step)) // 64 * 64
            if free > 0:
                k, speed[:] = min(k + free, count), 0.0
                continue
        if k % RENEWAL == 0:
            quadrature(nodes, lay, pose[2], matrix)
            invert(matrix, step, inertia, inverse)
        wrench[:] = 0.0
        for p in range(len(tips)):
            if k >= rests[p]:
                law = (mu[p], stiff, damping, step)
                overlap = press(outline, pose, speed, tips[p], law, wrench)
                if overlap > grain.deepest:
                    return STUCK
                # a tip and the part come closer at most at FASTEST times the speed of the tips
                rests[p] = k + int(-overlap / (FASTEST * grain.speed * step))
        accelerate(inertia, inverse, wrench, step, speed)
        pose += step * speed
        k += 1
    return DONE


@njit(cache=True, nogil=True)
def push(outline, film, ways, radii, friction, grain, pose):  # type: ignore[no-untyped-def]
    """Push the part through one move; `pose` (3,) becomes that at its end.

    Parameters
    ----------
    outline
        (V, 2) corners of the part, counter-clockwise, about its reference point.
    film
        Nodes (Q, 2) and lay (4,); see `quadrature`.
    ways
        (L + 1, P, 2) ends of the legs of the tips.
    radii, friction
        (P,) and (L, P) of the tips.
    grain
        Of the plant.

    Returns
    -------
    int
        DONE, STUCK or INSIDE.
    """
    tips, speed = np.zeros((len(radii), 6)), np.zeros(3)
    tips[:, :2], tips[:, 4] = ways[0], radii
    if clearance(outline, pose, tips) < -grain.deepest:
        return INSIDE
    for leg in range(len(ways) - 1):
        way = ways[leg + 1] - ways[leg]
        ending = go(outline, film, ways[leg], way, tips, friction[leg], grain, (pose, speed))
        if ending != DONE:
            return ending
    return DONE


@njit(cache=True, nogil=True)
def push_all(outlines, film, ways, radii, friction, grain, out, span):  # type: ignore[no-untyped-def]
    """Push the parts of the runs of a span; arrays as in `push`, with a row for each.

    out: poses (N, 3), which become those at the end, and endings (N,).
    """
    nodes, lays = film
    poses, endings = out
    for i in range(span[0], span[1]):
        own = (nodes[i], lays[i])
        endings[i] = push(outlines[i], own, ways[i], radii[i], friction[i], grain, poses[i])
