"""Eqs. (3) and (4) by hand, loads by linear equations, and μ_s that cancels."""

from __future__ import annotations

import json

import numpy as np
import pytest

from meso_robust.reproduction.eight_tests import TESTS, planned, pushed
from meso_robust.reproduction.item import Found, Setting
from meso_robust.reproduction.printed import PART, POINTS
from meso_robust.reproduction.table_one import (
    FIRST,
    ITEM,
    SECOND,
    multiplied,
    pairs_of,
    recorded,
    scored,
    surface_friction_changes,
    vector,
    within,
)


@pytest.fixture(scope="module")
def found() -> Found:
    return ITEM.run(Setting(quick=True))


def test_eq_3_between_the_sets_as_worked_out_by_hand() -> None:
    tests = [planned()[name] for name in TESTS]
    apart = pushed(tests, FIRST).path - pushed(tests, SECOND).path
    apart[..., 2] *= 0.5 * np.hypot(1616e-6, 837e-6)
    by_hand = np.sqrt(np.mean(apart**2, axis=1)).max(axis=1)
    scores = scored(recorded(FIRST), vector(SECOND)[None])
    # its steps are finer about the first touch
    assert scores.trials[0] == pytest.approx(by_hand, rel=1e-3, abs=1e-9)
    assert scores.values[0] == pytest.approx(by_hand.mean(), rel=1e-3)


def test_a_set_explains_its_own_tests() -> None:
    scores = scored(recorded(SECOND), vector(SECOND)[None])
    assert np.all(scores.trials < 1e-8)
    assert within(scores, 1e-3) == list(TESTS)


def test_tests_beyond_twice_the_printed_errors_are_told() -> None:
    scores = scored(recorded(FIRST), vector(SECOND)[None])
    scores.axes[0, 1] = [79e-6, 81e-6, 0.0]
    scores.axes[0, 3] = [0.0, 0.0, 1e-3 * np.deg2rad(6.1)]
    scores.axes[0, 4] = [79e-6, 79e-6, 1e-3 * np.deg2rad(5.9)]
    kept = within(scores, 1e-3)
    assert "B" not in kept
    assert "D" not in kept
    assert "E" in kept


def test_all_28_pairs_by_hand() -> None:
    pairs = pairs_of(np.arange(8.0))
    assert len(pairs) == 28
    assert (pairs["AB"], pairs["CH"], pairs["GH"]) == (0.5, 4.5, 6.5)


@pytest.mark.parametrize("name", list(POINTS))
def test_surface_friction_changes_nothing(name: str) -> None:
    same, largest = surface_friction_changes(name)
    assert same
    assert 0.0 <= largest < 1e-11  # m or rad: rounding
    weak, strong = (multiplied(name, factor)[1].tables().points for factor in (0.01, 100.0))
    assert strong[..., 2] == pytest.approx(1e4 * weak[..., 2])  # it is there in every force


def test_loads_balance_the_weight_about_the_centre(found: Found) -> None:
    for name, own in POINTS.items():
        by_hand = np.linalg.solve(np.vstack([np.ones(3), own.T]), [1.0, 0.0, 0.0])
        assert found.data["loads"][name] == pytest.approx(by_hand)  # type: ignore[index]


def test_the_table_is_read_so_that_all_points_lie_in_the_part() -> None:
    for own in POINTS.values():
        assert np.all(np.abs(own) <= [0.5 * PART.length, 0.5 * PART.width])
    assert np.abs(POINTS[SECOND]).max(axis=0) == pytest.approx([794.0e-6, 412.4e-6])


def test_rows_and_pictures(found: Found) -> None:
    (whole,) = [row for row in found.rows if row.quantity.startswith("F, eq. (4)")]
    f_um = found.data["f_um"]
    assert isinstance(f_um, dict)
    assert whole.ours == pytest.approx(np.mean(list(f_um.values())))
    assert found.answer.startswith("Near-equivalent")
    assert "p1*" in found.figures[0].svg
    json.dumps(found.data)
