"""Recordings of simulated motion: what is written is what was simulated, as seen."""

from pathlib import Path

import numpy as np
import pytest

from meso_robust.laboratory.filming import Camera, film, film_plan
from meso_robust.laboratory.simulation import player_of, simulated
from meso_robust.planning.reading import read_plan
from meso_robust.primitives.setup import setup_of
from meso_robust.recordings import read_set, write_set
from meso_robust.simulator import Effects, Film, Push, exact
from meso_robust.simulator.observation import Sensor
from meso_robust.task import load_task
from meso_robust.tasks import PAPER

UM = 1e-6
ROOT = Path(__file__).parents[2]
QUIET = Sensor(position_sigma=0.0, orientation_sigma=0.0, frame_rate=30.0)


def one_push(effects: Effects | None = None, runs: int = 1) -> Push:
    half = np.array([418.5, 808.0]) * UM
    return Push.straight(
        vertices=half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]),
        poses=np.zeros((runs, 3)),
        tips=np.tile([[[half[0], 150 * UM]]], (runs, 1, 1)),
        travel=np.tile([[[-150 * UM, 0.0]]], (runs, 1, 1)),
        friction=np.full(runs, 0.4),
        support=Film.ratio(0.3769e-6),
        effects=Effects() if effects is None else effects,
        step=0.5 * UM,
        speed=75 * UM,
    )


def test_a_quiet_camera_sees_the_true_path_at_30_frames_a_second() -> None:
    _, seen = film(one_push(), Camera(sensor=QUIET, effects=Effects()), np.random.default_rng(0))
    (recording,) = seen.recordings
    np.testing.assert_allclose(recording.times, np.arange(61) / 30.0, atol=1e-12)
    # The path from the other engine; the tip goes 2.5 um a frame.
    truth = exact(one_push(), samples=60).path[0]
    assert np.all(np.abs(recording.poses - truth) < [1e-9, 1e-9, 1e-7])
    np.testing.assert_allclose(np.diff(recording.probes[:, 0, 0]), -2.5 * UM, atol=1e-12)


def test_latency_of_the_push_shows_in_the_frames_but_not_in_the_controller() -> None:
    late = Effects({"camera_latency": {"time_ms": 100.0}})
    camera = Camera(sensor=QUIET, effects=Effects())
    _, plain = film(one_push(), camera, np.random.default_rng(0))
    _, seen = film(one_push(late), camera, np.random.default_rng(0))
    np.testing.assert_allclose(
        seen.recordings[0].poses[3:], plain.recordings[0].poses[:-3], atol=1e-12
    )
    np.testing.assert_array_equal(seen.recordings[0].probes, plain.recordings[0].probes)


def test_a_camera_that_sees_the_tips_sees_lost_motion_and_the_controller_does_not() -> None:
    loose = Effects({"backlash": {"width_um": 6.0}})
    rng = np.random.default_rng(0)
    _, seen = film(one_push(loose), Camera(sensor=QUIET, effects=Effects(), source="camera"), rng)
    _, commanded = film(one_push(loose), Camera(sensor=QUIET, effects=Effects()), rng)
    behind = seen.recordings[0].probes[-1, 0, 0] - commanded.recordings[0].probes[-1, 0, 0]
    assert behind == pytest.approx(3 * UM, abs=1e-10)


def test_lost_frames_and_noise_are_as_asked() -> None:
    sensor = Sensor(position_sigma=1.2 * UM, orientation_sigma=1e-3, frame_rate=30.0, dropout=0.2)
    _, seen = film(
        one_push(runs=40), Camera(sensor=sensor, effects=Effects()), np.random.default_rng(5)
    )
    kept = sum(len(recording.times) for recording in seen.recordings)
    assert kept / (40 * 61) == pytest.approx(0.8, abs=0.04)
    truth = exact(one_push(), samples=60).path[0]
    miss = [
        recording.poses - truth[np.rint(recording.times * 30).astype(int)]
        for recording in seen.recordings
    ]
    sigma = np.concatenate(miss).std(axis=0)
    np.testing.assert_allclose(sigma, [1.2 * UM, 1.2 * UM, 1e-3], rtol=0.08)


def test_runs_of_different_length_are_not_filmed_together() -> None:
    push = one_push(runs=2)
    times = push.times * [[1.0], [2.0]]
    different = Push(
        vertices=push.vertices,
        poses=push.poses,
        waypoints=push.waypoints,
        times=times,
        friction=push.friction,
        support=push.support,
        step=push.step,
    )
    with pytest.raises(ValueError, match="must be the same for all runs"):
        film(different, Camera(sensor=QUIET, effects=Effects()), np.random.default_rng(0))


def test_a_plan_is_recorded_move_by_move_and_comes_back_from_disk(tmp_path: Path) -> None:
    task = load_task(PAPER)
    plan = read_plan(ROOT / "reports" / "paper_task" / "plan.json", task)
    player = player_of(plan, setup_of(task))
    found = simulated(task, plan, player, samples=3, seed=1)
    seen = film_plan(found, Camera(sensor=QUIET, effects=Effects()), np.random.default_rng(0), 2)
    assert [r.file for r in seen.recordings[:4]] == [f"run_00_move_{k}.csv" for k in (1, 2, 3, 4)]
    assert len(seen.recordings) == 8
    write_set(tmp_path, seen)
    back = read_set(tmp_path)
    for move, recording in zip(found.nominal.runs.moves, back.recordings[:4], strict=True):
        np.testing.assert_allclose(recording.poses[0], move.before[0], atol=1e-10)
        np.testing.assert_allclose(recording.probes[0], move.tips[0], atol=1e-10)
        # The last frame comes less than a frame before the end of the move.
        assert np.all(np.abs(recording.poses[-1] - move.after[0]) < [3 * UM, 3 * UM, 0.01])
