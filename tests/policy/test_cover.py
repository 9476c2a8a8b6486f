"""Unions of boxes: against points drawn in them, and against cases known by hand."""

from __future__ import annotations

import numpy as np
from hypothesis import given, strategies as st

from meso_robust.bounds import Interval
from meso_robust.policy.cover import covered, ends_of, left_over, rooms
from meso_robust.primitives.setup import PoseBox
from tests.strategies import REPEATABLE


def box(x: tuple[float, float], y: tuple[float, float], theta: tuple[float, float]) -> PoseBox:
    return PoseBox(x=Interval(*x), y=Interval(*y), theta=Interval(*theta))


@st.composite
def small_boxes(draw: st.DrawFn) -> PoseBox:
    """Boxes with ends on a coarse grid, so that faces meet often."""
    ends = [sorted(draw(st.tuples(st.integers(0, 5), st.integers(0, 5)))) for _ in range(3)]
    return box(*((float(low), float(high + 1)) for low, high in ends))


def holds(boxes: list[PoseBox], poses: np.ndarray) -> np.ndarray:
    """(N,) by brute force."""
    low, high = ends_of(boxes)
    inside = (low[:, None] <= poses) & (poses <= high[:, None])
    return np.asarray(inside.all(axis=2).any(axis=0))


def centres(of: PoseBox) -> np.ndarray:
    """Middle of every unit cell of a box with whole ends: they decide a cover by whole boxes."""
    sides = [np.arange(side.lo, side.hi) + 0.5 for side in (of.x, of.y, of.theta)]
    return np.stack(np.meshgrid(*sides), axis=-1).reshape(-1, 3)


@given(small_boxes(), st.lists(small_boxes(), max_size=6))
@REPEATABLE
def test_a_cover_is_found_exactly_when_every_unit_cell_is_covered(
    one: PoseBox, boxes: list[PoseBox]
) -> None:
    truly = bool(boxes) and bool(holds(boxes, centres(one)).all())

    assert covered(one, boxes) == truly
    assert (left_over(one, ends_of(boxes), 1e-3) is None) == truly


@given(st.lists(small_boxes(), min_size=1, max_size=6), small_boxes())
@REPEATABLE
def test_a_box_is_covered_exactly_when_it_lies_in_one_of_the_rooms(
    boxes: list[PoseBox], one: PoseBox
) -> None:
    found = rooms(boxes, one.theta)

    held = any(one.x.within(x) and one.y.within(y) for x, y in found)
    assert held == bool(holds(boxes, centres(one)).all())


def test_the_smallest_gap_is_a_gap() -> None:
    whole = box((0.0, 2.0), (0.0, 1.0), (0.0, 1.0))
    left = box((0.0, 1.0), (0.0, 1.0), (0.0, 1.0))
    right = box((float(np.nextafter(1.0, 2.0)), 2.0), (0.0, 1.0), (0.0, 1.0))

    assert not covered(whole, [left, right])
    assert covered(whole, [left, box((1.0, 2.0), (0.0, 1.0), (0.0, 1.0))])
