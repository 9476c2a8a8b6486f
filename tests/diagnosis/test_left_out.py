"""Errors of recordings that no fit has seen, before and after."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.diagnosis.answer import document
from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.judge import Judge
from meso_robust.diagnosis.left_out import LeftOut, fall_of_error, left_out


def made(*sigma: float) -> LeftOut:
    count = len(sigma)
    return LeftOut(
        sigma=np.array(sigma),
        metres=np.ones(count),
        counts=np.full(count, 100),
        places=np.full(count, 30),
    )


def test_a_fall_that_all_recordings_show_has_no_width() -> None:
    before = made(4.0, 8.0)
    assert fall_of_error(before, made(1.0, 2.0), 0) == pytest.approx((0.75, 0.75))
    assert fall_of_error(before, before, 0) == pytest.approx((0.0, 0.0))


def test_a_fall_that_one_recording_shows_is_wide() -> None:
    before, after = made(4.0, 4.0), made(4.0, 1.0)
    low, high = fall_of_error(before, after, 0)
    # of two recordings weighed by a share w that is drawn evenly, 1 - √(1 - 15/16 w) for 5 and 95 % of it
    assert (low, high) == pytest.approx((0.024, 0.669), abs=0.02)
    assert fall_of_error(before, after, 0) == (low, high)
    assert fall_of_error(after, before, 0)[0] < -1.0


def test_every_recording_is_predicted_without_it(late: Diagnosis) -> None:
    assert late.grade.extended is not None
    bench = late.grade.bench
    before, after = (left_out(bench, one) for one in (late.grade.plain, late.grade.extended))
    assert len(before.sigma) == len(bench.prepared.files)
    assert before.whole > 2.0
    assert after.whole == pytest.approx(1.0, abs=0.1)
    by_hand = np.sqrt(np.nansum((bench.prepared.seen - late.grade.plain.poses)[0, :, :2] ** 2) / bench.seen[0, :, 0].sum())  # fmt: skip
    assert before.metres[0] == pytest.approx(by_hand)


def test_a_recording_that_is_predicted_much_worse_spoils_a_set(late: Diagnosis) -> None:
    grade = late.grade
    assert grade.extended is not None
    assert grade.chosen is not None
    names, bench = grade.chosen.effects, grade.bench
    own = Judge(
        bench, {(): grade.plain, names: grade.extended}, np.zeros(len(bench.prepared.files))
    )
    assert own.spoilt(names) == grade.spoilt == ()
    squares = grade.extended.squares.copy()
    squares[2] = 1.5 * grade.plain.squares[2] + 1.0
    worse = replace(own, seen={(): grade.plain, names: replace(grade.extended, squares=squares)})
    assert worse.spoilt(names) == (bench.prepared.files[2],)


def test_a_set_that_spoils_recordings_is_not_named(late: Diagnosis) -> None:
    files = tuple(f"push_{k}.csv" for k in range(5))
    told = document(replace(late, grade=replace(late.grade, verdict="partial", spoilt=files)), "1")
    assert (
        "with it push_0.csv, push_1.csv, push_2.csv and 2 more recordings would be predicted worse"
        in told.why
    )
