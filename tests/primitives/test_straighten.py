"""Which tip touches first in a straightening."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meso_robust.bounds import HALF_PI, Interval, Verdict
from meso_robust.planning.x_translation import FAR_UM, rule_at
from meso_robust.primitives.move import from_part
from meso_robust.primitives.setup import setup_of
from meso_robust.primitives.straighten import (
    _first_contacts,
    certify_straighten,
    is_proved,
    refuted,
)
from meso_robust.task import Task

ALIGNED = Interval(1.56, 1.58)


@pytest.mark.parametrize("start", [(1.4, 1.5), (1.6, 1.7), (1.4, 1.7), (1.57, 1.7), (1.4, 1.57)])
def test_each_start_is_in_the_case_of_each_tip_that_can_touch_first(
    start: tuple[float, float],
) -> None:
    """Below the direction in which the pair is aligned the upper tip, above it the lower one."""
    cases = _first_contacts(Interval(*start), ALIGNED)

    for share in range(11):
        angle = start[0] + share / 10 * (start[1] - start[0])
        sides = {side for side, angles in cases if angle in angles}
        assert sides >= ({1} if angle < ALIGNED.hi else set())
        assert sides >= ({-1} if angle > ALIGNED.lo else set())


MICROSCOPE = Path(__file__).parents[2] / "meso_robust" / "tasks" / "microscope.toml"


@pytest.mark.parametrize("lean_deg", [2.0, -9.0])
def test_pushes_refuted_together_are_those_that_are_not_proved_one_by_one(lean_deg: float) -> None:
    setup = setup_of(Task.load(MICROSCOPE))
    lean = Interval.point(math.radians(lean_deg)) + Interval(-0.004, 0.004)
    pre = replace(setup.start, theta=HALF_PI + lean)
    half = setup.edge(pre.theta.mid).last.mid
    middles = np.linspace(-0.9 * half, 0.9 * half, 19)
    rules = [
        rule_at(middle, pre, setup, from_part(FAR_UM), step=3, primitive="x_translation")
        for middle in (0.0, *middles)
    ]
    proved = [
        certify_straighten(rule, pre, setup, whole=False, slipping=False).verdict is Verdict.PROVED
        for rule in rules[1:]
    ]

    together = refuted(rules[0], pre, setup, middles)

    assert together.tolist() == [not one for one in proved]
    assert [is_proved(rule, pre, setup) for rule in rules[1:]] == proved
    assert 0 < sum(proved) < len(proved)


def test_without_an_error_of_the_probe_nothing_is_refuted_together() -> None:
    setup = setup_of(Task.load(MICROSCOPE))
    exact = replace(
        setup, uncertainty=replace(setup.uncertainty, probe_position=Interval.point(0.0))
    )
    rule = rule_at(0.0, setup.start, exact, from_part(FAR_UM), step=3, primitive="x_translation")
    assert not refuted(rule, setup.start, exact, np.array([0.0, 1.0])).any()
