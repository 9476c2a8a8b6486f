"""Splitting against probabilities that are known exactly, and against plain Monte Carlo."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.campaigns.falsify.budgeted_search import Problem, Rare, search
from meso_robust.campaigns.falsify.methods.splitting import splitting
from meso_robust.campaigns.falsify.views import pooled
from tests.campaigns.falsify.problems import SIZE, share_above

Floats = npt.NDArray[np.float64]

BUDGET = 20_000


def estimates(score: Callable[[Floats], Floats], limit: float, count: int) -> list[Rare]:
    at = Problem(score=score, low=np.full(SIZE, 3.0), high=np.full(SIZE, 5.0), limit=limit)
    found = [search(splitting, at, np.random.default_rng(k), BUDGET)[1] for k in range(count)]
    return [one for one in found if one is not None]


def told(found: list[Rare]) -> tuple[float, float]:
    """Mean and its coefficient of variation."""
    return pooled([{"probability": f.probability, "variation": f.variation} for f in found])


@pytest.mark.parametrize(
    ("sides", "gap"),
    [(10, Fraction(1)), (3, Fraction(18, 1000)), (10, Fraction(16, 10)), (25, Fraction(6))],
)
def test_probabilities_of_a_sum_that_are_known_exactly(sides: int, gap: Fraction) -> None:
    """From 4e-5 down to 2.8e-7 (1/10!), of 25 coordinates of which some do not matter."""
    exact = share_above(sides, gap)
    found = estimates(lambda rows: 0.5 * (rows - 3.0)[:, :sides].sum(axis=1), float(sides - gap), 8)

    mean, variation = told(found)

    assert 1e-7 < exact < 1e-4
    assert abs(mean / exact - 1.0) < 2.0 * variation < 1.0
    # the stated error of one estimate is no smaller than what estimates spread
    spread = np.std([one.probability for one in found], ddof=1) / exact
    assert spread < 1.5 * np.mean([one.variation for one in found])


def test_share_above_is_right() -> None:
    assert share_above(1, Fraction(1, 4)) == 0.25
    assert share_above(2, Fraction(1)) == 0.5
    assert share_above(10, Fraction(1)) == pytest.approx(1.0 / 3628800.0, rel=1e-15)


def test_two_corners_apart_are_both_counted() -> None:
    """Above in two opposite corners of four coordinates: twice ``gap ** 4 / 24``."""

    def score(rows: Floats) -> Floats:
        return np.asarray(np.abs((rows[:, :4] - 4.0).sum(axis=1)))

    gap = 0.3
    mean, variation = told(estimates(score, 4.0 - 2.0 * gap, 6))

    exact = 2.0 * gap**4 / 24.0
    assert abs(mean / exact - 1.0) < 3.0 * variation < 1.2


def test_plain_monte_carlo_says_the_same() -> None:
    def score(rows: Floats) -> Floats:
        own = rows - 4.0
        return np.asarray(own[:, 0] * own[:, 1] + np.sin(3.0 * own[:, 2]) + own[:, 3:6].sum(axis=1))

    limit = 3.9
    rows = 3.0 + 2.0 * np.random.default_rng(99).random((1_000_000, SIZE))
    plain = float(np.mean(score(rows) > limit))
    mean, variation = told(estimates(score, limit, 6))

    assert 1e-4 < plain < 1e-2
    assert abs(mean / plain - 1.0) < 3.0 * variation < 0.9


def test_failing_runs_count_as_above_any_level() -> None:
    """A thousandth of the box fails outright, where the score before gives no hint of a limit."""

    def score(rows: Floats) -> Floats:
        least = 0.5 * (rows - 3.0)[:, :3].min(axis=1)
        return np.where(least > 0.9, np.inf, least)

    mean, variation = told(estimates(score, 5.0, 6))

    assert abs(mean / 1e-3 - 1.0) < 3.0 * variation < 0.9


def test_what_is_never_above_is_told_by_how_far_it_got() -> None:
    """A limit out of reach: the deepest level, and the exact probability of being at least there."""
    found = estimates(lambda rows: 0.5 * (rows - 3.0)[:, :4].sum(axis=1), 9.0, 6)

    assert all(one.probability == 0.0 for one in found)
    ratios = [
        one.level_probability / share_above(4, Fraction(4) - Fraction(one.level)) for one in found
    ]
    assert all(one.level > 3.95 and one.level_probability < 1e-8 for one in found)
    # an estimate that deep varies by 1.3 times itself, by its own account: the mean of six by half
    assert np.exp(np.mean(np.log(ratios))) == pytest.approx(1.0, abs=0.6)


def test_a_plateau_ends_the_levels() -> None:
    """No point is above 1, a third of the box is at 1: there is no next level."""
    found = estimates(lambda rows: np.minimum(1.5 * (rows[:, 0] - 3.0), 1.0), 1.0, 1)[0]

    assert found.probability == 0.0
    assert found.level == 1.0
    assert found.level_probability == pytest.approx(2.0 / 3.0, abs=0.05)
