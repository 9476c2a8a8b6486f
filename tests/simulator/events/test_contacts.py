"""Discs, corners, walls and hollows; outcomes; arguments that are refused."""

from typing import Any

import numpy as np
import pytest

from meso_robust.simulator.events import integrate
from tests.simulator.events.reference import (
    HALF_LONG,
    HALF_SHORT,
    PLAIN,
    PLATE,
    TILTED,
    UM,
    Contact,
    F,
    assert_same,
    end_of,
    follow,
    push,
    turn,
)

NAN = float("nan")
PEN = np.array([[-1, -1], [-1, 1], [1, 1], [1, -1.0]])  # clockwise: the solid is outside
HOLLOW = UM * np.array([[-500, -400], [500, -400], [500, 400], [0, 0], [-500, 400.0]])


def test_disc_rolls_where_it_sticks() -> None:
    radius, travel = 50 * UM, 300 * UM
    result = push([[468.5, 200]], [[-300, 0]], mu=0.9, drag=TILTED, radii=np.array([radius]))
    assert result.timeline(0).modes.tolist() == [[1]]

    def contacts(pose: F, s: float) -> list[Contact]:
        inward = turn(pose[2]) @ np.array([0.0, 1.0])
        tip = np.array([HALF_SHORT + radius - s * travel, 200 * UM])
        return [(inward, tip + radius * inward, np.array([-travel, 0]), NAN)]

    exact = follow([0, 0, np.pi / 2], TILTED, contacts)
    assert_same(result.poses[0], end_of(exact), travel)


def test_disc_slides_round_a_corner() -> None:
    # The disc is beside the end of the edge, in the cone of the corner (808, -418.5) um.
    radius, travel, slant = 40 * UM, 60 * UM, np.radians(30)
    corner = np.array([HALF_SHORT, HALF_LONG])
    start = corner + radius * np.array([np.cos(slant), np.sin(slant)])
    step = travel * np.array([-1.0, 0.2]) / np.hypot(1, 0.2)
    result = push(
        [start / UM], [step / UM], mu=0.0, drag=TILTED, radii=np.array([radius]), samples=2
    )
    timeline = result.timeline(0)
    assert timeline.tip_edges.tolist() == [[-3]]

    def contacts(pose: F, s: float) -> list[Contact]:
        point = pose[:2] + turn(pose[2]) @ np.array([HALF_LONG, -HALF_SHORT])
        way = point - (start + s * step)
        return [(way / np.hypot(*way), point, step, 0.0)]

    exact = follow([0, 0, np.pi / 2], TILTED, contacts)
    assert_same(result.path[0, 1:], np.array([end_of(exact, s) for s in (0.5, 1)]), travel)


def test_disc_goes_from_the_edge_round_the_corner_without_a_jump() -> None:
    radius = 40 * UM
    result = push([[458.5, 780]], [[-150, 130]], mu=0.0, radii=np.array([radius]), samples=600)
    edges = result.timeline(0).tip_edges[:, 0].tolist()
    assert edges[:2] == [0, -3]
    centre = np.array([458.5, 780]) * UM + np.linspace(0, 1, 601)[:, None] * [-150 * UM, 130 * UM]
    body = np.array(
        [turn(p[2]).T @ (c - p[:2]) for p, c in zip(result.path[0], centre, strict=True)]
    )
    outside = np.maximum(np.abs(body) - [HALF_LONG, HALF_SHORT], 0)
    closed = np.hypot(outside[:, 0], outside[:, 1])
    assert closed.min() > radius - 1e-13
    until = result.timeline(0).times
    last = 600 if len(until) == 2 else int(600 * until[2])
    np.testing.assert_allclose(closed[:last], radius, rtol=0, atol=1e-13)


def test_corner_of_the_part_slides_along_a_wall() -> None:
    # The lower left corner of the plate stands on a floor; a tip pushes the plate to the left.
    tilt, travel, mu = np.radians(20), 200 * UM, 0.2
    low = turn(tilt) @ PLATE[0]
    pose = np.array([0.0, -low[1], tilt])
    floor = UM * np.array([[-3000, -500], [3000, -500], [3000, 0], [-3000, 0.0]])
    tip = pose[:2] + turn(tilt) @ np.array([HALF_LONG, 50 * UM])
    step = travel * turn(tilt) @ np.array([-1.0, 0.0])
    result = push(
        [tip / UM], [step / UM], pose, mu=0.8, drag=TILTED, fixture=[floor], fixture_friction=mu
    )
    timeline = result.timeline(0)
    assert timeline.pairs == (("corner", 0, 2),)
    assert timeline.pair_modes.shape == (1, 1)
    assert timeline.modes.tolist() == [[1]]
    sign = -1.0 if timeline.pair_modes[0, 0] == 2 else 1.0

    def contacts(pose: F, s: float) -> list[Contact]:
        corner = pose[:2] + turn(pose[2]) @ PLATE[0]
        inward = turn(pose[2]) @ np.array([-1.0, 0.0])
        return [
            (inward, tip + s * step, step, NAN),
            (np.array([0.0, 1.0]), corner, np.zeros(2), sign * mu),
        ]

    exact = follow(pose, TILTED, contacts)
    assert_same(result.poses[0], end_of(exact), travel)


def test_corner_of_the_fixture_holds_as_a_passive_tip_does() -> None:
    tooth = UM * np.array([[-418.5, -500], [-900, -300], [-900, -700.0]])
    tips, travel = [[418.5, 500], [-418.5, -500]], [[-300, 0], [0, 0]]
    with_tip = push(tips, travel)
    with_tooth = push(tips[:1], travel[:1], fixture=[tooth], fixture_friction=0.33)
    assert with_tooth.timeline(0).pairs == (("edge", 0, 2),)
    assert_same(with_tooth.poses[0], with_tip.poses[0], 300 * UM, 1e-11)


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_part_that_is_flush_with_a_wall_jams_where_it_meets_it(mu: float) -> None:
    pen = PEN * [HALF_SHORT + 30 * UM, 2000 * UM]
    result = push([[428.5, 0]], [[-100, 0]], fixture=[pen], fixture_friction=mu)
    assert result.outcomes[0] == 1
    assert result.ended_at[0] == pytest.approx(0.4, abs=1e-12)
    assert_same(result.poses[0], np.array([-30 * UM, 0, np.pi / 2]), 100 * UM, 1e-11)


def test_part_slides_flush_along_a_wall() -> None:
    # Two corners of the left-hand edge on a wall without friction, a tip that sticks.
    pen = PEN * [HALF_SHORT, 5000 * UM]
    result = push([[0, -808]], [[0, 250]], fixture=[pen], samples=2)
    assert result.outcomes[0] == 0
    assert_same(result.path[0, 1], np.array([0, 125 * UM, np.pi / 2]), 250 * UM, 1e-12)
    assert_same(result.poses[0], np.array([0, 250 * UM, np.pi / 2]), 250 * UM, 1e-12)


def test_tip_slides_into_a_hollow_and_stays_there() -> None:
    result = push(
        [[60, 100]], [[10, -500]], (0, 0, 0), mu=0.0, vertices=HOLLOW, drag=TILTED, samples=10
    )
    timeline = result.timeline(0)
    assert 2 in timeline.tip_edges[:, 0].tolist()
    tip = np.array([70, -400]) * UM
    pose = result.poses[0]
    np.testing.assert_allclose(turn(pose[2]).T @ (tip - pose[:2]), [0, 0], rtol=0, atol=1e-12)


def test_tip_crosses_a_hollow_and_meets_its_other_side() -> None:
    result = push([[-100, 150]], [[150, 0]], (0, 0, 0), mu=0, vertices=HOLLOW)
    timeline = result.timeline(0)
    # The flank is y = 0.8 x: from x = -100 um to 187.5 um at this height it is free.
    assert timeline.modes.tolist() == [[0]]
    result = push([[-100, 150]], [[350, 0]], (0, 0, 0), mu=0, vertices=HOLLOW)
    assert result.timeline(0).times[1] == pytest.approx(287.5 / 350, abs=1e-12)
    assert result.timeline(0).tip_edges[1].tolist() == [2]


def test_pinched_part_may_go_along_or_stay() -> None:
    # Tips on both sides that go along the edges: a grip of any strength, or none.
    result = push([[418.5, 0], [-418.5, 0]], [[0, 100], [0, 100]], samples=2)
    assert result.outcomes[0] == 4
    assert result.ended_at[0] == 0
    np.testing.assert_array_equal(result.path[0], np.tile([0, 0, np.pi / 2], (3, 1)))


def test_tip_that_starts_in_the_part_is_refused_and_a_rounding_is_taken_back() -> None:
    assert push([[410, 0]], [[-100, 0]]).outcomes[0] == 3
    result = push([[418.4999999, 0]], [[-100, 0]])
    assert result.outcomes[0] == 0
    assert result.poses[0, 0] == pytest.approx(-100.0000001 * UM, abs=1e-15)


def test_lengths_scale() -> None:
    one = push([[418.5, 600]], [[-1000, 0]])
    large = integrate(
        vertices=1000 * PLATE,
        poses=np.array([[0, 0, np.pi / 2]]),
        tips=np.array([[[0.4185, 0.6]]]),
        travel=np.array([[[-1.0, 0]]]),
        friction=np.array([[0.33]]),
        drag=7.0 * PLAIN * [1, 1, 1e6],
    )
    assert_same(large.poses[0] / [1000, 1000, 1], one.poses[0], 1000 * UM, 1e-10)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("vertices", PLATE[::-1]),
        ("vertices", PLATE[:2]),
        ("poses", np.array([[0.0, np.nan, 0]])),
        ("tips", np.zeros((2, 1, 2))),
        ("travel", np.zeros((1, 2, 2))),
        ("friction", np.array([[-0.1]])),
        ("drag", np.diag([1, 1, -1e-6])),
        ("drag", PLAIN + 0.1 * np.eye(3, k=1)),
        ("radii", np.array([-1.0])),
        ("fixture_friction", -0.1),
        ("samples", -1),
    ],
)
def test_refusals_name_the_argument(name: str, value: Any) -> None:
    arguments: dict[str, Any] = {
        "vertices": PLATE,
        "poses": np.zeros((1, 3)),
        "tips": np.array([[[0.0, 0.01]]]),
        "travel": np.zeros((1, 1, 2)),
        "friction": np.zeros((1, 1)),
        "drag": PLAIN,
    }
    assert integrate(**arguments).outcomes.tolist() == [0]
    with pytest.raises(ValueError, match=rf"^{name}: .*; .*; "):
        integrate(**{**arguments, name: value})
