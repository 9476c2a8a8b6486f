"""What is claimed of a box, held against its points by the planner's formulas."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from meso_robust.admissibility import values
from meso_robust.campaigns.mutation.places import Document

Floats = npt.NDArray[np.float64]
POINTS = 20000

PLAIN = {
    "travel > 0": lambda p: [p["travel"]],
    "half - |d2| > 0": lambda p: [p["half"] - np.abs(p["d2"])],
    "d2 - first > 0 and last - d2 > 0": lambda p: [p["d2"] - p["first"], p["last"] - p["d2"]],
    "h at the touch > h at the end": lambda p: [p["h_start"] - p["h_end"]],
    "sin(theta) > 0 at the end": lambda p: [np.sin(p["theta"])],
}
"""Inequalities that no generated formula states."""


def least(stated: Document) -> float | None:
    """The smallest value of an inequality's left side at points of its box, corners included.

    By the planner's formula. None if it is no formula of the box's variables.
    """
    over = {name: [float.fromhex(end) for end in ends] for name, ends in stated["over"].items()}
    rng = np.random.default_rng(0)
    inside = {
        name: low + (high - low) * rng.random(POINTS) for name, (low, high) in sorted(over.items())
    }
    corners = np.array(np.meshgrid(*(over[name] for name in inside))).reshape(len(over), -1)
    points = {name: np.concatenate([inside[name], corners[k]]) for k, name in enumerate(inside)}
    rows = _rows(stated["inequality"], points)
    if rows is None:
        return None
    return float(rows.max(axis=0).min() if "at least one" in stated["inequality"] else rows.min())


def _rows(text: str, points: dict[str, Floats]) -> Floats | None:
    if text in PLAIN:
        return np.array(PLAIN[text](points))
    if "(" not in text:
        return None
    module, name = text.split("(")[0].split(".")
    return np.array(values(module, name)(**points))
