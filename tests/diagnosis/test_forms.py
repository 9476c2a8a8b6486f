"""A family is named whatever the form of its law, and the form is told only if the recordings tell it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest

from meso_robust.diagnosis.answer import document
from meso_robust.diagnosis.candidates import best_of_each
from meso_robust.diagnosis.diagnose import Diagnosis, diagnose
from meso_robust.diagnosis.refit import Refit
from meso_robust.diagnosis.trials import Trial, trials, trials_of
from meso_robust.simulator.catalogue import CATALOGUE
from tests.diagnosis.conftest import small_set

WALL = {"direction_deg": 0.0, "position_um": 900.0, "range_um": 300.0}


@pytest.fixture(scope="module")
def wall() -> Diagnosis:
    """Pushes near a wall that draws the part by a power of the gap, not exponentially."""
    given = {"wall_capillarity": {"pull_um_s": 15.0, **WALL, "form": 1.0}}
    return diagnose(small_set(given, 12), quick=True)


def test_a_law_that_falls_otherwise_is_named_by_its_family(wall: Diagnosis) -> None:
    found = document(wall, "1.2.3")
    assert found.verdict == "named"
    assert [one.name for one in found.effects] == ["wall_capillarity"]
    (effect,) = found.effects
    assert effect.form.endswith("falls as 1/(1 + gap/l)²")
    assert effect.parameters["form"].value == 1.0
    assert found.explained is not None
    assert found.explained.share > 0.95


@pytest.mark.parametrize("lead", [None, 2.0])
def test_a_form_that_another_equals_is_not_told(wall: Diagnosis, lead: float | None) -> None:
    best = wall.grade.chosen
    assert best is not None
    own = best.refit
    others = () if lead is None else (replace(own, others=(), gain=own.gain - lead),)
    chosen = replace(best, refit=replace(own, others=others))
    found = replace(wall, grade=replace(wall.grade, chosen=chosen))
    (effect,) = document(found, "1.2.3").effects
    assert effect.form.endswith("form not told by these recordings")


def test_the_lead_is_over_another_form_of_the_same_effects() -> None:
    def fit(effect: str, gain: float, **shape: float) -> Refit:
        trial = Trial(effect=effect, sizes={"pull_um_s": 1.0}, shape=shape)
        empty = np.zeros(0)
        return Refit(
            trials=(trial,),
            gain=gain,
            chi2=0.0,
            rows=empty,
            **dict.fromkeys(("model", "fits", "fitted", "tangent"), cast("Any", None)),
        )

    near = fit("wall_capillarity", 40.0, form=1.0, range_um=1.0)
    found = best_of_each(
        [
            fit("wall_capillarity", 31.0, form=0.0),
            near,
            fit("wall_capillarity", 39.0, form=1.0, range_um=2.0),
            fit("body_force", 12.0),
        ]
    )
    leads = {one.effects: (one.gain, one.lead) for one in found}
    assert leads == {("wall_capillarity",): (40.0, 9.0), ("body_force",): (12.0, None)}


@pytest.mark.parametrize(("behind", "has"), [(2.0, True), (4.0, False)])
def test_an_image_is_turned_about_a_place_unless_the_origin_is_much_likelier(
    behind: float, has: bool
) -> None:
    def fit(gain: float, **free: float) -> Refit:
        trial = Trial(effect="camera_scale", sizes={"percent": 0.3}, shape=free, free=free)
        empty = np.zeros(0)
        return Refit(
            trials=(trial,),
            gain=gain,
            chi2=0.0,
            rows=empty,
            **dict.fromkeys(("model", "fits", "fitted", "tangent"), cast("Any", None)),
        )

    place = fit(50.0 - behind, about_x_um=1.0, about_y_um=1.0)
    (found,) = best_of_each([fit(50.0), place])
    assert ("about_x_um" in found.trials[0].scales) == has
    (other,) = best_of_each([fit(50.0), fit(49.0, width_um=1.0)])
    assert other.gain == 50.0


def test_every_form_of_a_law_is_tried(wall: Diagnosis) -> None:
    tried = {(one.effect, one.law) for one in trials(wall.baseline.prepared)}
    for name, effect in CATALOGUE.items():
        for law in range(len(effect.forms)):
            # one tip of two is no other law where all pushes are made with one
            of_two = (
                law > 0 and name in ("tip_radius", "leadscrew_error")
            ) or name == "tip_latency"
            assert ((name, float(law)) in tried) != of_two


def test_each_tip_may_be_worn_by_itself_where_there_are_two(wall: Diagnosis) -> None:
    prepared = wall.baseline.prepared
    way = prepared.waypoints
    assert way.shape[2] == 1
    two = replace(prepared, waypoints=np.concatenate([way, way + 1e-3], axis=2))
    assert [one.law for one in trials_of("tip_radius", two)] == [0.0, 1.0, 2.0]
    assert [one.law for one in trials_of("tip_radius", prepared)] == [0.0]
