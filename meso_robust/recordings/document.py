"""``set.toml`` as users write it: keys, units and rules, and the JSON Schema that follows."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    FiniteFloat,
    model_validator,
)

from meso_robust.errors import InputError
from meso_robust.recordings.outline import outline_fault
from meso_robust.recordings.rules import file_fault, probe_fault, twice_fault
from meso_robust.toml_files import checked, read_toml

SCHEMA = "meso-robust/recordings/1"
SET_FILE = "set.toml"
"""Name of the file in the folder of a set."""

# Limits that catch a slip of the unit and let parts of a metre pass: recordings of pushing on a
# table obey the same laws.
Length = Annotated[FiniteFloat, Field(ge=1, le=1e6)]
Coordinate = Annotated[FiniteFloat, Field(ge=-1e6, le=1e6)]


def _raise_if(fault: str | None) -> None:
    if fault:
        raise ValueError(fault)


def _file(name: str) -> str:
    _raise_if(file_fault(name))
    return name


def _probe(name: str) -> str:
    _raise_if(probe_fault(name))
    return name


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, title=None)


class PartSection(_Section):
    """The outline: a rectangle (length_um and width_um) or a polygon (polygon_um)."""

    length_um: Length | None = None
    """Side along the part's x axis at theta = 0, the long one, um."""
    width_um: Length | None = None
    """Side across it, um."""
    polygon_um: (
        Annotated[tuple[tuple[Coordinate, Coordinate], ...], Field(max_length=1000)] | None
    ) = None
    """Corners about the reference point, counter-clockwise, um."""

    @model_validator(mode="after")
    def _one_outline(self) -> Self:
        given = (self.length_um is not None, self.width_um is not None)
        if self.polygon_um is not None:
            if any(given):
                raise ValueError("length_um or width_um beside polygon_um; give one outline only")
            _raise_if(_in_polygon(outline_fault(np.array(self.polygon_um).reshape(-1, 2))))
        elif not all(given):
            raise ValueError("no outline; give length_um and width_um, or polygon_um")
        elif (self.width_um or 0.0) > (self.length_um or 0.0):
            raise ValueError(
                f"width_um = {self.width_um} exceeds length_um = {self.length_um}; give the long "
                "side as length_um"
            )
        return self


def _in_polygon(fault: str | None) -> str | None:
    return fault and f"polygon_um: {fault}"


class ProbeSection(_Section):
    """The probes, all of one kind."""

    tip_radius_um: Annotated[FiniteFloat, Field(ge=0, le=1e5)]
    """Radius of a tip, um; 0: a point."""
    position_source: Literal["controller", "camera"]
    """Where positions of probes are from: "controller": commanded, "camera": seen."""


class SensorSection(_Section):
    """The camera and the tracker."""

    position_sigma_um: Annotated[FiniteFloat, Field(ge=0, le=1e4)] | None = None
    """Standard deviation of a seen x or y, um: repeatability and systematic error together; when absent,
    the repeatability alone, from still frames."""
    orientation_sigma_deg: Annotated[FiniteFloat, Field(ge=0, le=90)] | None = None
    """Standard deviation of a seen theta, deg, likewise."""
    tip_sigma_um: Annotated[FiniteFloat, Field(ge=0, le=1e4)] | None = None
    """Standard deviation of x or y of a tip in the controller's log, um; when absent, estimated from
    straight travel."""
    tip_offset_um: Annotated[FiniteFloat, Field(ge=0, le=1e4)] | None = None
    """Standard deviation of x or y of what a tip is away from where it is said to be throughout a recording, and
    otherwise in the next, um: how well a manipulator finds a place, or, of a seen tip, what every frame's has
    in common; when absent, 0, or, of a seen tip, what position_sigma_um has beyond the tip's scatter."""
    tip_offset_across_um: Annotated[FiniteFloat, Field(ge=0, le=1e4)] | None = None
    """Likewise across tip_directions_deg of the recordings, along which tip_offset_um then is, um; when absent,
    tip_offset_um in all directions."""
    frame_rate_hz: Annotated[FiniteFloat, Field(gt=0, le=1e6)]
    """Frames a second."""


class RecordingSection(_Section):
    """One recording."""

    file: Annotated[str, AfterValidator(_file)]
    """Plain name of its CSV file, in the same folder."""
    probes: tuple[Annotated[str, AfterValidator(_probe)], ...]
    """Names of its probes, as in the columns."""
    alike_orientations: Annotated[int, Field(ge=1, le=1000)] = 1
    """Number of orientations in which the part looks the same, where none was chosen; 1: theta is certain."""
    tip_directions_deg: tuple[Annotated[FiniteFloat, Field(ge=-1e6, le=1e6)], ...] | None = None
    """Of each probe the direction in which its place is known least, that of its needle, deg, world frame; goes
    with tip_offset_across_um."""

    @model_validator(mode="after")
    def _names_differ(self) -> Self:
        _raise_if(twice_fault(self.probes))
        return self

    @model_validator(mode="after")
    def _each_has_a_direction(self) -> Self:
        given, probes = self.tip_directions_deg, len(self.probes)
        wrong = given is not None and len(given) != probes
        _raise_if(
            f"tip_directions_deg: {len(given or ())} values; must be {probes}, one of each probe; add or remove some"
            if wrong
            else None
        )
        return self


class SetDocument(_Section):
    """A recording set, file set.toml."""

    schema_: Annotated[Literal["meso-robust/recordings/1"], Field(alias="schema")]
    """Name and version of the format."""
    part: PartSection
    """The outline that was pushed."""
    probe: ProbeSection
    """The probes."""
    sensor: SensorSection
    """Camera and tracker."""
    recording: Annotated[tuple[RecordingSection, ...], Field(min_length=1)]
    """The recordings, one a CSV file."""

    @model_validator(mode="after")
    def _files_differ(self) -> Self:
        fault = twice_fault([recording.file for recording in self.recording])
        _raise_if(fault and f"recording: file {fault}")
        return self

    @model_validator(mode="after")
    def _across_has_a_direction(self) -> Self:
        if self.sensor.tip_offset_across_um is None:
            return self
        _raise_if(
            None
            if self.sensor.tip_offset_um is not None
            else "sensor.tip_offset_across_um: needs tip_offset_um, along the needle; state both"
        )
        without = next((one.file for one in self.recording if one.tip_directions_deg is None), None)
        _raise_if(
            without
            and f"sensor.tip_offset_across_um: needs tip_directions_deg of every recording; {without} has none; add it"
        )
        return self


def load_outline(path: Path) -> PartSection:
    """Read and check the ``[part]`` of a TOML file; the rest of it is passed over.

    Raises
    ------
    InputError
        The file cannot be read, is not TOML, has no such section, or a value breaks a rule.
    """
    values = read_toml(path, "give a file with [part] as in set.toml").get("part")
    if not isinstance(values, dict):
        raise InputError(
            f"{path}: key part is missing; must be a section with length_um and width_um, or "
            "polygon_um; add it"
        )
    keys = "`meso-robust schema recordings`"
    return checked(PartSection, values, f"{path}, part", whole="part", keys=keys)


def load_document(path: Path) -> SetDocument:
    """Read and check a ``set.toml``.

    Parameters
    ----------
    path
        Of the file.

    Returns
    -------
    SetDocument
        Lengths in µm and angles in degrees, as the file has them.

    Raises
    ------
    InputError
        The file cannot be read, is not TOML, or a value breaks a rule; the message names file, key,
        value and rule.
    """
    advice = "give the folder of a recording set"
    return parse_document(read_toml(path, advice), str(path))


def parse_document(values: dict[str, Any], source: str) -> SetDocument:
    """Check the values of a ``set.toml``; ``source`` names them in messages.

    Parameters
    ----------
    values
        As TOML has them.
    source
        What they are from.

    Returns
    -------
    SetDocument
        Checked.

    Raises
    ------
    InputError
        A value breaks a rule.
    """
    keys = "`meso-robust schema recordings`"
    return checked(SetDocument, values, source, whole="set", keys=keys)
