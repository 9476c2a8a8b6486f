"""The plant's stepper: Newton's law by semi-implicit Euler, quadrature for the film, penalty contacts.

The film's resistance at the present speed makes a 3 x 3 matrix over nodes of the footprint, taken
implicitly, so that regularised dry friction needs no smaller step. Tips press on a simple polygon by a
penalty on their overlap, with a tangential spring that slips by return mapping.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

inner = njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
"""Counts no references to arrays, which took two thirds of a step, and so makes none."""
RENEWAL = 3
"""Steps between renewals of the film's matrix."""
TANGENTIAL = 0.8
"""Tangential over normal stiffness, about that of a sphere."""
CREEP = 0.05
"""Speed below which regularised dry friction is viscous, um/s."""
REFERENCE = 75.0
"""Speed at which power laws are stated, um/s."""
FASTEST = 10.0
"""Over the speed of the tips: no point of a part that is pushed and not yet stuck moves faster."""
DONE, STUCK, INSIDE = 0, 1, 2
"""How a run of a move ends: its travel is made, the tips go into the part, or one starts in it."""
TIP = 7
"""Numbers of a tip: place x and y, speed x and y, radius, tangential force, whether it has touched."""


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


@inner
def nearest(outline, x, y):  # type: ignore[no-untyped-def]
    """Distance from a simple polygon, negative inside, its nearest point, the way there, and its edge."""
    best, px, py, ex, ey, edge, corner, inside = np.inf, 0.0, 0.0, 0.0, 0.0, 0, False, False
    count = len(outline)
    for k in range(count):
        j = (k + 1) % count
        ax, ay, bx, by = outline[k, 0], outline[k, 1], outline[j, 0], outline[j, 1]
        dx, dy = bx - ax, by - ay
        if (ay > y) != (by > y) and x < ax + (y - ay) / dy * dx:
            inside = not inside
        share = min(max(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy), 0.0), 1.0)
        qx, qy = ax + share * dx, ay + share * dy
        square = (x - qx) ** 2 + (y - qy) ** 2
        if square < best:
            best, px, py, edge = square, qx, qy, k
            ex, ey, corner = -dy, dx, share == 0.0 or share == 1.0
    distance = np.sqrt(best)
    length = np.sqrt(ex * ex + ey * ey)
    if corner:
        length = -max(distance, 1e-12) if inside else max(distance, 1e-12)
        ex, ey = px - x, py - y
    return -distance if inside else distance, px, py, ex / length, ey / length, edge


@inner
def press(outline, laws, pose, speed, tip, law, wrench):  # type: ignore[no-untyped-def]
    """Add the wrench of a tip on the part to `wrench`; return the overlap.

    tip: its `TIP` numbers, of which the last two are carried on. law: friction, stiffness, damping, time
    step. A tip that gives way is a spring in series with the contact's.
    """
    mu, stiff, damping, step = law
    c, s = np.cos(pose[2]), np.sin(pose[2])
    dx, dy = tip[0] - pose[0], tip[1] - pose[1]
    distance, qx, qy, ex, ey, edge = nearest(outline, c * dx + s * dy, c * dy - s * dx)
    overlap = tip[4] - distance
    drawn = 0.0
    if tip[6] > 0.0 and -overlap < laws.adhesion_range:
        drawn = laws.adhesion
    if laws.attraction != 0.0:
        reach = laws.attraction_range
        drawn += laws.attraction * reach / (reach + max(-overlap, 0.0))
    if overlap > 0.0:
        tip[6] = 1.0
    elif -overlap > laws.adhesion_range:
        tip[6] = 0.0
    if overlap <= 0.0:
        tip[5] = 0.0
        if drawn == 0.0:
            return overlap
    nx, ny = c * ex - s * ey, s * ex + c * ey
    rx, ry = c * qx - s * qy, s * qx + c * qy
    ux, uy = speed[0] - speed[2] * ry - tip[2], speed[1] + speed[2] * rx - tip[3]
    series = 1.0 + stiff * laws.compliance
    normal = 0.0
    if overlap > 0.0:
        pressed = overlap + laws.compliance * drawn
        normal = max((stiff * pressed - damping * (ux * nx + uy * ny)) / series, 0.0)
    if edge == laws.edge:
        mu *= 1.0 + laws.edge_change
    limit, tangential = mu * normal, TANGENTIAL * stiff
    trial = tip[5] - tangential / (1.0 + tangential * laws.compliance) * step * (uy * nx - ux * ny)
    tip[5] = min(max(trial, -limit), limit)
    fx, fy = (normal - drawn) * nx - tip[5] * ny, (normal - drawn) * ny + tip[5] * nx
    wrench[0] += fx
    wrench[1] += fy
    wrench[2] += rx * fy - ry * fx
    return overlap


@inner
def resistance(laws, u, age, pressure):  # type: ignore[no-untyped-def]
    """Resistance over speed at one node: of the fluid, and of dry contact."""
    fluid, dry = 1.0, laws.dry + laws.uneven * max(pressure, 0.0)
    if laws.thinning != 0.0:
        fluid = (u / REFERENCE) ** (-laws.thinning)
    if laws.stribeck != 0.0:
        dry += laws.stribeck * np.exp(-((u / laws.stribeck_speed) ** 2))
    if laws.breakaway != 0.0:
        dry += laws.breakaway * np.log1p(age)
    return fluid, dry / u


@inner
def film(support, pose, speed, age, now, matrix, load):  # type: ignore[no-untyped-def]
    """Write the film's matrix (3, 3) and the load (3,) of its flow, stage frame; age the contact.

    support: nodes (Q, 3) of equal weight, x and y in the part's frame, relative pressure; lay (4,), deviation
    of the drag from its mean, along x and across, fixed in the part and fixed in the stage; laws. now: time and
    the time since the last call.
    """
    nodes, lay, laws = support
    c, s = np.cos(pose[2]), np.sin(pose[2])
    double, twice = c * c - s * s, 2.0 * c * s
    along = lay[0] * double - lay[1] * twice + lay[2]
    across = lay[1] * double + lay[0] * twice + lay[3]
    weight = np.exp(laws.growth * now[0]) / len(nodes)
    matrix[:] = 0.0
    load[:] = 0.0
    slip = 0.0
    for k in range(len(nodes)):
        rx, ry = c * nodes[k, 0] - s * nodes[k, 1], s * nodes[k, 0] + c * nodes[k, 1]
        ux, uy = speed[0] - speed[2] * ry - laws.flow_x, speed[1] + speed[2] * rx - laws.flow_y
        u = np.sqrt(ux * ux + uy * uy + CREEP * CREEP)
        fluid, dry = resistance(laws, u, age[0], nodes[k, 2])
        fluid *= np.exp(laws.gradient_x * (pose[0] + rx) + laws.gradient_y * (pose[1] + ry))
        xx, yy = weight * (fluid * (1.0 + along) + dry), weight * (fluid * (1.0 - along) + dry)
        xy = weight * fluid * across
        mx, my = xy * rx - xx * ry, yy * rx - xy * ry
        matrix[0, 0] += xx
        matrix[1, 1] += yy
        matrix[0, 1] += xy
        matrix[0, 2] += mx
        matrix[1, 2] += my
        matrix[2, 2] += rx * my - ry * mx
        slip += u * u / len(nodes)
    matrix[1, 0], matrix[2, 0], matrix[2, 1] = matrix[0, 1], matrix[0, 2], matrix[1, 2]
    for k in range(3):
        load[k] = matrix[k, 0] * laws.flow_x + matrix[k, 1] * laws.flow_y
    rate = np.sqrt(slip) / laws.breakaway_distance
    age[0] += (1.0 / rate - age[0]) * -np.expm1(-rate * now[1])


@inner
def ambient(laws, pose, wrench):  # type: ignore[no-untyped-def]
    """Add what acts on a part that nothing touches."""
    wrench[0] += laws.force_x
    wrench[1] += laws.force_y
    if laws.wall != 0.0:
        nx, ny = np.cos(laws.wall_angle), np.sin(laws.wall_angle)
        gap = laws.wall_place - nx * pose[0] - ny * pose[1]
        pull = laws.wall * np.exp(-gap / laws.wall_range)
        wrench[0] += pull * nx
        wrench[1] += pull * ny


@inner
def invert(matrix, share, inertia, inverse):  # type: ignore[no-untyped-def]
    """Inverse of diag(inertia) + share matrix, symmetric 3 x 3, by cofactors."""
    a, b = share * matrix[0, 0] + inertia[0], share * matrix[1, 1] + inertia[1]
    c = share * matrix[2, 2] + inertia[2]
    d, e, f = share * matrix[0, 1], share * matrix[0, 2], share * matrix[1, 2]
    inverse[0, 0], inverse[1, 1], inverse[2, 2] = b * c - f * f, a * c - e * e, a * b - d * d
    inverse[0, 1] = inverse[1, 0] = e * f - c * d
    inverse[0, 2] = inverse[2, 0] = d * f - b * e
    inverse[1, 2] = inverse[2, 1] = d * e - a * f
    determinant = a * inverse[0, 0] + d * inverse[0, 1] + e * inverse[0, 2]
    for k in range(3):
        for j in range(3):
            inverse[k, j] /= determinant


@inner
def turning(outline):  # type: ignore[no-untyped-def]
    """Square of the radius of gyration of a lamina about its reference point, um²."""
    area, second = 0.0, 0.0
    for k in range(len(outline)):
        a, b = outline[k], outline[(k + 1) % len(outline)]
        cross = a[0] * b[1] - a[1] * b[0]
        area += cross
        second += cross * (a @ a + a @ b + b @ b)
    return second / (6.0 * area)


@inner
def clearance(outline, pose, tips):  # type: ignore[no-untyped-def]
    """Least distance of the part from a tip's surface."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    least = np.inf
    for p in range(len(tips)):
        dx, dy = tips[p, 0] - pose[0], tips[p, 1] - pose[1]
        least = min(least, nearest(outline, c * dx + s * dy, c * dy - s * dx)[0] - tips[p, 4])
    return least


@inner
def idle(laws):  # type: ignore[no-untyped-def]
    """Whether nothing acts on a part that no tip touches."""
    pulled = laws.attraction != 0.0 or laws.adhesion != 0.0 or laws.wall != 0.0
    driven = laws.force_x != 0.0 or laws.force_y != 0.0 or laws.flow_x != 0.0 or laws.flow_y != 0.0
    return not pulled and not driven


@inner
def untouched(outline, tips, pose, reach):  # type: ignore[no-untyped-def]
    """Steps in which no tip comes near the part, at rest; reach: of the tips in a step. 0: none."""
    room = clearance(outline, pose, tips) - 1.0
    if room <= 0.0:
        return 0
    if reach == 0.0 or room == np.inf:
        return np.iinfo(np.int64).max
    return int(room / reach) // 64 * 64


@inner
def accelerate(inertia, inverse, step, wrench, speed):  # type: ignore[no-untyped-def]
    """Take the speed (3,) over a step, the film's resistance implicitly."""
    for i in range(3):
        wrench[i] = inertia[i] * speed[i] + step * wrench[i]
    for i in range(3):
        speed[i] = 0.0
        for j in range(3):
            speed[i] += inverse[i, j] * wrench[j]


@inner
def place(start, way, share, tips):  # type: ignore[no-untyped-def]
    """Put the tips where they are at a share of their ways (P, 2)."""
    for p in range(len(tips)):
        for i in range(2):
            tips[p, i] = start[p, i] + way[p, i] * share


@inner
def largest(speed):  # type: ignore[no-untyped-def]
    """Largest of three numbers, without their signs."""
    return max(abs(speed[0]), abs(speed[1]), abs(speed[2]))


@inner
def touched(outline, laws, motion, tips, mu, law, rests, wrench):  # type: ignore[no-untyped-def]
    """Add the wrench of all tips; return the deepest overlap, over what is stuck.

    law: stiffness, damping, time step, overlap at which the part is stuck, fastest way in a step. rests:
    (P,) steps in which a tip need not be looked at, written.
    """
    pose, speed = motion
    stiff, damping, step, deepest, fastest = law
    far = laws.attraction != 0.0 or laws.adhesion != 0.0
    worst = 0.0
    for p in range(len(tips)):
        if rests[p] > 0 and not far:
            rests[p] -= 1
            continue
        overlap = press(outline, laws, pose, speed, tips[p], (mu[p], stiff, damping, step), wrench)
        worst = max(worst, overlap / deepest)
        rests[p] = max(int(-overlap / fastest) - 1, 0)
    return worst


@njit(cache=True, nogil=True)
def advance(outline, support, tips, way, mu, grain, state, duration):  # type: ignore[no-untyped-def]
    """Take the tips along straight ways (P, 2) in a time, s; return DONE or STUCK.

    support: nodes, lay and laws, as in `film`. tips: (P, TIP), whose places, forces and contacts are
    carried on. state: pose and speed (3,), time and age of the contact under the film (1,), carried on.
    """
    usual = grain.step * np.sqrt(grain.overlap * grain.coast) / grain.speed
    count = max(int(np.ceil(duration / usual)), 1)
    room = (np.zeros((4, 3)), np.zeros((3, 3)), np.zeros((3, 3)), np.zeros(len(tips), np.int64))
    going = (tips, tips[:, :2].copy(), way)
    return march(outline, support, going, mu, grain, state, (duration, count), room)


@inner
def march(outline, support, going, mu, grain, state, lasts, room):  # type: ignore[no-untyped-def]
    """Carry out `advance` in arrays that are there.

    going: tips, their places at the start and their ways (P, 2). lasts: duration and number of steps. room:
    rows of inertia, wrench, load and times (4, 3), the film's matrix and its inverse (3, 3), rests (P,).
    """
    tips, start, way = going
    rows, matrix, inverse, rests = room
    inertia, wrench, load, now = rows[0], rows[1], rows[2], rows[3]
    duration, count = lasts
    laws = support[2]
    pose, speed, time, age = state
    step = duration / count
    stiff, mass = grain.speed / grain.overlap, grain.coast / grain.speed
    inertia[0], inertia[1], inertia[2] = mass, mass, mass * turning(outline)
    pace = 0.0
    for p in range(len(tips)):
        tips[p, 2], tips[p, 3] = way[p, 0] / duration, way[p, 1] / duration
        pace = max(pace, np.hypot(tips[p, 2], tips[p, 3]))
    # the contact is damped about as strongly as makes it settle fastest, so that it does not bounce;
    # a tip and the part come closer at most at FASTEST times the speed of the tips
    deepest = grain.deepest * (1.0 + stiff * laws.compliance)
    law = (stiff, np.sqrt(mass * stiff), step, deepest, FASTEST * max(pace, grain.speed) * step)
    calm, k, worst = idle(laws), 0, 0.0
    while k < count and worst <= 1.0:
        place(start, way, k / count, tips)
        if calm and k % 64 == 0 and largest(speed) < 1e-9 * grain.speed:
            free = min(untouched(outline, tips, pose, pace * step), count - k)
            if free > 0:
                k += free
                speed[:] = 0.0
                rests[:] = 0
                continue
        if k % RENEWAL == 0:
            now[0], now[1] = time[0] + k * step, RENEWAL * step
            film(support, pose, speed, age, now, matrix, load)
            invert(matrix, step, inertia, inverse)
        for i in range(3):
            wrench[i] = load[i]
        ambient(laws, pose, wrench)
        worst = touched(outline, laws, (pose, speed), tips, mu, law, rests, wrench)
        if worst <= 1.0:
            accelerate(inertia, inverse, step, wrench, speed)
            for i in range(3):
                pose[i] += step * speed[i]
            k += 1
    place(start, way, k / count, tips)
    time[0] += duration
    return DONE if worst <= 1.0 else STUCK


@njit(cache=True, nogil=True)
def push(outline, support, ways, radii, friction, grain, pose):  # type: ignore[no-untyped-def]
    """Push the part through one move; `pose` (3,) becomes that at its end.

    Parameters
    ----------
    outline
        (V, 2) corners of the part, counter-clockwise, about its reference point.
    support
        Nodes (Q, 3), lay (4,) and laws; see `film`.
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
    tips, state = np.zeros((len(radii), TIP)), (pose, np.zeros(3), np.zeros(1), np.zeros(1))
    tips[:, :2], tips[:, 4] = ways[0], radii
    if clearance(outline, pose, tips) < -grain.deepest:
        return INSIDE
    for leg in range(len(ways) - 1):
        way = ways[leg + 1] - ways[leg]
        length = np.sqrt((way**2).sum(axis=1).max())
        if length > 0.0:
            duration = length / grain.speed
            ending = advance(outline, support, tips, way, friction[leg], grain, state, duration)
            if ending != DONE:
                return ending
    return DONE


@njit(cache=True, nogil=True)
def push_all(outlines, support, ways, radii, friction, grain, out, span):  # type: ignore[no-untyped-def]
    """Push the parts of the runs of a span; arrays as in `push`, with a row for each.

    support: nodes, lays and the laws of all. out: poses (N, 3), which become those at the end, and endings
    (N,).
    """
    nodes, lays, laws = support
    poses, endings = out
    for i in range(span[0], span[1]):
        own = (nodes[i], lays[i], laws)
        endings[i] = push(outlines[i], own, ways[i], radii[i], friction[i], grain, poses[i])
