"""Overlaps of tips and parts, by geometry that can be told by hand."""

import numpy as np
import pytest

from meso_robust.identification.touching import distances, freed
from meso_robust.simulator.checks import depth_inside
from tests.identification.sets import PART

OUTLINE = PART.outline[None]
UM = 1e-6


def test_distances_agree_with_those_of_the_simulators_own_check() -> None:
    points = np.random.default_rng(0).uniform(-1e-3, 1e-3, (500, 2))
    distance, out = distances(OUTLINE, points)
    np.testing.assert_allclose(distance, -depth_inside(PART.outline, points), atol=1e-15)
    further, _ = distances(OUTLINE, points + 1e-9 * out)
    np.testing.assert_allclose(further - distance, 1e-9, rtol=1e-4)


@pytest.mark.parametrize("angle", [0.0, 0.7, np.pi])
def test_a_tip_three_um_inside_moves_the_part_by_three_um_across_the_edge(angle: float) -> None:
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    pose = np.array([[1e-4, -2e-4, angle]])
    tip = pose[0, :2] + turn @ np.array([200 * UM, 418.5 * UM + 12.5 * UM - 3 * UM])
    shift, left = freed(pose, tip[None, None], OUTLINE, np.array([[12.5 * UM]]))
    np.testing.assert_allclose(shift[0], turn @ [0.0, -3 * UM], atol=1e-15)
    assert left[0] <= 1e-15


def test_a_part_that_is_free_stays() -> None:
    tips = np.array([[[0.0, 500 * UM], [0.0, -500 * UM]]])
    shift, left = freed(np.zeros((1, 3)), tips, OUTLINE, np.full((1, 2), 12.5 * UM))
    assert not shift.any()
    assert left[0] < 0.0


def test_a_part_between_tips_that_are_too_close_is_caught() -> None:
    tips = np.array([[[0.0, 400 * UM], [0.0, -400 * UM]]])
    _, left = freed(np.zeros((1, 3)), tips, OUTLINE, np.full((1, 2), 12.5 * UM))
    assert left[0] > 10 * UM
