"""A residual law is found where one was put, told by what it predicts, and written as a model."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meso_robust.diagnosis.answer import document, model_toml
from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.document import DiagnosisDocument
from meso_robust.diagnosis.folds import Bench, bench_of, rolled_out
from meso_robust.diagnosis.residual import ResidualLaw, residual_law
from meso_robust.identification.document import read_model
from meso_robust.identification.forward import predicted
from meso_robust.identification.models import with_effects
from tests.diagnosis.conftest import baseline_of, regraded, small_set

TRUE = {"torque_um": 40.0, "across_cos1": 0.15}


@pytest.fixture(scope="module")
def pushes() -> Bench:
    """Fourteen pushes: halves of seven tell two bases."""
    recordings = small_set(None, 14)
    return bench_of(recordings, baseline_of(recordings), 0)


def seen_with(bench: Bench, terms: dict[str, float]) -> Bench:
    """The pushes of a set, had the part obeyed some bases beside the plain model."""
    baseline = bench.baseline
    model = baseline.model
    values = baseline.fits.values[0]
    if terms:
        model = with_effects(model, {}, fixed={"residual": terms})
    poses = predicted(bench.prepared, model, values[None]).poses[0]
    noise = np.random.default_rng(5).normal(size=poses.shape) * baseline.noise.sigma
    seen = np.where(bench.seen, poses + noise, np.nan)
    return replace(bench, prepared=replace(bench.prepared, seen=seen))


def law_of(bench: Bench) -> ResidualLaw | None:
    baseline = bench.baseline
    return residual_law(bench, rolled_out(bench, baseline.model, baseline.fits.values[0]), 0)


@pytest.fixture(scope="module")
def planted(pushes: Bench) -> ResidualLaw:
    law = law_of(seen_with(pushes, TRUE))
    assert law is not None
    return law


def test_the_bases_that_were_put_in_are_chosen_with_their_sizes(planted: ResidualLaw) -> None:
    found = {one.key.partition(".")[2]: one.shown for one in planted.bases}
    assert set(TRUE) <= set(found)
    for key, value in TRUE.items():
        assert found[key]["low"] <= value <= found[key]["high"]
        assert found[key]["value"] == pytest.approx(value, rel=0.2)
        assert planted.chosen[key] >= 0.75


def test_the_gain_is_that_of_recordings_that_neither_choice_nor_fit_has_seen(
    planted: ResidualLaw,
) -> None:
    share, low, high = planted.fall
    assert low <= share <= high
    assert share > 0.8  # some folds choose one base of two
    assert planted.offered
    assert planted.metres[1] < 0.5 * planted.metres[0]


def test_a_recording_has_no_say_in_the_choice_that_predicts_it(
    pushes: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each fold is predicted with the bases that the others choose."""
    from meso_robust.diagnosis import residual

    asked: list[tuple[int, ...]] = []
    real = residual._stability

    def watched(system: residual._System, rows: np.ndarray, seed: int) -> np.ndarray:
        asked.append(tuple(rows.tolist()))
        return np.asarray(real(system, rows, seed))

    monkeypatch.setattr(residual, "_stability", watched)
    bench = seen_with(pushes, {"torque_um": 40.0})
    assert law_of(bench) is not None
    whole, *rest = asked
    assert whole == tuple(range(14))
    assert len(rest) == bench.count
    for fold, rows in enumerate(rest):
        assert rows == tuple(np.flatnonzero(bench.fold != fold).tolist())


def test_noise_alone_offers_no_law(pushes: Bench) -> None:
    law = law_of(seen_with(pushes, {}))
    assert law is None or not law.offered


def test_a_few_recordings_have_no_halves(null: Diagnosis) -> None:
    bench = null.grade.bench
    few = replace(bench, fold=bench.fold[:5])
    assert residual_law(few, null.grade.plain, 0) is None


def test_it_is_written_as_a_term_that_the_simulator_runs(
    null: Diagnosis, pushes: Bench, planted: ResidualLaw, tmp_path: Path
) -> None:
    baseline = pushes.baseline
    plain = rolled_out(pushes, baseline.model, baseline.fits.values[0])
    found = replace(regraded(null, verdict="unknown", bench=pushes, plain=plain), residual=planted)
    told = document(found, "1.2.3")
    again = DiagnosisDocument.model_validate_json(told.model_dump_json(by_alias=True))
    assert again.residual is not None
    assert set(TRUE) <= set(again.residual.bases)
    assert again.residual.offered
    assert not again.effects  # a law is no name

    path = tmp_path / "model.toml"
    path.write_text(model_toml(found, "1.2.3"), encoding="utf-8")
    read = read_model(path)
    assert read.model == "viscous+residual"
    assert read.interval == "jackknife"
    made = read.made()
    bench = seen_with(pushes, TRUE)
    own = predicted(bench.prepared, made, read.values[None]).poses[0]
    away = (own - predicted(bench.prepared, planted.model, planted.values[None]).poses[0])[
        bench.seen
    ]
    assert np.abs(away).max() < 1e-9

    without = replace(found, residual=replace(planted, offered=False))
    path.write_text(model_toml(without, "1.2.3"), encoding="utf-8")
    assert read_model(path).model == "viscous"
    section = document(without, "1.2.3").residual
    assert section is not None
    assert not section.offered


def test_an_older_document_has_none(null: Diagnosis) -> None:
    text = json.loads(document(null, "1.2.3").model_dump_json(by_alias=True))
    del text["residual"]
    assert DiagnosisDocument.model_validate_json(json.dumps(text)).residual is None


def test_a_base_counts_by_what_the_model_and_other_bases_cannot_do() -> None:
    """Of three bases: one mostly like a parameter, one all its own, one that is the parameter."""
    from meso_robust.diagnosis.residual import _pursued, _System

    parameter, other, own, rest = np.eye(4)
    hidden = parameter + 0.1 * own  # its own part is a hundredth of its square
    columns = np.stack([parameter, hidden, other, parameter, rest, rest + other])
    data = 3.0 * parameter + 0.5 * own + 0.2 * other
    system = _System(columns @ columns.T[None], (columns @ data)[None], 1)
    chosen = _pursued(system, np.array([0]))
    assert chosen[:2] == [0, 1]
