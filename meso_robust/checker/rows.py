"""Many boxes at once: intervals of doubles with their slopes, one column a box.

What ``dual.py`` does for one box in balls, for thousands of them in arrays. IEEE 754 rounds sums,
products, quotients and roots to the nearest double, off by at most 2^-53 of the result or, below the
least normal number, by less than :data:`TINY`; every end is moved outward by more than that. Where
nothing is known (a divisor that may be zero, a negative radicand) ends are infinite or not a number,
and a comparison with such an end is false: nothing is proved.

The first half of the columns are boxes, the second half their middles, so that every value is known
in two ways: as an interval, and by the mean value theorem from that at the middle and the slopes.
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
        found = {}
        for k, name in enumerate(self.names):
            own = np.zeros((2, 1 + len(self.names), 2 * self.count))
            own[:, 0], own[0, 1 + k], own[1, 1 + k] = ends[:, k], -1.0, 1.0
            found[name] = Rows(own, reach)
        return found


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Enclosures of a quantity (first row) and its slopes (the others; none of a constant)."""

    ends: Floats
    """Lower ends with their signs changed, and upper ends: both grow as an interval widens."""
    reach: Floats | None = None
    """By how much each variable differs from its middle at most."""

    __array_ufunc__ = None  # so that an array on the left leaves the operation to this class

    @classmethod
    def constant(cls, value: Any) -> Rows:
        """The same number in every column, or one a column."""
        if isinstance(value, arb):
            ends = np.zeros((2, 1)) if value.is_zero() else _around(value)
            return cls(ends.reshape(2, 1, 1))
        exact = np.asarray(value, dtype=np.float64).reshape(1, -1)
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
    def single(self) -> bool:
        """Whether there are no slopes."""
        return self.ends.shape[1] == 1

    def __neg__(self) -> Rows:
        return Rows(self.ends[::-1], self.reach)

    def __add__(self, other: Any) -> Rows:
        one, two = self, _rows(other)
        if one.ends.shape[1] < two.ends.shape[1]:
            one, two = two, one
        if two.ends.shape[1] == one.ends.shape[1]:
            return Rows(_outward(one.ends + two.ends), one.reach)
        value = _outward(one.ends[:, :1] + two.ends)
        return Rows(_with_slopes(value, one.ends[:, 1:]), one.reach)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Rows:
        return self + -_rows(other)

    def __rsub__(self, other: Any) -> Rows:
        return -self + other

    def __mul__(self, other: Any) -> Rows:
        if isinstance(other, int | float):
            ends = self.ends if other >= 0 else self.ends[::-1]
            return Rows(_outward(ends * abs(other)), self.reach)
        one, two = self, _rows(other)
        if one.ends.shape[1] < two.ends.shape[1]:
            one, two = two, one
        ends = _product(two.ends[:, :1], one.ends)
        if not two.single:
            slopes = ends[:, 1:]
            slopes += _product(one.ends[:, :1], two.ends[:, 1:])
            _outward(slopes)
        return Rows(ends, one.reach)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Rows:
        return self * _rows(other)._inverse()

    def __rtruediv__(self, other: Any) -> Rows:
        return self._inverse() * other

    def _inverse(self) -> Rows:
        ends = self.ends[:, :1]
        safe = (ends < 0).any(axis=0)
        own = Rows(_outward(np.where(safe, -1 / ends[::-1], np.inf)))
        return own if self.single else self._chain(own, -own.squared())

    def _chain(self, value: Rows, slope: Rows) -> Rows:
        if self.single:
            return value
        return Rows(_with_slopes(value.ends, _product(slope.ends, self.ends[:, 1:])), self.reach)

    def plain(self) -> Rows:
        """The value without its slopes."""
        return Rows(self.ends[:, :1])

    def change(self) -> Rows:
        """The slopes, of the value zero."""
        ends = self.ends.copy()
        ends[:, 0] = 0.0
        return Rows(ends, self.reach)

    def moving(self, slopes: Rows) -> Rows:
        """The value with other slopes."""
        if slopes.single:
            return self.plain()
        return Rows(_with_slopes(self.ends[:, :1], slopes.ends[:, 1:]), slopes.reach)

    def squared(self) -> Rows:
        """Its square, never negative."""
        ends = self.ends[:, :1]
        least = np.maximum(-ends.min(axis=0), 0.0)
        own = _outward(np.array([-least * least, np.square(ends.max(axis=0))]))
        own[0] = np.where(least > 0, own[0], 0.0)
        value = Rows(own)
        return value if self.single else self._chain(value, self.plain() * 2)

    def sqrt(self) -> Rows:
        """Square root; not a number where the radicand may be negative."""
        low, high = -self.ends[0, :1], self.ends[1, :1]
        own = _outward(np.array([-np.sqrt(low), np.sqrt(high)]))
        own[0] = np.where(own[0] > 0, 0.0, own[0])
        value = Rows(own)
        return value if self.single else self._chain(value, value._inverse() * 0.5)

    def sin_cos(self) -> tuple[Rows, Rows]:
        """Sine and cosine, from those of one angle amid all and the Taylor polynomials about it.

        Not a number where an angle is more than :data:`FAR` from it.
        """
        own = self.ends[:, 0]
        amid = float(0.5 * (own[1].max() - own[0].max()))
        s, c = (Ends(_around(part)[:, None]) for part in arb(amid).sin_cos())
        off = Ends(_outward(own + np.array([[amid], [-amid]])))
        reach = off.ends.max(axis=0)
        near = np.where(reach < FAR, 0.0, np.nan)
        square = Ends(Rows(off.ends[:, None]).squared().ends[:, 0])
        rest = np.full(own.shape, REMAINDER) + near
        sine, cosine = Ends(rest), Ends(rest)
        for n in range(TERMS, -1, -1):
            sine = sine * square + _factor(2 * n + 1, (-1) ** n)
            cosine = cosine * square + _factor(2 * n, (-1) ** n)
        sine = sine * off
        both = s * cosine + c * sine, c * cosine + -(s * sine)
        sin, cos = (Rows(one.ends[:, None]) for one in both)
        return self._chain(sin, cos), self._chain(cos, -sin)

    def tan(self) -> Rows:
        """Tangent."""
        sine, cosine = self.sin_cos()
        return sine / cosine

    def tight(self) -> Rows:
        """The same, the value over a box narrowed by that at its middle and the slopes."""
        if self.reach is None or self.single:
            return self
        ends, count = self.ends.copy(), self.reach.shape[1]
        ends[:, 0, :count] = np.minimum(ends[:, 0, :count], self.by_middle())
        return Rows(ends, self.reach)

    def by_middle(self) -> Floats:
        """Both ends over each box by the mean value theorem, as in ``ends``."""
        if self.reach is None:
            raise ValueError("a constant has no middle")
        count = self.reach.shape[1]
        off = _up(self.steepest(count) * self.reach).sum(axis=0)
        off = _up(off * (1.0 + len(self.reach) * EPS))
        return _outward(self.ends[:, 0, count:] + off)

    def steepest(self, count: int) -> Floats:
        """Largest absolute values of the slopes over the first boxes."""
        return np.asarray(self.ends[:, 1:, :count].max(axis=0))


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
    return Rows(np.where(first, one.ends, other.ends), one.reach)


def _rows(value: Any) -> Rows:
    return value if isinstance(value, Rows) else Rows.constant(value)


def _with_slopes(value: Floats, slopes: Floats) -> Floats:
    """Ends of a value and of its slopes in one array; either may be the same in every column."""
    wide = max(value.shape[2], slopes.shape[2])
    ends = np.empty((2, 1 + slopes.shape[1], wide))
    ends[:, :1], ends[:, 1:] = value, slopes
    return ends


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
    # the products of unlike ends with their signs changed, and of like ends
    every = one * other[PAIRED]
    first, second = every[:, 0], every[:, 1]
    ends, least = np.maximum(first, second), np.minimum(first, second)
    np.maximum(ends, np.negative(least, out=least)[::-1], out=ends)
    return _outward(ends)


PAIRED = np.array([[1, 0], [0, 1]])


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
        every = np.broadcast_arrays(*(value.ends[:, 0] for value in values))
        return cls(np.stack(every, axis=1))

    def __neg__(self) -> Ends:
        return Ends(self.ends[::-1])

    def __add__(self, other: Ends) -> Ends:
        return Ends(_outward(self.ends + other.ends))

    def __mul__(self, other: Ends) -> Ends:
        return Ends(_product(other.ends, self.ends))

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
    """A quantity from its value and those of its slopes that are not zero, by their places."""
    ends = np.zeros_like(like.ends)
    ends[:, 0] = value.ends
    for place, slope in slopes.items():
        ends[:, 1 + place] = slope.ends
    return Rows(ends, like.reach)


EXACT = arb(1e-14)
"""Relative half width below which a range is as good as a number."""


def boxes_of(box: Box, count: int) -> tuple[Boxes, dict[str, Rows]]:
    """A box, so many times, and what is a number in it."""
    wide = {name: ends for name, ends in box.items() if varies(ends)}
    exact = {name: Rows.constant(whole(s)) for name, s in box.items() if name not in wide}
    ends = np.array([[_below(low), _above(high)] for low, high in wide.values()])
    low, high = (np.repeat(ends[:, end, None], count, axis=1) for end in (0, 1))
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
    of: Of, boxes: Boxes, close: float, cuts: int, enough: float = np.inf, rough: float = 0.0
) -> Floats:
    """Proved lower bounds of a formula, one a box; minus infinity where nothing was proved.

    Parameters
    ----------
    of, boxes
        The formula and the boxes of its variables.
    close
        How close to the least value a bound need not get closer.
    cuts
        How often a box may be cut in two.
    enough
        A bound above this needs no cut either.
    rough
        Nor does one that is within this share of a negative least value.
    """
    found, which = np.full(boxes.count, np.inf), np.arange(boxes.count)
    best = np.full(boxes.count, np.inf)
    for left in range(cuts, -1, -1):
        seen = _seen(of, boxes, which)
        closer = seen.boxes
        # what can be narrowed is looked at again, if the whole box is not enough already
        moved = (closer.low != boxes.low) | (closer.high != boxes.high)
        again = moved.any(axis=0) & ~(seen.low > enough)
        if again.any():
            seen.put(again, _seen(of, closer.of(again), which[again]))
        np.minimum.at(best, which, seen.attained)
        least, weight = best[which], seen.steep * (closer.high - closer.low)
        more = (seen.low <= enough) & (least - seen.low > np.fmax(close, rough * -least))
        more &= (weight.max(axis=0, initial=0.0) > 0) & (left > 0)
        np.minimum.at(found, which[~more], seen.low[~more])
        if not more.any():
            break
        boxes, which = halves(closer.of(more), weight[:, more]), np.tile(which[more], 2)
    return found


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


AT_ONCE = 128
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
    value = of(boxes.points(), np.concatenate([which, which]))
    grows, falls = (end <= 0 for end in value.ends[:, 1:, :count])
    bound = -np.minimum(value.ends[0, 0, :count], value.by_middle()[0])
    attained, steep = value.ends[1, 0, count:], value.steepest(count)
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
