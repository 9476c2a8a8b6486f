"""Batches, records and repeatability."""

from dataclasses import fields
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.simulator import Film, Push, simulate
from tests.simulator.problems import UM, one_point, two_sided


def test_threads_agree_to_the_last_bit() -> None:
    push = two_sided(np.linspace(840, 1100, 23) * UM, 1500 * UM, 2 * UM)
    results = [simulate(push, record=10, workers=workers) for workers in (1, 2, 3, 2)]
    assert len(set(results[0].outcomes.tolist())) == 2
    for other in results[1:]:
        for item in fields(other):
            np.testing.assert_array_equal(getattr(results[0], item.name), getattr(other, item.name))


def test_run_does_not_depend_on_its_neighbours() -> None:
    heights = np.array([850, 900, 1000]) * UM
    plain = two_sided(heights, 900 * UM, 2 * UM)
    waypoints, ratio = plain.waypoints.copy(), np.array([0.3, 0.4, 0.5]) * 1e-6
    waypoints[:, 1, 1, 1] += np.array([0, 100, -200]) * UM
    friction = np.array([[0.2, 0.2], [0.3, 0.1], [0.4, 0.5]])

    def push(pick: slice, step: float) -> Push:
        return Push(
            vertices=plain.vertices,
            poses=plain.poses[pick],
            waypoints=waypoints[pick],
            times=plain.times[pick],
            friction=friction[pick],
            support=Film.ratio(ratio[pick]),
            step=step,
        )

    together = simulate(push(slice(None), 2 * UM), record=4)
    for i in range(3):
        way = waypoints[i, 1, 1] - waypoints[i, 0, 1]
        alone = simulate(push(slice(i, i + 1), np.hypot(*way) / together.steps), record=4)
        assert alone.steps == together.steps
        np.testing.assert_array_equal(together.path[i], alone.path[0])
        np.testing.assert_array_equal(together.forces[i], alone.forces[0])
        assert together.outcomes[i] == alone.outcomes[0]


def test_one_row_holds_for_all_runs() -> None:
    poses = np.array([[0, 0, np.pi / 2], [0, 5 * UM, np.pi / 2], [-3 * UM, 0, np.pi / 2]])
    one = one_point(0.0, 50 * UM, 1 * UM)
    common: dict[str, Any] = {
        "vertices": one.vertices,
        "poses": poses,
        "support": one.support,
        "step": one.step,
    }
    short = Push(waypoints=one.waypoints, times=one.times, friction=one.friction, **common)
    long = Push(
        waypoints=one.waypoints.repeat(3, axis=0),
        times=one.times.repeat(3, axis=0),
        friction=one.friction.repeat(3, axis=0),
        **common,
    )
    np.testing.assert_array_equal(simulate(short).poses, simulate(long).poses)
    assert len(np.unique(simulate(short).poses, axis=0)) == 3


def test_path_is_sampled_evenly() -> None:
    push = one_point(0.0, 100 * UM, 1 * UM)  # through the centre: a pure translation
    for record in (1, 7, 100, 250):
        result = simulate(push, record=record)
        assert result.path.shape == (1, record + 1, 3)
        expected = -np.linspace(0, 100 * UM, record + 1)
        np.testing.assert_allclose(result.path[0, :, 0], expected, atol=1e-12)
    assert simulate(push).path.shape == (1, 0, 3)
    assert simulate(push).steps == 100


def test_still_tips_leave_the_part_where_it_is() -> None:
    push = two_sided([900 * UM, 950 * UM], 0.0, 1 * UM)
    result = simulate(push, record=3)
    np.testing.assert_array_equal(result.poses, push.poses)
    np.testing.assert_array_equal(result.path, push.poses[:, None].repeat(4, axis=1))
    np.testing.assert_array_equal(result.forces, 0.0)


def test_no_runs() -> None:
    result = simulate(two_sided([], 100 * UM, 1 * UM), record=2)
    assert result.poses.shape == (0, 3)
    assert result.path.shape == (0, 3, 3)


def test_result_is_read_only() -> None:
    result = simulate(one_point(0.0, 10 * UM, 1 * UM))
    with pytest.raises(ValueError, match="read-only"):
        result.poses[0, 0] = 1.0


def test_negative_record_is_refused() -> None:
    with pytest.raises(ValueError, match="record: -1; must not be negative; give"):
        simulate(one_point(0.0, 10 * UM, 1 * UM), record=-1)


@pytest.mark.parametrize(
    ("instants", "message"),
    [
        (np.zeros(3), r"instants: shape \(3,\); must be \(1\|N, R\); reshape"),
        (np.zeros((2, 3)), r"instants: shape \(2, 3\); must be \(1\|N, R\)"),
        (np.array([[0.0, 0.0]]), r"instants: times that do not increase; must increase; sort"),
        (np.array([[0.0, 9.0]]), r"instants: a time outside the move; must lie within"),
        (np.array([[np.nan]]), r"instants: a time outside the move"),
    ],
)
def test_wrong_instants_are_refused(instants: npt.NDArray[np.float64], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        simulate(one_point(0.0, 10 * UM, 1 * UM), instants=instants)


@pytest.mark.parametrize("workers", [0, -1])
def test_no_threads_are_refused(workers: int) -> None:
    with pytest.raises(ValueError, match=f"workers: {workers}; must be at least 1; leave it out"):
        simulate(one_point(0.0, 10 * UM, 1 * UM), workers=workers)
