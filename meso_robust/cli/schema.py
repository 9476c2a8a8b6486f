"""``meso-robust schema NAME``."""

from __future__ import annotations

import json
from importlib import import_module
from typing import TYPE_CHECKING, Annotated

import typer

from meso_robust.cli.console import refuse

if TYPE_CHECKING:
    from pydantic import BaseModel

_MODELS = {
    "task": "task:Task",
    "plan": "planning.plan_file:PlanDocument",
    "policy": "policy.policy_file:PolicyDocument",
    "certificate": "certificates.document:CertificateDocument",
    "campaign": "campaigns.document:campaign_document",
    "witness": "laboratory.witness_form:WitnessFile",
    "recordings": "recordings.document:SetDocument",
    "model": "identification.document:ModelDocument",
    "experiment": "identification.experiment_document:ExperimentDocument",
    "diagnosis": "diagnosis.document:DiagnosisDocument",
    "lab": "live.lab_file:Lab",
    "manipulators": "live.calibration_file:CalibrationDocument",
    "run": "live.run_document:RunDocument",
    "premises": "transfer.document:PremisesDocument",
}
"""Where the model of each document is; only the one asked for is imported."""


def _names() -> list[str]:
    return list(_MODELS)


def schema(
    name: Annotated[str, typer.Argument(help=", ".join(_MODELS), autocompletion=_names)],
) -> None:
    """Print the JSON Schema of a document."""
    if name not in _MODELS:
        refuse(f"schema NAME = {name!r}: must be one of {', '.join(_MODELS)}")
    print(json.dumps(_model(name).model_json_schema(by_alias=True), indent=2))


def _model(name: str) -> type[BaseModel]:
    place, _, attribute = _MODELS[name].partition(":")
    found = getattr(import_module(f"meso_robust.{place}"), attribute)
    model: type[BaseModel] = found() if name == "campaign" else found
    return model


def documents() -> dict[str, type[BaseModel]]:
    """Models of all published documents by name."""
    return {name: _model(name) for name in _MODELS}
