"""Tips that travel beside the part."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.bounds import Verdict
from meso_robust.laboratory.replay import Feedback
from meso_robust.primitives.certify import certify_move
from meso_robust.primitives.frame import Frame
from meso_robust.primitives.move import MoveRule, Point, from_part
from tests.strategies import paper_chain


def rule(x_um: float, y_um: float, end_um: float, frame: Frame | None = None) -> MoveRule:
    return MoveRule(
        step=1,
        primitive="regrasp",
        action="regrasp",
        side=0,
        dual=Point(x=from_part(x_um), y=from_part(y_um)),
        dual_end=from_part(end_um),
        frame=frame or Frame(),
    )


CLEAR = {  # the part stands upright: 837 um wide in x, 1616 um high in y; tips 290 um up and down
    "backs off from the edge": rule(440.0, 0.0, 2000.0),
    "stays in front": rule(600.0, 0.0, 440.0),
    "passes above": rule(900.0, 1130.0, -900.0),
    "passes below": rule(900.0, -1130.0, -900.0),
    "passes on the far side": rule(-440.0, 0.0, -900.0),
    "goes up along the edge": rule(-2000.0, 740.0, 2000.0, Frame(heading="+y")),
}
HIT = {
    "pushes": rule(440.0, 0.0, 400.0),
    "passes too low": rule(900.0, 1090.0, -900.0),
    "goes up too close": rule(-2000.0, 700.0, 2000.0, Frame(heading="+y")),
}


@pytest.mark.parametrize("name", CLEAR)
def test_a_way_beside_the_part_leaves_it_at_rest(name: str) -> None:
    setup = paper_chain().setup
    step = certify_move(CLEAR[name], setup.start, setup)
    assert step.verdict is Verdict.PROVED
    assert step.post is not None
    assert setup.start.within(step.post)
    assert step.post.theta.width < setup.start.theta.width + 1e-14

    player = Feedback(rules=(CLEAR[name],), setup=setup)
    runs = player.run(player.draw(20, np.random.default_rng(0)))
    assert runs.completed.all()
    np.testing.assert_array_equal(runs.moves[0].before, runs.moves[0].after)


@pytest.mark.parametrize("name", HIT)
def test_a_way_that_may_touch_is_not_proved(name: str) -> None:
    setup = paper_chain().setup
    assert certify_move(HIT[name], setup.start, setup).verdict is Verdict.UNKNOWN


def test_a_passive_tip_has_no_place_in_it() -> None:
    setup = paper_chain().setup
    tip = Point(x=from_part(0.0), y=from_part(0.0))
    with pytest.raises(ValueError, match="passive tip belongs"):
        certify_move(replace(CLEAR["stays in front"], single=tip), setup.start, setup)
