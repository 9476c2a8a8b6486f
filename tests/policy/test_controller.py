"""What the controller answers when lines repeat, and which policies it does not take."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from meso_robust.errors import InputError
from meso_robust.policy.cells import Policy
from meso_robust.policy.controller import Done, Move, PlanController
from meso_robust.policy.document import policy_document, read_policy
from meso_robust.policy.pose import Sensed
from meso_robust.primitives.move import MoveRule, Point, from_part
from tests.conftest import paper_task


def test_the_same_line_again_gets_the_same_move_though_it_could_be_the_end_too() -> None:
    """A push so short that the poses before and after it overlap."""
    task = paper_task(
        start__x_um=8.0, start__y_um=0.0, start__theta_deg=180.0,
        goal__position_tolerance_um=11.5, uncertainty__sensed_orientation_deg=0.01,
        uncertainty__probe_position_um=1.0, uncertainty__tip_misalignment_deg=[-0.01, 0.01],
    )  # fmt: skip
    push = MoveRule(
        step=1,
        primitive="x_translation",
        action="straighten",
        side=0,
        dual=Point(x=from_part(820.0), y=from_part(0.0)),
        dual_end=from_part(800.0),
    )
    controller = PlanController((push,), task)
    pose = Sensed(x_um=8.3, y_um=0.0, theta_deg=180.0)

    first, again = controller.answer(pose), controller.answer(pose)

    assert isinstance(first, Move)
    assert again == first
    assert isinstance(controller.answer(Sensed(x_um=0.1, y_um=0.0, theta_deg=180.0)), Done)


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
