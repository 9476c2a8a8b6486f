"""What is stated of a rotation leaves room for another enclosure of the same slide."""

from __future__ import annotations

import json

import pytest

from meso_robust.pipeline import Planned
from tests.checker.test_check import checked
from tests.checker.test_walls import certificate_of
from tests.paper import paper_task


@pytest.mark.parametrize(
    ("friction", "percent"), [([0.33, 0.33], 1.0), ([0.32, 0.34], 5.0), ([0.30, 0.36], 1.0)]
)
def test_a_plan_is_verified_however_closely_friction_and_film_are_known(
    friction: list[float], percent: float, paper_plan: Planned
) -> None:
    """Where little is uncertain, what two enclosures differ by is much of the box."""
    closer = paper_task(uncertainty__friction=friction, uncertainty__film_ratio_percent=percent)
    document = json.loads(certificate_of(closer, paper_plan.found.rules))
    assert document["verdict"] == "PROVED"
    assert checked(document, closer).verdict == "VERIFIED"
