"""The sampled search of Section IX-D: its steps, where it is unsound, and the certified one."""

from __future__ import annotations

import itertools
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from meso_robust import units
from meso_robust.bounds import HALF_PI, Interval
from meso_robust.planning.motion_search import (
    STICKING_TURN,
    Choice,
    RobustMotion,
    at_all_corners,
    over_the_box,
    robust_motion,
)

UM = 1e-6
PAPER: dict[str, Interval] = {
    "theta": HALF_PI + units.radians(-0.3).hull(units.radians(0.3)),
    "d1": units.metres(418.5),
    "rho": units.square_metres(376900.0 * 0.95).hull(units.square_metres(376900.0 * 1.05)),
    "mu": units.plain(0.30).hull(units.plain(0.36)),
    "side": Interval.point(1.0),
}
EDGE = Choice(name="d2", low=-808 * UM, high=808 * UM, control=10 * UM)


def search(test: Any, **changes: Any) -> RobustMotion | None:
    uncertain = {**PAPER, **changes.pop("uncertain", {})}
    choice = changes.pop("choice", EDGE)
    return robust_motion(STICKING_TURN, [choice], uncertain, test)


@pytest.mark.parametrize("test", [at_all_corners, over_the_box])
def test_the_first_robust_sample_along_the_edge(test: Any) -> None:
    """By hand: sticking at 90 deg needs d1 |d2| < mu (d1^2 + rho), so |d2| < 395.8 um at mu = 0.3
    and the nominal rho, 384.1 um less 10 um of control at the least rho; turning needs d2 > 0.

    Samples: 0 (does not turn), +-404 (slips at mu = 0.3), then +-202.
    """
    found = search(test)
    assert found is not None
    assert found.inputs["d2"] == pytest.approx(202 * UM)
    assert found.dispersion["d2"] == pytest.approx(202 * UM)
    assert found.tested == 2  # 404 um passes the nominal test with mu = 0.33, not the maximal one


def test_nothing_robust_ends_at_the_control_uncertainty() -> None:
    seen: list[float] = []

    def never(_: object, box: Any) -> bool:
        seen.append(box["d2"].mid)
        return False

    assert search(never) is None
    level = sorted({round(value / UM, 3) for value in seen})
    gaps = {round(b - a, 3) for a, b in itertools.pairwise(level)}
    # 808 / 2^7 = 6.3125 is the first dispersion that is no larger than 10
    assert gaps == {6.312, 6.313}


def test_a_slippery_tip_has_no_robust_motion() -> None:
    slippery = {"mu": Interval(0.001, 0.36)}
    assert search(at_all_corners, uncertain=slippery) is None


def test_every_dimension_is_halved_down_to_its_own_control_uncertainty() -> None:
    choices = [
        Choice(name="d2", low=0.0, high=8.0, control=1.0),
        Choice(name="d1", low=0.0, high=8.0, control=4.0),
    ]
    tried: list[tuple[float, float]] = []

    def note(_: object, box: Any) -> bool:
        tried.append((box["d1"].mid, box["d2"].mid))
        return False

    everywhere = {"theta": HALF_PI, "rho": Interval.point(1.0), "mu": Interval.point(50.0)}
    property_ = (("one_point_sticking", "normal_force"),)
    assert robust_motion(property_, choices, everywhere, note) is None
    assert {d1 for d1, _ in tried} == {4.0}
    assert {d2 for _, d2 in tried} == set(np.arange(1.0, 8.0))


LONG_PART = {
    # an edge of 4 mm, far below upright: the friction margin dips between the ends of the range
    "theta": units.radians(82.0),
    "d1": units.metres(418.5),
    "rho": units.square_metres(376900.0),
    "mu": units.plain(0.33),
}
MARGIN = (("one_point_sticking", "friction_margin"),)


def exact_margin(d2: Fraction) -> float:
    """mu lambda_n - lambda_t (first of the two), by hand, over cos(theta) > 0."""
    tangent = Fraction(np.tan(np.radians(82.0)))
    d1, rho, mu = Fraction(4185, 10**7), Fraction(3769, 10**10), Fraction(33, 100)
    return float(mu * d1 * d2 + d2**2 + rho + tangent * (d1 * d2 + mu * (d1**2 + rho)))


def test_corners_can_pass_where_the_box_fails() -> None:
    """The margin is a parabola in d2 with its lowest point at -d1 (mu + tan theta)/2 = -1.56 mm."""
    lowest = Fraction(-156, 10**5)
    ends = Fraction(-28, 10**4), Fraction(-3, 10**4)
    assert exact_margin(lowest) < 0.0 < min(map(exact_margin, ends))
    box = {**LONG_PART, "d2": Interval(-2.8e-3, -0.3e-3)}
    first = (("one_point_sticking", "friction_margin"),)
    sampled, proved = at_all_corners(first, box), over_the_box(first, box)
    assert not proved
    assert sampled
    choice = Choice(name="d2", low=-1.55e-3 - 1.25e-3, high=-1.55e-3 + 1.25e-3, control=1.25e-3)
    nominal_passes = {**LONG_PART, "mu": Interval(0.33, 0.33)}
    assert robust_motion(first, [choice], nominal_passes, over_the_box) is None


def test_an_argument_without_a_range_is_named() -> None:
    with pytest.raises(ValueError, match=r"friction_margin depends on mu: add"):
        robust_motion(MARGIN, [EDGE], {k: v for k, v in PAPER.items() if k != "mu"}, over_the_box)


@pytest.mark.parametrize(("low", "high", "control"), [(1.0, 1.0, 1.0), (0.0, 1.0, 0.0)])
def test_a_choice_that_cannot_be_sampled_is_refused(
    low: float, high: float, control: float
) -> None:
    with pytest.raises(ValueError, match="choice d2 needs low < high and control > 0"):
        Choice(name="d2", low=low, high=high, control=control)
