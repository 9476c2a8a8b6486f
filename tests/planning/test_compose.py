"""Which steps a plan has, and what the planner refuses."""

from __future__ import annotations

import pytest

from meso_robust.bounds import Verdict
from meso_robust.certificates.chain import certify
from meso_robust.errors import NotApplicableError
from meso_robust.planning.compose import compose
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task
from tests.conftest import paper_task


def steps(task: Task) -> list[tuple[int, str, str]]:
    """Certified moves of the plan for ``task``."""
    found = compose(task)
    assert found.scale >= 1.0
    assert certify(found.rules, setup_of(task)).verdict is Verdict.PROVED
    return [(rule.step, rule.primitive, rule.action) for rule in found.rules]


def test_upright_part_needs_only_step_4() -> None:
    task = paper_task(start__theta_deg=180.0, start__x_um=1500.0, start__y_um=20.0)

    assert steps(task) == [(4, "x_translation", "straighten")]


def test_step_3_is_added_where_it_is_needed() -> None:
    """72 um off in y, and the goal's tolerance of 76 um leaves no room for the errors."""
    task = paper_task(
        start__theta_deg=180.0,
        start__x_um=4000.0,
        start__y_um=75.0,
        uncertainty__sensed_position_um=2.0,
        uncertainty__sensed_orientation_deg=0.1,
        uncertainty__probe_position_um=2.0,
        uncertainty__tip_misalignment_deg=[0.0, 0.0],
    )

    assert steps(task) == [
        (3, "y_translation", "tilt"),
        (3, "y_translation", "straighten"),
        (4, "x_translation", "straighten"),
    ]


def test_y_translation_is_left_out_when_none_is_asked_for() -> None:
    assert [step for step, _, _ in steps(paper_task(plan__least_y_translations=0))] == [2, 4]


@pytest.mark.parametrize("y_um", [60.0, -40.0])
def test_a_start_off_the_goals_height_is_made_up_for_by_the_pairs_height(y_um: float) -> None:
    assert [step for step, _, _ in steps(paper_task(start__y_um=y_um))] == [1, 1, 2, 4]


def test_down_or_up_the_first_tilt_turns_the_right_way() -> None:
    up = compose(paper_task(start__y_um=-20.0)).rules[0]
    down = compose(paper_task(start__y_um=20.0)).rules[0]

    # a rise of the part needs a counter-clockwise tilt first, a fall a clockwise one
    assert (up.side, down.side) == (1, -1)


@pytest.mark.parametrize(
    ("theta", "words"),
    [
        (140.0, "upright"),
        (0.0, "one quarter only"),
        (20.0, "one quarter only|upright"),
    ],
)
def test_poses_that_no_primitive_handles(theta: float, words: str) -> None:
    with pytest.raises(NotApplicableError, match=words):
        compose(paper_task(start__theta_deg=theta))


def test_what_would_settle_it_names_the_uncertainty_in_the_way() -> None:
    found = compose(paper_task(uncertainty__friction=[0.25, 0.41]))

    assert found.scale < 1.0
    assert found.only == "friction"
    assert "friction" in found.settled_by
