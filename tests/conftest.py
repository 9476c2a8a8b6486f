"""Fixtures that are costly enough to be shared."""

from __future__ import annotations

import tomllib
from typing import Any

import pytest

from meso_robust.job import Planned, make
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


@pytest.fixture(scope="session")
def paper_plan() -> Planned:
    """The main job on the paper's task, with the 1,000 runs that the task asks for."""
    return make(paper_task(), 1000, 0)


@pytest.fixture(scope="session")
def wide_friction_plan() -> Planned:
    """The same task with friction anywhere from 0.05 to 0.9."""
    return make(paper_task(uncertainty__friction=[0.05, 0.9]), 100, 0)
