"""The graded verdict: shares out of fold, what matters, and what is left."""

from __future__ import annotations

import pickle
from dataclasses import replace
from functools import partial
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from meso_robust.diagnosis.answer import _by_share, _why
from meso_robust.diagnosis.candidates import Candidate, Naming
from meso_robust.diagnosis.choice import _answer, _holding, earning, in_open_forms, pools, slight
from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.document import Verdict
from meso_robust.diagnosis.further import with_more, with_one_more
from meso_robust.diagnosis.grading import (
    Grade,
    _all_longer,
    _left_open,
    _outdone,
    _stage_left,
    _verdict,
    _with_what_is_beside,
    graded,
    sized,
)
from meso_robust.diagnosis.judge import Explained, Judge, _floor
from meso_robust.diagnosis.next_push import next_experiment
from meso_robust.diagnosis.refit import Refit
from meso_robust.diagnosis.rejection import Ground, Rejection
from meso_robust.diagnosis.rivals import equal, holds, only_law
from meso_robust.diagnosis.sizes import beyond_by_folds
from meso_robust.diagnosis.trials import Trial
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.sway import Sway
from meso_robust.simulator.catalogue import CATALOGUE, stage_of
from tests.identification.sets import UM


def again(found: Diagnosis, **changes: object) -> Grade:
    """The grade of the same competition, asked otherwise."""
    given = {"naming": found.naming, "reach": 1.0, "relevant": None} | changes
    return graded(
        found.recordings,
        found.grade.bench,
        given["naming"],  # type: ignore[arg-type]
        found.located,
        given["reach"],  # type: ignore[arg-type]
        quick=True,
        seed=0,
        relevant=given["relevant"],  # type: ignore[arg-type]
    )


@pytest.mark.parametrize(
    ("matters", "share", "low", "verdict"),
    [
        (False, 1.0, 0.9, "consistent"),
        (True, 0.81, 0.7, "named"),
        (True, 0.81, 0.69, "partial"),
        (True, 0.79, 0.7, "partial"),
        (True, 0.21, 0.12, "partial"),
        (True, 0.19, 0.12, "unknown"),
        (True, 0.33, 0.005, "partial"),
        (True, 0.5, 0.0, "unknown"),
    ],
)
def test_a_verdict_is_by_its_share(
    matters: bool, share: float, low: float, verdict: Verdict
) -> None:
    explained = Explained(share=share, low=low, high=1.0, folds=6)
    assert _verdict(matters, explained, ()) == verdict


@pytest.mark.parametrize(
    ("share", "verdict"), [(0.95, "ambiguous"), (0.21, "ambiguous"), (0.19, "unknown")]
)
def test_sets_that_explain_a_fifth_alike_are_ambiguous(share: float, verdict: Verdict) -> None:
    explained = Explained(share=share, low=0.1, high=0.95, folds=6)
    assert _verdict(True, explained, (stated("b", gain=1.0),)) == verdict


def test_what_has_no_sure_size_has_no_name(late: Diagnosis) -> None:
    """Of 30 effects that are not there, the best is 1.8 half widths beyond nought in a tenth of the sets."""
    assert late.grade.verdict == "named"
    (one,) = [each for each in late.known if each.key == "camera_latency.time_ms"]
    for half, verdict in ((0.5 * one.value, "named"), (0.6 * one.value, "partial")):
        wide = replace(one, low=one.value - half, high=one.value + half)
        grade = sized(late.grade, (wide,))
        assert grade.verdict == verdict
        assert grade.unsure == (("camera_latency",) if verdict == "partial" else ())
    assert sized(late.grade, ()).verdict == "partial"  # recordings that tell no size
    unknown = replace(late.grade, verdict="unknown")
    assert sized(unknown, ()) is unknown
    words = replace(late, grade=grade)
    assert "but the recordings do not agree on the size of camera_latency" in _why(words)


def test_a_set_that_leaves_much_at_another_stage_is_not_named(
    late: Diagnosis, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A late camera explains all of it; it is held to more than that, and to what is left being elsewhere."""
    grading = "meso_robust.diagnosis.grading"
    monkeypatch.setattr(f"{grading}._stage_left", lambda *_: "support")
    assert not again(late).elsewhere
    monkeypatch.setattr(f"{grading}._ALL_BUT_FORM", 1.1)
    grade = again(late)
    assert (grade.verdict, grade.elsewhere) == ("partial", True)
    assert "but what is left is in the support" in _why(replace(late, grade=grade))
    monkeypatch.setattr(f"{grading}._stage_left", lambda *_: "observation")
    assert again(late).verdict == "named"


def test_without_a_set_a_mismatch_that_matters_is_unknown() -> None:
    assert _verdict(True, None, ()) == "unknown"
    assert _verdict(False, None, ()) == "consistent"


def test_the_share_is_of_the_error_beyond_the_floor(late: Diagnosis) -> None:
    grade = late.grade
    assert grade.verdict == "named"
    assert grade.explained is not None
    assert grade.extended is not None
    count = np.isfinite(grade.bench.prepared.seen).sum()
    plain, extended = (one.squares.sum() / count for one in (grade.plain, grade.extended))
    assert grade.floor == pytest.approx(1.0, abs=0.15)
    assert grade.explained.share == pytest.approx((plain - extended) / (plain - grade.floor))
    assert sum(grade.shares.values()) == pytest.approx(grade.explained.share)
    assert sum(cell.share for cell in grade.cells) == pytest.approx(1.0)
    # beside the delay there is nothing: a tenth of σ is 0.12 µm
    assert grade.remainder.metres < 0.5 * UM
    assert grade.size > 3 * UM


@pytest.mark.parametrize(
    ("stays", "um"),
    [
        ((3.0 * UM, 4.0 * UM, 0.0), 5.0 * 2.0**0.5),
        ((0.0, 3.0 * UM, 0.01), 0.01 * 0.5 * float(np.hypot(1616.0, 837.0)) * 2.0**0.5),
        ((0.01 * UM, 0.0, 0.0), 0.2 * 1.2),
    ],
)
def test_what_an_error_makes_that_stays_does_not_matter(
    late: Diagnosis, stays: tuple[float, float, float], um: float
) -> None:
    """A prediction begins with one such error, and what is seen later has another; a turn moves a whole part."""
    bench = late.grade.bench
    noise = replace(bench.baseline.noise, stays=np.array(stays))
    bench = replace(bench, baseline=replace(bench.baseline, noise=noise))
    found = replace(late, grade=replace(late.grade, bench=bench))
    assert again(found, naming=None).relevant == pytest.approx(um * UM, rel=0.01)


def test_what_matters_is_for_the_user_to_say(late: Diagnosis) -> None:
    assert late.grade.relevant == pytest.approx(0.2 * 1.2 * UM)
    grade = again(late, relevant=1e-3)
    assert grade.verdict == "consistent"
    assert grade.chosen is None
    assert grade.explained is None
    assert grade.cells == ()
    assert grade.size == pytest.approx(late.grade.size, rel=0.1)


def test_a_wrong_effect_explains_too_little(late: Diagnosis) -> None:
    assert late.naming is not None
    wrong = [one for one in late.naming.candidates if "camera_latency" not in one.effects]
    wrong = [one for one in wrong if "probe_compliance" not in one.effects]
    assert wrong
    naming = Naming(answers=(), candidates=tuple(wrong), best=wrong[0])  # offers no further ones
    grade = again(late, naming=naming)
    assert grade.verdict in ("unknown", "partial", "ambiguous")


def test_where_the_likeliest_set_fails_the_next_ones_are_asked(
    late: Diagnosis, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is the likeliest by the recordings that it was fitted to."""
    assert late.naming is not None
    right = next(one for one in late.naming.candidates if one.effects == ("camera_latency",))
    wrong = next(one for one in late.naming.candidates if "camera_latency" not in one.effects)

    def fails(judge: Judge, naming: Naming, whole: Candidate, *more: Any, **also: Any) -> Any:
        return None if whole is wrong else earning(judge, naming, whole, *more, **also)

    def sent(function: Any, items: Any) -> list[Any]:
        return [pickle.loads(pickle.dumps(function(item))) for item in items]

    monkeypatch.setattr("meso_robust.diagnosis.choice.earning", fails)
    monkeypatch.setattr("meso_robust.diagnosis.judge.shared", sent)
    naming = replace(late.naming, answers=(wrong,), candidates=(wrong, right), best=wrong)
    grade = again(late, naming=naming)
    assert grade.verdict == "named"
    assert grade.chosen == right


def test_what_windows_leave_of_a_sway_is_no_floor(late: Diagnosis) -> None:
    """Inputs that are constant in a window cannot follow it, so that they would excuse all of it."""
    assert late.naming is not None
    none = replace(late.naming, answers=(), candidates=(), best=None)
    bench, count = late.grade.bench, np.isfinite(late.grade.bench.prepared.seen).sum()
    mean = float(late.grade.plain.squares.sum() / count)
    excused = {"naming": none, "reach": float(np.sqrt(0.9 * mean))}
    assert again(late, **excused).floor == pytest.approx(0.9 * mean, rel=0.1)
    noise = bench.baseline.noise
    size = np.sqrt(mean - 1.0) * noise.sigma
    sway = Sway(rate=2.0, rate_error=0.1, size=size, error=0.1 * size, p_value=0.005)
    shaken = replace(bench, baseline=replace(bench.baseline, noise=replace(noise, sway=sway)))
    grade = again(replace(late, grade=replace(late.grade, bench=shaken)), **excused)
    assert grade.verdict == "unknown"
    assert grade.remainder.stage == "observation"
    assert grade.floor == pytest.approx(1.0, abs=0.15)
    # a small one excuses nothing and says nothing of the rest
    small = replace(noise, sway=replace(sway, size=0.1 * size))
    still = replace(bench, baseline=replace(bench.baseline, noise=small))
    kept = again(replace(late, grade=replace(late.grade, bench=still)), **excused)
    assert kept.floor == pytest.approx(0.9 * mean, rel=0.1)


def test_what_a_set_leaves_may_be_at_the_stage_of_its_own_effects(
    late: Diagnosis, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A law of another form leaves something where it is; and where no input explains more, the largest effect is."""
    bench, plain, where = late.grade.bench, late.grade.plain, late.located
    assert where is not None
    names, shares = ("camera_latency", "part_yaw"), {"camera_latency": 0.6, "part_yaw": 0.1}
    predicted = {(): plain, names: replace(plain, squares=0.5 * plain.squares)}
    judge = Judge(bench, predicted, bench.seen.sum(axis=(1, 2)).astype(float))

    looked = []

    def told(own: float, matters: float = 0.0, of: tuple[str, ...] = names) -> str | None:
        def stages(some: RecordingSet, *_: object) -> dict[str, float]:
            looked.append([one.file for one in some.recordings])
            return {"support": 50.0, "geometry": 48.0, "observation": own}

        monkeypatch.setattr("meso_robust.diagnosis.grading.stages", stages)
        return _stage_left(judge, late.recordings, of, shares, where, matters)

    assert told(90.0) == "observation"
    assert told(44.0) == "support"
    assert told(49.0, of=()) == "support"
    # of those that explain as much, the set's own
    assert told(46.0) == "observation"
    # nothing is left that matters: the latency's
    assert told(40.0, matters=1.0) == "observation"
    shares["part_yaw"] = 0.7
    assert told(90.0, matters=1.0) == stage_of("part_yaw").name != "observation"
    assert told(90.0, matters=1.0, of=()) == where.channels[0].channel
    monkeypatch.setattr(
        "meso_robust.diagnosis.grading.stages", lambda *_: {"support": 4.9, "contact": -3.0}
    )
    left_little = _stage_left(judge, late.recordings, names, shares, where, 0.0)
    assert left_little == stage_of("part_yaw").name  # what few nats tell is chance
    monkeypatch.setattr("meso_robust.diagnosis.grading._LOOKED", 2)
    assert told(90.0) == "observation"
    left = dict(zip(bench.prepared.files, judge.sums(names) - judge.floor, strict=True))
    assert set(looked[-1]) == set(sorted(left, key=lambda file: left[file])[-2:])


def test_of_one_recording_nothing_is_named(late: Diagnosis) -> None:
    """Nothing can be left out of its fit, so that no share is one of recordings left out."""
    bench = replace(late.grade.bench, fold=np.zeros_like(late.grade.bench.fold))
    grade = again(replace(late, grade=replace(late.grade, bench=bench)))
    assert grade.verdict == "unknown"
    assert grade.chosen is None
    assert grade.explained is None
    assert grade.size == pytest.approx(late.grade.size, rel=0.1)


def test_of_a_set_without_a_mismatch_the_size_is_told(null: Diagnosis) -> None:
    grade = null.grade
    assert grade.verdict == "consistent"
    assert grade.chosen is None
    assert grade.size < 1.0 * UM
    assert grade.cells == ()


def test_hidden_inputs_that_leave_more_than_a_set_are_no_floor(late: Diagnosis) -> None:
    grade, bench = late.grade, late.grade.bench
    count = float(bench.seen.sum())
    good = grade.extended
    assert good is not None
    worse = replace(good, squares=9.0 * good.squares)
    for extended, reach, low, high in ((good, 1.3, 0.9, 1.2), (worse, 4.0, 0.95, 1.2)):
        both = {(): grade.plain, ("camera_latency",): extended}
        floor = float(_floor(bench, both, reach).sum())
        assert floor <= extended.squares.sum() * (1.0 + 1e-12)
        assert low < floor / count < high
    # where they leave less than every set, they are the floor
    free = float(_floor(bench, {(): grade.plain, ("a",): worse}, 2.0).sum()) / count
    assert 4.0 < free < 4.5


@pytest.mark.parametrize(
    ("general", "special", "held"),
    [
        (("camera_anisotropy",), ("camera_scale",), True),
        (("camera_scale",), ("camera_anisotropy",), False),
        (("camera_anisotropy", "part_yaw"), ("camera_scale",), True),
        (("part_yaw",), ("camera_scale",), False),
        # what has a special case holds itself as well
        (("uneven_support", "drag_gradient"), ("uneven_support",), True),
        (("uneven_support", "drag_gradient"), ("dry_friction",), True),
    ],
)
def test_a_more_general_law_is_no_rival(
    general: tuple[str, ...], special: tuple[str, ...], held: bool
) -> None:
    one, other = (cast("Candidate", SimpleNamespace(effects=e)) for e in (general, special))
    assert holds(one, other) is held


def test_what_does_not_help_in_every_fold_is_not_named() -> None:
    explained = Explained(share=0.97, low=0.9, high=1.0, folds=6)
    assert _verdict(True, explained, (), everywhere=False) == "partial"


def stood(
    sums: dict[tuple[str, ...], list[float]],
    floor: float = 100.0,
    lost: tuple[tuple[str, ...], ...] = (),
    chance: float = 50.0,
) -> Judge:
    """A judge of eight recordings, a fold each, that has predicted some sets, some of them in vain."""
    made = SimpleNamespace(
        floor=np.full(8, floor),
        chance=chance,
        sums=lambda names: np.array(sums[names]),
        explainable=sum(sums[()]) - 8 * floor,
        share=lambda names: (sum(sums[()]) - sum(sums[names])) / (sum(sums[()]) - 8 * floor),
        with_part=lambda whole, names: None,
        carries=lambda names: names not in lost,
        lessens=lambda names: sum(sums[names][:3]) < sum(sums[()][:3]),
        bench=SimpleNamespace(fold=np.arange(8), count=8),
    )
    for name in ("by_fold", "surely_worse", "explained"):
        setattr(made, name, partial(getattr(Judge, name), made))
    return cast(Judge, made)


def stated(*names: str, gain: float, ground: Ground | None = None) -> Candidate:
    refit = SimpleNamespace(effects=names, gain=gain, trials=names)
    rejected = Rejection(ground=ground) if ground else None
    return Candidate(refit=cast(Refit, refit), rejected=rejected)


def contest(*candidates: Candidate, answers: tuple[Candidate, ...] = ()) -> Naming:
    return Naming(answers=answers, best=candidates[0], candidates=candidates)


UNUSED = ("model", "fits", "fitted", "tangent", "rows", "chi2")
PLAIN = [100.0, 95.0, 9000.0, 104.0, 98.0, 103.0, 6000.0, 97.0]
NOISE = [101.0, 96.0, 104.0, 103.0, 99.0, 101.0, 99.0, 98.0]


def test_a_share_that_two_pushes_of_eight_tell_is_told() -> None:
    """One edge of four is wrong: a tenth of all draws with replacement have no push on it."""
    found = stood({(): PLAIN, ("part_geometry",): NOISE}).explained(("part_geometry",), 0)
    assert found.share == pytest.approx(1.0, abs=0.01)
    assert 0.97 < found.low <= found.share <= found.high


def test_of_the_likeliest_the_first_that_holds_out_of_fold_is_taken() -> None:
    worse = [100.0, 95.0, 9500.0, 20000.0, 98.0, 103.0, 100.0, 97.0]
    judge = stood({(): PLAIN, ("a",): worse, ("b",): NOISE, ("c",): NOISE})
    a, b, c = stated("a", gain=1000.0), stated("b", gain=900.0), stated("c", gain=700.0)
    assert _holding(judge, contest(a, b, c), (a, b, c), 0) == (b, True)
    # what is far less likely is not asked
    assert _holding(judge, contest(a, c), (a, c), 0) == (None, True)


@pytest.mark.parametrize(("few", "everywhere"), [(8, True), (9, False)])
def test_of_few_recordings_what_is_not_the_likeliest_is_partial(
    monkeypatch: pytest.MonkeyPatch, few: int, everywhere: bool
) -> None:
    """Of eight recordings; by the luck of three pushes one law or another predicts the fourth."""
    monkeypatch.setattr("meso_robust.diagnosis.choice._FEW", few)
    worse = [100.0, 95.0, 100.0, 104.0, 98.0, 103.0, 9000.0, 97.0]
    judge = stood({(): PLAIN, ("a",): worse, ("b",): NOISE})
    a, b = stated("a", gain=1000.0), stated("b", gain=900.0)
    assert _answer(judge, contest(a, b), (a, b), 0) == (b, (), everywhere)
    assert _answer(judge, contest(b, a), (b, a), 0) == (b, (), True)


def test_what_predicts_held_out_recordings_worse_explains_nothing() -> None:
    mostly = [100.0, 95.0, 9500.0, 900.0, 98.0, 103.0, 200.0, 97.0]
    some = [100.0, 95.0, 9500.0, 104.0, 98.0, 103.0, 99.0, 97.0]
    judge = stood({(): PLAIN, ("a",): mostly, ("b",): some}, lost=(("a",), ("b",)))
    a, b = stated("a", gain=1000.0), stated("b", gain=950.0)
    assert _holding(judge, contest(a), (a,), 0) == (None, True)
    assert _holding(judge, contest(b), (b,), 0) == (None, True)
    assert _answer(judge, contest(b, answers=(b,)), (b,), 0) == (None, (), True)


def test_one_effect_that_explains_most_of_the_whole_is_told_though_a_turn_is_worse() -> None:
    """Of the three recordings that are held out it leaves less, place and turn together."""
    most = [100.0, 95.0, 3000.0, 900.0, 98.0, 103.0, 200.0, 97.0]
    less = [100.0, 95.0, 5000.0, 900.0, 98.0, 103.0, 4000.0, 97.0]
    more = [100.0, 95.0, 9500.0, 104.0, 98.0, 103.0, 99.0, 97.0]
    a = stated("a", gain=1000.0)
    for sums, told in ((most, a), (less, None), (more, None)):
        judge = stood({(): PLAIN, ("a",): sums}, lost=(("a",),))
        assert _holding(judge, contest(a), (a,), 0) == (told, told is None)
    both = stated("a", "b", gain=1000.0)
    # a set that surely explains nearly all may predict a push worse that needs nothing
    nearly = [100.0, 95.0, 200.0, 400.0, 98.0, 103.0, 150.0, 97.0]
    unsure = [100.0, 95.0, 1000.0, 900.0, 98.0, 103.0, 200.0, 97.0]
    for sums, found in (
        (most, (None, True)),
        (unsure, (None, True)),
        (nearly, (both, False)),
    ):
        judge = stood({(): PLAIN, ("a",): less, ("b",): less, ("a", "b"): sums}, lost=(("a", "b"),))
        assert _holding(judge, contest(both), (both,), 0) == found


@pytest.mark.parametrize(
    ("place", "turn", "carries"),
    [
        (1.0, 0.2, True),
        (1.05, 0.2, True),  # no more than noise
        (1.2, 0.2, False),
        (0.2, 1.2, False),
        (0.2, 1.05, True),
    ],
)
def test_a_set_carries_over_if_neither_place_nor_turn_gets_worse(
    late: Diagnosis, place: float, turn: float, carries: bool
) -> None:
    bench, plain = late.grade.bench, late.grade.plain
    assert bench.held_out.sum() == 2
    fitted = set(late.baseline.prepared.files)
    assert [file in fitted for file in bench.prepared.files] == (~bench.held_out).tolist()
    of = 30.0 * np.where(bench.seen, [0.5, 0.5, 1.0], 0.0)  # far beyond the noise
    held = bench.held_out[:, None, None]
    own = of * np.where(held, [place, place, turn], 0.1)  # those of the fit do not count
    before, after = (replace(plain, squares=squares) for squares in (of, own))
    judge = Judge(bench, {(): before, ("a",): after}, np.zeros(8))
    assert judge.carries(("a",)) is carries


def test_what_helps_on_the_whole_only_explains_a_part() -> None:
    mostly = [100.0, 95.0, 3000.0, 900.0, 98.0, 103.0, 200.0, 97.0]
    judge = stood({(): PLAIN, ("a",): mostly, ("b",): NOISE[:2] + PLAIN[2:]})
    a, b = stated("a", gain=1000.0), stated("b", gain=950.0)
    assert _holding(judge, contest(a, b), (a, b), 0) == (a, False)


def test_what_two_held_out_recordings_spoke_against_is_asked_in_every_fold() -> None:
    a = stated("a", gain=1000.0)
    near = stated("b", gain=998.0, ground=Ground.HELD_OUT_WORSE)
    far = stated("c", gain=900.0, ground=Ground.HELD_OUT_WORSE)
    other = stated("d", gain=999.0, ground=Ground.MISMATCH_LEFT)
    naming = contest(a, other, near, far, answers=(a,))
    first, (asked, then), _ = pools(naming, True)
    assert first == (naming, (a, near))
    assert asked is not None
    assert (asked.answers, then) == ((), (a, other, near, far))
    judge = stood({(): PLAIN, ("a",): NOISE, ("b",): NOISE})
    assert _answer(judge, naming, (a, near), 0) == (a, (near,), True)
    judge = stood({(): PLAIN, ("a",): NOISE, ("b",): PLAIN})
    assert _answer(judge, naming, (a, near), 0) == (a, (), True)


def test_of_two_laws_that_are_alike_where_they_were_fitted_other_recordings_tell() -> None:
    worse = [one + 20.0 for one in NOISE]
    judge = stood({(): PLAIN, ("a",): NOISE, ("b",): worse})
    a, less, more = stated("a", gain=1000.0), stated("b", gain=1003.0), stated("b", gain=1007.0)
    # by what a simulator of finite steps does not know
    assert not equal(judge, a, less, 0)
    # no witness against a law that is the likelier one
    assert equal(judge, a, more, 0)
    assert _answer(judge, contest(a, less, answers=(a, less)), (a, less), 0) == (a, (), True)
    assert _answer(judge, contest(a, more, answers=(a, more)), (a, more), 0) == (a, (more,), True)
    # nor is what noise makes
    assert equal(stood({(): PLAIN, ("a",): NOISE, ("b",): worse}, chance=170.0), a, less, 0)
    # nor is what leaves something itself
    half = [one + 10.0 for one in NOISE]
    assert equal(stood({(): PLAIN, ("a",): half, ("b",): worse}), a, less, 0)
    # nor is one recording
    once = [*NOISE[:2], NOISE[2] + 200.0, *(one - 2.0 for one in NOISE[3:])]
    assert equal(stood({(): PLAIN, ("a",): NOISE, ("b",): once}), a, less, 0)


@pytest.mark.parametrize("behind", [20.0, 40.0])
def test_no_law_is_put_aside_before_each_form_that_the_fits_leave_open_was_asked(
    monkeypatch: pytest.MonkeyPatch, behind: float
) -> None:
    worse = [one + 20.0 for one in NOISE]
    sums = {(): PLAIN, ("a",): NOISE, ("b",): worse}
    judge = cast(Any, stood(sums))
    judge.seen = {(): None}
    monkeypatch.setattr("meso_robust.diagnosis.choice.judge_of", lambda *_: judge)

    def predicted(_: Any, seen: dict[Any, Any], pool: tuple[Candidate, ...]) -> Any:
        """The other form leaves no more than noise."""
        (form,) = pool
        seen[form.effects] = SimpleNamespace(squares=np.array(NOISE))
        sums[form.effects] = NOISE
        return pool

    monkeypatch.setattr("meso_robust.diagnosis.choice.with_predictions", predicted)
    a, b = (
        Candidate(refit=Refit(trials=(Trial(effect=name, sizes={}),), gain=gain, **nothing))
        for name, gain in (("a", 1000.0), ("b", 999.0))
        for nothing in (dict.fromkeys(UNUSED, cast(Any, None)),)
    )
    other = replace(b.refit, gain=1000.0 - behind)
    b = replace(b, refit=replace(b.refit, others=(other,)))
    found, turned = in_open_forms(contest(a, b, answers=(a, b)), (a, b), judge, None, 0)
    assert found[0] is a
    if behind > 25.0:
        assert (found[1], turned) == ((), {})
        return
    (rival,) = found[1]
    assert turned == {("b",): rival}
    assert rival.refit.gain == 1000.0 - behind


@pytest.mark.parametrize(
    ("chosen", "rival", "left", "told"),
    [
        ("stribeck_friction", "breakaway_friction", 0.0, True),
        ("stribeck_friction", "drag_gradient", 0.0, False),
        # another law of the same physics beside something else, whatever that explains
        ("stribeck_friction", "camera_drift dry_friction", -50.0, True),
        # of several hundred sets of two some do by chance what one effect does
        ("uneven_support", "drag_centre_offset stribeck_friction", 0.0, True),
        ("uneven_support", "drag_centre_offset stribeck_friction", -50.0, False),
        ("uneven_support part_yaw", "drag_centre_offset stribeck_friction", 0.0, False),
    ],
)
def test_of_sets_that_explain_alike_what_is_known_is_told(
    chosen: str, rival: str, left: float, told: bool
) -> None:
    own, other = (stated(*names.split(), gain=1000.0) for names in (chosen, rival))
    worse = [one + 60.0 for one in NOISE]
    judge = stood({(): PLAIN, own.effects: worse, other.effects: [one + left for one in worse]})
    assert only_law(judge, own, other, 0) is told


def test_a_rival_that_leaves_the_law_open_makes_an_answer_partial(
    late: Diagnosis, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert late.naming is not None
    right = next(one for one in late.naming.candidates if one.effects == ("camera_latency",))
    wider, other = (
        stated(*names.split(), gain=1.0) for names in ("camera_latency part_yaw", "drag_drift")
    )
    for rivals, verdict in (((wider,), "partial"), ((wider, other), "ambiguous")):
        monkeypatch.setattr(
            "meso_robust.diagnosis.choice._answer", lambda *_, of=rivals: (right, of, True)
        )
        found = replace(late, grade=again(late))
        assert found.verdict == verdict
        assert set(found.answers) == {right, *rivals}
        assert "so does" in _why(found)
        assert "camera_latency + part_yaw" in _why(found)


def test_what_is_told_first_is_what_explains_most_and_then_what_is_beside_it(
    late: Diagnosis,
) -> None:
    """A reader must not doubt a delay for what of two small things is beside it."""
    whole, other = (stated("camera_latency", name, gain=1.0) for name in ("part_yaw", "drag_drift"))
    grade = replace(
        late.grade,
        verdict="partial",
        chosen=whole,
        beside=("part_yaw",),
        alike=(other,),
        shares={"camera_latency": 0.97, "part_yaw": 0.02},
    )
    said = _why(replace(late, grade=grade))
    assert said.startswith("camera_latency explains 97 % of the explainable error")
    assert (
        "; beside it is something small, which part_yaw explains, and so does drag_drift;" in said
    )
    most = replace(grade, shares={"camera_latency": 0.7, "part_yaw": 0.25})
    said = _why(replace(late, grade=most))
    assert said.startswith("camera_latency explains 70 % of the explainable error")
    assert "; beside it is something that part_yaw explains, and so does drag_drift;" in said
    alone = replace(most, beside=())
    assert "but so does camera_latency + drag_drift" in _why(replace(late, grade=alone))


@pytest.mark.parametrize(
    ("rivals", "common", "beside"),
    [
        (("part_yaw drag_drift",), 0.5, ("camera_latency",)),
        (("part_yaw drag_drift", "part_yaw backlash"), 0.5, ("camera_latency",)),
        # what all hold explains too little by itself
        (("part_yaw drag_drift",), 0.1, ()),
        # nothing is in all of them
        (("part_yaw drag_drift", "drag_drift"), 0.5, ()),
        (("drag_drift",), 0.5, ()),
    ],
)
def test_what_all_sets_hold_is_told_and_the_rest_left_open(
    rivals: tuple[str, ...], common: float, beside: tuple[str, ...]
) -> None:
    chosen, *others = (
        stated(*names.split(), gain=1000.0) for names in ("part_yaw camera_latency", *rivals)
    )
    judge = stood(
        {
            (): [1100.0] * 8,
            ("part_yaw",): [1100.0 - 1000.0 * common] * 8,
            **{one.effects: [100.0] * 8 for one in (chosen, *others)},
        }
    )
    apart, alike, found = _left_open(judge, chosen, tuple(others), 0)
    assert found == beside
    assert (apart, alike) == (((), tuple(others)) if beside else (tuple(others), ()))
    assert _left_open(judge, chosen, (), 0) == _left_open(judge, None, (), 0) == ((), (), ())


def test_a_law_is_open_where_another_one_of_the_same_physics_explains_nearly_as_much() -> None:
    """However surely it leaves more, and though it is the less likely one where both were fitted."""
    own, other = (
        stated(name, gain=gain) for name, gain in (("body_force", 1000.0), ("film_flow", 960.0))
    )
    less, foreign = stated("film_flow", gain=940.0), stated("drag_gradient", gain=960.0)
    nearly = [n + 0.04 * (p - n) for n, p in zip(NOISE, PLAIN, strict=True)]
    worse = [n + 0.06 * (p - n) for n, p in zip(NOISE, PLAIN, strict=True)]
    judge = stood(
        {(): PLAIN, ("body_force",): NOISE, ("film_flow",): nearly, ("drag_gradient",): nearly}
    )
    assert equal(judge, own, other, 0)
    assert not equal(judge, own, less, 0)
    assert not equal(judge, own, foreign, 0)
    assert not equal(
        stood({(): PLAIN, ("body_force",): NOISE, ("film_flow",): worse}), own, other, 0
    )
    # among the answers of a competition, too, and asked where it put the other law aside
    assert _answer(judge, contest(own, other, answers=(own, other)), (own, other), 0) == (
        own,
        (other,),
        True,
    )
    aside = stated("film_flow", gain=960.0, ground=Ground.MISMATCH_LEFT)
    naming = contest(own, aside, foreign, answers=(own,))
    first, (asked, then), _ = pools(naming, True)
    assert first == (naming, (own, aside))
    # of another answer what the held-out recordings said is noted in the list of candidates
    both = contest(own, replace(aside, p_value=0.5), answers=(own, aside))
    assert next(pools(both, True))[1] == (own, aside)
    assert asked is not None
    assert set(then) == {own, aside, foreign}
    assert _answer(judge, naming, (own, aside), 0) == (own, (aside,), True)
    # the fifth likeliest set may be the other law of the likeliest one
    many = [
        stated(name, gain=gain)
        for name, gain in (("a", 999.0), ("b", 998.0), ("c", 997.0), ("d", 996.0))
    ]
    (_, then), _ = pools(contest(own, *many, aside), True)
    assert then == (own, *many[:3], aside)


def test_laws_of_one_physics_are_no_reason_to_tell_less() -> None:
    one, other = stated("body_force", "c", gain=1000.0), stated("c", "film_flow", gain=999.0)
    most = [n + 0.3 * (p - n) for n, p in zip(NOISE, PLAIN, strict=True)]
    judge = stood(
        {(): PLAIN, ("c",): most, ("body_force",): PLAIN, one.effects: NOISE, other.effects: NOISE}
    )
    naming = contest(one, other, stated("c", gain=800.0))
    assert _answer(judge, naming, (one, other), 0) == (one, (other,), True)


def test_what_does_not_carry_over_is_no_rival() -> None:
    sums = {(): PLAIN, ("a",): NOISE, ("b",): NOISE}
    a, b = stated("a", gain=1000.0), stated("b", gain=1002.0)
    assert equal(stood(sums), a, b, 0)
    assert not equal(stood(sums, lost=(("b",),)), a, b, 0)


def test_a_member_that_explains_little_beside_the_others_is_told_apart() -> None:
    """What the form of a law leaves is a hundredth, which one of so many effects always takes up."""
    most, some = [2.0 * one for one in NOISE], [20.0 * one for one in NOISE]
    both = stated("a", "b", gain=1000.0)
    judge = stood({(): PLAIN, ("a",): most, ("b",): PLAIN, ("a", "b"): NOISE})
    assert slight(judge, both) == ()
    nearly = [one + 20.0 for one in NOISE]
    assert slight(stood({(): PLAIN, ("a",): nearly, ("b",): some, ("a", "b"): NOISE}), both) == (
        "b",
    )
    assert slight(judge, stated("a", gain=1000.0)) == ()


def extended(late: Diagnosis, monkeypatch: pytest.MonkeyPatch, **given: Any) -> tuple[str, ...]:
    """What is chosen with what is told apart, of sets beside "a", which leaves nine times the noise of every recording, of a thousand.

    Each is given by what it leaves of the recordings, and by how many half widths its size is beyond nought.
    """
    matters, open_high = given.pop("matters", 0.0), given.pop("open_high", False)
    parameter = SimpleNamespace(low=-9.0, high=given.pop("end", 9.0))
    alone = given.pop("alone", "")
    bench, plain = late.grade.bench, late.grade.plain
    parts = ("", "b", "c", "b_c", "a_c")
    left = dict.fromkeys(parts, (1000.0, 9.0)) | {"a": (10.0, 9.0)} | given
    ones, predicted = {}, {}
    for name, (level, ratio) in left.items():
        each = np.broadcast_to(level, len(bench.fold))[:, None, None]
        names = tuple(name.split("_")) if name else ()
        # the number of folds holds the ratio, for what stands in for the intervals
        predicted[names] = replace(
            plain,
            squares=np.where(bench.seen, each, 0.0),
            values=ratio,
            alone=((alone, "push_01.csv"),) if alone in names else (),
        )
        trials = tuple(SimpleNamespace(effect=one, sizes={"x": 1.0}) for one in names)
        refit = SimpleNamespace(effects=names, trials=trials, gain=1.0)
        ones[names] = Candidate(refit=cast(Refit, refit))

    def intervals(found: Any) -> list[Any]:
        half = 1.0 / found.values
        ends = {"value": 1.0, "low": 1.0 - half, "high": 1.0 + half}
        of = {"open_low": False, "open_high": open_high, "parameter": parameter, **ends}
        return [SimpleNamespace(key=f"{one}.x", **of) for one in "abc"]

    def further(base: Candidate) -> list[Candidate]:
        return [
            one
            for names, one in ones.items()
            if set(base.effects) < set(names) and len(names) == len(base.effects) + 1
        ]

    monkeypatch.setattr("meso_robust.diagnosis.further.intervals_by_fold", intervals)
    a = ones["a",]
    naming = Naming(answers=(), best=a, candidates=(a,), further=further)
    judge = Judge(bench, predicted, bench.seen.sum(axis=(1, 2)).astype(float))
    chosen, beside, alike, _ = with_more(judge, naming, a, None, matters, 0)
    return (
        *(name for name in chosen.effects if name not in beside),
        *(f"({b})" for b in beside),
        *("or " + "+".join(one.effects) for one in alike),
    )


def test_beside_a_strong_effect_a_further_one_is_asked_for(
    late: Diagnosis, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is half a hundredth of the whole error, and half of what is left."""
    assert extended(late, monkeypatch, a_b=(5.0, 9.0)) == ("a", "(b)")
    assert extended(late, monkeypatch, a_b=(5.0, 9.0), a_c=(8.0, 9.0)) == ("a", "(b)")
    # one that is a third of the whole is no afterthought, and may have others beside it
    more = {"a": (400.0, 9.0), "a_b": (40.0, 9.0)}
    assert extended(late, monkeypatch, **more) == ("a", "b")
    assert extended(late, monkeypatch, **more, a_b_c=(2.0, 9.0)) == ("a", "b", "(c)")


def test_what_one_push_alone_tells_of_is_no_further_effect(
    late: Diagnosis, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The fit that predicts the push has seen it."""
    assert extended(late, monkeypatch, alone="b", a_b=(5.0, 9.0)) == ("a",)
    assert extended(late, monkeypatch, alone="a", a_b=(5.0, 9.0)) == ("a", "(b)")


def test_a_further_effect_takes_away_much_everywhere_by_a_sure_amount_that_matters(
    late: Diagnosis, monkeypatch: pytest.MonkeyPatch
) -> None:
    one_fold = np.where(late.grade.bench.fold == 0, 400.0, 1.0)
    assert extended(late, monkeypatch, a_b=(9.0, 9.0)) == ("a",)
    assert extended(late, monkeypatch, a_b=(5.0, 2.0)) == ("a",)
    assert extended(late, monkeypatch, a_b=(5.0, 3.0)) == ("a", "(b)")
    # nearly all that is left, unless its size is at the end of its range
    assert extended(late, monkeypatch, a_b=(2.5, 0.5)) == ("a", "(b)")
    assert extended(late, monkeypatch, a_b=(2.9, 0.5)) == ("a",)
    assert extended(late, monkeypatch, a_b=(2.5, 0.1)) == ("a",)
    assert extended(late, monkeypatch, a_b=(2.5, 9.0), end=1.0) == ("a",)
    assert extended(late, monkeypatch, a_b=(5.0, 3.0), open_high=True) == ("a",)
    assert extended(late, monkeypatch, a_b=(one_fold, 9.0), a=(100.0, 9.0)) == ("a",)
    matters = 2.5 * float(late.grade.bench.baseline.noise.sigma[0])
    assert extended(late, monkeypatch, a_b=(5.0, 9.0), matters=matters) == ("a", "(b)")
    assert extended(late, monkeypatch, a_b=(5.0, 9.0), matters=1.5 * matters) == ("a",)


def test_of_further_effects_that_take_away_alike_none_is_named(
    late: Diagnosis, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One that is surely better, as it is in every recording, is told apart, however small or large."""
    some = np.where(late.grade.bench.fold == 0, 5.5, 5.0)
    some[-1] = 4.5
    assert extended(late, monkeypatch, a_b=(5.0, 9.0), a_c=(some, 9.0)) == ("a",)
    assert extended(late, monkeypatch, a_b=(5.0, 9.0), a_c=(some, 2.0)) == ("a",)
    assert extended(late, monkeypatch, a_b=(5.0, 9.0), a_c=(5.5, 9.0)) == ("a", "(b)")
    assert extended(late, monkeypatch, a_b=(5.0, 9.0), a_c=(7.0, 9.0)) == ("a", "(b)")
    # where each takes away nearly all that is left, it is one of them
    assert extended(late, monkeypatch, a_b=(2.5, 9.0), a_c=(0.5 * some, 9.0)) == (
        "a",
        "(b)",
        "or a+c",
    )
    more = {"a": (400.0, 9.0), "a_b": (40.0, 9.0)}
    assert extended(late, monkeypatch, **more, a_c=(110.0, 9.0)) == ("a", "(b)")
    assert extended(late, monkeypatch, **more, a_c=(120.0, 9.0)) == ("a", "b")


def test_of_further_effects_that_are_laws_of_one_physics_the_best_is_told_with_the_others(
    late: Diagnosis, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = {"a": (400.0, 9.0), "a_b": (40.0, 9.0), "a_c": (45.0, 9.0)}
    assert extended(late, monkeypatch, **given) == ("a", "(b)")
    of = {"a": "one", "b": "another", "c": "another"}
    monkeypatch.setattr("meso_robust.diagnosis.rivals.family_of", lambda name: of[name])
    assert extended(late, monkeypatch, **given) == ("a", "b", "or a+c")
    # it is the last: which law it is would have to be known first
    assert extended(late, monkeypatch, **given, a_b_c=(2.0, 9.0)) == ("a", "b", "or a+c")


def test_a_part_that_cannot_be_simulated_explains_nothing(
    late: Diagnosis, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object) -> None:
        raise np.linalg.LinAlgError

    assert late.naming is not None
    whole = late.naming.candidates[0]
    bench, plain = late.grade.bench, late.grade.plain
    judge = Judge(bench, {(): plain}, np.zeros(len(bench.fold)))
    monkeypatch.setattr("meso_robust.diagnosis.judge.rolled_out", fails)
    judge.with_part(whole, whole.effects[:1])
    assert judge.share(whole.effects[:1]) == 0.0


def test_a_set_that_does_not_carry_over_is_told_where_it_helps_more_than_one_recording() -> None:
    thrice = [6000.0, 95.0, 8000.0, 104.0, 98.0, 103.0, 7000.0, 97.0]
    once = [100.0, 95.0, 9000.0, 104.0, 98.0, 103.0, 300.0, 97.0]
    both = stated("a", "b", gain=1000.0)
    for plain, left, told in (
        (thrice, [2000.0, 95.0, 2500.0, 104.0, 98.0, 103.0, 2200.0, 97.0], both),
        (thrice, [6000.0, 95.0, 2500.0, 104.0, 98.0, 103.0, 2200.0, 97.0], None),  # not surely
        (once, [100.0, 95.0, 2400.0, 104.0, 98.0, 103.0, 300.0, 97.0], None),
    ):
        sums = {(): plain, ("a",): plain, ("b",): plain, ("a", "b"): left}
        judge = stood(sums, lost=(("a", "b"),))
        assert _holding(judge, contest(both), (both,), 0) == (told, told is None)
    assert judge.explained(("a", "b"), 0).low > 0.5  # by one recording


def test_of_sets_that_do_not_carry_over_the_one_of_fewest_effects_is_told() -> None:
    nearly = [100.0, 95.0, 200.0, 400.0, 98.0, 103.0, 150.0, 97.0]
    sums = {(): PLAIN, ("a",): nearly, ("b",): PLAIN, ("a", "b"): nearly}
    one, both = stated("a", gain=900.0), stated("a", "b", gain=1000.0)
    judge = stood(sums, lost=(("a",), ("a", "b")))
    assert _holding(judge, contest(both, one), (both, one), 0) == (one, False)


def test_one_effect_that_explains_as_much_as_scores_are_known_is_asked_as_well() -> None:
    """Four sets of two hold the first effect: what another one would do by itself is asked all the same."""
    sets = [stated("a", name, gain=20_000.0) for name in "wxyz"]
    for gain, asked in ((18_950.0, True), (18_850.0, False)):
        singles = [stated("a", gain=19_000.0), stated("b", gain=gain)]
        (_, pool), (_, later) = pools(contest(*sets, *singles), quick=True)
        assert (singles[1] in pool, singles[0] in pool) == (asked, True)
        # the next likeliest ones, if none of these explains anything
        assert (singles[1] in later, len(set(pool) & set(later))) == (not asked, 0)


def test_a_further_effect_that_does_the_work_of_another_is_not_named_beside_it(
    late: Diagnosis, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert extended(late, monkeypatch, a_b=(5.0, 9.0), b=(8.0, 9.0)) == ("a", "(b)")
    assert extended(late, monkeypatch, a_b=(5.0, 9.0), b=(5.5, 9.0)) == ("a",)


def test_of_all_effects_one_is_beyond_nought_in_a_tenth_of_sets_that_hold_none() -> None:
    drawn = np.random.default_rng(5).normal(size=(300_000, 6))
    without = (drawn.sum(axis=1, keepdims=True) - drawn) / 5.0
    half = 2.015 * np.sqrt(
        5.0 / 6.0 * np.sum((without - without.mean(axis=1)[:, None]) ** 2, axis=1)
    )
    chance = np.mean(np.abs(drawn.mean(axis=1)) > beyond_by_folds(6) * half)
    assert chance * len(CATALOGUE) == pytest.approx(0.1, rel=0.15)


def test_every_set_that_the_competition_leaves_is_asked_in_the_quick_form_too() -> None:
    """One that was not would have no roll-outs to be judged by."""
    left = tuple(stated(name, gain=1000.0) for name in "abcdef")
    pool = next(pools(contest(*left, answers=left), quick=True))[1]
    assert pool == left
    judge = stood({(): PLAIN} | {one.effects: NOISE for one in left[:5]})
    # the sixth cannot be simulated: it is no answer, and no fault
    assert _answer(judge, contest(*left, answers=left), left[:5], 0) == (left[0], left[1:5], True)


def test_one_recording_that_has_nearly_all_that_is_left_is_told(late: Diagnosis) -> None:
    assert late.naming is not None
    none = replace(late.naming, answers=(), candidates=(), best=None)
    grade = again(late, naming=none)
    assert grade.remainder.odd == ""
    bench = grade.bench
    seen, file = bench.prepared.seen.copy(), bench.prepared.files[2]
    seen[2, -20:, :2] += 500.0 * UM  # of one recording, as where its clock is off
    moved = replace(bench, prepared=replace(bench.prepared, seen=seen))
    odd = replace(late, grade=again(replace(late, grade=replace(grade, bench=moved)), naming=none))
    assert odd.verdict == "unknown"
    assert odd.grade.remainder.odd == file
    assert f"nearly all of the error is in {file}" in _why(odd)
    assert file in str(next_experiment(odd)["push"])


@pytest.mark.parametrize(("behind", "kept"), [(60.0, False), (0.0, True)])
def test_a_set_that_explains_as_much_with_more_is_asked_beside_a_further_effect(
    behind: float, kept: bool
) -> None:
    """Its effects may be what the further one is in truth: where that leaves surely less, they are not told."""
    part, whole, other = (
        stated(*names.split(), gain=1000.0) for names in ("a", "a b", "b dry_friction")
    )
    assert _all_longer((other,), part)
    assert not _all_longer((stated("c", gain=1000.0),), part)
    worse = [one + behind for one in NOISE]
    judge = stood({(): PLAIN, ("a",): worse, ("a", "b"): NOISE, other.effects: worse})
    assert _outdone(judge, whole, other, 0) is not kept
    assert _outdone(judge, whole, whole, 0)


def test_what_is_beside_laws_of_one_physics_is_told_though_the_law_is_open(
    late: Diagnosis, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two laws explain as much, and one of them leaves half as much with a wave beside it."""
    names = ("stribeck_friction", "breakaway_friction", "backlash", "breakaway_friction backlash")
    first, other, alone, whole = (stated(*one.split(), gain=1000.0) for one in names)
    few = [one + 3.0 for one in NOISE]
    judge = stood(
        {
            (): PLAIN,
            first.effects: few,
            other.effects: few,
            alone.effects: PLAIN,
            whole.effects: NOISE,
        }
    )
    monkeypatch.setattr(
        "meso_robust.diagnosis.further._adds", lambda _, part, of, __: (part, of) == (other, whole)
    )
    naming = Naming(answers=(), best=first, candidates=())

    def told(alike: tuple[Candidate, ...]) -> tuple[Candidate, tuple[str, ...], Any]:
        return _with_what_is_beside(judge, naming, first, alike, None, 1.0, 0)[:3]

    assert told((other, whole)) == (whole, ("backlash",), (other,))
    assert told((other, alone)) == (first, (), (other, alone))
    assert with_one_more(judge, (first,), (whole,), 1.0) is None


def test_the_effect_that_explains_most_is_told_first(late: Diagnosis) -> None:
    grade = late.grade
    two = replace(grade, chosen=stated("a", "b", gain=1.0), shares={"a": 0.1, "b": 0.8})
    assert _by_share(two) == ("b", "a")
