"""What is claimed of a box, held against its points by the planner's formulas."""

from __future__ import annotations

import numpy as np

from meso_robust.campaigns.mutation.along_runs import ALONG
from meso_robust.campaigns.mutation.places import Document
from meso_robust.conditions import values
from meso_robust.conditions.formula import inputs
from meso_robust.primitives.names import Inequality
from meso_robust.types import Floats

POINTS = 20000

PLAIN = {
    Inequality.TRAVEL: lambda p: [p["travel"]],
    Inequality.WITHIN_EDGE: lambda p: [p["half"] - np.abs(p["d2"])],
    Inequality.BETWEEN_CORNERS: lambda p: [p["d2"] - p["first"], p["last"] - p["d2"]],
    Inequality.TOUCH_BEFORE_END: lambda p: [p["h_start"] - p["h_end"]],
    Inequality.FACES_BACK: lambda p: [np.sin(p["theta"])],
}
"""Inequalities that no generated formula states."""
VARIABLES = {
    Inequality.TRAVEL: {"travel"},
    Inequality.WITHIN_EDGE: {"half", "d2"},
    Inequality.BETWEEN_CORNERS: {"d2", "first", "last"},
    Inequality.TOUCH_BEFORE_END: {"h_start", "h_end"},
    Inequality.FACES_BACK: {"theta"},
}
"""What they are about."""


def of_formula(stated: Document) -> bool:
    """Whether the box of an inequality is one of the planner's formula, or of none."""
    inequality = Inequality(stated["inequality"])
    if inequality in PLAIN:
        return set(stated["over"]) == VARIABLES[inequality]
    if inequality in ALONG or inequality.derivation is None:
        return True
    return set(stated["over"]) == set(inputs(*inequality.split(".")))


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
    inequality = Inequality(stated["inequality"])
    rows = _rows(inequality, points)
    if rows is None:
        return None
    return float(rows.max(axis=0).min() if inequality.any_value else rows.min())


def _rows(inequality: Inequality, points: dict[str, Floats]) -> Floats | None:
    if inequality in PLAIN:
        return np.array(PLAIN[inequality](points))
    if inequality in ALONG or inequality.derivation is None:
        return None
    return np.array(values(*inequality.split("."))(**points))
