"""Each way to search, on problems whose highest points are known, and what it does not find."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.campaigns.falsify.budgeted_search import Problem, search
from meso_robust.campaigns.falsify.draws import Spread, shares_of
from meso_robust.campaigns.falsify.methods import SEARCHES
from meso_robust.laboratory.ascent import Summit
from tests.campaigns.falsify.problems import SIZE, problem, signs

Floats = npt.NDArray[np.float64]

BUDGET = 10_000
CLIMBING = ("climb", "corner-walk", "face-walk", "cma-es")


def found(name: str, at: Problem, seed: int = 0, budget: int = BUDGET) -> Summit:
    return search(SEARCHES[name], at, np.random.default_rng(seed), budget)[0]


def by_draws(how: Spread, at: Problem) -> float:
    shares = shares_of(how, (BUDGET, SIZE), np.random.default_rng(0))
    return float(at.score(at.rows(shares)).max())


def paired(rows: Floats) -> Floats:
    """Highest (SIZE) in one corner; a flip of one of a pair of coordinates alone only costs."""
    good = (rows * signs() > 0.5 * signs()).astype(float)
    pairs = good[:, 1::2] - good[:, :-1:2]
    both = good[:, 1::2] + good[:, :-1:2] == 2
    return np.asarray(good[:, -1] + (2.0 * both - 1.5 * np.abs(pairs)).sum(axis=1))


def inside(rows: Floats) -> Floats:
    """Highest (0) where ten coordinates are inside, five at an end, and ten do not matter."""
    at = 0.5 + 0.8 * np.sin(np.arange(10))
    own = rows[:, :10] - at
    across = own + 0.5 * np.roll(own, 1, axis=1)
    return np.asarray(-(across**2).sum(axis=1) - np.abs(rows[:, 10:15] - 2.0).sum(axis=1))


@pytest.mark.parametrize("name", CLIMBING)
def test_a_search_finds_the_one_corner_that_draws_miss(name: str) -> None:
    """A sum is above its limit in 3e-30 of the box, and at one of 2**25 corners."""
    weights = 1.0 + np.arange(SIZE) / SIZE
    at = problem(lambda rows: (rows * signs() * weights).sum(axis=1))
    best = float(np.where(signs() > 0, 2.0, 1.0) @ weights)

    assert found(name, at).value > best - 1e-2
    assert by_draws("uniform", at) < best - 20.0
    assert by_draws("corners", at) < best - 4.0


def test_a_corner_walk_finds_what_only_two_flips_together_improve() -> None:
    at = problem(paired)

    for seed in range(6):
        walked = found("corner-walk", at, seed, budget=3_000)
        assert walked.value == 1.0 + 2.0 * (SIZE // 2)
    assert by_draws("corners", at) < SIZE - 4


@pytest.mark.parametrize("name", ["face-walk", "cma-es"])
def test_what_is_highest_inside_of_a_face_is_found(name: str) -> None:
    """Not by corner walks, which the middle of the box beats, and not by draws."""
    at = problem(inside)

    summit = found(name, at)

    assert summit.value > -0.2
    assert found("corner-walk", at).value < -10.0
    assert max(by_draws("uniform", at), by_draws("mixed", at)) < -3.0
    assert (np.abs(summit.row[10:15] - 2.0) < 0.05).all()


@pytest.mark.parametrize("name", SEARCHES)
def test_a_search_keeps_to_its_budget_and_to_the_box(name: str) -> None:
    counted = []

    def score(rows: Floats) -> Floats:
        assert ((rows >= -1.0) & (rows <= 2.0)).all()
        counted.append(len(rows))
        return np.asarray(-np.abs(rows - 0.3).sum(axis=1))

    summit = found(name, problem(score), budget=1234)

    assert summit.evaluations == sum(counted) <= 1234
    assert summit.evaluations == 1234 or name == "splitting"
    assert summit.value == pytest.approx(float(-np.abs(summit.row - 0.3).sum()))


@pytest.mark.parametrize("name", CLIMBING)
def test_a_search_ends_at_a_run_that_fails(name: str) -> None:
    def score(rows: Floats) -> Floats:
        value = rows[:, 0] - np.abs(rows[:, 1] + 1.0)
        return np.where(value > 1.5, np.inf, value)

    summit = found(name, problem(score))

    assert summit.value == np.inf
    assert summit.evaluations < BUDGET
    assert summit.row[0] > 1.5


@pytest.mark.parametrize("name", SEARCHES)
def test_a_score_that_says_nothing_anywhere(name: str) -> None:
    summit = found(name, problem(lambda rows: np.full(len(rows), -np.inf)), budget=2000)

    assert summit.value == -np.inf
    assert summit.row.tolist() == [0.5] * SIZE


@pytest.mark.parametrize("name", SEARCHES)
def test_a_search_follows_from_its_seed_alone(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It does without the global generator, the clock and files, and warns of nothing."""
    monkeypatch.chdir(tmp_path)
    one = found(name, problem(inside), seed=5, budget=2000)
    for forbidden in ("seed", "rand", "randn", "random", "normal", "uniform", "permutation"):
        monkeypatch.setattr(f"numpy.random.{forbidden}", refuse)

    other = found(name, problem(inside), seed=5, budget=2000)

    assert one.row.tobytes() == other.row.tobytes()
    assert (one.value, one.evaluations) == (other.value, other.evaluations)
    assert not list(tmp_path.iterdir())
    assert found(name, problem(inside), seed=6, budget=2000).row.tobytes() != one.row.tobytes()


def refuse(*_: object, **__: object) -> None:
    raise AssertionError("the global generator was asked")


def test_shares_and_rows_are_each_other_to_the_ends() -> None:
    at = Problem(
        score=lambda rows: rows[:, 0],
        low=np.array([-0.4, -3.0, 5.0]),
        high=np.array([0.1, 1e-9, 5.0]),
        limit=0.0,
    )
    ends = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 1.0]])

    rows = at.rows(ends)

    assert rows.tolist() == [[-0.4, 1e-9, 5.0], [0.1, -3.0, 5.0]]
    assert -0.4 + (0.1 - -0.4) < 0.1  # as a sum it would not be the end
    assert at.shares(rows)[:, :2].tolist() == ends[:, :2].tolist()
    assert at.shares(np.array([[-0.4 + 0.75 * (0.1 - -0.4), -1.5, 5.0]]))[0, :2] == (
        pytest.approx([0.75, 0.5])
    )
