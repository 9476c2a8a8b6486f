"""The guess of the modes changes the speed of a run, not its result."""

import numpy as np

from meso_robust.simulator import Outcome
from meso_robust.simulator.batch import prepare, run_serial
from meso_robust.simulator.guess import guess_forces
from meso_robust.simulator.rows import is_solution, workspace
from meso_robust.simulator.stepping import _advance
from tests.simulator.problems import UM, one_point, random_rows, two_sided


def test_runs_with_and_without_guess_agree() -> None:
    for push in (
        two_sided(np.linspace(850, 1200, 15) * UM, 1600 * UM, 2 * UM),
        one_point(350 * UM, 900 * UM, 2 * UM),
    ):
        results = []
        for warm in (True, False):
            inputs, outputs = prepare(push, 100)
            run_serial(inputs, push.steps, warm, outputs)
            results.append(outputs)
        np.testing.assert_allclose(results[0].path, results[1].path, rtol=0, atol=1e-11)
        np.testing.assert_array_equal(results[0].outcomes, results[1].outcomes)


def test_modes_of_a_solution_give_its_forces_back() -> None:
    work, system = workspace(2), np.zeros((9, 3))
    seen = set()
    for rows in random_rows(300, 2, np.random.default_rng(2)):
        work.rows[:] = rows
        closing = np.min(rows[:, 0]) < 0
        if closing and _advance(work, 0.5, False, system) == Outcome.COMPLETED:
            force, motion = work.force.copy(), work.motion.copy()
            seen.update(work.modes.tolist())
            assert guess_forces(work, 0.5, system)
            assert is_solution(work, 0.5)
            np.testing.assert_allclose(work.force, force, atol=1e-9 * np.max(force, initial=1.0))
            np.testing.assert_allclose(work.motion, motion, atol=1e-9 * np.max(force, initial=1.0))
    assert seen == {0, 1, 2, 3}
