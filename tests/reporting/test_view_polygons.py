"""The view of parts that are polygons: the hexagon and the L-shape that are shipped."""

from __future__ import annotations

import math
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meso_robust import pipeline
from meso_robust.bounds import Verdict
from meso_robust.laboratory.draws import draw, nominal
from meso_robust.laboratory.running import run
from meso_robust.planning.document import PlanDocument, RuleDocument, plan_document
from meso_robust.primitives.frame import Frame
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.reporting.plan import report
from meso_robust.reporting.view import task as told_task
from meso_robust.task import Task, load_task, parse_task
from meso_robust.tasks import PAPER
from tests.browser import Page
from tests.nightly import at_night
from tests.polygons import SHIPPED, planned, values_of
from tests.reporting.javascript import Script, draw_of, runs_script, steady
from tests.reporting.test_view_page import number, said
from tests.reporting.test_view_runs import PLAN, UNITS, how, how_simulated, largest, rules_of, told

AGREES_UM = 1e-3
AGREES_RAD = 1e-6
TOUCHING_UM = 1e-6  # the script takes a tip to touch 1e-7 um late
NAMES = tuple(SHIPPED)
Json = dict[str, Any]


@pytest.fixture(scope="module")
def script() -> Script:
    return runs_script()


def policy_of(task: Task, rules: tuple[MoveRule, ...]) -> tuple[RuleDocument, ...]:
    return plan_document(task, rules, [np.zeros(3)] * len(rules), [None] * len(rules)).policy


def agrees(script: Script, setup: Setup, policy: Any, rules: Any, count: int, seed: int) -> None:
    """The nominal run and random ones are the event engine's, which knows corners only."""
    random = steady(draw(setup, len(rules), count, np.random.default_rng(seed)))
    for draws in (nominal(setup, len(rules)), random):
        runs = run(rules, setup, draws, engine="events")
        for row, shown in enumerate(told(script, setup, policy, draws)):
            assert (how(shown), how_simulated(runs, row)) == ("completed", "completed")
            away, turned = largest(shown, runs, row)
            assert away < AGREES_UM
            assert turned < AGREES_RAD


@pytest.mark.parametrize("name", NAMES)
def test_runs_within_the_box_are_those_of_the_simulator(script: Script, name: str) -> None:
    task, rules, _ = planned(name)
    agrees(script, setup_of(task), policy_of(task, rules), rules, 20, 11)


@pytest.mark.parametrize("name", NAMES)
def test_a_mirrored_part_in_mirrored_axes(script: Script, name: str) -> None:
    """The same plan in other axes moves the mirrored part; the simulator knows the world's only."""
    task, rules, _ = planned(name)
    frame, values = Frame(heading="+y", mirrored=True), values_of(SHIPPED[name])
    values["part"]["polygon_um"] = [[x, -y] for x, y in reversed(values["part"]["polygon_um"])]
    for key in ("start", "goal"):
        pose = values[key]
        x, y = frame.to_world(np.array([pose["x_um"], pose["y_um"]])).tolist()
        values[key] |= {"x_um": x, "y_um": y, "theta_deg": 270.0 - pose["theta_deg"]}
    mirrored = parse_task(values, "mirrored")
    setup = setup_of(mirrored)
    plan = plan_document(task, rules, [np.zeros(3)] * len(rules), [None] * len(rules))
    assert {(rule.heading, rule.mirrored) for rule in plan.policy} == {("-x", False)}
    policy = tuple(
        rule.model_copy(update={"heading": "+y", "mirrored": True}) for rule in plan.policy
    )
    told_rules = rules_of(plan.model_copy(update={"policy": policy}), setup)
    agrees(script, setup, policy, told_rules, 4, 12)


@pytest.mark.parametrize("name", NAMES)
def test_runs_far_outside_are_the_simulator_s_or_declined(script: Script, name: str) -> None:
    task, rules, _ = planned(name)
    setup, policy = setup_of(task), policy_of(task, rules)
    draws = steady(draw(setup_of(task, 5.0), len(rules), 20, np.random.default_rng(13)))
    runs = run(rules, setup, draws, engine="events")
    seen: Counter[str] = Counter()
    for row, shown in enumerate(told(script, setup, policy, draws)):
        end = how(shown)
        seen[end] += 1
        if end == "completed":
            assert how_simulated(runs, row) == end
            assert largest(shown, runs, row)[0] < AGREES_UM
    assert seen["completed"] >= 5


@pytest.mark.parametrize("name", NAMES)
def test_margins_are_above_what_the_certificate_proves(script: Script, name: str) -> None:
    task, rules, chain = planned(name)
    assert chain.verdict is Verdict.PROVED
    setup = setup_of(task)
    draws = steady(draw(setup, len(rules), 12, np.random.default_rng(14)))
    closest = math.inf
    for shown in told(script, setup, policy_of(task, rules), draws):
        for move, step in zip(shown["moves"], chain.steps, strict=True):
            live = {
                item.name.key: move["conditions"].get(item.name.key) for item in step.obligations
            }
            for item in step.obligations:
                found = live[item.name.key]
                if found is None:  # of the tip that does not touch first in this run
                    assert step.rule.action == "straighten"
                    continue
                proved = item.proof.lower * UNITS[found["unit"]]
                if math.isfinite(proved):
                    slack = TOUCHING_UM if found["unit"] == "um" else 1e-9 * max(1.0, abs(proved))
                    assert found["value"] >= proved - slack, item.name.key
                    closest = min(closest, found["value"] / max(proved, 1e-12))
    assert closest < 1.5


def test_a_rectangle_told_by_its_corners_moves_the_same(script: Script) -> None:
    """The paper's whole plan, with the two-sided rotation."""
    plan = PlanDocument.model_validate_json(PLAN.read_text(encoding="utf-8"))
    values = values_of(PAPER)
    a, b = 808.0, 418.5
    values["part"] = {"polygon_um": [[-a, -b], [a, -b], [a, b], [-a, b]]}
    setups = [setup_of(load_task(PAPER)), setup_of(parse_task(values, "corners"))]
    draws = steady(draw(setups[0], 4, 5, np.random.default_rng(15)))
    for one, two in zip(*(told(script, s, plan.policy, draws) for s in setups), strict=True):
        assert how(one) == how(two) == "completed"
        for move, same in zip(one["moves"], two["moves"], strict=True):
            assert same["after"] == pytest.approx(move["after"], abs=1e-6)
            assert {claim: found["value"] for claim, found in same["conditions"].items()} == {
                claim: pytest.approx(found["value"], rel=1e-6, abs=1e-5)
                for claim, found in move["conditions"].items()
            }


# -- geometry --------------------------------------------------------------------------------------


def part_of(script: Script, name: str) -> Json:
    task, _, _ = planned(name)
    setup = setup_of(task)
    found = script.call(
        "partOf",
        told_task(setup),
        draw_of(nominal(setup, 1), 0, edges=len(setup.outline.corners)),
        False,
    )
    assert isinstance(found, dict)
    return found


def test_a_tip_in_the_notch_is_declined_and_one_in_the_part_is_inside(script: Script) -> None:
    part, pose = part_of(script, "L-shape"), {"x": 0.0, "y": 0.0, "theta": 0.0}

    def told_of(x: float, y: float) -> Any:
        return script.call("hindrance", part, [{"x": x, "y": y, "r": 0.0}], 100.0, pose)

    assert told_of(300.0, 300.0)["end"].startswith("leaves what the closed forms describe")
    assert "inside" not in told_of(300.0, 300.0)
    for x, y in ((-200.0, 600.0), (600.0, -200.0), (-100.0, -100.0)):
        assert told_of(x, y) == {"inside": True, "end": "a probe would start inside the part"}
    assert told_of(370.0, 370.0) is None  # beyond x + y = 720 um, the side of the hull


def test_a_tip_that_enters_the_notch_is_declined(script: Script) -> None:
    part = part_of(script, "L-shape")
    both = {"x": 900.0, "active": True, "r": 0.0, "mu": 0.3}
    tips = [{**both, "y": 200.0}, {**both, "y": 1500.0}]
    source = """
    const entered = (part, tips) => runMove(part, tips, 700,
      { part: () => Infinity, tip: () => Infinity }, { x: 0, y: 0, theta: 0 }, () => {});
    """
    end = runs_script(source).call("entered", part, tips)
    assert end["now"]["s"] == pytest.approx(900.0 - 520.0)  # where x + 200 um = 720 um
    assert end["end"].endswith("a tip comes between two corners of the part that no edge joins")


@pytest.mark.parametrize("name", NAMES)
def test_distance_from_a_wall_is_that_along_the_best_normal(script: Script, name: str) -> None:
    """By projections of all corners on many directions, which the best side can only beat."""
    part, rng = part_of(script, name), np.random.default_rng(16)
    corners, wall = np.array(part["corners"]), np.array([1000.0, 1400.0, -200.0, 900.0])
    block = np.array([[x, y] for x in wall[:2] for y in wall[2:]])
    angles = np.linspace(0.0, 2.0 * np.pi, 20001)
    normals = np.stack([np.cos(angles), np.sin(angles)])
    for x, y, theta in rng.uniform([-300, -1500, -4], [1700, 600, 4], (40, 3)):
        c, s = np.cos(theta), np.sin(theta)
        placed = corners @ np.array([[c, s], [-s, c]]) + [x, y]
        apart = (block @ normals).min(axis=0) - (placed @ normals).max(axis=0)
        pose = {"x": x, "y": y, "theta": theta}
        found = script.call("wallDistance", part, pose, wall.tolist())
        assert (found > 0) == (apart.max() > 0)
        assert found <= apart.max() + 0.5  # um; the directions are 0.3 mrad apart
        if found < 0:  # the least way out is along a side
            assert found == pytest.approx(apart.max(), abs=0.5)


# -- the page --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", [NAMES[0], *(pytest.param(name, marks=at_night) for name in NAMES[1:])]
)
def test_the_page_plays_the_simulated_run(page: Page, name: str, tmp_path: Path) -> None:
    task, _, _ = planned(name)
    result = pipeline.make(task, 4, 3)
    path = tmp_path / "report.html"
    path.write_text(report(result), encoding="utf-8")
    page.open(path)
    page.slide("#position", 1000)

    runs = run(result.found.rules, result.setup, nominal(result.setup, 3), engine="events")
    x, y, theta = runs.final[0] * [1e6, 1e6, 180 / np.pi]
    shown = [number(page, f"now-{axis}") for axis in ("x", "y", "theta")]
    assert shown == pytest.approx([x, y, theta], abs=0.051)  # as it is rounded
    assert said(page, "box-tag") == "inside: proved"
    page.click("#corner")
    assert said(page, "end-tag") == "✓ ends in the goal"
    assert page.evaluate("document.querySelectorAll('.sheet .tag.good').length") == 4
    assert (page.errors, page.outside) == ([], [])
