"""The policy's claim: tried in the simulator, and broken on purpose."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.bounds import Interval
from meso_robust.laboratory.running import Bench
from meso_robust.policy.cells import Cell, Policy, resting, sensed_poses, true_poses
from meso_robust.policy.cover import ends_of
from meso_robust.policy.follow import expected, follows
from meso_robust.policy.proof import NotProvedError, recertified
from meso_robust.policy.region import region_of, sensed_start, tube
from meso_robust.primitives.certify import certify_move
from meso_robust.primitives.setup import PoseBox, setup_of
from reports.policy.runs import draw_starts, run_policy


def with_cell(policy: Policy, number: int, cell: Cell) -> Policy:
    cells = [*policy.cells]
    cells[number] = cell
    return replace(policy, cells=tuple(cells))


def sample(policy: Policy) -> Policy:
    """All cells from which at most one move is left, and a few others: quick to prove again."""
    near = [cell for cell in policy.cells if cell.moves == 1][:12]
    return replace(policy, cells=tuple(near))


def aimed(cell: Cell, um: float) -> Cell:
    """The same cell with a push that ends elsewhere."""
    end = cell.rule.dual_end
    return replace(
        cell, rule=replace(cell.rule, dual_end=replace(end, offset_um=end.offset_um + um))
    )


def wider(side: Interval, by: float) -> Interval:
    return Interval(side.lo - by, side.hi + by)


def test_all_orientations_and_both_kinds_of_move_are_there(small_policy: Policy) -> None:
    near = {round(np.degrees(region.near)) for region in region_of(small_policy)}

    assert near == {180, 90}
    assert {cell.rule.action for cell in small_policy.cells} == {"straighten", "rotate"}
    assert small_policy.moves >= 3


def test_the_moves_to_go_fall_whatever_is_sensed(small_policy: Policy) -> None:
    setup = setup_of(small_policy.task)
    assert small_policy.rest is not None
    rng = np.random.default_rng(5)
    low, high = ends_of([cell.sensed for cell in small_policy.cells])
    for cell in small_policy.cells:
        after = sensed_poses(cell.post, setup)
        a, b = after.ends
        poses = rng.choice([0.0, 0.5, 1.0], (8, 3)) * (b - a) + a
        for pose in poses:
            held = ((low <= pose) & (pose <= high)).all(axis=1)
            moves = [small_policy.cells[k].moves for k in np.flatnonzero(held)]
            rests = all(
                s.lo <= v <= s.hi
                for s, v in zip(
                    (small_policy.rest.x, small_policy.rest.y, small_policy.rest.theta),
                    pose,
                    strict=True,
                )
            )
            assert cell.ends or rests or min(moves) < cell.moves


def test_every_start_ends_in_the_goal_in_the_simulator(small_policy: Policy) -> None:
    rng = np.random.default_rng(0)

    setup, draws = setup_of(small_policy.task), draw_starts(small_policy, 600, rng)
    runs = run_policy(small_policy, Bench.of(setup, draws, engine="events"))

    assert runs.kept, runs.why
    assert runs.moves.max() == 4
    assert (runs.excess < 1e-9).all()


def test_the_policy_is_proved_again_as_it_is(small_policy: Policy) -> None:
    part = sample(small_policy)

    assert recertified(part).cells == part.cells


@pytest.mark.parametrize(
    "broken",
    [
        lambda cell: aimed(cell, 90.0),
        lambda cell: aimed(cell, -90.0),
        lambda cell: replace(
            cell, sensed=replace(cell.sensed, theta=wider(cell.sensed.theta, 0.03))
        ),
        lambda cell: replace(cell, sensed=replace(cell.sensed, y=wider(cell.sensed.y, 2e-5))),
        lambda cell: replace(cell, moves=0),
    ],
    ids=["pushed too little", "pushed too far", "more lean", "more y", "no move to go"],
)
def test_a_cell_that_claims_too_much_is_not_proved(small_policy: Policy, broken: object) -> None:
    part = sample(small_policy)
    cell = part.cells[0]
    assert cell.rule.frame.heading == "-x"

    with pytest.raises(NotProvedError, match="cell 0"):
        recertified(with_cell(part, 0, broken(cell)))  # type: ignore[operator]


def test_a_cell_that_leads_to_no_other_is_not_proved(small_policy: Policy) -> None:
    last = small_policy.cells[-1]
    alone = replace(small_policy, cells=(replace(last, moves=1),))

    with pytest.raises(NotProvedError):
        recertified(alone)


def test_resting_poses_are_the_goal_less_the_sensing_error(small_policy: Policy) -> None:
    setup = setup_of(small_policy.task)
    rest = resting(setup)
    assert rest is not None

    assert true_poses(rest, setup).within(setup.goal)
    assert rest.x.hi == pytest.approx(71e-6, abs=1e-9)
    assert rest.theta.width == pytest.approx(np.radians(2 * 4.7), abs=1e-9)


def test_an_answered_box_holds_what_is_certified_from_the_pose_alone(small_policy: Policy) -> None:
    setup = setup_of(small_policy.task)
    rng = np.random.default_rng(2)
    kinds = {(c.rule.action, c.rule.frame, follows(c.rule)): c for c in small_policy.cells}
    for cell in kinds.values():
        pre = true_poses(cell.sensed, setup)
        for share in (0.0, 1.0, rng.random()):
            x, y = ((1.0 - share) * side.lo + share * side.hi for side in (pre.x, pre.y))
            now = PoseBox(x=Interval.point(x), y=Interval.point(y), theta=pre.theta)
            step = certify_move(cell.rule, now, setup)
            assert step.post is not None
            answered = expected(cell.rule, now, pre, cell.post)
            room = PoseBox(
                x=wider(answered.x, 1e-9), y=wider(answered.y, 1e-9), theta=answered.theta
            )
            assert step.post.within(room) or cell.rule.action == "rotate"
    assert any(True in follows(cell.rule) for cell in kinds.values())


def test_the_tube_from_a_start_ends_in_the_goal(small_policy: Policy) -> None:
    setup = setup_of(small_policy.task)

    slices = tube(small_policy, sensed_start(small_policy.task))

    assert all(box.within(setup.goal) for box in slices[-1].boxes)
    assert [stage.to_go for stage in slices] == sorted(
        (stage.to_go for stage in slices), reverse=True
    )
    assert slices[-1].to_go == 0
