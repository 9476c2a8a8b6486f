"""Units at the edge: micrometres and degrees outside, metres and radians inside.

A number in a task file means its decimal value, not the double nearest to it, so the conversions
that feed proofs return enclosures of the exact product.
"""

from __future__ import annotations

import math
from fractions import Fraction

from meso_robust.bounds import HALF_PI, Interval

UM = 1e-6
DEG = math.pi / 180.0


def metres(value_um: float) -> Interval:
    """Enclose a length given in um, in m."""
    return Interval.exactly(Fraction(repr(float(value_um))) / 10**6)


def square_metres(value_um2: float) -> Interval:
    """Enclose an area given in um^2, in m^2."""
    return Interval.exactly(Fraction(repr(float(value_um2))) / 10**12)


def radians(value_deg: float) -> Interval:
    """Enclose an angle given in deg, in rad."""
    return Interval.exactly(Fraction(repr(float(value_deg))) / 90) * HALF_PI


def plain(value: float) -> Interval:
    """Enclose a dimensionless decimal number."""
    return Interval.exactly(Fraction(repr(float(value))))


def to_um(value: float) -> float:
    """Metres to um, for display."""
    return value / UM


def to_deg(value: float) -> float:
    """Radians to degrees, for display."""
    return value / DEG
