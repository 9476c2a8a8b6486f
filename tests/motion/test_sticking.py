"""Turning in sticking contact against an integration from force balance."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pytest

from meso_robust.bounds import Interval
from meso_robust.motion import sticking
from tests.motion.sticking_reference import after

UM = 1e-6
ERROR = 1e-9  # of the integration


@dataclass(frozen=True)
class Case:
    side: int
    start: Interval
    travel: Interval
    depth: Interval
    offset: Interval
    ratio: Interval
    widest: float
    """Largest share by which the enclosure may exceed the sampled range."""


RHO = Interval(0.358e-6, 0.396e-6)
CASES = {
    "shipped tilt": Case(
        1,
        Interval(1.565, 1.576),
        Interval(140 * UM, 180 * UM),
        Interval(418.5 * UM, 418.5 * UM),
        Interval(326 * UM, 349 * UM),
        RHO,
        0.02,
    ),
    "mirrored": Case(
        -1,
        Interval(1.565, 1.576),
        Interval(140 * UM, 180 * UM),
        Interval(418.5 * UM, 418.5 * UM),
        Interval(-349 * UM, -326 * UM),
        RHO,
        0.02,
    ),
    "short edge, uncertain width": Case(
        1,
        Interval(1.50, 1.54),
        Interval(20 * UM, 60 * UM),
        Interval(805 * UM, 811 * UM),
        Interval(150 * UM, 260 * UM),
        RHO,
        math.inf,  # the width enters the travel many times; the package knows it exactly
    ),
    "short edge": Case(
        1,
        Interval(1.50, 1.54),
        Interval(20 * UM, 60 * UM),
        Interval(808 * UM, 808 * UM),
        Interval(150 * UM, 260 * UM),
        RHO,
        0.02,
    ),
    "known": Case(
        -1,
        Interval(1.6, 1.6),
        Interval(100 * UM, 100 * UM),
        Interval(400 * UM, 400 * UM),
        Interval(-300 * UM, -300 * UM),
        Interval(0.3e-6, 0.3e-6),
        0.0,
    ),
}


def points(sides: Sequence[Interval]) -> list[tuple[float, ...]]:
    """Corners and random points."""
    rng = np.random.default_rng(3)
    lo, hi = np.array([[side.lo, side.hi] for side in sides]).T
    chosen = set(itertools.product(*((side.lo, side.hi) for side in sides)))
    inside = {tuple(map(float, row)) for row in lo + rng.random((25, len(sides))) * (hi - lo)}
    return sorted(chosen | inside)


@pytest.mark.parametrize("name", CASES)
def test_angle_after_the_travel_lies_in_the_enclosure(name: str) -> None:
    case = CASES[name]
    sides = (case.start, case.travel, case.depth, case.offset, case.ratio)
    assert sticking.travel_monotone(
        case.start.hull(case.start + Interval.point(0.6 * case.side)),
        case.side,
        case.depth,
        case.offset,
        case.ratio,
    )
    found = sticking.turned(case.start, case.travel, case.side, case.depth, case.offset, case.ratio)
    ends = [after(*point)[2] for point in points(sides)]
    assert found.lo - ERROR <= min(ends)
    assert max(ends) <= found.hi + ERROR
    assert found.width <= (1 + case.widest) * (max(ends) - min(ends)) + 3 * sticking.RESOLUTION


def test_contact_point_by_geometry() -> None:
    angle, depth, rise = Interval(1.55, 1.65), Interval(4e-4, 4.2e-4), Interval(1e-4, 1.5e-4)
    offset = sticking.contact_offset(angle, depth, rise)
    reach = sticking.contact_reach(angle, depth, rise)
    for theta, d, y in points((angle, depth, rise)):
        # the edge: x sin - y cos = depth
        x = (d + y * math.cos(theta)) / math.sin(theta)
        along = x * math.cos(theta) + y * math.sin(theta)
        assert reach.lo - 1e-15 <= x <= reach.hi + 1e-15
        assert offset.lo - 1e-15 <= along <= offset.hi + 1e-15


def test_a_turn_beyond_the_candidates_is_not_bounded() -> None:
    found = sticking.turned(
        Interval(1.56, 1.58),
        Interval(5e-3, 5e-3),
        1,
        Interval(4e-4, 4e-4),
        Interval(3e-4, 3e-4),
        RHO,
    )
    assert found.hi == math.inf
    back = sticking.turned(
        Interval(1.56, 1.58),
        Interval(5e-3, 5e-3),
        -1,
        Interval(4e-4, 4e-4),
        Interval(-3e-4, -3e-4),
        RHO,
    )
    assert back.lo == -math.inf


def test_a_push_that_turns_the_other_way_is_not_bounded() -> None:
    """Below the middle the part turns clockwise, not counter-clockwise as asked."""
    sides = (Interval(4e-4, 4e-4), Interval(-3e-4, -2e-4), RHO)
    found = sticking.turned(Interval(1.56, 1.58), Interval(1e-4, 1e-4), 1, *sides)
    assert found.width == math.inf


def test_the_monotone_range_ends_where_the_slope_changes_sign() -> None:
    """At an upright edge the travel falls with the offset up to d2^2 = rho + d1^2."""
    upright, depth = Interval.point(math.pi / 2), Interval.point(4e-4)
    ratio = Interval.point(0.3769e-6)
    turn = math.sqrt(0.3769e-6 + 4e-4**2)
    below, across = Interval(1e-4, turn * (1 - 1e-6)), Interval(1e-4, turn * (1 + 1e-6))
    assert sticking.travel_monotone(upright, 1, depth, below, ratio)
    assert not sticking.travel_monotone(upright, 1, depth, across, ratio)
    assert not sticking.travel_monotone(upright, -1, depth, below, ratio)  # it turns the other way
