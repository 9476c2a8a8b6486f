"""What hidden inputs leave: of hand-made statistics, and of pushes with a force."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.diagnosis.answer import document
from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.controls import catch_all
from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.hidden_inputs import Statistics, left
from meso_robust.diagnosis.windows import windowed
from tests.diagnosis.conftest import regraded, small_set
from tests.diagnosis.test_windows import hidden

PULL = {"body_force": {"x_um_s": 3.0}}


def statistics(chi2: list[float], freedom: list[float], gain: float, rank: float) -> Statistics:
    """Windows of which the inputs of all stages take the same; a single stage takes half."""
    gains = np.array([[0.5 * gain, gain]] * len(chi2))
    ranks = np.array([[1.0, rank]] * len(chi2))
    none = np.zeros((len(chi2), 1))
    return Statistics(
        chi2=np.array(chi2),
        freedom=np.array(freedom),
        components=none,
        gains=gains,
        ranks=ranks,
        slack=none,
        slack_sigma=none,
        shared_gains=gains[0],
        shared_ranks=ranks[0],
    )


def test_it_is_what_all_inputs_leave_per_degree_of_freedom() -> None:
    found = statistics([90.0, 30.0], [30.0, 16.0], gain=20.0, rank=3.0)
    assert left(found) == pytest.approx(np.sqrt((120.0 - 40.0) / (46.0 - 6.0)))


def test_nothing_is_said_where_inputs_take_every_datum() -> None:
    assert left(statistics([5.0], [3.0], gain=5.0, rank=3.0)) is None


def test_a_force_is_within_reach_of_hidden_inputs() -> None:
    found = hidden({"body_force": {"x_um_s": 12.0}}).found
    assert np.sqrt(found.chi2.sum() / found.freedom.sum()) > 1.3
    assert left(found) == pytest.approx(1.0, abs=0.06)


def test_windows_are_those_of_the_recordings_under_the_plain_fit(pulled: Baseline) -> None:
    recordings, noise = small_set(PULL, 5), pulled.noise
    assert noise.correlation == 0.0
    found = windowed(recordings, pulled.model, pulled.fits.values[0], noise.sigma).found
    assert catch_all(recordings, pulled.prepared, pulled) == pytest.approx(left(found), rel=1e-3)


def test_without_a_mismatch_the_noise_is_left() -> None:
    assert left(hidden(None).found) == pytest.approx(1.0, abs=0.06)


def test_recordings_without_a_window_say_nothing(pulled: Baseline) -> None:
    seen = pulled.prepared.seen.copy()
    seen[:, 4:] = np.nan
    short = replace(pulled.prepared, seen=seen)
    assert catch_all(small_set(PULL, 5), short, pulled) is None


def test_an_unknown_mismatch_says_what_any_law_could_reach(late: Diagnosis) -> None:
    assert late.accepted is not None
    assert late.grade.explained is not None
    little = replace(late.grade.explained, share=0.07)
    unknown = regraded(late, verdict="unknown", explained=little, floor=1.234**2)
    unknown = replace(unknown, accepted=replace(late.accepted, catch_all=1.234))
    found = document(unknown, "0")
    assert found.verdict == "unknown"
    assert found.catch_all_sigma == 1.234
    assert "camera_latency explains 7 % of the explainable error" in found.why
    assert found.why.endswith("free hidden inputs would leave 1.23 σ")
    none = regraded(unknown, chosen=None, explained=None)
    assert document(none, "0").why.startswith(
        "no effect of the catalogue explains any of the explainable error of"
    )


def test_the_floor_is_never_above_an_answer(late: Diagnosis) -> None:
    grade, counts = late.grade, np.isfinite(late.grade.bench.prepared.seen).sum()
    assert grade.extended is not None
    for one in (grade.plain, grade.extended):
        assert grade.floor <= one.squares.sum() / counts
