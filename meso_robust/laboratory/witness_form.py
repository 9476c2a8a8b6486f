"""The form of ``witness.json``, apart from what runs it: a bad file is refused at once."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from meso_robust.errors import InputError
from meso_robust.planning.reading import first_of, read_text

SCHEMA: Literal["meso-robust/witness/1"] = "meso-robust/witness/1"


class WitnessFile(BaseModel):
    """``witness.json``."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    schema_: Annotated[Literal["meso-robust/witness/1"], Field(alias="schema")] = SCHEMA
    """Name and version of the format."""
    task_hash: str
    """SHA-256 of the task's values."""
    plan_hash: str
    """SHA-256 of the plan's values."""
    factor: Annotated[float, Field(gt=0, le=10)]
    """Of all uncertainties about their middles: the bounds that the run keeps."""
    engine: Literal["events", "stepper"]
    """Engine of the simulator that made the run: from event to event, or in LCP steps."""
    breaks: tuple[str, ...]
    """What the run breaks, in words."""
    row: dict[str, str]
    """Everything uncertain by its name, hexadecimal doubles in SI units."""


def parse_witness(text: str, source: str) -> WitnessFile | None:
    """The witness that a JSON text holds, None if it is of another schema; ``source`` names it.

    Raises
    ------
    InputError
        A value breaks a rule.
    """
    values = json.loads(text)
    if not isinstance(values, dict) or values.get("schema") != SCHEMA:
        return None
    try:
        return WitnessFile.model_validate_json(text, strict=True)
    except ValidationError as error:
        raise InputError(f"{source}: {first_of(error, WitnessFile, 'witness')}") from error


def check_form(path: Path) -> None:
    """Refuse a file that is neither a witness nor a certificate, before anything is run.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    InputError
        It is neither, or a value of the witness breaks a rule.
    """
    text = read_text(path)
    values = json.loads(text)
    other = isinstance(values, dict) and "witness" in values
    if parse_witness(text, str(path)) is None and not other:
        raise InputError(
            f"{path}: is neither a witness nor a certificate with one; give witness.json, or the "
            "certificate.json of a REFUTED plan"
        )
