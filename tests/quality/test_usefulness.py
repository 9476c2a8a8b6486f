"""Named cases that must stay PROVED: bounds that are sound but too wide would lose them."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from typing import Any

import pytest

from meso_robust import units
from meso_robust.bounds import HALF_PI, Interval, Verdict, prove_positive
from meso_robust.certificates.chain import certify
from meso_robust.conditions import condition
from meso_robust.planning.compose import compose
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task, parse_task
from meso_robust.tasks import PAPER

Changes = Mapping[str, Mapping[str, Any]]


def task_with(changes: Changes) -> Task:
    values = tomllib.loads(PAPER.read_text(encoding="utf-8"))
    for section, entries in changes.items():
        values[section].update(entries)
    return parse_task(values, "a changed shipped task")


PLANS: dict[str, tuple[Changes, int, float]] = {
    # changes of the shipped task, number of moves, least scale of the uncertainties
    "shipped": ({}, 4, 1.2),
    "no Y-translation asked for": ({"plan": {"least_y_translations": 0}}, 2, 1.2),
    "start above the axis": ({"start": {"y_um": 9.0}}, 4, 1.2),
    "start 25 um above the axis": ({"start": {"y_um": 25.0}}, 4, 1.2),
    "start turned by 3 deg": ({"start": {"theta_deg": 93.0}}, 4, 1.0),
    "goal of 55 um": ({"goal": {"position_tolerance_um": 55.0}}, 4, 1.2),
    "no turn": ({"goal": {"theta_deg": 90.0}}, 1, 1.2),
}


@pytest.mark.parametrize("name", PLANS)
def test_a_plan_is_found_and_proved(name: str) -> None:
    changes, moves, scale = PLANS[name]
    task = task_with(changes)
    found = compose(task)
    assert found.scale >= scale
    assert len(found.rules) == moves
    assert certify(found.rules, setup_of(task)).verdict is Verdict.PROVED


def test_the_plan_bears_a_fifth_more_of_every_uncertainty() -> None:
    task = task_with({})
    assert certify(compose(task).rules, setup_of(task, 1.2)).verdict is Verdict.PROVED


def um(low: float, high: float) -> Interval:
    return units.metres(low).hull(units.metres(high))


WIDTH = units.metres(418.5)
FILM = units.square_metres(376900.0 * 0.95).hull(units.square_metres(376900.0 * 1.05))
FRICTION = units.plain(0.30).hull(units.plain(0.36))
UPRIGHT = HALF_PI + units.radians(-0.3).hull(units.radians(5.0))
INEQUALITIES: dict[str, tuple[str, dict[str, Interval], int]] = {
    # condition, box, most boxes the proof may take
    "a tip 330 um above the middle sticks over 5 deg": (
        "one_point_sticking.friction_margin",
        {"theta": UPRIGHT, "d1": WIDTH, "d2": um(310, 350), "rho": FILM, "mu": FRICTION},
        1,
    ),
    "a tip up to 380 um from the middle of an upright edge sticks": (
        "one_point_sticking.friction_margin",
        {
            "theta": HALF_PI,
            "d1": WIDTH,
            "d2": um(-380, 380),
            "rho": FILM,
            "mu": FRICTION,
        },
        1,
    ),
    "nothing slips beside sticking, anywhere on the edge": (
        "one_point_sticking.only_solution",
        {"d1": WIDTH, "d2": um(-808, 808), "rho": FILM, "mu": FRICTION},
        16,
    ),
    "both of two tips push over 2 deg of misalignment": (
        "two_point_sticking.normal_forces",
        {
            "beta": units.radians(-2.0).hull(units.radians(2.0)),
            "d1": WIDTH,
            "d2": um(200, 380),
            "d4": units.metres(580.0),
        },
        1,
    ),
    "a pair of tips sticks up to 16.6 deg of misalignment": (
        "two_point_sticking.friction_margin",
        {"beta": units.radians(-16.6).hull(units.radians(16.6)), "mu": FRICTION},
        1,
    ),
    "a pair 891 um apart cannot jam": (
        "two_sided_rotation.no_jam",
        {"V": um(890, 1000), "d1": WIDTH, "mu": FRICTION},
        1,
    ),
}


@pytest.mark.parametrize("name", INEQUALITIES)
def test_an_inequality_is_proved_with_few_boxes(name: str) -> None:
    what, box, most = INEQUALITIES[name]
    proof = prove_positive(condition(*what.split(".")), box)
    assert proof.verdict is Verdict.PROVED
    assert proof.lower > 0.0
    assert proof.boxes <= most
