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
    """Enclose a length given in um, in m.

    Parameters
    ----------
    value_um
        A length, um.

    Returns
    -------
    Interval
        Metres.
    """
    return Interval.exactly(Fraction(repr(float(value_um))) / 10**6)


def square_metres(value_um2: float) -> Interval:
    """Enclose an area given in um^2, in m^2.

    Parameters
    ----------
    value_um2
        An area, um^2.

    Returns
    -------
    Interval
        Square metres.
    """
    return Interval.exactly(Fraction(repr(float(value_um2))) / 10**12)


def radians(value_deg: float, turns: int = 0) -> Interval:
    """Enclose an angle given in deg, in rad.

    Parameters
    ----------
    value_deg
        An angle, deg.
    turns
        Whole turns that are added before anything is rounded.

    Returns
    -------
    Interval
        Radians.
    """
    quarters = Fraction(repr(float(value_deg))) / 90 + 4 * turns
    if quarters == 0:  # a product is rounded outward, and what is exact shall cost nothing
        return Interval.point(0.0)
    return Interval.exactly(quarters) * HALF_PI


def plain(value: float) -> Interval:
    """Enclose a dimensionless decimal number.

    Parameters
    ----------
    value
        The number.

    Returns
    -------
    Interval
        Holds the decimal number that the double spells.
    """
    return Interval.exactly(Fraction(repr(float(value))))


def to_um(value: float) -> float:
    """Metres to um, for display.

    Parameters
    ----------
    value
        A length, m.

    Returns
    -------
    float
        The nearest double to a product: nothing that is proved rests on it.
    """
    return value / UM


def to_deg(value: float) -> float:
    """Radians to degrees, for display.

    Parameters
    ----------
    value
        An angle, rad.

    Returns
    -------
    float
        The nearest double to a product: nothing that is proved rests on it.
    """
    return value / DEG
