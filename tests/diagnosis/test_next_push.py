"""The next push: how pushes are laid out, what tells two models apart, and what does not."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from scipy.optimize import least_squares

from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.candidates import Candidate
from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.document import NextExperiment, Verdict
from meso_robust.diagnosis.next_push import Rival, arranged, best_push, next_experiment, rivals
from meso_robust.diagnosis.trials import Trial, tried
from meso_robust.identification.forward import predicted
from meso_robust.identification.models import Model, with_effects
from meso_robust.recordings.contact import gaps
from tests.diagnosis.conftest import regraded
from tests.identification.sets import PART, RADIUS

Floats = npt.NDArray[np.float64]
Given = Mapping[str, float]

PULL: Given = {"x_um_s": 2.0, "y_um_s": 1.0}


def extended(base: Baseline, effect: str, sizes: Given) -> tuple[Model, Floats]:
    """The plain model with an effect, and its values."""
    model = with_effects(base.model, {effect: dict.fromkeys(sizes, 1.0)})
    to_si = [one.to_si for one in model.parameters[len(base.model.parameters) :]]
    return model, np.append(base.fits.values[0], np.array(list(sizes.values())) * to_si)


def best(base: Baseline, first: tuple[str, Given], second: tuple[str, Given]) -> Rival | None:
    return best_push(
        base.prepared,
        (extended(base, *first), extended(base, *second)),
        base.noise.sigma,
        base.noise.correlation,
    )


def test_pushes_wait_touch_the_edge_where_they_say_push_and_draw_back(pulled: Baseline) -> None:
    pushes = rivals(pulled.prepared)
    assert {one.edge for one in pushes} == {0, 1, 2, 3}
    assert len({round(one.speed, 9) for one in pushes}) == 3
    setting = arranged(pulled.prepared, pushes)
    outline = PART.outline
    for k in range(0, len(pushes), 7):
        one, clock, way = pushes[k], setting.times[k], setting.waypoints[k, :, 0]
        legs = np.hypot(*np.diff(way, axis=0).T)
        assert legs[[0, 3]] == pytest.approx(0.0, abs=1e-15)
        ahead = (way[2] - way[1]) / legs[1]
        touch = way[1] + (legs[1] - one.travel) * ahead
        start = np.array([one.start])
        assert gaps(outline, start, touch[None, None], RADIUS)[0, 0] == pytest.approx(0.0, abs=1e-9)
        assert gaps(outline, start, way[None, :1], RADIUS)[0, 0] > 10e-6
        cos, sin = np.cos(one.start[2]), np.sin(one.start[2])
        own = np.array([[cos, sin], [-sin, cos]]) @ ahead
        side = outline[(one.edge + 1) % 4] - outline[one.edge]
        inward = np.array([-side[1], side[0]]) / np.hypot(*side)
        assert own @ inward == pytest.approx(np.cos(one.slant))
        assert inward[0] * own[1] - inward[1] * own[0] == pytest.approx(np.sin(one.slant))
        assert legs[1] / np.diff(clock)[1] == pytest.approx(one.speed)
        assert legs[2] / np.diff(clock)[2] == pytest.approx(one.speed)
        assert np.diff(clock)[[0, 3]] == pytest.approx(1.0)


def test_forces_and_flow_are_one_motion_on_every_push(pulled: Baseline) -> None:
    found = best(pulled, ("body_force", PULL), ("film_flow", PULL))
    assert found is not None
    assert found.sigma < 3.0


def test_a_difference_is_what_no_other_start_explains(pulled: Baseline) -> None:
    little: Given = {"x_um_s": 0.1, "y_um_s": 0.05}
    found = best(pulled, ("body_force", little), ("camera_drift", little))
    assert found is not None
    # the same push once more, its start now searched without derivatives at the first one
    setting = arranged(pulled.prepared, [found])
    sigma = pulled.noise.sigma
    target = predicted(setting, *extended(pulled, "camera_drift", little)).poses[0, 0]
    model, values = extended(pulled, "body_force", little)

    def apart(move: Floats) -> Floats:
        start = setting.starts + move * sigma
        return np.ravel(
            (predicted(setting, model, values, starts=start).poses[0, 0] - target) / sigma
        )

    left = least_squares(apart, np.zeros(3), diff_step=0.1, x_scale=1.0)
    assert found.sigma == pytest.approx(np.sqrt(2.0 * left.cost), rel=0.05)
    assert 3.0 < found.sigma < 0.98 * np.linalg.norm(apart(np.zeros(3)))


def test_coloured_noise_hides_more(pulled: Baseline) -> None:
    two = (extended(pulled, "body_force", PULL), extended(pulled, "camera_drift", PULL))
    white, coloured = (
        best_push(pulled.prepared, two, pulled.noise.sigma, phi) for phi in (0.0, 0.6)
    )
    assert white is not None
    assert coloured is not None
    # a slow difference in noise of colour φ counts as in (1 − φ) / (1 + φ) as many frames
    assert coloured.sigma == pytest.approx(white.sigma * np.sqrt(0.4 / 1.6), rel=0.25)


def test_a_late_camera_is_told_by_the_fastest_push(pulled: Baseline) -> None:
    late = best(pulled, ("camera_latency", {"time_ms": 30.0}), ("camera_latency", {"time_ms": 0.0}))
    assert late is not None
    fastest = max(one.speed for one in rivals(pulled.prepared))
    assert late.speed == pytest.approx(fastest)


def walled(base: Baseline, centre: Floats) -> tuple[Model, Floats]:
    place = {"x_um": 1e6 * centre[0], "y_um": 1e6 * centre[1], "radius_um": 50.0}
    model = with_effects(base.model, {"unmodelled_wall": {}}, fixed={"unmodelled_wall": place})
    return model, base.fits.values[0]


def test_starts_that_a_model_forbids_are_passed_over(pulled: Baseline) -> None:
    plain = (pulled.model, pulled.fits.values[0])
    sigma = pulled.noise.sigma
    starts = list(dict.fromkeys(one.start for one in rivals(pulled.prepared)))
    assert len(starts) == 3
    x, y, theta = starts[0]
    rim = 0.5 * PART.width * np.array([np.sin(theta), -np.cos(theta)])  # middle of the lower edge
    blocked = walled(pulled, np.array([x, y]) + rim)
    found = best_push(pulled.prepared, (plain, blocked), sigma, 0.0)
    assert found is None or found.start != starts[0]
    only = replace(pulled.prepared, starts=np.repeat(np.array([starts[0]]), 5, axis=0))
    assert best_push(only, (plain, blocked), sigma, 0.0) is None
    assert best_push(only, (plain, plain), sigma, 0.0) is not None
    refused = (pulled.model, -pulled.fits.values[0])  # values that the simulator does not take
    assert best_push(only, (plain, refused), sigma, 0.0) is None


def answers(found: Diagnosis, *sets: tuple[str, Given]) -> Diagnosis:
    """The diagnosis with these effects as its answers."""
    assert found.naming is not None
    assert found.best is not None
    given = []
    for effect, sizes in sets:
        model, values = extended(found.baseline, effect, sizes)
        refit = found.best.refit
        refit = replace(
            refit,
            trials=(Trial(effect=effect, sizes=dict.fromkeys(sizes, 1.0)),),
            model=model,
            fits=replace(refit.fits, values=values[None]),
        )
        given.append(Candidate(refit=refit, probability=1.0 / len(sets)))
    verdict: Verdict = "ambiguous" if len(given) > 1 else "named" if given else "unknown"
    return regraded(
        found,
        verdict=verdict,
        chosen=given[0] if given else None,
        rivals=tuple(given[1:]),
    )


def test_an_ambiguous_answer_asks_for_the_push_that_tells(late: Diagnosis) -> None:
    found = answers(late, ("body_force", PULL), ("camera_drift", PULL))
    section = NextExperiment.model_validate(next_experiment(found))
    assert "to tell body_force from camera_drift, which would differ by" in section.why
    push = section.push
    assert push.edge in range(4)
    assert push.place in (-0.6, 0.0, 0.6)
    assert push.slant_deg in (-15.0, 0.0, 15.0)
    assert push.speed_um_s is not None
    assert 10.0 < push.speed_um_s < 1000.0
    assert push.travel_um is not None
    assert 100.0 < push.travel_um < 1000.0
    assert next_experiment(found) == next_experiment(found)


def test_a_named_effect_is_confirmed_before_a_plan_is_made_with_it(late: Diagnosis) -> None:
    section = NextExperiment.model_validate(next_experiment(late))
    shown_by = tried("camera_latency").shown_by
    assert section.push.what == (
        f"{shown_by}, to confirm camera_latency; then plan with --model model.toml"
    )
    part = NextExperiment.model_validate(next_experiment(regraded(late, verdict="partial")))
    assert part.push.what == f"{shown_by}, to confirm camera_latency"


def test_answers_that_are_exactly_alike_are_said_to_be(late: Diagnosis) -> None:
    section = NextExperiment.model_validate(
        next_experiment(answers(late, ("body_force", PULL), ("film_flow", PULL)))
    )
    assert section.why.startswith("no push on this stage tells body_force from film_flow")
    assert section.push.what == tried("body_force").shown_by
    assert section.push.edge is None
