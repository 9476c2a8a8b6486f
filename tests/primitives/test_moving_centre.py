"""A centre of drag that moves while one tip turns a part: pushes integrated from balance, against the proof."""

from __future__ import annotations

import random
from typing import Any

import pytest

from meso_robust.checker.inputs import given
from meso_robust.checker.moves import verify_move
from meso_robust.primitives.move import Action, MoveRule, Point, from_part
from meso_robust.primitives.setup import PoseBox, setup_of
from meso_robust.primitives.straighten import certify_straighten
from meso_robust.primitives.tilt import certify_tilt
from tests.checker.real_tips import Vector
from tests.checker.test_turns import (
    FULL,
    MOVING,
    STRAIGHTEN,
    TILT,
    Proved,
    changing,
    drawn,
    push_of,
    rule as stated,
    task,
)
from tests.nightly import by_day

ROOM = 3e-8
"""m and rad: what the integration of a push is off by."""
LITTLE: dict[str, dict[str, Any]] = {
    "part": {"size_tolerance_um": 0.0, "squareness_deg": 0.0},
    "probe": {"tip_radius_um": [5.0, 5.0], "tip_spacing_tolerance_um": 0.0},
    "uncertainty": {
        "sensed_position_um": 0.1,
        "sensed_orientation_deg": 0.01,
        "probe_position_um": 0.1,
        "friction": [0.4, 0.4],
        "film_ratio_percent": 0.1,
        "travel_direction_deg": [0.0, 0.0],
        "travel_scale_percent": 0.0,
        "drag_anisotropy_percent": 0.0,
    },
}
"""Beside the centre of drag there is little that is not known."""
LASTING = ("beta", "spacing", "radius_upper", "radius_lower", "depth", "kappa")


def rule(action: Action, offsets: tuple[float, float, float], side: int) -> MoveRule:
    x, y, end = (from_part(offset) for offset in offsets)
    return MoveRule(
        step=1, primitive="t", action=action, side=side, dual=Point(x=x, y=y), dual_end=end
    )


def outside(pose: Vector, box: PoseBox | None) -> float:
    assert box is not None
    sides = zip(pose, (box.x, box.y, box.theta), strict=True)
    return max(max(side.lo - value, value - side.hi) for value, side in sides)


@pytest.mark.parametrize("more", by_day(1, [[LITTLE], []]))
def test_pushes_end_in_the_proved_boxes_wherever_the_centre_is_at_each_instant(
    more: list[dict[str, dict[str, Any]]],
) -> None:
    """And, where there is little else, not in those of a centre that is known to be the reference point."""
    tasks = [
        task(FULL, *more, *moving, {"uncertainty": {"drag_centre_um": um}})
        for um, moving in ((20.0, [MOVING]), (0.0, []))
    ]
    known, rng = Proved(given(tasks[0])), random.Random(7)
    worst = []
    for setup in map(setup_of, tasks):
        tilted = certify_tilt(rule("tilt", TILT, 1), setup.start, setup)
        assert tilted.post is not None
        straightened = certify_straighten(rule("straighten", STRAIGHTEN, 0), tilted.post, setup)
        worst.append((tilted.post, straightened.post))
    far = [[-1.0, -1.0], [-1.0, -1.0]]
    for k in range(24):
        values = drawn(known.tilt.box, rng, corner=k % 2 == 0)
        push = push_of(known.tilt, values, TILT)
        push.film = changing(known.tilt.box, rng)
        pose = push.run(-1, second=False)
        later = drawn(known.straighten.box, rng, corner=k % 2 == 0)
        later |= {name: values[name] for name in LASTING}
        later |= dict(zip(("x", "y", "theta"), pose, strict=True))
        push = push_of(known.straighten, later, STRAIGHTEN)
        push.film = changing(known.straighten.box, rng)
        for after, end in enumerate((pose, push.run(-1, second=True))):
            for which, posts in enumerate(worst):
                far[which][after] = max(far[which][after], outside(end, posts[after]))

    assert max(far[0]) < ROOM
    assert not more or min(far[1]) > ROOM


def test_a_fixed_centre_of_drag_is_checked_as_closely_as_it_is_planned_with() -> None:
    """A certificate states a hundredth of a box's width on either side for the checker."""
    fixed = task({"uncertainty": {"drag_centre_um": 30.0}})
    setup, known = setup_of(fixed), given(fixed)
    step = certify_tilt(rule("tilt", TILT, 1), setup.start, setup)
    scene, found = verify_move(stated("tilt", TILT), known.start, known, None)
    assert step.post is not None

    for name in ("x", "y", "theta"):
        low, high = getattr(scene.frame.world(found.post), name)
        side = getattr(step.post, name)
        assert float(low) > side.lo - 0.01 * side.width
        assert float(high) < side.hi + 0.01 * side.width
