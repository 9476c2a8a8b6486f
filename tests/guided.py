"""The task with the slot from a part that lies before its mouth, pushed by a probe whose travel is askew."""

from __future__ import annotations

import tomllib
from functools import cache
from typing import Any

from meso_robust.planning.compose import compose
from meso_robust.primitives.move import MoveRule
from meso_robust.task import Task, parse_task
from tests.slot import SLOT


def guided_task(**changes: Any) -> Task:
    """Travel 1.6 deg askew takes the part onto a wall; ``changes`` are ``section__key``."""
    values = tomllib.loads(SLOT.read_text(encoding="utf-8"))
    values["probe"]["headings"] = ["-x"]
    values["start"] |= {"y_um": 0.0, "theta_deg": 180.0}
    values["uncertainty"]["travel_direction_deg"] = [-1.6, 1.6]
    for key, value in changes.items():
        section, name = key.split("__")
        values[section][name] = value
    return parse_task(values, "slot task")


@cache
def guided_rules() -> tuple[MoveRule, ...]:
    """Its plan: a push up to the mouth and one along the walls."""
    return compose(guided_task()).rules
