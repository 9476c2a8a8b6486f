"""Every pose during a move lies in the tube."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from meso_robust.bounds import Interval
from meso_robust.laboratory.replay import Feedback
from meso_robust.laboratory.running import PlanRun
from meso_robust.primitives.obligation import Knot
from tests.motion.first_principles import Floats
from tests.strategies import paper_chain

POSITION, ANGLE = 2e-8, 2e-6  # what steps of 1 um leave of error, m and rad


@cache
def runs() -> PlanRun:
    chain = paper_chain()
    player = Feedback(rules=tuple(step.rule for step in chain.steps), setup=chain.setup)
    return player.run(player.draw(80, np.random.default_rng(3)), record=60, step=1e-6)


def away(path: Floats, tube: Sequence[Knot]) -> Floats:
    """By how much poses lie outside the union of the slices, in errors of the simulation."""
    least = np.full(path.shape[:-1], np.inf)
    for knot in tube:
        sides = (knot.box.x, knot.box.y, knot.box.theta)
        low, high = np.array([s.lo for s in sides]), np.array([s.hi for s in sides])
        off = np.maximum(low - path, path - high) / [POSITION, POSITION, ANGLE]
        least = np.minimum(least, off.max(axis=-1))
    return least


def test_every_simulated_pose_lies_in_the_tube() -> None:
    assert runs().completed.all()
    for move, step in zip(runs().moves, paper_chain().steps, strict=True):
        assert away(move.path, step.tube).max() < 1.0, step.rule.action


def test_a_tube_less_wide_would_be_left() -> None:
    """Each side of each move's tube matters: cut off a third and poses lie outside."""
    for move, step in zip(runs().moves, paper_chain().steps, strict=True):
        for side in ("x", "y", "theta"):
            cut = [replace(k, box=replace(k.box, **{side: cut_off(getattr(k.box, side))}))
                   for k in step.tube]  # fmt: skip
            assert away(move.path, cut).max() > 1.0, (step.rule.action, side)


def test_the_push_by_one_tip_begins_before_the_move_and_ends_where_both_touch() -> None:
    step = paper_chain().steps[2]
    (alone,) = (k.box for k in step.tube if k.stage == "the active tip pushes alone")
    assert step.pre.within(alone)
    first = step.tube[2].box
    assert alone.x.meets(first.x)
    assert alone.y.meets(first.y)
    assert alone.theta.meets(first.theta)


def cut_off(side: Interval) -> Interval:
    third = (side.hi - side.lo) / 3.0
    return Interval(side.lo + third, side.hi - third)


def test_the_tube_begins_at_rest_and_holds_the_end() -> None:
    for step in paper_chain().steps:
        assert step.tube[0].box == step.pre
        assert step.post is not None
        ends = [k.box for k in step.tube[1:]]
        # what is stated of the end is wider by some per cent of its sides
        room_x, room_theta = 0.05 * step.post.x.width, 0.02 * step.post.theta.width
        assert min(b.x.lo for b in ends) <= step.post.x.lo + room_x
        assert max(b.theta.hi for b in ends) >= step.post.theta.hi - room_theta
