"""Where both models predict the same: which spans count, and their errors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.diagnosis.answer import document
from meso_robust.diagnosis.controls import Control, control
from meso_robust.diagnosis.detect import Span
from meso_robust.diagnosis.diagnose import Checked, Diagnosis
from meso_robust.diagnosis.validation import Errors

SIGMA = np.array([2e-6, 2e-6, 1e-3])
SPANS = tuple(
    Span(recording=row, phase="contact", first=first, last=first + 4, start=0.0, end=1.0)
    for row in range(2)
    for first in (0, 4)
)


@pytest.fixture
def pair(late: Diagnosis) -> tuple[Errors, Errors]:
    """Two recordings of 8 frames, seen 3 σ off the plain model in x, which the other one has too."""
    poses = np.zeros((2, 8, 3))
    seen = poses + np.array([3.0, 0.0, 0.0]) * SIGMA
    plain = replace(
        late.plain.training, poses=poses, prepared=replace(late.plain.training.prepared, seen=seen)
    )
    return plain, replace(plain, poses=poses.copy())


def test_equal_models_have_the_error_of_all_spans(pair: tuple[Errors, Errors]) -> None:
    found = control([(SPANS, *pair)], SIGMA)
    assert found is not None
    assert found.spans == 4
    assert [found.sigma_before, found.sigma_after] == pytest.approx([np.sqrt(3.0)] * 2)


def test_a_span_counts_if_no_frame_and_no_component_differs(pair: tuple[Errors, Errors]) -> None:
    before, after = pair
    after.poses[0, 2] += np.array([0.0, 0.0, 0.3]) * SIGMA  # too far: the span is out
    after.poses[0, 4:] += np.array([0.1, 0.0, 0.0]) * SIGMA  # little: the span stays
    after.poses[1] += np.array([0.0, -5.0, 0.0]) * SIGMA
    found = control([(SPANS, before, after)], SIGMA)
    assert found is not None
    assert found.spans == 1
    assert found.sigma_before == pytest.approx(np.sqrt(3.0))
    assert found.sigma_after == pytest.approx(np.sqrt(2.9**2 / 3.0))


def test_frames_that_were_not_seen_do_not_count(pair: tuple[Errors, Errors]) -> None:
    before, after = pair
    before.poses[0, :4], after.poses[0, :4] = np.nan, np.nan  # nothing seen: no span
    after.poses[0, 5], before.prepared.seen[0, 5] = np.nan, np.nan
    before.poses[0, 6] -= np.array([3.0, 0.0, 0.0]) * SIGMA  # 6 σ off, in both models
    after.poses[0, 6] = before.poses[0, 6]
    found = control([(SPANS[:2], before, after)], SIGMA)
    assert found is not None
    assert found.spans == 1
    assert found.sigma_after == pytest.approx(np.sqrt((9.0 + 36.0 + 9.0) / 9.0))


def test_groups_are_taken_together_and_none_is_none(pair: tuple[Errors, Errors]) -> None:
    before, after = pair
    far = replace(after, poses=after.poses + SIGMA)
    assert control([(SPANS, before, far)], SIGMA) is None
    found = control([(SPANS, before, far), (SPANS[:1], before, after)], SIGMA)
    assert found is not None
    assert found.spans == 1


def test_the_document_has_it(late: Diagnosis) -> None:
    shown = replace(
        late, checked=Checked(control=Control(spans=3, sigma_before=1.25, sigma_after=1.5))
    )
    found = document(shown, "0").control
    assert found is not None
    assert (found.spans, found.sigma_before, found.sigma_after) == (3, 1.25, 1.5)
    assert found.within_sigma == 0.2
