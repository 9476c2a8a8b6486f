"""Errors of recordings that no fit has seen, before and after."""

from __future__ import annotations

import numpy as np
import pytest

from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.left_out import LeftOut, fall_of_error, left_out


def made(*sigma: float) -> LeftOut:
    count = len(sigma)
    return LeftOut(sigma=np.array(sigma), metres=np.ones(count), counts=np.full(count, 100))


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
