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
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
from flint import arb

from meso_robust.checker.ranges import Box, Side, whole

Floats: TypeAlias = npt.NDArray[np.float64]
EPS = 2.0**-51
"""Relative; four times what rounding takes, as the end that is moved is rounded as well."""
TINY = 2.0**-1000


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

    def halfway(self, k: int) -> Boxes:
        """The same with one variable at its middle."""
        low, high = self.low.copy(), self.high.copy()
        low[k] = high[k] = 0.5 * (low[k] + high[k])
        return Boxes(self.names, low, high)

    def points(self) -> dict[str, Rows]:
        """The variables, each with slope 1 along itself."""
        middle = np.clip(0.5 * (self.low + self.high), self.low, self.high)
        reach = _up(np.maximum(self.high - middle, middle - self.low))
        slopes = np.eye(len(self.names))
        found = {}
        for k, name in enumerate(self.names):
            low, high = (np.concatenate([end[k], middle[k]]) for end in (self.low, self.high))
            own = np.broadcast_to(slopes[:, k, None], (len(self.names), 2 * self.count))
            stack = [np.concatenate([end[None], own]) for end in (low, high)]
            found[name] = Rows(stack[0], stack[1], reach)
        return found


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Enclosures of a quantity (first row) and its slopes (the others; none of a constant)."""

    low: Floats
    high: Floats
    reach: Floats | None = None
    """By how much each variable differs from its middle at most."""

    __array_ufunc__ = None  # so that an array on the left leaves the operation to this class

    @classmethod
    def constant(cls, value: Any) -> Rows:
        """The same number in every column, or one a column."""
        if isinstance(value, arb):
            zero = np.zeros((1, 1))
            ends = (zero, zero) if value.is_zero() else _around(value)
            return cls(*(end.reshape(1, 1) for end in ends))
        exact = np.asarray(value, dtype=np.float64).reshape(1, -1)
        return cls(exact, exact)

    def __neg__(self) -> Rows:
        return Rows(-self.high, -self.low, self.reach)

    def __add__(self, other: Any) -> Rows:
        one, two = self, _rows(other)
        if len(one.low) < len(two.low):
            one, two = two, one
        if len(two.low) == len(one.low):
            return Rows(*_outward(one.low + two.low, one.high + two.high), one.reach)
        low, high = _outward(one.low[:1] + two.low, one.high[:1] + two.high)
        width = low.shape[1]
        wide = (len(one.low) - 1, width)
        low, high = (
            np.concatenate([first, np.broadcast_to(end[1:], wide)])
            for first, end in ((low, one.low), (high, one.high))
        )
        return Rows(low, high, one.reach)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Rows:
        return self + -_rows(other)

    def __rsub__(self, other: Any) -> Rows:
        return -self + other

    def __mul__(self, other: Any) -> Rows:
        one, two = self, _rows(other)
        if len(one.low) < len(two.low):
            one, two = two, one
        first = two.low[:1]
        last = first if two.low is two.high else two.high[:1]
        low, high = _product(first, last, one.low, one.high)
        if len(two.low) > 1:
            less, more = _product(one.low[:1], one.high[:1], two.low[1:], two.high[1:])
            low[1:], high[1:] = _outward(low[1:] + less, high[1:] + more)
        return Rows(low, high, one.reach)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Rows:
        return self * _rows(other)._inverse()

    def __rtruediv__(self, other: Any) -> Rows:
        return self._inverse() * other

    def _inverse(self) -> Rows:
        low, high = self.low[:1], self.high[:1]
        safe = (low > 0) | (high < 0)
        ends = _outward(np.where(safe, 1 / high, -np.inf), np.where(safe, 1 / low, np.inf))
        own = Rows(*ends)
        return own if len(self.low) == 1 else self._chain(own, -own.squared())

    def _chain(self, value: Rows, slope: Rows) -> Rows:
        if len(self.low) == 1:
            return value
        less, more = _product(slope.low, slope.high, self.low[1:], self.high[1:])
        ends = np.concatenate([value.low, less]), np.concatenate([value.high, more])
        return Rows(*ends, self.reach)

    def plain(self) -> Rows:
        """The value without its slopes."""
        return Rows(self.low[:1], self.high[:1])

    def change(self) -> Rows:
        """The slopes, of the value zero."""
        zero = np.zeros((1, self.low.shape[1]))
        low, high = (np.concatenate([zero, end[1:]]) for end in (self.low, self.high))
        return Rows(low, high, self.reach)

    def moving(self, slopes: Rows) -> Rows:
        """The value with other slopes."""
        if len(slopes.low) == 1:
            return self.plain()
        width = max(self.low.shape[1], slopes.low.shape[1])
        ends = [
            np.concatenate([np.broadcast_to(a[:1], (1, width)), b[1:]])
            for a, b in ((self.low, slopes.low), (self.high, slopes.high))
        ]
        return Rows(ends[0], ends[1], slopes.reach)

    def squared(self) -> Rows:
        """Its square, never negative."""
        low, high = self.low[:1], self.high[:1]
        most = np.maximum(-low, high)
        least = np.maximum(np.maximum(low, -high), 0.0)
        less, more = _outward(least * least, most * most)
        own = Rows(np.where(least > 0, less, 0.0), more)
        return own if len(self.low) == 1 else self._chain(own, self.plain() * 2.0)

    def sqrt(self) -> Rows:
        """Square root; not a number where the radicand may be negative."""
        low, high = _outward(np.sqrt(self.low[:1]), np.sqrt(self.high[:1]))
        own = Rows(np.where(low < 0, 0.0, low), high)
        return own if len(self.low) == 1 else self._chain(own, 0.5 * own._inverse())

    def sin_cos(self) -> tuple[Rows, Rows]:
        """Sine and cosine, from those of one angle amid all and the Taylor polynomials about it.

        Not a number where an angle is more than :data:`FAR` from it.
        """
        ends = self.low[0], self.high[0]
        amid = float(0.5 * (ends[0].min() + ends[1].max()))
        s, c = (Ends(*_around(part)) for part in arb(amid).sin_cos())
        off = Ends(*_outward(ends[0] - amid, ends[1] - amid))
        reach = np.maximum(-off.low, off.high)
        near = np.where(reach < FAR, 0.0, np.nan)
        square = Ends(*(end[0] for end in (Rows(off.low[None], off.high[None]).squared().ends())))
        rest = REMAINDER * np.array([-1.0, 1.0])[:, None] + near
        sine, cosine = (Ends(rest[0], rest[1]), Ends(rest[0], rest[1]))
        for n in range(TERMS, -1, -1):
            sine = sine * square + _factor(2 * n + 1, (-1) ** n)
            cosine = cosine * square + _factor(2 * n, (-1) ** n)
        sine = sine * off
        both = s * cosine + c * sine, c * cosine + s * sine * MINUS
        sin, cos = (Rows(one.low[None], one.high[None]) for one in both)
        return self._chain(sin, cos), self._chain(cos, -sin)

    def tan(self) -> Rows:
        """Tangent."""
        sine, cosine = self.sin_cos()
        return sine / cosine

    def ends(self) -> tuple[Floats, Floats]:
        """Lower and upper ends."""
        return self.low, self.high

    def tight(self) -> Rows:
        """The same, the value over a box narrowed by that at its middle and the slopes."""
        if self.reach is None or len(self.low) == 1:
            return self
        low, high = self.low.copy(), self.high.copy()
        count = self.reach.shape[1]
        less, more = self.by_middle()
        low[0, :count] = np.maximum(low[0, :count], less)
        high[0, :count] = np.minimum(high[0, :count], more)
        return Rows(low, high, self.reach)

    def by_middle(self) -> tuple[Floats, Floats]:
        """Both ends over each box by the mean value theorem."""
        if self.reach is None:
            raise ValueError("a constant has no middle")
        count = self.reach.shape[1]
        steep = np.maximum(-self.low[1:, :count], self.high[1:, :count])
        off = _up(_up(steep * self.reach).sum(axis=0) * (1.0 + len(steep) * EPS))
        return _outward(self.low[0, count:] - off, self.high[0, count:] + off)


FAR, TERMS = 0.5, 6
"""rad, and terms of a Taylor polynomial besides the first."""
REMAINDER = 1e-9
"""Bound of the first coefficients that are left out, 1/15! and 1/14!, with all that follow."""
MINUS = np.array(-1.0)


def _factor(n: int, sign: int) -> Ends:
    """1/n! with a sign."""
    return Ends(*_around(arb(sign) / math.factorial(n)))


def _around(value: arb) -> tuple[Floats, Floats]:
    low, high = float(value.lower()), float(value.upper())
    return np.array(math.nextafter(low, -math.inf)), np.array(math.nextafter(high, math.inf))


def choose(first: npt.NDArray[np.bool_], one: Rows, other: Rows) -> Rows:
    """``one`` in some columns, ``other`` in the rest; both with slopes."""
    low, high = np.where(first, one.low, other.low), np.where(first, one.high, other.high)
    return Rows(low, high, one.reach)


def _rows(value: Any) -> Rows:
    return value if isinstance(value, Rows) else Rows.constant(value)


def _outward(low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Ends of what was just worked out, moved outward in place."""
    for end, move in ((low, np.subtract), (high, np.add)):
        off = np.abs(end)
        off *= EPS
        off += TINY
        move(end, off, out=end)
    return low, high


def _up(value: Floats) -> Floats:
    return np.asarray(value + (np.abs(value) * EPS + TINY))


def _product(a: Floats, b: Floats, c: Floats, d: Floats) -> tuple[Floats, Floats]:
    """Of the intervals from a to b and from c to d."""
    if a is b:
        p, q = a * c, a * d
        return _outward(np.minimum(p, q), np.maximum(p, q))
    p, q, r, s = a * c, a * d, b * c, b * d
    low, high = np.minimum(p, q), np.maximum(p, q)
    np.minimum(low, np.minimum(r, s, out=p), out=low)
    np.maximum(high, np.maximum(r, s, out=q), out=high)
    return _outward(low, high)


@dataclass(frozen=True, slots=True, eq=False)
class Ends:
    """Intervals without slopes, in arrays of any shape."""

    low: Floats
    high: Floats

    def __add__(self, other: Ends | Floats) -> Ends:
        two = other if isinstance(other, Ends) else Ends(other, other)
        return Ends(*_outward(self.low + two.low, self.high + two.high))

    def __mul__(self, other: Ends | Floats) -> Ends:
        two = other if isinstance(other, Ends) else Ends(other, other)
        return Ends(*_product(two.low, two.high, self.low, self.high))

    def row(self, k: int) -> Ends:
        """One row."""
        return Ends(self.low[k], self.high[k])

    def rows(self) -> Ends:
        """All but the first."""
        return Ends(self.low[1:], self.high[1:])

    def total(self) -> Ends:
        """Sums over the first axis."""
        found = Ends(self.low[0], self.high[0])
        for k in range(1, len(self.low)):
            found = found + Ends(self.low[k], self.high[k])
        return found


def ends_of(value: Rows) -> Ends:
    """What a quantity can be, without its slopes."""
    return Ends(value.low[0], value.high[0])


def joined(value: Ends, slopes: Mapping[int, Ends], like: Rows) -> Rows:
    """A quantity from its value and those of its slopes that are not zero, by their places."""
    low, high = np.zeros_like(like.low), np.zeros_like(like.low)
    low[0], high[0] = value.low, value.high
    for place, slope in slopes.items():
        low[1 + place], high[1 + place] = slope.low, slope.high
    return Rows(low, high, like.reach)


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
ROUGHLY = 0.3
"""How closely negative values are bounded, relative."""
NARROWED = 2
"""How often variables are put to their ends before a box is judged."""


def lowest(
    of: Of, boxes: Boxes, close: float, cuts: int, enough: float = np.inf, mean: int | None = None
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
        A bound above this needs no cut either, nor one that is about what it must be and negative.
    mean
        Place of a variable over whose box the mean of the formula is meant, whatever the others do
        meanwhile: with slopes between a and b that is the value at its middle, less at most (b - a)/8
        of its width, as with the slope a on one half and b on the other.
    """
    found, which = np.full(boxes.count, np.inf), np.arange(boxes.count)
    best = np.full(boxes.count, np.inf)
    for left in range(cuts, -1, -1):
        low, attained, boxes, steep = _judged(of, boxes, which, mean)
        np.minimum.at(best, which, attained)
        least, weight = best[which], steep * (boxes.high - boxes.low)
        if mean is not None:
            weight[mean] = 0.0
        more = (low <= enough) & (least - low > close)
        if np.isfinite(enough):
            more &= least - low > ROUGHLY * -least
        more &= (weight.max(axis=0, initial=0.0) > 0) & (left > 0)
        np.minimum.at(found, which[~more], low[~more])
        if not more.any():
            break
        boxes, which = halves(boxes.of(more), weight[:, more]), np.tile(which[more], 2)
    return found


def halves(boxes: Boxes, weight: Floats) -> Boxes:
    """Every box cut in two where it matters most."""
    best, each = weight.argmax(axis=0), np.arange(boxes.count)
    middle = 0.5 * (boxes.low[best, each] + boxes.high[best, each])
    low, high = boxes.low.copy(), boxes.high.copy()
    high[best, each], low[best, each] = middle, middle
    ends = np.hstack([boxes.low, low]), np.hstack([high, boxes.high])
    return Boxes(boxes.names, *ends)


def _judged(
    of: Of, boxes: Boxes, which: npt.NDArray[np.int64], mean: int | None
) -> tuple[Floats, Floats, Boxes, Floats]:
    """Lower bounds, values that are attained, and the parts of the boxes where the least values are.

    A variable along which the formula is proved to grow or fall is put to the end where it is least.
    """
    columns, count, every = np.concatenate([which, which]), boxes.count, boxes
    off = np.zeros(count)
    if mean is not None:
        slopes = of(boxes.points(), columns)
        off = _up(slopes.high[1 + mean, :count] - slopes.low[1 + mean, :count])
        off = _up(off * (boxes.high[mean] - boxes.low[mean]) / 8)
        boxes = boxes.halfway(mean)
    for left in range(NARROWED, -1, -1):
        value = of(boxes.points(), columns)
        grows, falls = value.low[1:, :count] >= 0, value.high[1:, :count] <= 0
        high = np.where(grows, boxes.low, boxes.high)
        low = np.where(falls & ~grows, boxes.high, boxes.low)
        if left == 0 or bool((low == boxes.low).all() and (high == boxes.high).all()):
            break
        boxes = Boxes(boxes.names, low, high)
    bound = np.maximum(value.low[0, :count], value.by_middle()[0])
    if mean is not None:
        bound = np.nextafter(bound - off, -np.inf)
    attained = value.high[0, count:] - off
    steep = np.maximum(-value.low[1:, :count], value.high[1:, :count])
    if mean is not None:
        steep = value.high[1:, :count] - value.low[1:, :count]
    return (
        np.where(np.isfinite(bound), bound, -np.inf),
        np.where(np.isfinite(attained), attained, np.inf),
        # the slopes along what is averaged must be those of the whole box
        boxes if mean is None else every,
        np.where(np.isfinite(steep), steep, 1e30),
    )
