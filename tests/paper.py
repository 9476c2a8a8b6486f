"""The paper's task with changes, for tests and for the programs in ``reports/``."""

from __future__ import annotations

import tomllib
from typing import Any

from meso_robust.task import Task, parse_task
from meso_robust.tasks import PAPER

Values = dict[str, Any]


def paper_task(**changes: Any) -> Task:
    """The paper's task with changes, each given as ``section__key=value``."""
    values: Values = tomllib.loads(PAPER.read_text(encoding="utf-8"))
    for name, value in changes.items():
        section, key = name.split("__")
        values[section][key] = value
    return parse_task(values, "changed paper task")
