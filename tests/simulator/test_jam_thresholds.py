"""Where round tips that are too close jam the part: both engines against numbers worked out by hand."""

from __future__ import annotations

import pytest

from reports.simulator.jam_thresholds import Pair, threshold

# d_v > 837 sqrt(1 + m^2) + (r + r') / sqrt(1 + m^2), m the smaller coefficient
BY_HAND: list[tuple[Pair, Pair, float]] = [
    ((0.33, 0.33), (0.0, 0.0), 881.40),
    ((0.33, 0.33), (2.5, 2.5), 886.14),
    ((0.33, 0.33), (12.5, 12.5), 905.14),
    ((0.36, 0.36), (0.0, 0.0), 889.59),
    ((0.36, 0.36), (12.5, 12.5), 913.11),
    ((0.30, 0.36), (12.5, 12.5), 897.80),
    ((0.36, 0.30), (2.5, 12.5), 888.22),
]


@pytest.mark.parametrize("engine", ["events", "stepper"])
@pytest.mark.parametrize(("friction", "radii", "by_hand"), BY_HAND)
def test_a_part_jams_where_it_does_by_hand(
    engine: str, friction: Pair, radii: Pair, by_hand: float
) -> None:
    assert threshold(engine, friction, radii) == pytest.approx((by_hand, by_hand), abs=0.05)
