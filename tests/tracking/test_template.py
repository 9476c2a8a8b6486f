"""The search over a whole frame."""

from __future__ import annotations

import math

import numpy as np
import pytest

from meso_robust.tracking.template import STEP, candidates, symmetry
from tests.tracking.drawing import CORNERS, digitised, plain

SQUARE = np.array([[-50.0, -50], [50, -50], [50, 50], [-50, 50]])


def test_symmetry_of_outlines_about_their_reference_point() -> None:
    hexagon = [[60.0 * math.cos(a), 60.0 * math.sin(a)] for a in np.arange(6) * math.pi / 3.0]
    assert symmetry(CORNERS) == 2
    assert symmetry(SQUARE) == 4
    assert symmetry(np.array(hexagon)) == 6
    assert symmetry(SQUARE + np.array([3.0, 0.0])) == 1  # the reference point lies off the centre
    assert symmetry(np.array([[-50.0, -30], [70, -30], [-50, 60]])) == 1


@pytest.mark.parametrize("levels", [(60.0, 170.0), (180.0, 40.0)])
def test_the_best_candidate_is_near_the_part(levels: tuple[float, float]) -> None:
    rng = np.random.default_rng(0)
    for _ in range(3):
        pose = np.array([rng.uniform(220, 420), rng.uniform(180, 300), rng.uniform(0, math.pi)])
        found = candidates(digitised(plain(pose, 1.0, *levels), rng), None, CORNERS, 4)[0]
        assert np.hypot(*(found - pose)[:2]) < 8.0
        turn = (found[2] - pose[2] + 0.5 * math.pi) % math.pi - 0.5 * math.pi
        assert abs(turn) < STEP
