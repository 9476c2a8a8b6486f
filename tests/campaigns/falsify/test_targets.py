"""What an adversary raises: by hand, and against what judges the claims."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.campaigns.falsify.targets import (
    TIGHTEST,
    all_targets,
    needed_friction,
    scorer,
    tube_targets,
)
from meso_robust.laboratory.claim_ids import Claim, ClaimId
from meso_robust.laboratory.claims import slips
from meso_robust.laboratory.engines import push_all
from meso_robust.laboratory.judging import INSTANTS, judge
from meso_robust.laboratory.replay import limits, nominal_row
from meso_robust.laboratory.running import MoveRun, rectangle
from meso_robust.simulator import Push
from tests.campaigns.falsify.parts import claiming, paper_ready, with_side
from tests.laboratory.paper import exactly

Floats = npt.NDArray[np.float64]


def _alone(move: MoveRun, friction: float, film_ratio: float) -> MoveRun:
    """The same move with another friction, by the event-driven engine."""
    push = Push.straight(
        vertices=rectangle(exactly().setup),
        poses=move.before,
        tips=move.tips,
        travel=move.travel,
        friction=np.array([friction]),
        film_ratio=np.array([film_ratio]),
        step=1e-6,
    )
    return replace(move, after=push_all(push, "events").poses)


def test_needed_friction_is_what_the_engine_needs() -> None:
    """Just above it nothing slips, just below it the contact does, in the event-driven engine."""
    rows = nominal_row(exactly())
    moves = exactly().run(rows).moves
    for k in (0, 1, 3):
        needed = needed_friction(moves[k], rows[:, 4])[0]
        # the move by itself: the ones before it may slip as well at this friction
        held = [_alone(moves[k], share * needed, rows[0, 4]) for share in (1.001, 0.999)]
        assert slips(held[0])[0] < 1e-15
        assert slips(held[1])[0] > 1e-12


def test_a_box_is_left_exactly_where_its_target_is_above_one() -> None:
    """At random corners, by what judges the claims, of a box that half of the runs leave."""
    ready = paper_ready()
    rows = drawn_corners(60)
    y = ready.player.run(rows).moves[1].after[:, 1]
    low = with_side(ready, 1, 1, 0, float(np.median(y)))

    score = scorer(low.player, low.target("move 2: box, y low"))(rows)
    judged = judge(low.player, low.claims, rows).broken[Claim(ClaimId.ENDS_IN_BOX, 2)]

    assert np.array_equal(score > 1.0, judged)
    assert judged.sum() == 30


def test_a_tube_is_left_exactly_where_its_target_is_above_one() -> None:
    ready = paper_ready()
    aside = np.array([0.0, 8e-6, 0.0])
    tubes = tuple(None if tube is None else tube + aside for tube in ready.claims.tubes)
    moved = claiming(ready, replace(ready.claims, tubes=tubes))
    low, high = limits(moved.player)
    rows = low + np.random.default_rng(4).random((60, len(low))) * (high - low)
    judged = judge(moved.player, moved.claims, rows)

    for k in (0, 1):
        target = moved.target(f"move {k + 1}: tube")
        assert target.record == INSTANTS
        left = scorer(moved.player, target)(rows) > 1.0
        assert np.array_equal(left, judged.broken[Claim(ClaimId.STAYS_IN_TUBE, k + 1)])
        assert 0 < left.sum() < 60


def test_a_pose_in_a_slice_of_a_tube_by_hand() -> None:
    """Two slices; a path whose worst pose is nearest to the second, at 3/4 of its half width."""
    claims = paper_ready().claims
    one = np.array([[0.0, 0.0, 0.0], [2.0, 2.0, 2.0]])
    tube = np.array([one, one + 1.5])
    target = tube_targets(replace(claims, tubes=(tube, None, None, None)))[0]
    runs = exactly().run(nominal_row(exactly()))
    path = np.array([[[1.0, 1.0, 1.5], [2.5, 3.25, 2.5]]])
    moves = (replace(runs.moves[0], path=path), *runs.moves[1:])

    draws = exactly().draws_of(nominal_row(exactly()))
    value = target.measure(replace(runs, moves=moves), draws)

    assert value == pytest.approx([0.75])


def test_a_box_of_no_width_is_measured_by_the_nanometre() -> None:
    ready = paper_ready()
    x = float(ready.player.run(nominal_row(ready.player)).moves[1].after[0, 0])
    box = ready.claims.posts[1]
    assert box is not None
    flat = box.copy()
    flat[:, 0] = x - 3.0 * TIGHTEST
    claims = replace(ready.claims, posts=(None, flat, None, None))
    target = next(t for t in all_targets(claims) if t.name == "move 2: box, x high")

    value = scorer(ready.player, target)(nominal_row(ready.player))

    assert value == pytest.approx([3.0], rel=1e-6)


def test_a_run_that_cannot_be_carried_out_scores_above_everything() -> None:
    rows = nominal_row(exactly()).repeat(2, axis=0)
    rows[1, 3] = 0.6  # jams in the third move
    ready = paper_ready()

    for name in ("move 1: start", "move 4: box, x low", "goal, theta high"):
        score = scorer(ready.player, ready.target(name))(rows)
        assert np.isfinite(score[0])
        assert score[1] == np.inf


def drawn_corners(count: int) -> Floats:
    low, high = limits(exactly())
    return np.where(np.random.default_rng(4).random((count, len(low))) < 0.5, low, high)
