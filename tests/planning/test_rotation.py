"""Which rotation is chosen: how close the pair, and how long the push."""

from __future__ import annotations

from dataclasses import dataclass, replace

import pytest

from meso_robust.bounds import Verdict
from meso_robust.planning import rotation
from meso_robust.planning.rotation import CLOSER_UM, EASED_UM, _eased, _farthest, rotate_and_insert
from meso_robust.planning.x_translation import to_goal
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.setup import PoseBox, Setup, setup_of
from tests.paper import paper_task


@pytest.fixture(scope="module")
def found() -> tuple[Setup, tuple[Step, Step]]:
    """The task, with a rotation and the push after it."""
    setup = setup_of(paper_task())
    first = setup.start
    near = replace(first, y=setup.goal.y)
    both = rotate_and_insert(near, setup)
    assert both is not None
    return setup, both


def shorter(before: Step, after: Step) -> float:
    return after.rule.dual_end.offset_um - before.rule.dual_end.offset_um


def test_a_push_is_as_short_as_will_do(found: tuple[Setup, tuple[Step, Step]]) -> None:
    setup, both = found
    eased = _eased(both, setup, lambda state: to_goal(state, setup))
    assert shorter(both[0], eased[0]) == pytest.approx(EASED_UM[0])
    assert eased[0].verdict is Verdict.PROVED
    assert eased[1].post is not None
    assert eased[1].post.within(setup.goal)


def test_a_push_stays_as_long_as_what_follows_needs(
    found: tuple[Setup, tuple[Step, Step]],
) -> None:
    """Ends beyond the goal, or none at all, will not do."""
    setup, both = found
    assert _eased(both, setup, lambda state: None) is both
    outside = replace(both[1], post=setup.start)
    assert _eased(both, setup, lambda state: outside) is both


@dataclass(frozen=True)
class _Ends:
    h: float


def test_the_closest_pair_is_taken_and_of_those_the_longest_push(
    found: tuple[Setup, tuple[Step, Step]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The active tip stays where it is as the passive one comes closer."""
    setup, both = found
    pre, tried = both[0].pre, []

    def reach(rule: MoveRule, pre: PoseBox, setup: Setup, coarser: float) -> _Ends | None:
        tried.append(rule)
        apart = rule.dual.y.offset_um - rule.single.y.offset_um if rule.single else 0.0
        least = 1000.0 - CLOSER_UM[1] + 0.5e6 * setup.spacing.mid
        # not where tips are closest; and the farther the higher
        return None if apart < least - 0.1 else _Ends(-1e-6 * rule.dual.y.offset_um)

    monkeypatch.setattr(rotation, "reach", reach)
    choice = _farthest(1000.0, pre, setup)
    assert choice is not None
    assert choice.separation == 1000.0 - CLOSER_UM[1]
    assert -choice.h_end == max(rule.dual.y.offset_um for rule in tried)
    heights = {round(rule.dual.y.offset_um, 1) for rule in tried}
    assert len(heights) * 2 == len(tried)  # and none that are farther apart
