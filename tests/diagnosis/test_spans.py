"""Spans: every frame belongs to one at most, in the phase that the tips say."""

from __future__ import annotations

import numpy as np

from meso_robust.diagnosis.detect import spans_of
from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.recordings.phases import phases


def test_spans_follow_the_phases_and_cut_the_contact_in_three(null: Diagnosis) -> None:
    prepared, training = null.baseline.prepared, null.split.training
    spans = spans_of(training, prepared)
    for row, recording in enumerate(training.recordings):
        own = [one for one in spans if one.recording == row]
        used = np.zeros(prepared.instants.shape[1], dtype=int)
        for one in own:
            used[one.first : one.last] += 1
            assert one.start == prepared.instants[row, one.first]
            assert one.end == prepared.instants[row, one.last - 1]
        seen = np.isfinite(prepared.seen[row]).any(axis=1)
        assert used.max() == 1
        assert np.sum(seen & (used == 0)) <= 2 * len(own)  # at most what is too short for a span

        pieces = [one for one in own if one.phase == "contact"]
        known = {phase.name: phase for phase in phases(training, recording)}
        assert len(pieces) == 3
        length = known["contact"].end - known["contact"].start
        step = length / len(pieces) + 0.1
        for one in pieces:
            assert known["contact"].start <= one.start + 0.05
            assert one.end <= known["contact"].end + 0.05
            assert one.end - one.start < step
