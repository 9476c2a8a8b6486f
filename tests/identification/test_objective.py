"""Eqs. (3) and (4) by loops, and what lies outside the constraints."""

from dataclasses import replace

import numpy as np

from meso_robust.identification.forward import predicted
from meso_robust.identification.models import viscous
from meso_robust.identification.prepared import prepare
from meso_robust.identification.search import score, scores_of
from meso_robust.recordings import RecordingSet
from meso_robust.simulator import Outcome
from tests.identification.sets import PART

MODEL = viscous(PART.outline)


def test_the_objective_is_the_printed_one(film_set: RecordingSet) -> None:
    prepared = prepare(film_set, step=4 * MODEL.step, most_frames=20)
    values = np.array([[0.2e-6, 0.5]])
    poses = predicted(prepared, MODEL, values).poses[0]
    length = np.hypot(808e-6, 418.5e-6)
    trials = []
    for x, s in zip(prepared.seen, poses, strict=True):
        axes = []
        for axis, unit in enumerate((1.0, 1.0, length)):
            pairs = [(a, b) for a, b in zip(x[:, axis], s[:, axis], strict=True) if a == a]
            axes.append((sum((unit * (a - b)) ** 2 for a, b in pairs) / len(pairs)) ** 0.5)
        trials.append(max(axes))
    found = score(prepared, MODEL, values)
    np.testing.assert_allclose(found.trials[0], trials, rtol=1e-12)
    np.testing.assert_allclose(found.values[0], sum(trials) / len(trials), rtol=1e-12)


def test_vectors_outside_the_constraints_cost_infinitely_much(film_set: RecordingSet) -> None:
    prepared = prepare(film_set, step=4 * MODEL.step, most_frames=5)
    found = score(prepared, MODEL, np.array([[0.2e-6, 0.5], [0.2e-6, -0.1], [-1.0, 0.5]]))
    assert np.isfinite(found.values).tolist() == [True, False, False]
    assert found.valid.tolist() == [True, False, False]


def test_a_run_that_does_not_end_costs_infinitely_much(film_set: RecordingSet) -> None:
    """However near to what was seen it was stopped."""
    prepared = prepare(film_set, step=4 * MODEL.step, most_frames=5)
    prediction = predicted(prepared, MODEL, np.array([[0.2e-6, 0.5]]))
    outcomes = prediction.outcomes.copy()
    outcomes[0, 1] = Outcome.JAM

    jammed = scores_of(prepared, replace(prediction, outcomes=outcomes))

    assert np.isfinite(scores_of(prepared, prediction).values).all()
    assert np.flatnonzero(np.isinf(jammed.trials[0])).tolist() == [1]
    assert np.isinf(jammed.values).all()
