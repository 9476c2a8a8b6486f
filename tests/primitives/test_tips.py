"""Where the tips can be: every corner of the errors by hand, and no more than these."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import pytest

from meso_robust.primitives.move import Aim, Anchor, from_part, in_world
from meso_robust.primitives.tips import tip_of
from tests.strategies import paper_chain

SENSED, PROBE, TILT = 5e-6, 5e-6, math.radians(0.25)
"""Errors of the paper's task."""
HALF = 290e-6


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("end", [from_part(-120.0), in_world(700.0)], ids=["part", "world"])
def test_a_tip_ends_where_the_corners_of_the_errors_take_it(side: int, end: Aim) -> None:
    step = paper_chain().steps[0]
    rule = replace(step.rule, dual_end=end)
    setup, x = paper_chain().setup, step.pre.x

    tip = tip_of(rule, side, step.pre, setup)

    ahead = []
    for true, sensing, off, beta in itertools.product(
        (x.lo, x.hi), (-SENSED, SENSED), (-PROBE, PROBE), (-TILT, TILT)
    ):
        commanded = end.offset_um * 1e-6
        commanded += true + sensing if end.anchor is Anchor.PART else 0.0
        # a positive misalignment puts the upper tip ahead, towards -x
        ahead.append(commanded + off - side * HALF * math.tan(beta) - true)
    assert tip.ahead_end.lo == pytest.approx(min(ahead), abs=1e-15)
    assert tip.ahead_end.hi == pytest.approx(max(ahead), abs=1e-15)
