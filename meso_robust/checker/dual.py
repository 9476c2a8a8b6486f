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

    def _chain(self, value: arb, slope: arb) -> Dual:
        return Dual(value, {key: slope * own for key, own in self.slopes.items()})

    def __neg__(self) -> Dual:
        return Dual(-self.value, {key: -own for key, own in self.slopes.items()})

    def __add__(self, other: Number) -> Dual:
        if not isinstance(other, Dual):
            return Dual(self.value + other, self.slopes)
        return Dual(self.value + other.value, _sum(self.slopes, other.slopes))

    __radd__ = __add__

    def __sub__(self, other: Number) -> Dual:
        if not isinstance(other, Dual):
            return Dual(self.value - other, self.slopes)
        found = dict(self.slopes)
        for key, own in other.slopes.items():
            found[key] = found[key] - own if key in found else -own
        return Dual(self.value - other.value, found)

    def __rsub__(self, other: arb | int) -> Dual:
        return -self + other

    def __mul__(self, other: Number) -> Dual:
        if not isinstance(other, Dual):
            return Dual(self.value * other, {k: own * other for k, own in self.slopes.items()})
        p, q, more = self.value, other.value, other.slopes
        found = {key: q * own for key, own in self.slopes.items()}
        if found:
            for key, own in more.items():
                found[key] = found[key] + p * own if key in found else p * own
        elif more:
            found = {key: p * own for key, own in more.items()}
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
        return self._chain(value, -_square(value))

    def squared(self) -> Dual:
        """Its square, never negative."""
        return self._chain(_square(self.value), 2 * self.value)

    def sin_cos(self) -> tuple[Dual, Dual]:
        """Sine and cosine."""
        s, c = self.value.sin_cos()
        return self._chain(s, c), self._chain(c, -s)

    def tan(self) -> Dual:
        """Tangent."""
        value = self.value.tan()
        return self._chain(value, 1 + _square(value))

    def atan(self) -> Dual:
        """Inverse tangent."""
        return self._chain(self.value.atan(), 1 / (1 + _square(self.value)))

    def asin(self) -> Dual:
        """Inverse sine; not finite beyond -1 and 1."""
        return self._chain(self.value.asin(), 1 / (1 - _square(self.value)).sqrt())

    def sqrt(self) -> Dual:
        """Square root; not finite where the radicand may be negative."""
        value = self.value.sqrt()
        return self._chain(value, 1 / (2 * value))

    def asinh(self) -> Dual:
        """Inverse hyperbolic sine."""
        return self._chain(self.value.asinh(), 1 / (1 + _square(self.value)).sqrt())

    def gudermannian(self) -> Dual:
        """The angle between -pi/2 and pi/2 whose sine is the hyperbolic tangent."""
        return self._chain(self.value.sinh().atan(), self.value.sech())

    def tanh_sech(self) -> tuple[Dual, Dual]:
        """Hyperbolic tangent and secant."""
        t, s = self.value.tanh(), self.value.sech()
        return self._chain(t, _square(s)), self._chain(s, -s * t)


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
