"""Complementarity problems per second: Lemke's method of the package and of QuantEcon."""

from collections.abc import Callable
from importlib import import_module
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
from numba import njit

from meso_robust.simulator.lemke import SOLVED, lemke
from meso_robust.simulator.modes import FOUND, NONE, new_walk, next_mode
from reports.benchmarks.timing import best_of, number, reached, table
from tests.simulator.problems import contact_problems, random_rows

F = npt.NDArray[np.float64]
I = npt.NDArray[np.int64]  # noqa: E741

Solver: TypeAlias = Callable[[F, F, F, int], None]
"""Takes matrices (K, n, n), vectors (K, n), solutions (K, n) to fill, and how often to do it."""

COUNT = 500
"""Problems that are timed: few enough for the cache, as in a run."""
WALKS = 200
"""Problems whose contact modes are all tried."""
_SIZES = (4, 8, 12, 24)
_TARGETS = {8: 2e6, 24: 1.7e5}
_FAIL = np.inf
_RESIDUAL = 1e-7


@njit
def solve_all(M: F, q: F, z: F, rounds: int) -> None:
    """Lemke's method of the package on every problem, one after the other."""
    n = q.shape[1]
    tableau = np.zeros((n + 3, n))
    index = np.zeros(4 * n + 2, np.int64)
    for _ in range(rounds):
        for i in range(q.shape[0]):
            if lemke(n, M[i], q[i], z[i], tableau, index) != SOLVED:
                z[i, 0] = _FAIL


@njit
def walk_all(M: F, q: F, found: I) -> None:
    """Try contact modes of every problem until one holds, or all."""
    n = q.shape[1]
    z = np.zeros(n)
    for i in range(q.shape[0]):
        found[i] = next_mode(n, M[i], q[i], z, new_walk(n))


def quantecon_solver() -> Solver:
    """Lemke's method of QuantEcon in a compiled loop, its workspace allocated once.

    Raises
    ------
    ImportError
        If QuantEcon is not installed.
    """
    lcp_lemke = import_module("quantecon.optimize.lcp_lemke").lcp_lemke

    @njit
    def solve(M: F, q: F, z: F, rounds: int) -> None:
        n = q.shape[1]
        d = np.ones(n)
        tableau = np.zeros((n, 2 * n + 2))
        basis = np.zeros(n, np.int64)
        for _ in range(rounds):
            for i in range(q.shape[0]):
                # One expression a call: the workspace arrays are its, the solution ours.
                result = lcp_lemke(M[i], q[i], d=d, tableau=tableau, basis=basis, z=z[i])
                if not result.success:
                    z[i, 0] = _FAIL

    return solve


def solvable(n: int, count: int = COUNT, seed: int = 0) -> tuple[F, F]:
    """Contact problems of a part that is drawn along while all obstacles rest.

    Such problems have a solution (Stewart and Trinkle 1996): with the free motion s and gaps g ≥ 0,
    q_n = g + w_n s and q_t = w_t s. At least one gap would close.
    """
    rng = np.random.default_rng(seed)
    rows = random_rows(8 * count, n // 4, rng)
    free = rng.normal(size=(len(rows), 1, 3))
    gap = rng.uniform(0.0, 0.3, rows.shape[:2])
    rows[..., 0] = gap + np.sum(rows[..., 2:5] * free, axis=2)
    rows[..., 1] = np.sum(rows[..., 5:8] * free, axis=2)
    rows = rows[np.min(rows[..., 0], axis=1) < 0][:count]
    return contact_problems(rows, rng.uniform(0.0, 1.0, len(rows)))


def prescribed(n: int, count: int = COUNT, seed: int = 0) -> tuple[F, F]:
    """Contact problems with any velocity prescribed at every contact; many of them jam."""
    rng = np.random.default_rng(seed)
    rows = random_rows(8 * count, n // 4, rng)
    rows = rows[np.min(rows[..., 0], axis=1) < 0][:count]
    return contact_problems(rows, rng.uniform(0.0, 1.0, len(rows)))


def share_solved(M: F, q: F, z: F) -> float:
    """Share of the problems whose solution holds: z ≥ 0, w ≥ 0 and z · w = 0."""
    w = q + np.einsum("kij,kj->ki", M, np.where(np.isfinite(z), z, 0.0))
    worst = np.max(np.maximum(np.maximum(-z, -w), np.minimum(z, w)), axis=1)
    size = np.maximum(1.0, np.max(np.where(np.isfinite(z), z, 0.0), axis=1))
    return float(np.mean(worst <= _RESIDUAL * size))


def _speed(name: str, solver: Solver, n: int, target: float | None) -> tuple[str, ...]:
    """Time a solver on solvable problems."""
    M, q = solvable(n)
    z = np.zeros(q.shape)
    rounds = max(1, 2400 // n**2)
    clock = best_of(lambda: solver(M, q, z, rounds), 40)
    share = share_solved(M, q, z)
    solves = rounds * len(q)
    goal, met = reached(solves / clock.cpu, target) if target else ("", "")
    met = "NO" if target and share < 1.0 else met
    speeds = (number(solves / clock.cpu), number(solves / clock.wall))
    return name, str(n), *speeds, f"{100 * share:.1f} %", goal, met


def _fates(n: int) -> tuple[str, ...]:
    """What becomes of problems with prescribed velocities."""
    M, q = prescribed(n, WALKS)
    z = np.zeros(q.shape)
    solve_all(M, q, z, 1)
    solved = np.isfinite(z[:, 0])
    found = np.zeros(len(q), dtype=np.int64)
    walk_all(M, q, found)
    shares = (
        share_solved(M, q, z),
        np.mean(~solved & (found == FOUND)),
        np.mean(~solved & (found == NONE)),
        np.mean(~solved & (found != FOUND) & (found != NONE)),
        np.mean(solved & (found == NONE)),
    )
    return str(n), str(len(q)), *(f"{100 * share:.1f} %" for share in shares)


def section(peers: bool) -> list[str]:
    """Lines of this part of the report."""
    rows = [_speed("meso-robust", solve_all, n, _TARGETS.get(n)) for n in _SIZES]
    if peers:
        try:
            solver = quantecon_solver()
        except ImportError:
            rows.append(("quantecon", "not installed", "", "", "", "", ""))
        else:
            rows += [_speed("quantecon", solver, n, None) for n in (8, 24)]
    heads: tuple[str, ...] = ("Lemke's method", "n", "solves/s (CPU time)", "solves/s (wall clock)")
    heads += ("solved", "target", "reached")
    lines = table("Random contact problems that have a solution", heads, rows)
    lines += ["Every solution is checked afterwards: z ≥ 0, w ≥ 0 and z · w = 0.", ""]
    heads = ("n", "problems", "solved by Lemke's method", "solved by another contact mode")
    heads += ("proved unsolvable", "undecided", "contradictions")
    fates = [_fates(n) for n in _SIZES]
    return lines + table("Random contact problems with prescribed velocities", heads, fates)
