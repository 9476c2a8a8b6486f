"""The whole diagnosis of small sets of known truth."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meso_robust.diagnosis import detect as module, diagnose as diagnosing
from meso_robust.diagnosis.answer import document
from meso_robust.diagnosis.diagnose import Diagnosis, _numbers, diagnose
from meso_robust.diagnosis.evidence import evidence
from meso_robust.diagnosis.folds import intervals_by_fold
from meso_robust.diagnosis.judge import Explained
from meso_robust.diagnosis.noise import Noise
from meso_robust.diagnosis.validation import split
from meso_robust.recordings import RecordingSet
from tests.diagnosis.conftest import regraded, small_set
from tests.diagnosis.designs import SIGMA


def test_a_film_and_friction_are_consistent_with_themselves(null: Diagnosis) -> None:
    assert null.verdict == "consistent"
    assert null.naming is None
    assert null.located is None
    assert null.best is None
    assert null.extended is None
    assert null.plain.held_out is not None
    assert null.plain.held_out.whole == pytest.approx(1.0, abs=0.1)
    assert null.checked.extrapolation is None


def test_a_hidden_delay_is_named_and_explains_what_no_fit_has_seen(late: Diagnosis) -> None:
    assert late.verdict == "named"
    assert late.best is not None
    assert late.best.effects == ("camera_latency",)
    assert late.located is not None
    assert late.extended is not None
    assert late.plain.held_out is not None
    assert late.extended.held_out is not None
    assert late.plain.held_out.whole > 2.0
    assert late.extended.held_out.whole == pytest.approx(1.0, abs=0.1)


def test_places_are_told_from_the_worst_and_each_is_beyond_chance(late: Diagnosis) -> None:
    assert late.located is not None
    sigmas = [place.sigma for place in late.located.places]

    assert len(sigmas) > 1
    assert sigmas == sorted(sigmas, reverse=True)
    assert sigmas[-1] > 3.0  # one of 20 sets of 40 windows has a larger one by chance


def test_a_diagnosis_goes_on_from_what_was_kept_and_ends_the_same(
    monkeypatch: pytest.MonkeyPatch, null: Diagnosis, null_set: RecordingSet, null_store: Path
) -> None:
    def again(*_: object) -> None:
        raise AssertionError("nulls are simulated again")

    monkeypatch.setattr(module, "null_rows", again)
    resumed = diagnose(null_set, quick=True, store=null_store)
    assert document(resumed, "0") == document(null, "0")
    np.testing.assert_array_equal(
        resumed.detected.detection.null_statistics, null.detected.detection.null_statistics
    )
    with pytest.raises(AssertionError, match="simulated again"):
        diagnose(null_set, quick=True, seed=1, store=null_store)


def test_noise_that_nothing_tells_is_weighed_by_the_fit() -> None:
    recordings = small_set(None, count=5, seed=6)
    touching = tuple(
        replace(
            one,
            times=one.times[24:-24] - one.times[24],
            poses=one.poses[24:-24],
            probes=one.probes[24:-24],
        )
        for one in recordings.recordings
    )
    sensor = replace(recordings.sensor, position_sigma=None, orientation_sigma=None)
    told: list[str] = []
    found = diagnose(
        replace(recordings, recordings=touching, sensor=sensor),
        quick=True,
        told=lambda what, done, of: told.append(what),
    )
    assert not found.baseline.noise.known
    assert found.baseline.noise.source == "residuals of the fit"
    np.testing.assert_allclose(found.baseline.noise.sigma, SIGMA, rtol=0.25)
    assert found.baseline.noise.floor == pytest.approx(1.0, abs=0.25)
    assert found.split.held_out is None  # five recordings can spare none
    assert found.plain.held_out is None
    values = document(found, "0")
    assert values.noise.source == "residuals of the fit"
    assert len(values.held_out.recordings) == 5  # but each is predicted without itself
    assert values.held_out.noise_floor_sigma == found.baseline.noise.floor
    assert found.verdict == "consistent"
    assert told[-1] == "predicting recordings left out of the fit"


def test_pictures_show_all_recordings(late: Diagnosis, null: Diagnosis) -> None:
    found = evidence(late)
    assert late.split.held_out is not None
    training = [one.file for one in late.split.training.recordings]
    held_out = [one.file for one in late.split.held_out.recordings]
    assert list(found.files) == training + held_out
    assert list(found.held_out) == held_out
    assert found.extended is not None
    at = [found.files.index(file) for file in held_out]
    for poses, least, most in ((found.baseline, 2.0, np.inf), (found.extended, 0.0, 1.1)):
        away = (found.seen - poses)[at] / found.sigma
        assert least < np.sqrt(np.nanmean(away**2)) < most
    # the tip stands still at first, and so does its picture
    first = found.tips[:, :8]
    np.testing.assert_allclose(first - first[:, :1], 0.0, atol=1e-9)
    for r, file in enumerate(found.files):
        one = next(one for one in late.recordings.recordings if one.file == file)
        count = int(np.sum(np.isfinite(found.seen[r, :, 0])))
        np.testing.assert_allclose(found.tips[r, :count], one.probes[:count], atol=2e-7)
    assert evidence(null).extended is None


def test_recordings_held_out_may_have_more_tips_than_the_others(null: Diagnosis) -> None:
    held_out = null.plain.held_out
    assert held_out is not None
    ways = held_out.prepared.waypoints
    prepared = replace(held_out.prepared, waypoints=np.concatenate([ways, ways + 1e-3], axis=2))
    more = replace(null, plain=replace(null.plain, held_out=replace(held_out, prepared=prepared)))

    tips = evidence(more).tips

    count = len(null.baseline.prepared.files)
    assert tips.shape[2] == 2
    np.testing.assert_array_equal(tips[:, :, :1], evidence(null).tips)
    assert np.isnan(tips[:count, :, 1]).all()
    np.testing.assert_allclose(tips[count:, :, 1], tips[count:, :, 0] + 1e-3)


def test_numbers_have_room_for_what_is_undetected_where_more_than_noise_is_left(
    late: Diagnosis,
) -> None:
    """Folds do not differ by what is a little wrong with all recordings alike."""
    assert late.best is not None
    assert late.grade.extended is not None
    rolled = replace(late.grade.extended, weighed=True)
    told = {one.key: one for one in _numbers(late.baseline, late.best.refit, rolled)}
    by_fold = {one.key: one for one in intervals_by_fold(rolled)}
    assert set(told) == set(by_fold)
    key = "camera_latency.time_ms"
    assert told[key].low < by_fold[key].low < by_fold[key].high < told[key].high


@pytest.mark.parametrize(
    ("share", "quick", "forms"),
    [
        (0.9, True, [True, True]),
        (0.7, True, [True, True]),
        (None, True, [True, True]),
        (0.9, False, [False, True, False]),
        (0.7, False, [False, True]),
    ],
)
def test_what_nothing_explains_is_asked_with_others_held_out(
    monkeypatch: pytest.MonkeyPatch,
    late: Diagnosis,
    share: float | None,
    quick: bool,
    forms: list[bool],
) -> None:
    """In the quick form first, and the answer counts if it explains what is named for."""
    explained = Explained(share=share, low=0.1, high=1.0, folds=6) if share else None
    first = regraded(late, verdict="unknown")
    second = regraded(late, verdict="partial", explained=explained)
    held, asked = [], []

    def answered(recordings: RecordingSet, noise: Noise, fitted: frozenset[str], of: Any) -> Any:
        parts = split(recordings, 0, fitted)
        assert parts.held_out is not None
        held.append({one.file for one in parts.held_out.recordings})
        asked.append(of.quick)
        return second if fitted else first

    monkeypatch.setattr(diagnosing, "_answered", answered)
    found = diagnose(late.recordings, quick=quick)
    assert found is (second if share == 0.9 else first)
    assert asked == forms
    assert not held[0] & held[1]
    assert held[1:] == [held[1]] * (len(forms) - 1)


def test_an_answer_is_not_asked_for_again(monkeypatch: pytest.MonkeyPatch, late: Diagnosis) -> None:
    monkeypatch.setattr(diagnosing, "_answered", lambda *_: late)
    assert diagnose(late.recordings, quick=True) is late


@pytest.mark.parametrize(
    ("share", "there", "again"), [(0.6, 0.6, True), (0.6, 0.4, False), (0.85, 0.6, False)]
)
def test_what_is_left_in_recordings_held_out_is_asked_with_others_held_out(
    monkeypatch: pytest.MonkeyPatch, late: Diagnosis, share: float, there: float, again: bool
) -> None:
    """No fit of the competition has seen them: a second effect may show there alone."""
    parts, rolled = late.split.held_out, late.grade.extended
    assert parts is not None
    assert rolled is not None
    held = np.isin(late.grade.bench.prepared.files, [one.file for one in parts.recordings])
    counts = late.grade.bench.seen.sum(axis=(1, 2))
    beyond = np.where(held, there / held.sum(), (1.0 - there) / (~held).sum())
    squares = np.zeros_like(rolled.squares)
    squares[:, 0, 0] = late.grade.floor * counts + 1e4 * beyond
    explained = Explained(share=share, low=0.1, high=1.0, folds=6)
    first = regraded(
        late, verdict="partial", explained=explained, extended=replace(rolled, squares=squares)
    )
    second = regraded(late, verdict="partial", explained=replace(explained, share=0.9))
    monkeypatch.setattr(diagnosing, "_answered", lambda *given: second if given[2] else first)
    assert diagnose(late.recordings, quick=True) is (second if again else first)
