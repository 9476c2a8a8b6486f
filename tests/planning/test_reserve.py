"""What is left of a travel is read off the obligation by its name."""

from __future__ import annotations

from dataclasses import replace

import pytest

from meso_robust.planning.x_translation import reserve
from meso_robust.primitives.names import ObligationId
from tests.strategies import paper_chain

STRAIGHTEN = paper_chain().steps[1]
TOUCHES = next(
    one for one in STRAIGHTEN.obligations if one.name.id is ObligationId.SECOND_TIP_TOUCHES
)


def test_the_reserve_is_the_bound_of_the_travel_to_spare() -> None:
    assert reserve(STRAIGHTEN) == TOUCHES.proof.lower > 0.0


def test_the_case_that_leaves_least_counts() -> None:
    less = replace(TOUCHES, proof=replace(TOUCHES.proof, lower=0.5 * TOUCHES.proof.lower))
    both = replace(STRAIGHTEN, obligations=(*STRAIGHTEN.obligations, less))
    assert reserve(both) == 0.5 * TOUCHES.proof.lower


def test_a_step_without_it_is_a_fault_and_no_plan_without_reserve() -> None:
    """Silence here once turned the planner off: minus infinity is a number that is never best."""
    rest = tuple(one for one in STRAIGHTEN.obligations if one is not TOUCHES)
    with pytest.raises(ValueError, match=r"empty"):
        reserve(replace(STRAIGHTEN, obligations=rest))
