"""Polygons that are turned between two tips: their tasks, and plans of a few moves for them."""

from __future__ import annotations

from functools import cache
from typing import Any

from meso_robust.task import Task, parse_task
from meso_robust.tasks import L_SHAPE
from tests.polygons import values_of

LONG_L = [
    [-680.0, -280.0], [920.0, -280.0], [920.0, 120.0], [-280.0, 120.0], [-280.0, 520.0],
    [-680.0, 520.0],
]  # fmt: skip
"""um; an L with arms of 1600 and 800 um, 400 um wide, about its centroid."""


@cache
def long_l() -> dict[str, Any]:
    """The values of its task: from the long outer edge to the short one, 90 deg away."""
    values = values_of(L_SHAPE)
    return values


def changed(**changes: Any) -> Task:
    """Its task with some values of its sections changed."""
    values = {key: dict(one) if isinstance(one, dict) else one for key, one in long_l().items()}
    for section, own in changes.items():
        values[section] |= own
    return parse_task(values, "long L")
