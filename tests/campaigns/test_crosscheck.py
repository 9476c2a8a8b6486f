"""What counts as a run that refutes a plan."""

from __future__ import annotations

from meso_robust.campaigns.crosscheck import confirmed
from meso_robust.job import make
from tests.conftest import paper_task


def test_a_miss_within_the_rounding_of_doubles_refutes_nothing() -> None:
    """The part ends at pi + beta exactly, and the goal's tolerance equals the range of beta."""
    task = paper_task(
        start__theta_deg=180.0,
        start__x_um=1500.0,
        start__y_um=20.0,
        goal__orientation_tolerance_deg=0.25,
        plan__least_y_translations=0,
    )

    found = make(task, 60, 0)

    assert found.certificate.verdict == "UNKNOWN"
    assert found.check.missed.max() < 1e-13
    assert found.check.failure is None
    assert not confirmed(found.found.rules, found.setup, found.check)
