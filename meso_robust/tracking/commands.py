"""Positions of the probes as the controller commanded them, from a CSV file with a clock of its own."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from meso_robust.errors import InputError
from meso_robust.reading import foreign_table, shown, text_of
from meso_robust.recordings.rules import UM
from meso_robust.types import Floats
from meso_robust.wording import counted


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Commands:
    """What the controller was commanded.

    Attributes
    ----------
    names
        P probes.
    times
        (N,) s, strictly increasing, on the clock of the video.
    tips
        (N, P, 2) centres of the tips in m, world; NaN where there was none.
    """

    names: tuple[str, ...]
    times: Floats
    tips: Floats


def read_commands(path: Path) -> Commands:
    """Read ``time_s,<probe>_x_um,<probe>_y_um,…``.

    Raises
    ------
    InputError
        The file cannot be read or a column, a cell or the clock breaks its rule.
    """
    advice = "give --commands a table of the controller"
    text = text_of(path, advice, "a CSV file")
    try:
        rows = list(csv.reader(io.StringIO(text, newline=""), strict=True))
    except csv.Error as error:
        raise InputError(f"{path}: is not a CSV file in UTF-8 ({error}); {advice}") from error
    names = _names(path, rows[0] if rows else [])
    if len(rows) < 2:
        raise InputError(f"--commands {path}: no rows; must have at least one")
    values = np.array([_numbers(path, line, row, rows[0]) for line, row in enumerate(rows[1:], 2)])
    times = values[:, 0]
    late = np.flatnonzero(~(np.diff(times) > 0.0))
    if np.isnan(times).any() or late.size:
        line = int(np.flatnonzero(np.isnan(times))[0] if np.isnan(times).any() else late[0] + 1) + 2
        raise InputError(f"--commands {path}, line {line}: time_s is required and must increase")
    tips = values[:, 1:].reshape(len(values), len(names), 2) * UM
    return Commands(names=names, times=times, tips=tips)


def _names(path: Path, header: list[str]) -> tuple[str, ...]:
    names = tuple(column.removesuffix("_x_um") for column in header[1::2])
    wanted = ["time_s", *(f"{name}_{axis}_um" for name in names for axis in "xy")]
    if not names or header != wanted:
        raise InputError(
            f"--commands {path}: columns {shown(header)}; must be time_s, then "
            "<probe>_x_um, <probe>_y_um of each probe; "
            f"{foreign_table(header, 3) or 'correct the header'}"
        )
    return names


def _numbers(path: Path, line: int, row: list[str], header: list[str]) -> list[float]:
    if len(row) != len(header):
        foreign = foreign_table(row, len(header))
        raise InputError(
            f"--commands {path}, line {line}: {counted(len(row), 'cell')}; must be {len(header)} as in the header"
            + (f"; {foreign}" if foreign else "")
        )
    values = []
    for name, cell in zip(header, row, strict=True):
        try:
            value = float(cell) if cell else math.nan
        except ValueError:
            value = math.inf
        if math.isinf(value) or (cell and math.isnan(value)):
            raise InputError(
                f"--commands {path}, line {line}, column {shown(name)} = {shown(cell)}: must be a finite number, "
                f"or empty; {foreign_table([cell], 1) or 'correct the cell'}"
            )
        values.append(value)
    return values
