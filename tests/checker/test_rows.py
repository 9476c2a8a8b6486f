"""Intervals of many boxes hold what exact numbers give, and what balls find as slopes."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import arb

from meso_robust.checker.dual import Dual
from meso_robust.checker.rows import EPS, TINY, Boxes, lowest

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


def test_a_bound_is_brought_no_closer_than_is_asked_for() -> None:
    """Of ``x (1 - x)`` over 0 to 1 and moved: it is at least 0 there, one box only proves more than -1."""
    box = Boxes(("x",), np.array([[0.0]]), np.array([[1.0]]))
    asked: list[int] = []

    def hill(moved: float) -> Any:
        def of(at: Any, which: Any) -> Any:
            asked.append(len(which))
            return at["x"] * (1 - at["x"]) + moved

        return of

    def cost(moved: float, **asks: float) -> int:
        asked.clear()
        assert lowest(hill(moved), box, 1e-9, 6, **asks)[0] <= moved
        return sum(asked)

    whole = cost(0.0)
    assert cost(2.0, enough=0.5) < whole == cost(2.0)
    assert cost(-8.0, rough=0.3) < whole == cost(-8.0)
    assert cost(0.0, enough=0.0, rough=0.3) == whole


def test_where_nothing_is_known_nothing_is_proved() -> None:
    box = Boxes(("x",), np.array([[-1.0]]), np.array([[1.0]]))
    with np.errstate(all="ignore"):
        for of in (lambda at, _: 1 / at["x"], lambda at, _: at["x"].sqrt()):
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
