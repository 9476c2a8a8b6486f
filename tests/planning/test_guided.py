"""Plans whose last push is guided by the slot's walls."""

from __future__ import annotations

from dataclasses import replace

from meso_robust.bounds import Verdict
from meso_robust.certificates.chain import certify
from meso_robust.planning.compose import compose
from meso_robust.planning.guided import guided
from meso_robust.primitives.names import ObligationId
from meso_robust.primitives.setup import setup_of
from tests.guided import guided_rules, guided_task


def test_a_push_that_meets_the_walls_is_cut_in_two() -> None:
    setup, rules = setup_of(guided_task()), guided_rules()
    assert [rule.action for rule in rules] == ["straighten", "guide"]
    chain = certify(rules, setup)
    assert chain.verdict is Verdict.PROVED
    assert chain.guided
    assert certify(rules, setup_of(guided_task(), 1.1)).verdict is Verdict.PROVED
    # in one push it is not clear of the walls, and nothing else is open
    whole = replace(rules[0], dual_end=rules[1].dual_end)
    found = certify((whole,), setup).open_obligation
    assert found is not None
    assert found[1].name.id is ObligationId.PART_CLEAR_OF_WALLS
    cut = guided((whole,), setup)
    assert cut is not None
    assert certify(cut, setup).verdict is Verdict.PROVED


def test_a_plan_that_is_clear_of_the_walls_is_preferred() -> None:
    rules = compose(guided_task(uncertainty__travel_direction_deg=[-1.0, 1.0])).rules
    assert {rule.action for rule in rules} == {"straighten"}


def test_no_push_is_guided_that_does_not_enter_the_slot() -> None:
    setup, (first, last) = (
        setup_of(guided_task(slot__opens="-x", slot__mouth_x_um=-4000.0)),
        guided_rules(),
    )
    whole = replace(first, dual_end=last.dual_end)
    assert certify((whole,), setup).verdict is Verdict.PROVED
    assert guided((whole,), setup) is None
