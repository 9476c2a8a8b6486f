"""What is stated of a rotation leaves room for another enclosure of the same slide."""

from __future__ import annotations

import json

import pytest

from meso_robust.pipeline import Planned
from meso_robust.planning.compose import compose
from meso_robust.task import parse_task
from tests.checker.test_check import checked
from tests.checker.test_walls import certificate_of
from tests.nightly import at_night, by_day
from tests.paper import paper_task


@pytest.mark.parametrize(
    ("friction", "percent"),
    by_day(1, [([0.33, 0.33], 1.0), ([0.32, 0.34], 5.0), ([0.30, 0.36], 1.0)]),
)
def test_a_plan_is_verified_however_closely_friction_and_film_are_known(
    friction: list[float], percent: float, paper_plan: Planned
) -> None:
    """Where little is uncertain, what two enclosures differ by is much of the box."""
    closer = paper_task(uncertainty__friction=friction, uncertainty__film_ratio_percent=percent)
    document = json.loads(certificate_of(closer, paper_plan.found.rules))
    assert document["verdict"] == "PROVED"
    assert checked(document, closer).verdict == "VERIFIED"


@pytest.mark.parametrize("radius_um", [[20.0, 20.0], pytest.param([20.0, 25.0], marks=at_night)])
def test_a_long_part_whose_friction_is_closely_known_is_verified(radius_um: list[float]) -> None:
    """Its rotation leaves it where the next push hardly begins to turn it."""
    values = {
        "schema": "meso-robust/task/2",
        "name": "long",
        "part": {"length_um": 3000.0, "width_um": 1000.0},
        "start": {"x_um": 5000.0, "y_um": -50.0, "theta_deg": 90.0},
        "goal": {
            "x_um": 0.0,
            "y_um": 0.0,
            "theta_deg": 0.0,
            "position_tolerance_um": 90.0,
            "orientation_tolerance_deg": 5.0,
        },
        "probe": {
            "speed_um_s": 75.0,
            "tip_spacing_um": 650.0,
            "tip_radius_um": radius_um,
            "headings": ["-x"],
        },
        "uncertainty": {
            "sensed_position_um": 2.0,
            "sensed_orientation_deg": 0.15,
            "probe_position_um": 2.0,
            "friction": [0.545, 0.555],
            "film_ratio_percent": 4.0,
            "tip_misalignment_deg": [-0.1, 0.1],
            "film_ratio_um2": 1e7 / 12,
        },
        "plan": {"least_y_translations": 0},
    }
    long = parse_task(values, "long part")
    document = json.loads(certificate_of(long, compose(long).rules))
    assert document["verdict"] == "PROVED"
    assert checked(document, long).verdict == "VERIFIED"
