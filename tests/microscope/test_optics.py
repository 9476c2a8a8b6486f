"""World to pixels and back."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from meso_robust.microscope import Optics, project, unproject


def test_the_map_follows_its_conventions() -> None:
    optics = Optics(pixel_size=5e-6, centre=(1e-3, 2e-3))
    points = np.array([[1e-3, 2e-3], [1.05e-3, 2e-3], [1e-3, 2.05e-3]])
    assert project(optics, points) == pytest.approx(
        np.array([[319.5, 239.5], [329.5, 239.5], [319.5, 229.5]])
    )


def test_a_camera_turned_counter_clockwise_sees_the_world_turned_clockwise() -> None:
    seen = project(Optics(pixel_size=1e-6, rotation=math.pi / 6), np.array([[100e-6, 0.0]]))
    assert seen[0] - [319.5, 239.5] == pytest.approx([100 * math.sqrt(0.75), 50.0])


def test_k1_moves_a_point_at_half_the_diagonal_by_that_fraction() -> None:
    optics = Optics(pixel_size=1e-6, k1=0.04)
    assert project(optics, np.array([400e-6, 0.0]))[0] - 319.5 == pytest.approx(416.0)
    assert project(optics, np.array([200e-6, 0.0]))[0] - 319.5 == pytest.approx(202.0)


@pytest.mark.parametrize("k1", [-0.1, -0.03, 0.0, 0.1])
def test_the_inverse_is_exact(k1: float) -> None:
    optics = Optics(k1=k1, rotation=0.4, centre=(3e-4, -1e-4), distortion_centre=(300.0, 250.0))
    pixels = np.random.default_rng(0).uniform([0, 0], [639, 479], (500, 2))
    assert np.abs(project(optics, unproject(optics, pixels)) - pixels).max() < 1e-9


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"pixel_size": 0.0}, "pixel_size"),
        ({"k1": 0.2}, "k1"),
        ({"blur": -1.0}, "blur"),
        ({"width": 8}, "size"),
    ],
)
def test_impossible_optics_are_refused(changes: dict[str, Any], word: str) -> None:
    with pytest.raises(ValueError, match=word):
        Optics(**changes)
