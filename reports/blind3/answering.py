"""A set of the third blind trial, diagnosed; apart, as processes that are started anew find it by its name."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import meso_robust
from reports.blind3.cases import Case, checked

Values = Mapping[str, Any]


def answered(case: Case) -> Values:
    """What `diagnose` says of a promised set, in its quick form."""
    return {"id": case.id, **diagnosed(checked(case), quick=True)}


def diagnosed(folder: Path, *, quick: bool) -> Values:
    """What `diagnose` says of a set, as a user would run it."""
    clock, cpu = time.perf_counter(), time.process_time()
    try:
        found = meso_robust.diagnose(folder, quick=quick)
        answer = told(found.document.model_dump(mode="json", by_alias=True))
        found.files()  # as `save` writes them: a fault there is no answer either
    except Exception as problem:  # a crash is an answer that is scored
        answer = {"verdict": "none", "error": f"{type(problem).__name__}: {problem}"}
    return {
        **answer,
        "seconds": round(time.perf_counter() - clock, 1),
        "cpu_seconds": round(time.process_time() - cpu, 1),
    }


def told(found: Values) -> dict[str, Any]:
    """What is kept of a ``diagnosis.json``."""
    where, left = found["mismatch"]["where"], found["remainder"]
    stage = (left or {}).get("stage") or (where[0]["channel"] if where else None)
    return {
        "verdict": found["verdict"],
        "why": found["why"],
        "effects": {
            one["name"]: {
                "share": one["share"],
                "stage": one["stage"],
                "parameters": {
                    key: [value["value"], value["low"], value["high"]]
                    for key, value in one["parameters"].items()
                },
            }
            for one in found["effects"]
        },
        "ambiguous_with": found["ambiguous_with"],
        "explained": found["explained"],
        "stage": stage,
        "first_stage": where[0]["channel"] if where else None,
        "explainable_um": found["explainable_um"],
        "relevant_um": found["relevant_um"],
        "recordings_sha256": found["provenance"]["recordings_sha256"],
    }
