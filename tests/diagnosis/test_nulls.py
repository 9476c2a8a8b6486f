"""Recordings without a mismatch: as white, as large and as coloured as they are said to be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.nulls import null_rows
from tests.diagnosis.conftest import baseline_of, coloured, small_set

Floats = npt.NDArray[np.float64]
COUNT = 40


def sums(baseline: Baseline, rows: Floats) -> Floats:
    """(B,) squares that are left of nulls, over what white noise would leave."""
    taken = 3 * len(baseline.prepared.files) + len(baseline.model.parameters)
    left = baseline.tangent.evidence(rows)
    return np.asarray(np.sum(left**2, axis=1) / (baseline.seen.sum() - taken))


def neighbours(baseline: Baseline, rows: Floats) -> float:
    """Mean product of neighbouring frames over the mean square."""
    count, frames = baseline.seen.shape[:2]
    white = rows.reshape(-1, count, frames, 3)
    both = baseline.seen[:, 1:] & baseline.seen[:, :-1]
    products = (white[:, :, 1:] * white[:, :, :-1])[:, both]
    return float(products.mean() / (white[:, :, 1:][:, both] ** 2).mean())


def test_nulls_leave_white_noise_and_nothing_else(null: Diagnosis) -> None:
    at = null.baseline
    rows = null_rows(at, COUNT, 1)
    left = sums(at, rows)
    free = float(at.seen.sum())
    assert rows.shape == (COUNT, len(at.prepared.files), 3 * at.seen.shape[1])
    assert left.mean() == pytest.approx(1.0, abs=5.0 * np.sqrt(2.0 / free / COUNT) + 2e-3)
    assert 0.6 < left.std() / np.sqrt(2.0 / free) < 1.6
    assert neighbours(at, rows) == pytest.approx(0.0, abs=0.02)
    # the fit of each null is at its end: what parameters and starts could take is taken
    taken = np.sum(rows**2, axis=(1, 2)) - left * (free - 3.0 * len(at.prepared.files) - 2.0)
    assert np.all(taken < 1.0)


def test_frames_that_were_lost_are_lost_again(null: Diagnosis) -> None:
    at = null.baseline
    seen = at.seen.copy()
    seen[0, 20:25] = False
    blind = replace(
        at,
        prepared=replace(at.prepared, seen=np.where(seen, at.prepared.seen, np.nan)),
        tangent=replace(at.tangent, seen=seen),
    )
    rows = null_rows(blind, 3, 0).reshape(3, *seen.shape)
    assert np.all(rows[:, ~seen] == 0.0)
    assert np.all(rows[:, seen] != 0.0)


def test_the_seed_makes_the_nulls(null: Diagnosis) -> None:
    first, again, other = (null_rows(null.baseline, 3, seed) for seed in (4, 4, 5))
    np.testing.assert_array_equal(first, again)
    assert not np.any(np.all(first == other, axis=(1, 2)))


def test_nulls_have_the_colour_of_the_noise(null: Diagnosis) -> None:
    known = coloured(null.baseline, 0.6)
    rows = null_rows(known, COUNT, 2)
    assert neighbours(known, rows) == pytest.approx(0.0, abs=0.02)
    ignored = replace(known, tangent=null.baseline.tangent)
    assert neighbours(ignored, null_rows(ignored, 10, 2)) == pytest.approx(0.6, abs=0.04)


def test_what_is_not_known_of_the_noise_is_drawn(null: Diagnosis) -> None:
    vague = coloured(null.baseline, 0.0, freedom=10.0)
    left = sums(vague, null_rows(vague, COUNT, 3))
    # x, y and θ each with σ (1 + 0.22 n): the mean of three squares has a deviation of 0.26
    assert 0.15 < left.std() < 0.4
    assert left.mean() == pytest.approx(1.0 + 1.0 / 20.0, abs=0.15)


def test_nulls_end_well_where_friction_hardly_shows() -> None:
    # pushes that stick: from a friction of about their slant on nothing depends on it
    at = baseline_of(small_set(None, count=6, seed=14))
    left = sums(at, null_rows(at, 20, 0))
    assert left.max() < 1.3
