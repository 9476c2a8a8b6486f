"""Gap and normal of a tip against distances to the segments of the outline."""

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings, strategies as st

from meso_robust.simulator.contact import locate, polygon_faces
from tests.simulator.problems import rectangle

F = npt.NDArray[np.float64]

HEXAGON = np.array([[np.cos(k), np.sin(k)] for k in (0.2, 1.1, 2.5, 3.3, 4.6, 5.5)])


def distance_to_outline(vertices: F, point: F) -> float:
    start, end = vertices, np.roll(vertices, -1, axis=0)
    share = np.sum((point - start) * (end - start), axis=1) / np.sum((end - start) ** 2, axis=1)
    foot = start + np.clip(share, 0, 1)[:, None] * (end - start)
    return float(np.min(np.hypot(*(point - foot).T)))


def is_inside(vertices: F, point: F) -> bool:
    to = vertices - point
    ahead = np.roll(to, -1, axis=0)
    return bool(np.all(to[:, 0] * ahead[:, 1] - to[:, 1] * ahead[:, 0] > 0))


@settings(deadline=None, max_examples=400)
@given(st.floats(-2, 2), st.floats(-2, 2))
def test_gap_is_the_distance_to_the_outline(x: float, y: float) -> None:
    gap, nx, ny, px, py = locate(polygon_faces(HEXAGON), x, y, 0.0, 0.0)
    point = np.array([x, y])
    distance = distance_to_outline(HEXAGON, point)
    assert abs(gap) == pytest.approx(distance, abs=1e-12)
    assert (gap < -1e-12) <= is_inside(HEXAGON, point) <= (gap < 1e-12)
    assert np.hypot(nx, ny) == pytest.approx(1.0)
    np.testing.assert_allclose([px + gap * nx, py + gap * ny], point, atol=1e-12)


@pytest.mark.parametrize(
    ("tip", "move", "normal", "gap"),
    [
        # Beyond the corner (808, 418.5), less than a step away.
        ((809.0, 418.6), (-5.0, 0.0), (0.0, 1.0), 0.1),  # grazes along the top
        ((808.1, 420.0), (0.0, -5.0), (1.0, 0.0), 0.1),  # grazes along the side
        ((809.0, 419.0), (-5.0, -1.0), (0.0, 1.0), 0.5),  # crosses the side's line, then the top
        ((809.0, 419.0), (-1.2, -5.0), (1.0, 0.0), 1.0),  # crosses the top's line, then the side
    ],
)
def test_tip_near_a_corner_is_held_off_by_the_edge_it_meets(
    tip: tuple[float, float],
    move: tuple[float, float],
    normal: tuple[float, float],
    gap: float,
) -> None:
    found = locate(polygon_faces(1e6 * rectangle()), *tip, *move)
    np.testing.assert_allclose(found, (gap, *normal, 808.0, 418.5), atol=1e-9)


def test_slow_tip_beyond_a_corner_faces_the_corner() -> None:
    found = locate(polygon_faces(1e6 * rectangle()), 811.0, 422.5, -1.0, 0.0)
    np.testing.assert_allclose(found, (5.0, 0.6, 0.8, 808.0, 418.5), atol=1e-9)


def test_tip_on_a_corner_has_an_edge_normal() -> None:
    gap, nx, ny, _, _ = locate(polygon_faces(rectangle()), 808e-6, 418.5e-6, 0.0, 0.0)
    assert gap == pytest.approx(0.0, abs=1e-18)
    assert sorted((nx, ny)) == [0.0, 1.0]
