"""Batches, records and repeatability."""

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.simulator import simulate
from meso_robust.simulator.batch import prepare, run_parallel, run_serial
from tests.simulator.problems import UM, one_point, two_sided


def test_serial_and_parallel_agree_to_the_last_bit() -> None:
    push = two_sided(np.linspace(840, 1100, 23) * UM, 1500 * UM, 2 * UM)
    results = []
    for kernel in (run_serial, run_parallel, run_parallel):
        inputs, outputs = prepare(push, 10)
        kernel(inputs, push.steps, True, outputs)
        results.append(outputs)
    for other in results[1:]:
        for a, b in zip(results[0], other, strict=True):
            np.testing.assert_array_equal(a, b)


def test_run_does_not_depend_on_its_neighbours() -> None:
    heights = np.array([850, 900, 1000]) * UM
    push = two_sided(heights, 900 * UM, 2 * UM)
    aside = np.array([[0, 0], [0, 100], [0, -200]]) * UM
    push = replace(
        push,
        travel=push.travel + aside[:, None] * [[0], [1]],
        friction=np.array([0.2, 0.3, 0.4]),
        film_ratio=np.array([0.3, 0.4, 0.5]) * 1e-6,
    )
    together = simulate(push, record=4)
    for i in range(3):
        arrays = ("poses", "tips", "travel", "friction", "film_ratio")
        one = replace(push, **{name: getattr(push, name)[i : i + 1] for name in arrays})
        one = replace(one, step=np.hypot(*one.travel[0, 1]) / push.steps)
        alone = simulate(one, record=4)
        assert alone.steps == together.steps
        np.testing.assert_array_equal(together.path[i], alone.path[0])


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
    assert result.steps == 0


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
