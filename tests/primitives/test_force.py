"""The cap on contact forces, by hand."""

from __future__ import annotations

import math

import pytest

from meso_robust.bounds import Verdict
from meso_robust.primitives.force import force_below_cap, squeeze_below_cap
from meso_robust.primitives.move import MoveRule, Point, from_part
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.task import Task

BOUND = 0.2 * 75e-6 * (1 + math.hypot(0.025, 0.025)) * 1.005 * math.hypot(1, 0.02) * 1.02
"""N: drag, speed, the larger principal drag, a travel that is too long, a path that strays, across and along."""


def setup(cap_un: float | None) -> Setup:
    values = Task.paper().to_dict()
    values["schema"] = "meso-robust/task/2"
    values["probe"] |= {"tip_radius_um": [2.5, 12.5]}
    values["uncertainty"] |= {
        "drag_anisotropy_percent": 5.0,
        "travel_scale_percent": 0.5,
        "probe_wander_um": 2.0,
    }
    if cap_un is not None:
        values["probe"]["max_force_un"] = cap_un
        values["film"] = {"drag_un_s_per_um": 0.2}
    return setup_of(Task.from_dict(values))


def rule(action: str) -> MoveRule:
    here = from_part(0.0)
    return MoveRule(
        step=1, primitive="t", action=action, side=1, dual=Point(x=here, y=here), dual_end=here  # type: ignore[arg-type]
    )  # fmt: skip


@pytest.mark.parametrize(("action", "times"), [("tilt", 1.0), ("straighten", math.hypot(1, 0.36))])
def test_the_bound_is_that_by_hand_and_no_larger_cap_is_needed(action: str, times: float) -> None:
    bound = BOUND * times * 1e6  # in uN, with drag in uN s/um
    for cap, verdict in ((1.001 * bound, Verdict.PROVED), (0.999 * bound, Verdict.UNKNOWN)):
        (found,) = force_below_cap(rule(action), setup(cap))
        assert found.proof.verdict is verdict
        assert found.proof.box["force"].hi == pytest.approx(bound * 1e-6)


def test_two_tips_that_squeeze_a_part_are_capped_with_friction_and_travel_in_it() -> None:
    bound = 3.0 * 0.2 * 75e-6 * 1.005 * 1.02 * math.hypot(1, 0.36)
    for cap, verdict in ((1.003 * bound, Verdict.PROVED), (0.999 * bound, Verdict.UNKNOWN)):
        (found,) = squeeze_below_cap(3.0, setup(cap * 1e6))
        assert found.proof.verdict is verdict
        assert bound < found.proof.box["force"].hi < 1.003 * bound


def test_without_a_cap_or_contact_nothing_is_asked() -> None:
    assert not squeeze_below_cap(3.0, setup(None))
    assert not force_below_cap(rule("regrasp"), setup(20.0))
    assert not force_below_cap(rule("tilt"), setup(None))
