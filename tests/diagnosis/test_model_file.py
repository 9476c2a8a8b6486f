"""``model.toml`` of a diagnosis, read back and made again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meso_robust.diagnosis.answer import document, model_toml
from meso_robust.diagnosis.common_error import roomier
from meso_robust.diagnosis.diagnose import Diagnosis, _numbers
from meso_robust.identification.document import ModelDocument, read_model
from meso_robust.identification.forward import predicted
from meso_robust.simulator import Effects


def read(found: Diagnosis, folder: Path) -> ModelDocument:
    path = folder / "model.toml"
    path.write_text(model_toml(found, "1.2.3"), encoding="utf-8")
    return read_model(path)


def test_an_extended_model_is_made_again_from_its_file(late: Diagnosis, tmp_path: Path) -> None:
    again = read(late, tmp_path)
    assert late.best is not None
    fits = late.best.refit.fits
    made = again.made()
    assert again.model == made.name == "viscous+camera_latency"
    assert made.keys == ("rho_um2", "mu", "camera_latency.time_ms")
    np.testing.assert_allclose(again.values, fits.values[0], rtol=1e-9)
    known = again.parameters["camera_latency.time_ms"]
    assert known.value == pytest.approx(60.0, abs=1.0)
    assert known.low < known.value < known.high
    table = made.physics(again.values[None]).effects.table
    delay = Effects({"camera_latency": {"time_ms": known.value}}).table
    np.testing.assert_allclose(table, delay, rtol=1e-9)


def test_the_model_of_the_file_predicts_the_recordings(late: Diagnosis, tmp_path: Path) -> None:
    again = read(late, tmp_path)
    assert late.best is not None
    refit, at = late.best.refit, late.baseline
    poses = predicted(
        at.prepared,
        again.made(),
        again.values[None],
        starts=refit.fits.starts[0],
        offsets=refit.fits.offsets[0],
    ).poses[0]
    away = ((at.prepared.seen - poses) / at.settings.sigma)[at.seen]
    assert np.sqrt(np.mean(away**2)) == pytest.approx(1.0, abs=0.06)
    plain = predicted(at.prepared, at.model, at.fits.values, starts=at.fits.starts[0]).poses[0]
    off = ((at.prepared.seen - plain) / at.settings.sigma)[at.seen]
    assert np.sqrt(np.mean(off**2)) > 2.0


def test_a_model_that_leaves_more_than_noise_has_the_numbers_of_its_roll_outs(
    late: Diagnosis, tmp_path: Path
) -> None:
    """Starts that are free take up what is wrong; those of roll-outs are held where the parts were seen."""
    assert late.best is not None
    assert late.grade.extended is not None
    assert not late.grade.extended.weighed
    rolled = replace(late.grade.extended, weighed=True)
    known = _numbers(late.baseline, late.best.refit, rolled)
    found = replace(late, known=known, grade=replace(late.grade, extended=rolled))
    again = read(found, tmp_path)
    np.testing.assert_allclose(again.values, rolled.values, rtol=1e-9)
    own = again.parameters["camera_latency.time_ms"]
    late_by = 1e3 * rolled.by_fold[:, 2]
    count = len(late_by)
    error = np.sqrt((count - 1) * np.mean((late_by - late_by.mean()) ** 2))
    (exact,) = roomier(
        late.best.refit,
        tuple(
            replace(one, low=one.value, high=one.value)
            for one in known
            if one.key == "camera_latency.time_ms"
        ),
    )
    room = 1e3 * (exact.high - exact.value)
    assert room > 0.0
    # Student, 5 degrees, and what may be undetected
    assert own.high - own.value == pytest.approx(np.hypot(2.015 * error, room), rel=1e-3)
    assert len(again.recording) == len(found.grade.bench.prepared.files)
    (minimum,) = again.minima
    away = (found.grade.bench.prepared.seen - rolled.poses) / late.baseline.settings.sigma
    assert minimum.cost == pytest.approx(np.nansum(away**2))


def test_what_the_file_says_of_the_fit(late: Diagnosis, tmp_path: Path) -> None:
    again = read(late, tmp_path)
    assert again.diagnosis == "named"
    assert again.provenance.meso_robust == "1.2.3"
    training = [one.file for one in late.split.training.recordings]
    assert [one.file for one in again.recording] == training
    for row in again.recording:
        assert row.x_um == pytest.approx(1.2, rel=0.3)
        assert row.theta_deg == pytest.approx(0.08, rel=0.3)
    assert "film_viscosity" in [one.name for one in again.not_identifiable]
    (effect,) = document(late, "0").effects
    stated = again.parameters["camera_latency.time_ms"]
    assert stated.value == effect.parameters["time_ms"].value
    assert (stated.low, stated.high) == (
        effect.parameters["time_ms"].low,
        effect.parameters["time_ms"].high,
    )


def test_where_nothing_was_added_the_plain_model_is_given(null: Diagnosis, tmp_path: Path) -> None:
    again = read(null, tmp_path)
    assert again.model == "viscous"
    assert again.diagnosis == "consistent"
    assert again.made().keys == ("rho_um2", "mu")
    np.testing.assert_allclose(again.values, null.baseline.fits.values[0], rtol=0.02)
    np.testing.assert_allclose(again.values, [0.276e-6, 0.3], rtol=0.1)
