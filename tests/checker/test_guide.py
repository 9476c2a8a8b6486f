"""A push that the slot's walls guide: what the checker verifies of it, and what it does not let pass."""

from __future__ import annotations

import json
from typing import Any

import pytest

from tests.checker.test_check import checked, relisted
from tests.checker.test_walls import certificate, obligation, refusal
from tests.guided import guided_task

Document = dict[str, Any]
GUIDED = 1
"""The second move."""


@pytest.fixture
def document() -> Document:
    return dict(json.loads(certificate(guided_task())))


def answer(document: Document, **changes: Any) -> Any:
    return checked(document, guided_task(**changes))


def test_a_plan_along_the_walls_is_verified(document: Document) -> None:
    found = answer(document)
    assert found.verdict == "VERIFIED"
    assert found.claims.endswith("and the part only its side walls, in guided pushes.")
    assert document["claim"]["id"] == "ends_in_goal_guided"


def test_it_is_not_said_to_be_clear_of_walls(document: Document) -> None:
    document["claim"]["id"] = "ends_in_goal_clear_of_walls"
    assert refusal(answer(document)) == "value: claim.id"


@pytest.mark.parametrize(
    ("changes", "lacks"),
    [
        ({"slot__friction": 0.1}, "edge_turns_back/upper"),
        ({"slot__depth_um": 1110.0}, "part_in_slot"),
        ({"slot__opens": "-y", "slot__mouth_y_um": -4000.0}, "guide_covered"),
    ],
)
def test_another_slot_is_rejected(document: Document, changes: Document, lacks: str) -> None:
    """The first push is left as it is, or it would be what is refused."""
    document["claim"]["id"] = "ends_in_goal_guided"
    assert refusal(answer(document, **changes)) == lacks


@pytest.mark.parametrize(
    "id_",
    ["part_in_slot", "one_wall_at_a_time", "wall_turns_back", "edge_turns_back", "tip_steers"],
)
def test_every_bound_of_a_guided_push_is_compared(document: Document, id_: str) -> None:
    one = obligation(document, GUIDED, id_)
    one["lower_bound"] = (1e-3 + 3.0 * float.fromhex(one["lower_bound"])).hex()
    assert refusal(answer(document)).startswith(id_)


@pytest.mark.parametrize("id_", ["part_in_slot", "no_jam"])
def test_a_dropped_condition_is_rejected(document: Document, id_: str) -> None:
    document["steps"][GUIDED]["obligations"].remove(obligation(document, GUIDED, id_))
    relisted(document)
    assert refusal(answer(document)) == "obligations_listed"


def test_a_box_of_less_than_can_be_is_rejected(document: Document) -> None:
    one = obligation(document, GUIDED, "edge_turns_back")
    low, high = (float.fromhex(end) for end in one["over"]["p"])
    one["over"]["p"] = [low.hex(), (high - 5e-6).hex()]
    assert refusal(answer(document)) == "edge_turns_back/upper: p"


def test_a_post_that_walls_would_not_hold_is_rejected(document: Document) -> None:
    """The part is said to end closer to the axis than the walls see to."""
    post = document["steps"][GUIDED]["post_exact"]
    post["y_m"] = [(-60e-6).hex(), (60e-6).hex()]
    document["steps"][GUIDED]["post"]["y_um"] = [-60.001, 60.001]
    assert refusal(answer(document)) == "post_holds/2: post_exact.y"


def test_a_guided_push_of_a_part_that_is_not_covered_is_rejected(document: Document) -> None:
    for changes in ({"part__corner_radius_um": 3.0}, {"uncertainty__drag_centre_um": 0.1}):
        assert answer(document, **changes).verdict == "REJECTED"
