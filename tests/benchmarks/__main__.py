"""Speed of the simulator on one core: ``python -m tests.benchmarks``.

Prints a small table. It is no test: it asserts nothing about time.
"""

import platform
import sys
import time
from collections.abc import Callable
from importlib.metadata import version

import numpy as np
import numpy.typing as npt
from numba import njit

from meso_robust.simulator import Push
from meso_robust.simulator.batch import prepare, run_serial
from meso_robust.simulator.lemke import SOLVED, lemke
from tests.simulator.problems import UM, contact_problems, random_rows, two_sided

F = npt.NDArray[np.float64]
I = npt.NDArray[np.int64]  # noqa: E741

REPEATS = 7


@njit
def solve_all(M: F, q: F, status: I) -> None:
    """Lemke's method on every problem, one after the other."""
    n = q.shape[1]
    z = np.zeros(n)
    tableau = np.zeros((n + 3, n))
    index = np.zeros(4 * n + 2, np.int64)
    for i in range(q.shape[0]):
        status[i] = lemke(n, M[i], q[i], z, tableau, index)


def best_time(work: Callable[[], None]) -> float:
    """Shortest of a few times in s, the first call (which may compile) left out."""
    work()
    times = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def steps_per_second(push: Push, warm: bool) -> float:
    """Steps of both tips in contact, all of each step included."""

    def work() -> None:
        inputs, outputs = prepare(push)
        run_serial(inputs, push.steps, warm, outputs)

    return len(push.poses) * push.steps / best_time(work)


def lemke_solves(contacts: int, count: int = 20_000) -> tuple[float, float]:
    """Solves per second of the solvable problems with a closing gap, and their share."""
    rng = np.random.default_rng(0)
    rows = random_rows(count, contacts, rng)
    rows = rows[np.min(rows[..., 0], axis=1) < 0]
    M, q = contact_problems(rows, rng.uniform(0, 1, len(rows)))
    status = np.zeros(len(q), dtype=np.int64)
    solve_all(M, q, status)
    solved = status == SOLVED
    some = np.flatnonzero(solved)[:2000]  # small enough for the cache, as in a run
    M, q = M[some], q[some]

    def work() -> None:
        for _ in range(20):
            solve_all(M, q, status)

    return 20 * len(some) / best_time(work), float(np.mean(solved))


def main() -> None:
    """Print the table."""
    # Both tips stay on the part, without a jam, over the whole of this move.
    push = two_sided(np.linspace(900, 1300, 200) * UM, 1000 * UM, 0.5 * UM)
    lines = [
        ("two-contact steps, modes guessed first", steps_per_second(push, warm=True), ""),
        ("two-contact steps, Lemke's method only", steps_per_second(push, warm=False), ""),
    ]
    for contacts in (1, 2, 3):
        speed, share = lemke_solves(contacts)
        name = f"Lemke's method, n = {4 * contacts}, random contacts"
        lines.append((name, speed, f"{100 * share:.1f} % solved"))
    sys.stdout.write(
        f"one core of {platform.machine()}, Python {platform.python_version()}, "
        f"numba {version('numba')}, meso-robust {version('meso-robust')}; best of several runs\n"
    )
    for name, speed, note in lines:
        sys.stdout.write(f"{name:<42}{speed / 1e6:7.2f} M/s  {note}\n")


if __name__ == "__main__":
    main()
