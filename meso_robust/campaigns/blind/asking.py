"""Asking for one diagnosis, by someone who knows only the recordings."""

from __future__ import annotations

import math
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from meso_robust.campaigns.blind.sealing import digest
from meso_robust.diagnosis.answer import diagnosed
from meso_robust.errors import InputError

Values = Mapping[str, Any]

FAILURES = (ArithmeticError, AssertionError, AttributeError, LookupError, RuntimeError, TypeError, ValueError)  # fmt: skip
"""How a diagnosis may fail of itself; a full disk or memory is not its failure."""
SIGMAS = ("baseline_sigma", "extended_sigma", "noise_floor_sigma")
SPANS = 5
"""Spans that are kept of where a mismatch was found."""
BEYOND = 1e300
"""Stands for infinity, which JSON does not have."""
SEED = 0
"""Of the diagnosis: that of ``meso-robust diagnose``."""


def asked(folder: Path, expected: str, *, quick: bool) -> Values:
    """The diagnosis of a recording set, or how it failed: ``document`` or ``error``.

    Parameters
    ----------
    folder
        Of the set; a copy is diagnosed, whose path tells nothing of the case.
    expected
        Digest that the set must have.
    quick
        Whether the quick form is asked for.

    Raises
    ------
    InputError
        The recordings are not those of the campaign.
    """
    with tempfile.TemporaryDirectory() as scratch:
        copy = Path(scratch) / "recordings"
        if folder.is_dir():
            shutil.copytree(folder, copy)
        if not copy.exists() or digest(copy) != expected:
            raise InputError(
                f"{folder}: differs from the recording set that the campaign started with; restore it, or "
                "start a new campaign"
            )
        try:
            return {"document": essence(diagnosed(copy, quick=quick, seed=SEED))}
        except FAILURES as error:
            return {"error": f"{type(error).__name__}: {error}".replace(str(copy), folder.name)}


def essence(document: Values) -> Values:
    """What is judged of a ``diagnosis.json``."""
    held = document["held_out"]
    effects = [
        {
            "name": effect["name"],
            "probability": effect["probability"],
            "parameters": {
                key: {end: _finite(told[end]) for end in ("value", "low", "high")}
                for key, told in effect["parameters"].items()
            },
        }
        for effect in document["effects"]
    ]
    return {
        "verdict": document["verdict"],
        "effects": effects,
        "ambiguous_with": [list(names) for names in document["ambiguous_with"]],
        "not_identifiable": list(document["not_identifiable"]),
        "mismatch": {
            "where": [{"channel": one["channel"]} for one in document["mismatch"]["where"][:SPANS]]
        },
        "held_out": {
            "recordings": list(held["recordings"]),
            **{key: _finite(held[key]) for key in SIGMAS},
        },
    }


def _finite(value: float) -> float:
    """The number, or one beyond all that can be measured."""
    return value if math.isfinite(value) else math.copysign(BEYOND, value)
