"""Where a push starts, ahead of all poses that the part may have."""

from __future__ import annotations

import math

from meso_robust.bounds import Interval
from meso_robust.planning.clearance import FARTHEST_UM, rise_of, start_ahead_um
from meso_robust.planning.x_translation import upright
from meso_robust.primitives.setup import PoseBox, setup_of
from tests.paper import paper_task


def leaning(by_rad: float) -> PoseBox:
    here = Interval(-1e-6, 1e-6)
    return PoseBox(x=here, y=here, theta=Interval(math.pi - by_rad, math.pi + by_rad))


def test_of_poses_of_any_orientation_no_push_is_proved_and_none_fails() -> None:
    setup = setup_of(paper_task())
    rises = tuple((side, rise_of(Interval.point(0.0), side, setup)) for side in (1, -1))
    upright_um, leaning_um = (
        start_ahead_um(rises, leaning(by), setup) for by in (0.0, math.radians(8.0))
    )
    assert 808.0 < upright_um < leaning_um < 1000.0  # half the part's length, and its corner's way
    assert start_ahead_um(rises, leaning(2.0), setup) > FARTHEST_UM
    assert upright(leaning(2.0), setup, step=3, primitive="y_translation") is None
