"""The guess of the modes changes the speed of a run, not its result."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from meso_robust.simulator import Outcome, Push, simulate
from meso_robust.simulator.tables import CONTACTS, MARKS
from tests.simulator.entries import advance, closes, guess_forces, is_solution
from tests.simulator.problems import UM, fill, one_point, random_rows, two_sided, workspace_of

F = npt.NDArray[np.float64]


def without_memory(push: Push) -> tuple[F, npt.NDArray[np.int8]]:
    """Poses and outcomes with every step a move of its own, which knows no modes of a last step."""
    poses, outcomes = push.poses, np.zeros(len(push.poses), dtype=np.int8)
    way = np.diff(push.waypoints, axis=1)
    for k in range(push.steps):
        ends = push.waypoints[:, :1] + way * np.array([k, k + 1])[:, None, None] / push.steps
        result = simulate(
            Push(
                vertices=push.vertices,
                poses=poses,
                waypoints=ends,
                times=np.array([[0.0, 1.0]]),
                friction=push.friction,
                support=push.support,
                frame="start",
                step=10
                * push.step,  # one step all the same; deep enough at the start for the last one
            )
        )
        outcomes = np.where(outcomes == 0, result.outcomes, outcomes)
        poses = np.where((outcomes == 0)[:, None], result.poses, poses)
    return poses, outcomes


def test_runs_with_and_without_guess_agree() -> None:
    for push in (
        two_sided(np.linspace(950, 1200, 9) * UM, 900 * UM, 3 * UM),
        one_point(350 * UM, 900 * UM, 3 * UM),
    ):
        # The angle of the middle is made with the last turn, which a move of its own does not know.
        warm = simulate(replace(push, frame="start"))
        poses, outcomes = without_memory(push)
        np.testing.assert_array_equal(warm.outcomes, outcomes)
        np.testing.assert_allclose(warm.poses, poses, rtol=0, atol=1e-11)


def test_modes_of_a_solution_give_its_forces_back() -> None:
    work = workspace_of(np.zeros((2, 8)), 0.5)
    seen = set()
    for rows in random_rows(300, 2, np.random.default_rng(2)):
        fill(work, rows, 0.5)
        if not closes(work.contacts, work.marks, work.step, 2):
            continue
        if advance(work, 2) == Outcome.COMPLETED:
            force, motion = (
                work.contacts[:, [CONTACTS.ln, CONTACTS.lt]].copy(),
                work.step[:3].copy(),
            )
            seen.update(work.marks[:2, MARKS.mode].tolist())
            assert guess_forces(work.contacts, work.marks, work.step, work.system, 2)
            assert is_solution(work.contacts, work.marks, work.step, 2)
            tight = 1e-9 * np.max(force, initial=1.0)
            np.testing.assert_allclose(
                work.contacts[:, [CONTACTS.ln, CONTACTS.lt]], force, atol=tight
            )
            np.testing.assert_allclose(work.step[:3], motion, atol=tight)
    assert seen == {0, 1, 2, 3}
