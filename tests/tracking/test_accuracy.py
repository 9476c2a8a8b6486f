"""The quick form of the accuracy campaign (the full one: ``python -m reports.tracking.accuracy``)."""

from __future__ import annotations

import math

import numpy as np
import pytest

from reports.tracking.accuracy import Result, measured, row, together


@pytest.fixture(scope="session")
def overall() -> Result:
    names = ("strong compression", "pushed by a probe", "lit through the slide")
    return together([measured(name, np.random.default_rng(7), 1, 36) for name in names])


def test_poses_are_right_to_a_tenth_of_a_px(overall: Result) -> None:
    assert overall.lost == 0
    assert overall.rms[:2].max() < 0.1
    assert overall.rms[2] < math.radians(0.05)
    assert overall.worst[:2].max() < 1.0


def test_stated_intervals_are_neither_too_narrow_nor_useless(overall: Result) -> None:
    assert overall.coverage.min() > 0.6  # three films: an error is much alike through a film
    assert np.all(np.median(overall.sigma, axis=0) < [0.2, 0.2, math.radians(0.05)])


def test_the_table_says_what_was_measured() -> None:
    error = np.array([[0.3, -0.4, 0.0], [0.3, 0.4, 0.001]])
    line = row(Result("x", error, np.full((2, 3), 0.2), 1, np.array([1e-3, 3e-3, 5e-3])))
    assert line == "| x | 3 | 1 | 0.300 | 0.400 | 0.0405 | 0.40 | 0.057 | 100 / 0 / 100 | 3.00 |"
