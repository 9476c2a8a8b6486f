"""A straightening whose first tip may slip: verified as stated, and refused where more is stated than is so."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx

from meso_robust.certificates.document import step_document
from meso_robust.checker.chain import holds_side
from meso_robust.checker.document import ObligationDocument, RuleDocument, StepDocument
from meso_robust.checker.force import force_below_cap
from meso_robust.checker.ids import Must, place
from meso_robust.checker.inputs import PoseBox, given
from meso_robust.checker.moves import verify_move
from meso_robust.checker.numbers import box
from meso_robust.checker.obligations import compare
from meso_robust.checker.passage import Passage, Sweep
from meso_robust.checker.ranges import point_of
from meso_robust.checker.refusal import Refused
from meso_robust.checker.requirement import Requirement
from meso_robust.checker.scene import scene_of
from meso_robust.checker.verdict import BITS
from meso_robust.checker.walls import clear_of_walls
from meso_robust.planning.document import _rule as rule_document
from meso_robust.primitives.grid import roomy
from meso_robust.task import Task
from tests.checker.test_turns import task
from tests.nightly import at_night
from tests.primitives import test_slip as promised

UM = 1e-6
REAL: dict[str, dict[str, Any]] = {
    "part": {"size_tolerance_um": 2.0, "squareness_deg": 0.1},
    "probe": {"tip_radius_um": [2.5, 12.5], "tip_spacing_um": 580.0},
    "uncertainty": {
        "travel_direction_deg": [-0.1, 0.1],
        "drag_centre_um": 20.0,
        "drag_anisotropy_percent": 5.0,
    },
}
FORCED: dict[str, dict[str, Any]] = {"probe": {"max_force_un": 1e9}}


@pytest.fixture(autouse=True)
def precision() -> Iterator[None]:
    with ctx.workprec(BITS):
        yield


@functools.cache
def stated() -> tuple[RuleDocument, StepDocument]:
    """What the promise states of the push."""
    _, step = promised.proved()
    assert step.post is not None
    document = step_document(dataclasses.replace(step, post=roomy(step.post)))
    rule = RuleDocument.model_validate_json(rule_document(step.rule).model_dump_json())
    return rule, StepDocument.model_validate_json(document.model_dump_json())


def told(which: str) -> PoseBox:
    found = getattr(stated()[1], which)
    return box(found, place(which))


@functools.cache
def verified() -> Passage:
    with ctx.workprec(BITS):
        known = given(task(REAL))
        return verify_move(stated()[0], told("pre_exact"), known, None)[1]


def test_the_push_is_verified_as_the_promise_states_it() -> None:
    found = verified()
    assert found.slips
    for name in ("x", "y", "theta"):
        assert holds_side(getattr(told("post_exact"), name), getattr(found.post, name))
    compare(stated()[1].obligations, found.requirements)


def test_runs_with_slipping_tips_end_where_the_checker_says() -> None:
    setup, step = promised.proved()
    end, *_ = promised.runs(setup, step)
    post = verified().post
    low, high = ([float(getattr(post, n)[k]) for n in ("x", "y", "theta")] for k in (0, 1))
    room = np.array([UM, UM, 0.001])  # a step: the second tip is met only to its length
    assert np.all(end >= np.array(low) - room)
    assert np.all(end <= np.array(high) + room)


def narrowed(key: str, by: float, only: str = "") -> Callable[[ObligationDocument], Any]:
    """Of each obligation the upper end of a range is lowered by a share of its width."""

    def change(one: ObligationDocument) -> ObligationDocument:
        if key not in one.over or only not in one.id:
            return one
        low, high = map(float.fromhex, one.over[key])
        lower = high - by * ((high - low) or high)
        first = lower if low == high else low
        return one.model_copy(update={"over": {**one.over, key: (first.hex(), lower.hex())}})

    return change


def claimed(only: str, factor: float) -> Callable[[ObligationDocument], Any]:
    """More is said to be to spare."""

    def change(one: ObligationDocument) -> ObligationDocument:
        if one.id != only or one.lower_bound is None:
            return one
        return one.model_copy(
            update={"lower_bound": (float.fromhex(one.lower_bound) * factor).hex()}
        )

    return change


@pytest.mark.parametrize(
    "forged",
    [
        narrowed("creep_now", 0.3),
        narrowed("creep_most", 0.3),
        narrowed("turned", 0.3),
        narrowed("mu_upper_now", 0.2),
        narrowed("mu_upper_now", 0.2, "slip_bounded"),
        narrowed("radius_upper", 0.2),
        narrowed("theta", 0.3),
        claimed("slip_bounded", 1e5),
        pytest.param(claimed("second_tip_touches", 30.0), marks=at_night),
        claimed("tip_turns_part", 3.0),
    ],
)
def test_what_is_forged_of_a_slip_is_refused(forged: Callable[[ObligationDocument], Any]) -> None:
    obligations = stated()[1].obligations
    changed = tuple(map(forged, obligations))
    assert changed != obligations
    with pytest.raises(Refused):
        compare(changed, verified().requirements)


def test_a_contact_that_slips_may_not_be_stated_as_one_that_sticks() -> None:
    """Nor may the bound of the slip be left out."""
    obligations = stated()[1].obligations
    without = tuple(one for one in obligations if one.id != "slip_bounded")
    with pytest.raises(Refused, match="the list of obligations"):
        compare(without, verified().requirements)
    sticking = tuple(
        one.model_copy(update={"inequality": "one_point_sticking.normal_force"})
        if one.inequality == "drag_tensor.slips_one_way"
        else one
        for one in obligations
    )
    with pytest.raises(Refused):
        compare(sticking, verified().requirements)


def test_less_friction_than_the_slip_is_bounded_for_is_refused() -> None:
    values = task(REAL).to_dict()
    values["uncertainty"]["friction"] = [0.02, 0.36]
    with pytest.raises(Refused):
        verify_move(stated()[0], told("pre_exact"), given(Task.from_dict(values)), None)


def test_forces_are_not_judged_of_a_tip_that_slips() -> None:
    known = dataclasses.replace(given(task(REAL)), largest_force=arb(1.0), drag=arb(1.0))
    with pytest.raises(Refused, match="not of a tip that may slip"):
        force_below_cap(scene_of(stated()[0], told("pre_exact"), known), known, verified())


def beside(y_um: float, x_um: tuple[float, float] = (-8000.0, 3000.0)) -> tuple[Requirement, ...]:
    """What is proved of the push with a wall along it whose lower side is at this y."""
    low, high = x_um
    wall = (arb(low) / 10**6, arb(high) / 10**6), (arb(y_um) / 10**6, arb(y_um + 100) / 10**6)
    known = dataclasses.replace(given(task(REAL)), blocks=(wall,))
    return clear_of_walls(scene_of(stated()[0], told("pre_exact"), known), verified(), known)


def test_a_wall_beside_the_way_of_a_tip_that_slips() -> None:
    """Proved 60 um beyond the highest place of a corner in runs, refused where runs meet the wall."""
    *_, passed = promised.runs(*promised.proved())
    x, y, theta = passed[..., None].transpose(2, 0, 1, 3)
    along, across = np.array([[808, -808, -808, 808], [418.5, 418.5, -418.5, -418.5]]) * UM
    high = y + np.sin(theta) * along + np.cos(theta) * across
    assert 680 * UM < high.max() < 690 * UM
    assert Must.PART_CLEAR_OF_WALLS in {one.name.id for one in beside(750.0)}
    # a wall that a corner passes under only once the tip has come halfway
    half = high[len(high) // 2]
    highest = np.unravel_index(half.argmax(), half.shape)
    there = (x + np.cos(theta) * along - np.sin(theta) * across)[len(high) // 2][highest] / UM
    for met in ({"y_um": 680.0}, {"y_um": half.max() / UM - 5.0, "x_um": (there - 5, there + 5)}):
        with pytest.raises(Refused, match="clear of the slot's walls"):
            beside(**met)


STRAYED = {"wander_x": -3.0, "wander_y": 2.0, "wander_x_now": 4.0, "wander_y_now": -5.0}
"""um, of a probe where it meets the part, and later."""


def passed(sweep: Sweep, **shares: float) -> list[float]:
    """The pose at one point of the box, of a probe that has strayed."""
    ends = {name: (high, high) for name, (_, high) in sweep.box.items()}
    strayed = {name: arb(um) / 10**6 for name, um in STRAYED.items()}
    fixed = {name: arb(value) for name, value in shares.items()}
    at = {name: (value, value) for name, value in {**strayed, **fixed}.items()}
    return [float(p.value.mid()) for p in sweep.pose(point_of({**ends, **at}))]


def test_a_tip_that_slips_can_be_wherever_it_strays_from_where_it_meets_the_part_to_its_end() -> (
    None
):
    """The part has been moved by what the probe has strayed at first; at last it is where both tips leave it."""
    turning, together = verified().swept
    moved = [1e6 * (a - float(turning.box[n][1])) for a, n in zip(
        passed(turning, share=0.0, progress=0.0, creep_now=0.0), ("x", "y", "theta"), strict=True
    )]  # fmt: skip
    np.testing.assert_allclose(moved, [7.0, -7.0, 0.0], atol=1e-9)
    last = passed(turning, share=1.0, progress=1.0)
    np.testing.assert_allclose(last, passed(together, share=0.0), rtol=0, atol=1e-15)
    first = passed(turning, share=1.0, progress=0.0)
    np.testing.assert_allclose(first, passed(together, share=1.0), rtol=0, atol=1e-15)
