"""What the answer of ``plan`` says of runs that do not end in the goal."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from meso_robust.laboratory.running import STARTS_INSIDE
from meso_robust.pipeline import _failures
from meso_robust.simulator import Outcome

DEG = np.pi / 180.0


@pytest.mark.parametrize(
    ("outcomes", "missed", "said"),
    [
        ([0, 0], [(0, 0, 0), (0, 0, 0)], ""),
        # what most runs miss by, whatever one of them does
        (
            [0, 0, 0],
            [(0, 1e-6, 0), (0, 2.804e-6, 0), (9e-6, 0, 0)],
            "; 3 end outside it, y by up to 2.81 um",
        ),
        ([0], [(0, 0, 0.496 * DEG)], "; 1 ends outside it, theta by up to 0.50 deg"),
        ([Outcome.JAM, 0], [(1, 1, 1), (0, 0, 0)], "; 1 cannot be carried out: jam"),
        (
            [STARTS_INSIDE, STARTS_INSIDE, Outcome.JAM, 0],
            [(1, 1, 1), (1, 1, 1), (1, 1, 1), (1e-6, 0, 0)],
            "; 1 ends outside it, x by up to 1.00 um; 3 cannot be carried out: a tip starts inside the part, jam",
        ),
    ],
)
def test_failures_are_told_by_how_most_runs_end(
    outcomes: list[int], missed: list[tuple[float, float, float]], said: str
) -> None:
    ends, away = np.array(outcomes, dtype=np.int8), np.array(missed, dtype=float)
    done = ends == Outcome.COMPLETED
    sampled = SimpleNamespace(outcomes=ends, completed=done)
    check = SimpleNamespace(sampled=sampled, missed=away, in_goal=done & (away == 0.0).all(axis=1))
    assert _failures(cast(Any, check)) == said
