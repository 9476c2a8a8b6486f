"""Forms of a law: each is the same near its scale and another one away from it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from meso_robust.simulator import Effects, Film, Outcome, Push, Round, simulate
from meso_robust.simulator.catalogue import CATALOGUE
from tests.simulator.problems import RHO, UM, rectangle
from tests.simulator.test_effects import ON, lifted
from tests.simulator.test_residual import end

WITH_FORMS = [name for name, effect in CATALOGUE.items() if effect.forms]


def test_every_form_has_words_and_a_number() -> None:
    assert len(WITH_FORMS) >= 6
    for name in WITH_FORMS:
        forms, number = CATALOGUE[name].forms, CATALOGUE[name].parameters[-1]
        assert (number.key, number.low, number.high) == ("form", 0.0, len(forms) - 1.0)
        assert all(words in number.meaning for words in forms)
        with pytest.raises(ValueError, match=rf"{name}.form: {len(forms)}.0; must be"):
            Effects({name: {**ON[name], "form": float(len(forms))}})


@pytest.mark.parametrize("name", WITH_FORMS)
def test_another_form_is_another_motion_and_no_size_is_none(name: str) -> None:
    plain = simulate(lifted({name: ON[name]})).poses
    np.testing.assert_array_equal(simulate(lifted({name: {**ON[name], "form": 0.0}})).poses, plain)
    other = simulate(lifted({name: {**ON[name], "form": 1.0}}))
    assert (other.outcomes == Outcome.COMPLETED).all()
    assert np.abs((other.poses - plain) * [1, 1, 1e-3]).max() > 1e-9


def test_a_wall_by_a_power_pulls_as_stated() -> None:
    """x' = p / (1 + (s − x)/l)²: with z = 1 + (s − x)/l, z³ falls by 3 p t / l."""
    pull, place, reach = 8.0, 400.0, 150.0
    given = {"pull_um_s": pull, "direction_deg": 0.0, "position_um": place, "range_um": reach}
    x, _, _ = end({"wall_capillarity": {**given, "form": 1.0}})
    z = np.cbrt((1.0 + place / reach) ** 3 - 3.0 * pull * 4.0 / reach)
    assert x == pytest.approx(place - reach * (z - 1.0), rel=1e-3)


def dragged(values: dict[str, Any], force: float) -> float:
    """Speed in µm/s at which a force, over the film's drag, moves a free part."""
    return end({"body_force": {"x_um_s": force}, **values})[0] / 4.0


def test_friction_of_slow_sliding_falls_by_the_first_or_second_power() -> None:
    ratio, scale, force = 0.2, 60.0, 80.0  # of the film's drag at 75 µm/s: 15 µm/s
    for form, power in ((0.0, 2), (1.0, 1)):
        v = dragged(
            {"stribeck_friction": {"ratio": ratio, "speed_um_s": scale, "form": form}}, force
        )
        assert force - v == pytest.approx(15.0 * np.exp(-((v / scale) ** power)), rel=1e-3)


def test_drag_by_place_grows_along_a_line() -> None:
    """x' = f / k(x) of a point-like support: the mean of k over the part is k at its centre."""
    f, slope = 50.0, 1.0
    x = end({"body_force": {"x_um_s": f}, "drag_gradient": {"x_per_mm": slope, "form": 1.0}})[0]
    # x + g x² / 2 = f t; a line has no curvature over the area
    exact = (np.sqrt(1.0 + 2.0 * 1e-3 * slope * f * 4.0) - 1.0) / (1e-3 * slope)
    assert x == pytest.approx(exact, rel=2e-3)


@pytest.mark.parametrize("form", [0.0, 1.0])
def test_a_tip_draws_the_part_by_its_form(form: float) -> None:
    """Attraction at a gap g: F/(1 + g/r), or F/2^(g/r)."""
    gap, reach, pull = 20.0, 10.0, 3.0
    tip = np.array([[[[-808.0 - 15.0 - gap, 0.0]], [[-808.0 - 15.0 - gap, 0.0]]]]) * UM
    push = Push(
        vertices=rectangle(),
        poses=np.zeros((1, 3)),
        waypoints=tip,
        times=np.array([[0.0, 0.01]]),
        friction=np.array([[0.3]]),
        support=Film.ratio(RHO),
        shapes=(Round(15 * UM),),
        effects=Effects({"tip_attraction": {"pull_um_s": pull, "range_um": reach, "form": form}}),
        step=1 * UM,
        time_step=1e-3,
    )
    moved = -simulate(push).poses[0, 0] / UM / 0.01
    far = 1.0 / (1.0 + gap / reach) if form == 0.0 else 0.5 ** (gap / reach)
    assert moved == pytest.approx(pull * far, rel=0.01)
