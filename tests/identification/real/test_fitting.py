"""Robust fits: simulated truth recovered, outliers borne, held-out pushes not looked at."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.identification.models import viscous
from meso_robust.identification.prepared import prepare
from meso_robust.recordings import RecordingSet
from meso_robust.simulator import Film
from meso_robust.simulator.observation import Sensor
from reports.identification.real.fitting import (
    Problem,
    difference,
    errors,
    fitted,
    folds_of,
    held_out,
    interval,
    losses,
    residuals,
    root_mean_square,
)
from tests.identification.sets import PART, random_pushes, recorded

TRUE = np.array([0.3769e-6, 0.33])
START = np.array([0.2e-6, 0.2])
PUSHES = 8


@pytest.fixture(scope="module")
def recordings() -> RecordingSet:
    """Pushes on a film by the event-driven engine, all but without noise."""
    rng = np.random.default_rng(3)
    sensor = Sensor(position_sigma=1e-9, orientation_sigma=1e-6, frame_rate=20.0)
    return recorded(
        random_pushes(rng, PUSHES, 0.8),
        Film.ratio(np.full(PUSHES, TRUE[0])),
        float(TRUE[1]),
        rng,
        sensor=sensor,
    )


def problem_of(recordings: RecordingSet) -> Problem:
    model = viscous(PART.outline)
    return Problem(prepared=prepare(recordings, step=model.step), model=model, scale=1e-5)


def spoilt(recordings: RecordingSet, row: int) -> RecordingSet:
    """One recording with a part that turns where none did."""
    own = list(recordings.recordings)
    poses = own[row].poses + np.linspace(0.0, 1.0, len(own[row].times))[:, None] * (0.0, 0.0, 0.5)
    own[row] = replace(own[row], poses=poses)
    return replace(recordings, recordings=tuple(own))


def test_truth_is_recovered_and_unseen_pushes_are_predicted(recordings: RecordingSet) -> None:
    problem = problem_of(recordings)
    fit = fitted(problem, START)
    assert np.allclose(fit.values, TRUE, rtol=0.02)
    folds = folds_of(problem.pushes, 4, 1, seed=0)
    unseen = root_mean_square(held_out(problem, START, folds))
    assert unseen[0] < 2e-6
    assert unseen[1] < np.radians(0.1)
    whole = 0.5 * losses(problem, fit.values[None]).sum()
    assert fit.cost == pytest.approx(whole, rel=1e-6, abs=0.0)


def test_one_false_push_does_not_carry_the_fit_away(recordings: RecordingSet) -> None:
    problem = problem_of(spoilt(recordings, 2))
    fit = fitted(problem, START)
    assert np.allclose(fit.values, TRUE, rtol=0.1)
    bad = errors(problem, fit.values)[:, 1]
    assert np.argmax(bad) == 2
    assert bad[2] > 0.2


def test_rows_that_are_left_out_are_not_looked_at(recordings: RecordingSet) -> None:
    rows = np.array([0, 1, 3, 4, 5])
    one, other = (
        fitted(problem_of(each), START, rows) for each in (recordings, spoilt(recordings, 2))
    )
    assert np.array_equal(one.values, other.values)


def test_an_unseen_push_is_predicted_from_the_others_only(recordings: RecordingSet) -> None:
    problem = problem_of(spoilt(recordings, 2))
    rest = np.setdiff1d(np.arange(PUSHES), [2])
    unseen = held_out(problem, START, [np.array([2]), rest])
    expected = errors(problem, fitted(problem, START, rest).values)
    assert np.array_equal(unseen[2], expected[2])
    assert not np.array_equal(unseen[3], expected[3])


def test_what_is_held_stays(recordings: RecordingSet) -> None:
    fit = fitted(problem_of(recordings), START, free=np.array([True, False]))
    assert fit.values[1] == START[1]
    assert fit.values[0] != START[0]


def test_errors_are_root_mean_squares_and_residuals_their_parts(recordings: RecordingSet) -> None:
    problem = problem_of(recordings)
    position, angle = errors(problem, START).T
    square = position**2 + (problem.prepared.length * angle) ** 2
    # a frame in which not everything is seen has no part in either; none is lost here
    assert np.allclose(np.sum(residuals(problem, START[None])[0] ** 2, axis=1), square)
    refused = residuals(problem, np.array([[-1.0, 0.3]]))
    assert np.all(refused == 0.1)


def test_folds_leave_every_push_out_as_often_as_asked() -> None:
    folds = folds_of(20, 4, 3, seed=1)
    assert [len(fold) for fold in folds] == [4] * 15
    assert np.array_equal(np.bincount(np.concatenate(folds)), np.full(20, 3))


def test_intervals_over_pushes_cover() -> None:
    """Of 200 samples of 40 Gaussian errors nine in ten intervals hold the true spread."""
    rng = np.random.default_rng(2)
    held = []
    for _ in range(200):
        low, high = interval(rng.normal(size=(40, 2)), draws=300)
        held.append((low <= 1.0) & (high >= 1.0))
    assert 0.80 < np.mean(held) < 0.95
    first, second = rng.normal(1.0, 0.1, 60), rng.normal(0.0, 0.1, 60)
    low, high = difference(first, second)
    assert 0.9 < low < 1.0 < high < 1.1
