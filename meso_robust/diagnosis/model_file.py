"""The model of a diagnosis as ``model.toml``."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from meso_robust.diagnosis.answer import VISCOSITY
from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.intervals import CONFIDENCE, Interval, intervals
from meso_robust.diagnosis.validation import Errors
from meso_robust.identification.answer import document as identified
from meso_robust.identification.document import ModelDocument
from meso_robust.toml_files import toml_of

UM, DEG = 1e6, 180.0 / np.pi


def model_toml(found: Diagnosis, version: str) -> str:
    """Text of ``model.toml``: the extended model, or the plain one where nothing was added.

    Parameters
    ----------
    found
        The diagnosis.
    version
        Of this package.
    """
    return toml_of(model_document(found, version))


def model_document(found: Diagnosis, version: str) -> ModelDocument:
    """The document behind it."""
    plain = identified(found.split.training, found.baseline.found, version).model_dump(
        mode="json", by_alias=True, exclude_none=True
    )
    best, errors = found.best, found.retrained
    plain["diagnosis"] = found.verdict
    if best is None or errors is None:
        return ModelDocument.model_validate_json(json.dumps(plain))
    model, values = best.refit.model, best.refit.fits.values[0]
    known = intervals(model, values, best.refit.fitted.jacobian[0], best.refit.tangent)
    shown = {one.key: one.value for one in known}
    held = {
        f"{trial.effect}.{key}": value
        for trial in best.refit.trials
        for key, value in trial.held.items()
    }
    plain |= {
        "model": model.name,
        "interval": "curvature",
        "confidence": CONFIDENCE,
        "parameters": {one.key: _section(one) for one in known},
        "held": plain.get("held", {}) | held,
        "not_identifiable": _unknown(known),
        "minima": [_minimum(errors, float(best.refit.fits.chi2[0]), shown)],
        "recording": _recordings(errors),
    }
    for of_the_plain_fit in ("quality", "verdict"):
        plain.pop(of_the_plain_fit, None)
    return ModelDocument.model_validate_json(json.dumps(plain))


def _section(one: Interval) -> dict[str, Any]:
    return {
        "value": one.value,
        "low": one.low,
        "high": one.high,
        "open_low": one.open_low,
        "open_high": one.open_high,
    }


def _unknown(known: tuple[Interval, ...]) -> list[dict[str, str]]:
    """Numbers without a bound, and the scale of the drag, which no motion shows."""
    listed = [
        {"name": one.key, "why": "the recordings give no bound on one side"}
        for one in known
        if one.open_low or one.open_high
    ]
    return [*listed, {"name": VISCOSITY, "why": "no motion depends on the scale of the drag"}]


def _minimum(errors: Errors, chi2: float, shown: dict[str, float]) -> dict[str, Any]:
    rms = _rms(errors)
    mean = np.sqrt(np.mean(rms**2, axis=0))
    return {
        "cost": chi2,
        "x_um": UM * mean[0],
        "y_um": UM * mean[1],
        "theta_deg": DEG * mean[2],
        "found": 0,  # the search began at a linear estimate, not at a random start
        "parameters": shown,
    }


def _rms(errors: Errors) -> np.ndarray[Any, np.dtype[np.float64]]:
    """(R, 3) root mean squares of seen less predicted, m and rad."""
    return np.sqrt(np.nanmean((errors.prepared.seen - errors.poses) ** 2, axis=1))


def _recordings(errors: Errors) -> list[dict[str, Any]]:
    rms, frames = _rms(errors), errors.prepared.counts.max(axis=1)
    return [
        {
            "file": file,
            "frames": int(frames[k]),
            "x_um": UM * rms[k, 0],
            "y_um": UM * rms[k, 1],
            "theta_deg": DEG * rms[k, 2],
            "outcome": errors.outcomes[k],
        }
        for k, file in enumerate(errors.prepared.files)
    ]
