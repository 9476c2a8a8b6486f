"""Corners of a polygon in exact rational numbers: an outline, its hull, and its edges as made."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from fractions import Fraction

Corner = tuple[Fraction, Fraction]


def bend(p: Corner, q: Corner, r: Corner) -> Fraction:
    """Twice the area of the triangle, positive if its corners run counter-clockwise."""
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])


def hull(corners: Sequence[Corner]) -> tuple[int, ...]:
    """Which corners are those of the convex hull, counter-clockwise (monotone chain).

    Corners on a side of the hull are left out.

    Parameters
    ----------
    corners
        Any number, in any order; exact numbers give an exact answer.

    Returns
    -------
    tuple
        Indices into ``corners``, from the lowest one on.

    Examples
    --------
    >>> hull([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)])
    (0, 1, 2, 4, 5)
    """
    order = sorted(range(len(corners)), key=lambda k: corners[k])
    lower, upper = _half(corners, order), _half(corners, order[::-1])
    found = [*lower[:-1], *upper[:-1]]
    first = found.index(min(found))
    return (*found[first:], *found[:first])


def _half(corners: Sequence[Corner], order: Sequence[int]) -> list[int]:
    found: list[int] = []
    for k in order:
        while len(found) > 1 and bend(*(corners[i] for i in (*found[-2:], k))) <= 0:
            found.pop()
        found.append(k)
    return found


def fault(corners: Sequence[Corner]) -> str | None:
    """What forbids corners as the outline of a part about the origin, or None.

    Parameters
    ----------
    corners
        At least three, in um.

    Returns
    -------
    str or None
        The first fault as "what; rule; advice".
    """
    count = len(corners)
    for k in range(count):
        p, q, r = (corners[(k + step) % count] for step in range(3))
        if max(abs(q[0] - p[0]), abs(q[1] - p[1])) < 1:
            return (
                f"corners {k} and {(k + 1) % count} are less than 1 um apart; must differ; leave "
                "one out"
            )
        if bend(p, q, r) == 0:
            return (
                f"corner {(k + 1) % count} lies on the line through its neighbours; must bend the "
                "outline; leave it out"
            )
    return _crossing(corners) or _order(corners) or _around_origin(corners)


def _crossing(corners: Sequence[Corner]) -> str | None:
    count = len(corners)
    sides = [(corners[k], corners[(k + 1) % count]) for k in range(count)]
    for i, j in itertools.combinations(range(count), 2):
        neighbours = j - i in (1, count - 1)
        if not neighbours and _meet(*sides[i], *sides[j]):
            return (
                f"the sides after corners {i} and {j} touch or cross; must meet only at a common "
                "corner; give the corners in their order along the outline"
            )
    return None


def _meet(a: Corner, b: Corner, c: Corner, d: Corner) -> bool:
    """Whether two segments have a point in common."""
    apart = (
        max(p[k] for p in one) < min(p[k] for p in other)
        for k in (0, 1)
        for one, other in (((a, b), (c, d)), ((c, d), (a, b)))
    )
    if any(apart):
        return False
    return bend(a, b, c) * bend(a, b, d) <= 0 and bend(c, d, a) * bend(c, d, b) <= 0


def _order(corners: Sequence[Corner]) -> str | None:
    origin = (Fraction(0), Fraction(0))
    pairs = zip(corners, (*corners[1:], corners[0]), strict=True)
    if sum(bend(origin, p, q) for p, q in pairs) > 0:
        return None
    return "the corners run clockwise; must run counter-clockwise; reverse their order"


def _around_origin(corners: Sequence[Corner]) -> str | None:
    origin = (Fraction(0), Fraction(0))
    around = hull(corners)
    for i, j in zip(around, (*around[1:], around[0]), strict=True):
        if bend(origin, corners[i], corners[j]) <= 0:
            return (
                "the reference point, the origin, lies outside the convex hull; must be the centre "
                "of drag, which lies within it; subtract the centre of drag from the corners"
            )
    return None


def straight_edges(
    corners: Sequence[Corner], moved: float, turned: float, rounded: float
) -> list[float]:
    """What is left of each edge of a part as made, at worst: for a message, no proof rests on it.

    Parameters
    ----------
    corners
        As stated, about the reference point, counter-clockwise.
    moved
        How far each edge's line may lie from its place, along its own normal, in the corners' unit.
    turned
        By how much each edge may be turned, rad.
    rounded
        Largest radius of the corners, in the corners' unit.

    Returns
    -------
    list
        Least length between the rounded ends of the edge after each corner; not positive where the edge
        can vanish, -inf where its neighbour can become parallel to it.
    """
    sides = [
        (float(q[0] - p[0]), float(q[1] - p[1]), float(p[0] * q[1] - p[1] * q[0]))
        for p, q in zip(corners, (*corners[1:], corners[0]), strict=True)
    ]
    depths = [area / math.hypot(x, y) for x, y, area in sides]
    bends = [  # at the corner before each edge
        math.atan2(u * y - v * x, u * x + v * y)
        for (u, v, _), (x, y, _) in zip((sides[-1], *sides), sides, strict=False)
    ]
    count = len(corners)
    found = []
    for k in range(count):
        before, after = k - 1, (k + 1) % count
        found.append(
            min(
                _least_reach(
                    depths[k] + own, depths[before], bends[k] + skew, moved, turned, rounded
                )
                + _least_reach(
                    depths[k] + own, depths[after], bends[after] - skew, moved, turned, rounded
                )
                for own, skew in itertools.product((-moved, moved), (-turned, 0.0, turned))
            )
        )
    return found


def _least_reach(
    depth: float, beside: float, bend: float, moved: float, turned: float, rounded: float
) -> float:
    """From the foot of the reference point on an edge to its rounded end, where ``beside`` follows."""
    low, high = bend - turned, bend + turned
    if not (math.sin(low) * math.sin(high) > 0.0 and high - low < math.pi):
        return -math.inf
    found = []
    for far in (beside - moved, beside + moved):
        angles = [low, high]
        if abs(depth) < abs(far):  # the nearest end may lie between the two
            angles.append(min(max(math.copysign(math.acos(depth / far), bend), low), high))
        found += [
            (far - depth * math.cos(at)) / math.sin(at) - rounded * math.tan(abs(at) / 2)
            for at in angles
        ]
    return min(found)
