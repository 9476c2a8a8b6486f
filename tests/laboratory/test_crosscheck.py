"""What counts as a run that refutes a plan."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.laboratory.crosscheck import confirmed
from meso_robust.laboratory.running import STARTS_INSIDE
from meso_robust.pipeline import Planned, make
from meso_robust.simulator import Outcome
from tests.conftest import paper_task


def test_a_miss_within_the_rounding_of_doubles_refutes_nothing() -> None:
    """The part ends at pi + beta exactly, and the goal's tolerance equals the range of beta."""
    task = paper_task(
        start__theta_deg=180.0,
        start__x_um=1500.0,
        start__y_um=20.0,
        goal__orientation_tolerance_deg=0.25,
        plan__least_y_translations=0,
        probe__headings=["-x"],
    )

    found = make(task, 60, 0)

    assert found.certificate.verdict == "UNKNOWN"
    assert found.check.missed.max() < 1e-13
    assert found.check.failure is None
    assert not confirmed(found.found.rules, found.setup, found.check)


@pytest.mark.parametrize(
    ("outcome", "refutes"),
    [
        (Outcome.JAM, True),
        (STARTS_INSIDE, True),
        (Outcome.SOLVER_FAILURE, False),
        (Outcome.OUT_OF_RANGE, False),
    ],
)
def test_only_what_the_part_does_refutes_not_what_the_solver_fails_to_do(
    paper_plan: Planned, outcome: int, refutes: bool
) -> None:
    outcomes = paper_plan.check.sampled.outcomes.copy()
    outcomes[7] = outcome
    check = replace(paper_plan.check, sampled=replace(paper_plan.check.sampled, outcomes=outcomes))

    assert not check.in_goal[7]
    assert check.failure == (7 if refutes else None)


def test_the_refuting_miss_is_a_clear_one_whatever_the_unit(paper_plan: Planned) -> None:
    """A large angle within the error must not hide a small but clear miss in x."""
    missed = np.zeros_like(paper_plan.check.missed)
    missed[3, 2], missed[5, 0] = 1e-3, 20e-6
    check = replace(paper_plan.check, missed=missed, error=(1e-6, 1e-6, 1e-3))

    assert check.failure == 5
