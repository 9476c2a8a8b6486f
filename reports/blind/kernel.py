"""A part with mass, pushed on a film by a compliant round tip: the blind benchmark's own stepper.

Newton's law by semi-implicit Euler. The film is quadrature over nodes of the wetted footprint; its
resistance at the present speed makes a 3 x 3 matrix that is renewed every few steps and taken
implicitly, so that regularised dry friction needs no smaller step. Contact is a penalty on the
overlap of tip and outline with a tangential spring that slips by return mapping.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

Floats = npt.NDArray[np.float64]

RENEWAL = 3
"""Steps between renewals of the film's matrix."""
CREEP = 0.05
"""Speed below which regularised dry friction is viscous, um/s."""
REFERENCE = 75.0
"""Speed at which power laws and ratios are stated, um/s."""
TANGENTIAL = 0.8
"""Tangential over normal stiffness, about that of a sphere."""
CONTACT = 7
"""Numbers of a contact's state: tangential force, deflection x and y, wetted, normal force, gap,
slip speed."""


@njit(cache=True)
def nearest(outline, x, y):  # type: ignore[no-untyped-def]
    """Nearest point of a convex outline, its edge, and the signed distance from (x, y)."""
    best, where, px, py = np.inf, 0, 0.0, 0.0
    inside = True
    count = len(outline)
    for k in range(count):
        ax, ay = outline[k]
        bx, by = outline[(k + 1) % count]
        dx, dy = bx - ax, by - ay
        s = ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy)
        s = min(max(s, 0.0), 1.0)
        qx, qy = ax + s * dx, ay + s * dy
        square = (x - qx) ** 2 + (y - qy) ** 2
        inside = inside and dx * (y - ay) - dy * (x - ax) > 0.0
        if square < best:
            best, where, px, py = square, k, qx, qy
    distance = np.sqrt(best)
    return px, py, where, -distance if inside else distance


@njit(cache=True)
def node_drag(laws, speed, age, pressure):  # type: ignore[no-untyped-def]
    """Resistance over speed at one node: of the fluid, and of dry contact."""
    fluid = 1.0
    if laws.thinning != 0.0:
        fluid = (speed / REFERENCE) ** (-laws.thinning)
    fluid += laws.quadratic * speed / REFERENCE
    dry = laws.dry
    if laws.stribeck != 0.0:
        dry += laws.stribeck * np.exp(-((speed / laws.stribeck_speed) ** 2))
    if laws.ageing != 0.0:
        dry += laws.ageing * np.log1p(age)
    dry += laws.uneven * max(pressure, 0.0)
    return fluid, dry / speed


@njit(cache=True)
def place_factors(laws, x, y):  # type: ignore[no-untyped-def]
    """What the place on the stage does: a factor on the fluid's drag, and a dry patch."""
    factor, patch = 1.0, 0.0
    if laws.gradient_x != 0.0 or laws.gradient_y != 0.0:
        factor = np.exp(laws.gradient_x * x + laws.gradient_y * y)
    if laws.patch != 0.0:
        distance = np.hypot(x - laws.patch_x, y - laws.patch_y)
        patch = laws.patch if distance < laws.patch_radius else 0.0
    return factor, patch


@njit(cache=True)
def tensor(laws, theta):  # type: ignore[no-untyped-def]
    """Anisotropy of the fluid's drag, stage frame: (xx, yy, xy), the mean being 1."""
    stage, part = 2.0 * laws.anisotropy_angle, 2.0 * (laws.part_anisotropy_angle + theta)
    c = laws.anisotropy * np.cos(stage) + laws.part_anisotropy * np.cos(part)
    s = laws.anisotropy * np.sin(stage) + laws.part_anisotropy * np.sin(part)
    return 1.0 + c, 1.0 - c, s


@njit(cache=True)
def film(laws, nodes, age, pose, speed, now, matrix, load):  # type: ignore[no-untyped-def]
    """Quadrature of the film into matrix (3, 3) and the load (3,) of its flow; ages the contact.

    The wrench on the part is load - matrix @ speed. nodes: (Q, 3) x, y, relative pressure. age: (1,)
    of the contact, s, renewed at the mean (rms) slip of the footprint. now: time and step, s.
    """
    slip = 0.0
    c, s = np.cos(pose[2]), np.sin(pose[2])
    xx, yy, xy = tensor(laws, pose[2])
    matrix[:] = 0.0
    load[:] = 0.0
    weight = 1.0 / len(nodes)
    for k in range(len(nodes)):
        rx, ry = c * nodes[k, 0] - s * nodes[k, 1], s * nodes[k, 0] + c * nodes[k, 1]
        ux, uy = speed[0] - speed[2] * ry - laws.flow_x, speed[1] + speed[2] * rx - laws.flow_y
        u = np.sqrt(ux * ux + uy * uy + CREEP * CREEP)
        fluid, dry = node_drag(laws, u, age[0], nodes[k, 2])
        factor, patch = place_factors(laws, pose[0] + rx, pose[1] + ry)
        dry = weight * (dry + patch / u)
        fluid *= weight * factor
        kxx, kyy, kxy = fluid * xx + dry, fluid * yy + dry, fluid * xy
        mx, my = kxy * rx - kxx * ry, kyy * rx - kxy * ry
        matrix[0, 0] += kxx
        matrix[1, 1] += kyy
        matrix[0, 1] += kxy
        matrix[0, 2] += mx
        matrix[1, 2] += my
        matrix[2, 2] += rx * my - ry * mx
        load[0] += kxx * laws.flow_x + kxy * laws.flow_y
        load[1] += kxy * laws.flow_x + kyy * laws.flow_y
        load[2] += mx * laws.flow_x + my * laws.flow_y
        slip += weight * u * u
    rate = np.sqrt(slip) / laws.ageing_distance
    age[0] += (1.0 / rate - age[0]) * -np.expm1(-rate * RENEWAL * now[1])
    matrix[1, 0], matrix[2, 0], matrix[2, 1] = matrix[0, 1], matrix[0, 2], matrix[1, 2]
    if laws.growth != 0.0:
        growth = np.exp(laws.growth * now[0])
        for k in range(3):
            load[k] *= growth
            for j in range(3):
                matrix[k, j] *= growth


@njit(cache=True)
def invert(matrix, share, inertia, inverse):  # type: ignore[no-untyped-def]
    """Inverse of diag(inertia) + share · matrix, symmetric 3 x 3, by cofactors."""
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


@njit(cache=True)
def ambient(laws, pose, wrench):  # type: ignore[no-untyped-def]
    """Add the wrench on the untouched part, stage frame."""
    wrench[0] += laws.force_x
    wrench[1] += laws.force_y
    wrench[2] += laws.moment
    if laws.wall != 0.0:
        nx, ny = np.cos(laws.wall_angle), np.sin(laws.wall_angle)
        gap = laws.wall_place - nx * pose[0] - ny * pose[1]
        pull = laws.wall * np.exp(-gap / laws.wall_range)
        wrench[0] += pull * nx
        wrench[1] += pull * ny
    if laws.centre_pull != 0.0:
        dx, dy = laws.pull_x - pose[0], laws.pull_y - pose[1]
        scale = laws.centre_pull * 500.0 / (dx * dx + dy * dy + 1e4)
        wrench[0] += scale * dx
        wrench[1] += scale * dy


@njit(cache=True)
def friction(laws, edge, normal, time):  # type: ignore[no-untyped-def]
    """Friction coefficient of the tip now."""
    mu = laws.mu
    if edge == laws.edge:
        mu *= 1.0 + laws.edge_change
    if laws.wear != 0.0:
        mu *= 1.0 + laws.wear * np.expm1(-time / laws.wear_time)
    if laws.load_exponent != 0.0:
        mu *= (max(normal, 0.1) / REFERENCE) ** laws.load_exponent
    return max(mu, 0.0)


@njit(cache=True)
def pull(laws, gap, wet):  # type: ignore[no-untyped-def]
    """Force that draws tip and part together across a gap."""
    force = laws.adhesion if wet and gap < laws.adhesion_range else 0.0
    if laws.attraction != 0.0:
        force += laws.attraction * laws.attraction_range / (laws.attraction_range + max(gap, 0.0))
    return force


@njit(cache=True)
def touch(laws, outline, pose, speed, body, contact, now, wrench):  # type: ignore[no-untyped-def]
    """Add the wrench of a round body on the part; update its `CONTACT`.

    body: place x and y, speed x and y, radius, compliance. now: time and step, s.
    """
    c, s = np.cos(pose[2]), np.sin(pose[2])
    radius, compliance = body[4], body[5]
    dx, dy = body[0] + contact[1] - pose[0], body[1] + contact[2] - pose[1]
    bx, by = c * dx + s * dy, c * dy - s * dx
    qx, qy, edge, distance = nearest(outline, bx, by)
    gap = distance - radius
    ox, oy = (qx - bx) / distance, (qy - by) / distance
    nx, ny = c * ox - s * oy, s * ox + c * oy
    rx, ry = c * qx - s * qy, s * qx + c * qy
    ux, uy = speed[0] - speed[2] * ry - body[2], speed[1] + speed[2] * rx - body[3]
    # The tip gives way together with the surface: springs in series, about the driven place.
    series = 1.0 + laws.stiffness * compliance
    drawn = pull(laws, gap, contact[3] > 0.0)
    overlap = -gap - contact[1] * nx - contact[2] * ny + compliance * drawn
    normal = laws.stiffness * overlap / series
    if normal > 0.0:
        contact[3] = 1.0
        normal -= laws.damping * (ux * nx + uy * ny) / series
    elif gap > laws.adhesion_range:
        contact[3] = 0.0
    normal = max(normal, 0.0)
    limit = friction(laws, edge, normal, now[0]) * normal
    slip = uy * nx - ux * ny
    # The tip's deflection turns with the contact, so that what it had counts, not what it gains.
    spring, had = TANGENTIAL * laws.stiffness, contact[2] * nx - contact[1] * ny
    trial = (contact[0] - spring * (slip * now[1] + had)) / (1.0 + spring * compliance)
    tangential = min(max(trial, -limit), limit)
    fx, fy = (normal - drawn) * nx - tangential * ny, (normal - drawn) * ny + tangential * nx
    contact[0], contact[4], contact[5], contact[6] = tangential, normal, gap, slip
    contact[1], contact[2] = -compliance * fx, -compliance * fy
    wrench[0] += fx
    wrench[1] += fy
    wrench[2] += rx * fy - ry * fx


@njit(cache=True)
def drive(laws, path, time, step, leg, lost, tip):  # type: ignore[no-untyped-def]
    """Take the tip to where it is driven at a time; the leg of its path at that time.

    lost: (2,) where lost motion leaves the tip. tip: as `touch` has it; its speed becomes the mean
    over the step.
    """
    while leg < len(path) - 2 and time > path[leg + 1, 0]:
        leg += 1
    share = (time - path[leg, 0]) / (path[leg + 1, 0] - path[leg, 0])
    half, phase = 0.5 * laws.backlash, laws.runout_rate * time + laws.runout_phase
    for k in range(2):
        command = path[leg, 1 + k] + share * (path[leg + 1, 1 + k] - path[leg, 1 + k])
        lost[k] = min(max(lost[k], command - half), command + half)
    x = lost[0] + laws.drift_x * time + laws.runout * np.cos(phase)
    y = lost[1] + laws.drift_y * time + laws.runout * np.sin(phase)
    tip[2], tip[3] = (x - tip[0]) / step, (y - tip[1]) / step
    tip[0], tip[1] = x, y
    return leg


@njit(cache=True)
def relax(laws, matrix, stretch, speed, step, wrench):  # type: ignore[no-untyped-def]
    """Add the elastic part of a Maxwell film's drag and let its stretch (3,) follow."""
    scale = laws.memory / laws.memory_time
    for k in range(3):
        for j in range(3):
            wrench[k] -= scale * matrix[k, j] * stretch[j]
    for k in range(3):
        stretch[k] += step * (speed[k] - stretch[k] / laws.memory_time)


@njit(cache=True)
def accelerate(inertia, inverse, wrench, step, speed):  # type: ignore[no-untyped-def]
    """Take the speed (3,) over a step, the film's resistance implicitly."""
    for k in range(3):
        wrench[k] = inertia[k] * speed[k] + step * wrench[k]
    for k in range(3):
        speed[k] = 0.0
        for j in range(3):
            speed[k] += inverse[k, j] * wrench[j]


@njit(cache=True)
def simulate(laws, outline, nodes, path, start, samples, step):  # type: ignore[no-untyped-def]
    """Poses (S, 3) at the sample times, and the tip's `CONTACT` (S, 7) there.

    Parameters
    ----------
    laws
        The physics.
    outline
        (V, 2) true corners of the part about its reference point, counter-clockwise.
    nodes
        (Q, 3) nodes of equal weight of the footprint, and the relative pressure there.
    path
        (K, 3) times and places of the corners of the commanded path of the tip.
    start
        (3,) pose at time 0, at rest.
    samples
        (S,) ascending times; before 0 the part is where it starts.
    step
        Time step, s.
    """
    pose, speed, wrench, now = start.copy(), np.zeros(3), np.zeros(3), np.array([0.0, step])
    inertia = laws.mass * np.array([1.0, 1.0, turning(outline)])
    age, matrix, load, inverse, stretch = (
        np.zeros(1),
        np.zeros((3, 3)),
        np.zeros(3),
        np.zeros((3, 3)),
        np.zeros(3),
    )
    lost = path[0, 1:].copy()
    tip = np.array([0.0, 0.0, 0.0, 0.0, laws.tip_radius, laws.compliance])
    post = np.array([laws.post_x, laws.post_y, 0.0, 0.0, laws.post_radius, 0.0])
    leg = drive(laws, path, 0.0, np.inf, 0, lost, tip)
    contact, post_contact = np.zeros(CONTACT), np.zeros(CONTACT)
    poses, contacts = np.empty((len(samples), 3)), np.empty((len(samples), CONTACT))
    taken, count = 0, 0
    while taken < len(samples):
        now[0] = count * step
        if count % RENEWAL == 0:
            film(laws, nodes, age, pose, speed, now, matrix, load)
            invert(matrix, (1.0 - laws.memory) * step, inertia, inverse)
        wrench[:] = load
        ambient(laws, pose, wrench)
        touch(laws, outline, pose, speed, tip, contact, now, wrench)
        if laws.post_radius > 0.0:
            touch(laws, outline, pose, speed, post, post_contact, now, wrench)
        if laws.memory > 0.0:
            relax(laws, matrix, stretch, speed, step, wrench)
        accelerate(inertia, inverse, wrench, step, speed)
        count += 1
        leg = drive(laws, path, count * step, step, leg, lost, tip)
        while taken < len(samples) and samples[taken] <= count * step:
            share = min(max(samples[taken] - now[0], 0.0), step) if samples[taken] > 0.0 else 0.0
            poses[taken] = pose + share * speed
            contacts[taken] = contact
            taken += 1
        pose += step * speed
    return poses, contacts


@njit(cache=True)
def turning(outline):  # type: ignore[no-untyped-def]
    """Square of the radius of gyration of a convex lamina about its reference point, um²."""
    area, second = 0.0, 0.0
    for k in range(len(outline)):
        a, b = outline[k], outline[(k + 1) % len(outline)]
        cross = a[0] * b[1] - a[1] * b[0]
        area += cross
        second += cross * (a @ a + a @ b + b @ b)
    return second / (6.0 * area)
