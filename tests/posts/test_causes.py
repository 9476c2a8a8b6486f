"""What is left out of a rotation, one uncertainty after the other."""

from __future__ import annotations

from dataclasses import fields

from meso_robust.bounds import Interval
from meso_robust.certificates.chain import certify
from meso_robust.planning.reading import read_plan
from meso_robust.planning.rules import rules_of
from meso_robust.primitives.setup import Uncertainty, setup_of
from meso_robust.task import load_task
from reports.posts.causes import TASK, cases

SETUP = setup_of(load_task(TASK))
STEP = certify(rules_of(read_plan(TASK.with_name("plan.json"), load_task(TASK)))[:2], SETUP).steps[
    1
]


def is_wide(side: Interval) -> bool:
    return side.lo < side.hi


def test_each_case_leaves_out_one_thing_and_all_have_their_turn() -> None:
    found, whole = list(cases(STEP, SETUP)), SETUP.uncertainty
    wide = {f.name for f in fields(Uncertainty) if is_wide(getattr(whole, f.name))}
    gone = [
        {name for name in wide if not is_wide(getattr(case.setup.uncertainty, name))}
        for case in found
    ]
    assert set().union(*gone) == wide
    radii = {"tip_radius", "passive_tip_radius"}
    assert sorted(map(len, gone)) == [0] * 5 + [1] * (len(wide) - 2) + [2]
    assert radii in gone
    boxes = [[not is_wide(side) for side in (c.pre.x, c.pre.y, c.pre.theta)] for c in found]
    assert sorted(map(sum, boxes)) == [0] * (len(found) - 3) + [1] * 3
    assert [case.setup.friction_common for case in found].count(True) == 1
