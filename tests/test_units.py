"""Conversions hold the exact value of the decimal that was given."""

from __future__ import annotations

import math
from fractions import Fraction

import mpmath  # type: ignore[import-untyped]
import pytest
from hypothesis import given, strategies as st

from meso_robust import units
from meso_robust.bounds import Interval
from tests.strategies import REPEATABLE

EXACT = mpmath.mp.clone()
EXACT.dps = 60
decimals = st.one_of(
    st.decimals(-5000, 5000, places=3).map(float),
    st.floats(-1e4, 1e4),
    st.sampled_from([0.0, 0.1, 418.5, 1616.0, 837.0, 5.0, 0.3, -9.2, 2060.4, 1e-300, 1e300]),
)


@REPEATABLE
@given(value=decimals)
def test_lengths_areas_and_plain_numbers_hold_the_decimal(value: float) -> None:
    decimal = Fraction(repr(value))
    for found, exact in (
        (units.metres(value), decimal / 10**6),
        (units.square_metres(value), decimal / 10**12),
        (units.plain(value), decimal),
    ):
        assert found.lo <= exact <= found.hi
        assert found.hi <= math.nextafter(found.lo, math.inf)


@REPEATABLE
@given(value=decimals)
def test_angles_hold_the_decimal_times_pi(value: float) -> None:
    decimal = Fraction(repr(value))
    exact = EXACT.pi * decimal.numerator / decimal.denominator / 180
    found = units.radians(value)
    assert EXACT.mpf(found.lo) <= exact <= EXACT.mpf(found.hi)
    assert found.width <= 4e-15 * abs(value) + 1e-320


@pytest.mark.parametrize("value", [0.1, 0.3, 418.5, 376900.0])
def test_a_decimal_is_not_the_double_nearest_to_it(value: float) -> None:
    exact = Fraction(str(value)) / 10**6
    found = units.metres(value)
    assert found.lo < exact < found.hi


def test_display_conversions_undo_the_units() -> None:
    assert units.to_um(units.metres(418.5).mid) == pytest.approx(418.5, rel=1e-14)
    assert units.to_deg(units.radians(30.0).mid) == pytest.approx(30.0, rel=1e-14)


@pytest.mark.parametrize("turns", [-2, -1, 1, 2])
def test_whole_turns_are_added_without_rounding(turns: int) -> None:
    """As narrow as any angle: a checker that knows the angle exactly compares to a few last digits."""
    assert units.radians(360.0, -1) == Interval.point(0.0)
    assert units.radians(358.5, turns) == units.radians(358.5 + 360.0 * turns)


@pytest.mark.parametrize("convert", [units.metres, units.radians, units.plain])
@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_what_is_no_number_has_no_enclosure(convert: object, value: float) -> None:
    assert callable(convert)
    with pytest.raises(ValueError, match="Fraction"):
        convert(value)
