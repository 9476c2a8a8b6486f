"""CSV files of a recording set: text to a recording and back.

Columns are found by their names, in any order. They are written in the order time, part, positions
of each probe, forces of each probe.
"""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from meso_robust.errors import InputError
from meso_robust.recordings.rules import DEG, UM, clock_fault
from meso_robust.recordings.values import Recording

Floats = npt.NDArray[np.float64]

TIME = "time_s"
POSE = ("part_x_um", "part_y_um", "part_theta_deg")
_POSE_UNITS = np.array([UM, UM, DEG])
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)


def read_table(path: Path, probes: Sequence[str]) -> Recording:
    """Read and check one recording.

    Parameters
    ----------
    path
        The CSV file, in UTF-8.
    probes
        Names of the probes, as in ``set.toml``.

    Returns
    -------
    Recording
        In SI, NaN where a cell is empty, angles as they stand in the file.

    Raises
    ------
    InputError
        The file cannot be read, a column is missing, unknown or double, a row is too short or too
        long, a cell is no number, or the clock does not go on; the message names file, line,
        column, value and rule.
    """
    header, rows, lines = _cells(path)
    _check_header(path, header, probes)
    if not rows:
        raise InputError(f"{path}: no rows; must have at least one; leave the recording out")
    columns = {
        name: _column(path, name, [row[k] for row in rows], lines) for k, name in enumerate(header)
    }
    fault = clock_fault(columns[TIME])
    if fault:
        raise InputError(f"{path}, line {lines[fault[0]]}, column {TIME} = {fault[1]}")
    return Recording(
        file=path.name,
        probe_names=tuple(probes),
        times=columns[TIME],
        poses=np.stack([columns[name] for name in POSE], axis=-1) * _POSE_UNITS,
        probes=_pairs(columns, [_positions(probe) for probe in probes]),
        forces=_pairs(columns, [_forces(probe) for probe in probes])
        if any(_forces(probe)[0] in columns for probe in probes)
        else None,
    )


def table_text(recording: Recording) -> str:
    """Text of the CSV file of a recording: um, deg and uN to six decimals, times exactly."""
    names = recording.probe_names
    header = [TIME, *POSE, *(name for probe in names for name in _positions(probe))]
    rows = recording.times.size
    blocks = [recording.poses / _POSE_UNITS, recording.probes.reshape(rows, -1) / UM]
    if recording.forces is not None:
        header += [name for probe in names for name in _forces(probe)]
        blocks.append(recording.forces.reshape(rows, -1) / UM)
    values = np.concatenate(blocks, axis=1).tolist()
    lines = [",".join(header)]
    for time, row in zip(recording.times.tolist(), values, strict=True):
        lines.append(",".join([repr(time), *map(_cell, row)]))
    return "\n".join(lines) + "\n"


def _positions(probe: str) -> tuple[str, str]:
    return f"{probe}_x_um", f"{probe}_y_um"


def _forces(probe: str) -> tuple[str, str]:
    return f"{probe}_fx_un", f"{probe}_fy_un"


def _cell(value: float) -> str:
    return "" if math.isnan(value) else f"{value:z.6f}"


def _pairs(columns: dict[str, Floats], names: Sequence[tuple[str, str]]) -> Floats:
    """(T, P, 2) of pairs of columns; NaN for a pair that is not there."""
    rows = columns[TIME].size
    unseen = np.full(rows, np.nan)
    flat = [columns.get(name, unseen) for pair in names for name in pair]
    return np.array(flat).reshape(len(names), 2, rows).transpose(2, 0, 1) * UM


def _cells(path: Path) -> tuple[list[str], list[list[str]], list[int]]:
    """Header, rows and the lines that they end at; every row as long as the header."""
    try:
        text = path.read_text(encoding="utf-8-sig").rstrip("\r\n")  # spreadsheets write the mark
        reader = csv.reader(io.StringIO(text, newline=""), strict=True)
        table = [(row, reader.line_num) for row in reader]
    except OSError as error:
        raise InputError(
            f"{path}: cannot be read ({error.strerror}); mend its name in set.toml or add the file"
        ) from error
    except (csv.Error, UnicodeDecodeError) as error:
        raise InputError(f"{path}: is not a CSV file in UTF-8 ({error})") from error
    header = table[0][0] if table else []
    for row, line in table[1:]:
        if len(row) != len(header):
            raise InputError(
                f"{path}, line {line}: {len(row)} cells; must be {len(header)} as in the header; "
                "leave a cell empty where nothing was seen"
            )
    return header, [row for row, _ in table[1:]], [line for _, line in table[1:]]


def _check_header(path: Path, header: Sequence[str], probes: Sequence[str]) -> None:
    needed = [TIME, *POSE, *(name for probe in probes for name in _positions(probe))]
    forces = [_forces(probe) for probe in probes]
    for pair in forces:  # one of a pair asks for the other
        needed += pair if set(pair) & set(header) else []
    known = {*needed, *(name for pair in forces for name in pair)}
    for name in header:
        if header.count(name) > 1:
            raise InputError(f"{path}: column {name!r} stands twice; leave one out")
        if name not in known:
            rule = f"must be one of {', '.join(needed)}"
            raise InputError(
                f"{path}: column {name!r} is unknown; {rule}; mend the name or set.toml"
            )
    for name in needed:
        if name not in header:
            raise InputError(f"{path}: column {name!r} is missing; add it, empty where not seen")


def _column(path: Path, name: str, cells: Sequence[str], lines: Sequence[int]) -> Floats:
    """Values of a column as they stand; NaN where a cell is empty."""
    values = [_number(cell) for cell in cells]
    for cell, value, line in zip(cells, values, lines, strict=True):
        if value is None or (name == TIME and math.isnan(value)):
            rule = "must be a finite number" + ("" if name == TIME else ", or empty where not seen")
            raise InputError(
                f"{path}, line {line}, column {name} = {cell!r}: {rule}; mend the cell"
            )
    return np.array(values, dtype=np.float64)


def _number(cell: str) -> float | None:
    """Value of a cell, NaN if it is empty, None if it is no finite number."""
    if not cell:
        return math.nan
    if not _NUMBER.fullmatch(cell):
        return None
    value = float(cell)
    return value if math.isfinite(value) else None
