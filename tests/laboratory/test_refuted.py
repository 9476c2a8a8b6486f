"""Witnesses of refuted certificates, replayed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from meso_robust.pipeline import Planned
from reports.campaigns.refuted import replayed


def test_the_witness_of_a_refuted_certificate_fails_again_by_both_engines(
    wide_friction_plan: Planned, tmp_path: Path
) -> None:
    found = replayed(wide_friction_plan, "wide friction", tmp_path)

    assert found.verdict == "REFUTED"
    assert found.status == 1
    assert found.fails, found


def test_a_witness_that_does_not_fail_is_told(wide_friction_plan: Planned, tmp_path: Path) -> None:
    certificate = wide_friction_plan.certificate
    witness = certificate.witness
    assert witness is not None
    zero, moves = (0.0).hex(), len(certificate.policy)
    harmless = witness.model_copy(
        update={
            "friction": (0.33).hex(),
            "start": tuple(float(v).hex() for v in wide_friction_plan.setup.start.mid),
            "sensing": ((zero, zero, zero),) * moves,
            "dual_probe": ((zero, zero),) * moves,
            "single_probe": ((zero, zero),) * moves,
        }
    )
    made_up = certificate.model_copy(update={"witness": harmless})

    found = replayed(replace(wide_friction_plan, certificate=made_up), "made up", tmp_path)

    assert not found.fails
    assert found.stepper.startswith("completed")
    assert found.events.startswith("completed")
