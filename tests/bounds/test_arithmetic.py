"""Every operation holds the exact result; the exact result comes from another arithmetic."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction

import mpmath  # type: ignore[import-untyped]
import pytest
from hypothesis import given, strategies as st

from meso_robust.bounds import Interval, arithmetic as ia
from tests.strategies import (
    LARGEST,
    REPEATABLE,
    SMALLEST,
    holds,
    intervals,
    intervals_with_points,
    is_whole,
)

EXACT = mpmath.mp.clone()
EXACT.dps = 60
Pointed = tuple[Interval, list[Fraction]]
BINARY: dict[str, tuple[Callable[..., tuple[float, float]], Callable[..., Fraction]]] = {
    "add": (ia.add, lambda x, y: x + y),
    "sub": (ia.sub, lambda x, y: x - y),
    "mul": (ia.mul, lambda x, y: x * y),
    "div": (ia.div, lambda x, y: x / y),
}
angles = st.one_of(
    st.floats(-10.0, 10.0),
    st.floats(-1100.0, 1100.0),
    st.builds(lambda k, off: k * math.pi / 2 + off, st.integers(-600, 600), st.floats(-1e-9, 1e-9)),
    st.sampled_from([0.0, SMALLEST, -SMALLEST, 1e-310, 1e-20, 1000.0, -1000.0, 1e300]),
)
positive = st.one_of(
    st.floats(0.0, LARGEST, exclude_min=True),
    st.floats(1e-3, 1e3),
    st.sampled_from([SMALLEST, 1e-310, 2.3e-308, 1.0, math.nextafter(1.0, 0.0), LARGEST]),
)


def mp(value: Fraction | float) -> mpmath.mpf:
    exact = Fraction(value)
    return EXACT.mpf(exact.numerator) / exact.denominator


def mp_holds(pair: tuple[float, float], value: mpmath.mpf) -> bool:
    return bool(EXACT.mpf(pair[0]) <= value <= EXACT.mpf(pair[1]))


@pytest.mark.parametrize("name", BINARY)
@REPEATABLE
@given(one=intervals_with_points(), other=intervals_with_points())
def test_four_operations_hold_every_exact_result(name: str, one: Pointed, other: Pointed) -> None:
    operation, exact = BINARY[name]
    (x, xs), (y, ys) = one, other
    found = operation(x.lo, x.hi, y.lo, y.hi)
    if name == "div" and 0.0 in y:
        assert is_whole(found)
        return
    for p in xs:
        for q in ys:
            assert holds(found, exact(p, q)), (p, q, found)


@REPEATABLE
@given(one=intervals_with_points())
def test_square_and_root_hold_every_exact_result(one: Pointed) -> None:
    x, points = one
    square, root = ia.sq(x.lo, x.hi), ia.sqrt(x.lo, x.hi)
    assert square[0] >= 0.0
    assert all(holds(square, p * p) for p in points)
    if x.lo < 0.0:
        assert is_whole(root)
        return
    for p in points:  # lo <= sqrt(p) <= hi, by squaring
        assert Fraction(root[0]) ** 2 <= p
        assert root[0] >= 0.0
        assert root[1] == math.inf or Fraction(root[1]) ** 2 >= p


@pytest.mark.parametrize("name", ["sin", "cos"])
@REPEATABLE
@given(one=intervals_with_points(angles))
def test_sine_and_cosine_hold_every_exact_result(name: str, one: Pointed) -> None:
    x, points = one
    found = getattr(ia, name)(x.lo, x.hi)
    assert -1.0 <= found[0] <= found[1] <= 1.0
    for p in points:
        assert mp_holds(found, getattr(EXACT, name)(mp(p)))
    first = int(EXACT.ceil(mp(x.lo) / (EXACT.pi / 2)))  # extrema inside the box
    for k in range(first, first + 4):
        if k * EXACT.pi / 2 <= mp(x.hi):
            assert mp_holds(found, EXACT.mpf(round(getattr(EXACT, name)(k * EXACT.pi / 2))))


@REPEATABLE
@given(one=intervals_with_points(positive))
def test_logarithm_holds_every_exact_result(one: Pointed) -> None:
    x, points = one
    found = ia.log(x.lo, x.hi)
    for p in points:
        assert mp_holds(found, EXACT.log(mp(p)))


@REPEATABLE
@given(x=st.floats(-100.0, 100.0))
def test_results_at_one_point_are_narrow(x: float) -> None:
    def width(pair: tuple[float, float]) -> float:
        return pair[1] - pair[0]

    assert width(ia.add(x, x, 1.0, 1.0)) <= 1e-15 * (1.0 + abs(x))
    assert width(ia.mul(x, x, x, x)) <= 1e-15 * (1.0 + x * x)
    assert width(ia.div(1.0, 1.0, x * x + 1.0, x * x + 1.0)) <= 1e-15
    assert width(ia.sqrt(x * x, x * x)) <= 1e-15 * (1.0 + abs(x))
    assert width(ia.sin(x, x)) <= 1e-15 * (4.0 + abs(x))
    assert width(ia.cos(x, x)) <= 1e-15 * (4.0 + abs(x))
    assert width(ia.log(x * x + 0.1, x * x + 0.1)) <= 2e-14


@pytest.mark.parametrize(
    ("operation", "ends"),
    [
        (ia.div, (1.0, 2.0, -1.0, 1.0)),
        (ia.div, (1.0, 2.0, 0.0, 1.0)),
        (ia.div, (1.0, 2.0, -1.0, -0.0)),
        (ia.div, (0.0, 0.0, 0.0, 0.0)),
        (ia.sqrt, (-SMALLEST, 1.0)),
        (ia.sqrt, (-2.0, -1.0)),
        (ia.log, (0.0, 1.0)),
        (ia.log, (-1.0, 1.0)),
        (ia.log, (-2.0, -1.0)),
        (ia.log, (1.0, math.inf)),
        (ia.mul, (0.0, 0.0, -math.inf, math.inf)),
        (ia.mul, (0.0, 1.0, 1.0, math.inf)),
        (ia.div, (-math.inf, math.inf, 1.0, math.inf)),
        (ia.add, (-math.inf, math.inf, -math.inf, math.inf)),
    ],
)
def test_undefined_or_unbounded_results_are_the_whole_line(
    operation: Callable[..., tuple[float, float]], ends: tuple[float, ...]
) -> None:
    assert is_whole(operation(*ends))


@pytest.mark.parametrize("operation", [ia.sin, ia.cos])
def test_angles_beyond_the_reduction_are_bounded_by_one(
    operation: Callable[..., tuple[float, float]],
) -> None:
    for ends in ((0.0, math.inf), (-math.inf, 0.0), (1e4, 1e4), (-1e16, 3.0)):
        assert operation(*ends) == (-1.0, 1.0)


@REPEATABLE
@given(x=intervals(), y=intervals())
def test_overflow_is_never_mistaken_for_a_bound(x: Interval, y: Interval) -> None:
    for name, (operation, _) in BINARY.items():
        low, high = operation(x.lo, x.hi, y.lo, y.hi)
        assert low < math.inf, name
        assert high > -math.inf, name


@REPEATABLE
@given(x=st.floats(allow_nan=False, allow_infinity=False))
def test_down_and_up_leave_the_double(x: float) -> None:
    assert ia.down(x) <= math.nextafter(x, -math.inf)
    assert ia.up(x) >= math.nextafter(x, math.inf)


@pytest.mark.parametrize(
    ("ends", "value"), [(ia.HALF_PI, mpmath.pi / 2), (ia.LN2, mpmath.ln2)], ids=["pi/2", "log 2"]
)
def test_constants_are_bracketed(ends: tuple[float, float], value: object) -> None:
    exact = EXACT.pi / 2 if ends is ia.HALF_PI else EXACT.ln2
    assert EXACT.mpf(ends[0]) < exact < EXACT.mpf(ends[1])
    assert math.nextafter(ends[0], math.inf) == ends[1]


@pytest.mark.parametrize("other", [(-3.0, 2.0), (5e-324, 1e300), (0.0, 0.0)])
def test_a_product_with_exactly_zero_is_exactly_zero(other: tuple[float, float]) -> None:
    assert ia.mul(0.0, 0.0, *other) == (0.0, 0.0)
    assert ia.mul(*other, 0.0, 0.0) == (0.0, 0.0)
    assert ia.mul(0.0, 0.0, other[0], math.inf) == (-math.inf, math.inf)
    # a product that is lost is not one
    low, high = ia.mul(5e-324, 5e-324, 5e-324, 5e-324)
    assert low <= 0.0 < high
