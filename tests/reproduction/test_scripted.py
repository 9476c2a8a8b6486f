"""The seven-step plan: the printed numbers by hand, and the shape of plans with other lengths."""

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.reproduction import scripted, seven_steps
from meso_robust.reproduction.bench import START, Place, follow, nominal


def test_the_printed_plan_ends_where_table_ii_adds_up_to() -> None:
    way = seven_steps.PRINTED[0]
    assert way.shape == (8, 2)
    assert way[0] == pytest.approx([3.05e-3, -1.24e-3])
    assert way[-1] == pytest.approx([0.55e-3, -1.415e-3])
    assert way[2] == pytest.approx([1.55e-3, -0.64e-3])


def test_the_printed_lengths_give_the_printed_plan() -> None:
    lengths = seven_steps.lengths_of(seven_steps.PRINTED)
    assert lengths == pytest.approx([600e-6, 1500e-6, 50e-6, 775e-6])
    assert seven_steps.with_lengths(lengths[None])[0] == pytest.approx(
        seven_steps.PRINTED[0], abs=1e-12
    )


def test_the_printed_plan_turns_a_free_peg_towards_the_slot_but_not_by_a_quarter() -> None:
    far = Place(mouth=-2e-3, axis=-1.36e-3)
    done = follow(seven_steps.PRINTED, nominal("film"), far, record=1)
    turned = np.rad2deg(done.paths[0][0, :, 2] - START[2])
    assert turned[:2] == pytest.approx([0.0, 0.0], abs=1e-6)  # the tip only moves up beside the peg
    assert 40.0 < turned[3] < 60.0


def test_places_leave_the_peg_free_and_all_walls_are_tried() -> None:
    found = scripted.places(quick=False)
    assert {place.friction for place in found} == set(scripted.WALLS)
    top = START[1] + 0.5 * (1616e-6 * np.sin(START[2]) + 837e-6 * np.cos(START[2]))
    assert all(top < place.axis + 968e-6 for place in found)


def test_the_cost_is_the_distance_of_a_peg_that_is_not_touched() -> None:
    place = Place()
    lengths = np.array([[0.2e-3, 0.1e-3, 0.0, 1.5e-3]])  # the last push passes below the peg
    x = START[0] - (0.55e-3 - 12.5e-6 - 808e-6)
    y, turn = START[1] - place.axis, 525.3e-6 * np.deg2rad(89.0)  # the other end ahead
    expected = np.sqrt(x**2 + y**2 + turn**2)
    assert seven_steps.mean_cost(lengths, nominal("film"), place) == pytest.approx(
        [expected / (expected + 0.3e-3)], rel=1e-3
    )


def test_the_mean_cost_is_that_of_the_runs() -> None:
    place, runs = Place(), nominal("film", 3)
    lengths = np.array([[600e-6, 600e-6, 50e-6, 775e-6], [200e-6, 100e-6, 0.0, 1500e-6]])
    away = np.array([[0.0, 0.0, 0.0], [5e-5, 0.0, 0.0], [0.0, 5e-5, 0.0]])
    shifted = replace(runs, poses=runs.poses + away)
    whole = seven_steps.mean_cost(lengths, shifted, place)
    for k, own in enumerate(lengths):
        each = [
            seven_steps.mean_cost(own[None], shifted.where(np.array([j])), place)[0]
            for j in range(3)
        ]
        assert whole[k] == pytest.approx(np.mean(each))
