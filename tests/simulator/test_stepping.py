"""Whole runs against closed forms of quasi-static pushing."""

from dataclasses import replace
from typing import Literal

import numpy as np
import numpy.typing as npt
import pytest
from scipy.optimize import brentq

from meso_robust.simulator import Outcome, Push, PushResult, simulate
from meso_robust.simulator.tables import CONTACTS
from tests.simulator.entries import advance, closes
from tests.simulator.problems import (
    HALF_SHORT,
    MU,
    RHO,
    UM,
    WIDTH,
    contact_problems,
    fill,
    in_body,
    one_point,
    random_rows,
    rectangle,
    some_mode_holds,
    two_sided,
    workspace_of,
)

F = npt.NDArray[np.float64]


def sticking_angle(d2: float, travel: float) -> float:
    """Angle after sticking contact: integral of dθ/dξ = r_y/(ρ + R²)."""
    R, delta = np.hypot(HALF_SHORT, d2), np.arctan2(HALF_SHORT, d2)
    growth = np.exp(R * travel / (RHO + R**2))
    return float(delta + 2 * np.arctan(np.tan((np.pi / 2 - delta) / 2) * growth))


def contact_in_body(push: Push, result: PushResult, tip: int = 0) -> F:
    return in_body(result.path[0], on_the_way(push, result.path.shape[1], tip))


def on_the_way(push: Push, instants: int, tip: int = 0) -> F:
    """Where a tip should be, evenly spaced in time."""
    start, end = push.waypoints[0, :, tip]
    return np.asarray(start + np.linspace(0, 1, instants)[:, None] * (end - start))


@pytest.mark.parametrize("frame", ["start", "middle"])
def test_sticking_point_turns_the_part_by_the_closed_form(
    frame: Literal["middle", "start"],
) -> None:
    exact = sticking_angle(200 * UM, 300 * UM)
    errors = []
    for step in (1.0 * UM, 0.5 * UM, 0.25 * UM):
        push = replace(one_point(200 * UM, 300 * UM, step), frame=frame)
        result = simulate(push, record=300)
        assert result.outcomes[0] == Outcome.COMPLETED
        body = contact_in_body(push, result)
        np.testing.assert_allclose(body, np.tile([200 * UM, -HALF_SHORT], (301, 1)), atol=step / 2)
        errors.append(abs(result.poses[0, 2] - exact))
    assert errors[0] < np.radians(0.02)
    # Displacements about the middle of the step: of the second order, at its start: of the first.
    ratio = 4 if frame == "middle" else 2
    assert errors[0] / errors[1] == pytest.approx(ratio, abs=0.1)
    assert errors[1] / errors[2] == pytest.approx(ratio, abs=0.1)


def test_contact_starts_to_slip_where_the_force_leaves_the_cone() -> None:
    d2 = 350 * UM

    def friction_needed(theta: float) -> float:
        a = np.array([np.cos(theta), np.sin(theta)])
        n = np.array([np.sin(theta), -np.cos(theta)])
        r = d2 * a + HALF_SHORT * n
        turn = r[1] / (RHO + r @ r)
        force = np.array([-1 + turn * r[1], -turn * r[0]])  # equal to the velocity of the centre
        return float(abs(force @ a) / -(force @ n))

    expected = np.degrees(brentq(lambda th: friction_needed(th) - MU, np.pi / 2, np.radians(140)))
    assert expected == pytest.approx(120.96, abs=0.01)
    push = one_point(d2, 900 * UM, 0.1 * UM)
    result = simulate(push, record=9000)
    body = contact_in_body(push, result)
    moved = np.abs(np.diff(body[:, 0])) > 1e-3 * push.step
    onset = np.degrees(result.path[0, np.flatnonzero(moved)[0], 2])
    assert onset == pytest.approx(expected, abs=0.3)
    assert np.all(moved[np.flatnonzero(moved)[0] :])


def test_sliding_contact_force_lies_on_the_cone_and_balances_the_film() -> None:
    push = replace(one_point(700 * UM, 400 * UM, 0.1 * UM, mu=0.1), frame="start")
    path = simulate(push, record=4000).path[0]
    # The film answers a velocity v, ω with the force v and the torque ρ ω about the centre.
    v, turn = np.diff(path[:, :2], axis=0), np.diff(path[:, 2])
    tip = on_the_way(push, 4001)
    r = (tip - path[:, :2])[:-1]
    np.testing.assert_allclose(r[:, 0] * v[:, 1] - r[:, 1] * v[:, 0], RHO * turn, atol=1e-17)
    a = np.column_stack([np.cos(path[:-1, 2]), np.sin(path[:-1, 2])])
    n = np.column_stack([a[:, 1], -a[:, 0]])
    along, inward = np.sum(v * a, axis=1), -np.sum(v * n, axis=1)
    slip = np.diff(in_body(path, tip)[:, 0])
    sliding = np.abs(slip) > 1e-3 * push.step
    assert np.sum(sliding) > 1000
    # Friction drags the part the way the tip goes along the edge, and at rest it is less.
    ratio = along / inward
    np.testing.assert_allclose(ratio[sliding], 0.1 * np.sign(slip[sliding]), rtol=1e-9)
    assert np.all(np.abs(ratio[~sliding]) < 0.1 * (1 + 1e-9))


@pytest.mark.parametrize("mu", [0.0, 0.33])
def test_two_tips_on_one_edge_translate_the_part(mu: float) -> None:
    gap = 1 * UM
    push = Push.straight(
        vertices=rectangle(),
        poses=np.array([[0.0, 0.0, np.pi / 2]]),
        tips=np.array([[[HALF_SHORT + gap, 250 * UM], [HALF_SHORT + gap, -400 * UM]]]),
        travel=np.tile([-950 * UM, 0.0], (1, 2, 1)),
        friction=np.array([mu]),
        film_ratio=np.array([RHO]),
        step=0.7 * UM,
    )
    result = simulate(push)
    assert result.outcomes[0] == Outcome.COMPLETED
    np.testing.assert_allclose(result.poses[0], [-949 * UM, 0, np.pi / 2], atol=1e-13)
    assert result.max_penetration[0] < 1e-15


@pytest.mark.parametrize("travel", [300 * UM, 800 * UM, 1200 * UM, 1700 * UM])
def test_two_sided_rotation_is_kinematic(travel: float) -> None:
    # A longer part, for both tips to stay on its edges to the end of the longest move.
    V = 930 * UM
    result = simulate(two_sided([V], travel, 0.5 * UM, half_long=1200 * UM))
    base = WIDTH - travel
    expected = np.arctan2(V, base) + np.arcsin(WIDTH / np.hypot(base, V))
    assert result.outcomes[0] == Outcome.COMPLETED
    assert np.degrees(result.poses[0, 2]) == pytest.approx(np.degrees(expected), abs=2e-4)
    assert result.max_penetration[0] < 1e-3 * UM


def test_tip_leaves_the_end_of_an_edge_without_a_jam() -> None:
    push = two_sided([930 * UM], 1700 * UM, 1 * UM)
    result = simulate(push, record=1700)
    along = contact_in_body(push, result, tip=1)[:, 0]
    angle = result.path[0, :, 2]
    assert result.outcomes[0] == Outcome.COMPLETED
    assert along[-1] > 900 * UM
    # Nothing turns the part once the tip is past the end, give or take the corner.
    assert np.ptp(angle[along > 820 * UM]) == 0.0
    assert np.all(np.diff(angle[along < 805 * UM]) > 0)


@pytest.mark.parametrize("height", [820 * UM, 857 * UM, 875 * UM])
def test_two_sided_push_jams_where_the_line_of_the_tips_enters_both_cones(height: float) -> None:
    # Both cones hold the line through the tips once these are nearer than w √(1 + μ²).
    base = np.sqrt(WIDTH**2 * (1 + MU**2) - height**2)
    expected = np.arctan2(height, base) + np.arcsin(WIDTH / np.hypot(base, height))
    push = two_sided([height], 1700 * UM, 0.5 * UM)
    result = simulate(push, record=1700)
    assert result.outcomes[0] == Outcome.JAM
    assert np.degrees(result.poses[0, 2]) == pytest.approx(np.degrees(expected), abs=0.15)
    if height == 857 * UM:
        assert np.degrees(result.poses[0, 2]) == pytest.approx(148, abs=0.5)
    jammed = int((WIDTH - base) / UM)
    for pose in result.path[0, jammed + 2 :]:
        np.testing.assert_array_equal(pose, result.poses[0])


def test_jam_gives_way_at_the_critical_height() -> None:
    low, high = 860 * UM, 900 * UM
    for _ in range(3):
        heights = np.linspace(low, high, 9)
        jams = simulate(two_sided(heights, 1400 * UM, 1 * UM)).outcomes == Outcome.JAM
        assert jams[0]
        assert not jams[-1]
        flip = int(np.argmin(jams))
        assert np.all(jams[:flip])
        assert not np.any(jams[flip:])
        low, high = heights[flip - 1], heights[flip]
    assert (low + high) / 2 == pytest.approx(WIDTH * np.sqrt(1 + MU**2), abs=0.5 * UM)


def test_mirrored_push_has_the_mirrored_path() -> None:
    vertices = np.array([[-700, -400], [650, -450], [800, 300], [-500, 420]]) * UM
    push = Push.straight(
        vertices=vertices,
        poses=np.array([[10 * UM, -20 * UM, 0.3]]),
        tips=np.array([[[300, -700], [-700, 800]]]) * UM,
        travel=np.array([[[50, 900], [0, 0]]]) * UM,
        friction=np.array([0.3]),
        film_ratio=np.array([RHO]),
        step=1 * UM,
    )
    flip = np.array([-1.0, 1.0])
    mirrored = Push.straight(
        vertices=(vertices * flip)[::-1],
        poses=push.poses * [-1, 1, -1],
        tips=push.waypoints[:, 0] * flip,
        travel=np.diff(push.waypoints, axis=1)[:, 0] * flip,
        friction=push.friction,
        film_ratio=RHO,
        step=push.step,
    )
    path = simulate(push, record=50).path[0]
    image = simulate(mirrored, record=50).path[0]
    assert np.ptp(path[:, 2]) > 0.1
    np.testing.assert_allclose(image * [-1, 1, -1], path, atol=1e-11)


def test_scaled_push_has_the_scaled_path() -> None:
    small = two_sided([930 * UM], 1200 * UM, 1 * UM)
    large = Push.straight(
        vertices=2 * small.vertices,
        poses=small.poses,
        tips=2 * small.waypoints[:, 0],
        travel=2 * np.diff(small.waypoints, axis=1)[:, 0],
        friction=small.friction,
        film_ratio=4 * RHO,
        step=2 * small.step,
    )
    path = simulate(small, record=20).path[0]
    np.testing.assert_allclose(
        simulate(large, record=20).path[0] / [2, 2, 1], path, rtol=1e-10, atol=1e-14
    )


def test_free_motion_leaves_the_part_alone() -> None:
    push = one_point(0.0, -500 * UM, 5 * UM)  # away from the part
    result = simulate(push)
    np.testing.assert_array_equal(result.poses, push.poses)
    assert result.outcomes[0] == Outcome.COMPLETED


def test_too_large_a_turn_is_out_of_range() -> None:
    result = simulate(one_point(350 * UM, 800 * UM, 400 * UM))
    assert result.outcomes[0] == Outcome.OUT_OF_RANGE
    np.testing.assert_array_equal(result.poses[0], [0, 0, np.pi / 2])


def test_tip_at_a_distance_that_overflows_leaves_the_part_alone() -> None:
    push = one_point(200 * UM, 300 * UM, 1 * UM)
    far = Push.straight(
        vertices=push.vertices,
        poses=push.poses,
        tips=np.array([[[1e308, 1e308]]]),
        travel=np.array([[[-300 * UM, 0.0]]]),
        friction=push.friction,
        film_ratio=RHO,
        step=push.step,
    )
    result = simulate(far)
    assert result.outcomes[0] in (Outcome.COMPLETED, Outcome.OUT_OF_RANGE)
    np.testing.assert_array_equal(result.poses, push.poses)


def test_no_step_with_a_motion_is_given_up() -> None:
    # Three random contacts; on a few such problems Lemke's pivots miss the solution there is.
    rows = random_rows(2000, 3, np.random.default_rng(1))
    M, q = contact_problems(rows, np.full(2000, 0.9))
    work = workspace_of(rows[0], 0.9)
    jams = 0
    for i, case in enumerate(rows):
        fill(work, case, 0.9)
        if not closes(work.contacts, work.marks, work.step, 3):
            continue
        outcome = advance(work, 3)
        assert outcome in (Outcome.COMPLETED, Outcome.JAM)
        if outcome == Outcome.JAM:
            jams += 1
            assert not some_mode_holds(12, M[i], q[i])
    assert jams > 50


def test_far_contact_that_closes_in_the_step_is_not_left_out() -> None:
    # The part moves by more than the tips, through a lever, and meets a tip five steps away.
    work = workspace_of(np.zeros((2, 8)), 0.3)
    met = 0
    for rows in random_rows(500, 2, np.random.default_rng(4)):
        rows[:, 0] = [-8.0, 5.0]
        fill(work, rows, 0.3)
        if advance(work, 2) == Outcome.COMPLETED:
            normal = rows[1, 0] + rows[1, 2:5] @ work.step[:3]
            assert normal > -1e-7
            met += work.contacts[1, CONTACTS.ln] > 1e-6
        else:
            M, q = contact_problems(rows[None], np.full(1, 0.3))
            assert not some_mode_holds(8, M[0], q[0])
    assert met > 20
