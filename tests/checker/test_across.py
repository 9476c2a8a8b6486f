"""A push after one across it, by the checker: as sharp as promised, and from the box alone if it is not."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from flint import arb, ctx

from meso_robust.checker.document import RuleDocument
from meso_robust.checker.inputs import PoseBox, given
from meso_robust.checker.moves import verify_move
from meso_robust.checker.ranges import Side
from meso_robust.checker.verdict import BITS
from meso_robust.planning.document import _rule as rule_document
from meso_robust.primitives import setup as planner
from meso_robust.primitives.frame import Frame
from meso_robust.primitives.move import MoveRule
from tests.checker.test_slip import REAL
from tests.checker.test_turns import task
from tests.nightly import by_day
from tests.primitives.test_across import WAYS, pushes


@pytest.fixture(autouse=True)
def precision() -> Iterator[None]:
    with ctx.workprec(BITS):
        yield


def stated(rule: MoveRule) -> RuleDocument:
    return RuleDocument.model_validate_json(rule_document(rule).model_dump_json())


def poses(box: planner.PoseBox) -> PoseBox:
    sides = ((arb(s.lo), arb(s.hi)) for s in (box.x, box.y, box.theta))
    x, y, theta = sides
    return PoseBox(x=x, y=y, theta=theta)


def width(side: Side) -> float:
    return float(side[1] - side[0])


@pytest.mark.parametrize("way", by_day(1, WAYS))
def test_what_the_push_before_leaves_known_is_found_again(way: tuple[Frame, Frame]) -> None:
    _, first, second, alone = pushes(way)
    assert first.post is not None
    assert second.post is not None
    assert alone.post is not None
    known = given(task(REAL))
    memory = verify_move(stated(first.rule), poses(first.pre), known, None)[1].memory
    found = {}
    for one in (None, memory):
        scene, passage = verify_move(stated(second.rule), poses(first.post), known, one)
        found[one is memory] = scene.frame.world(passage.post)
    across = "xy"[way[0].quarters % 2]
    for mine, theirs in ((found[True], second.post), (found[False], alone.post)):
        side, promise = getattr(mine, across), getattr(theirs, across)
        assert float(side[0]) == pytest.approx(promise.lo, abs=0.02 * promise.width)
        assert float(side[1]) == pytest.approx(promise.hi, abs=0.02 * promise.width)
    assert width(getattr(found[True], across)) < 0.92 * width(getattr(found[False], across))
