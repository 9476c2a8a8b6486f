"""CSV files of a recording set: text to a recording and back.

Columns are found by their names, in any order. They are written in the order time, part, positions
of each probe, forces of each probe.
"""

from __future__ import annotations

import csv
import io
import math
import re
from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from meso_robust.errors import InputError
from meso_robust.reading import foreign_table, like, shown, text_of
from meso_robust.recordings.rules import CLOCK_RULE, DEG, UM
from meso_robust.recordings.values import Recording
from meso_robust.types import Floats, Indices
from meso_robust.wording import counted

TIME = "time_s"
POSE = ("part_x_um", "part_y_um", "part_theta_deg")
_LARGEST = (
    1e15  # in any unit of the format; what is larger is no measurement, and its square counts
)
_CORRECT = "correct the cell"
_ADVICE = "correct its name in set.toml or add the file"
_POSE_UNITS = np.array([UM, UM, DEG])
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)


def forward(times: Floats) -> Indices:
    """Indices of as many instants as possible that increase strictly.

    If it loses no more rows, every instant that is later than all before it is kept; else one
    instant far ahead would throw out all that follow, and a longest increasing subsequence is taken
    (Schensted 1961, doi:10.4153/CJM-1961-015-3). Of equal instants the first is kept.

    Parameters
    ----------
    times
        (T,) finite instants.
    """
    if not times.size:
        return np.zeros(0, dtype=np.intp)
    later = np.ones(times.size, dtype=bool)
    later[1:] = times[1:] > np.maximum.accumulate(times)[:-1]
    longest = _longest(times.tolist())
    return np.flatnonzero(later) if later.sum() >= longest.size else longest


def _longest(times: Sequence[float]) -> Indices:
    """Longest strictly increasing subsequence by patience sorting."""
    ends: list[float] = []  # smallest last instant of an increasing run of each length
    at: list[int] = []  # its index
    before = np.full(len(times), -1, dtype=np.intp)
    for k, time in enumerate(times):
        length = bisect_left(ends, time)
        before[k] = at[length - 1] if length else -1
        if length == len(ends):
            ends.append(time)
            at.append(k)
        elif time < ends[length]:
            ends[length], at[length] = time, k
    chain = [at[-1]]
    while before[chain[-1]] >= 0:
        chain.append(int(before[chain[-1]]))
    return np.array(chain[::-1], dtype=np.intp)


@dataclass(frozen=True, slots=True)
class Fault:
    """A row or cell that breaks a rule, and the line it ends at."""

    line: int
    kind: Literal["row", "cell", "clock"]
    value: str
    rule: str
    advice: str

    def __str__(self) -> str:
        """As it stands after the name of the file in a message."""
        between = ": " if self.kind == "row" else ", "
        then = ": " if self.kind == "cell" else "; "
        return f", line {self.line}{between}{self.value}{then}{self.rule}; {self.advice}"


@dataclass(frozen=True, slots=True)
class Table:
    """What could be read of a recording, the lines of its rows, and what could not."""

    recording: Recording
    lines: tuple[int, ...]
    faults: tuple[Fault, ...]


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
        In SI, NaN where a cell is empty, angles as stored in the file.

    Raises
    ------
    InputError
        The file cannot be read, a column is missing, unknown or double, a row is too short or too
        long, a cell is not a number, or the clock does not advance; the message names file, line,
        column, value and rule.
    """
    table = read_readable(path, probes)
    for fault in table.faults:
        raise InputError(f"{path}{fault}")
    return table.recording


def read_readable(path: Path, probes: Sequence[str]) -> Table:
    """Read what can be read of a recording, and list every row and cell that cannot.

    Rows of the wrong length or without an instant, and the fewest rows that must go for the clock
    to run forward, are left out; a cell that is not a number becomes NaN.

    Raises
    ------
    InputError
        Nothing can be read: no file, no CSV, wrong columns, no row left.
    """
    header, rows, lines = _cells(path)
    faults = [fault for fault in map(_row_fault(header), rows, lines) if fault]
    _check_header(path, header, probes)
    whole = [k for k, row in enumerate(rows) if len(row) == len(header)]
    rows, lines = [rows[k] for k in whole], [lines[k] for k in whole]
    columns = {}
    for k, name in enumerate(header):
        columns[name], wrong = _column(name, [row[k] for row in rows], lines)
        faults += wrong
    timed = np.flatnonzero(np.isfinite(columns[TIME]))
    kept = timed[forward(columns[TIME][timed])]
    faults += _clock_faults(columns[TIME], timed, kept, lines)
    if not kept.size:
        raise InputError(
            f"{path}{faults[0]}"
            if faults
            else f"{path}: no rows; must have at least one; leave the recording out"
        )
    columns = {name: values[kept] for name, values in columns.items()}
    recording = Recording(
        file=path.name,
        probe_names=tuple(probes),
        times=columns[TIME],
        poses=np.stack([columns[name] for name in POSE], axis=-1) * _POSE_UNITS,
        probes=_pairs(columns, [_positions(probe) for probe in probes]),
        forces=_pairs(columns, [_forces(probe) for probe in probes])
        if any(_forces(probe)[0] in columns for probe in probes)
        else None,
    )
    return Table(recording, tuple(lines[k] for k in kept), tuple(faults))


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
    """Header, rows and the lines that they end at."""
    try:
        text = text_of(path, _ADVICE, "a CSV file").rstrip("\r\n")
        reader = csv.reader(io.StringIO(text, newline=""), strict=True)
        table = [(row, reader.line_num) for row in reader]
    except csv.Error as error:
        raise InputError(f"{path}: is not a CSV file in UTF-8 ({error}); {_ADVICE}") from error
    header = table[0][0] if table else []
    return header, [row for row, _ in table[1:]], [line for _, line in table[1:]]


def _row_fault(header: Sequence[str]) -> Callable[[Sequence[str], int], Fault | None]:
    def fault(row: Sequence[str], line: int) -> Fault | None:
        if len(row) == len(header):
            return None
        rule = f"must be {len(header)} as in the header"
        advice = foreign_table(row, len(header)) or "leave a cell empty where nothing was seen"
        return Fault(line, "row", counted(len(row), "cell"), rule, advice)

    return fault


def _check_header(path: Path, header: Sequence[str], probes: Sequence[str]) -> None:
    needed = [TIME, *POSE, *(name for probe in probes for name in _positions(probe))]
    forces = [_forces(probe) for probe in probes]
    for pair in forces:  # one of a pair asks for the other
        needed += pair if set(pair) & set(header) else []
    known = {*needed, *(name for pair in forces for name in pair)}
    foreign = foreign_table(header, len(needed)) if len(header) < len(needed) else ""
    if foreign:
        raise InputError(f"{path}: header {shown(','.join(header))}; {foreign}")
    for name in header:
        if header.count(name) > 1:
            raise InputError(f"{path}: duplicate column {name!r}; leave one out")
        if name not in known:
            rule = f"must be one of {', '.join(needed)}"
            raise InputError(
                f"{path}: column {name!r} is unknown; {rule}; {like(name, known)}correct the name or set.toml"
            )
    for name in needed:
        if name not in header:
            raise InputError(f"{path}: column {name!r} is missing; add it, empty where not seen")


def _column(name: str, cells: Sequence[str], lines: Sequence[int]) -> tuple[Floats, list[Fault]]:
    """Values of a column as they stand, NaN where a cell is empty or no number; what is wrong."""
    values = [_number(cell) for cell in cells]
    rule = "must be a finite number" + ("" if name == TIME else ", or empty where not seen")
    faults: list[Fault] = []
    for k, (cell, value) in enumerate(zip(cells, values, strict=True)):
        if value is None or (name == TIME and math.isnan(value)):
            advice = foreign_table([cell], 1) or _CORRECT
            faults.append(Fault(lines[k], "cell", f"column {name} = {cell!r}", rule, advice))
        elif abs(value) > _LARGEST:
            values[k] = None
            large = f"must be at most {_LARGEST:g} in size"
            faults.append(Fault(lines[k], "cell", f"column {name} = {cell!r}", large, _CORRECT))
    return np.array([math.nan if v is None else v for v in values], dtype=np.float64), faults


def _clock_faults(
    times: Floats, timed: Indices, kept: Indices, lines: Sequence[int]
) -> list[Fault]:
    """The rows that were left out because the clock does not advance there."""
    faults = []
    for k in np.setdiff1d(timed, kept).tolist():
        before, after = kept[kept < k], kept[kept > k]
        rule, advice = CLOCK_RULE, "sort the rows, keep one of each instant"
        if before.size and times[k] <= times[before[-1]]:
            rule += f", {times[before[-1]]} s"
        else:
            rule = f"must be before the instant of the row after, {times[after[0]]} s"
            advice = "leave the row out"
        faults.append(Fault(lines[k], "clock", f"column {TIME} = {times[k]} s", rule, advice))
    return faults


def _number(cell: str) -> float | None:
    """Value of a cell, NaN if it is empty, None if it is not a finite number."""
    if not cell:
        return math.nan
    if not _NUMBER.fullmatch(cell):
        return None
    value = float(cell)
    return value if math.isfinite(value) else None
