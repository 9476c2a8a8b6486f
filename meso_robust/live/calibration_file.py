"""``calibration.json``: where the tips of each manipulator are in the world, and how well that is known."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

from meso_robust.errors import InputError
from meso_robust.reading import LARGEST_STATED, text_of
from meso_robust.toml_files import checked

SCHEMA: Literal["meso-robust/manipulators/1"] = "meso-robust/manipulators/1"
Pair = tuple[FiniteFloat, FiniteFloat]
NotNegative = Annotated[FiniteFloat, Field(ge=0)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)


class TipPlace(_Section):
    """A tip."""

    offset_um: Pair
    """[x, y] of the world at which its centre is while the manipulator is at its zero, um."""
    offset_error_um: Pair
    """Half widths of the 95 % intervals, um."""


class MeasuredManipulator(_Section):
    """A manipulator as measured."""

    axes: tuple[Pair, Pair]
    """Rows of the matrix from its own axes to the world's."""
    axes_error: tuple[Pair, Pair]
    """Half widths of the 95 % intervals."""
    tips: dict[str, TipPlace]
    """By name."""
    tip_error_um: NotNegative
    """Largest error of a tip's x or y anywhere among the places that were seen, um: the fit's, at 99.9 %,
    plus the largest that a place lay off the fit."""
    direction_error_deg: NotNegative
    """Largest error of a travel's direction by the axes, deg, at 99.9 %."""
    scale_error_percent: NotNegative
    """Largest error of a travel's length by the axes, %, at 99.9 %."""
    scatter_um: NotNegative
    """Root mean square of what the places lie off the fit, um."""
    places: int
    """Places at which the tips were seen."""


class CalibrationDocument(_Section):
    """``calibration.json``."""

    schema_: Annotated[Literal["meso-robust/manipulators/1"], Field(alias="schema")] = SCHEMA
    """Name and version of the format."""
    camera_um: NotNegative
    """Largest error of the camera's own calibration, which is in every place that it sees, um."""
    probe_position_um: NotNegative
    """What `[uncertainty] probe_position_um` of a task must at least state, um: the largest error of any
    tip, plus the camera's, plus the distance at which a manipulator counts as arrived."""
    manipulators: dict[str, MeasuredManipulator]
    """By name."""


def load_calibration(path: Path) -> CalibrationDocument:
    """Read ``calibration.json``.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    CalibrationDocument
        Checked.

    Raises
    ------
    InputError
        It cannot be read, or a value breaks its rule.
    """
    advice = "give what meso-robust calibrate wrote"
    text = text_of(path, advice, "a calibration", LARGEST_STATED)
    try:
        values = json.loads(text)
    except ValueError as error:
        raise InputError(f"{path}: is not JSON ({error}); {advice}") from error
    return checked(CalibrationDocument, values, str(path), whole="the calibration", keys=advice)
