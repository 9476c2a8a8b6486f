"""Which steps a plan has, and what the planner refuses."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from meso_robust.bounds import Interval, Verdict
from meso_robust.certificates.chain import certify
from meso_robust.errors import NotApplicableError
from meso_robust.planning import compose as composing
from meso_robust.planning.compose import compose, robust_at
from meso_robust.planning.remedy import Remedy
from meso_robust.primitives.frame import WORLD
from meso_robust.primitives.move import Aim, Point
from meso_robust.primitives.names import about
from meso_robust.primitives.setup import Block, setup_of
from meso_robust.task import Film, Task, load_task
from meso_robust.tasks import HEXAGON, SLOT
from tests.conftest import paper_task
from tests.nightly import at_night
from tests.strategies import paper_chain


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
        (0.0, "one quarter; make it two tasks"),
        (20.0, "one quarter; make it two tasks|upright"),
    ],
)
def test_poses_that_no_primitive_handles(theta: float, words: str) -> None:
    with pytest.raises(NotApplicableError, match=words):
        compose(paper_task(start__theta_deg=theta))


def test_a_goal_that_no_edge_lies_flat_in_is_refused_at_once() -> None:
    task = paper_task(start__theta_deg=180.0, goal__theta_deg=186.0)
    assert task.goal.orientation_tolerance_deg < 6.0
    with pytest.raises(NotApplicableError, match=r"the goal stands 6\.0 deg from upright"):
        compose(task)


def test_what_a_plan_bears_least_is_suspected_first_and_how_far_it_holds_is_told() -> None:
    task = paper_task(uncertainty__friction=[0.1, 0.56])
    rules = robust_at(task, composing.REDUCED[-1])
    assert rules is not None

    suspected = composing._suspected(task, rules, list(setup_of(task).uncertainty.stated))
    assert suspected[0] == "friction"
    most = composing._borne(task, rules, composing.REDUCED[-1], None)
    proved = [
        certify(rules, setup_of(task, scale)).verdict is Verdict.PROVED
        for scale in (most, most + 0.01 * composing.FINELY)
    ]
    assert proved == [True, False]
    assert most > composing.REDUCED[-1]


@at_night
def test_what_would_settle_it_names_the_uncertainty_in_the_way() -> None:
    found = compose(paper_task(uncertainty__friction=[0.22, 0.46], probe__headings=["-x"]))

    assert found.scale < 1.0
    assert found.only == "friction"
    assert found.range is not None
    assert found.settled_by == about(
        Remedy.NARROW_ONE, uncertainty="friction", scale=str(found.scale), range=found.range
    )


@pytest.mark.parametrize(
    ("start", "goal_deg", "heading", "mirrored"),
    [
        ((2060.4, 9.2, 90.0), 0.0, "-x", True),
        ((-2060.4, 9.2, -90.0), 0.0, "+x", False),
        ((9.2, 2060.4, 180.0), 270.0, "-y", False),
        ((9.2, -2060.4, 0.0), -90.0, "+y", True),
        ((2060.4, 9.2, -270.0), 0.0, "-x", True),
    ],
    ids=["clockwise", "from the left", "from above", "clockwise from below", "a turn further on"],
)
def test_a_turned_or_mirrored_task_has_the_same_plan_in_other_axes(
    start: tuple[float, float, float], goal_deg: float, heading: str, mirrored: bool
) -> None:
    task = paper_task(
        start__x_um=start[0], start__y_um=start[1], start__theta_deg=start[2],
        goal__theta_deg=goal_deg,
    )  # fmt: skip

    found = compose(task)

    assert {(rule.frame.heading, rule.frame.mirrored) for rule in found.rules} == {
        (heading, mirrored)
    }
    same = [replace(rule, frame=WORLD) for rule in found.rules]
    for one, other in zip(same, (step.rule for step in paper_chain().steps), strict=True):
        assert (one.action, one.side) == (other.action, other.side)
        for name in ("dual", "single", "dual_end"):
            assert near(getattr(one, name), getattr(other, name))
    assert certify(found.rules, setup_of(task)).verdict is Verdict.PROVED


def near(one: object, other: object) -> bool:
    """Whether two points, aims or nothings agree to the 0.1 um of a command."""
    if isinstance(one, Point) and isinstance(other, Point):
        return near(one.x, other.x) and near(one.y, other.y)
    if isinstance(one, Aim) and isinstance(other, Aim):
        return one.anchor == other.anchor and abs(one.offset_um - other.offset_um) < 0.21
    return one is other is None


def test_a_plan_that_presses_too_hard_says_by_how_much() -> None:
    """On an even film, of which a root of a sum of squares is nought."""
    task = load_task(HEXAGON)
    film = Film(drag_un_s_per_um=0.2)

    def capped(cap_un: float) -> Task:
        probe = task.probe.model_copy(update={"max_force_un": cap_un})
        return task.model_copy(update={"probe": probe, "film": film})

    found = compose(capped(15.9))

    # drag, speed and friction of one tip that may press alone with both's force
    assert found.settled_by == about(Remedy.RAISE_CAP, force_un="16.0")
    assert 0.2 * 75.0 * math.hypot(1.0, 0.36) == pytest.approx(16.0, abs=0.1)
    assert certify(found.rules, setup_of(capped(15.9))).verdict is Verdict.UNKNOWN
    # a plan that fails for another reason as well is none that a larger cap would settle
    lean = found.rules[:-1]
    assert composing._largest_force(lean, setup_of(capped(15.9))) is None
    wall = Block(x=Interval(-1e-3, 0.0), y=Interval(-1e-3, 1e-3))
    walled = replace(setup_of(capped(15.9)), blocks=(wall,))
    assert certify(found.rules, walled).end is not None
    assert composing._largest_force(found.rules, walled) is None
    enough = compose(capped(16.0))
    assert enough.force_n is None
    assert certify(enough.rules, setup_of(capped(16.0))).verdict is Verdict.PROVED


@at_night
def test_a_plan_that_the_slot_forbids_says_so() -> None:
    slot = load_task(SLOT)
    assert slot.slot is not None
    narrow = slot.slot.model_copy(update={"width_um": 850.0})
    task = slot.model_copy(update={"slot": narrow})

    found = compose(task)

    assert found.scale >= 1.0
    assert found.settled_by == about(Remedy.LEAVE_SLOT)
    assert certify(found.rules, setup_of(task)).verdict is Verdict.UNKNOWN
