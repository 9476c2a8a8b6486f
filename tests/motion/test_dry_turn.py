"""Turns on three dry points, against the least dissipated power, integrated step by step."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from meso_robust.bounds import Interval
from meso_robust.errors import NotApplicableError
from meso_robust.motion.dry_turn import DryPush, turn_on_points
from meso_robust.types import Floats

UM = 1e-6
TABLE_I = ((-563.3, 411.3), (605.9, -409.1), (-102.1, -273.2))
"""First row of Table I, um: along the long edge, then along its normal."""
WIDE = ((-780.0, 400.0), (-780.0, -400.0), (780.0, 0.0))


def around(middle: float, reach: float) -> Interval:
    return Interval((middle - reach) * UM, (middle + reach) * UM)


def push(places: tuple[tuple[float, float], ...], offset: float, reach: float = 5.0) -> DryPush:
    return DryPush(
        depth=around(418.5, 1.0),
        offset=around(offset, 8.0),
        radius=around(7.5, 5.0),
        places=tuple((around(x, reach), around(y, reach)) for x, y in places),
        friction=Interval(0.30, 0.36),
    )


def angles(low: float, high: float) -> Interval:
    return Interval(math.radians(low), math.radians(high))


def rate(edge: float, contact: Floats, supports: Floats, loads: Floats) -> tuple[float, Floats]:
    """The turn per travel that dissipates least, and the push, all in the part's frame."""
    ahead = -np.array([math.cos(edge), math.sin(edge)])  # of the tip: -e_x along a and n
    arms = supports - contact

    def speeds(omega: float) -> Floats:
        # counter-clockwise in the world; (a, n) is a left-handed pair, so the turn is reversed here
        return ahead + omega * np.stack([arms[:, 1], -arms[:, 0]], axis=1)

    def power(omega: float) -> float:
        return float(loads @ np.hypot(*speeds(omega).T))

    found = float(
        minimize_scalar(power, bounds=(-8e3, 8e3), method="bounded", options={"xatol": 1e-9}).x
    )
    moving = speeds(found)
    return found, loads @ (moving / np.hypot(*moving.T)[:, None])


def followed(
    draw: np.random.Generator, of: DryPush, start: Interval, travel: Interval
) -> tuple[float, float]:
    """The end of one run from the box, and its smallest margin to slipping."""

    def one(side: Interval) -> float:
        return float(draw.choice([side.lo, side.hi, draw.uniform(side.lo, side.hi)]))

    depth, offset, radius, first = map(one, (of.depth, of.offset, of.radius, start))
    supports = np.array([[one(x), one(y)] for x, y in of.places])
    loads = np.linalg.solve(np.vstack([supports.T, np.ones(3)]), [0.0, 0.0, 1.0])
    edge, far, steps, margin = first, one(travel), 200, math.inf

    def at(angle: float) -> tuple[float, Floats]:
        return rate(angle, np.array([offset - radius * (angle - first), depth]), supports, loads)

    for _ in range(steps):
        slope, force = at(edge)
        margin = min(margin, of.friction.lo * -force[1] - abs(force[0]))
        middle, _ = at(edge + 0.5 * far / steps * slope)
        edge += far / steps * middle
    return edge, margin


@pytest.mark.parametrize(
    ("places", "offset", "start", "side"),
    [
        (TABLE_I, 130.0, angles(89.7, 90.3), 1),
        (WIDE, 200.0, angles(89.7, 90.3), 1),
        (WIDE, -130.0, angles(89.7, 90.3), -1),
    ],
)
def test_every_run_ends_inside_and_sticks(
    places: tuple[tuple[float, float], ...], offset: float, start: Interval, side: int
) -> None:
    of, travel = push(places, offset), around(100.0, 10.0)
    turn = turn_on_points(of, start, travel, side)
    assert turn.sticks
    draw = np.random.default_rng(5)
    runs = [followed(draw, of, start, travel) for _ in range(25)]
    ends = [end for end, _ in runs]
    assert turn.end.lo <= min(ends)
    assert max(ends) <= turn.end.hi
    assert min(margin for _, margin in runs) > 0.0
    assert turn.end.width < 3.0 * (max(ends) - min(ends))  # and not by being wide


def test_a_push_that_can_slip_is_not_proved_to_stick() -> None:
    of, start, travel = push(WIDE, 300.0), angles(89.7, 90.3), around(100.0, 10.0)
    draw = np.random.default_rng(5)
    assert min(followed(draw, of, start, travel)[1] for _ in range(10)) < 0.0
    assert not turn_on_points(of, start, travel, 1).sticks


def test_the_other_sense_is_not_proved() -> None:
    assert not turn_on_points(push(WIDE, 200.0), angles(89.7, 90.3), around(100.0, 10.0), -1).sticks


def test_a_support_that_may_carry_nothing_is_refused() -> None:
    with pytest.raises(NotApplicableError, match="centre of mass"):
        turn_on_points(push(TABLE_I, 130.0, 20.0), angles(89.7, 90.3), around(100.0, 10.0), 1)
