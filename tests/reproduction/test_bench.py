"""The bench of the baselines: frame, goal, errors and strokes, by hand and by symmetry."""

import numpy as np
import pytest

from meso_robust.reproduction import printed
from meso_robust.reproduction.baselines import (
    ALL,
    REPORTED,
    Errors,
    drawn,
    successes,
)
from meso_robust.reproduction.bench import (
    START,
    STARTS_INSIDE,
    Blend,
    Place,
    clock,
    corners,
    follow,
    nominal,
)
from meso_robust.simulator import Outcome

PLACE = Place()


def test_a_push_through_the_middle_on_the_film_moves_the_peg_by_what_is_left_of_the_travel() -> (
    None
):
    runs = nominal("film")
    runs.poses[0] = 2.33e-3, PLACE.axis, 0.5 * np.pi
    x = 2.33e-3 + 0.5 * 837e-6 + 12.5e-6 + 20e-6
    done = follow((np.array([[x, PLACE.axis], [x - 320e-6, PLACE.axis]]),), runs, PLACE)
    assert done.outcomes[0] == Outcome.COMPLETED
    assert done.poses[0] == pytest.approx([2.03e-3, PLACE.axis, 0.5 * np.pi], abs=1e-9)


def test_a_tip_that_comes_down_on_the_peg_ends_the_run() -> None:
    runs = nominal("p1*", 2)
    runs.tips[1, 0] = -30e-6
    x = 2.33e-3 + 0.5 * 837e-6 + 12.5e-6 + 25e-6
    done = follow((np.array([[x, -1.21e-3], [x - 30e-6, -1.21e-3]]),), runs, PLACE)
    assert done.outcomes.tolist() == [Outcome.COMPLETED, STARTS_INSIDE]
    assert done.poses[1] == pytest.approx(START)


def test_every_run_may_have_a_stroke_of_its_own() -> None:
    runs, x = nominal("film", 2), 2.81e-3
    way = np.array([[[x, -0.8e-3], [x - 200e-6, -0.8e-3]], [[x, -1.5e-3], [x - 300e-6, -1.5e-3]]])
    both = follow((way,), runs, PLACE, record=2)
    for k in range(2):
        alone = follow((way[k],), nominal("film"), PLACE, record=2)
        assert both.poses[k] == pytest.approx(alone.poses[0], abs=2e-6)  # steps differ
        assert both.paths[0][k, 0] == pytest.approx(START)
    assert both.poses[0, 2] > START[2] > both.poses[1, 2]  # pushed above and below the middle


def test_the_goal_is_behind_the_mouth_on_the_axis_either_end_ahead() -> None:
    pose = np.array([PLACE.mouth - 1e-6, PLACE.axis, np.pi])
    off = np.array(
        [[0, 0, 0], [0, 0, np.pi], [2e-6, 0, 0], [0, 77e-6, 0], [0, -75e-6, 0.08], [0, 0, 0.09]]
    )
    assert PLACE.holds(pose + off).tolist() == [True, True, False, False, True, False]


def test_the_corners_of_a_standing_peg() -> None:
    found = corners(np.array([[1e-3, 2e-3, 0.5 * np.pi]]))[0]
    assert found.min(axis=0) == pytest.approx([581.5e-6, 1.192e-3])
    assert found.max(axis=0) == pytest.approx([1418.5e-6, 2.808e-3])


def test_the_walls_are_clear_of_a_tip_in_the_slot_and_in_the_channel_only() -> None:
    m, a = PLACE.mouth, PLACE.axis
    tips = np.array([[m - 1e-3, a + 474e-6], [m - 1e-3, a + 475e-6], [m + 1e-3, a + 955e-6]])
    more = np.array([[m + 1e-3, a + 956e-6], [m + 12e-6, a + 600e-6], [m + 13e-6, a + 600e-6]])
    found = PLACE.clear(np.concatenate([tips, more])).tolist()
    assert found == [True, False, True, False, False, True]


def test_the_clock_runs_at_the_middle_speed() -> None:
    way = np.array([[0.0, 0.0], [75e-6, 0.0], [75e-6, 150e-6]])
    assert clock(way) == pytest.approx([0.0, 1.0, 3.0])


def test_a_blend_of_one_kind_is_that_kind_and_carries_the_whole_weight() -> None:
    for share, name in ((0.0, "p1*"), (1.0, "p2*")):
        own = Blend(np.array([share])).tables().points
        assert own == pytest.approx(printed.three_points(name).tables().points)
    half = Blend(np.array([0.25])).tables().points[0]
    assert half.shape == (6, 3)
    assert half[:, 2].sum() == pytest.approx(printed.SPEED)
    assert half[3:, 2].sum() == pytest.approx(0.25 * printed.SPEED)
    moment = (half[:, :2] * half[:, 2:]).sum(axis=0)
    assert moment == pytest.approx([0.0, 0.0], abs=1e-15)  # the weight stays on the centre


def test_draws_stay_in_their_ranges_and_starts_out_of_the_walls() -> None:
    runs = drawn(REPORTED, 400, np.random.default_rng(0), Place(axis=-1.1e-3))
    off = np.abs(runs.poses - START)
    assert np.all(off <= [26e-6, 74e-6, np.deg2rad(3.0)])
    assert np.all(off.max(axis=0) > [24e-6, 60e-6, np.deg2rad(2.5)])
    assert np.abs(runs.tips).max(axis=0) == pytest.approx([11e-6, 21e-6], rel=0.05)
    assert corners(runs.poses)[..., 1].min() > -1.1e-3 - 968e-6
    assert set(drawn(Errors(), 3, np.random.default_rng(0), PLACE).share) == {0.0}
    share = drawn(ALL, 200, np.random.default_rng(0), PLACE).share
    assert 0.0 < share.min() < 0.1 < 0.9 < share.max() < 1.0


def test_no_plan_at_all_never_succeeds() -> None:
    stay = np.array([[3.05e-3, -1.24e-3], [3.06e-3, -1.24e-3]])
    assert not successes((stay,), 4, ALL, np.random.default_rng(0)).any()
