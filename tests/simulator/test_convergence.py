"""The stepper converges to the event-driven engine, which shares no code with it."""

import numpy as np
import pytest

from reports.simulator.convergence import FLOOR, cases, errors, order
from tests.simulator.problems import UM

CASES = cases()
LEVER = 800 * UM  # turns an angle into a length
SMOOTH = ("one point sticks", "full drag matrix, sticks", "two sides, both slip")


@pytest.mark.parametrize("name", CASES)
def test_halving_the_step_halves_the_error_at_least(name: str) -> None:
    found = errors(CASES[name], "start") * [1.0, LEVER]
    for column in found.T[found.max(axis=0) > FLOOR]:
        # From the longest step to the shortest; a single step may fall on an event by chance.
        assert column[-1] < 2.0 * column[0] / 32
        assert column[-1] < 0.1 * UM


@pytest.mark.parametrize("name", ["one point sticks", "one point slips", "full drag matrix, slips"])
def test_displacements_turned_at_the_start_of_a_step_are_of_first_order(name: str) -> None:
    assert order(errors(CASES[name], "start")[:, 0]) == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("name", SMOOTH)
def test_displacements_turned_about_the_middle_are_of_second_order(name: str) -> None:
    found = errors(CASES[name], "middle")
    assert order(found[:, 0]) == pytest.approx(2.0, abs=0.15)
    assert np.all(found < errors(CASES[name], "start"))
