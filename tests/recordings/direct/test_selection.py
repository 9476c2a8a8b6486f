"""Sets of effects that explain a residual by chance."""

from __future__ import annotations

import numpy as np
import pytest

from meso_robust.recordings.direct.selection import Columns, selected

DRAWS = 60


@pytest.mark.parametrize(("recordings", "most"), [(8, 0.07), (12, 0.1)])
def test_sets_are_found_in_chance_as_rarely_as_is_said(recordings: int, most: float) -> None:
    """One in twenty times; without the test of the best of all sets 12 and 15 % of 150 draws.

    With as many numbers as recordings it was 27 % of eight.
    """
    alarms = 0
    for seed in range(DRAWS):
        rng = np.random.default_rng(seed)
        groups = np.repeat(np.arange(recordings), 12)
        size = (groups.size, 2)
        values = rng.normal(size=recordings)[groups] + 0.3 * rng.normal(size=groups.size)
        columns = {
            name: Columns(
                ("x_um", "y_um"),
                rng.normal(size=(recordings, 2))[groups] + 0.2 * rng.normal(size=size),
            )
            for name in "abcdef"
        }
        alarms += bool(selected(values, groups, columns, lambda *_: True).steps)
    assert alarms <= most * DRAWS


def test_an_effect_that_is_there_is_found_beside_as_many_that_are_not() -> None:
    rng = np.random.default_rng(1)
    groups = np.repeat(np.arange(10), 12)
    columns = {
        name: Columns(("x_um", "y_um"), rng.normal(size=(10, 2))[groups]) for name in "abcdef"
    }
    values = columns["c"].values @ [2.0, -1.0] + 0.3 * rng.normal(size=10)[groups]
    found = selected(values, groups, columns, lambda *_: True)
    assert [step.effect for step in found.steps] == ["c"]
