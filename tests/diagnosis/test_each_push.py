"""Friction that differs from push to push: nothing tells it of another push, and it is told as such."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
import pytest

from meso_robust.diagnosis import diagnose as diagnosing
from meso_robust.diagnosis.answer import document
from meso_robust.diagnosis.diagnose import Diagnosis, _by_push, diagnose
from meso_robust.diagnosis.document import DiagnosisDocument
from meso_robust.diagnosis.each_push import EachPush, _order, each_push
from meso_robust.diagnosis.folds import bench_of, rolled_out
from meso_robust.diagnosis.judge import Explained
from meso_robust.recordings import RecordingSet
from tests.diagnosis.conftest import baseline_of
from tests.diagnosis.designs import MU, random_plans, recorded_plans
from tests.identification.sets import UM
from tests.nightly import at_night

OWN = (0.19, 0.41, 0.24, 0.36, 0.15, 0.45, 0.22, 0.38, 0.27, 0.33)


def slipping(own: tuple[float, ...]) -> RecordingSet:
    """Slanted pushes, each with a friction of its own."""
    rng = np.random.default_rng(8)
    plans = [
        replace(plan, slant=0.6 * np.sign(plan.slant))
        for plan in random_plans(rng, len(own), (75 * UM, 150 * UM))
    ]
    sets = [
        recorded_plans([plan], rng, {"friction_spread": {"change": mu / MU - 1.0, "tip": 0.0}})
        for plan, mu in zip(plans, own, strict=True)
    ]
    named = [replace(one.recordings[0], file=f"push_{k:02d}.csv") for k, one in enumerate(sets)]
    return replace(sets[0], recordings=tuple(named))


@pytest.fixture(scope="module")
def found() -> Diagnosis:
    return diagnose(slipping(OWN), quick=True)


@at_night
def test_it_is_told_with_its_spread(found: Diagnosis) -> None:
    told = document(found, "1.2.3")
    (effect,) = told.effects
    (spread,) = effect.parameters.values()
    assert (told.verdict, effect.name, effect.stage) == ("partial", "friction_spread", "contact")
    assert spread.low <= np.std(OWN, ddof=1) / np.mean(OWN) <= spread.high
    assert told.explained is not None
    assert told.explained.share > 0.9
    assert "friction = [" in told.next_experiment.push.what
    assert DiagnosisDocument.model_validate_json(told.model_dump_json(by_alias=True)) == told


def own_of(recordings: RecordingSet) -> EachPush | None:
    baseline = baseline_of(recordings)
    bench = bench_of(recordings, baseline, 0)
    return each_push(bench, rolled_out(bench, baseline.model, baseline.fits.values[0]), 1.0, 0)


def test_every_push_tells_its_own_where_its_tip_slips() -> None:
    own = own_of(slipping(OWN))
    assert own is not None
    assert own.explained.low > 0.9
    assert own.least == pytest.approx(min(OWN), rel=0.1)
    assert own.most == pytest.approx(max(OWN), rel=0.1)
    assert own.pushes == 7  # in the others it sticks


def test_one_friction_of_all_pushes_is_no_spread() -> None:
    own = own_of(slipping((0.3,) * len(OWN)))
    assert own is None or not own.explained.tells


def test_of_tips_without_friction_nothing_is_told() -> None:
    some = slipping(OWN[:3])
    baseline = baseline_of(some)
    bench = bench_of(some, baseline, 0)
    plain = rolled_out(bench, baseline.model, baseline.fits.values[0])
    smooth = replace(plain, values=plain.values * [1.0, 0.0])
    assert each_push(bench, smooth, 1.0, 0) is None
    assert each_push(bench, plain, 1.0, 0) is None  # three pushes are too few


def test_friction_that_rises_with_use_is_told_by_the_order_of_the_files() -> None:
    rising, mixed = (own_of(slipping(own)) for own in (tuple(sorted(OWN)), OWN))
    assert rising is not None
    assert mixed is not None
    assert rising.order > 0.9 > 0.5 > abs(mixed.order)
    assert rising.order_p < 0.001 < 0.1 < mixed.order_p


def test_the_tenth_file_comes_after_the_second() -> None:
    files = [f"push_{k}.csv" for k in range(1, 21)]
    assert _order(np.arange(20.0), files) == pytest.approx((1.0, 0.0))
    assert _order(np.ones(20), files) == (0.0, 1.0)


@pytest.mark.parametrize(
    ("verdict", "high", "by_push"),
    [("partial", 0.78, True), ("partial", 0.97, False), ("unknown", None, True)],
)
def test_it_takes_the_place_of_effects_that_surely_explain_less(
    late: Diagnosis,
    monkeypatch: pytest.MonkeyPatch,
    verdict: Literal["partial", "unknown"],
    high: float | None,
    *,
    by_push: bool,
) -> None:
    own = EachPush(
        spread=(0.2, 0.1, 0.3),
        least=0.2,
        most=0.4,
        pushes=7,
        explained=Explained(share=0.97, low=0.95, high=0.99, folds=12),
        order=0.9,
        order_p=0.001,
    )
    monkeypatch.setattr(diagnosing, "each_push", lambda *_: own)
    other = None if high is None else Explained(share=0.6, low=0.3, high=high, folds=6)
    found = _by_push(replace(late, grade=replace(late.grade, verdict=verdict, explained=other)))
    assert (found.each_push is own) is by_push
    if by_push:
        assert "rises in the order of the files" in document(found, "1").why
