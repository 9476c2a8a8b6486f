"""Small files in the formats of others, written from numbers."""

from __future__ import annotations

import gzip
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

MCUBE_NAME = "motion_surface=plywood_shape={shape}_a=0_v=100_i=0.000_s=0.500_t=0.000.json"
START = 1476728847.5  # a Unix time that doubles hold to better than 1 us

Row = Sequence[float]


def mcube(folder: Path, shape: str = "rect1", **streams: Any) -> Path:
    """Write a push of 100 Hz streams; a stream given replaces the written one."""
    t = START + 0.01 * np.arange(6)
    ones = np.ones(6)
    columns = {
        "object_pose": (t, 0.1 * ones, 0.2 * ones, 3.13 + 0.005 * np.arange(6)),
        "tip_pose": (t + 0.004, 1e-3 * np.arange(6), -ones, 0 * ones),
        "ft_wrench": (t + 0.002, 2.0 + np.arange(6), -3.0 * ones, ones),
    }
    content = {name: np.stack(column, axis=-1).tolist() for name, column in columns.items()}
    path = folder / MCUBE_NAME.format(shape=shape)
    path.write_text(json.dumps({**content, **streams}), encoding="utf-8")
    return path


def two_finger(folder: Path, rows: Sequence[Row], name: str = "log2017.txt") -> Path:
    """Write a log."""
    folder.mkdir(parents=True, exist_ok=True)
    text = "".join(",".join(str(cell) for cell in row) + "\n" for row in rows)
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


def support_push(t: float, angle: float = 0.0, forces: Sequence[Row] = ()) -> list[str]:
    """Lines of a push of three tool rows 0.1 s apart, the tool turned by ``angle`` (rad)."""
    half = 0.5 * angle
    quaternion = f"{math.cos(half)} 0 0 {math.sin(half)}"
    quarter = math.sqrt(0.5)
    forces = forces or [(t + 0.05 * k, 0.5 + k, -0.25) for k in range(5)]
    return [
        "100 200 9 1 0 0 0",
        f"110 200 9 {quarter} 0 0 {quarter}",
        str(len(forces)),
        *(" ".join(repr(float(cell)) for cell in row) for row in forces),
        "3",
        *(f"{t + 0.1 * k} {90 + k} 210 20 {quaternion}" for k in range(3)),
    ]


def support_log(folder: Path, lines: Sequence[str], name: str = "exp.txt.gz") -> Path:
    """Write a log, packed if its name ends in .gz."""
    folder.mkdir(parents=True, exist_ok=True)
    text = "\n".join(lines).encode()
    (folder / name).write_bytes(gzip.compress(text) if name.endswith(".gz") else text)
    return folder / name
