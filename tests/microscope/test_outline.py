"""Distances to outlines."""

from __future__ import annotations

import math

import numpy as np
import pytest

from meso_robust.microscope.outline import inset, rounded_distance, signed_distance

SQUARE = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
ELL = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 4.0], [0.0, 4.0]])


def test_distance_to_a_square_and_its_hole() -> None:
    x, y = np.array([1.0, 3.0, 3.0, 1.0]), np.array([1.0, 1.0, 3.0, 1.9])
    assert signed_distance((SQUARE,), x, y) == pytest.approx([-1.0, 1.0, math.sqrt(2.0), -0.1])
    hole = 0.5 * SQUARE + 0.5
    assert signed_distance((SQUARE, hole), x, y) == pytest.approx([0.5, 1.0, math.sqrt(2.0), -0.1])


def test_rounding_moves_convex_corners_only() -> None:
    r = 0.25

    def at(x: float, y: float) -> float:
        return float(rounded_distance(ELL, r, np.array(x), np.array(y)))

    gone = r * (1.0 - math.sqrt(0.5))
    assert at(gone, gone) == pytest.approx(0.0, abs=1e-12)  # the arc meets the diagonal here
    assert at(2.5, 0.0) == pytest.approx(0.0, abs=1e-12)  # edges stay
    assert at(1.0, 1.0) == pytest.approx(0.0, abs=1e-12)  # and so does the reflex corner
    assert at(1.1, 1.1) == pytest.approx(0.1)


def test_a_radius_too_large_for_an_edge_is_refused() -> None:
    with pytest.raises(ValueError, match="corner radius"):
        inset(SQUARE, 1.01)
