"""Roll-outs from the pose at rest: of which recordings, from where, and by which fits."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from meso_robust.diagnosis import folds
from meso_robust.diagnosis.answer import _why
from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.folds import RollOut, _step, _told, bench_of, rolled_out
from meso_robust.identification.likelihood import fit_part
from meso_robust.identification.models.model import Model
from meso_robust.identification.problem import Fitted
from meso_robust.recordings import RecordingSet
from meso_robust.types import Floats
from tests.diagnosis.conftest import baseline_of


def test_every_recording_is_left_out_once(late: Diagnosis) -> None:
    bench = late.grade.bench
    assert list(bench.prepared.files) == [one.file for one in late.recordings.recordings]
    counts = np.bincount(bench.fold)
    assert bench.count == len(counts) == 6
    assert counts.sum() == 8
    assert counts.min() >= 1


def test_roll_outs_start_where_the_part_was_seen_at_rest(late: Diagnosis) -> None:
    grade = late.grade
    bench, sigma = grade.bench, late.baseline.settings.sigma
    assert grade.extended is not None
    for one in (grade.plain, grade.extended):
        for seen, poses, quiet in zip(bench.prepared.seen, one.poses, bench.still, strict=True):
            assert np.count_nonzero(quiet) >= 5
            away = (seen[quiet] - poses[quiet]).mean(axis=0) / sigma
            np.testing.assert_allclose(away, 0.0, atol=0.15)
    # a delay of 60 ms at 225 µm/s is eleven σ, none of which a start may take
    assert np.sqrt(grade.plain.squares.max()) > 8.0


def test_a_start_is_not_moved_away_from_where_the_part_was_seen(late: Diagnosis) -> None:
    """By a slope of another contact than the one the part rests in: each step would go too far."""
    bench, found = late.grade.bench, late.grade.plain
    sigma, rows = late.baseline.settings.sigma, np.arange(len(bench.fold))
    starts = bench.prepared.starts + 3.0 * sigma
    flat = np.broadcast_to(0.05 * np.eye(3), (*bench.still.shape, 3, 3))
    slopes = flat.reshape(len(rows), -1, 3)
    poses, outcomes = folds._from_rest(bench, found.model, found.values, rows, starts, slopes)
    quiet = bench.still[..., None]
    away = np.where(quiet, np.abs(bench.prepared.seen - poses) / sigma, 0.0).max(axis=(1, 2))
    assert away.max() < 8.0  # the three σ that the starts are off, and noise
    assert not outcomes.any()


def test_a_recording_has_no_say_in_its_own_prediction(late: Diagnosis) -> None:
    """What is recorded of a push after its rest changes the other predictions only."""
    bench, baseline = late.grade.bench, late.baseline
    row = 2
    seen = bench.prepared.seen.copy()
    seen[row, ~bench.still[row]] += 40.0 * baseline.settings.sigma
    changed = replace(bench, prepared=replace(bench.prepared, seen=seen))

    def moved(after: RollOut, before: RollOut) -> np.ndarray:
        own = np.abs(after.by_fold - before.by_fold)[:, 1] / before.by_fold[:, 1]
        return np.asarray(own)

    before = rolled_out(bench, baseline.model, baseline.fits.values[0])
    after = rolled_out(changed, baseline.model, baseline.fits.values[0])
    change = moved(after, before)
    others = np.delete(change, bench.fold[row])
    assert change[bench.fold[row]] < 0.2 * others.min()


def _held(
    at: Diagnosis, model: Model, values: Floats, monkeypatch: pytest.MonkeyPatch
) -> list[list[bool]]:
    """Of every fold which numbers its fit holds, where recording 3 alone tells all but the first."""
    told = np.full((len(at.grade.bench.fold), len(values)), 1e-4)
    told[3] = told[:, 0] = 1.0
    held: list[list[bool]] = []

    def fitted(*given: Any, **named: Any) -> Fitted:
        held.append(named["held"].tolist())
        return fit_part(*given, **named)

    monkeypatch.setattr(folds, "_told", lambda *_: told)
    monkeypatch.setattr(folds, "fit_part", fitted)
    rolled_out(at.grade.bench, model, values)
    return held


def test_friction_that_the_others_do_not_tell_is_that_of_all(
    late: Diagnosis, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A tip slips in one recording alone: without it no friction is known, which no law can mend."""
    model, bench = late.baseline.model, late.grade.bench
    assert model.keys[1] == "mu"
    held = _held(late, model, late.baseline.fits.values[0], monkeypatch)
    assert held == [[False, k == bench.fold[3]] for k in range(bench.count)]


def test_a_number_of_an_effect_is_never_lent(
    late: Diagnosis, monkeypatch: pytest.MonkeyPatch
) -> None:
    best = late.best
    assert best is not None
    held = _held(late, best.refit.model, best.refit.fits.values[0], monkeypatch)
    assert [of[:2] for of in held if any(of)] == [[False, True]]
    assert not any(any(of[2:]) for of in held)


def test_friction_at_the_end_of_its_range_is_looked_for_again(null: Diagnosis) -> None:
    """No tip slips at a friction of 1, so that nothing there says which way to go."""
    bench, model = null.grade.bench, null.baseline.model
    rho, mu = null.baseline.fits.values[0]
    stuck = replace(null.baseline, fits=replace(null.baseline.fits, values=np.array([[rho, 1.0]])))
    plain = folds._again(bench.prepared, stuck, 0)
    assert plain is not None
    assert plain[1] == pytest.approx(mu, rel=0.05)
    found = rolled_out(replace(bench, plain=plain), model, np.array([rho, 1.0]))
    assert found.values[1] == pytest.approx(mu, rel=0.05)
    assert folds._again(bench.prepared, null.baseline, 0) is None


def test_what_a_recording_tells_is_what_its_own_start_cannot_take() -> None:
    """By regression of each column on those of the start, which leaves what only the number makes."""
    rng = np.random.default_rng(2)
    rows = rng.standard_normal((2, 30, 5))
    rows[0, :, 1] = rows[0, :, 2:] @ [1.0, -2.0, 3.0]
    expected = [
        [np.linalg.lstsq(one[:, 2:], one[:, k], rcond=None)[1][0] for k in range(2)] for one in rows
    ]
    assert expected[0][1] < 1e-20
    np.testing.assert_allclose(_told(rows, 2), expected, atol=1e-10)


def test_the_noise_of_the_start_adds_a_little(late: Diagnosis) -> None:
    # some twenty frames at rest: the mean is known to a twentieth of σ², and a push keeps most of it
    quiet = late.grade.bench.still.sum(axis=1)
    ratio = late.grade.plain.start_squares * quiet
    assert np.all(ratio > 0.6)
    assert np.all(ratio < 1.1)


def test_a_start_that_still_frames_hardly_tell_stays_near_where_it_was_seen() -> None:
    """A tip that seems to be inside the part moves it out before the first frame, whatever its start."""
    flat, plain = 1e-5 * np.eye(3), np.eye(3)
    away, quiet = np.array([300.0, -200.0, 100.0]), np.array([True])
    assert np.abs(_step(flat, away, quiet)).max() < 1.0
    assert _step(plain, away, quiet) == pytest.approx(away, rel=0.01)


def test_where_a_tip_was_put_down_is_known_from_the_recording_alone_and_paid_for(
    null_set: RecordingSet,
) -> None:
    """Tips are 3 µm off in one direction or the other, of which the set states the deviation."""
    signs = np.random.default_rng(2).choice([-1.0, 1.0], (len(null_set.recordings), 2))
    off = replace(
        null_set,
        recordings=tuple(
            replace(one, probes=one.probes + 3e-6 * sign)
            for one, sign in zip(null_set.recordings, signs, strict=True)
        ),
    )
    stated = replace(off, sensor=replace(off.sensor, tip_offset=3e-6))

    def left(recordings: RecordingSet) -> float:
        baseline = baseline_of(recordings)
        bench = bench_of(recordings, baseline, 0)
        found = rolled_out(bench, baseline.model, baseline.fits.values[0])
        return float(found.squares.sum() / bench.seen.sum())

    plain, known, free = left(off), left(stated), left(null_set)
    assert plain > 2.0
    # four offsets a recording, each of them about one deviation, over some 500 data
    assert free < known < free + 0.05


def test_a_prediction_takes_a_tip_to_be_near_its_place_and_pays_for_the_rest(
    late: Diagnosis,
) -> None:
    bench = late.grade.bench
    settings = replace(late.baseline.settings, offset=1.5e-6)
    unsure = replace(bench, baseline=replace(late.baseline, settings=settings))
    offsets = np.zeros((len(bench.fold), 4))
    offsets[3] = 1e-6 * np.array([1.5, -2.9, 8.0, -12.0])
    expected = np.zeros_like(offsets)
    expected[3] = 1e-6 * np.array([1.5, -2.9, 3.0, -3.0])

    likely = folds._likely(unsure, offsets)
    np.testing.assert_allclose(likely, expected, rtol=1e-12)

    paid = folds._paid(unsure, likely) * bench.seen.sum(axis=(1, 2))
    squares = 1.0 + (2.9 / 1.5) ** 2 + 4.0 + 4.0
    np.testing.assert_allclose(paid, np.where(np.arange(len(paid)) == 3, squares, 0.0), rtol=1e-12)
    assert not np.any(folds._likely(bench, np.zeros_like(offsets)))
    assert not np.any(folds._paid(bench, np.zeros_like(offsets)))


def test_friction_that_a_search_with_an_effect_ran_up_to_its_end_is_that_of_the_plain_fit(
    late: Diagnosis,
) -> None:
    """The training recordings alone may not tell it: there a search has no way back."""
    bench, best, plain = late.grade.bench, late.best, late.grade.plain
    assert best is not None
    model, values = best.refit.model, best.refit.fits.values[0].copy()
    values[1] = model.parameters[1].high
    alone = rolled_out(bench, model, values)
    assert alone.values[1] > 0.9
    helped = rolled_out(bench, model, values, plain.values)
    assert helped.values[1] == pytest.approx(late.baseline.fits.values[0, 1], rel=0.05)
    assert helped.squares.sum() < 0.9 * alone.squares.sum()


def test_an_effect_that_one_fold_alone_tells_of_is_known(late: Diagnosis) -> None:
    """By what each recording tells of its number: all of it by one, or a part by another one too."""
    found = late.grade.extended
    assert found is not None
    bench = late.grade.bench
    assert found.alone == ()
    told = np.zeros((len(bench.fold), len(found.model.parameters)))
    told[:, :-1] = 1.0
    told[3, -1] = 50.0
    assert folds._alone(bench, found.model, told) == (("camera_latency", bench.prepared.files[3]),)
    other = int(np.flatnonzero(bench.fold != bench.fold[3])[0])
    told[other, -1] = 2.0
    assert folds._alone(bench, found.model, told) == ()
    told[:, -1] = 0.0
    assert folds._alone(bench, found.model, told) == ()
    alone = replace(found, alone=(("camera_latency", "push_03.csv"),))
    words = replace(late, grade=replace(late.grade, verdict="partial", extended=alone))
    assert "told of camera_latency by push_03.csv alone: repeat that push" in _why(words)
