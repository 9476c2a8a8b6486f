"""Corners of a polygon in exact rational numbers: what makes an outline, and its convex hull."""

from __future__ import annotations

import itertools
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
