"""What was seen as one long table: for data frames, Parquet and HDF5, with the extra ``tables``."""

from __future__ import annotations

import io
from collections.abc import Sequence
from importlib import import_module
from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from meso_robust.errors import InputError
from meso_robust.recordings.rules import DEG, UM
from meso_robust.tracking.track import Track

Format: TypeAlias = Literal["parquet", "hdf5"]
FILES: dict[Format, str] = {"parquet": "track.parquet", "hdf5": "track.h5"}
"""Names of the files."""
WRITERS: dict[Format, str] = {"parquet": "pyarrow", "hdf5": "h5py"}
"""What writes them."""


def columns(tracks: Sequence[Track], names: Sequence[str]) -> dict[str, npt.NDArray[Any]]:
    """Equally long columns, a row for every frame of every video.

    Parameters
    ----------
    tracks
        What was seen.
    names
        Of the recordings made of them.

    Returns
    -------
    dict
        Recording, frame, instant, pose with standard deviations, state and reason, and tips with
        standard deviations; units are in the names, NaN is "not seen".
    """
    found: dict[str, list[Any]] = {}
    probes = sorted({name for track in tracks for name in track.names})
    for track, recording in zip(tracks, names, strict=True):
        count = len(track.times)
        sigma = np.sqrt(np.diagonal(track.covariances, axis1=1, axis2=2))
        rows: dict[str, Any] = {
            "recording": np.full(count, recording, dtype=object),
            "frame": np.arange(count),
            "time_s": track.times,
        }
        for k, (key, unit) in enumerate((("x_um", UM), ("y_um", UM), ("theta_deg", DEG))):
            rows[f"part_{key}"] = track.poses[:, k] / unit
            rows[f"part_{key.replace('_', '_sigma_')}"] = sigma[:, k] / unit
        rows["state"] = np.array(track.states, dtype=object)
        rows["reason"] = np.array(track.reasons, dtype=object)
        nothing = np.full(count, np.nan)
        for name in probes:
            p = track.names.index(name) if name in track.names else None
            for k, axis in enumerate("xy"):
                seen = p is not None
                rows[f"{name}_{axis}_um"] = track.tips[:, p, k] / UM if seen else nothing
                rows[f"{name}_{axis}_sigma_um"] = (
                    np.sqrt(track.tip_covariances[:, p, k, k]) / UM if seen else nothing
                )
        for key, values in rows.items():
            found.setdefault(key, []).append(values)
    return {key: np.concatenate(parts) for key, parts in found.items()}


def frame(table: dict[str, npt.NDArray[Any]]) -> Any:
    """The table as a ``pandas.DataFrame``.

    Parameters
    ----------
    table
        Of `columns`.

    Returns
    -------
    pandas.DataFrame
        With the same columns.

    Raises
    ------
    InputError
        Pandas is not installed.
    """
    return needed("pandas", "to_frame").DataFrame(table)


def packed(table: dict[str, npt.NDArray[Any]], form: Format) -> bytes:
    """The table as the content of a Parquet or an HDF5 file; in the latter a data set is a column.

    Raises
    ------
    InputError
        What writes it is not installed.
    """
    out = io.BytesIO()
    if form == "parquet":
        arrow = needed("pyarrow", "--tables parquet")
        needed("pyarrow.parquet", "--tables parquet").write_table(arrow.table(table), out)
    else:
        with needed("h5py", "--tables hdf5").File(out, "w") as file:
            for name, values in table.items():
                file.create_dataset(name, data=values)
    return out.getvalue()


def needed(module: str, what: str) -> Any:
    """A module of the extra ``tables``.

    Parameters
    ----------
    module
        Its name.
    what
        What asks for it, for the message.

    Returns
    -------
    module
        Imported.

    Raises
    ------
    InputError
        It is not installed.
    """
    try:
        return import_module(module)
    except ImportError as error:
        raise InputError(
            f"{what}: needs {module.partition('.')[0]}, which is not installed; install the project with "
            "its extra `tables`"
        ) from error
