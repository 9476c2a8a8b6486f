"""Outlines in rational numbers: what is refused, and the hull against another library's."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from meso_robust.corners import fault, hull
from meso_robust.errors import InputError
from meso_robust.task import PolygonPart, parse_task
from tests.polygons import SHIPPED, values_of

L = [[-440, -440], [760, -440], [760, -40], [-40, -40], [-40, 760], [-440, 760]]
BAD: dict[str, tuple[Any, tuple[str, ...]]] = {
    "too few": (L[:2], ("part.polygon_um", "at least 3")),
    "too many": ([[k, k * k] for k in range(65)], ("part.polygon_um", "at most 64")),
    "clockwise": (L[::-1], ("part: polygon_um", "run clockwise", "reverse their order")),
    "crossing": ([L[0], L[2], L[1], L[3]], ("sides after corners 0 and 2 touch or cross",)),
    "touching": (
        [[-9, -9], [9, -9], [9, 9], [0, -9], [-9, 9]],
        ("sides after corners 0 and 2 touch or cross",),
    ),
    "straight": ([L[0], [0, -440], *L[1:]], ("corner 1 lies on the line",)),
    "turning straight back": ([L[0], [9, -440], [3, -440], *L[2:]], ("corner 1 lies on",)),
    "twice": ([L[0], *L], ("corners 0 and 1 are less than 1 um apart",)),
    "around another point": ([[x + 440, y] for x, y in L], ("outside the convex hull", "centre")),
    "not a number": ([[float("nan"), 0.0], *L[1:]], ("part.polygon_um.0.0", "nan", "finite")),
    "three coordinates": ([[1.0, 2.0, 3.0], *L[1:]], ("part.polygon_um.0", "at most 2")),
    "text": ("L", ("part.polygon_um", "'L'", "array")),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_outline_is_refused_by_key_and_rule(name: str) -> None:
    corners, words = BAD[name]
    values = values_of(SHIPPED["L-shape"])
    values["part"] = {"polygon_um": corners}
    with pytest.raises(InputError) as caught:
        parse_task(values, "task")
    for word in words:
        assert word in str(caught.value)


def test_a_part_is_a_rectangle_or_a_polygon_not_both() -> None:
    values = values_of(SHIPPED["L-shape"])
    values["part"]["length_um"] = 1200.0
    with pytest.raises(InputError, match=r"part\.length_um is unknown"):
        parse_task(values, "task")


def test_the_shipped_outlines_are_about_their_centroids_with_the_film_of_an_even_one() -> None:
    for path in SHIPPED.values():
        task = parse_task(values_of(path), "task")
        assert isinstance(task.part, PolygonPart)
        x, y = np.array(task.part.polygon_um).T
        # areas and moments from a fine grid of points, not from the corners
        own = np.meshgrid(*(np.arange(-800.5, 801.0, 1.0),) * 2)
        inside = np.zeros(own[0].shape, dtype=bool)
        for x0, y0, x1, y1 in zip(x, y, np.roll(x, -1), np.roll(y, -1), strict=True):
            if y0 != y1:
                right = x0 + (own[1] - y0) * (x1 - x0) / (y1 - y0)
                inside ^= ((y0 > own[1]) != (y1 > own[1])) & (own[0] < right)
        points = np.array([side[inside] for side in own])
        np.testing.assert_allclose(points.mean(axis=1), 0.0, atol=0.5)
        ratio = (points**2).sum(axis=0).mean()
        assert ratio == pytest.approx(task.uncertainty.film_ratio_um2, rel=1e-3)


def test_the_hull_is_that_of_another_library() -> None:
    rng = np.random.default_rng(3)
    for count in (3, 5, 9, 40):
        points = rng.integers(-50, 50, (count, 2))
        found = hull([(Fraction(int(x)), Fraction(int(y))) for x, y in points])
        wanted = {tuple(points[k]) for k in ConvexHull(points).vertices}
        assert {tuple(points[k]) for k in found} == wanted
        x, y = points[list(found)].T
        assert np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) > 0


def test_a_good_outline_has_no_fault() -> None:
    assert fault([(Fraction(x), Fraction(y)) for x, y in L]) is None
