"""The random tree: its inputs by hand, and a plan that works when it is run by other code."""

import numpy as np
import pytest

from meso_robust.reproduction import printed, rrt
from meso_robust.reproduction.bench import START, Place
from meso_robust.simulator import Outcome, Push, Round, simulate

PLACE = Place()


def test_the_boundary_is_cut_evenly_with_normals_outward() -> None:
    points, normals = rrt.boundary(100)
    x, y = 0.5 * 1616e-6, 0.5 * 837e-6
    on_long = np.isclose(np.abs(points[:, 1]), y) & (np.abs(points[:, 0]) <= x)
    on_short = np.isclose(np.abs(points[:, 0]), x) & (np.abs(points[:, 1]) <= y)
    assert np.all(on_long ^ on_short)
    assert on_long.sum() == round(100 * 1616 / (1616 + 837))
    assert np.all(np.sum(points * normals, axis=1) > 0.0)
    assert points.mean(axis=0) == pytest.approx([0.0, 0.0], abs=1e-12)


def test_pushes_go_along_an_axis_and_start_a_gap_off_the_edge() -> None:
    pose = np.array([2.33e-3, PLACE.axis, 0.5 * np.pi])
    strokes = rrt.pushes(pose, PLACE)
    way = strokes[:, 1] - strokes[:, 0]
    assert np.all((np.abs(way) < 1e-12).sum(axis=1) == 1)
    assert np.abs(way).max(axis=1) == pytest.approx(rrt.LONGEST)
    left = strokes[way[:, 0] < -1e-12]
    assert left[:, 0, 0] == pytest.approx(2.33e-3 + 418.5e-6 + 12.5e-6 + rrt.GAP)
    assert len(left) == 33  # of 100 places as many as lie on a long side


def test_the_pads_resist_a_shift_equally_and_a_turn_by_the_points_mean_square() -> None:
    drag = rrt.pads().drag[0]
    points, loads = printed.three_points("p1*").points[0], printed.three_points("p1*").loads[0]
    assert drag[0, 0] == drag[1, 1] == pytest.approx(printed.SPEED)
    assert drag[0, 1] == 0.0
    assert drag[:2, 2] == pytest.approx([0.0, 0.0], abs=1e-15)
    assert drag[2, 2] / drag[0, 0] == pytest.approx(np.sum(loads * np.sum(points**2, axis=1)))


def test_the_metric_takes_either_end_for_the_same() -> None:
    turned = START + np.array([0.0, 0.0, np.pi])
    shifted = START + np.array([3e-6, 4e-6, 0.0])
    leaned = START + np.array([0.0, 0.0, 0.1])
    found = rrt.distance(np.stack([turned, shifted, leaned]), START)
    assert found == pytest.approx([0.0, 5e-6, 52.53e-6], abs=1e-8)


def test_a_plan_brings_the_peg_into_the_slot_push_by_push() -> None:
    found = rrt.plan(PLACE, seed=3)
    pose = START[None].copy()
    for stroke in found.plan:
        assert np.sum(np.abs(np.diff(stroke, axis=0)) > 1e-12) == 1  # along one axis
        result = simulate(
            Push.straight(
                vertices=printed.PART.outline,
                poses=pose,
                tips=stroke[None, :1],
                travel=np.diff(stroke, axis=0)[None],
                friction=np.array([printed.TIP_FRICTION["p1*"]]),
                support=printed.three_points("p1*"),
                shapes=(Round(printed.TIP_RADIUS),),
                fixture=PLACE.fixture,
                step=1e-6,
            )
        )
        assert result.outcomes[0] == Outcome.COMPLETED
        pose = result.poses
    x, y, theta = pose[0]
    assert x < PLACE.mouth
    assert abs(y - PLACE.axis) < 76e-6
    assert abs(np.sin(theta)) < np.sin(np.deg2rad(5.0))
    assert len(found.plan) <= found.nodes - 1 <= found.iterations
    again = rrt.plan(PLACE, seed=3)
    assert all(np.array_equal(a, b) for a, b in zip(found.plan, again.plan, strict=True))


def test_a_search_cut_short_says_so() -> None:
    with pytest.raises(ValueError, match="no plan after 1 iterations"):
        rrt.plan(PLACE, seed=3, most=1)
