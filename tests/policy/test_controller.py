"""What the controller answers when lines repeat, and which policies it does not take."""

from __future__ import annotations

import json
import math
from concurrent.futures import Future
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from meso_robust.bounds import Interval
from meso_robust.errors import InputError
from meso_robust.policy.cells import Policy
from meso_robust.policy.controller import (
    Done,
    Move,
    PlanController,
    PolicyController,
    Refused,
    _stages,
)
from meso_robust.policy.document import policy_document, read_policy
from meso_robust.policy.pose import Sensed
from meso_robust.primitives.move import MoveRule, Point, from_part
from meso_robust.primitives.setup import PoseBox, setup_of
from meso_robust.task import Task
from tests.conftest import paper_task


def test_the_same_line_again_gets_the_same_move_though_it_could_be_the_end_too() -> None:
    """A push so short that the poses before and after it overlap."""
    controller, pose = short_push(), AT_START

    first, again = controller.answer(pose), controller.answer(pose)

    assert isinstance(first, Move)
    assert again == first
    assert isinstance(controller.answer(IN_GOAL), Done)


def short_push(settled: bool = True) -> PlanController:
    """A plan of one push so short that the poses before and after it overlap."""
    plan = PlanController((PUSH,), short_push_task())
    if settled:
        plan.settle()
    return plan


def short_push_task() -> Task:
    return paper_task(
        start__x_um=8.0, start__y_um=0.0, start__theta_deg=180.0,
        goal__position_tolerance_um=11.5, uncertainty__sensed_orientation_deg=0.01,
        uncertainty__probe_position_um=1.0, uncertainty__tip_misalignment_deg=[-0.01, 0.01],
    )  # fmt: skip


PUSH = MoveRule(
    step=1,
    primitive="x_translation",
    action="straighten",
    side=0,
    dual=Point(x=from_part(820.0), y=from_part(0.0)),
    dual_end=from_part(800.0),
)
STATED = Sensed(x_um=8.0, y_um=0.0, theta_deg=180.0)
AT_START = Sensed(x_um=8.1, y_um=0.0, theta_deg=180.0)
IN_GOAL = Sensed(x_um=0.1, y_um=0.0, theta_deg=180.0)


def test_a_part_at_the_stated_start_is_answered_before_other_starts_are_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """And what is expected after its move is of the stated starts, whenever the others are found."""
    wide, not_yet = Future[tuple[PoseBox, ...]](), Future[tuple[PoseBox, ...]]()
    not_yet.set_exception(AssertionError("other starts were asked for"))
    monkeypatch.setattr("meso_robust.policy.controller._beside", lambda work: not_yet)
    plan = short_push(settled=False)

    first = plan.answer(STATED)
    assert isinstance(first, Move)
    assert isinstance(plan.answer(IN_GOAL), Done)

    stated = _stages((PUSH,), setup_of(short_push_task()))
    assert stated is not None
    room = Interval(-5e-6, 5e-6)
    wide.set_result(tuple(replace(box, x=box.x + room) for box in stated))
    plan._widest = wide
    beside = plan.answer(AT_START)
    assert isinstance(beside, Move)
    assert isinstance(plan.answer(IN_GOAL), Done)
    assert plan.answer(STATED) == first


def test_what_goes_wrong_while_starts_are_looked_for_is_told_to_who_asks(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def fails(*_: object) -> tuple[PoseBox, ...]:
        raise ArithmeticError("no bound")

    monkeypatch.setattr("meso_robust.policy.controller._widest", fails)

    plan = short_push(settled=False)
    with pytest.raises(ArithmeticError, match="no bound"):
        plan.settle()
    with pytest.raises(ArithmeticError, match="no bound"):
        plan.answer(AT_START)


def test_no_answer_is_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """A part outside the stated starts is refused as long as others are looked for, and told so."""
    wide = Future[tuple[PoseBox, ...]]()
    monkeypatch.setattr("meso_robust.policy.controller._beside", lambda work: wide)
    plan = short_push(settled=False)
    plan.settle(0.01)

    early = plan.answer(AT_START)

    assert isinstance(early, Refused)
    assert "outside the starts that the task states" in early.why
    assert "ask again" in early.why
    stated = _stages((PUSH,), setup_of(short_push_task()))
    assert stated is not None
    room = Interval(-5e-6, 5e-6)
    wide.set_result(tuple(replace(box, x=box.x + room) for box in stated))
    assert isinstance(plan.answer(AT_START), Move)


@pytest.mark.parametrize("end", ["done", "refused"])
def test_the_next_part_is_pushed_though_its_pose_could_be_the_last_one_s_end(end: str) -> None:
    """Both are where the last move may have left a part; the new part has not been pushed at all."""
    controller = short_push()
    assert isinstance(controller.answer(AT_START), Move)
    if end == "done":
        assert isinstance(controller.answer(IN_GOAL), Done)
    else:
        assert isinstance(controller.answer(Sensed(x_um=5e3, y_um=0.0, theta_deg=180.0)), Refused)
    near = Sensed(x_um=8.05, y_um=0.0, theta_deg=180.0)

    answer = controller.answer(near)

    assert answer == short_push().answer(near)
    assert isinstance(answer, Move)


def test_a_pose_that_only_the_last_part_s_move_explains_is_refused_for_the_next_part() -> None:
    controller = short_push()
    controller.answer(AT_START)

    assert isinstance(controller.answer(IN_GOAL), Done)
    assert isinstance(controller.answer(IN_GOAL), Refused)


def test_a_policy_judges_the_next_part_by_its_own_pose(small_policy: Policy) -> None:
    """In a goal too small to be told by sensing, only the last move makes `done` true, of one part."""
    policy = replace(small_policy, rest=None)
    ends = [cell for cell in policy.cells if cell.ends]
    assert ends
    for cell in ends[:10]:
        controller = PolicyController(policy)
        move = controller.answer(_middle(cell.sensed))
        assert isinstance(move, Move)
        after = _middle(move.expect)

        done, next_part = controller.answer(after), controller.answer(after)

        assert isinstance(done, Done)
        assert next_part == PolicyController(policy).answer(after)
        assert not isinstance(next_part, Done)


def _middle(box: PoseBox) -> Sensed:
    x, y, theta = box.mid
    return Sensed(x_um=1e6 * x, y_um=1e6 * y, theta_deg=math.degrees(theta))


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("side", 2, ".side = 2: must be one of"),
        ("single_x", {"relative_to": "sensed part", "offset_um": -900.0}, "both null"),
        ("dual_x", {"relative_to": "sensed part", "offset_um": 1e12}, "must lie within 1e+06"),
    ],
)
def test_a_policy_of_rules_that_no_motion_is_made_for_is_refused(
    small_policy: Policy, tmp_path: Path, key: str, value: object, words: str
) -> None:
    document: dict[str, Any] = json.loads(
        policy_document(small_policy).model_dump_json(by_alias=True)
    )
    number = next(k for k, rule in enumerate(document["rules"]) if rule["action"] == "straighten")
    document["rules"][number][key] = value
    file = tmp_path / "policy.json"
    file.write_text(json.dumps(document), encoding="utf-8")

    with pytest.raises(InputError) as refused:
        read_policy(file, small_policy.task)

    assert f"rules.{number}." in str(refused.value)
    assert words in str(refused.value)
