r"""Where on a curve the next event is: a contact that closes, or a quantity that turns negative.

Distances change no faster than the tip and the part move, so a search that goes ahead by the
distance over that speed cannot pass a contact, however small the corner (sphere tracing); only
steps below a small part of the curve are cut off.
"""

import numpy as np

from meso_robust.simulator.events.balance import monitor, velocity
from meso_robust.simulator.events.closing import speed_between
from meso_robust.simulator.events.contact import Place, tip_in_body
from meso_robust.simulator.events.curve import place_at
from meso_robust.simulator.events.fused import inlined, sealed
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

_FAR = 0.2  # distance from the circle about the part that needs no measure of its own
_FINEST = 1.0 / 2048  # of the curve
_SECTION = 4.0  # of a distance over the speed: as far ahead as a step looks for its own
_BOLD = 0.95  # of the longest step that two distances would cover if they changed evenly
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
    return _between(scene, work, event, (low, f_low, high, f_high), clock)


@sealed
def _between(
    scene: Scene, work: Work, event: int, bracket: tuple[float, float, float, float], clock: float
) -> float:
    """The same for a bracket given with the values at its ends, each after its instant."""
    low, f_low, high, f_high = bracket
    if f_low <= _EXACT:  # it may grow from zero at the start, which is not where it falls to zero
        low, f_low = _positive(scene, work, event, (low, high), clock)
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

    Its distance at the start must be there. A step may be longer than the distance allows if there
    is so much left at its end that the two distances cover it (Keinert and others, *Enhanced sphere
    tracing*, 2014).
    """
    end, fastest = limit
    time, here = 0.0, scene.clear[body]
    apart, f_apart = 0.0, here
    rate = fastest  # at which it came closer last
    while time < end:
        if here >= fastest * (end - time):
            scene.clear[body] = here - fastest * (end - time)
            return np.inf
        until = min(time + _SECTION * here / fastest, end)
        speed = speed_between(scene, work, body, (time, until), clock)
        speed = min(fastest, speed + _EXACT * fastest)  # never nothing, by which steps are divided
        safe = max(here / speed, _FINEST * end)
        step = max(_BOLD * 2.0 * here / (speed + min(rate, speed)), safe)
        step = min(step, max(until - time, _FINEST * end))
        ahead = min(time + step, end)
        there = event_value(scene, work, -1 - body, ahead, clock)
        if there < speed * step - here and step > safe:
            step, ahead = 0.0, min(time + safe, end)
            there = event_value(scene, work, -1 - body, ahead, clock)
        if there < NEGATIVE:
            return _between(scene, work, -1 - body, (apart, f_apart, ahead, there), clock)
        rate = min(max((here - there) / (ahead - time), 0.0), speed) if step > 0.0 else speed
        time, here = ahead, there
        if here > 0.0:  # a step may end in the band that is no event yet
            apart, f_apart = time, here
    scene.clear[body] = max(here, 0.0)
    return np.inf


@sealed
def next_contact(scene: Scene, work: Work, end: float, clock: float) -> tuple[float, int]:
    """First contact that closes on the curve.

    Parameters
    ----------
    scene, work
        The run; the bounds of `closing` must be there.
    end
        Length of the curve on the clock.
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
        speed = scene.closing[body]
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
