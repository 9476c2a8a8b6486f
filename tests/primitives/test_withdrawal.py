"""Tips back off without meeting the part."""

from __future__ import annotations

import math

import pytest

from meso_robust.bounds import Interval, Verdict
from meso_robust.primitives.names import Named, ObligationId, When, Which
from meso_robust.primitives.tips import comes_free
from tests.strategies import paper_chain

PASSES = Named(ObligationId.IDLE_TIP_PASSES, {"when": When.ON_WITHDRAWAL})


@pytest.mark.parametrize(
    ("low_deg", "high_deg", "free"),
    [(80.0, 100.0, True), (5.0, 175.0, True), (170.0, 181.0, False), (-1.0, 20.0, False)],
)
def test_a_tip_comes_free_if_its_edge_faces_the_way_back(
    low_deg: float, high_deg: float, free: bool
) -> None:
    angle = Interval(math.radians(low_deg), math.radians(high_deg))
    assert (comes_free(Which.PUSHING, angle).proof.verdict is Verdict.PROVED) is free


def test_every_move_proves_it() -> None:
    for step in paper_chain().steps:
        assert any(o.name.id is ObligationId.WITHDRAWS_FREE for o in step.obligations)
        idle = [o for o in step.obligations if o.name == PASSES]
        assert len(idle) == (0 if step.rule.action == "straighten" else 1)
