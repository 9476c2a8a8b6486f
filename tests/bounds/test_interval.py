"""The interval type: what it refuses, and what its operations hold."""

from __future__ import annotations

import math
from fractions import Fraction

import mpmath  # type: ignore[import-untyped]
import pytest
from hypothesis import given, strategies as st

from meso_robust.bounds import HALF_PI, Interval
from meso_robust.bounds.interval import arcsin, cos, sin
from tests.strategies import REPEATABLE, intervals, intervals_with_points

EXACT = mpmath.mp.clone()
EXACT.dps = 60
Pointed = tuple[Interval, list[Fraction]]


@pytest.mark.parametrize(
    ("lo", "hi"), [(1.0, 0.0), (math.nan, 1.0), (0.0, math.nan), (math.nan, math.nan)]
)
def test_inverted_or_undefined_ends_are_refused(lo: float, hi: float) -> None:
    with pytest.raises(ValueError, match="lo <= hi"):
        Interval(lo, hi)


def test_a_point_that_is_no_number_is_refused() -> None:
    with pytest.raises(ValueError, match="lo <= hi"):
        Interval.point(math.nan)


@REPEATABLE
@given(
    value=st.one_of(
        st.fractions(),
        st.builds(Fraction, st.integers(-(10**30), 10**30), st.integers(1, 10**30)),
        st.floats(allow_nan=False, allow_infinity=False).map(Fraction),
    )
)
def test_exactly_is_the_narrowest_interval_around_the_rational(value: Fraction) -> None:
    found = Interval.exactly(value)
    assert found.lo <= value <= found.hi
    if Fraction(float(value)) == value:
        assert found.lo == found.hi
    else:
        assert found.lo < value < found.hi
        assert math.nextafter(found.lo, math.inf) == found.hi


@REPEATABLE
@given(one=intervals_with_points(), other=intervals_with_points())
def test_operators_hold_exact_results(one: Pointed, other: Pointed) -> None:
    (x, (p, *_)), (y, (_, q, *_)) = one, other
    assert (x + y).lo <= p + q <= (x + y).hi
    assert (x - y).lo <= p - q <= (x - y).hi
    assert (x * y).lo <= p * q <= (x * y).hi
    assert (-x).lo <= -p <= (-x).hi
    quotient = x / y
    if q == 0:
        assert quotient == Interval(-math.inf, math.inf)
    else:
        assert quotient.lo <= p / q <= quotient.hi


@REPEATABLE
@given(x=intervals(), y=intervals())
def test_hull_within_and_width_agree_with_the_ends(x: Interval, y: Interval) -> None:
    both = x.hull(y)
    assert x.within(both)
    assert y.within(both)
    assert (both.lo, both.hi) == (min(x.lo, y.lo), max(x.hi, y.hi))
    assert x.within(y) == (y.lo <= x.lo and x.hi <= y.hi)
    assert x.lo in x
    assert x.hi in x
    assert x.width >= Fraction(x.hi) - Fraction(x.lo)


def test_partly_outside_is_not_within() -> None:
    assert not Interval(0.0, 2.0).within(Interval(0.0, 1.0))
    assert not Interval(-1.0, 1.0).within(Interval(0.0, 1.0))
    assert 1.5 not in Interval(0.0, 1.0)


@REPEATABLE
@given(x=intervals(st.floats(-1.2, 1.2)))
def test_arcsine_holds_the_exact_one(x: Interval) -> None:
    found = arcsin(x)
    if not (x.lo > -1.0 and x.hi < 1.0):
        assert found == Interval(-math.inf, math.inf)
        return
    for value in (x.lo, x.mid, x.hi):
        assert EXACT.mpf(found.lo) <= EXACT.asin(EXACT.mpf(value)) <= EXACT.mpf(found.hi)
    if max(abs(x.lo), abs(x.hi)) < 0.99:
        assert found.width <= math.asin(x.hi) - math.asin(x.lo) + 1e-13


@pytest.mark.parametrize("off", [1e-10, -1e-10])
def test_an_arcsine_that_the_system_gets_wrong_is_not_believed(
    monkeypatch: pytest.MonkeyPatch, off: float
) -> None:
    right = math.asin
    monkeypatch.setattr(math, "asin", lambda value: right(value) + off)

    found = arcsin(Interval.point(0.4))

    assert EXACT.mpf(found.lo) <= EXACT.asin(EXACT.mpf(0.4)) <= EXACT.mpf(found.hi)
    assert found.width < 1e-8


def test_sine_and_cosine_of_a_right_angle() -> None:
    assert 1.0 in sin(HALF_PI)
    assert 0.0 in cos(HALF_PI)
    assert cos(HALF_PI).width < 2e-15
