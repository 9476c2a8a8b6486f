"""A recording set from its folder."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from meso_robust.errors import InputError
from meso_robust.recordings.document import (
    SET_FILE,
    PartSection,
    RecordingSection,
    SensorSection,
    SetDocument,
    load_document,
    load_outline,
)
from meso_robust.recordings.outline import Polygon, Rectangle
from meso_robust.recordings.rules import DEG, UM
from meso_robust.recordings.table import read_table
from meso_robust.recordings.values import Recording, RecordingSet, SensorInfo


def read_set(folder: Path) -> RecordingSet:
    """Read and check the form of a recording set; its content is taken as it is.

    Parameters
    ----------
    folder
        Folder with ``set.toml`` and the CSV files named there; other files are passed over.

    Returns
    -------
    RecordingSet
        In SI; angles may wrap, see `unwrapped`.

    Raises
    ------
    InputError
        A file cannot be read or breaks a rule; the message names file, key or line, value and rule.
    """
    document = load_document(folder / SET_FILE)
    recordings = [
        stated(read_table(folder / one.file, one.probes), one) for one in document.recording
    ]
    return assembled(document, folder, recordings)


def read_outline(path: Path) -> Rectangle | Polygon:
    """Read the outline that a TOML file states as ``set.toml`` does.

    Parameters
    ----------
    path
        Of the file.

    Returns
    -------
    Rectangle or Polygon
        In m.

    Raises
    ------
    InputError
        As for `load_outline`.
    """
    return _part(load_outline(path), path)


def stated(recording: Recording, section: RecordingSection) -> Recording:
    """A recording with what ``set.toml`` states of it beside its table."""
    angles = section.tip_directions_deg
    return replace(
        recording,
        alike_orientations=section.alike_orientations,
        tip_directions=None if angles is None else tuple(angle * DEG for angle in angles),
    )


def assembled(document: SetDocument, folder: Path, recordings: Sequence[Recording]) -> RecordingSet:
    """Put a set together from its checked ``set.toml`` and its recordings.

    Raises
    ------
    InputError
        The outline has no extent in metres; ``folder`` is named in the message.
    """
    return RecordingSet(
        part=_part(document.part, folder / SET_FILE),
        tip_radius=document.probe.tip_radius_um * UM,
        position_source=document.probe.position_source,
        sensor=_sensor(document.sensor),
        recordings=tuple(recordings),
    )


def _part(section: PartSection, path: Path) -> Rectangle | Polygon:
    if section.length_um is not None and section.width_um is not None:
        return Rectangle(length=section.length_um * UM, width=section.width_um * UM)
    try:
        return Polygon(corners=np.array(section.polygon_um) * UM)
    except ValueError as error:  # corners so close that they meet in metres
        raise InputError(f"{path}: key part.polygon_um, in metres: {error}") from error


def _sensor(section: SensorSection) -> SensorInfo:
    position, orientation = section.position_sigma_um, section.orientation_sigma_deg
    tip, offset = section.tip_sigma_um, section.tip_offset_um
    across = section.tip_offset_across_um
    return SensorInfo(
        frame_rate=section.frame_rate_hz,
        position_sigma=None if position is None else position * UM,
        orientation_sigma=None if orientation is None else orientation * DEG,
        tip_sigma=None if tip is None else tip * UM,
        tip_offset=None if offset is None else offset * UM,
        tip_offset_across=None if across is None else across * UM,
    )
