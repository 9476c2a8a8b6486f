"""Moves in turned and mirrored axes."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from meso_robust.bounds import HALF_PI, Interval, Verdict
from meso_robust.certificates.chain import Chain, certify
from meso_robust.laboratory.replay import Feedback
from meso_robust.primitives.frame import HEADINGS, WORLD, Frame
from meso_robust.primitives.setup import PoseBox, Setup
from tests.strategies import paper_chain

FRAMES = [Frame(heading=h, mirrored=m) for h, m in itertools.product(HEADINGS, (False, True))]
NAMES = [f"{frame.heading}{' mirrored' if frame.mirrored else ''}" for frame in FRAMES]


def in_world(frame: Frame) -> Setup:
    """The paper's task as it lies in the world if its own axes are those of ``frame``."""
    setup = paper_chain().setup
    u = setup.uncertainty
    return replace(
        setup,
        start=frame.box_to_world(setup.start),
        goal=frame.box_to_world(setup.goal),
        uncertainty=replace(u, misalignment=-u.misalignment) if frame.mirrored else u,
    )


def moved(frame: Frame) -> Chain:
    rules = [replace(step.rule, frame=frame) for step in paper_chain().steps]
    return certify(rules, in_world(frame))


@pytest.mark.parametrize(
    ("frame", "ahead", "left", "quarter"),
    [
        (Frame(), (-1, 0), (0, 1), 0.0),
        (Frame(heading="-y"), (0, -1), (-1, 0), 90.0),
        (Frame(heading="+x"), (1, 0), (0, -1), 180.0),
        (Frame(heading="+y"), (0, 1), (1, 0), 270.0),
        (Frame(mirrored=True), (-1, 0), (0, -1), 0.0),
        (Frame(heading="+y", mirrored=True), (0, 1), (-1, 0), 270.0),
    ],
)
def test_axes_by_hand(
    frame: Frame, ahead: tuple[int, int], left: tuple[int, int], quarter: float
) -> None:
    """``ahead``: where own -x points; ``left``: own +y; a pose at own angle 0 and at own 10 deg."""
    np.testing.assert_array_equal(
        frame.to_world(np.array([[-1.0, 0.0], [0.0, 1.0]])), [ahead, left]
    )
    turn = -10.0 if frame.mirrored else 10.0
    world = np.array([[*left, math.radians(quarter + turn)]])
    np.testing.assert_allclose(frame.sensed(world), [[0.0, 1.0, math.radians(10.0)]], atol=1e-15)


@pytest.mark.parametrize("frame", FRAMES, ids=NAMES)
def test_boxes_go_there_and_back(frame: Frame) -> None:
    box = PoseBox(x=Interval(1.0, 2.0), y=Interval(-5.0, -3.0), theta=Interval(0.25, 0.5))
    back = frame.from_world(frame.box_to_world(box))
    assert box.within(back)
    assert max(back.x.width - 1, back.y.width - 2, back.theta.width - 0.25) < 1e-14
    corners = [(x, y, t) for x in (1, 2) for y in (-5, -3) for t in (0.25, 0.5)]
    own = frame.sensed(np.array(corners, dtype=float))
    there = frame.from_world(box)
    for k, side in enumerate((there.x, there.y, there.theta)):
        assert side.lo == pytest.approx(own[:, k].min(), abs=1e-14)
        assert side.hi == pytest.approx(own[:, k].max(), abs=1e-14)


@pytest.mark.parametrize("frame", FRAMES, ids=NAMES)
def test_goal_is_rounded_inward(frame: Frame) -> None:
    setup = paper_chain().setup
    seen = frame.setup(setup)
    assert frame.box_to_world(seen.goal).x == setup.goal.x
    turned = HALF_PI * Interval.point(float(frame.quarters))
    wide = (-seen.goal.theta if frame.mirrored else seen.goal.theta) + turned
    assert wide.width <= setup.goal.theta.width + 1e-14
    if frame != WORLD:
        assert frame.box_to_world(frame.from_world(setup.goal)).theta.width >= (
            setup.goal.theta.width
        )


@pytest.mark.parametrize("frame", FRAMES, ids=NAMES)
def test_a_turned_and_mirrored_task_is_proved_like_the_papers(frame: Frame) -> None:
    chain = moved(frame)

    assert chain.verdict is Verdict.PROVED
    for step, original in zip(chain.steps, paper_chain().steps, strict=True):
        assert step.post is not None
        assert original.post is not None
        here = frame.from_world(step.post)
        for side in ("x", "y", "theta"):
            found, wanted = getattr(here, side), getattr(original.post, side)
            assert found.lo == pytest.approx(wanted.lo, abs=2e-8)
            assert found.hi == pytest.approx(wanted.hi, abs=2e-8)
        for one, other in zip(step.obligations, original.obligations, strict=True):
            assert one.proof.lower == pytest.approx(other.proof.lower, rel=1e-3, abs=1e-8)


@pytest.mark.parametrize("frame", FRAMES[1:], ids=NAMES[1:])
def test_the_simulator_which_knows_no_frames_ends_in_the_certified_boxes(frame: Frame) -> None:
    chain = moved(frame)
    player = Feedback(rules=tuple(step.rule for step in chain.steps), setup=chain.setup)

    runs = player.run(player.draw(24, np.random.default_rng(5)))

    assert runs.completed.all()
    for move, step in zip(runs.moves, chain.steps, strict=True):
        assert step.post is not None
        for k, side in enumerate((step.post.x, step.post.y, step.post.theta)):
            error = 3e-6 if k == 2 else 1e-7  # of the steps of 2 um, see reports/simulator
            assert (move.after[:, k] >= side.lo - error).all()
            assert (move.after[:, k] <= side.hi + error).all()


def test_a_mirrored_rotation_turns_clockwise() -> None:
    chain = moved(Frame(mirrored=True))
    turn = next(step for step in chain.steps if step.rule.action == "rotate")
    assert turn.post is not None
    assert turn.pre.theta.lo > math.radians(-91)
    assert turn.post.theta.hi < math.radians(-170)


@pytest.mark.parametrize("frame", FRAMES[1::2], ids=NAMES[1::2])
def test_a_crooked_pair_is_mirrored_with_the_axes(frame: Frame) -> None:
    """A pair that always has its upper tip ahead in the world has the lower one ahead in the mirror."""
    crooked = Interval(math.radians(0.2), math.radians(0.4))
    setup = in_world(frame)
    setup = replace(setup, uncertainty=replace(setup.uncertainty, misalignment=crooked))
    rules = tuple(replace(step.rule, frame=frame) for step in paper_chain().steps)
    chain = certify(rules, setup)
    assert chain.verdict is Verdict.PROVED
    player = Feedback(rules=rules, setup=setup, engine="events")

    runs = player.run(player.draw(12, np.random.default_rng(6)))

    assert runs.completed.all()
    assert chain.end is not None
    assert (runs.final[:, 2] >= chain.end.theta.lo).all()
    assert (runs.final[:, 2] <= chain.end.theta.hi).all()
    assert chain.end.theta.width < math.radians(0.21)
