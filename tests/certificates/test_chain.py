"""What a chain of proved moves proves together."""

from __future__ import annotations

from meso_robust.bounds import Verdict
from meso_robust.certificates.chain import certify
from meso_robust.primitives.names import Reason
from meso_robust.primitives.setup import setup_of
from tests.conftest import paper_task
from tests.strategies import paper_chain


def test_proved_moves_that_may_end_outside_the_goal_prove_nothing() -> None:
    """The shipped plan leaves the part within some 40 µm of the goal's middle."""
    rules = [step.rule for step in paper_chain().steps]

    narrow = certify(rules, setup_of(paper_task(goal__position_tolerance_um=20.0)))

    assert all(step.verdict is Verdict.PROVED for step in narrow.steps)
    assert narrow.complete
    assert narrow.verdict is Verdict.UNKNOWN
    assert narrow.first_open[1].id is Reason.ENDS_IN_GOAL
    assert paper_chain().verdict is Verdict.PROVED


def test_a_plan_with_a_move_left_out_or_not_reached_proves_nothing() -> None:
    steps = paper_chain().steps
    rules = [step.rule for step in steps]

    assert certify(rules[:-1], paper_chain().setup).verdict is Verdict.UNKNOWN
    assert certify([], paper_chain().setup).verdict is Verdict.UNKNOWN
    backwards = certify([rules[1], rules[0], rules[2]], paper_chain().setup)
    assert not backwards.complete
    assert backwards.verdict is Verdict.UNKNOWN
