"""Axes of a move, against the planner's own."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from flint import arb

from meso_robust.checker.inputs import PoseBox
from meso_robust.checker.scene import HEADINGS, Frame
from meso_robust.primitives import frame as planner


def point(x: float, y: float, theta: float) -> PoseBox:
    return PoseBox(x=(arb(x), arb(x)), y=(arb(y), arb(y)), theta=(arb(theta), arb(theta)))


@pytest.mark.parametrize(("heading", "mirrored"), list(itertools.product(HEADINGS, [False, True])))
def test_poses_are_turned_as_the_planner_turns_them(heading: str, mirrored: bool) -> None:
    pose = (1.0, 2.0, 0.3)
    there = planner.Frame(heading=heading, mirrored=mirrored)  # type: ignore[arg-type]
    here = Frame(HEADINGS.index(heading), mirrored)
    own = here.own(point(*pose))
    found = [float(side[0]) for side in (own.x, own.y, own.theta)]
    assert found == pytest.approx(list(there.sensed(np.array(pose))), abs=1e-12)
    back = here.world(own)
    assert [float(s[0]) for s in (back.x, back.y, back.theta)] == pytest.approx(pose, abs=1e-12)
