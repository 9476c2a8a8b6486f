"""Failing rows made small, on failures whose smallest form is known."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from meso_robust.campaigns.falsify.minimising import PARTS, ROUNDS, Breaks, minimal

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]

MIDDLE = np.linspace(-1.0, 2.0, 25)
ROW = MIDDLE + np.where(np.arange(25) % 2, 1.0, -0.5)


def counting(breaks: Breaks) -> tuple[Breaks, list[int]]:
    counts: list[int] = []

    def counted(rows: Floats) -> Flags:
        counts.append(len(rows))
        return breaks(rows)

    return counted, counts


def test_only_what_is_needed_stays_off_the_middle() -> None:
    def breaks(rows: Floats) -> Flags:
        return (rows[:, 3] > MIDDLE[3] + 0.25) & (rows[:, 10] < MIDDLE[10] - 0.1)

    counted, counts = counting(breaks)
    small = minimal(ROW, MIDDLE, counted)

    assert np.flatnonzero(small != MIDDLE).tolist() == [3, 10]
    assert breaks(small[None])[0]
    # as near to the middle as it may be, to a 4096th of the way
    assert 0.25 < small[3] - MIDDLE[3] <= 0.25 + 1.0 / PARTS**ROUNDS
    assert 0.1 < MIDDLE[10] - small[10] <= 0.1 + 0.5 / PARTS**ROUNDS
    assert sum(counts) < 250


def test_either_of_two_is_enough_but_not_neither() -> None:
    """All single resets still fail, all together do not."""

    def breaks(rows: Floats) -> Flags:
        return (rows[:, 1] != MIDDLE[1]) | (rows[:, 20] != MIDDLE[20])

    small = minimal(ROW, MIDDLE, breaks)

    assert np.flatnonzero(small != MIDDLE).size == 1
    assert breaks(small[None])[0]


def test_a_row_that_needs_everything_stays() -> None:
    def breaks(rows: Floats) -> Flags:
        return np.asarray((rows == ROW).all(axis=1))

    assert minimal(ROW, MIDDLE, breaks).tolist() == ROW.tolist()


def test_a_failure_of_the_middle_itself() -> None:
    assert minimal(ROW, MIDDLE, lambda rows: np.ones(len(rows), dtype=bool)).tolist() == (
        MIDDLE.tolist()
    )


def test_a_sum_of_many_needs_few() -> None:
    """Any five of thirteen coordinates, each by one: what is left has no spare coordinate."""

    def breaks(rows: Floats) -> Flags:
        return np.asarray((rows - MIDDLE)[:, 1::2].sum(axis=1) > 4.5)

    small = minimal(ROW, MIDDLE, breaks)

    assert np.flatnonzero(small != MIDDLE).size == 5
    off = small - MIDDLE
    assert 4.5 < off.sum() <= 4.5 + 1.0 / PARTS**ROUNDS


def test_a_failure_that_comes_and_goes_ends() -> None:
    """As if the steps of a batch decided: nothing may loop for ever."""
    calls = []

    def breaks(rows: Floats) -> Flags:
        calls.append(len(rows))
        return np.full(len(rows), len(calls) % 2 == 1)

    minimal(ROW, MIDDLE, breaks)

    assert len(calls) < 200
