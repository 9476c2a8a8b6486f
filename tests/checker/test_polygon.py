"""Certificates of polygons: verified, and rejected for another polygon or a false statement."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx

from meso_robust.bounds import Verdict
from meso_robust.certificates.chain import certify
from meso_robust.checker import outline as own
from meso_robust.checker.inputs import given
from meso_robust.checker.verdict import BITS, Answer
from meso_robust.checker.walls import apart
from meso_robust.planning.x_translation import to_goal
from meso_robust.primitives.frame import Frame
from meso_robust.primitives.names import Inequality
from meso_robust.primitives.setup import setup_of
from meso_robust.task import PolygonPart, Task, parse_task
from tests.checker.test_check import checked
from tests.polygons import SHIPPED, certificate, inside, planned, values_of

Document = dict[str, Any]


@pytest.fixture(scope="module", autouse=True)
def _as_the_checker_computes() -> Iterator[None]:
    with ctx.workprec(BITS):
        yield


def document_of(name: str) -> Document:
    return certificate(*planned(name))


def moved(name: str, corner: int, by: tuple[float, float]) -> Task:
    """The shipped task with one corner of the part elsewhere."""
    values = values_of(SHIPPED[name])
    corners = values["part"]["polygon_um"]
    corners[corner] = [value + step for value, step in zip(corners[corner], by, strict=True)]
    return parse_task(values, "moved")


def refusal(found: Answer) -> str:
    assert found.verdict == "REJECTED"
    assert found.refused is not None
    return found.refused.name.key


@pytest.mark.parametrize("name", SHIPPED)
def test_the_certificate_of_a_shipped_task_is_verified(name: str) -> None:
    assert checked(document_of(name), planned(name)[0]).verdict == "VERIFIED"


def test_a_start_that_is_told_whole_turns_away_is_the_same_start() -> None:
    values = values_of(SHIPPED["hexagon"])
    values["start"]["theta_deg"] -= 360.0
    task, rules = parse_task(values, "a turn away"), planned("hexagon")[1]
    chain = certify(rules, setup_of(task))
    assert chain.verdict is Verdict.PROVED
    found = checked(certificate(task, rules, chain), task)
    assert found.verdict == "VERIFIED", found.refused


@pytest.mark.parametrize("frame", [Frame(mirrored=True), Frame(heading="+y", mirrored=True)])
def test_a_mirrored_and_turned_task_is_verified_as_well(frame: Frame) -> None:
    """The same plan seen from other axes, told as a task and a policy of its own."""
    values = values_of(SHIPPED["L-shape"])
    sign = -1.0 if frame.mirrored else 1.0
    part, start, goal = values["part"], values["start"], values["goal"]
    part["polygon_um"] = [[x, sign * y] for x, y in part["polygon_um"][::-1]]
    for pose in (start, goal):
        x, y = frame.to_world(np.array([pose["x_um"], pose["y_um"]]))
        theta = sign * pose["theta_deg"] + 90.0 * frame.quarters
        pose |= {"x_um": float(x), "y_um": float(y), "theta_deg": theta}
    task = parse_task(values, "seen from other axes")
    rules = [replace(rule, frame=frame) for rule in planned("L-shape")[1]]
    chain = certify(rules, setup_of(task))
    assert chain.verdict is Verdict.PROVED
    found = checked(certificate(task, rules, chain), task)
    assert found.verdict == "VERIFIED", found.refused
    # the part is not symmetric: seen from axes that are not mirrored another edge faces the probe
    other = [replace(rule, frame=replace(frame, mirrored=False)) for rule in rules]
    assert certify(other, setup_of(task)).verdict is not Verdict.PROVED


# the pushed edge of the hexagon runs from corner 0 to corner 1; its other tip passes corner 1 on the
# side of the edge to corner 2. The L is pushed from corner 0 to corner 1, and its other tip passes
# corner 0 on the side of the edge from corner 5
ALTERED = [
    ("hexagon", 0, (0.5, 0.0)),
    ("hexagon", 0, (0.0, 20.0)),
    ("hexagon", 1, (0.0, -20.0)),
    ("hexagon", 1, (-0.5, 0.0)),
    ("hexagon", 2, (0.0, 300.0)),
    ("L-shape", 0, (20.0, 0.0)),
    ("L-shape", 0, (-60.0, 0.0)),
    ("L-shape", 1, (-60.0, 0.0)),
]
"""A corner that is moved along a side only makes it shorter or longer: that matters once it takes more
than a certificate leaves to spare, while a side that turns matters at once."""


@pytest.mark.parametrize(("name", "corner", "by"), ALTERED)
def test_another_polygon_is_rejected(name: str, corner: int, by: tuple[float, float]) -> None:
    refusal(checked(document_of(name), moved(name, corner, by)))


def test_a_corner_that_nothing_rests_on_may_move() -> None:
    """The notch of the L lies behind its convex hull: the proof holds with another one as well."""
    assert checked(document_of("L-shape"), moved("L-shape", 3, (-5.0, -5.0))).verdict == "VERIFIED"


def obligation(document: Document, move: int, key: str) -> Document:
    listed = document["steps"][move]["obligations"]
    found: Document = next(
        one for one in listed if "/".join((one["id"], *one["about"].values())) == key
    )
    return found


def larger_bound(one: Document) -> None:
    one["lower_bound"] = (2.0 * float.fromhex(one["lower_bound"])).hex()


def narrower(name: str) -> Callable[[Document], None]:
    def change(one: Document) -> None:
        low, high = (float.fromhex(end) for end in one["over"][name])
        one["over"][name] = [low.hex(), (low + 0.6 * (high - low)).hex()]

    return change


def of_a_rectangle(one: Document) -> None:
    one["inequality"] = "within_edge"


FALSE: list[tuple[str, Callable[[Document], None]]] = [
    ("tip_on_edge/pushing", larger_bound),
    ("tip_on_edge/pushing", narrower("theta")),
    ("tip_on_edge/pushing", of_a_rectangle),
    ("idle_tip_passes/while_turning", larger_bound),
    ("idle_tip_passes/while_turning", narrower("theta")),
    ("idle_tip_passes/before_touch", narrower("x")),
    ("idle_tip_passes/on_withdrawal", narrower("beta")),
]


@pytest.mark.parametrize(("key", "change"), FALSE)
def test_a_false_statement_is_rejected(key: str, change: Callable[[Document], None]) -> None:
    document = copy.deepcopy(document_of("hexagon"))
    change(obligation(document, 0, key))
    listed = [one["inequality"] for step in document["steps"] for one in step["obligations"]]
    document["claim"]["inequalities"] = {id_: Inequality(id_).derivation for id_ in listed}
    assert refusal(checked(document, planned("hexagon")[0])).split(": ")[0] == key


def walled(width_um: float) -> Task:
    """The hexagon before a slot, pushed from further away."""
    values = values_of(SHIPPED["hexagon"])
    values["start"] |= {"x_um": 1600.0, "y_um": -8.0}
    values["slot"] = {
        "mouth_x_um": 100.0, "mouth_y_um": 0.0, "opens": "+x", "width_um": width_um,
        "depth_um": 620.0, "wall_um": 200.0, "friction": 0.3,
    }  # fmt: skip
    return parse_task(values, "walled")


def test_a_hexagon_in_a_slot_is_verified_and_not_in_a_narrower_one() -> None:
    task = walled(1100.0)
    setup = setup_of(task)
    pushed = to_goal(setup.start, setup)
    assert pushed is not None
    chain = certify([pushed.rule], setup)
    assert chain.verdict is Verdict.PROVED
    document = certificate(task, [pushed.rule], chain)
    assert checked(document, task).verdict == "VERIFIED"
    # corner to corner the nut is 1039 um wide; 4 um a side leave no room for its errors in y
    narrow = walled(1046.0)
    assert certify([pushed.rule], setup_of(narrow)).verdict is not Verdict.PROVED
    assert refusal(checked(document, narrow)) == "part_clear_of_walls"


# ------------------------------------------------------------------------ its own outline


def test_sides_of_the_hull_by_hand() -> None:
    """An L with sides of 3-4-5 triangles about it."""
    part = PolygonPart(polygon_um=((-20.0, -20.0), (40.0, -20.0), (0.0, 10.0), (-20.0, 50.0)))
    found = own.outline(part)
    assert isinstance(found, own.Polygon)
    assert found.around == (0, 1, 3)  # (0, 10) lies behind the side from (40, -20) to (-20, 50)
    first = next(edge for edge in found.every if edge.name == 0)
    exact = [Fraction(-20, 10**6), Fraction(40, 10**6), Fraction(20, 10**6)]
    for ball, value in zip((first.first, first.last, first.d1), exact, strict=True):
        assert abs(ball - arb(value.numerator) / value.denominator) < 1e-20
    assert abs(first.turn) < 1e-20
    # pushed by its left side the part stands at 180 deg, whole turns aside
    for turns in (-1, 0, 1):
        facing = found.facing(arb.pi() * (1 + 2 * turns))
        assert facing.name == 3
        assert abs(facing.turn - arb.pi() * (0.5 + 2 * turns)) < 1e-18


def test_what_is_apart_from_a_polygon_has_no_common_point() -> None:
    values = values_of(SHIPPED["L-shape"])
    values["slot"] = {
        "mouth_x_um": 0.0, "mouth_y_um": 0.0, "opens": "+x", "width_um": 900.0, "depth_um": 500.0,
        "wall_um": 300.0, "friction": 0.3,
    }  # fmt: skip
    known, rng, decided = given(parse_task(values, "walled")), np.random.default_rng(1), 0
    body = 1e-6 * np.array(values["part"]["polygon_um"])
    grid = np.array(np.meshgrid(*(np.linspace(-0.8e-3, 0.8e-3, 41),) * 2)).reshape(2, -1).T
    points = np.concatenate([body, grid[inside(grid, body)]])
    for _ in range(60):
        x, y, theta = rng.uniform([-2e-3, -2e-3, -3.2], [2e-3, 2e-3, 3.2])
        block = known.blocks[rng.integers(3)]
        box = {name: (arb(v), arb(v)) for name, v in (("x", x), ("y", y), ("theta", theta))}
        c, s = np.cos(theta), np.sin(theta)
        at = points @ np.array([[c, s], [-s, c]]) + [x, y]
        gaps = [
            np.maximum(float(side[0]) - at[:, k], at[:, k] - float(side[1]))
            for k, side in enumerate(block)
        ]
        nearest = np.maximum(*gaps).min()
        if apart(box, block, known, pieces=8):
            decided += 1
            assert nearest > 0.0
        else:
            assert nearest < 0.7e-3  # the hull of the L reaches over its notch
    assert decided > 30
