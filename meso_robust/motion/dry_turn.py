"""Turning about one sticking tip on three dry support points, over a whole box.

There is no closed form. The rate of the turn is the only root of a moment that grows with it
(derivations/dry_sticking.py), so a rate at which the moment is proved positive or negative bounds
it; the turn is cut into arcs with one pair of bounds each.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from scipy.optimize import brentq

from meso_robust.bounds import Interval, Verdict, enclose, prove_positive
from meso_robust.conditions import condition, values
from meso_robust.errors import NotApplicableError

MODULE = "dry_sticking"
ARC = math.radians(0.25)  # finer arcs tighten the end little and cost time
LARGEST_TURN = 0.4  # rad: a turn that is not bounded by then is given up
SPARE = (
    0.01,
    0.03,
    0.1,
    0.3,
)  # shares of the rate by which bounds are tried beside the middle's root

Places = tuple[tuple[Interval, Interval], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class DryPush:
    """One tip that pushes a part on three dry points."""

    depth: Interval
    """Distance of the pushed edge from the centre of mass (d1), m."""
    offset: Interval
    """Of the contact along the edge at the touch (d2), m."""
    radius: Interval
    """Of the tip, m."""
    places: Places
    """Supports from the centre of mass, along the edge and along its outward normal, m."""
    friction: Interval
    """Between tip and part."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Arc:
    """A piece of the turn."""

    angles: Interval
    """rad"""
    rate: Interval
    """Turn per travel of all that can be there, rad/m; of one sign."""
    sticks: bool
    """Whether the contact is proved to stick, which excludes all other motions."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DryTurn:
    """What is proved of a turn."""

    end: Interval
    """Angle of the edge afterwards, rad; infinite where no bound was found."""
    arcs: tuple[Arc, ...]

    @property
    def sticks(self) -> bool:
        """Whether the tip is proved to stick all the way, to an end that is enclosed."""
        return self.end.width < math.inf and all(arc.sticks for arc in self.arcs)


def shares(places: Places) -> tuple[Interval, ...]:
    """Share of the weight on each support.

    Parameters
    ----------
    places
        As in :class:`DryPush`.

    Returns
    -------
    tuple
        Enclosed; they hold for a push at the height of the support plane.

    Raises
    ------
    NotApplicableError
        A support may carry nothing: the centre of mass may lie beside the triangle.
    """
    box = {
        f"{axis}_{j}": side
        for j, place in enumerate(places, 1)
        for axis, side in zip("xy", place, strict=True)
    }
    found = enclose(condition(MODULE, "shares"), box)
    if not all(share.lo > 0.0 for share in found):
        raise NotApplicableError(
            "supports: the centre of mass must lie between them over their whole ranges; give "
            "other places or narrower ranges"
        )
    return found


def turn_on_points(push: DryPush, start: Interval, travel: Interval, side: int) -> DryTurn:
    """Enclose the turn of a part by one tip on three dry points.

    Parameters
    ----------
    push
        Tip, edge, supports and their ranges; each is constant on the way, friction aside.
    start
        Angles of the edge at the touch, rad.
    travel
        Of the tip from the touch on, m.
    side
        1 for counter-clockwise, -1 for clockwise.

    Returns
    -------
    DryTurn
        The end, and on every arc the bounds on the rate and whether the tip sticks.

    Raises
    ------
    NotApplicableError
        A support may carry nothing.

    Notes
    -----
    The part that turns last starts at the near end of ``start`` and turns at the slower bound all the
    way; the one that turns first starts at the far end and turns at the faster bound. Each passes
    whole arcs, so its end is told to an arc, rounded away from the other.
    """
    shares(push.places)
    near, far = (start.lo, start.hi) if side > 0 else (start.hi, start.lo)
    arcs: list[Arc] = []
    longest, shortest = 0.0, 0.0  # travel that has been used, by the last one and by the first one
    last, first = near, None
    for angles in _arcs(near, side):
        rate = _rate(push, start, angles, side)
        if rate is None:
            break
        box = _box(push, start, angles) | {"omega": rate, "mu": push.friction}
        proof = prove_positive(condition(MODULE, "friction_margin"), box)
        arcs.append(Arc(angles=angles, rate=rate, sticks=proof.verdict is Verdict.PROVED))
        low, high = sorted((abs(rate.lo), abs(rate.hi)))
        width = Interval.point(angles.hi) - Interval.point(angles.lo)
        longest = (Interval.point(longest) + width / Interval.point(low)).hi
        if longest <= travel.lo:
            last = angles.hi if side > 0 else angles.lo
        begun = angles.lo >= far if side > 0 else angles.hi <= far
        if begun:
            shortest = (Interval.point(shortest) + width / Interval.point(high)).lo
        if begun and shortest >= travel.hi:
            first = angles.hi if side > 0 else angles.lo
            break
    if first is None:
        return DryTurn(end=Interval(-math.inf, math.inf), arcs=tuple(arcs))
    return DryTurn(end=Interval(min(last, first), max(last, first)), arcs=tuple(arcs))


def _arcs(start: float, side: int) -> Iterator[Interval]:
    at = start
    while abs(at - start) < LARGEST_TURN:
        after = at + side * ARC
        yield Interval(min(at, after), max(at, after))
        at = after


def _box(push: DryPush, start: Interval, angles: Interval) -> dict[str, Interval]:
    """What the balance depends on while the edge is at ``angles``: a round tip rolls along it."""
    box = {
        "theta": angles,
        "d1": push.depth,
        "d2": push.offset - push.radius * (angles - start),
    }
    for j, place in enumerate(push.places, 1):
        box |= {f"x_{j}": place[0], f"y_{j}": place[1]}
    return box


def _rate(push: DryPush, start: Interval, angles: Interval, side: int) -> Interval | None:
    """Turn per travel, rad/m, of all that can be at ``angles``; None if its sign is not ``side``."""
    box = _box(push, start, angles)
    moment = condition(MODULE, "moment")
    middle = {name: range_.mid for name, range_ in box.items()}

    def at(rate: float) -> float:
        return float(values(MODULE, "moment")(**middle, omega=rate)[0])

    most = side * 4.0 / push.depth.mid  # beyond any rate of a tip that drives the part before it
    if not at(0.0) * at(most) < 0.0:
        return None
    root = brentq(at, 0.0, most)
    ends = []
    for sign in (-1.0, 1.0):
        for spare in SPARE:
            trial = root * (1.0 + sign * spare)
            (found,) = enclose(moment, box | {"omega": Interval.point(trial)})
            if found.lo > 0.0 if trial > root else found.hi < 0.0:
                ends.append(trial)
                break
    return Interval(min(ends), max(ends)) if len(ends) == 2 else None
