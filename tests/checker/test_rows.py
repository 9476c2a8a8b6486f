"""Intervals of many boxes hold what exact numbers give, and what balls find as slopes."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import arb

from meso_robust.checker.dual import Dual
from meso_robust.checker.ranges import Box, side_of
from meso_robust.checker.rows import (
    EPS,
    TINY,
    Boxes,
    choose,
    ends_of,
    lowest,
    most_of,
    quarters,
)

NAMES = ("x", "y", "z")


def formula(at: Any) -> Any:
    """Of all operations; x and y are about 1, z is small."""
    s, c = (at["x"] + at["z"]).sin_cos()
    root = (at["x"] * at["y"] + 1).sqrt()
    return (s * root - c.squared() / (at["y"] + 2)) * 3 + at["z"].tan() * (1 - at["y"]) / root


def boxes(count: int, wide: float) -> Boxes:
    rng = np.random.default_rng(0)
    middle = np.stack([rng.uniform(0.8, 1.2, count), rng.uniform(0.8, 1.2, count), rng.uniform(-0.1, 0.1, count)])  # fmt: skip
    return Boxes(NAMES, middle - wide, middle + wide)


@pytest.mark.parametrize("wide", [0.0, 1e-9, 1e-3, 0.03])
def test_values_and_slopes_are_held(wide: float) -> None:
    some = boxes(20, wide)
    found = formula(some.points()).tight()
    ends = np.concatenate([found.ends[:, None, : some.count], found.slopes()], axis=1)
    rng = np.random.default_rng(1)
    for k in range(some.count):
        for share in (*rng.uniform(size=(4, 3)), np.zeros(3), np.ones(3)):
            place = np.clip(
                some.low[:, k] + share * (some.high - some.low)[:, k],
                some.low[:, k],
                some.high[:, k],
            )
            point = {n: Dual(arb(float(v)), {n: arb(1)}) for n, v in zip(NAMES, place, strict=True)}
            exact = formula(point)
            for row, value in enumerate((exact.value, *(exact.slopes[n] for n in NAMES))):
                assert arb(float(-ends[0, row, k])) <= value.upper()
                assert value.lower() <= arb(float(ends[1, row, k]))
        assert found.high[k] - found.low[k] <= 40 * wide + 1e-13


def test_the_lowest_value_is_bounded_and_cuts_bring_it_closer() -> None:
    some = boxes(8, 0.05)

    def valley(at: Any, which: Any) -> Any:
        return (at["x"] - 1).squared() + at["y"] * at["z"]

    rng = np.random.default_rng(2)
    share = rng.uniform(size=(3, 4000, 1))
    x, y, z = some.low[:, None] + share * (some.high - some.low)[:, None]
    least = ((x - 1) ** 2 + y * z).min(axis=0)
    few, many = (lowest(valley, some, 1e-9, cuts) for cuts in (0, 4))
    assert np.all(many <= least)
    assert np.all(few <= many + 1e-15)
    assert np.all(least - many < 6e-3)


def test_boxes_are_looked_at_in_parts_and_say_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    some, own = boxes(8, 0.05), np.arange(8.0)

    def valley(at: Any, which: Any) -> Any:
        return (at["x"] - 1).squared() + at["y"] * at["z"] + own[which]

    whole = lowest(valley, some, 1e-9, 4)
    monkeypatch.setattr("meso_robust.checker.rows.AT_ONCE", 3)
    np.testing.assert_array_equal(lowest(valley, some, 1e-9, 4), whole)


HILL = Boxes(("x",), np.array([[0.0]]), np.array([[1.0]]))


def hill(at: Any) -> Any:
    """At least 0 over :data:`HILL`; what one look at it proves is more than -1."""
    return at["x"] * (1 - at["x"])


def test_a_bound_is_brought_no_closer_than_is_asked_for() -> None:
    asked: list[int] = []

    def cost(moved: float, **asks: Any) -> int:
        def of(at: Any, which: Any) -> Any:
            asked.append(len(which))
            return hill(at) + moved

        asked.clear()
        assert lowest(of, HILL, 1e-9, 6, **asks)[0] <= moved + 0.26
        return sum(asked)

    whole = cost(0.0)
    assert cost(2.0, enough=0.5) < whole == cost(2.0)
    assert cost(-8.0, hopeless=-7.0) < whole == cost(-8.0)
    assert cost(8.0, hopeless=-7.0) == whole


def test_of_what_is_given_up_a_value_is_told_that_is_attained() -> None:
    (found,) = lowest(lambda at, _: hill(at) - 8, HILL, 1e-9, 6, hopeless=-7.0)
    assert -8.0 <= found <= -7.7


def test_of_a_group_the_least_value_is_bounded() -> None:
    some, groups = HILL.of(np.zeros(3, dtype=np.int64)), np.array([1, 0, 1])
    moved = np.array([5.0, 1.0, 3.0])
    found = lowest(lambda at, which: hill(at) + moved[which], some, 1e-9, 6, groups=groups)
    assert np.all(found <= [1.0, 3.0])
    assert np.all(found > [0.9, 2.9])


def test_boxes_are_cut_in_four_along_what_matters_most() -> None:
    low, high = np.zeros((3, 1)), np.array([[8.0], [8.0], [8.0]])
    for weight, wide in (((5, 4, 0), (4, 4, 8)), ((9, 4, 0), (2, 8, 8))):
        found = quarters(Boxes(NAMES, low, high), np.array([weight], dtype=float).T)
        assert np.all(found.high - found.low == np.array([wide]).T)
        assert np.prod(found.high - found.low, axis=0).sum() == 8.0**3
        assert len({tuple(corner) for corner in found.low.T}) == 4


def test_ranges_of_a_formula_are_bounded_from_both_sides() -> None:
    box: Box = {"x": (arb(0), arb(1)), "moved": side_of(arb(3))}

    def of(at: Any) -> Any:
        return hill(at) + at["moved"]

    low, high = ends_of(of, box, 1e-3, 6)
    assert 2.998 < low <= 3
    assert 3.25 <= high < 3.252
    half, tenth = most_of(of, [{**box, "x": (arb(0), arb(x))} for x in (0.5, 0.125)], 1e-3, 6)
    assert 3.25 <= half < 3.252
    assert 3.109375 <= tenth < 3.1105


def test_quantities_that_are_used_twice_have_the_sum_of_their_slopes() -> None:
    """Of boxes without width: that of each column, whichever quantity was chosen there."""
    some = boxes(6, 0.0)
    at = some.points()
    x, y, _ = some.low
    first = np.arange(12) % 2 == 0
    both = at["x"] * at["y"]
    one, other = both * both, both + at["z"]
    chosen = choose(first, one, other)
    moved = (both.plain() * at["y"]).moving((at["z"] * 3).change() + at["x"].settled() * at["x"])
    expected = np.where(first[:6], 2 * x * y * np.array([y, x, 0 * x]), np.array([y, x, 1 + 0 * x]))
    for slopes, exact in ((chosen, expected), (moved, np.array([2 * x, 0 * x, 3 + 0 * x]))):
        low, high = slopes.slopes() * np.array([-1.0, 1.0])[:, None, None]
        assert np.all(low <= exact + 1e-15)
        assert np.all(exact - 1e-15 <= high)
        assert np.all(high - low < 1e-12)
    assert np.all(abs(moved.low[:6] - x * y * y) < 1e-12)


def test_where_nothing_is_known_nothing_is_proved() -> None:
    box = Boxes(("x",), np.array([[-1.0]]), np.array([[1.0]]))
    with np.errstate(all="ignore"):
        for of in (
            lambda at, _: 1 / at["x"],
            lambda at, _: at["x"].sqrt(),
            lambda at, _: at["x"].sqrt().squared() + 1,
        ):
            assert not lowest(of, box, 1e-9, 2)[0] > -np.inf


def test_what_is_rounded_is_moved_outward() -> None:
    """Sums, products and quotients of doubles, held against fractions."""
    some = boxes(50, 0.0)
    at = some.points()
    results: dict[str, tuple[Any, Any]] = {
        "sum": (at["x"] + at["z"], lambda x, y, z: x + z),
        "product": (at["x"] * at["y"], lambda x, y, z: x * y),
        "quotient": (at["x"] / at["y"], lambda x, y, z: x / y),
        "square": (at["z"].squared(), lambda x, y, z: z * z),
    }
    for found, exact in results.values():
        for k in range(some.count):
            value = exact(*(Fraction(float(end)) for end in some.low[:, k]))
            assert Fraction(float(found.low[k])) < value < Fraction(float(found.high[k]))
    root = at["x"].sqrt()
    for k in range(some.count):
        square = Fraction(float(some.low[0, k]))
        assert Fraction(float(root.low[k])) ** 2 < square < Fraction(float(root.high[k])) ** 2


def test_what_ends_are_moved_by_is_a_normal_number() -> None:
    """Also times lengths in m: a processor takes a hundred times as long for others."""
    metre = 1e-12
    assert TINY * EPS * metre**2 > np.finfo(float).tiny


def test_a_square_is_never_negative() -> None:
    assert np.all(
        Boxes(("x",), np.array([[-1.0]]), np.array([[1.0]])).points()["x"].squared().low >= 0
    )
