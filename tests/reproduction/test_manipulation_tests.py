"""Symmetry, hand-made displacements and the second engine against the eight tests."""

from __future__ import annotations

import json

import numpy as np
import pytest

from meso_robust.reproduction.eight_tests import BENCH, SUPPORTS, TESTS, planned, pushed
from meso_robust.reproduction.item import Found, Row, Setting
from meso_robust.reproduction.manipulation_tests import ITEM, moved, sideways, unmirrored


@pytest.fixture(scope="module")
def found() -> Found:
    return ITEM.run(Setting(quick=True))


def row(found: Found, start: str) -> Row:
    (one,) = [each for each in found.rows if each.quantity.startswith(start)]
    return one


def test_places_and_angles_are_those_of_the_paper() -> None:
    pushes = planned()
    asked = [pushes[name].asked * 1e6 for name in TESTS]
    assert asked == pytest.approx([808, 404, 0, -404, -808, 418.5, 0, -418.5])
    assert [pushes[name].start[2] for name in TESTS] == pytest.approx([np.pi / 2] * 5 + [np.pi] * 3)
    assert {pushes[name].travel[0] for name in TESTS} == {-(BENCH.gap + 700e-6)}


@pytest.mark.parametrize("support", SUPPORTS)
def test_pushes_through_the_centre_translate_on_any_support(support: str) -> None:
    pushes = planned()
    end = pushed([pushes["C"], pushes["G"]], support).poses
    assert end == pytest.approx(np.array([[-350e-6, 0, np.pi / 2], [-350e-6, 0, np.pi]]), abs=1e-12)


def test_the_film_knows_no_side_but_the_points_do(found: Found) -> None:
    turns = np.array(found.data["moved_um_um_deg"]["film"])  # type: ignore[index]
    image = turns[[4, 3, 7]] * [1, -1, -1]
    assert turns[[0, 1, 5]] == pytest.approx(image, abs=1e-6)
    assert np.all(turns[[0, 1, 5], 2] > 5.0)  # above the middle: counter-clockwise
    of_points = np.array(found.data["moved_um_um_deg"]["p1*"])  # type: ignore[index]
    assert np.abs(of_points[1] - of_points[3] * [1, -1, -1]).max() > 5.0


def test_the_measures_of_symmetry_see_a_lack_of_it() -> None:
    turns = np.zeros((8, 3))
    turns[0], turns[4] = [-3.0, -1.0, 0.5], [-3.0, 1.0, -0.25]
    turns[2] = [-7.0, 0.1, -0.2]
    assert unmirrored(turns) == pytest.approx(np.array([[0, 0, 0.25], [0, 0, 0], [0, 0, 0]]))
    assert sideways(turns) == pytest.approx(np.array([[0.1, 0.2], [0, 0]]))


def test_motion_is_counted_from_the_start() -> None:
    pushes = planned()
    starts = np.array([pushes[name].start for name in TESTS])
    assert moved(pushes, starts + np.array([1e-6, 2e-6, 0.1])) == pytest.approx(
        np.tile([1e-6, 2e-6, 0.1], (8, 1))
    )


def test_rows_stand_beside_the_print(found: Found) -> None:
    assert row(found, "Push after first contact").ours == pytest.approx(700.0)
    assert row(found, "Width of the slot").difference == 0.0
    assert row(found, "Test A: place").difference == pytest.approx(-25.0)
    engines = row(found, "Film: largest difference of the two engines").ours
    assert isinstance(engines, float)
    assert 0.0 < engines < 0.05
    json.dumps(found.data)


def test_the_pictures_name_sizes_and_tests(found: Found) -> None:
    task, tests = (figure.svg for figure in found.figures)
    for words in ("976", "837", "1616"):
        assert words in task
    assert all(f">{name}<" in tests for name in TESTS)
