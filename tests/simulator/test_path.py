"""Waypoints and times, and what is recorded on the way."""

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.simulator import Film, Fixture, Outcome, Point, Push, Round, simulate
from tests.simulator.oracle import turned
from tests.simulator.problems import (
    HALF_SHORT,
    MU,
    RHO,
    UM,
    in_body,
    one_point,
    rectangle,
    two_sided,
)

F = npt.NDArray[np.float64]


def along(
    corners: list[list[float]], times: list[float], *, step: float = 1 * UM, mu: float = MU
) -> Push:
    """One probe by way of corners, µm."""
    return Push(
        vertices=rectangle(),
        poses=np.array([[0.0, 0.0, np.pi / 2]]),
        waypoints=np.array(corners)[None, :, None] * UM,
        times=np.array([times]),
        friction=np.array([[mu]]),
        support=Film.ratio(RHO),
        step=step,
    )


def test_push_back_and_push_again() -> None:
    """Push by 100, go round to the other side, push back by 40: by hand."""
    right, left = HALF_SHORT / UM, -HALF_SHORT / UM
    push = along(
        [[right, 0], [right - 100, 0], [right + 50, 0], [right + 50, 2e3], [left - 150, 2e3],
         [left - 150, 0], [left - 60, 0]],
        [0, 1, 2, 3, 4, 5, 6],
    )  # fmt: skip
    result = simulate(push, record=6)
    expected = np.array([0, -100, -100, -100, -100, -100, -60]) * UM
    np.testing.assert_allclose(result.path[0, :, 0], expected, atol=1e-12)
    np.testing.assert_allclose(result.path[0, :, 1:], np.tile([0, np.pi / 2], (7, 1)), atol=1e-12)
    np.testing.assert_array_equal(result.modes[0, :, 0] > 0, [1, 1, 0, 0, 0, 0, 1])
    assert push.steps == 100 + 150 + 2000 + round(2 * right + 200) + 2000 + 90


def test_sticking_tip_that_changes_direction_carries_its_point_along() -> None:
    push = along([[HALF_SHORT / UM, 100], [300, 120], [200, 60]], [0, 1, 2], step=0.25 * UM, mu=3.0)
    result = simulate(push, record=60)
    assert np.all(result.modes[0, :, 0] == 1)
    body = in_body(result.path[0], result.tips[0, :, 0])
    np.testing.assert_allclose(body, np.tile(body[0], (61, 1)), atol=0.1 * UM)
    assert np.ptp(result.path[0, :, 2]) > 0.02


@pytest.mark.parametrize("cut", [0.25, 0.5, 0.7])
def test_two_segments_of_a_line_are_one(cut: float) -> None:
    whole = one_point(200 * UM, 200 * UM, 1 * UM)
    start, end = whole.waypoints[0, 0, 0] / UM, whole.waypoints[0, 1, 0] / UM
    middle = start + cut * (end - start)
    split = along([list(start), list(middle), list(end)], [0.0, cut, 1.0])
    assert split.steps == whole.steps
    a, b = simulate(whole, record=20), simulate(split, record=20)
    assert a.poses[0, 2] > np.pi / 2 + 0.05
    np.testing.assert_allclose(a.path, b.path, rtol=0, atol=1e-12)


def test_speed_does_not_matter_on_a_film() -> None:
    results = []
    for speed in (7.4e-6, 75e-6, 140e-6):
        base = two_sided(np.array([900, 1000]) * UM, 900 * UM, 1 * UM)
        push = Push.straight(
            vertices=base.vertices,
            poses=base.poses,
            tips=base.waypoints[:, 0],
            travel=base.waypoints[:, 1] - base.waypoints[:, 0],
            friction=base.friction,
            film_ratio=RHO,
            step=base.step,
            speed=speed,
        )
        results.append(simulate(push, record=30))
    for other in results[1:]:
        np.testing.assert_allclose(other.path, results[0].path, rtol=0, atol=1e-12)
        np.testing.assert_array_equal(other.poses, results[0].poses)
        np.testing.assert_array_equal(other.modes, results[0].modes)
    # Forces are as the speeds.
    scale = 140 / 7.4
    np.testing.assert_allclose(results[2].forces, scale * results[0].forces, rtol=1e-9, atol=1e-12)


def test_uneven_times_do_not_matter_either() -> None:
    corners = [[HALF_SHORT / UM, 150.0], [300.0, 150.0], [200.0, 40.0]]
    a, b = simulate(along(corners, [0, 1, 2])), simulate(along(corners, [-3, 40, 40.001]))
    np.testing.assert_array_equal(a.poses, b.poses)


def test_record_is_taken_at_the_instants_that_are_asked_for() -> None:
    push = along(
        [[HALF_SHORT / UM, 0], [HALF_SHORT / UM - 100, 0], [HALF_SHORT / UM - 110, 0]], [1, 2, 7]
    )
    instants = np.array([[1.0, 1.25, 1.5017, 2.0, 4.5, 7.0]])
    result = simulate(push, instants=instants)
    np.testing.assert_array_equal(result.times, instants)
    expected = -np.array([0, 25, 50.17, 100, 105, 110]) * UM
    np.testing.assert_allclose(result.path[0, :, 0], expected, atol=1e-12)
    np.testing.assert_allclose(result.tips[0, :, 0, 0], HALF_SHORT + expected, atol=1e-12)
    # 100 µm/s in the first leg, 2 µm/s in the second, and the drag over e_x is the speed.
    forces = -np.array([100, 100, 100, 100, 2, 2]) * UM
    np.testing.assert_allclose(result.forces[0, :, 0, 0], forces, atol=1e-12)
    every = simulate(push, record=12)
    np.testing.assert_allclose(every.times[0], np.linspace(1, 7, 13))


def test_record_after_a_jam_repeats_the_last_pose_without_forces() -> None:
    push = two_sided([857 * UM], 1700 * UM, 1 * UM)
    result = simulate(push, record=170)
    assert result.outcomes[0] == Outcome.JAM
    still = np.all(result.path[0] == result.poses[0], axis=1)
    first = int(np.argmax(still))
    assert 50 < first < 160
    assert np.all(still[first:])
    np.testing.assert_array_equal(result.forces[0, first + 1 :], 0.0)
    np.testing.assert_array_equal(result.modes[0, first + 1 :], 0)
    assert np.ptp(result.tips[0, first + 1 :], axis=0).max() == 0.0


def rich() -> Push:
    """Two probes and a wall: point and disc of different friction."""
    wall = np.array([[-700, -1500], [-600, -1500], [-600, 1500], [-700, 1500]]) * UM
    return Push.straight(
        vertices=rectangle(),
        poses=np.array([[0.0, 0.0, np.pi / 2]]),
        tips=np.array([[[HALF_SHORT, 500 * UM], [-HALF_SHORT - 40 * UM, -300 * UM]]]),
        travel=np.array([[[-260 * UM, 60 * UM], [0.0, 0.0]]]),
        friction=np.array([[0.1, 0.5]]),
        film_ratio=RHO,
        shapes=(Point(), Round(40 * UM)),
        fixture=Fixture((wall,), 0.2),
        step=0.25 * UM,
        frame="start",
    )


def test_forces_balance_the_film_and_lie_in_their_cones() -> None:
    push = rich()
    result = simulate(push, record=push.steps)
    path, dt = result.path[0], result.times[0, 1]
    free = result.fixture_modes[0] == 0
    assert np.sum(free[1:]) > 100
    v = np.diff(path, axis=0) / dt
    f = result.forces[0, 1:]
    normal = np.column_stack([np.sin(path[:-1, 2]), -np.cos(path[:-1, 2])])  # of the right face
    side = np.column_stack([np.cos(path[:-1, 2]), np.sin(path[:-1, 2])])
    tips = result.tips[0, :-1]
    arms = tips - path[:-1, None, :2]
    arms[:, 1] += 40 * UM * normal  # the disc touches the left face
    torque = np.sum(arms[..., 0] * f[..., 1] - arms[..., 1] * f[..., 0], axis=1)
    balanced = free[1:]
    speed = np.abs(f).max()
    np.testing.assert_allclose(f.sum(axis=1)[balanced], v[balanced, :2], atol=1e-9 * speed)
    np.testing.assert_allclose(
        torque[balanced], RHO * v[balanced, 2], atol=1e-6 * speed * HALF_SHORT
    )
    for p, (mu, inward) in enumerate(((0.1, -normal), (0.5, normal))):
        press = np.sum(f[:, p] * inward, axis=1)
        assert np.all(press >= -1e-9 * speed)
        assert np.all(np.abs(np.sum(f[:, p] * side, axis=1)) <= mu * press + 1e-9 * speed)
        assert np.sum(press > 1e-3 * speed) > 100


def test_modes_agree_with_the_slip_along_the_path() -> None:
    push = rich()
    result = simulate(push, record=push.steps)
    seen = set()
    for p, face in ((0, -1.0), (1, 1.0)):  # the faces are y = ∓ half the width, body frame
        for k in range(1, push.steps + 1):
            before, after = result.path[0, k - 1], result.path[0, k]
            back = turned(-before[2])
            tip_way = back @ (result.tips[0, k, p] - result.tips[0, k - 1, p])
            way, turn = back @ (after[:2] - before[:2]), after[2] - before[2]
            slip = way[0] - turn * face * HALF_SHORT - tip_way[0]  # of the part, along x
            mode = int(result.modes[0, k, p])
            seen.add((p, mode))
            t = face  # inward is −y for the upper face, which turned by +90° is +x
            if mode == 1:
                assert abs(slip) < 2e-6 * push.step
            elif mode:
                assert (slip * t < 0) == (mode == 2)
    assert len([pair for pair in seen if pair[1] > 1]) >= 2
