"""The competition: probabilities, duplicates and answers by hand, and on sets of known truth."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.detect import ALARM
from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.name import (
    Candidate,
    Contest,
    Naming,
    _answers,
    _supported,
    _with_probabilities,
    _without_duplicates,
    judged,
    partial,
)
from meso_robust.diagnosis.nulls import null_rows
from meso_robust.diagnosis.refit import Refit
from meso_robust.diagnosis.show import Errors
from meso_robust.diagnosis.signatures import signatures
from meso_robust.diagnosis.trials import Trial
from meso_robust.simulator.catalogue import CATALOGUE

EACH = np.log(len(CATALOGUE))
"""What an effect costs before any recording: one of so many."""


def candidate(
    *effects: str, score: float = 0.0, numbers: int = 1, rows: float = 0.0, **more: Any
) -> Candidate:
    """A set with a score and motion of its own."""
    sizes = {f"k{k}": 1.0 for k in range(numbers)}
    trials = [Trial(effect=effects[0], sizes=sizes)]
    trials += [Trial(effect=one, sizes={"k": 1.0}) for one in effects[1:]]
    nothing = cast(Any, None)
    refit = Refit(
        trials=tuple(trials),
        model=nothing,
        fits=nothing,
        fitted=nothing,
        tangent=nothing,
        rows=np.array([[rows, 0.0]]),
        chi2=0.0,
        gain=score + EACH * len(effects),
    )
    return Candidate(refit=refit, **more)


def test_a_score_pays_for_effects_and_for_forms() -> None:
    one = candidate("body_force", "backlash", score=7.0, choices=1.5)
    assert one.score == pytest.approx(5.5)
    assert one.effects == ("backlash", "body_force")


def test_probabilities_are_those_of_bayes() -> None:
    field = [candidate("backlash", score=2.0), candidate("body_force", score=5.0)]
    found = _with_probabilities(field)
    weights = np.exp([5.0, 2.0, 0.0])  # the plain model among them
    assert [one.effects for one in found] == [("body_force",), ("backlash",)]
    expected = weights[:2] / weights.sum()
    np.testing.assert_allclose([one.probability for one in found], expected)


def test_differences_that_may_be_the_simulators_count_less() -> None:
    found = _with_probabilities(
        [candidate("body_force", score=5000.0), candidate("backlash", score=4950.0)]
    )
    # a two-hundredth of 5000 nats is 25: two doubts
    assert found[0].probability / found[1].probability == pytest.approx(np.e**2)


def test_an_answer_holds_nearly_all_of_the_probability() -> None:
    def field(second: float) -> list[Candidate]:
        return _with_probabilities(
            [
                candidate("body_force", score=20.0, adequate=True),
                candidate("backlash", score=second, adequate=True),
                candidate("tip_radius", score=19.0, adequate=False, rejected="leaves a mismatch"),
                candidate("probe_drift", score=19.0),
            ]
        )

    assert [one.effects for one in _answers(field(16.0))] == [("body_force",)]
    assert [one.effects for one in _answers(field(18.0))] == [("body_force",), ("backlash",)]
    assert _answers([]) == ()


def test_the_same_motion_with_more_numbers_is_a_duplicate() -> None:
    simple = candidate("dry_friction", score=10.0, numbers=1, rows=1.0)
    same = candidate("stribeck_friction", score=9.0, numbers=2, rows=2.0)
    other = candidate("breakaway_friction", score=9.0, numbers=2, rows=9.0)
    better = candidate("shear_thinning", score=10.5, numbers=2, rows=2.0)
    found = {one.effects[0]: one for one in _without_duplicates([simple, same, other, better])}
    assert found["stribeck_friction"].rejected == "the same motion as dry_friction"
    assert [name for name, one in found.items() if one.rejected] == ["stribeck_friction"]


def errors(misfit: float) -> Errors:
    """With −½ Σ r² = −misfit."""
    nothing = cast(Any, None)
    rows = np.sqrt([[misfit, misfit]])
    return Errors(
        sigma=nothing, metres=nothing, rows=rows, at=nothing, poses=nothing, prepared=nothing
    )


def naming(*names: str) -> Naming:
    field = tuple(candidate(name, score=9.0, adequate=True) for name in names)
    return Naming(answers=field, best=field[0], candidates=field)


def test_held_out_recordings_refute_answers() -> None:
    both = naming("body_force", "backlash")
    kept = judged(both, errors(500.0), (errors(100.0), errors(104.0)))
    assert [one.effects for one in kept.answers] == [("body_force",), ("backlash",)]
    found = judged(both, errors(500.0), (errors(106.0), errors(100.0)))
    assert [one.effects for one in found.answers] == [("backlash",)]
    assert "6.0 nats" in found.candidates[0].rejected
    assert found.candidates[1].rejected == ""
    assert judged(both, errors(90.0), (errors(96.0), errors(97.0))).answers == ()
    none = replace(both, answers=())
    assert judged(none, errors(1.0), ()) is none


def test_a_hidden_delay_is_named(late: Diagnosis) -> None:
    assert late.naming is not None
    (answer,) = late.naming.answers
    assert answer.effects == ("camera_latency",)
    assert answer.probability > 0.99
    assert answer.adequate
    assert answer.p_value > ALARM
    scores = [one.score for one in late.naming.candidates]
    assert scores == sorted(scores, reverse=True)


def contest(at: Baseline, *tried: Trial) -> Naming:
    nulls = null_rows(at, 99, 0)
    return Contest(at, signatures(at, list(tried)), (), nulls, True, lambda *_: None).named()


FORCE = Trial(effect="body_force", sizes={"x_um_s": 0.5, "y_um_s": 0.5})
FLOW = Trial(effect="film_flow", sizes={"x_um_s": 0.5, "y_um_s": 0.5})
RADIUS = Trial(effect="tip_radius", sizes={"excess_um": 2.0})
TURN = Trial(effect="camera_rotation", sizes={"angle_deg": 0.2})


def test_what_motion_cannot_tell_apart_is_all_given(pulled: Baseline) -> None:
    found = contest(pulled, FORCE, FLOW, RADIUS)
    assert {one.effects for one in found.answers} == {("body_force",), ("film_flow",)}
    one, two = found.answers
    assert one.probability == pytest.approx(two.probability, rel=0.05)
    values = one.refit.fits.values[0, 2:]
    np.testing.assert_allclose(values, [3e-6, 0.0], atol=0.1e-6)


def test_without_the_true_effect_there_is_no_answer(pulled: Baseline) -> None:
    found = contest(pulled, RADIUS, TURN)
    assert found.answers == ()
    assert found.best is not None
    assert found.best.adequate is False
    assert found.best.rejected.startswith("leaves a mismatch")


def test_what_is_enough_by_itself_is_not_given_with_more(pulled: Baseline) -> None:
    one = candidate("body_force", score=30.0, adequate=True)
    more = candidate("body_force", "tip_radius", score=31.5, adequate=True)
    needed = candidate("body_force", "camera_rotation", score=32.5, adequate=True)
    court = Contest(pulled, [], (), np.zeros((1, 1, 1)), True, lambda *_: None)
    found = {one.effects: one.rejected for one in court._pruned([needed, more, one])}
    assert found[more.effects] == "body_force is enough"
    assert found[needed.effects] == ""
    assert found[one.effects] == ""


def test_an_answer_that_is_beaten_by_what_is_not_enough_is_none() -> None:
    ahead = candidate("stribeck_friction", score=20.0, adequate=False, rejected="leaves a mismatch")
    behind = candidate("body_force", score=14.0, adequate=True)
    close = candidate("backlash", score=16.0, adequate=True)
    field = [ahead, behind, close]
    assert "6 nats likelier" in _supported(behind, field).rejected
    assert _supported(close, field).rejected == ""


def test_a_further_effect_must_explain_much() -> None:
    single = candidate("body_force", score=50.0, adequate=False, rejected="leaves a mismatch")
    slight = candidate("body_force", "tip_radius", score=89.0, adequate=True)
    much = candidate("body_force", "backlash", score=91.0, adequate=True)
    assert "mends 39 nats only" in _supported(slight, [single, slight]).rejected
    assert _supported(much, [single, much]).rejected == ""


def test_of_what_is_not_explained_the_part_is_given_that_carries_over() -> None:
    none = Naming(
        answers=(),
        best=candidate("body_force", score=9.0),
        candidates=(candidate("body_force", score=9.0), candidate("backlash", score=8.0)),
    )

    def left(whole: float) -> Errors:
        return cast(Errors, SimpleNamespace(whole=whole))

    found = partial(none, left(2.0), (left(2.1), left(1.5)))
    assert found.best is not None
    assert found.best.effects == ("backlash",)
    assert partial(none, left(1.4), (left(2.1), left(1.5))).best is None
