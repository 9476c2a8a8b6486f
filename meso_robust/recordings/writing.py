"""A recording set into its folder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from meso_robust.files import write_all
from meso_robust.recordings.document import SCHEMA, SET_FILE, parse_document
from meso_robust.recordings.outline import Polygon, Rectangle
from meso_robust.recordings.rules import DEG, UM
from meso_robust.recordings.table import table_text
from meso_robust.recordings.values import RecordingSet
from meso_robust.toml_files import toml_text


def write_set(folder: Path, recordings: RecordingSet) -> None:
    """Write a recording set so that `read_set` returns it to 1e-6 um, deg and uN.

    Parameters
    ----------
    folder
        Made if needed; files of other names in it stay. ``set.toml`` is put in place last.
    recordings
        The set.

    Raises
    ------
    InputError
        If a value is beyond the limits of the format, or a file cannot be written.
    """
    write_all(folder, set_files(recordings, str(folder / SET_FILE)))


def set_files(recordings: RecordingSet, source: str = SET_FILE) -> dict[str, str]:
    """The texts of the files of a recording set.

    Parameters
    ----------
    recordings
        The set.
    source
        Names ``set.toml`` in messages.

    Returns
    -------
    dict
        A text for each name; ``set.toml`` is last, so that a set that lacks files is never complete.

    Raises
    ------
    InputError
        A value is beyond the limits of the format.
    """
    values = _values(recordings)
    parse_document(values, source)
    tables = {recording.file: table_text(recording) for recording in recordings.recordings}
    return {**tables, SET_FILE: toml_text(values)}


def _values(recordings: RecordingSet) -> dict[str, Any]:
    """Content of ``set.toml``."""
    sensor = recordings.sensor
    sigmas = {
        "position_sigma_um": _in(sensor.position_sigma, UM),
        "orientation_sigma_deg": _in(sensor.orientation_sigma, DEG),
        "tip_sigma_um": _in(sensor.tip_sigma, UM),
        "tip_offset_um": _in(sensor.tip_offset, UM),
        "tip_offset_across_um": _in(sensor.tip_offset_across, UM),
    }
    return {
        "schema": SCHEMA,
        "part": _outline(recordings.part),
        "probe": {
            "tip_radius_um": _in(recordings.tip_radius, UM),
            "position_source": recordings.position_source,
        },
        "sensor": {
            **{key: value for key, value in sigmas.items() if value is not None},
            "frame_rate_hz": float(sensor.frame_rate),
        },
        "recording": [
            {
                "file": recording.file,
                "probes": list(recording.probe_names),
                **_alike(recording.alike_orientations),
                **_directions(recording.tip_directions),
            }
            for recording in recordings.recordings
        ],
    }


def _alike(orientations: int) -> dict[str, int]:
    return {"alike_orientations": orientations} if orientations > 1 else {}


def _directions(angles: tuple[float, ...] | None) -> dict[str, list[float | None]]:
    return {} if angles is None else {"tip_directions_deg": [_in(angle, DEG) for angle in angles]}


def _outline(part: Rectangle | Polygon) -> dict[str, Any]:
    if isinstance(part, Rectangle):
        return {"length_um": _in(part.length, UM), "width_um": _in(part.width, UM)}
    return {"polygon_um": [[_in(x, UM) for x in corner] for corner in part.corners.tolist()]}


def _in(value: float | None, unit: float) -> float | None:
    """A value in the unit, to twelve digits: 12.5e-6 m is 12.5 um, not 12.500000000000002."""
    return None if value is None else float(f"{value / unit:.12g}")
