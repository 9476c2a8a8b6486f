"""The competition: probabilities, duplicates and answers by hand, and on sets of known truth."""

from __future__ import annotations

import pickle
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from meso_robust.diagnosis.acceptance import Witnesses, in_open_forms, judged, partial
from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.candidates import (
    Candidate,
    Naming,
    answers_of,
    freed,
    pruned,
    supported,
    why_not,
    with_probabilities,
    without_duplicates,
)
from meso_robust.diagnosis.detect import ALARM
from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.invariances import Pair
from meso_robust.diagnosis.model_selection import Contest, Form
from meso_robust.diagnosis.nulls import null_rows
from meso_robust.diagnosis.refit import Refit
from meso_robust.diagnosis.rejection import Ground, Rejection
from meso_robust.diagnosis.signatures import Signature, signatures
from meso_robust.diagnosis.trials import Trial
from meso_robust.diagnosis.validation import Errors
from meso_robust.identification.problem import Fits
from meso_robust.simulator.catalogue import CATALOGUE

EACH = np.log(len(CATALOGUE))
"""What an effect costs before any recording: one of so many."""
LEFT = Rejection(ground=Ground.MISMATCH_LEFT, names=("the largest test",))


def same_as(*effects: str) -> Rejection:
    return Rejection(ground=Ground.SAME_MOTION, names=effects)


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


@pytest.mark.parametrize("rejected", [None, Rejection(ground=Ground.NO_GAIN)])
@pytest.mark.parametrize("adequate", [True, False, None])
def test_every_set_that_is_no_answer_has_a_reason(
    adequate: bool | None, rejected: Rejection | None
) -> None:
    first = candidate("body_force", score=50.0, adequate=True)
    other = candidate("backlash", score=9.0, adequate=adequate, rejected=rejected)
    naming = Naming(answers=(first,), best=first, candidates=(first, other))

    assert why_not(first, naming) is None
    reason = why_not(other, naming)

    assert reason is not None
    assert len(reason.words.split()) >= 3
    assert reason == rejected or rejected is None
    if adequate is None and rejected is None:
        assert (reason.ground, reason.names) == (Ground.FAR_BEHIND, ("body_force",))
        assert reason.amount == pytest.approx(41.0)


def test_a_score_pays_for_effects_and_for_forms() -> None:
    one = candidate("body_force", "backlash", score=7.0, choices=1.5)
    assert one.score == pytest.approx(5.5)
    assert one.effects == ("backlash", "body_force")


def test_probabilities_are_those_of_bayes() -> None:
    field = [candidate("backlash", score=2.0), candidate("body_force", score=5.0)]
    found = with_probabilities(field)
    weights = np.exp([5.0, 2.0, 0.0])  # the plain model among them
    assert [one.effects for one in found] == [("body_force",), ("backlash",)]
    expected = weights[:2] / weights.sum()
    np.testing.assert_allclose([one.probability for one in found], expected)


def test_differences_that_may_be_the_simulators_count_less() -> None:
    found = with_probabilities(
        [candidate("body_force", score=5000.0), candidate("backlash", score=4950.0)]
    )
    # a two-hundredth of 5000 nats is 25: two doubts
    assert found[0].probability / found[1].probability == pytest.approx(np.e**2)


def test_an_answer_holds_nearly_all_of_the_probability() -> None:
    def field(second: float) -> list[Candidate]:
        return with_probabilities(
            [
                candidate("body_force", score=20.0, adequate=True),
                candidate("backlash", score=second, adequate=True),
                candidate("tip_radius", score=19.0, adequate=False, rejected=LEFT),
                candidate("probe_drift", score=19.0),
            ]
        )

    assert [one.effects for one in answers_of(field(16.0))] == [("body_force",)]
    assert [one.effects for one in answers_of(field(18.0))] == [("body_force",), ("backlash",)]
    assert answers_of([]) == ()


def test_the_same_motion_with_more_numbers_is_a_duplicate() -> None:
    simple = candidate("dry_friction", score=10.0, numbers=1, rows=1.0)
    same = candidate("stribeck_friction", score=9.0, numbers=2, rows=2.0)
    other = candidate("breakaway_friction", score=9.0, numbers=2, rows=9.0)
    better = candidate("shear_thinning", score=10.5, numbers=2, rows=2.0)
    found = {one.effects[0]: one for one in without_duplicates([simple, same, other, better])}
    assert found["stribeck_friction"].rejected == same_as("dry_friction")
    assert [name for name, one in found.items() if one.rejected] == ["stribeck_friction"]


def test_the_same_motion_by_other_physics_leaves_open_which_it_is() -> None:
    wall = candidate("wall_capillarity", score=10.0, numbers=3)
    force = candidate("body_force", score=9.0, numbers=4)
    both = candidate("body_force", "part_yaw", score=9.0, numbers=4)
    general = candidate("uneven_support", score=9.0, numbers=3)
    special = candidate("dry_friction", score=10.0, numbers=1)
    assert [one.rejected for one in without_duplicates([wall, force])] == [None, None]
    for one, other in ((wall, both), (special, general)):
        found = without_duplicates([one, other])
        assert [each.rejected for each in found] == [None, same_as(*one.effects)]


def test_a_duplicate_of_what_is_not_enough_may_yet_answer() -> None:
    short = candidate("dry_friction", adequate=False, rejected=LEFT)
    same = candidate("stribeck_friction", rejected=same_as("dry_friction"))
    enough = candidate("body_force", adequate=True)
    other = candidate("backlash", rejected=same_as("body_force"))
    found = {one.effects[0]: one.rejected for one in freed([short, same, enough, other])}
    assert found == {
        "dry_friction": LEFT,
        "stribeck_friction": None,
        "body_force": None,
        "backlash": same_as("body_force"),
    }


def errors(misfit: float, *sigma: float) -> Errors:
    """With −½ Σ r² = −misfit, and errors of so many σ of each recording."""
    rows = np.sqrt([[misfit, misfit]])
    return cast(Errors, SimpleNamespace(rows=rows, sigma=np.array(sigma or (1.0,))))


def pair(x: float, tolerance: float = 1e-6) -> Pair:
    """A push that should coincide with another, and is so far off along x, m."""
    return cast(
        Pair,
        SimpleNamespace(
            invariance="speed",
            first="a.csv",
            second="b.csv",
            difference=np.array([x, 0.0, 0.0]),
            tolerance=np.array([tolerance, tolerance, 1e-3]),
        ),
    )


def told(plain: float, unseen: bool = True, reach: float = 1.0, **each: Errors) -> Witnesses:
    """Errors of sets, named ``a__b``, and no pairs."""
    own = {tuple(name.split("__")): one for name, one in each.items()}
    return Witnesses(errors={(): errors(plain)} | own, unseen=unseen, reach=reach, pairs={})


def naming(*names: str) -> Naming:
    field = tuple(candidate(name, score=9.0, adequate=True) for name in names)
    return Naming(answers=field, best=field[0], candidates=field)


def test_held_out_recordings_refute_answers() -> None:
    both = naming("body_force", "backlash")
    kept = judged(both, told(500.0, body_force=errors(100.0), backlash=errors(104.0)))
    assert [one.effects for one in kept.answers] == [("body_force",), ("backlash",)]
    found = judged(both, told(500.0, body_force=errors(106.0), backlash=errors(100.0)))
    assert [one.effects for one in found.answers] == [("backlash",)]
    against = found.candidates[0].rejected
    assert against is not None
    assert against.ground is Ground.HELD_OUT_WORSE
    assert against.amount == pytest.approx(6.0)
    assert found.candidates[1].rejected is None
    worse = told(90.0, body_force=errors(96.0), backlash=errors(97.0))
    assert judged(both, worse).answers == ()
    fitted = replace(worse, unseen=False)  # a fit that is no worse than another refutes nothing
    assert len(judged(both, fitted).answers) == 2


def formed(effect: str, score: float, *others: float) -> Candidate:
    """An adequate set in a form of its law, and scores of the other ones."""

    def of(law: int, score: float) -> Candidate:
        one = candidate(effect, score=score, adequate=True)
        trial = replace(one.refit.trials[0], shape={"form": float(law)})
        return replace(one, refit=replace(one.refit, trials=(trial,)))

    best = of(0, score)
    more = tuple(of(1 + k, one).refit for k, one in enumerate(others))
    return replace(best, refit=replace(best.refit, others=more))


@pytest.mark.parametrize(
    ("behind", "left", "law"),
    [
        (20.0, 101.0, 1.0),  # the other form predicts the recordings held out
        (30.0, 101.0, None),  # the fits exclude it
        (20.0, 111.0, None),  # nor does it predict them
    ],
)
def test_a_law_is_refuted_in_every_form_that_the_fits_leave_open(
    behind: float, left: float, law: float | None
) -> None:
    wall, force = (
        candidate("wall_capillarity", score=428.0, adequate=True),
        formed("body_force", 425.0, 428.0 - behind),
    )
    both = Naming(answers=(wall, force), best=wall, candidates=(wall, force))
    worths = {("wall_capillarity",): errors(100.0), ("body_force",): errors(112.0)}

    def heard(worths: Any) -> Witnesses:
        return told(500.0, **{"__".join(names): one for names, one in worths.items()})

    asked, made = in_open_forms(both, cast(Any, worths), heard, lambda _: cast(Any, errors(left)))
    found = judged(asked, heard(made)).answers
    assert found[0] is wall
    assert [one.refit.trials[0].law for one in found[1:]] == ([] if law is None else [law])
    if law is not None:
        # it is told that neither form leads, and the detector was not asked of this one
        assert found[1].refit.lead == pytest.approx(-(behind - 3.0))
        assert found[1].adequate is None


def test_every_effect_of_a_set_must_help_where_nothing_was_fitted() -> None:
    one = candidate("backlash", "body_force", score=9.0, adequate=True)
    found = Naming(answers=(one,), best=one, candidates=(one,))

    def against(part: float) -> Rejection | None:
        witnesses = told(500.0, body_force=errors(part), backlash__body_force=errors(50.0))
        return judged(found, witnesses).candidates[0].rejected

    assert against(50.1) is None
    assert against(49.9) == Rejection(ground=Ground.IDLE_MEMBER, names=("body_force",))


def test_an_answer_must_come_near_what_any_law_could_reach() -> None:
    one = naming("body_force")
    near = errors(9.0, 1.0, 1.31, 7.0)  # of one recording in three it may be the numbers
    assert judged(one, told(500.0, reach=1.1, body_force=near)).answers
    found = judged(one, told(500.0, reach=1.1, body_force=errors(9.0, 1.0, 1.33, 1.4)))
    assert found.answers == ()
    assert found.candidates[0].rejected == Rejection(
        ground=Ground.ABOVE_FLOOR, amount=1.33, limit=1.1
    )


def test_invariances_must_be_broken_as_they_are_seen_to_be() -> None:
    one = naming("body_force")

    def answers(seen: float, predicted: float) -> int:
        witnesses = replace(
            told(500.0, body_force=errors(9.0)),
            seen=(pair(0.0), pair(seen)),
            pairs={("body_force",): (pair(0.0), pair(predicted))},
        )
        return len(judged(one, witnesses).answers)

    assert answers(9e-6, 9e-6) == 1
    assert answers(9e-6, 5e-6) == 1
    # 5 σ of three numbers: a chance of 1.5e-5, less than a thousandth over two pairs
    assert answers(9e-6, 4e-6) == 0
    assert answers(0.0, 5e-6) == 0  # nor may it break one that is seen to hold


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


def test_what_motion_cannot_tell_apart_is_all_given(
    pulled: Baseline, monkeypatch: pytest.MonkeyPatch
) -> None:
    def sent(function: Any, items: Any) -> list[Any]:
        """As from a copy of the process."""
        return [pickle.loads(pickle.dumps(function(item))) for item in items]

    monkeypatch.setattr("meso_robust.diagnosis.model_selection.shared", sent)
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
    assert found.best.rejected is not None
    assert found.best.rejected.ground is Ground.MISMATCH_LEFT


def test_what_is_enough_by_itself_is_not_given_with_more() -> None:
    one = candidate("body_force", score=30.0, adequate=True)
    more = candidate("body_force", "tip_radius", score=31.5, adequate=True)
    needed = candidate("body_force", "camera_rotation", score=32.5, adequate=True)
    found = {one.effects: one.rejected for one in pruned([needed, more, one])}
    enough = Rejection(ground=Ground.SUBSET_SUFFICES, names=("body_force",))
    assert found == {more.effects: enough, needed.effects: None, one.effects: None}


def test_an_answer_that_is_beaten_by_what_is_not_enough_is_none() -> None:
    ahead = candidate("stribeck_friction", score=20.0, adequate=False, rejected=LEFT)
    behind = candidate("body_force", score=14.0, adequate=True)
    close = candidate("backlash", score=16.0, adequate=True)
    field = [ahead, behind, close]
    beaten = supported(behind, field).rejected
    assert beaten is not None
    assert (beaten.ground, beaten.names) == (Ground.OUTSCORED, ("stribeck_friction",))
    assert beaten.amount == pytest.approx(6.0)
    assert supported(close, field).rejected is None


def test_a_further_effect_must_explain_much() -> None:
    single = candidate("body_force", score=50.0, adequate=False, rejected=LEFT)
    slight = candidate("body_force", "tip_radius", score=89.0, adequate=True)
    much = candidate("body_force", "backlash", score=91.0, adequate=True)
    too_little = Rejection(ground=Ground.SLIGHT_MEMBER, amount=39.0)
    assert supported(slight, [single, slight]).rejected == too_little
    assert supported(much, [single, much]).rejected is None


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


@pytest.mark.parametrize("quick", [True, False])
def test_what_no_effect_explains_alone_is_looked_for_in_sets(quick: bool) -> None:
    asked: list[int] = []

    class Alone(Contest):
        """Nothing answers, and nothing can be added."""

        def _singles(self) -> list[Candidate]:
            return []

        def _judged(self, field: list[Candidate]) -> list[Candidate]:
            return field

        def _extended(self, field: list[Candidate]) -> list[Candidate]:
            asked.append(len(field))
            return []

    none = cast(Any, None)
    naming = Alone(
        baseline=none, signatures=[], spans=(), nulls=none, quick=quick, told=none
    ).named()

    assert naming.answers == ()
    assert asked == [0]


@pytest.fixture
def one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fits are made where they are asked for, by what stands in for them."""
    monkeypatch.setattr("meso_robust.diagnosis.model_selection.ahead", lambda *_, **__: None)
    monkeypatch.setattr(Contest, "_chosen", lambda *_: ())


@pytest.mark.usefixtures("one_by_one")
def test_a_form_with_more_numbers_is_compared_when_its_search_has_ended(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ends = {0.0: 1001.0, 1.0: 1040.0, 2.0: 1200.0}
    gains = {
        0.0: 1000.0,
        1.0: 980.0,
        2.0: 900.0,
    }  # the last is too far behind to be looked at again

    def rough(law: float) -> Refit:
        base = candidate("body_force").refit
        trial = Trial(effect="body_force", sizes={"x_um_s": 1.0}, shape={"form": law})
        return replace(base, trials=(trial,), gain=gains[law])

    def ended(_: Contest, one: Refit) -> Refit:
        return replace(one, gain=ends[one.trials[0].law])

    monkeypatch.setattr(Contest, "_ended", ended)
    monkeypatch.setattr(Contest, "_choices", lambda *_: 0.0)
    nothing = cast(Any, None)
    contest = Contest(nothing, [], (), np.zeros(0), True, nothing)
    (found,) = contest._refined([rough(0.0), rough(1.0), rough(2.0)])
    assert (found.refit.trials[0].law, found.refit.gain) == (1.0, 1040.0)
    assert found.refit.lead == pytest.approx(39.0)


@pytest.mark.parametrize(
    ("chi2", "gain", "kept"), [(900.0, 990.0, True), (1100.0, 1010.0, True), (1100.0, 990.0, False)]
)
def test_a_promise_of_one_more_step_is_not_preferred_to_the_end_of_a_search(
    monkeypatch: pytest.MonkeyPatch, chi2: float, gain: float, kept: bool
) -> None:
    """The gain of a rough fit is that of its next linear step: where nothing is linear, it is not to be had."""

    def fit(chi2: float, gain: float) -> Refit:
        fits = cast(Fits, SimpleNamespace(chi2=np.array([chi2])))
        other = candidate("camera_latency").refit
        return replace(other, fits=fits, gain=gain, others=(other,))

    rough, more = fit(1000.0, 1000.0), replace(fit(chi2, gain), others=())
    monkeypatch.setattr("meso_robust.diagnosis.model_selection.refined", lambda *_, **__: more)
    monkeypatch.setattr(Contest, "_chosen", lambda *_: ())
    nothing = cast(Any, None)
    found = Contest(nothing, [], (), np.zeros(0), True, nothing)._ended(rough)
    assert found.fits is (more if kept else rough).fits
    assert found.gain == (gain if kept else 1000.0)
    assert found.others == rough.others


@pytest.mark.usefixtures("one_by_one")
def test_a_rough_fit_behind_its_own_linear_estimate_is_taken_to_its_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A turn of the image by 12° needs more steps than a rough fit has; a poor fit that kept its promise does not."""
    promised = {"camera_rotation": 900.0, "backlash": 350.0, "tip_radius": 200.0}
    gains = {"camera_rotation": 400.0, "backlash": 390.0, "tip_radius": 100.0, "body_force": 1000.0}
    asked: list[str] = []
    begun: list[list[str]] = []

    def ahead(*_: object, rough: Any = (), fine: Any = ()) -> None:
        begun.extend([[one.trial.effect for (one,), _ in rough]] if rough else [])

    monkeypatch.setattr("meso_robust.diagnosis.model_selection.ahead", ahead)

    def form(effect: str) -> Form:
        trial = Trial(effect=effect, sizes={"x": 1.0})
        signature = cast(Signature, SimpleNamespace(trial=trial))
        return Form(gain=promised.get(effect, 950.0), signature=signature, linear=False)

    def tried(_: Contest, chosen: tuple[Signature, ...], __: object) -> list[Refit]:
        (one,) = chosen
        base = candidate(one.trial.effect).refit
        return [replace(base, trials=(one.trial,), gain=gains[one.trial.effect], chi2=0.0)]

    def ended(_: Contest, one: Refit) -> Refit:
        asked.append(one.trials[0].effect)
        return replace(one, gain=one.gain + 700.0)

    monkeypatch.setattr(Contest, "_forms", lambda *_: [form(effect) for effect in gains])
    monkeypatch.setattr(Contest, "_tried", tried)
    monkeypatch.setattr(Contest, "_ended", ended)
    monkeypatch.setattr(Contest, "_choices", lambda *_: 0.0)
    nothing = cast(Any, SimpleNamespace(seen=np.ones(1)))
    field = Contest(nothing, [], (), np.zeros(0), True, lambda *_: None)._singles()
    assert {one.effects[0] for one in field} == set(gains)
    # the one by itself, then the others that may win; not the one again
    assert asked == ["camera_rotation", "body_force"]
    assert begun == [["body_force", "camera_rotation"], ["backlash", "tip_radius"]]


@pytest.mark.parametrize(("left", "asked"), [(250.0, True), (150.0, False)])
def test_while_nothing_explains_estimates_are_held_against_estimates(
    monkeypatch: pytest.MonkeyPatch, left: float, asked: bool
) -> None:
    """A post took more than a weight on one corner was estimated to take, and left twice the noise and more."""
    promised = {"unmodelled_wall": 0.0, "drag_drift": 300.0, "uneven_support": 200.0}
    tried: list[str] = []

    def form(effect: str) -> Form:
        signature = cast(Signature, SimpleNamespace(trial=Trial(effect=effect, sizes={"x": 1.0})))
        linear = effect != "unmodelled_wall"
        return Form(gain=promised[effect] or 900.0, signature=signature, linear=linear)

    def fit(_: Contest, chosen: tuple[Signature, ...], __: object) -> list[Refit]:
        (one,) = chosen
        tried.append(one.trial.effect)
        base = candidate(one.trial.effect).refit
        return [replace(base, trials=(one.trial,), gain=2000.0, chi2=left)]

    monkeypatch.setattr("meso_robust.diagnosis.model_selection.ahead", lambda *_, **__: None)
    monkeypatch.setattr(Contest, "_forms", lambda *_: [form(effect) for effect in promised])
    monkeypatch.setattr(Contest, "_tried", fit)
    monkeypatch.setattr(Contest, "_refined", lambda _, fits, __: fits)
    monkeypatch.setattr(Contest, "_all_ended", lambda *_: {})
    seen = cast(Any, SimpleNamespace(seen=np.ones(100)))
    Contest(seen, [], (), np.zeros(0), True, lambda *_: None)._singles()
    assert tried == ["unmodelled_wall", *(["drag_drift", "uneven_support"] if asked else [])]


@pytest.mark.usefixtures("one_by_one")
@pytest.mark.parametrize("quick", [True, False])
def test_the_sets_that_promise_most_as_a_whole_are_refitted(
    monkeypatch: pytest.MonkeyPatch, quick: bool
) -> None:
    """Neither of two strong effects need be the best by itself: a scale of the image is, here, and is neither."""
    added = {
        "camera_scale": {"part_geometry": 50.0, "tip_radius": 40.0, "backlash": 30.0}
        | dict.fromkeys(("body_force", "part_yaw", "film_flow", "shear_thinning"), -20.0),
        "camera_drift": {"camera_scale": 10.0, "part_geometry": 20.0},
        "probe_compliance": {"drag_gradient": 300.0, "camera_scale": 290.0, "tip_radius": 1.0},
    }
    alone = {"camera_scale": 900.0, "camera_drift": 880.0, "probe_compliance": 850.0}
    tried: list[tuple[str, ...]] = []

    def form(effect: str, gain: float) -> Form:
        trial = Trial(effect=effect, sizes={"x": 1.0})
        signature = cast(Signature, SimpleNamespace(trial=trial))
        return Form(gain=gain, signature=signature, linear=True)

    def forms(_: Contest, start: Refit, without: tuple[str, ...], of: Any = None) -> list[Form]:
        own = added[start.trials[0].effect] if of is None else dict.fromkeys(names_of(of), -30.0)
        return [form(name, gain) for name, gain in own.items() if name not in without]

    def names_of(signatures: list[Signature]) -> list[str]:
        return [one.trial.effect for one in signatures]

    def fitted(_: Contest, chosen: tuple[Signature, ...], __: object) -> list[Refit]:
        names = tuple(one.trial.effect for one in chosen)
        tried.append(names)
        made = SimpleNamespace(effects=tuple(sorted(names)), gain=950.0 - 5.0 * len(names[1]))
        return [cast(Refit, made)]

    def known(_: Contest, base: Refit) -> tuple[Signature, ...]:
        return (form(base.trials[0].effect, 0.0).signature,)

    monkeypatch.setattr(Contest, "_forms", forms)
    monkeypatch.setattr(Contest, "_tried", fitted)
    monkeypatch.setattr(Contest, "_chosen", known)
    monkeypatch.setattr(Contest, "_refined", lambda _, fits: [one.effects for one in fits])
    nothing = cast(Any, None)
    every = [form(name, 0.0).signature for name in (*alone, *added["camera_scale"])]
    contest = Contest(nothing, every, (), np.zeros(0), quick, lambda *_: None)
    field = [candidate(name, score=gain) for name, gain in alone.items()]
    kept = contest._extended(field)
    assert tried[:2] == [
        ("probe_compliance", "drag_gradient"),  # 1150
        ("probe_compliance", "camera_scale"),  # 1140
    ]
    # a set that two bases lead to is fitted from the one that promises more, once
    assert tried[2:5] == [
        ("camera_scale", "part_geometry"),
        ("camera_scale", "tip_radius"),
        ("camera_scale", "backlash"),
    ]
    assert len({frozenset(one) for one in tried}) == len(tried)
    # what gains most beside the best one, in fact, is tried beside the next ones, where nothing was promised of it
    strong = {"backlash", "part_yaw", "film_flow"}
    crossed = [one for one in tried if one[1] in strong and one[0] != "camera_scale"]
    assert {one[1] for one in crossed if one[0] == "camera_drift"} == strong
    assert {one[1] for one in crossed if one[0] == "probe_compliance"} == strong
    if not quick:
        assert len(kept) == 12 + 3
        return
    # beside the best one all others are tried, and those kept that gain most: a linear estimate promised less
    beside = [one for one in tried[6:] if one[0] == "camera_scale"]
    assert {one[1] for one in beside} == {"body_force", "part_yaw", "film_flow", "shear_thinning"}
    assert {frozenset(one) for one in cast(Any, kept[6:])} <= {
        frozenset(one) for one in (*beside, *crossed)
    }
    assert len(kept) == 9


@pytest.mark.usefixtures("one_by_one")
def test_beside_a_set_those_that_gain_most_and_those_seen_without_a_simulation_are_offered(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Whatever a linear estimate promises of them: "effect8" gains four times as much as that."""
    promised = {f"effect{k}": 100.0 - k for k in range(9)} | {"part_yaw": 1.0, "backlash": 0.5}
    gains = promised | {"effect8": 400.0, "effect0": 190.0, "effect1": 210.0, "effect2": 220.0}

    def form(effect: str) -> Form:
        signature = SimpleNamespace(trial=Trial(effect=effect, sizes={"x": 1.0}))
        return Form(gain=promised[effect], signature=cast(Signature, signature), linear=True)

    def forms(_: Contest, __: Refit, without: tuple[str, ...], of: list[Any]) -> list[Form]:
        assert (without, of) == (("camera_latency",), ["alone", "beside"])
        return [form(effect) for effect in promised]

    tried: list[str] = []

    def fitted(_: Contest, chosen: tuple[Signature, ...], start: Refit) -> list[Refit]:
        tried.append(effect := chosen[-1].trial.effect)
        names = tuple(sorted(("camera_latency", effect)))
        return [cast(Refit, SimpleNamespace(effects=names, gain=start.gain + gains[effect]))]

    monkeypatch.setattr(Contest, "_forms", forms)
    monkeypatch.setattr(Contest, "_tried", fitted)
    monkeypatch.setattr(Contest, "_chosen", lambda *_: ())
    monkeypatch.setattr(Contest, "_refined", lambda _, fits: [one.effects[1] for one in fits])
    seen = cast(Any, SimpleNamespace(effect="part_yaw"))
    nothing = cast(Any, None)
    contest = Contest(
        nothing,
        cast(Any, ["alone"]),
        (),
        np.zeros(0),
        True,
        lambda *_: None,
        findings=(seen,),
        beside=cast(Any, ("beside",)),
    )
    base = candidate("camera_latency")
    gain = SimpleNamespace(gain=base.refit.gain + gains["effect1"])
    known = SimpleNamespace(effects=("camera_latency", "effect1"), refit=gain)
    found = contest.further(cast(Any, [base, known]), base)
    assert tried == [effect for effect in promised if effect != "effect1"]
    # half of what the best one gains, and no less, or seen
    assert found == [known, "effect8", "effect2", "part_yaw"]
