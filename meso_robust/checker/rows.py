"""Many boxes at once: intervals of doubles with their slopes, one column a box.

What ``dual.py`` does for one box in balls, for thousands of them in arrays. IEEE 754 rounds sums,
products, quotients and roots to the nearest double, off by at most 2^-53 of the result or, below the
least normal number, by less than :data:`TINY`; every end is moved outward by more than that. Where
nothing is known (a divisor that may be zero, a negative radicand) ends are infinite or not a number,
and a comparison with such an end is false: nothing is proved.

The first half of the columns are boxes, the second half their middles, so that every value is known
in two ways: as an interval, and by the mean value theorem from that at the middle and the slopes. A quantity
knows what it was worked out from; its slopes are asked for where they are needed, and then found from
the end back to the variables. Where several terms that cancel hang on one variable it is closer to settle
their sum first: what follows starts from its slopes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
from flint import arb

from meso_robust.checker.ranges import Box, Side, whole

Floats: TypeAlias = npt.NDArray[np.float64]
EPS = 2.0**-51
"""Relative; four times what rounding takes, as the end that is moved is rounded as well."""
TINY = 2.0**-800


@dataclass(frozen=True, slots=True, eq=False)
class Boxes:
    """Boxes of some variables, a row a variable and a column a box."""

    names: tuple[str, ...]
    low: Floats
    high: Floats

    @property
    def count(self) -> int:
        """How many there are."""
        return int(self.low.shape[1])

    def of(self, chosen: npt.NDArray[Any]) -> Boxes:
        """Some of them."""
        return Boxes(self.names, self.low[:, chosen], self.high[:, chosen])

    def points(self) -> dict[str, Rows]:
        """The variables, each with slope 1 along itself."""
        middle = np.clip(0.5 * (self.low + self.high), self.low, self.high)
        reach = _up(np.maximum(self.high - middle, middle - self.low))
        ends = np.array([np.hstack([-self.low, -middle]), np.hstack([self.high, middle])])
        return {
            name: Rows(ends[:, k], reach, own=Slopes(np.array([k]), ALONG))
            for k, name in enumerate(self.names)
        }

    def amid(self) -> Boxes:
        """Their middles, as boxes."""
        middle = np.clip(0.5 * (self.low + self.high), self.low, self.high)
        return Boxes(self.names, middle, middle)


@dataclass(frozen=True, slots=True, eq=False)
class Slopes:
    """Slopes of a quantity over boxes, along some of the variables; zero along the others."""

    places: npt.NDArray[np.int64]
    ends: Floats
    """(2, variables, boxes)"""


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Enclosures of a quantity, and what its slopes follow from (nothing of a constant)."""

    ends: Floats
    """Lower ends with their signs changed, and upper ends: both grow as an interval widens."""
    reach: Floats | None = None
    """By how much each variable differs from its middle at most."""
    links: tuple[Link, ...] = ()
    """Quantities that it was worked out from, with its slopes along them over the boxes."""
    own: Slopes | None = None
    """Slopes along variables, besides those by the links."""

    __array_ufunc__ = None  # so that an array on the left leaves the operation to this class

    @classmethod
    def constant(cls, value: Any) -> Rows:
        """The same number in every column, or one a column."""
        if isinstance(value, arb):
            return cls((np.zeros(2) if value.is_zero() else _around(value))[:, None])
        exact = np.asarray(value, dtype=np.float64).reshape(-1)
        return cls(np.array([-exact, exact]))

    @property
    def low(self) -> Floats:
        """Lower ends."""
        return -self.ends[0]

    @property
    def high(self) -> Floats:
        """Upper ends."""
        return self.ends[1]

    @property
    def over(self) -> Floats:
        """Ends over the boxes, middles left out."""
        return self.ends if self.reach is None else self.ends[:, : self.reach.shape[1]]

    def __neg__(self) -> Rows:
        return _made(self.ends[::-1], (self, -1))

    def __add__(self, other: Any) -> Rows:
        two = _rows(other)
        return _made(_outward(self.ends + two.ends), (self, 1), (two, 1))

    __radd__ = __add__

    def __sub__(self, other: Any) -> Rows:
        two = _rows(other)
        return _made(_outward(self.ends + two.ends[::-1]), (self, 1), (two, -1))

    def __rsub__(self, other: Any) -> Rows:
        return _rows(other) - self

    def __mul__(self, other: Any) -> Rows:
        if isinstance(other, int) and abs(other) == 1:
            return self if other > 0 else -self
        two = _rows(other)
        ends = _product(self.ends, two.ends)
        return _made(ends, (self, self._beside(two)), (two, two._beside(self)))

    __rmul__ = __mul__

    def _beside(self, other: Rows) -> Floats:
        """Ends of another factor over the boxes of this one."""
        if other.reach is None and self.reach is not None and other.ends.shape[1] > 1:
            return other.ends[:, : self.reach.shape[1]]
        return other.over

    def __truediv__(self, other: Any) -> Rows:
        return self * _rows(other)._inverse()

    def __rtruediv__(self, other: Any) -> Rows:
        return self._inverse() * other

    def _inverse(self) -> Rows:
        safe = (self.ends < 0).any(axis=0)
        ends = _outward(np.where(safe, -1 / self.ends[::-1], np.inf))
        over = self._beside(Rows(ends))
        # where there may be a pole the slope has no sign either
        slope = np.where(np.isfinite(over), _square(over)[::-1], np.inf)
        return _made(ends, (self, slope))

    def plain(self) -> Rows:
        """The value without its slopes."""
        return Rows(self.ends)

    def change(self) -> Rows:
        """The slopes, of the value zero."""
        return _made(np.zeros_like(self.ends), (self, 1))

    def moving(self, slopes: Rows) -> Rows:
        """The value with other slopes."""
        return _made(self.ends, (slopes, 1))

    def squared(self) -> Rows:
        """Its square, never negative."""
        return _made(_square(self.ends), (self, self.over * 2.0))

    def sqrt(self) -> Rows:
        """Square root; not a number where the radicand may be negative."""
        ends = _outward(np.array([-np.sqrt(-self.ends[0]), np.sqrt(self.ends[1])]))
        ends[0] = np.minimum(ends[0], 0.0)
        half = Rows(self._beside(Rows(ends)))._inverse() * 0.5
        return _made(ends, (self, half.ends))

    def sin_cos(self) -> tuple[Rows, Rows]:
        """Sine and cosine, from those of one angle amid all and the Taylor polynomials about it.

        Not a number where an angle is more than :data:`FAR` from it.
        """
        own = self.ends
        amid = float(0.5 * (own[1].max() - own[0].max()))
        s, c = (Ends(_around(part)[:, None]) for part in arb(amid).sin_cos())
        off = Ends(_outward(own + np.array([[amid], [-amid]])))
        near = np.where(off.ends.max(axis=0) < FAR, 0.0, np.nan)
        square = Ends(_square(off.ends))
        rest = np.full(own.shape, REMAINDER) + near
        sine, cosine = Ends(rest), Ends(rest)
        for n in range(TERMS, -1, -1):
            sine = sine * square + _factor(2 * n + 1, (-1) ** n)
            cosine = cosine * square + _factor(2 * n, (-1) ** n)
        sine = sine * off
        sin, cos = (Rows(one.ends) for one in (s * cosine + c * sine, c * cosine + -(s * sine)))
        return (
            _made(sin.ends, (self, self._beside(cos))),
            _made(cos.ends, (self, self._beside(sin)[::-1])),
        )

    def tan(self) -> Rows:
        """Tangent."""
        sine, cosine = self.sin_cos()
        return sine / cosine

    def settled(self) -> Rows:
        """The same, its slopes along variables worked out."""
        if self.reach is None or not self.links:
            return self
        return Rows(self.ends, self.reach, own=_backward(self, self.reach))

    def slopes(self) -> Floats:
        """Ends of the slopes along all variables: (2, variables, boxes)."""
        if self.reach is None:
            raise ValueError("a constant has no slopes")
        found, own = np.zeros((2, *self.reach.shape)), self.settled().own
        if own is not None:
            found[:, own.places] = own.ends
        return found

    def tight(self) -> Rows:
        """The same, the value over a box narrowed by that at its middle and the slopes."""
        if self.reach is None:
            return self
        settled, ends, count = self.settled(), self.ends.copy(), self.reach.shape[1]
        ends[:, :count] = np.minimum(ends[:, :count], settled.by_middle())
        return Rows(ends, self.reach, own=settled.own)

    def by_middle(self) -> Floats:
        """Both ends over each box by the mean value theorem, as in ``ends``."""
        own = self.settled().own
        if self.reach is None or own is None:
            raise ValueError("a constant has no middle")
        off = _up(own.ends.max(axis=0) * self.reach[own.places]).sum(axis=0)
        off = _up(off * (1.0 + len(self.reach) * EPS))
        return _outward(self.ends[:, self.reach.shape[1] :] + off)


def _made(ends: Floats, *sources: Link) -> Rows:
    """A quantity with slopes along what it is made from, as far as that is not constant."""
    links = tuple(link for link in sources if link[0].reach is not None)
    return Rows(ends, links[0][0].reach, links) if links else Rows(ends)


Slope: TypeAlias = "int | npt.NDArray[Any]"
"""1, -1, whether it is 1 or 0 in each box, or ends."""
Link: TypeAlias = tuple[Rows, Slope]
ONE = np.array([[-1.0], [1.0]])
"""Ends of the number 1."""
ALONG = ONE[:, None]
"""The slope of a variable along itself."""


def _backward(of: Rows, reach: Floats) -> Slopes:
    """Slopes along all variables: from a quantity back to what it was worked out from.

    Along each quantity on the way the slope is the sum of those along what was worked out from it, each times
    the slope of that along this one. So every quantity is passed once, however many variables there are.
    """
    found = np.zeros((2, *reach.shape))
    touched = np.zeros(len(reach), dtype=bool)
    weights: dict[int, Floats] = {id(of): ONE}
    for one in _from_last_to_first(of):
        weight = weights.pop(id(one))
        if one.own is not None:
            places, more = one.own.places, _along(weight, one.own.ends)
            if touched[places].any():
                more = _outward(found[:, places] + more)
            found[:, places], touched[places] = more, True
        for source, slope in one.links:
            more, known = _passed(weight, slope), weights.get(id(source))
            weights[id(source)] = more if known is None else _outward(known + more)
    places = np.flatnonzero(touched)
    return Slopes(places, found[:, places])


def _from_last_to_first(of: Rows) -> list[Rows]:
    """All that a quantity was worked out from, each before its own sources."""
    seen: set[int] = set()
    order: list[Rows] = []
    stack: list[tuple[Rows, bool]] = [(of, False)]
    while stack:
        one, done = stack.pop()
        if done:
            order.append(one)
        elif id(one) not in seen:
            seen.add(id(one))
            stack.append((one, True))
            stack += ((source, False) for source, _ in one.links)
    return order[::-1]


def _along(weight: Floats, slopes: Floats) -> Floats:
    """A slope along a quantity times the slopes of that along variables."""
    if slopes is ALONG:
        return weight[:, None]
    return slopes if weight is ONE else _product(weight[:, None], slopes)


def _passed(weight: Floats, slope: Slope) -> Floats:
    """A slope along a quantity passed on to one of its sources."""
    if isinstance(slope, int):
        return weight if slope > 0 else weight[::-1]
    if slope.dtype == bool:
        return np.where(slope, weight, 0.0)
    return slope if weight is ONE else _product(weight, slope)


FAR, TERMS = 0.5, 6
"""rad, and terms of a Taylor polynomial besides the first."""
REMAINDER = 1e-9
"""Bound of the first coefficients that are left out, 1/15! and 1/14!, with all that follow."""


def _factor(n: int, sign: int) -> Ends:
    """1/n! with a sign."""
    return Ends(_around(arb(sign) / math.factorial(n))[:, None])


def _around(value: arb) -> Floats:
    """Ends of the doubles around a number, as in :class:`Rows`."""
    low, high = float(value.lower()), float(value.upper())
    return np.array([-math.nextafter(low, -math.inf), math.nextafter(high, math.inf)])


def choose(first: npt.NDArray[np.bool_], one: Rows, other: Rows) -> Rows:
    """``one`` in some columns, ``other`` in the rest; both with slopes."""
    over = first[: len(first) // 2]
    return _made(np.where(first, one.ends, other.ends), (one, over), (other, ~over))


def _rows(value: Any) -> Rows:
    return value if isinstance(value, Rows) else Rows.constant(value)


def _outward(ends: Floats) -> Floats:
    """Ends of what was just worked out, moved outward in place."""
    off = np.abs(ends)
    off *= EPS
    off += TINY
    ends += off
    return ends


def _up(value: Floats) -> Floats:
    return np.asarray(value + (np.abs(value) * EPS + TINY))


def _product(one: Floats, other: Floats) -> Floats:
    """Ends of the products of two intervals."""
    # of unlike ends with their signs changed and of like ones; then the other way round
    first, second = one[0] * other[::-1], one[1] * other
    least = np.minimum(first, second)
    ends = np.maximum(first, second, out=first)
    np.maximum(ends, np.negative(least, out=least)[::-1], out=ends)
    return _outward(ends)


def _square(ends: Floats) -> Floats:
    """Ends of squares, never negative."""
    least = np.maximum(-ends.min(axis=0), 0.0)
    found = _outward(np.array([-least * least, np.square(ends.max(axis=0))]))
    found[0] = np.minimum(found[0], 0.0)
    return found


@dataclass(frozen=True, slots=True, eq=False)
class Ends:
    """Intervals without slopes, in arrays of any shape; ends as in :class:`Rows`."""

    ends: Floats

    @classmethod
    def exactly(cls, value: Floats) -> Ends:
        """Of numbers."""
        return cls(np.array([-value, value]))

    @classmethod
    def of(cls, values: Sequence[Rows]) -> Ends:
        """What some quantities can be, a row each."""
        every = np.broadcast_arrays(*(value.ends for value in values))
        return cls(np.stack(every, axis=1))

    def __neg__(self) -> Ends:
        return Ends(self.ends[::-1])

    def __add__(self, other: Ends) -> Ends:
        return Ends(_outward(self.ends + other.ends))

    def __mul__(self, other: Ends) -> Ends:
        return Ends(_product(other.ends, self.ends))

    def over(self, like: Rows) -> Ends:
        """Over the boxes of a quantity, middles left out."""
        if like.reach is None or self.ends.shape[-1] == 1:
            return self
        return Ends(self.ends[..., : like.reach.shape[1]])

    def row(self, k: int) -> Ends:
        """One row."""
        return Ends(self.ends[:, k])

    def rows(self) -> Ends:
        """All but the first."""
        return Ends(self.ends[:, 1:])

    def total(self) -> Ends:
        """Sums over the first axis."""
        found = self.row(0)
        for k in range(1, self.ends.shape[1]):
            found = found + self.row(k)
        return found


def joined(value: Ends, slopes: Mapping[int, Ends], like: Rows) -> Rows:
    """A quantity from its value and, over the boxes, those of its slopes that are not zero, by their places."""
    every = np.stack(np.broadcast_arrays(*(slope.ends for slope in slopes.values())), axis=1)
    return Rows(value.ends, like.reach, own=Slopes(np.array(list(slopes)), every))


EXACT = arb(1e-14)
"""Relative half width below which a range is as good as a number."""


def boxes_of(box: Box, count: int) -> tuple[Boxes, dict[str, Rows]]:
    """A box, so many times, and what is a number in it."""
    boxes, exact = boxes_of_all([box])
    return boxes.of(np.zeros(count, dtype=np.int64)), exact


def boxes_of_all(every: Sequence[Box]) -> tuple[Boxes, dict[str, Rows]]:
    """Boxes of the same variables, and what is one number in all of them."""
    first = every[0]
    wide = [
        name for name, s in first.items() if any(varies(b[name]) or b[name] != s for b in every)
    ]
    exact = {name: Rows.constant(whole(s)) for name, s in first.items() if name not in wide}
    low = np.array([[_below(box[name][0]) for box in every] for name in wide])
    high = np.array([[_above(box[name][1]) for box in every] for name in wide])
    return Boxes(tuple(wide), low, high), exact


def varies(side: Side) -> bool:
    """Whether a range is worth a variable of its own."""
    around = whole(side)
    return bool(around.rad() > abs(around.mid()) * EXACT)


def _below(value: arb) -> float:
    return math.nextafter(float(value.lower()), -math.inf)


def _above(value: arb) -> float:
    return math.nextafter(float(value.upper()), math.inf)


Of: TypeAlias = Callable[[Mapping[str, Rows], npt.NDArray[np.int64]], Rows]
"""A formula of the variables; for every column also which of the boxes it belongs to."""


def lowest(
    of: Of,
    boxes: Boxes,
    close: float,
    cuts: int,
    enough: float = np.inf,
    hopeless: float = -np.inf,
    groups: npt.NDArray[np.int64] | None = None,
) -> Floats:
    """Proved lower bounds of a formula, one a box or group; minus infinity where nothing was proved.

    Parameters
    ----------
    of, boxes
        The formula and the boxes of its variables.
    close
        How close to the least value a bound need not get closer.
    cuts
        How often a box may be cut in four.
    enough
        A bound above this needs no cut either.
    hopeless
        Where no more than this is attained it is told instead of a bound: the least value that was seen.
    groups
        Which of the groups 0, 1, ... each box belongs to; None: a group each.
    """
    which = np.arange(boxes.count)
    groups = which if groups is None else groups
    found, best = np.full((2, groups.max(initial=-1) + 1), np.inf)
    for left in range(cuts, -1, -1):
        seen = _seen(of, boxes, which)
        closer = seen.boxes
        # what can be narrowed is looked at again, if the whole box is not enough already and is not cut next
        moved = (closer.low != boxes.low) | (closer.high != boxes.high)
        again = moved.any(axis=0) & ~(seen.low > enough) & (left in (0, cuts))
        if again.any():
            seen.put(again, _seen(of, closer.of(again), which[again]))
        group = groups[which]
        np.minimum.at(best, group, seen.attained)
        least, weight = best[group], seen.steep * (closer.high - closer.low)
        more = (seen.low <= enough) & (least - seen.low > close) & (least > hopeless)
        more &= (weight.max(axis=0, initial=0.0) > 0) & (left > 0)
        np.minimum.at(found, group[~more], seen.low[~more])
        if not more.any():
            break
        boxes, which = quarters(closer.of(more), weight[:, more]), np.tile(which[more], 4)
    return np.where(best <= hopeless, best, found)


Plain: TypeAlias = Callable[[Mapping[str, Rows]], Rows]
"""A formula of the variables."""


def ends_of(of: Plain, box: Box, close: float, cuts: int) -> Side:
    """Proved lower and upper bound of a formula over a box.

    Parameters
    ----------
    of, box
        The formula and the box of its variables.
    close, cuts
        As of :func:`lowest`.

    Returns
    -------
    Side
        Exact numbers; infinite where nothing was proved.
    """
    low, most = _signed(of, [box, box], np.array([1.0, -1.0]), close, cuts)
    return low, -most


def most_of(of: Plain, every: Sequence[Box], close: float, cuts: int) -> list[arb]:
    """Proved upper bounds of a formula, one a box; the rest as of :func:`ends_of`."""
    return [-one for one in _signed(of, every, np.full(len(every), -1.0), close, cuts)]


def _signed(of: Plain, every: Sequence[Box], signs: Floats, close: float, cuts: int) -> list[arb]:
    """Proved lower bounds of a formula times a sign, one a box."""
    boxes, exact = boxes_of_all(every)

    def signed(at: Mapping[str, Rows], which: npt.NDArray[np.int64]) -> Rows:
        return of({**exact, **at}) * Rows.constant(signs[which])

    with np.errstate(all="ignore"):  # what is not a number proves nothing
        return [arb(float(low)) for low in lowest(signed, boxes, close, cuts)]


def quarters(boxes: Boxes, weight: Floats) -> Boxes:
    """Every box cut in four, along what matters most and along what does next."""
    half, rest = halves(boxes, weight), np.tile(weight, 2)
    best = weight.argmax(axis=0)
    rest[np.tile(best, 2), np.arange(half.count)] *= 0.5
    return halves(half, rest)


def halves(boxes: Boxes, weight: Floats) -> Boxes:
    """Every box cut in two where it matters most."""
    best, each = weight.argmax(axis=0), np.arange(boxes.count)
    middle = 0.5 * (boxes.low[best, each] + boxes.high[best, each])
    low, high = boxes.low.copy(), boxes.high.copy()
    high[best, each], low[best, each] = middle, middle
    ends = np.hstack([boxes.low, low]), np.hstack([high, boxes.high])
    return Boxes(boxes.names, *ends)


@dataclass(frozen=True, slots=True, eq=False)
class _Seen:
    """What one look at a formula over some boxes tells."""

    low: Floats
    """A lower bound in each."""
    attained: Floats
    """A value that is attained there."""
    steep: Floats
    """The steepest slopes."""
    boxes: Boxes
    """Where the least values are: a variable along which the formula is proved to grow or fall is put to
    the end where it is least."""

    def put(self, where: npt.NDArray[np.bool_], closer: _Seen) -> None:
        """What a look at some of the narrowed boxes tells instead."""
        self.low[where], self.attained[where] = closer.low, closer.attained
        self.steep[:, where] = closer.steep


AT_ONCE = 1024
"""Boxes that are looked at in one go: their arrays stay where they are worked at, in a cache."""


def _seen(of: Of, boxes: Boxes, which: npt.NDArray[np.int64]) -> _Seen:
    if boxes.count <= AT_ONCE:
        return _seen_at_once(of, boxes, which)
    every = np.arange(boxes.count)
    parts = [
        _seen_at_once(of, boxes.of(some), which[some])
        for some in np.array_split(every, math.ceil(boxes.count / AT_ONCE))
    ]
    return _Seen(
        np.hstack([one.low for one in parts]),
        np.hstack([one.attained for one in parts]),
        np.hstack([one.steep for one in parts]),
        Boxes(
            boxes.names,
            np.hstack([one.boxes.low for one in parts]),
            np.hstack([one.boxes.high for one in parts]),
        ),
    )


def _seen_at_once(of: Of, boxes: Boxes, which: npt.NDArray[np.int64]) -> _Seen:
    count = boxes.count
    value = of(boxes.points(), np.concatenate([which, which])).settled()
    slopes = value.slopes()
    grows, falls = slopes <= 0
    bound = -np.minimum(value.ends[0, :count], value.by_middle()[0])
    attained, steep = value.ends[1, count:], slopes.max(axis=0)
    return _Seen(
        np.where(np.isfinite(bound), bound, -np.inf),
        np.where(np.isfinite(attained), attained, np.inf),
        np.where(np.isfinite(steep), steep, 1e30),
        Boxes(
            boxes.names,
            np.where(falls & ~grows, boxes.high, boxes.low),
            np.where(grows, boxes.low, boxes.high),
        ),
    )
