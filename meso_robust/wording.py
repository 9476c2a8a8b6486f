"""Counts and figures as they are told: what is promised is never made larger by rounding.

A margin, an allowance and a share of successes are rounded down, the bound of an error up, a box or an
interval outward. All of it is exact: no tolerance decides on which side a digit falls.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction

_MICRO = re.compile(r"\bum(2|\^2)?(?!\w)")


def down(value: float | Fraction, digits: int) -> str:
    """With so many digits after the point, not above the value.

    Parameters
    ----------
    value
        The number, exactly as the double has it.
    digits
        Digits after the point.

    Returns
    -------
    str
        A decimal number.

    Examples
    --------
    >>> down(1.21875, 2), down(-0.001, 1), up(1e-9, 2)
    ('1.21', '-0.1', '0.01')
    """
    return _fixed(value, digits, math.floor)


def up(value: float | Fraction, digits: int) -> str:
    """With so many digits after the point, not below the value.

    Parameters
    ----------
    value
        The number, exactly as the double has it.
    digits
        Digits after the point.

    Returns
    -------
    str
        A decimal number.
    """
    return _fixed(value, digits, math.ceil)


def down_to(value: float, digits: int) -> str:
    """With at most so many significant digits, not above the decimal that the value spells.

    Parameters
    ----------
    value
        The number.
    digits
        Significant digits.

    Returns
    -------
    str
        A number without needless zeros.
    """
    return _significant(value, digits, ROUND_FLOOR)


def up_to(value: float, digits: int) -> str:
    """With at most so many significant digits, not below the decimal that the value spells.

    Parameters
    ----------
    value
        The number.
    digits
        Significant digits.

    Returns
    -------
    str
        A number without needless zeros.

    Examples
    --------
    >>> up_to(0.300001, 3), down_to(0.300001, 3), up_to(0.34, 3)
    ('0.301', '0.3', '0.34')
    """
    return _significant(value, digits, ROUND_CEILING)


def counted(count: int, noun: str, plural: str = "") -> str:
    """So many of something.

    Parameters
    ----------
    count
        How many.
    noun
        Of one.
    plural
        Of several, where it is not the noun with an s.

    Returns
    -------
    str
        The count and the noun.

    Examples
    --------
    >>> counted(1, "move"), counted(2, "move"), counted(0, "axis", "axes")
    ('1 move', '2 moves', '0 axes')
    """
    return f"{count} {noun if count == 1 else plural or noun + 's'}"


def do(count: int, verb: str) -> str:
    """What so many do: one ends, two end.

    Parameters
    ----------
    count
        How many.
    verb
        As of several.

    Returns
    -------
    str
        The verb with an s or without.
    """
    return verb + "s" if count == 1 else verb


def worded(text: str) -> str:
    """Words with the sign of the unit, as people read it; keys of files stay as they are.

    Parameters
    ----------
    text
        A message, or lines of an answer.

    Returns
    -------
    str
        The same with µm for um.

    Examples
    --------
    >>> worded("film_ratio_um2 = 9, within 3 um of 376900 um^2")
    'film_ratio_um2 = 9, within 3 µm of 376900 µm²'
    """
    return _MICRO.sub(lambda found: "µm²" if found.group(1) else "µm", text)


def _fixed(value: float | Fraction, digits: int, rounded: Callable[[Fraction], int]) -> str:
    if not math.isfinite(value):
        return f"{value:g}"
    return f"{Decimal(rounded(Fraction(value) * 10**digits)).scaleb(-digits):f}"


def _significant(value: float, digits: int, rounding: str) -> str:
    if not math.isfinite(value):
        return f"{value:g}"
    told = Context(prec=digits, rounding=rounding).plus(Decimal(repr(float(value))))
    return f"{float(told):.{digits}g}"
