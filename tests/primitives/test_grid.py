"""Boxes are widened to decimals, by little and never inward."""

from __future__ import annotations

from hypothesis import given, strategies as st

from meso_robust.bounds import Interval
from meso_robust.primitives.grid import on_grid
from meso_robust.primitives.setup import PoseBox

LENGTH = st.floats(-1e-2, 1e-2)
ANGLE = st.floats(-7.0, 7.0)


def side(one: float, other: float) -> Interval:
    return Interval(min(one, other), max(one, other))


@given(LENGTH, LENGTH, LENGTH, LENGTH, ANGLE, ANGLE)
def test_a_box_is_widened_by_a_quarter_to_a_step_and_a_quarter(
    a: float, b: float, c: float, d: float, e: float, f: float
) -> None:
    box = PoseBox(x=side(a, b), y=side(c, d), theta=side(e, f))
    wide = on_grid(box)
    assert box.within(wide)
    for inner, outer, step in (
        (box.x, wide.x, 1e-9),
        (box.y, wide.y, 1e-9),
        (box.theta, wide.theta, 1.7453292519943296e-6),
    ):
        for gap in (inner.lo - outer.lo, outer.hi - inner.hi):
            assert 0.24 * step <= gap <= 1.26 * step
