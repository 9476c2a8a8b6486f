"""``calibration.toml``: keys, units and rules."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

from meso_robust.recordings.rules import DEG, UM
from meso_robust.toml_files import checked, read_toml, toml_text
from meso_robust.tracking.calibration import MOST_K1, Calibration, Interval

SCHEMA = "meso-robust/calibration/1"

Positive = Annotated[FiniteFloat, Field(gt=0, le=1e4)]
Coordinate = Annotated[FiniteFloat, Field(ge=-1e6, le=1e6)]
HalfWidth = Annotated[FiniteFloat, Field(ge=0)]
Pixel = Annotated[FiniteFloat, Field(ge=-1e5, le=1e5)]
Count = Annotated[int, Field(ge=1, le=100000)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, title=None)


class IntervalSection(_Section):
    """Half widths of the 95 % intervals; a key that is absent was not identifiable."""

    pixel_um: HalfWidth
    """Of `pixel_um`."""
    rotation_deg: HalfWidth
    """Of `rotation_deg`."""
    k1: HalfWidth | None = None
    """Of `k1`."""
    k1_centre_px: tuple[HalfWidth, HalfWidth] | None = None
    """Of `k1_centre_px`, (u, v)."""


class CalibrationDocument(_Section):
    """A calibration, file calibration.toml."""

    schema_: Annotated[Literal["meso-robust/calibration/1"], Field(alias="schema")]
    """Name and version of the format."""
    width_px: Count
    """Width of the image, px."""
    height_px: Count
    """Height of the image, px."""
    pixel_um: Positive
    """um a pixel."""
    rotation_deg: Annotated[FiniteFloat, Field(ge=-180, le=180)] = 0.0
    """Rotation of the camera in the world, counter-clockwise."""
    centre_um: tuple[Coordinate, Coordinate] = (0.0, 0.0)
    """World point at the middle of the image."""
    k1: Annotated[FiniteFloat, Field(ge=-MOST_K1, le=MOST_K1)] = 0.0
    """Radial distortion half a diagonal from its centre, relative; negative: barrel."""
    k1_centre_px: tuple[Pixel, Pixel] | None = None
    """Its centre (u, v); the middle of the image if absent."""
    interval: IntervalSection | None = None
    """How well it is known; absent if it was stated."""


def load_calibration(path: Path) -> Calibration:
    """Read and check a ``calibration.toml``.

    Raises
    ------
    InputError
        The file cannot be read, is not TOML, or a value breaks a rule; the message names file, key,
        value and rule.
    """
    values = read_toml(path, "give a calibration file")
    keys = "the calibration.toml that `meso-robust track --grid` writes"
    return _loaded(checked(CalibrationDocument, values, str(path), whole="calibration", keys=keys))


def calibration_text(calibration: Calibration) -> str:
    """Text of the ``calibration.toml`` from which `load_calibration` returns the calibration.

    Parameters
    ----------
    calibration
        Lengths to twelve digits.

    Returns
    -------
    str
        TOML.
    """
    return toml_text(_values(calibration))


def calibration_values(calibration: Calibration) -> dict[str, Any]:
    """The same as plain values, for a document that quotes it."""
    return _values(calibration)


def _values(calibration: Calibration) -> dict[str, Any]:
    values = {
        "schema": SCHEMA,
        "width_px": calibration.size[0],
        "height_px": calibration.size[1],
        "pixel_um": _in(calibration.pixel_size, UM),
        "rotation_deg": _in(calibration.rotation, DEG),
        "centre_um": [_in(x, UM) for x in calibration.centre],
        "k1": _in(calibration.k1, 1.0),
    }
    if calibration.k1_centre is not None:
        values["k1_centre_px"] = [_in(x, 1.0) for x in calibration.k1_centre]
    if calibration.interval is not None:
        values["interval"] = _interval_values(calibration.interval)
    return values


def _interval_values(interval: Interval) -> dict[str, Any]:
    values: dict[str, Any] = {
        "pixel_um": _in(interval.pixel_size, UM),
        "rotation_deg": _in(interval.rotation, DEG),
    }
    if math.isfinite(interval.k1):
        values["k1"] = _in(interval.k1, 1.0)
    if all(map(math.isfinite, interval.k1_centre)):
        values["k1_centre_px"] = [_in(x, 1.0) for x in interval.k1_centre]
    return values


def _in(value: float, unit: float) -> float:
    """A value in the unit, to twelve digits."""
    return float(f"{value / unit:.12g}")


def _loaded(document: CalibrationDocument) -> Calibration:
    return Calibration(
        pixel_size=document.pixel_um * UM,
        size=(document.width_px, document.height_px),
        centre=(document.centre_um[0] * UM, document.centre_um[1] * UM),
        rotation=document.rotation_deg * DEG,
        k1=document.k1,
        k1_centre=document.k1_centre_px,
        interval=None if document.interval is None else _loaded_interval(document.interval),
    )


def _loaded_interval(section: IntervalSection) -> Interval:
    return Interval(
        pixel_size=section.pixel_um * UM,
        rotation=section.rotation_deg * DEG,
        k1=math.inf if section.k1 is None else section.k1,
        k1_centre=section.k1_centre_px or (math.inf, math.inf),
    )
