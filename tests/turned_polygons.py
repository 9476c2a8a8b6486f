"""Polygons that are turned between two tips: tasks, and what is planned for them."""

from __future__ import annotations

from functools import cache
from typing import Any

from meso_robust.certificates.chain import Chain, certify
from meso_robust.planning.compose import robust_at
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task, parse_task
from meso_robust.tasks import L_SHAPE, PAPER
from tests.polygons import values_of

LONG_L = [
    [-666.7, -333.3], [933.3, -333.3], [933.3, 66.7], [133.3, 66.7], [133.3, 466.7],
    [-666.7, 466.7],
]  # fmt: skip
"""um; 1600 by 800 um without 800 by 400 um at one corner, about the centroid."""
CUT_PEG = [[-796.9, -413.2], [819.1, -413.2], [819.1, 223.8], [619.1, 423.8], [-796.9, 423.8]]
"""um; the paper's peg without a corner, about the centroid."""


def long_l() -> dict[str, Any]:
    """From the long outer edge of the L to the short one, 90 deg away, with round tips."""
    values = values_of(L_SHAPE)
    values["part"] = {"polygon_um": LONG_L}
    values["start"] = {"x_um": 1800.0, "y_um": 120.0, "theta_deg": 90.0}
    values["goal"] |= {"theta_deg": 180.0, "position_tolerance_um": 76.0}
    values["probe"]["tip_spacing_um"] = 580.0
    values["uncertainty"]["film_ratio_um2"] = 244444.0
    return values


def cut_peg() -> dict[str, Any]:
    """The paper's task with that peg, on an even film."""
    values = values_of(PAPER)
    values["part"] = {"polygon_um": CUT_PEG}
    values["uncertainty"]["film_ratio_um2"] = 269820.0
    return values


TURNED = {"long L": long_l, "cut peg": cut_peg}


def changed(name: str, **sections: dict[str, Any]) -> Task:
    """One of these tasks with some values of its sections changed."""
    values = TURNED[name]()
    for section, own in sections.items():
        values[section] |= own
    return parse_task(values, name)


@cache
def turned(name: str) -> tuple[Task, tuple[MoveRule, ...], Chain]:
    """One of these tasks, a plan with something in hand, and its certified chain."""
    task = changed(name)
    rules = robust_at(task, 1.1)
    assert rules is not None
    return task, rules, certify(rules, setup_of(task))
