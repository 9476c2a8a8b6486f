"""Balls with their partial derivatives: forward differentiation in Arb's arithmetic.

Each operation encloses the value and every first derivative over the whole box of its arguments.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from typing import Any, TypeAlias, TypeVar

from flint import arb

Slopes: TypeAlias = Mapping[str, arb]
_NONE: Slopes = {}


class Dual:
    """A value and its slopes with respect to named variables."""

    __slots__ = ("slopes", "value")

    def __init__(self, value: arb, slopes: Slopes = _NONE) -> None:
        self.value = value
        self.slopes = slopes

    def through(self, value: arb, slope: arb) -> Dual:
        """A function of it that has this value and this slope over the ball."""
        mine = self.slopes
        return Dual(value, {key: slope * own for key, own in mine.items()} if mine else mine)

    def __neg__(self) -> Dual:
        return Dual(-self.value, _minus(self.slopes))

    def __add__(self, other: Number) -> Dual:
        if not isinstance(other, Dual):
            return Dual(self.value + other, self.slopes)
        return Dual(self.value + other.value, _sum(self.slopes, other.slopes))

    __radd__ = __add__

    def __sub__(self, other: Number) -> Dual:
        if not isinstance(other, Dual):
            return Dual(self.value - other, self.slopes)
        mine, more = self.slopes, other.slopes
        if not more:
            return Dual(self.value - other.value, mine)
        found = dict(mine)
        for key, own in more.items():
            found[key] = found[key] - own if key in found else -own
        return Dual(self.value - other.value, found)

    def __rsub__(self, other: arb | int) -> Dual:
        return Dual(other - self.value, _minus(self.slopes))

    def __mul__(self, other: Number) -> Dual:
        mine = self.slopes
        if not isinstance(other, Dual):
            more: Slopes = {k: own * other for k, own in mine.items()} if mine else _NONE
            return Dual(self.value * other, more)
        p, q, more = self.value, other.value, other.slopes
        if not mine:
            return Dual(p * q, {key: p * own for key, own in more.items()} if more else _NONE)
        found = {key: q * own for key, own in mine.items()}
        for key, own in more.items():
            found[key] = found[key] + p * own if key in found else p * own
        return Dual(p * q, found)

    __rmul__ = __mul__

    def __truediv__(self, other: Number) -> Dual:
        if not isinstance(other, Dual):
            return Dual(self.value / other, {k: own / other for k, own in self.slopes.items()})
        return self * other._inverse()

    def __rtruediv__(self, other: arb | int) -> Dual:
        return self._inverse() * other

    def _inverse(self) -> Dual:
        value = 1 / self.value
        return self.through(value, -_square(value))

    def squared(self) -> Dual:
        """Its square, never negative."""
        return self.through(_square(self.value), 2 * self.value)

    def sin_cos(self) -> tuple[Dual, Dual]:
        """Sine and cosine."""
        s, c = self.value.sin_cos()
        return self.through(s, c), self.through(c, -s)

    def tan(self) -> Dual:
        """Tangent."""
        value = self.value.tan()
        return self.through(value, 1 + _square(value))

    def atan(self) -> Dual:
        """Inverse tangent."""
        return self.through(self.value.atan(), 1 / (1 + _square(self.value)))

    def asin(self) -> Dual:
        """Inverse sine; not finite beyond -1 and 1."""
        return self.through(self.value.asin(), 1 / (1 - _square(self.value)).sqrt())

    def sqrt(self) -> Dual:
        """Square root; not finite where the radicand may be negative."""
        value = self.value.sqrt()
        return self.through(value, 1 / (2 * value))

    def asinh(self) -> Dual:
        """Inverse hyperbolic sine."""
        return self.through(self.value.asinh(), 1 / (1 + _square(self.value)).sqrt())

    def gudermannian(self) -> Dual:
        """The angle between -pi/2 and pi/2 whose sine is the hyperbolic tangent."""
        return self.through(self.value.sinh().atan(), self.value.sech())

    def tanh_sech(self) -> tuple[Dual, Dual]:
        """Hyperbolic tangent and secant."""
        t, s = self.value.tanh(), self.value.sech()
        return self.through(t, _square(s)), self.through(s, -s * t)


Number: TypeAlias = Dual | arb | int
Point: TypeAlias = Mapping[str, Dual]


class Remembered(dict[str, Dual]):
    """A point, or a box seen as one, with what was worked out at it."""

    __slots__ = ("found",)

    def __init__(self, values: Mapping[str, Dual]) -> None:
        super().__init__(values)
        self.found: dict[Hashable, Any] = {}


Found = TypeVar("Found")


def once(key: Hashable, at: Point, work: Callable[[], Found]) -> Found:
    """What ``work`` finds at a point: worked out once, if the point remembers."""
    if not isinstance(at, Remembered):
        return work()
    if key not in at.found:
        at.found[key] = work()
    found: Found = at.found[key]
    return found


def _minus(slopes: Slopes) -> Slopes:
    return {key: -own for key, own in slopes.items()} if slopes else slopes


def _sum(one: Slopes, other: Slopes) -> Slopes:
    if not one or not other:
        return one or other
    found = dict(one)
    for key, own in other.items():
        found[key] = found[key] + own if key in found else own
    return found


def _square(ball: arb) -> arb:
    """Square of a ball; a product of two would forget that both factors are one."""
    if ball.is_exact():
        return ball * ball
    low, high = abs(ball.lower()), abs(ball.upper())
    most = low.max(high)
    least = arb(0) if ball.contains(0) else low.min(high)
    return (least * least).union(most * most)
