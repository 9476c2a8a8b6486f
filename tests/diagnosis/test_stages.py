"""Stages: what differs from push to push is put where it arises, also beside an effect that is known."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import multivariate_normal

from meso_robust.diagnosis.noise import noise_of
from meso_robust.diagnosis.stages import _gain, stages
from meso_robust.identification.models import Model, viscous, with_effects
from meso_robust.identification.prepared import prepare
from meso_robust.recordings import RecordingSet
from meso_robust.types import Floats
from tests.diagnosis.designs import SIGMA, VALUES, Given, Plan, random_plans, recorded_plans
from tests.identification.sets import PART, UM

MODEL = viscous(PART.outline)


def varied(*each: Given) -> RecordingSet:
    """A recording for every effect."""
    plans = random_plans(np.random.default_rng(3), len(each))
    sets = [
        recorded_plans([plan], np.random.default_rng(k), of)
        for k, (plan, of) in enumerate(zip(plans, each, strict=True))
    ]
    rows = [replace(of.recordings[0], file=f"{k}.csv") for k, of in enumerate(sets)]
    return replace(sets[0], recordings=tuple(rows))


def told(recordings: RecordingSet, model: Model = MODEL, values: Floats = VALUES) -> str:
    noise = replace(noise_of(recordings), sigma=SIGMA, correlation=0.0)
    found = stages(recordings, prepare(recordings, step=model.step), model, values, noise)
    return max(found, key=lambda channel: found[channel])


@pytest.mark.parametrize(
    ("stage", "effect", "sizes"),
    [
        ("actuation", "probe_drift", {"x_um_s": 1.0, "y_um_s": 0.7}),
        ("observation", "camera_drift", {"x_um_s": 1.0, "y_um_s": 0.7}),
        ("environment", "body_force", {"x_um_s": 3.0}),
    ],
)
def test_what_differs_between_pushes_is_at_its_stage(
    stage: str, effect: str, sizes: dict[str, float]
) -> None:
    """A tip that is off and an image that is off differ in what the part turns, and in no place."""
    signs = (1.0, -1.0, 1.0, -1.0)
    each = [{effect: {key: sign * size for key, size in sizes.items()}} for sign in signs]
    assert told(varied(*each)) == stage


@dataclass(frozen=True, slots=True)
class Circling(Plan):
    """A push whose tip goes round in a circle while it travels."""

    radius: float = 30 * UM

    @property
    def corners(self) -> tuple[Floats, Floats]:
        """Times (N,) and places (N, 2) of the tip's path."""
        clock, way = super(Circling, self).corners
        times = np.linspace(0.0, clock[-1], 400)
        tip = np.stack([np.interp(times, clock, column) for column in way.T], axis=1)
        turn = 2.0 * np.pi * 0.8 * times
        return times, tip + self.radius * np.column_stack([np.cos(turn) - 1.0, np.sin(turn)])


def test_a_tip_that_goes_round_is_no_matter_of_the_image() -> None:
    """It leaves the part and comes back, by more than a straight line tells, and its log shows no circle."""
    plans = random_plans(np.random.default_rng(3), 8, (75 * UM,))
    circles = [Circling(**asdict(plan)) for plan in plans]
    no_effect = {"camera_latency": {"time_ms": 0.0}}  # by the stepper, which takes paths that bend
    shown = recorded_plans(circles, np.random.default_rng(5), no_effect)
    stated = recorded_plans(plans, np.random.default_rng(5))
    rows = [
        replace(of, probes=straight.probes)
        for of, straight in zip(shown.recordings, stated.recordings, strict=True)
    ]
    assert told(replace(shown, recordings=tuple(rows))) == "actuation"


def test_friction_of_the_tip_is_no_matter_of_the_support() -> None:
    each = [
        {"edge_dependent_friction": {"change": -0.7, "edge": edge}} for edge in (1.0, 2.0, 3.0, 0.0)
    ]
    assert told(varied(*each)) == "contact"


def test_what_an_effect_leaves_may_be_at_its_own_stage() -> None:
    """A force that differs, beside a model that has one which does not."""
    pulls = [{"body_force": {"x_um_s": 5.0 + sign}} for sign in (3.0, -3.0, 3.0, -3.0)]
    model = with_effects(MODEL, {"body_force": {"x_um_s": 1.0, "y_um_s": 1.0}})
    assert told(varied(*pulls), model, np.array([*VALUES, 5.0 * UM, 0.0])) == "environment"


def test_a_width_makes_the_data_likeliest() -> None:
    """By the density of the data itself, with widths from another search."""
    rng = np.random.default_rng(5)
    group = np.array([0, 0, 1])
    columns = rng.standard_normal((20, 9, 3))
    inputs = rng.standard_normal((20, 3)) * [2.0, 2.0, 0.3]
    data = np.einsum("wmk,wk->wm", columns, inputs) + rng.standard_normal((20, 9))

    def cost(logs: Floats) -> float:
        width = np.exp(logs)[group]
        each = zip(columns * width, data, strict=True)
        return -sum(multivariate_normal(cov=np.eye(9) + own @ own.T).logpdf(of) for own, of in each)

    plain = sum(multivariate_normal(cov=np.eye(9)).logpdf(of) for of in data)
    best = -minimize(cost, [0.0, 0.0], method="Nelder-Mead").fun - plain
    normal, slope = (
        np.einsum("wmk,wml->wkl", columns, columns),
        np.einsum("wmk,wm->wk", columns, data),
    )
    assert _gain(normal, slope, group) == pytest.approx(best, abs=0.1)
    # of inputs that move nothing the width goes to nought, and the gain with it
    still = rng.standard_normal((20, 9))
    slope = np.einsum("wmk,wm->wk", columns, still)
    assert 0.0 <= _gain(normal, slope, group) < 3.0
