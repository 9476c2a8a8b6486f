"""A closed interval of real numbers with outward-rounded arithmetic."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

from meso_robust.bounds import arithmetic as ia


@dataclass(frozen=True, slots=True, init=False)
class Interval:
    """All real numbers from ``lo`` to ``hi``; never empty, never NaN.

    Raises
    ------
    ValueError
        If ``lo`` > ``hi`` or either is NaN: "for all" over nothing would be true.

    Examples
    --------
    >>> third = Interval(1.0, 1.0) / Interval(3.0, 3.0)
    >>> third.lo < third.hi
    True
    """

    lo: float
    hi: float

    def __init__(self, lo: float, hi: float) -> None:
        """Refuse what is not an interval."""
        if not lo <= hi:
            raise ValueError(f"Interval needs lo <= hi, got lo={lo!r}, hi={hi!r}")
        # a frozen dataclass writes its fields by name, which takes half the time of a sum
        _write_lo(self, lo)
        _write_hi(self, hi)

    @classmethod
    def point(cls, value: float) -> Interval:
        """The interval that holds one double."""
        return cls(float(value), float(value))

    @classmethod
    def exactly(cls, value: Fraction) -> Interval:
        """The narrowest interval around a rational number."""
        near = float(value)
        if Fraction(near) == value:
            return cls(near, near)
        below = near if Fraction(near) < value else math.nextafter(near, -math.inf)
        return cls(below, math.nextafter(below, math.inf))

    def __add__(self, other: Interval) -> Interval:
        """Sum."""
        return Interval(*ia.add(self.lo, self.hi, other.lo, other.hi))

    def __sub__(self, other: Interval) -> Interval:
        """Difference."""
        return Interval(*ia.sub(self.lo, self.hi, other.lo, other.hi))

    def __mul__(self, other: Interval) -> Interval:
        """Product."""
        return Interval(*ia.mul(self.lo, self.hi, other.lo, other.hi))

    def __truediv__(self, other: Interval) -> Interval:
        """Quotient; the whole line if ``other`` holds zero."""
        return Interval(*ia.div(self.lo, self.hi, other.lo, other.hi))

    def __neg__(self) -> Interval:
        """Opposite."""
        return Interval(-self.hi, -self.lo)

    def __contains__(self, value: float) -> bool:
        """Whether a double lies inside."""
        return self.lo <= value <= self.hi

    def within(self, other: Interval) -> bool:
        """Whether every number of this interval lies in ``other``."""
        return other.lo <= self.lo and self.hi <= other.hi

    def meets(self, other: Interval) -> bool:
        """Whether the two have a number in common."""
        return self.lo <= other.hi and other.lo <= self.hi

    def hull(self, other: Interval) -> Interval:
        """The smallest interval that holds both."""
        return Interval(min(self.lo, other.lo), max(self.hi, other.hi))

    def common(self, other: Interval) -> Interval:
        """What lies in both; they are known to meet."""
        return Interval(max(self.lo, other.lo), min(self.hi, other.hi))

    @property
    def mid(self) -> float:
        """A double near the middle; for display and for choosing, not for proofs."""
        return 0.5 * (self.lo + self.hi)

    @property
    def width(self) -> float:
        """Upper bound of the width."""
        return float(ia.up(self.hi - self.lo))


_write_lo, _write_hi = (vars(Interval)[end].__set__ for end in ("lo", "hi"))

HALF_PI = Interval(*ia.HALF_PI)


def sin(angle: Interval) -> Interval:
    """Enclose the sine.

    Parameters
    ----------
    angle
        rad.

    Returns
    -------
    Interval
        Holds the sine of every angle.
    """
    return Interval(*ia.sin(angle.lo, angle.hi))


def cos(angle: Interval) -> Interval:
    """Enclose the cosine.

    Parameters
    ----------
    angle
        rad.

    Returns
    -------
    Interval
        Holds the cosine of every angle.
    """
    return Interval(*ia.cos(angle.lo, angle.hi))


def arcsin(value: Interval) -> Interval:
    """Enclose the arcsine.

    Parameters
    ----------
    value
        Sines.

    Returns
    -------
    Interval
        Angles between -pi/2 and pi/2, rad; the whole line where ``value`` is not inside (-1, 1) or
        no end could be proved.

    Notes
    -----
    The system's arcsine only proposes an end: it is accepted when its own sine, enclosed here, is
    proved to lie beyond the end of ``value``.
    """
    if not (value.lo > -1.0 and value.hi < 1.0):
        return Interval(-math.inf, math.inf)
    slack = 1e-15  # a few last digits; doubled until the proof goes through, given up at 0.06 deg
    while slack < 1e-3:
        low, high = math.asin(value.lo) - slack, math.asin(value.hi) + slack
        inside = -ia.HALF_PI[0] < low and high < ia.HALF_PI[0]
        if inside and ia.sin(low, low)[1] <= value.lo and ia.sin(high, high)[0] >= value.hi:
            return Interval(low, high)
        slack *= 2.0
    return Interval(-math.inf, math.inf)
