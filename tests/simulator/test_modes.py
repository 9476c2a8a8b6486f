"""The enumeration of contact modes against linear programs over all complementary cones."""

import itertools

import numpy as np
import numpy.typing as npt
import pytest
from scipy.optimize import linprog

from tests.simulator.problems import contact_problems, random_rows, some_mode_holds

F = npt.NDArray[np.float64]


def solvable_by_linear_programs(M: F, q: F) -> bool:
    """Try all 2^n choices of which of z_i and w_i is zero."""
    n = len(q)
    equations = np.hstack([M, -np.eye(n)])
    for choice in itertools.product((0, 1), repeat=n):
        bounds = [(0, 0 if c else None) for c in choice] + [(0, None if c else 0) for c in choice]
        if linprog(np.zeros(2 * n), A_eq=equations, b_eq=-q, bounds=bounds).status == 0:
            return True
    return False


@pytest.mark.parametrize("seed", range(6))
def test_agrees_with_linear_programs(seed: int) -> None:
    # Two contacts that face each other and close: whether they jam depends on arms and friction.
    rng = np.random.default_rng(seed)
    rows = random_rows(1, 2, rng)
    rows[0, 1, 2:4] = -rows[0, 0, 2:4]
    rows[0, 1, 5:7] = -rows[0, 0, 5:7]
    rows[0, :, [4, 7]] *= 0.4
    rows[0, :, 0] = -1.0
    M, q = contact_problems(rows, np.array([0.5]))
    assert some_mode_holds(8, M[0], q[0]) == solvable_by_linear_programs(M[0], q[0])


def test_one_contact_always_has_a_mode() -> None:
    M, q = contact_problems(random_rows(50, 1, np.random.default_rng(1)), np.full(50, 0.4))
    assert all(some_mode_holds(4, M[i], q[i]) for i in range(50))


def test_two_facing_contacts_that_close_have_none() -> None:
    rows = np.array([[[-1, 0, 1, 0, 0, 0, 1, 0.5], [-1, 0, -1, 0, 0, 0, -1, 0.5]]], dtype=float)
    M, q = contact_problems(rows, np.array([0.5]))
    assert not some_mode_holds(8, M[0], q[0])


def test_singular_mode_is_decided() -> None:
    # Two sticking contacts on one face going the same way: four conditions of rank three.
    rows = np.array([[[-1, 0.1, 1, 0, 0.7, 0, 1, 0.6], [-1, 0.1, 1, 0, -0.7, 0, 1, 0.6]]])
    M, q = contact_problems(rows, np.array([0.5]))
    assert some_mode_holds(8, M[0], q[0])
