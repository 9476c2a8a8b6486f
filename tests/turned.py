"""The paper's task and plan as seen from other axes: turned by quarter turns, mirrored."""

from __future__ import annotations

import itertools
import tomllib
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from meso_robust.planning.compose import compose
from meso_robust.primitives.frame import HEADINGS, Frame
from meso_robust.primitives.move import MoveRule
from meso_robust.task import Task, parse_task
from meso_robust.tasks import PAPER

FRAMES = tuple(
    Frame(heading=heading, mirrored=mirrored)
    for heading, mirrored in itertools.product(HEADINGS, (False, True))
)
HALF = (*FRAMES[::4], *FRAMES[3::4])
"""Each heading, half of them mirrored: for tests of seconds."""


def turned_task(frame: Frame, **changes: Any) -> Task:
    """The paper's task with changes (``section__key=value``), start and goal seen from axes.

    The range of the misalignment is symmetric, so that it is the same in all of them.
    """
    values = tomllib.loads(PAPER.read_text(encoding="utf-8"))
    for name, value in changes.items():
        section, key = name.split("__")
        values[section][key] = value
    sign = -1.0 if frame.mirrored else 1.0
    for pose in (values["start"], values["goal"]):
        x, y = frame.matrix @ [pose["x_um"], pose["y_um"]]
        theta = sign * pose["theta_deg"] + 90.0 * frame.quarters
        pose |= {"x_um": float(x), "y_um": float(y), "theta_deg": (theta + 180.0) % 360.0 - 180.0}
    return parse_task(values, "turned task")


@cache
def _paper_rules() -> tuple[MoveRule, ...]:
    return compose(parse_task(tomllib.loads(PAPER.read_text(encoding="utf-8")), "paper")).rules


def turned_rules(frame: Frame) -> tuple[MoveRule, ...]:
    """The moves of the paper's plan in these axes."""
    rules = _paper_rules()
    if any(rule.frame != Frame() for rule in rules):
        raise ValueError("the paper's plan pushes along -x, not mirrored")
    return tuple(replace(rule, frame=frame) for rule in rules)


def tips_by_hand(frame: Frame, middle: Any, spacing: float, beta: float) -> Any:
    """(2, 2) the right-hand and the left-hand tip of a pair, seen along its heading.

    ``beta`` is the misalignment: how far the right-hand tip is ahead of the middle follows from it.
    """
    heading = np.array({"-x": (-1, 0), "+x": (1, 0), "-y": (0, -1), "+y": (0, 1)}[frame.heading])
    right = np.array([heading[1], -heading[0]])
    off = 0.5 * spacing * (right + np.tan(beta) * heading)
    return np.stack([middle + off, middle - off])
