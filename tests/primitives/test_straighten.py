"""Which tip touches first in a straightening."""

from __future__ import annotations

import pytest

from meso_robust.bounds import Interval
from meso_robust.primitives.straighten import _first_contacts

ALIGNED = Interval(1.56, 1.58)


@pytest.mark.parametrize("start", [(1.4, 1.5), (1.6, 1.7), (1.4, 1.7), (1.57, 1.7), (1.4, 1.57)])
def test_each_start_is_in_the_case_of_each_tip_that_can_touch_first(
    start: tuple[float, float],
) -> None:
    """Below the direction in which the pair is aligned the upper tip, above it the lower one."""
    cases = _first_contacts(Interval(*start), ALIGNED)

    for share in range(11):
        angle = start[0] + share / 10 * (start[1] - start[0])
        sides = {side for side, angles in cases if angle in angles}
        assert sides >= ({1} if angle < ALIGNED.hi else set())
        assert sides >= ({-1} if angle > ALIGNED.lo else set())
