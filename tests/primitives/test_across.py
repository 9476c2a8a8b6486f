"""A push after one across it: where it leaves the part, against force balance from push to push."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest

from meso_robust.bounds import HALF_PI, Interval, Verdict
from meso_robust.planning.x_translation import rule_at
from meso_robust.primitives.certify import certify_move
from meso_robust.primitives.frame import Frame
from meso_robust.primitives.move import MoveRule, in_world
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.types import Floats
from tests.primitives.replay import Draws
from tests.primitives.test_slip import Part
from tests.primitives.test_tolerance import DEG, UM, real

RUNS, SHORT = 300, 0.5 * UM
AHEAD, ASIDE, LEANING = (
    Interval(300 * UM, 320 * UM),
    Interval(-320 * UM, -300 * UM),
    Interval(-1.5 * DEG, 1.5 * DEG),
)
WAYS = (
    (Frame(heading="-x"), Frame(heading="+y", mirrored=True)),
    (Frame(heading="+y"), Frame(heading="-x")),
    (Frame(heading="-x", mirrored=True), Frame(heading="-y")),
)
"""The first push, on a short edge or on a long one, and one across it."""


def start_of(way: tuple[Frame, Frame]) -> PoseBox:
    """Ahead of both pushes, leaning either way, the short edges facing along x."""
    x, y = (
        next(a for a in (AHEAD, ASIDE) if all(faces(frame, axis, a) for frame in way))
        for axis in (0, 1)
    )
    return PoseBox(x=x, y=y, theta=Interval(2.0 * HALF_PI.lo, 2.0 * HALF_PI.hi) + LEANING)


def faces(frame: Frame, axis: int, side: Interval) -> bool:
    """Whether a part there is ahead of a push along this axis; any other push does not mind."""
    along = frame.matrix[axis, 0]
    return bool(along == 0.0 or along * side.mid > 0.0)


def depth(frame: Frame) -> float:
    """Of the edge that is pushed, m."""
    return (808 if frame.quarters % 2 == 0 else 418.5) * UM


def rule_in(frame: Frame, box: PoseBox, setup: Setup) -> MoveRule:
    """A push that ends with the part's middle at zero."""
    end = in_world(depth(frame) / UM + 7.5)
    own, there = frame.from_world(box), frame.setup(setup)
    rule = rule_at(0.0, own, there, end, step=4, primitive="x_translation")
    return replace(rule, frame=frame)


@functools.cache
def pushes(way: tuple[Frame, Frame]) -> tuple[Setup, Step, Step, Step]:
    """The first, the second, and the second from the box of poses alone."""
    setup, start = real(1.0, spacing=580 * UM), start_of(way)
    first = certify_move(rule_in(way[0], start, setup), start, setup)
    assert first.post is not None
    rule = rule_in(way[1], first.post, setup)
    return (
        setup,
        first,
        certify_move(rule, first.post, setup, first),
        certify_move(rule, first.post, setup),
    )


def pushed(step: Step, poses: Floats, setup: Setup, draw: Draws) -> Floats:
    """Poses (runs, 3) after a push, world axes; all that is uncertain is drawn anew but the part's place."""
    rule, frame = step.rule, step.rule.frame
    u, count = frame.setup(setup).uncertainty, len(poses)
    part = Part(
        pose=frame.sensed(poses),
        depth=depth(frame) + draw(u.size),
        kappa=draw(u.squareness),
        drag=np.stack([draw(u.drag_centre), draw(u.drag_centre)], 1),
        film=np.stack([draw(u.film_ratio), draw(u.drag_anisotropy), draw(u.drag_anisotropy)], 1),
    )
    quarter = np.round(part.pose[:, 2] / HALF_PI.mid - 1.0) * HALF_PI.mid
    part.kappa += HALF_PI.mid - quarter  # of the edge that faces the probe
    mu = np.stack([draw(u.friction), draw(u.friction)])
    radii = np.stack([draw(u.tip_radius), draw(u.tip_radius)])
    beta, phi = draw(u.misalignment), draw(u.travel_direction)
    sensed = part.pose[:, :2] + np.stack([draw(u.sensed_position), draw(u.sensed_position)], 1)
    wrong = np.stack([draw(u.probe_position), draw(u.probe_position)], 1)
    start = sensed + np.array([rule.dual.x.offset_um, rule.dual.y.offset_um]) * UM + wrong
    up = 0.5 * setup.spacing.mid * np.stack([-np.tan(beta), np.ones(count)], 1)
    tips = np.stack([start + up, start - up])
    course = -np.stack([np.cos(phi), np.sin(phi)], 1)
    left = sensed[:, 0] + (rule.dual.x.offset_um - rule.dual_end.offset_um) * UM
    which, every = np.arange(2), np.arange(count)
    _, n = part.axes()
    gaps = np.stack([part.gap(tips[k], radii[k]) for k in which]) / -np.sum(n * course, 1)
    one = np.argmin(gaps, axis=0)  # the tip that touches first
    tips, left = tips + gaps[one, every][:, None] * course, left - gaps[one, every]
    open_ = np.ones(count, dtype=bool)
    while open_.any():
        rate, _ = part.moved(tips[one, every], course, mu[one, every])
        by = np.where(open_, SHORT, 0.0)[:, None]
        half = replace(part, pose=part.pose + 0.5 * by * rate)
        rate, _ = half.moved(tips[one, every] + 0.5 * by * course, course, mu[one, every])
        part.pose, tips, left = part.pose + by * rate, tips + by * course, left - by[:, 0]
        assert np.all(left > 0.0)
        open_ &= part.gap(tips[1 - one, every], radii[1 - one, every]) > 0.0
    part.pose[:, :2] += left[:, None] * course
    ends = part.pose[:, :2] @ frame.matrix.T
    sign = -1.0 if frame.mirrored else 1.0
    return np.column_stack([ends, sign * part.pose[:, 2] + HALF_PI.mid * frame.quarters])


@pytest.mark.parametrize("way", WAYS)
def test_runs_end_where_it_is_promised_and_the_promise_is_sharper_than_from_the_box(
    way: tuple[Frame, Frame],
) -> None:
    setup, first, second, alone = pushes(way)
    assert {step.verdict for step in (first, second, alone)} == {Verdict.PROVED}
    assert second.post is not None
    assert alone.post is not None
    draw, start = Draws(RUNS, 3), first.pre
    poses = np.stack([draw(start.x), draw(start.y), draw(start.theta)], 1)
    ends = pushed(second, pushed(first, poses, setup, draw), setup, draw)
    low, high = second.post.ends
    room = np.array([0.3 * UM, 0.3 * UM, 0.002])  # a step of the runs
    assert np.all(ends >= low - room)
    assert np.all(ends <= high + room)
    # most of it is attained, which shows that the two pushes are looked at together
    across = way[0].quarters % 2  # the coordinate that the first push sets
    sharp, wide = ((box.x, box.y)[across].width for box in (second.post, alone.post))
    assert np.ptp(ends[:, across]) > 0.7 * sharp
    assert sharp < 0.92 * wide
    assert (second.post.y, second.post.x)[across] == (alone.post.y, alone.post.x)[across]


def test_after_a_push_along_the_same_line_nothing_is_known_beyond_the_box() -> None:
    setup, first, _, _ = pushes(WAYS[0])
    assert first.post is not None
    rule = rule_in(Frame(heading="+x"), first.post, setup)
    assert certify_move(rule, first.post, setup, first) == certify_move(rule, first.post, setup)
