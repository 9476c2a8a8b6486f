"""Moments by hand, certificates and runs of the robust and the other push."""

from __future__ import annotations

import json

import numpy as np
import pytest

from meso_robust.reproduction.item import Setting
from meso_robust.reproduction.robust_motion import ITEM, NOMINAL, pair_forces, variants
from meso_robust.reproduction.robust_trials import (
    CAMERA,
    certified,
    differences,
    holds,
    made,
    refuted,
    seen,
    spread_of,
    why_not,
)


@pytest.mark.parametrize("test", [0, 1])
def test_forces_of_the_pair_balance_about_the_centre(test: int) -> None:
    trial = NOMINAL[test]
    upper, lower = pair_forces(trial)
    above, below = (trial.middle_um + side * 0.5 * trial.spacing_um for side in (1, -1))
    assert upper * above + lower * below == pytest.approx(0.0, abs=1e-9)
    assert upper + lower == pytest.approx(trial.spacing_um)
    assert (lower > 0.0) == (test == 0)


def test_only_test_2_breaks_the_condition_of_lemma_2() -> None:
    first, second, third = (certified(trial) for trial in NOMINAL)
    assert holds(first)
    assert not refuted(first)
    assert holds(third)
    assert not holds(second)
    assert "both tips push" in refuted(second)
    assert "both tips push" in why_not(second)


def test_a_robust_push_ends_where_the_tips_do_with_both_in_contact() -> None:
    move = made(NOMINAL[0], 20, 3)
    spread = spread_of(move, 3)
    assert spread.pair == 1.0
    assert spread.turn == pytest.approx(0.0, abs=1e-9)
    assert move.after[:, 2] == pytest.approx(np.full(40, np.pi / 2), abs=1e-9)
    # tips from 520 um by 800 um, the part half its width in front of them, the probe off by 5 um
    assert np.all(np.abs(move.after[:, 0] - (520.0 - 800.0 - 418.5) * 1e-6) < 5.01e-6)


def test_the_other_push_loses_a_tip_and_turns_on() -> None:
    spread = spread_of(made(NOMINAL[1], 20, 3), 3)
    assert spread.pair == 0.0
    assert spread.turn < -0.01
    assert spread.largest[2] > spread_of(made(NOMINAL[0], 20, 3), 3).largest[2]


def test_differences_are_the_largest_within_a_series() -> None:
    paths = np.zeros((5, 2, 3))
    paths[:, 1, 0] = [0, 1, 5, 100, 101]
    paths[:, 0, 1] = [2, -2, 0, 0, 1]
    assert differences(paths, 2) == pytest.approx(np.array([[1, 4, 0], [95, 0, 0]]))
    assert differences(paths, 5) == pytest.approx(np.array([[101, 4, 0]]))


def test_the_camera_errs_within_its_bounds() -> None:
    off = seen(np.zeros((50, 20, 3)), 1) / CAMERA
    assert np.all(np.abs(off) <= 1.0)
    assert off.std(axis=(0, 1)) == pytest.approx(np.full(3, 1 / np.sqrt(3)), rel=0.1)


def test_missing_inputs_are_varied_one_and_all() -> None:
    for test in range(3):
        trials = variants(test, quick=False)
        assert trials[0] == NOMINAL[test]
        assert len(set(trials)) == len(trials)
        assert len({trial.travel_um for trial in trials}) == 2
    assert len({trial.spacing_um for trial in variants(0, quick=False)}) == 3


def test_the_item_says_what_holds() -> None:
    found = ITEM.run(Setting(quick=True))
    rows = {row.quantity: row for row in found.rows}
    assert rows["Test 1: largest difference between trials in X"].printed == 20.0
    assert rows["Test 2: largest difference between trials in θ"].printed == 0.1
    kept, stands = (
        rows[f"Test {test}: runs that end with both tips in contact"].ours for test in (1, 2)
    )
    assert (kept, stands) == ((100.0, 100.0), (0.0, 0.0))
    first, second = (
        np.asarray(rows[f"Test {test}: largest difference between trials in θ"].ours, dtype=float)
        for test in (1, 2)
    )
    assert first[1] < second[1]
    assert "test 1" in found.answer
    json.dumps(found.data)
