"""Numbers of a certificate: hexadecimal doubles are exact, and those for reading follow from them."""

from __future__ import annotations

import math
from fractions import Fraction

from flint import arb

from meso_robust.checker.document import BoxDocument, ExactBox, HexPair
from meso_robust.checker.ids import Named
from meso_robust.checker.inputs import PoseBox
from meso_robust.checker.ranges import Side
from meso_robust.checker.refusal import Refused

PER_UNIT = 1000
"""Numbers for reading have three decimals."""
SHIFT = Fraction(1, 10**6)
"""By which they are moved outward before they are rounded, in their last decimal."""


def double(text: str, what: Named) -> float:
    """A finite double, from its hexadecimal spelling by ``float.hex``.

    Raises
    ------
    Refused
        It is none.
    """
    try:
        value = float.fromhex(text)
    except (ValueError, OverflowError):
        value = math.nan
    if not math.isfinite(value) or value.hex() != text:
        raise Refused(what, repr(text), "not a finite hexadecimal double")
    return value


def side(pair: HexPair, what: Named) -> Side:
    """A range from its two ends.

    Raises
    ------
    Refused
        It is empty, or an end is not a number.
    """
    low, high = (double(text, what) for text in pair)
    if not low <= high:
        raise Refused(what, f"from {low} to {high}", "an empty range")
    return arb(low), arb(high)


def box(stated: ExactBox, what: Named) -> PoseBox:
    """A box of poses."""
    return PoseBox(
        x=side(stated.x_m, what.value("x_m")),
        y=side(stated.y_m, what.value("y_m")),
        theta=side(stated.theta_rad, what.value("theta_rad")),
    )


def check_reading(told: BoxDocument, exact: PoseBox, what: Named, *, outward: bool = True) -> None:
    """Compare the numbers for reading with the exact ones, rounded to three decimals.

    Raises
    ------
    Refused
        One is not what it should be.
    """
    per_um, per_deg = arb(10**6), 180 / arb.pi()
    pairs = (
        ("x_um", told.x_um, exact.x, per_um),
        ("y_um", told.y_um, exact.y, per_um),
        ("theta_deg", told.theta_deg, exact.theta, per_deg),
    )
    for name, stated, ends, factor in pairs:
        low, high = _thousandths(ends[0] * factor, -ends[1] * factor, outward=outward)
        if stated != (low, -high):
            raise Refused(what.value(name), list(stated), [low, -high])


def _thousandths(low: arb, high: arb, *, outward: bool) -> tuple[float, float]:
    """Lower end and negated upper end, rounded alike."""
    shift = arb(float(SHIFT))
    first, second = (
        _integer((end * PER_UNIT - shift).floor() if outward else (end * PER_UNIT - shift).ceil())
        for end in (low, high)
    )
    return first / PER_UNIT, second / PER_UNIT


def _integer(value: arb) -> int:
    found = value.unique_fmpz()
    return 0 if found is None else int(found)
