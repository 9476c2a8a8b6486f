r"""Where on a curve the next event is: a contact that closes, or a quantity that turns negative.

Distances change no faster than the tip and the part move, so a search that goes ahead by the
distance over that speed cannot pass a contact, however small the corner (sphere tracing); only
steps below a small part of the curve are cut off.
"""

from typing import TypeAlias

import numpy as np

from meso_robust.kernels import inlined, sealed
from meso_robust.simulator.events.balance import monitor, velocity
from meso_robust.simulator.events.contact import Place, tip_in_body
from meso_robust.simulator.events.curve import place_at
from meso_robust.simulator.events.outline import (
    CONVEX,
    VX,
    VY,
    distance,
    distance_without,
)
from meso_robust.simulator.events.scene import BUSY, Scene, Work

NEGATIVE = -1e-11
"""What is below is an event; lengths and speeds in scaled units."""

Bound: TypeAlias = tuple[float, float, float, float, float, float]
"""Bound of the motion of the part on a curve: place of a point of it at the start and its constant
velocity (world frame), how fast the part turns about it at most, and the speed of what else there
is."""

_FAR = 0.2  # distance from the circle about the part that needs no measure of its own
_FINEST = 1.0 / 2048  # of the curve
_ROOT_STEPS = 60  # halvings alone would reach rounding in 53
_EXACT = 1e-15  # of the curve, and of a distance: rounding of numbers of order one


@inlined
def clearance(scene: Scene, work: Work, body: int, place: Place, clock: float) -> float:
    """Distance of a tip from the part, or of a corner of the part from the fixture.

    What it touches in a closed contact is left out. Far off it is a lower bound.
    """
    tips = scene.tips.shape[0]
    if body >= tips:
        return _corner_clearance(scene, work, body, place)
    cx, cy = tip_in_body(scene, body, place, clock)
    r = scene.tips[body, 4]
    if scene.left_out[body, BUSY]:
        return distance_without(scene.edges, scene.left_out[body], cx, cy) - r
    circle = np.sqrt(cx * cx + cy * cy) - work.reach - r
    return circle if circle > _FAR else distance(scene.edges, cx, cy) - r


@inlined
def _corner_clearance(scene: Scene, work: Work, body: int, place: Place) -> float:
    """Distance of a corner of the part from the fixture."""
    i = body - scene.tips.shape[0]
    if scene.edges[i, CONVEX] <= 0.0 or scene.walls.shape[0] == 0:
        return np.inf
    px, py = scene.edges[i, VX], scene.edges[i, VY]
    x = place[0] + place[2] * px - place[3] * py
    y = place[1] + place[3] * px + place[2] * py
    if scene.left_out[body, BUSY]:
        return distance_without(scene.walls, scene.left_out[body], x, y)
    return distance(scene.walls, x, y)


@sealed
def event_value(scene: Scene, work: Work, event: int, time: float, clock: float) -> float:
    """Value of the quantity of an event on the curve; clearances have negative numbers."""
    place = place_at(work, time)
    if event < 0:
        return clearance(scene, work, -1 - event, place, clock + time)
    velocity(scene, work, place, clock + time)
    monitor(scene, work, place, clock + time)
    return float(work.slack[event])


@sealed
def root(scene: Scene, work: Work, event: int, bracket: tuple[float, float], clock: float) -> float:
    """Instant in the bracket at which a quantity falls to zero (Illinois method)."""
    low, high = bracket
    f_high = event_value(scene, work, event, high, clock)
    f_low = event_value(scene, work, event, low, clock)
    if f_low <= _EXACT:  # it may grow from zero at the start, which is not where it falls to zero
        low, f_low = _positive(scene, work, event, bracket, clock)
        if f_low <= _EXACT:
            return low
    side = 0
    for _ in range(_ROOT_STEPS):
        if high - low <= _EXACT:
            break
        middle = low + (high - low) * f_low / (f_low - f_high)
        if not low < middle < high:
            middle = 0.5 * (low + high)
        f = event_value(scene, work, event, middle, clock)
        if abs(f) < _EXACT:
            return middle
        if f > 0.0:
            low, f_low = middle, f
            f_high *= 0.5 if side > 0 else 1.0
            side = 1
        else:
            high, f_high = middle, f
            f_low *= 0.5 if side < 0 else 1.0
            side = -1
    return high


@sealed
def _positive(
    scene: Scene, work: Work, event: int, bracket: tuple[float, float], clock: float
) -> tuple[float, float]:
    """Instant after the start of the bracket at which the quantity is positive, and its value."""
    low, high = bracket
    width = high - low
    for _ in range(40):
        width *= 0.5
        value = event_value(scene, work, event, low + width, clock)
        if value > _EXACT:
            return low + width, value
    return low, 0.0


@inlined
def _march(scene: Scene, work: Work, body: int, limit: tuple[float, float], clock: float) -> float:
    """Instant at which a tip or corner closes a contact, or infinity; `limit` is time and speed.

    Its distance at the start must be there.
    """
    end, speed = limit
    time, apart = 0.0, 0.0
    here = scene.clear[body]
    while time < end:
        if here >= speed * (end - time):
            scene.clear[body] = here - speed * (end - time)
            return np.inf
        ahead = min(time + max(here / speed, _FINEST * end), end)
        there = event_value(scene, work, -1 - body, ahead, clock)
        if there < NEGATIVE:
            return root(scene, work, -1 - body, (apart, ahead), clock)
        time, here = ahead, there
        apart = time if here > 0.0 else apart  # a step may end in the band that is no event yet
    scene.clear[body] = max(here, 0.0)
    return np.inf


@inlined
def _length(x: float, y: float) -> float:
    """Length of a vector of order one, in the plainest way."""
    return np.sqrt(x * x + y * y)


@inlined
def _closing(scene: Scene, work: Work, body: int, end: float, bound: Bound, clock: float) -> float:
    """Bound of the speed at which a body and what it may touch come closer on the curve."""
    x, y, vx, vy, turn, rest = bound
    if body >= scene.tips.shape[0]:
        return float(_length(vx, vy) + 2.0 * work.reach * turn + rest)
    tx, ty, ux, uy = (
        scene.tips[body, 0],
        scene.tips[body, 1],
        scene.tips[body, 2],
        scene.tips[body, 3],
    )
    own = _length(ux - vx, uy - vy)
    lever = _length(tx + ux * clock - x, ty + uy * clock - y) + own * end
    return float(own + turn * lever + rest)


@sealed
def next_contact(
    scene: Scene, work: Work, end: float, bound: Bound, clock: float
) -> tuple[float, int]:
    """First contact that closes on the curve.

    Parameters
    ----------
    scene, work
        The run.
    end
        Length of the curve on the clock.
    bound
        Of the motion of the part; see `Bound`.
    clock
        The clock at the start of the curve.

    Returns
    -------
    tuple
        The instant, counted from the start of the curve, and the number of the event; the end
        and 0 if there is none.
    """
    found = 0
    first = end
    start, known = (0.0, 0.0, 0.0, 0.0), False
    for body in range(scene.clear.shape[0]):
        speed = _closing(scene, work, body, first, bound, clock)
        way = speed * first
        if way == 0.0 or (scene.clear[body] > way):
            scene.clear[body] -= way
            continue
        if not known:
            start, known = place_at(work, 0.0), True
        scene.clear[body] = clearance(scene, work, body, start, clock)
        time = _march(scene, work, body, (first, speed), clock)
        if time < first:
            first, found = time, -1 - body
    return first, found
