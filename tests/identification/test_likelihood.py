"""Maximum likelihood: its algebra against dense matrices, its answers against the truth."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from meso_robust.identification import problem
from meso_robust.identification.forward import predicted
from meso_robust.identification.identify import Identification, maximised
from meso_robust.identification.likelihood import Settings, _best_step, fit, fit_part
from meso_robust.identification.models import three_point, viscous
from meso_robust.identification.prepared import Sigmas, prepare, some_of
from meso_robust.identification.problem import Arrow, Problem
from meso_robust.recordings import RecordingSet
from meso_robust.simulator import ThreePoints
from tests.identification.conftest import MU, RHO
from tests.identification.sets import (
    FIRST_TABLE_POINTS,
    PART,
    SENSOR,
    random_pushes,
    recorded,
)

MODEL = viscous(PART.outline)
NOISE = Settings(position=SENSOR.position_sigma, orientation=SENSOR.orientation_sigma)


def dense(jacobian: np.ndarray, n: int) -> np.ndarray:
    """(R M, n + R d) the whole Jacobian of one fit from (R, M, n + d)."""
    recordings, rows, columns = jacobian.shape
    d = columns - n
    whole = np.zeros((recordings * rows, n + recordings * d))
    for r in range(recordings):
        block = slice(r * rows, (r + 1) * rows)
        whole[block, :n] = jacobian[r, :, :n]
        whole[block, n + r * d : n + (r + 1) * d] = jacobian[r, :, n:]
    return whole


def test_the_arrow_solves_the_whole_least_squares_problem() -> None:
    rng = np.random.default_rng(0)
    n, d, recordings, rows = 2, 3, 4, 20
    jacobian = rng.standard_normal((recordings, rows, n + d))
    residuals = rng.standard_normal((recordings, rows))
    turned = np.swapaxes(jacobian, -1, -2)
    arrow = Arrow(
        normal=(turned @ jacobian)[None],
        slope=(turned @ residuals[..., None])[None, ..., 0],
        parameters=n,
    )
    whole = dense(jacobian, n)
    answer = np.linalg.lstsq(whole, residuals.ravel(), rcond=None)[0]
    shared, own = arrow.step(np.zeros(1), np.ones((1, n), dtype=bool))
    np.testing.assert_allclose(shared[0], answer[:n], rtol=1e-6)
    np.testing.assert_allclose(own[0].ravel(), answer[n:], rtol=1e-6, atol=1e-9)
    covariance = np.linalg.inv(whole.T @ whole)[:n, :n]
    np.testing.assert_allclose(np.linalg.inv(arrow.information()[0]), covariance, rtol=1e-6)
    left = residuals.ravel() - whole @ answer
    fall = arrow.fall(shared, own)[0]
    np.testing.assert_allclose(fall, residuals.ravel() @ residuals.ravel() - left @ left, rtol=1e-6)


def test_fits_from_far_apart_meet_and_a_held_parameter_stays(film_set: RecordingSet) -> None:
    prepared = prepare(film_set, step=2 * MODEL.step, most_frames=60)
    away = np.array([[0.15e-6, 0.6], [0.8e-6, 0.15], [RHO, MU]])
    found = fit(prepared, MODEL, away, NOISE)
    assert found.converged.all()
    np.testing.assert_allclose(found.fits.values[1:], found.fits.values[:2], rtol=1e-4)
    held = fit(prepared, MODEL, away, NOISE, held=np.array([True, False]))
    np.testing.assert_array_equal(held.fits.values[:, 0], away[:, 0])
    assert np.all(held.fits.chi2[:2] > found.fits.chi2[:2] + 100.0)


def test_a_step_of_a_chord_that_does_what_is_hoped_for_is_tried_alone(
    film_set: RecordingSet, monkeypatch: pytest.MonkeyPatch
) -> None:
    prepared = prepare(film_set, step=2 * MODEL.step, most_frames=60)
    near = np.array([[1.05 * RHO, 0.95 * MU]])
    known = fit(prepared, MODEL, near, replace(NOISE, most=1))
    tried: list[int] = []

    def counted(*given: object, **more: object) -> object:
        tried.append(len(given[2]))  # type: ignore[arg-type]
        return predicted(*given, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(problem, "predicted", counted)
    found = fit(prepared, MODEL, near, NOISE.by_chord(2, 1e-2), jacobian=known.jacobian)
    assert found.fits.chi2[0] < known.fits.chi2[0]
    assert tried == [1, 1, 1]  # where it starts, and two steps


def test_derivatives_of_elsewhere_that_lead_nowhere_are_taken_anew(film_set: RecordingSet) -> None:
    """They must not end a fit by promising a fall that does not come."""
    prepared = prepare(film_set, step=2 * MODEL.step, most_frames=60)
    best = fit(prepared, MODEL, np.array([[RHO, MU]]), NOISE)
    near = np.array([[1.2 * RHO, 0.8 * MU]])
    found = fit(prepared, MODEL, near, NOISE.by_chord(16, 1e-2), jacobian=-best.jacobian)
    assert found.converged[0]
    assert found.fits.chi2[0] < best.fits.chi2[0] + 2.0


def test_a_fit_of_some_recordings_goes_on_where_that_of_all_ended(
    film_set: RecordingSet, monkeypatch: pytest.MonkeyPatch
) -> None:
    prepared, rows = prepare(film_set, step=MODEL.step), np.array([0, 2])
    settings = NOISE.by_chord(8, 1.0)
    whole = fit(prepared, MODEL, np.array([[0.9 * RHO, MU]]), settings)
    some = some_of(prepared, rows)
    again = fit(
        some,
        MODEL,
        whole.fits.values,
        settings,
        starts=whole.fits.starts[:, rows],
        offsets=whole.fits.offsets[:, rows],
    )
    monkeypatch.setattr(Problem, "jacobian", None)  # it has derivatives, which will do
    found = fit_part(some, MODEL, whole, rows, settings)
    np.testing.assert_allclose(found.fits.values, again.fits.values, rtol=1e-3)
    np.testing.assert_allclose(found.fits.chi2, again.fits.chi2, rtol=1e-3)


def test_a_step_that_is_no_number_is_not_taken(film_set: RecordingSet) -> None:
    """Derivatives of a search far out may overflow; that must end a step, not the whole."""
    prepared = prepare(film_set, step=2 * MODEL.step, most_frames=60)
    problem = Problem(prepared, MODEL, NOISE)
    values = np.array([[RHO, MU], [RHO, MU]])
    fits = problem.at(
        values, np.tile(prepared.starts, (2, 1, 1)), np.zeros((2, len(prepared.files), 4))
    )
    steps, own = np.zeros((2, 2)), np.zeros((2, len(prepared.files), 7))
    own[1, 0, 2] = np.nan
    found = problem.tried(fits, steps, own, np.ones((2, 2), dtype=bool))
    assert found.chi2[0] == pytest.approx(fits.chi2[0], rel=1e-6)
    assert found.chi2[1] == np.inf
    np.testing.assert_array_equal(found.starts[1], found.starts[0])


def test_a_fit_that_is_closed_has_the_derivatives_of_its_end(film_set: RecordingSet) -> None:
    prepared = prepare(film_set, step=2 * MODEL.step, most_frames=60)
    near = np.array([[1.2 * RHO, 0.8 * MU]])
    quick = NOISE.by_chord(1, 1e-2)

    def apart(closing: bool) -> float:
        settings = replace(quick, closing=closing)
        found = fit(prepared, MODEL, near, settings)
        whole = Problem(prepared, MODEL, settings)
        spans = whole.spans(whole.arrow(found.fits, found.jacobian))
        own = whole.jacobian(found.fits, spans, np.ones((1, 2), dtype=bool))
        return float(np.linalg.norm(found.jacobian - own) / np.linalg.norm(own))

    assert apart(closing=False) > 5.0 * apart(closing=True)


@pytest.mark.parametrize(
    ("way", "wary", "tried", "used", "failed"),
    [(1, False, 1, 1e-4, False), (1, True, 1, 0.01, False), (-1, False, 3, 0, True), (-1, True, 2, 0, True)],
)  # fmt: skip
def test_the_first_step_of_a_chord_that_does_what_is_hoped_for_is_taken(
    film_set: RecordingSet,
    monkeypatch: pytest.MonkeyPatch,
    way: int,
    wary: bool,
    tried: int,
    used: float,
    failed: bool,
) -> None:
    """From the boldest on, or of a fit for which that led too far from the next one."""
    prepared = prepare(film_set, step=2 * MODEL.step, most_frames=60)
    near = np.array([[1.001 * RHO, MU]])
    known = fit(prepared, MODEL, near, replace(NOISE, most=1))
    whole = Problem(prepared, MODEL, NOISE.by_chord(1, 1e-9))
    fits = whole.at(near, known.fits.starts, known.fits.offsets)
    given: list[object] = []

    def counted(*args: object, **more: object) -> object:
        given.append(args)
        return predicted(*args, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(problem, "predicted", counted)
    arrow, every = whole.arrow(fits, way * known.jacobian), np.ones((1, 2), dtype=bool)
    found = _best_step(whole, fits, arrow, np.array([1e-3]), every, np.array([wary]))
    assert len(given) == tried
    assert bool(found[3][0]) == failed
    if not failed:
        assert found[1][0] == pytest.approx(used)
        assert found[0].chi2[0] < fits.chi2[0]


def test_the_information_is_the_curvature_of_the_profile(film_fit: Identification) -> None:
    """Profiles come from fits anew, the information from derivatives: two routes to one width."""
    fitted = film_fit.fitted
    assert fitted is not None
    assert film_fit.quality is not None
    sd = np.sqrt(np.diag(np.linalg.inv(fitted.information[0])))
    for k, profile in enumerate(film_fit.profiles):
        ends = np.tile(film_fit.best, (2, 1))
        ends[:, k] = profile.low, profile.high
        low, high = MODEL.coordinates(ends)[:, k]
        wide = 2 * 1.645 * sd[k] * np.sqrt(film_fit.quality.widening)
        np.testing.assert_allclose(high - low, wide, rtol=0.15)


def test_the_truth_lies_where_the_fit_says(film_fit: Identification) -> None:
    """The data are from the event-driven engine; 3 half widths are 5 standard deviations."""
    for profile, truth in zip(film_fit.profiles, (RHO, MU), strict=True):
        half = 0.5 * (profile.high - profile.low)
        assert abs(profile.value - truth) < 3.0 * half
        assert half < 0.02 * truth
    assert film_fit.quality is not None
    assert film_fit.quality.inflation == 1.0
    assert 0.9 < film_fit.quality.chi2 / film_fit.quality.freedom < 1.1


def test_noise_that_nobody_stated_is_estimated_along(film_set: RecordingSet) -> None:
    unknown = Sigmas(
        position=None, orientation=None, position_source="unknown", orientation_source="unknown"
    )
    prepared = replace(prepare(film_set, step=MODEL.step), sigmas=unknown)
    guess = Settings(position=5e-6, orientation=0.01)
    settings, _ = maximised(prepared, MODEL, np.array([[RHO, MU]]), guess)
    np.testing.assert_allclose(settings.position, SENSOR.position_sigma, rtol=0.04)
    np.testing.assert_allclose(settings.orientation, SENSOR.orientation_sigma, rtol=0.06)


def test_three_points_are_recovered_from_a_rough_guess() -> None:
    """Six pushes; the motion is from the stepper with finer steps than those that fit."""
    model = three_point(PART.outline)
    rng = np.random.default_rng(4)
    truth = np.array([0.5, 0.7, *FIRST_TABLE_POINTS.ravel()])
    points = ThreePoints(points=FIRST_TABLE_POINTS)
    prepared = prepare(
        recorded(random_pushes(rng, 6), points, 0.5, rng), step=model.step, most_frames=40
    )
    guess = truth + np.append([-0.05, 0.0], rng.normal(0.0, 5e-6, 6))
    found = fit(prepared, model, guess, NOISE)
    information = found.information[0][np.ix_(model.fitted, model.fitted)]
    away = model.coordinates(found.fits.values) - model.coordinates(truth[None])
    z2 = away[0, model.fitted] @ information @ away[0, model.fitted]
    assert z2 < chi2.ppf(0.999, 7)
    assert found.fits.values[0, 1] == truth[1]
