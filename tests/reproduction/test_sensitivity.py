"""Growth of small errors: closed form of the linearised push on a film against the simulator."""

from __future__ import annotations

import json

import numpy as np
import pytest

from meso_robust.reproduction import sensitivity
from meso_robust.reproduction.eight_tests import SUPPORTS, TESTS, planned
from meso_robust.reproduction.item import Setting
from meso_robust.reproduction.printed import FILM_RATIO, PART
from meso_robust.reproduction.sensitivity import (
    ANGLE,
    BOXES,
    ITEM,
    RADIANS,
    amplification,
    ends,
    spread,
    starts,
)

DEPTH = 0.5 * PART.width
GROWTH = np.exp(DEPTH / (FILM_RATIO + DEPTH**2) * 700e-6)
"""Of the angle between force and centre over the push: dφ/ds = (d1 φ + d2)/(ρ + d1²), φ and d2 small."""


def test_the_corners_of_the_errors_come_first() -> None:
    shares = starts(np.random.default_rng(0), 5)
    assert shares.shape == (37, 5)
    assert len({tuple(corner) for corner in np.sign(shares[:32])}) == 32
    assert np.all(np.abs(shares[:32]) == 1.0)
    assert np.all(np.abs(shares[32:]) < 1.0)


def test_an_offset_across_the_push_grows_as_the_linear_push_says() -> None:
    shares = starts(np.random.default_rng(0), 0) * BOXES["5 um across the push alone"]
    turn = spread(ends(planned()["C"], "film", shares))[2]
    # part and tip are off by 5 um each: 10 um to either side
    assert turn == pytest.approx(2.0 * 10e-6 / DEPTH * (GROWTH - 1.0), rel=0.03)


@pytest.mark.parametrize("support", ["film", "p1*", "p2*"])
def test_an_angle_is_passed_on_as_the_force_still_meets_the_centre(support: str) -> None:
    for box, angle in (("0.005 deg alone", ANGLE), ("0.005 rad alone", RADIANS)):
        shares = np.array([[0, 0, -1.0, 0, 0], [0, 0, 1.0, 0, 0]]) * BOXES[box]
        turn = spread(ends(planned()["C"], support, shares))[2]
        assert turn == pytest.approx(2.0 * angle, rel=0.1)


def test_spread_is_from_least_to_most_at_the_end() -> None:
    paths = np.zeros((3, 2, 3))
    paths[:, 0] = [[9, 9, 9], [0, 0, 0], [0, 0, 0]]
    paths[:, 1] = [[1, 0, 2], [4, 0, -2], [2, 5, 0]]
    assert spread(paths) == pytest.approx([3, 5, 4])


def test_amplification_is_c_over_b() -> None:
    compared = np.zeros((8, 3))
    compared[TESTS.index("C"), 2], compared[TESTS.index("B"), 2] = 6.0, 4.0
    assert amplification(compared) == 1.5


def test_c_is_the_most_sensitive_test() -> None:
    found = ITEM.run(Setting(quick=True))
    of_tests = found.data["spread_of_tests_um_um_deg"]
    for support in ("film", "p1*", "p2*"):
        turns = {test: values[2] for test, values in of_tests[support].items()}  # type: ignore[index]
        assert max(turns, key=turns.__getitem__) == "C"
    assert {row.printed for row in found.rows if "spread of θ" in row.quantity} >= {
        "similar to that observed",
        None,
    }
    assert len(found.figures) == 2
    json.dumps(found.data)


def test_the_answer_says_only_what_the_numbers_do() -> None:
    def said(most: float, across: float) -> str:
        turns = {box: np.array([0.0, 0.0, np.deg2rad(2.0)]) for box in sensitivity.BOXES}
        turns[sensitivity.ACROSS] = np.array([0.0, 0.0, np.deg2rad(across)])
        tests = np.full((8, 3), 1.0)
        tests[TESTS.index("C"), 2] = most
        names = SUPPORTS
        return sensitivity._answer(dict.fromkeys(names, turns), dict.fromkeys(names, tests))

    assert "The sensitivity stands:" in said(2.0, 1.9)
    assert "95 to 95 %" in said(2.0, 1.9)
    assert "The sensitivity falls:" in said(0.5, 0.2)
    assert "10 to 10 %" in said(0.5, 0.2)
