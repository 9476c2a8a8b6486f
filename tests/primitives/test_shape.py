"""Rules of which the proof would not look at everything, and memories that do not fit."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from meso_robust.certificates.chain import certify
from meso_robust.laboratory.replay import Feedback
from meso_robust.primitives.certify import certify_move
from meso_robust.primitives.move import MoveRule, Point, from_part, in_world
from meso_robust.primitives.names import ObligationId
from meso_robust.primitives.setup import setup_of
from tests.conftest import paper_task
from tests.strategies import paper_chain

TILT, STRAIGHTEN, ROTATE, INSERT = (step.rule for step in paper_chain().steps)
TIP = Point(x=from_part(-900.0), y=from_part(100.0))


@pytest.mark.parametrize(
    ("rule", "words"),
    [
        (replace(TILT, side=2), "tilt needs side"),
        (replace(TILT, side=0), "tilt needs side"),
        (replace(STRAIGHTEN, side=1), "straighten needs side"),
        (replace(ROTATE, side=-1), "rotate needs side"),
        (replace(INSERT, single=TIP), "passive tip belongs to a rotation"),
        (replace(TILT, single=TIP), "passive tip belongs to a rotation"),
        (replace(ROTATE, single=None), "passive tip belongs to a rotation"),
    ],
)
def test_what_a_primitive_is_not_made_for_is_refused(rule: MoveRule, words: str) -> None:
    setup = paper_chain().setup
    with pytest.raises(ValueError, match=words):
        certify_move(rule, setup.start, setup)


def test_a_straightening_of_another_edge_than_the_tilts_forgets_the_tilt() -> None:
    """A nearly square part that grips: the tilt takes it across 45 deg, so the next edge is pushed."""
    task = paper_task(
        part__length_um=877.6, part__width_um=851.4, probe__tip_spacing_um=635.0,
        uncertainty__sensed_position_um=1.0, uncertainty__sensed_orientation_deg=0.05,
        uncertainty__probe_position_um=1.0, uncertainty__friction=[1.41, 1.43],
        uncertainty__film_ratio_um2=149109.0, uncertainty__film_ratio_percent=1.0,
        uncertainty__tip_misalignment_deg=[-0.05, 0.05],
        start__x_um=0.0, start__y_um=0.0, start__theta_deg=46.30658,
        goal__x_um=-1244.0, goal__y_um=-113.0, goal__theta_deg=0.0,
        goal__position_tolerance_um=50.0,
    )  # fmt: skip
    tilt = replace(
        TILT,
        side=-1,
        dual=Point(x=from_part(291.4), y=from_part(-649.7)),
        dual_end=from_part(16.1),
    )
    straighten = replace(
        STRAIGHTEN,
        dual=Point(x=from_part(1338.8), y=from_part(187.4)),
        dual_end=from_part(-652.1),
    )
    setup = setup_of(task)

    chain = certify((tilt, straighten), setup)

    runs = Feedback(rules=(tilt, straighten), setup=setup, engine="events").run(
        Feedback(rules=(tilt, straighten), setup=setup).draw(20, np.random.default_rng(0))
    )
    assert runs.completed.all()
    assert math.degrees(runs.moves[0].after[:, 2].max()) < 45.0 < 46.2
    assert chain.end is not None
    assert (runs.final[:, 1] >= chain.end.y.lo).all()
    assert (runs.final[:, 1] <= chain.end.y.hi).all()


def test_an_active_tip_below_the_passive_one_is_no_rotation() -> None:
    """The conditions hold the separation squared; its sign is asked for first."""
    assert ROTATE.single is not None
    below = replace(ROTATE, dual=replace(ROTATE.dual, y=in_world(-925.0)))
    step = certify_move(below, paper_chain().steps[2].pre, paper_chain().setup)
    assert step.post is None
    assert step.obligations[-1].name.id is ObligationId.ACTIVE_ABOVE_PASSIVE
