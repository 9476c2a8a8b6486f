"""Replayed motions end where the certified steps say."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from meso_robust import units
from meso_robust.bounds import Interval
from meso_robust.primitives.setup import PoseBox, Uncertainty
from meso_robust.primitives.straighten import certify_straighten
from meso_robust.primitives.tilt import certify_tilt
from meso_robust.primitives.tips import second_tip, tip_of
from tests.primitives.replay import Draws, World, begin, play
from tests.strategies import paper_chain

ERROR = 5e-9  # m, of the integration
TURN_ERROR = 5e-7  # rad, likewise: the turn between two tips is integrated with the midpoint rule
COUNT = 120


@pytest.fixture(scope="module")
def worlds() -> list[World]:
    """The samples before the first move and after every one."""
    chain, draw = paper_chain(), Draws(COUNT, 2)
    found = [begin(chain.setup, draw)]
    for step in chain.steps:
        found.append(play(step.rule, found[-1], chain.setup, draw))
    return found


def outside(world: World, box: PoseBox) -> float:
    """How far the worst sample lies outside the box, in errors of the integration."""
    pairs = ((world.x, box.x, ERROR), (world.y, box.y, ERROR), (world.theta, box.theta, TURN_ERROR))
    return max(float(np.max([side.lo - v, v - side.hi])) / error for v, side, error in pairs)


def test_every_replayed_pose_lies_in_the_certified_box(worlds: list[World]) -> None:
    for step, before, later in zip(paper_chain().steps, worlds, worlds[1:], strict=False):
        assert step.post is not None
        assert outside(before, step.pre) < 1.0
        assert outside(later, step.post) < 1.0, step.rule.action


def test_every_replayed_end_lies_in_the_goal(worlds: list[World]) -> None:
    assert outside(worlds[-1], paper_chain().setup.goal) < 0.0


def test_certified_boxes_are_not_much_wider_than_what_is_seen(worlds: list[World]) -> None:
    """At most this many times the sampled range in x, y and theta."""
    most = {"tilt": (2.0, 2.0, 1.5), "straighten": (2.0, 1.8, 1.1), "rotate": (3.0, 3.0, 1.1)}
    for step, world in zip(paper_chain().steps, worlds[1:], strict=True):
        assert step.post is not None
        sides = (step.post.x, step.post.y, step.post.theta)
        for side, seen, factor in zip(
            sides, (world.x, world.y, world.theta), most[step.rule.action], strict=True
        ):
            assert side.hi - side.lo <= factor * np.ptp(seen)


@pytest.mark.parametrize("index", [0, 1, 3])
@pytest.mark.parametrize("degrees", [1.0, -1.0])
def test_known_parameters_give_the_replayed_pose(index: int, degrees: float) -> None:
    """Nothing uncertain, the tips out of line by one degree: the box shrinks onto the motion."""
    old, setup = paper_chain().steps[index], paper_chain().setup
    zero, beta = Interval.point(0.0), units.radians(degrees)
    known = Uncertainty(
        sensed_position=zero,
        sensed_orientation=zero,
        probe_position=zero,
        friction=Interval.point(0.33),
        film_ratio=Interval.point(0.3769e-6),
        misalignment=beta,
    )
    x, y, theta = (Interval.point(value) for value in old.pre.mid)
    pre, exact = PoseBox(x=x, y=y, theta=theta), replace(setup, uncertainty=known)
    certified = certify_tilt if old.rule.action == "tilt" else certify_straighten
    step = certified(old.rule, pre, exact)
    draw = Draws(1, 0)
    world = World(
        x=draw(x),
        y=draw(y),
        theta=draw(theta),
        rho=draw(known.film_ratio),
        mu=draw(known.friction),
        beta=draw(beta),
    )
    assert step.post is not None
    assert outside(play(old.rule, world, exact, draw), step.post) < 1.0
    assert step.post.x.width < 0.2e-6
    assert step.post.y.width < 0.2e-6
    assert step.post.theta.width < 1e-6


@pytest.mark.parametrize("degrees", [2.0, -2.0])
def test_a_positive_misalignment_puts_the_upper_tip_ahead(degrees: float) -> None:
    step, setup = paper_chain().steps[0], paper_chain().setup
    u = replace(setup.uncertainty, misalignment=units.radians(degrees))
    upper, lower = (
        tip_of(step.rule, side, step.pre, replace(setup, uncertainty=u)) for side in (1, -1)
    )
    ahead = -580e-6 * math.tan(math.radians(degrees))  # the push is along -x
    assert upper.ahead.mid - lower.ahead.mid == pytest.approx(ahead, abs=1e-12)
    assert upper.ahead_end.mid - lower.ahead_end.mid == pytest.approx(ahead, abs=1e-12)
    assert upper.rise.mid - lower.rise.mid == pytest.approx(580e-6, abs=1e-12)
    dx, dy = second_tip(-1, replace(setup, uncertainty=u))  # from the lower tip to the upper one
    assert dx.mid == pytest.approx(ahead, abs=1e-12)
    assert dy.mid == pytest.approx(580e-6, abs=1e-12)
