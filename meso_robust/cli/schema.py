"""``meso-robust schema NAME``."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated

import typer

from meso_robust.cli.console import refuse

if TYPE_CHECKING:
    from pydantic import BaseModel


def schema(
    name: Annotated[
        str,
        typer.Argument(
            help=(
                "task, plan, policy, certificate, campaign, witness, recordings, model, experiment, "
                "diagnosis or premises"
            )
        ),
    ],
) -> None:
    """Print the JSON Schema of a document."""
    models = documents()
    if name not in models:
        refuse(f"schema NAME = {name!r}: must be one of {', '.join(models)}")
    print(json.dumps(models[name].model_json_schema(by_alias=True), indent=2))


def documents() -> dict[str, type[BaseModel]]:
    """Models of all published documents by name."""
    from meso_robust.campaigns.document import campaign_document
    from meso_robust.certificates.document import CertificateDocument
    from meso_robust.diagnosis.document import DiagnosisDocument
    from meso_robust.execution.witness_file import WitnessFile
    from meso_robust.identification.document import ModelDocument
    from meso_robust.identification.experiment_document import ExperimentDocument
    from meso_robust.planning.document import PlanDocument
    from meso_robust.policy.document import PolicyDocument
    from meso_robust.premises.document import PremisesDocument
    from meso_robust.recordings import SetDocument
    from meso_robust.task import Task

    return {
        "task": Task,
        "plan": PlanDocument,
        "policy": PolicyDocument,
        "certificate": CertificateDocument,
        "campaign": campaign_document(),
        "witness": WitnessFile,
        "recordings": SetDocument,
        "model": ModelDocument,
        "experiment": ExperimentDocument,
        "diagnosis": DiagnosisDocument,
        "premises": PremisesDocument,
    }
