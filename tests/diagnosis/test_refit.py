"""Refits with an effect, and their evidence against that of a linear Gaussian model in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.refit import WIDTH, Refit, _first, refined, refitted
from meso_robust.diagnosis.signatures import Signature, extended, signatures
from meso_robust.diagnosis.trials import Trial
from tests.diagnosis.conftest import coloured

Floats = npt.NDArray[np.float64]
DRIFT = Trial(effect="camera_drift", sizes={"x_um_s": 0.3, "y_um_s": 0.3})


@pytest.fixture(scope="module")
def drift(null: Diagnosis) -> tuple[Baseline, Signature, Refit]:
    """The null set without colour, its camera drifting by 0.15 µm/s along x, and a refit with it."""
    plain = coloured(null.baseline, 0.0)
    moved = 0.15e-6 * (plain.prepared.instants[..., None] * [1.0, 0.0, 0.0]) * plain.seen
    at = replace(
        plain,
        prepared=replace(plain.prepared, seen=plain.prepared.seen + moved),
        fits=replace(plain.fits, residuals=plain.fits.residuals + moved / plain.settings.sigma),
    )
    (one,) = signatures(at, [DRIFT])
    return at, one, refitted(at, (one,))


def nuisances(at: Baseline) -> Floats:
    """(M, n + 3 R) columns of parameters and starts, every recording with starts of its own."""
    count, frames = at.seen.shape[:2]
    n = len(at.model.parameters)
    white = at.jacobian.reshape(count, frames, 3, -1) * at.seen[..., None]
    columns = [white[..., k].ravel() for k in range(n)]
    for k in range(n, n + 3):
        for r in range(count):
            own = np.zeros(at.seen.shape)
            own[r] = white[r, ..., k]
            columns.append(own.ravel())
    return np.stack(columns, axis=1)


def log_evidence_gain(left: Floats, columns: Floats) -> float:
    """ln p(r | with) − ln p(r | without), the sizes normal about nought with `WIDTH`.

    ``N(r; 0, 1 + w² S Sᵀ)`` against ``N(r; 0, 1)``, by Sylvester's and Woodbury's identities.
    """
    gram = np.eye(columns.shape[1]) + WIDTH**2 * columns.T @ columns
    slope = columns.T @ left
    taken = WIDTH**2 * slope @ np.linalg.solve(gram, slope)
    return float(0.5 * taken - 0.5 * np.linalg.slogdet(gram)[1])


def test_the_evidence_is_that_of_a_linear_gaussian_model(
    drift: tuple[Baseline, Signature, Refit],
) -> None:
    at, _, refit = drift
    clock = at.prepared.instants - at.prepared.instants[:, :1]
    columns = np.zeros((2, *at.seen.shape))
    for axis in range(2):  # a camera that drifts shows r + v t
        columns[axis, ..., axis] = 0.3e-6 * clock / at.settings.sigma[axis]
    columns = np.where(at.seen, columns, 0.0).reshape(2, -1).T
    rows = np.where(at.seen, at.fits.residuals[0], 0.0).ravel()
    taken = np.linalg.qr(nuisances(at))[0]
    left, free = (one - taken @ (taken.T @ one) for one in (rows, columns))
    assert refit.gain == pytest.approx(log_evidence_gain(left, free), abs=0.1)
    sizes = np.linalg.lstsq(free, left, rcond=None)[0]
    assert refit.chi2 == pytest.approx(float(np.sum((left - free @ sizes) ** 2)), abs=0.2)
    np.testing.assert_allclose(refit.fits.values[0, 2:] / 0.3e-6, sizes, atol=0.02)


def test_a_refit_knows_its_effects(drift: tuple[Baseline, Signature, Refit]) -> None:
    at, one, refit = drift
    assert refit.trials == (one.trial,)
    assert refit.effects == ("camera_drift",)
    assert refit.numbers == 2
    assert refit.model.name == "viscous+camera_drift"
    assert refit.evidence @ refit.evidence == pytest.approx(refit.chi2)
    assert refit.tangent.shared.shape[1] == at.tangent.shared.shape[1] + 2


def test_a_hidden_delay_is_found_at_its_size(late: Diagnosis) -> None:
    assert late.best is not None
    refit = late.best.refit
    assert refit.effects == ("camera_latency",)
    assert refit.fits.values[0, -1] == pytest.approx(0.06, abs=0.001)
    free = late.baseline.seen.sum() - 3.0 * len(late.baseline.prepared.files) - 3.0
    assert refit.chi2 / free == pytest.approx(1.0, abs=5.0 * np.sqrt(2.0 / free) + 0.02)
    before = float(late.baseline.evidence @ late.baseline.evidence)
    # a handful of nats for one number, next to thousands that it explains
    assert 0.0 < 0.5 * (before - refit.chi2) - refit.gain < 30.0


def test_a_search_taken_to_its_end_is_no_worse(late: Diagnosis) -> None:
    (one,) = [s for s in late.detected.signatures if s.trial.effect == "camera_latency"]
    rough = refitted(late.baseline, (one,))
    more = refined(late.baseline, (one,), rough)
    assert more.gain > rough.gain - 0.05
    assert more.fits.values[0, -1] == pytest.approx(0.06, abs=0.001)


def test_an_effect_far_beyond_what_matters_is_found(late: Diagnosis) -> None:
    """On a bench a delay of 2 ms matters, and cameras are late by a hundred: steps must not be of what matters."""
    (one,) = signatures(late.baseline, [Trial(effect="camera_latency", sizes={"time_ms": 0.4})])
    more = refined(late.baseline, (one,), refitted(late.baseline, (one,)))
    assert more.fits.values[0, -1] == pytest.approx(0.06, abs=0.001)


def test_an_effect_at_the_end_of_its_range_takes_nothing_of_the_data(null: Diagnosis) -> None:
    # with the residuals turned round, what would be a positive size becomes a negative one
    at = null.baseline
    (one,) = signatures(
        at, [Trial(effect="tip_attraction", sizes={"pull_um_s": 2.0}, shape={"range_um": 3.0})]
    )
    left = one.left(at.tangent)[0]
    sign = -np.sign(left @ at.evidence)
    mirrored = replace(
        at,
        prepared=replace(
            at.prepared,
            seen=at.prepared.seen + (sign - 1.0) * at.fits.residuals[0] * at.settings.sigma,
        ),
        fits=replace(at.fits, residuals=sign * at.fits.residuals),
    )
    refit = refitted(mirrored, (one,))
    assert refit.fits.values[0, -1] == pytest.approx(0.0, abs=1e-9)
    assert refit.tangent.shared.shape == at.tangent.shared.shape
    assert refit.gain <= 0.0


def test_a_second_effect_goes_on_from_the_first(late: Diagnosis) -> None:
    (one,) = [s for s in late.detected.signatures if s.trial.effect == "camera_latency"]
    (two,) = signatures(late.baseline, [DRIFT])
    assert late.best is not None
    both = refitted(late.baseline, (one, two), start=late.best.refit)
    assert both.effects == ("camera_drift", "camera_latency")
    assert both.model.keys[2:] == (
        "camera_latency.time_ms",
        "camera_drift.x_um_s",
        "camera_drift.y_um_s",
    )
    assert both.fits.values[0, 2] == pytest.approx(0.06, abs=0.002)
    assert np.abs(both.fits.values[0, 3:]).max() < 0.2e-6
    assert both.chi2 < late.best.refit.chi2 + 1.0
    assert both.gain < late.best.refit.gain  # the drift is not there


def test_a_search_begins_half_way_to_the_end_of_a_range_at_most(
    null: Diagnosis, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A strong lay is searched from 0.8 / 2, not from the end that a linear estimate puts it at; a drift has no end."""
    lay = Trial(
        effect="anisotropic_drag",
        sizes={"fraction": 0.05},
        shape={"direction_deg": 45.0},
        free={"direction_deg": 20.0},
    )
    for trial, size, start in ((lay, 25.0, 0.4), (lay, -25.0, -0.4), (lay, 4.0, 0.2)):
        (one,) = signatures(null.baseline, [trial])
        monkeypatch.setattr(
            "meso_robust.diagnosis.refit.estimate", lambda *_, of=size: (np.array([of]), 1.0)
        )
        model = extended(null.baseline.model, (trial,), null.baseline.prepared)
        begun = _first(null.baseline, (one,), model, None)
        np.testing.assert_allclose(begun[-2:], [start, np.pi / 4.0])
