"""Turning about one sticking contact: how far, for how much travel."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence

from meso_robust.bounds import Box, Interval, Verdict, enclose, enclose_rows, prove_positive
from meso_robust.conditions import condition


def contact_offset(angle: Interval, depth: Interval, rise: Interval) -> Interval:
    """Where on the edge a tip touches.

    Parameters
    ----------
    angle
        Of the edge, rad; pi/2 stands upright to the push.
    depth
        Distance of the edge from the centre (d1), m.
    rise
        Height of the tip above the centre, across the push, m.

    Returns
    -------
    Interval
        Distance from the foot of the centre along the edge (d2), enclosed, m.
    """
    return contact_offsets([{"theta": angle, "d1": depth, "rise": rise}])[0]


def contact_offsets(places: Sequence[Box]) -> list[Interval]:
    """Where on the edge tips touch: as `contact_offset`, in far less time than one by one.

    Parameters
    ----------
    places
        The arguments of `contact_offset` in each case: ``theta``, ``d1`` and ``rise``.

    Returns
    -------
    list[Interval]
        One a case, m.
    """
    rows = enclose_rows(condition("sticking_motion", "contact_offset"), {}, places)
    return [row[0] for row in rows]


def contact_reach(angle: Interval, depth: Interval, rise: Interval) -> Interval:
    """How far ahead of the centre a tip touches.

    Parameters
    ----------
    angle
        Of the edge, rad; pi/2 stands upright to the push.
    depth
        Distance of the edge from the centre (d1), m.
    rise
        Height of the tip above the centre, across the push, m.

    Returns
    -------
    Interval
        x of the contact minus that of the centre, axes of the move, enclosed, m.
    """
    box = {"theta": angle, "d1": depth, "rise": rise}
    return enclose(condition("sticking_motion", "contact_reach"), box)[0]


def travel_monotone(
    path: Interval, side: int, depth: Interval, offset: Interval, ratio: Interval
) -> bool:
    """Whether the travel for a turn is proved to be monotone in the offset.

    Parameters
    ----------
    path
        All angles of the edge during the turn, rad.
    side
        1 for counter-clockwise, -1 for clockwise.
    depth
        Distance of the edge from the centre (d1), m.
    offset
        Of the contact along the edge (d2), m.
    ratio
        rho of the film, m^2.

    Returns
    -------
    bool
        True is a proof, False is none. That the part turns to ``side`` all along is proved as well:
        without it the bounds on the travel do not hold.
    """
    box = {
        "theta": path,
        "side": Interval.point(float(side)),
        "d1": depth,
        "d2": offset,
        "rho": ratio,
    }
    wanted = (
        condition("one_point_sticking", "turning"),
        condition("sticking_motion", "shortening"),
    )
    return all(prove_positive(of, box).verdict is Verdict.PROVED for of in wanted)


def _travel(start: float, end: float, depth: Interval, offset: float, ratio: float) -> Interval:
    box: Box = {
        "theta_start": Interval.point(start),
        "theta_end": Interval.point(end),
        "d1": depth,
        "d2": Interval.point(offset),
        "rho": Interval.point(ratio),
    }
    return enclose(condition("sticking_motion", "travel"), box, boxes=1)[0]


def turned(
    start: Interval,
    travel: Interval,
    side: int,
    depth: Interval,
    offset: Interval,
    ratio: Interval,
) -> Interval:
    """Enclose the angle after a travel in sticking contact.

    Parameters
    ----------
    start
        Angle of the edge at the touch, rad.
    travel
        From the touch on, m.
    side
        1 for counter-clockwise, -1 for clockwise.
    depth, offset, ratio
        Of the edge (d1, m), of the contact along it (d2, m), of the film (rho, m^2).

    Returns
    -------
    Interval
        rad; infinite on the far side if no bound is found. It holds where `travel_monotone` does.

    Notes
    -----
    A candidate end is a bound as soon as reaching it is proved to need more (less) travel than there can
    be; the closed form is only evaluated, never inverted.
    """
    if side > 0:
        far = _first_beyond(start.hi, side, travel.hi, depth, offset.hi, ratio.lo)
        near = _last_before(start.lo, side, travel.lo, depth, offset.lo, ratio.hi)
        return Interval(near, far)
    far = _first_beyond(start.lo, side, travel.hi, depth, offset.lo, ratio.lo)
    near = _last_before(start.hi, side, travel.lo, depth, offset.hi, ratio.hi)
    return Interval(far, near)


RESOLUTION = 1e-7  # rad: how closely the candidates bracket the end; not part of any proof
LARGEST_TURN = 0.6  # rad: candidates beyond it are not tried


def _first_beyond(
    start: float, side: int, travel: float, depth: Interval, offset: float, ratio: float
) -> float:
    """An angle that is proved to be out of reach, or infinity."""

    def more(turn: float) -> float:
        return _travel(start, start + side * turn, depth, offset, ratio).lo - travel

    most = more(LARGEST_TURN)
    if not most >= 0.0:
        return side * math.inf
    return start + side * _closing(more, most)[1]


def _last_before(
    start: float, side: int, travel: float, depth: Interval, offset: float, ratio: float
) -> float:
    """An angle that is proved to be reached (at worst the start)."""

    def less(turn: float) -> float:
        return _travel(start, start + side * turn, depth, offset, ratio).hi - travel

    most = less(LARGEST_TURN)
    return start + side * (_closing(less, most)[0] if most > 0.0 else LARGEST_TURN)


def _closing(of: Callable[[float], float], most: float) -> tuple[float, float]:
    """Turns close to each other: at the one it is not positive or there is none, at the other not negative.

    ``most`` is what it is at the largest turn.
    """
    low, high, least = 0.0, LARGEST_TURN, of(0.0)
    if least > 0.0:
        return 0.0, RESOLUTION if of(RESOLUTION) >= 0.0 else high
    for tried in itertools.count(1):
        if high - low <= RESOLUTION:
            break
        trial = 0.5 * (low + high)
        if tried % 4 and math.isfinite(
            most - least
        ):  # where the chord crosses zero, and a little to the side that is still open
            trial = low - least * (high - low) / (most - least)
            trial += math.copysign(0.4 * RESOLUTION, low + high - 2.0 * trial)
            trial = min(max(trial, low + 0.1 * RESOLUTION), high - 0.1 * RESOLUTION)
        value = of(trial)
        if value > 0.0:
            high, most = trial, value
        else:
            low, least = trial, value
    return low, high
