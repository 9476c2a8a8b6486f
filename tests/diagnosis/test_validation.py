"""Errors on recordings that no fit has seen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.validation import (
    Errors,
    errors,
    extrapolated,
    trained,
    without,
)
from meso_robust.recordings import RecordingSet
from tests.diagnosis.conftest import small_set
from tests.diagnosis.designs import VALUES
from tests.identification.sets import UM

Floats = npt.NDArray[np.float64]


@pytest.fixture(scope="module")
def fresh() -> RecordingSet:
    """A slow and a fast push of the null set's kind."""
    recordings = small_set(None, count=4, seed=21)
    return without(recordings, {"push_02.csv", "push_03.csv"})


@pytest.fixture(scope="module")
def true(fresh: RecordingSet, null: Diagnosis) -> Errors:
    return errors(fresh, null.baseline.model, VALUES, null.baseline)


def test_of_the_true_model_noise_is_left(true: Errors) -> None:
    free = float(true.at.seen.sum())
    assert true.whole == pytest.approx(1.0, abs=4.0 / np.sqrt(2.0 * free) + 0.01)
    # x and y of 1.2 µm each, two of some two hundred numbers taken by the start
    assert true.whole_metres == pytest.approx(np.sqrt(2.0) * 1.2 * UM, rel=0.08)
    assert true.poses.shape == true.prepared.seen.shape
    np.testing.assert_array_equal(np.isnan(true.poses), ~true.at.seen)


def test_whole_errors_count_every_number_once(true: Errors) -> None:
    uneven = replace(true, sigma=np.array([1.0, 4.0]), metres=np.array([1.0, 5.0]) * UM)
    free = true.at.seen.sum(axis=(1, 2)) - 3.0
    frames = true.at.seen[..., 0].sum(axis=1)
    assert uneven.whole == pytest.approx(np.sqrt((free[0] + 16.0 * free[1]) / free.sum()))
    assert uneven.whole_metres == pytest.approx(
        UM * np.sqrt((frames[0] + 25.0 * frames[1]) / frames.sum())
    )


def test_rows_are_the_white_residuals_of_the_poses(true: Errors, null: Diagnosis) -> None:
    scaled = (true.prepared.seen - true.poses) / null.baseline.settings.sigma
    phi = null.baseline.noise.correlation
    free = true.at.seen.sum(axis=(1, 2)) - 3.0
    for r, one in enumerate(scaled):
        kept = one[np.isfinite(one[:, 0])]
        factor = np.linalg.cholesky(phi ** np.abs(np.subtract.outer(*2 * (np.arange(len(kept)),))))
        squares = float(np.sum(np.linalg.solve(factor, kept) ** 2))
        # of a fit at its end the starts have nothing left to take, but for colour and a prior
        assert np.sum(true.rows[r] ** 2) == pytest.approx(squares, abs=1.0)
        assert true.sigma[r] ** 2 == pytest.approx(np.sum(true.rows[r] ** 2) / free[r])
        away = np.hypot(*(true.prepared.seen[r] - true.poses[r])[: len(kept), :2].T)
        assert true.metres[r] == pytest.approx(np.sqrt(np.mean(away**2)))


def test_of_a_wrong_model_more_is_left(true: Errors, fresh: RecordingSet, null: Diagnosis) -> None:
    wrong = errors(fresh, null.baseline.model, VALUES * [2.0, 1.0], null.baseline)
    assert wrong.whole > 1.5 * true.whole
    assert wrong.whole_metres > true.whole_metres


def test_errors_of_the_fit_itself(null: Diagnosis, late: Diagnosis) -> None:
    plain = trained(null.baseline, None)
    np.testing.assert_allclose(
        np.sum(plain.rows**2), np.sum(null.baseline.rows**2), atol=1.0
    )  # the fit has left the starts nothing
    assert late.best is not None
    assert late.extended is not None
    assert late.plain.training.whole > 2.0
    assert late.extended.training.whole == pytest.approx(1.0, abs=0.1)


def test_another_kind_of_push_is_left_out_of_both_fits(late: Diagnosis) -> None:
    assert late.best is not None
    training = late.split.training
    found = extrapolated(training, late.baseline, late.best.refit)
    assert found is not None
    away = {one.file: float(np.hypot(*one.poses[0, :2])) for one in training.recordings}
    farthest = sorted(away, key=lambda file: -away[file])[:2]
    assert found.what == "the pushes farthest out"  # three of six are equally fast
    assert found.files == tuple(sorted(farthest)) == found.before.prepared.files
    assert found.after.whole == pytest.approx(1.0, abs=0.15)
    assert found.before.whole > 2.0


def test_pushes_all_of_a_kind_offer_no_extrapolation(late: Diagnosis) -> None:
    assert late.best is not None
    one = late.split.training.recordings[0]
    same = tuple(replace(one, file=f"push_{k:02d}.csv") for k in range(6))
    training = replace(late.split.training, recordings=same)
    was = late.baseline.prepared
    prepared = replace(
        was,
        waypoints=np.repeat(was.waypoints[:1], 6, axis=0),
        times=np.repeat(was.times[:1], 6, axis=0),
        starts=np.repeat(was.starts[:1], 6, axis=0),
    )
    base = replace(late.baseline, prepared=prepared)
    assert extrapolated(training, base, late.best.refit) is None
