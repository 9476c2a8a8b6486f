"""The task with the slot for point tips and from farther away, about which more can be said by hand."""

from __future__ import annotations

import tomllib
from typing import Any

from meso_robust.task import Task, parse_task
from meso_robust.tasks import PAPER

SLOT = PAPER.with_name("slot.toml")


def point_slot(**changes: Any) -> Task:
    """Of 974 um, entered by the four moves of the paper's plan; ``changes`` are of the slot."""
    values = tomllib.loads(SLOT.read_text(encoding="utf-8"))
    values["schema"] = "meso-robust/task/1"
    del values["probe"]["tip_radius_um"]
    values["start"]["x_um"] = 3400.0
    values["slot"] |= {"width_um": 974.0} | changes
    return parse_task(values, "slot task")
