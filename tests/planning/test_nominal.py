"""What is left out of a search before anything is certified."""

from __future__ import annotations

import math

import pytest

from meso_robust.planning.nominal import may_stick, sticks
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.task import Task

UPRIGHT = 0.5 * math.pi
DEPTH, RATIO = 418.5e-6, 376900e-12


def setup(**uncertainty: object) -> Setup:
    values = Task.paper().to_dict()
    values["schema"] = "meso-robust/task/2"
    values["probe"]["tip_radius_um"] = [2.5, 2.5]
    values["uncertainty"] |= {"film_ratio_percent": 0.0, **uncertainty}
    return setup_of(Task.from_dict(values))


@pytest.mark.parametrize(
    ("least", "centre_um"), [(0.1, 0.0), (0.3, 0.0), (0.3, 40.0)], ids=["slips", "sticks", "aside"]
)
def test_a_contact_sticks_at_the_worst_corner(least: float, centre_um: float) -> None:
    """On an upright edge: |lambda_t|/lambda_n = d1 d2/(rho + d1^2), by hand; 3 % of rho are left."""
    task = setup(friction=[least, 0.9], drag_centre_um=centre_um)
    off = 1e-6 * centre_um

    def ends(d1: float) -> float:
        return least * (RATIO + d1**2) / d1 + 0.03 * RATIO / d1 - off

    end = min(ends(DEPTH + off), ends(DEPTH - off))
    for inside in (0.99, -0.99):
        assert may_stick((UPRIGHT,), inside * end, DEPTH, task)
        assert not may_stick((UPRIGHT,), 1.02 * end * inside / 0.99, DEPTH, task)
    assert sticks(UPRIGHT, UPRIGHT, 1.02 * end, DEPTH, task)  # with the friction in the middle
