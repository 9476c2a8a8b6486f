"""Each property holds at a small budget, and is broken, with a simple example, by a small wrong."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from meso_robust.bounds import Interval
from meso_robust.campaigns.property.law import Cost
from meso_robust.campaigns.property.laws import (
    certified,
    certified_units,
    convergence,
    formulas,
    mirrored_task,
    same_path,
    sticking,
    two_sided,
)
from meso_robust.campaigns.property.laws.routes import routes
from meso_robust.campaigns.property.laws.variants import paper_rules, variants
from meso_robust.campaigns.property.registry import PROPERTIES
from meso_robust.campaigns.property.search import Searched, search
from meso_robust.campaigns.property.section import PropertySection
from meso_robust.certificates.chain import certify
from meso_robust.conditions import balls
from meso_robust.planning.compose import robust_at
from meso_robust.primitives.certify import certify_move
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.simulator import Film, simulate

BUDGET = {
    "formula-values": 100,
    "formula-intervals": 100,
    "formula-balls": 100,
    "sticking-turn": 100,
    "planned-is-kept": 1,
    "mirrored-plan": 1,
}
SEED = 20
Patch = pytest.MonkeyPatch


@pytest.mark.usefixtures("derived")
@pytest.mark.parametrize("name", PROPERTIES)
def test_a_property_holds(name: str) -> None:
    found = search(PROPERTIES[name], BUDGET.get(name, 10), SEED)
    assert found.breach is None, f"{found.breach} by {found.example}"
    assert sum(found.silent.values()) < found.examples or found.examples == 1


def test_all_properties_are_asked_for_by_default() -> None:
    section = PropertySection(name="p", kind="property", examples=5)
    assert section.properties == tuple(PROPERTIES)
    assert len(PROPERTIES) == 15


def test_each_property_says_what_it_states_and_how_exactly() -> None:
    for name, one in PROPERTIES.items():
        assert one.name == name
        assert one.statement.endswith(".")
        assert one.agreement


# -- each is noticed when it is wrong -------------------------------------------------------------


def broken(name: str, budget: int = 60) -> Searched:
    found = search(PROPERTIES[name], budget, SEED)
    assert found.breach is not None
    assert found.entry is not None
    return found


@pytest.fixture
def other_formula(monkeypatch: Patch) -> Callable[[str], None]:
    """Make one route take ``turning`` with a changed sign."""
    from tests.conditions.functions import with_a_changed_sign

    (copy,) = with_a_changed_sign("one_point_sticking", "turning")
    monkeypatch.setitem(sys.modules, copy.__name__, copy)
    module = copy.__name__.split(".")[-1]

    def wrong(route: str) -> None:
        elsewhere: dict[str, Any] = {route: module}
        of = routes("one_point_sticking", "turning", **elsewhere)
        of = replace(of, truth=balls("one_point_sticking", "turning"))
        monkeypatch.setattr(formulas, "NAMES", (("one_point_sticking", "turning"),))
        monkeypatch.setattr(formulas, "_routes", lambda *_: of)

    return wrong


@pytest.mark.parametrize(
    ("name", "route", "simplest"),
    [
        ("formula-values", "numbers", "NumPy gives"),
        ("formula-values", "bounds", "CasADi gives"),
        ("formula-values", "balls", "result 0"),
        ("formula-intervals", "bounds", "the enclosure is"),
        ("formula-balls", "balls", "the ball over the box is"),
    ],
)
def test_a_changed_sign_of_a_formula(
    other_formula: Callable[[str], None], name: str, route: str, simplest: str
) -> None:
    other_formula(route)
    found = broken(name)
    assert found.breach is not None
    assert simplest in found.breach.detail
    assert found.breach.what.startswith("one_point_sticking.turning: ")


def test_a_derivation_that_is_not_what_was_generated(monkeypatch: Patch) -> None:
    from meso_robust.campaigns.property.laws import derived

    right = derived._evaluator
    name = ("two_point_sticking", "friction_margin")

    def wrong(module: str, function: str) -> Callable[..., list[Any]]:
        evaluate = right(module, function)
        return lambda **at: [value + value * 2.0**-100 for value in evaluate(**at)]

    monkeypatch.setattr(derived, "_evaluator", wrong)
    of = routes(*name, truth=derived.derived(*name))
    monkeypatch.setattr(formulas, "_routes", lambda *_: of)
    monkeypatch.setattr(formulas, "NAMES", (name,))
    found = broken("formula-values")
    assert found.breach is not None
    assert "the ball at 128 bits" in found.breach.detail


@pytest.mark.parametrize(
    ("name", "share", "what"),
    [
        ("sticking-turn", 1e-9, "sticking: turns as far as the closed form"),
        ("two-sided-rotation", 1e-5, "two-sided rotation: slides as derived"),
    ],
)
def test_a_film_that_is_a_little_too_stiff(
    monkeypatch: Patch, name: str, share: float, what: str
) -> None:
    right = Film.ratio
    monkeypatch.setattr(Film, "ratio", lambda ratio: right(np.multiply(ratio, 1.0 + share)))
    found = broken(name)
    assert found.breach is not None
    assert found.breach.what == what


def test_a_contact_that_slips_too_early(monkeypatch: Patch) -> None:
    right = sticking.push_of
    monkeypatch.setattr(
        sticking,
        "push_of",
        lambda turn: right(replace(turn, friction=turn.friction * 0.99)),
    )
    found = broken("sticking-turn", 400)
    assert found.breach is not None
    assert found.breach.what.startswith("sticking: s")  # sticks exactly where, or slips where


def test_a_tip_that_stands_a_little_off(monkeypatch: Patch) -> None:
    right = two_sided._orientation
    monkeypatch.setattr(two_sided, "_orientation", lambda grip, h: right(grip, h * (1 + 1e-9)))
    found = broken("two-sided-rotation")
    assert found.breach is not None


def test_a_stepper_that_does_not_converge(monkeypatch: Patch) -> None:
    right = simulate
    monkeypatch.setattr(
        convergence, "simulate", lambda push: right(replace(push, friction=push.friction + 0.02))
    )
    found = broken("stepper-converges")
    assert found.breach is not None
    assert "error over the step" in found.breach.detail


def test_an_engine_in_which_the_size_of_the_drag_matters(monkeypatch: Patch) -> None:
    right = same_path.ENGINES["stepper"]

    def wrong(push: Any) -> Any:
        scale = 1.0 + 1e-6 * float(np.log(push.support.drag[0, 0, 0]))
        return right(replace(push, friction=push.friction * scale))

    monkeypatch.setitem(same_path.ENGINES, "stepper", wrong)
    found = broken("scaled-drag")
    assert found.breach is not None
    assert found.breach.what == "scaled drag, stepper engine"


def test_an_engine_that_knows_an_absolute_length(monkeypatch: Patch) -> None:
    right = same_path.ENGINES["event-driven"]

    def wrong(push: Any) -> Any:
        path, end = right(push)
        return np.round(path, 12), end

    monkeypatch.setitem(same_path.ENGINES, "event-driven", wrong)
    found = broken("other-units-move")
    assert found.breach is not None
    assert found.breach.what == "other units, event-driven engine"
    assert "lengths times" in found.breach.detail


def test_an_engine_that_prefers_a_side(monkeypatch: Patch) -> None:
    right = same_path.ENGINES["event-driven"]

    def wrong(push: Any) -> Any:
        path, end = right(push)
        return path + np.array([0.0, 1e-11, 0.0]), end

    monkeypatch.setitem(same_path.ENGINES, "event-driven", wrong)
    found = broken("mirrored-move")
    assert found.breach is not None
    assert found.breach.what == "mirrored move, event-driven engine"


@pytest.mark.parametrize(
    "name", ["certified-is-kept", "failing-is-not-certified", "planned-is-kept"]
)
def test_a_certificate_for_smaller_uncertainties(monkeypatch: Patch, name: str) -> None:
    right = certify

    def wrong(rules: Any, setup: Setup) -> Any:
        return right(rules, replace(setup, uncertainty=setup.uncertainty.scaled(0.3)))

    monkeypatch.setattr(certified, "certify", wrong)
    monkeypatch.setattr(certified, "robust_at", lambda task, scale: paper_rules())
    monkeypatch.setattr(certified, "ROWS", 24)
    law = replace(PROPERTIES[name], cost=Cost.COSTLY)
    monkeypatch.setitem(globals(), "PROPERTIES", {**PROPERTIES, name: law})
    found = broken(name)
    assert found.breach is not None
    assert found.breach.what.startswith("certified, but broken by a run: ")
    assert set(found.breach.files) == {"task.toml", "plan.json", "witness.json"}
    told = json.loads(found.breach.files["witness.json"])
    assert told["engine"] == "events"
    assert all(claim in found.breach.detail for claim in told["breaks"])


def test_a_mirror_that_forgets_the_misalignment(monkeypatch: Patch) -> None:
    right = setup_of

    def wrong(task: Any) -> Setup:
        setup = right(task)
        if setup.goal.theta.lo > 0.0:
            return setup
        u = setup.uncertainty
        return replace(setup, uncertainty=replace(u, misalignment=-u.misalignment))

    monkeypatch.setattr(mirrored_task, "setup_of", wrong)
    found = broken("mirrored-certificate")
    assert found.breach is not None
    assert found.breach.what == "mirrored task: boxes"


def test_a_planner_that_prefers_a_side(monkeypatch: Patch) -> None:
    right = robust_at

    def wrong(task: Any, scale: float) -> Any:
        rules = right(task, scale)
        return rules if task.goal.theta_deg > 0.0 or rules is None else rules[:-1]

    monkeypatch.setattr(mirrored_task, "robust_at", wrong)
    one = replace(PROPERTIES["mirrored-plan"], examples=variants(0.5))
    found = search(one, 1, SEED)
    assert found.breach is not None
    assert found.breach.what == "mirrored task: plan"


def test_a_proof_that_knows_an_absolute_length(monkeypatch: Patch) -> None:
    right = certify_move

    def wrong(*given: Any) -> Any:
        step = right(*given)
        if step.post is not None:
            wide = Interval(step.post.x.lo - 1e-12, step.post.x.hi + 1e-12)
            step = replace(step, post=replace(step.post, x=wide))
        return step

    monkeypatch.setattr(certified_units, "certify_move", wrong)
    found = broken("other-units-certificate")
    assert found.breach is not None
    assert found.breach.what == "certificate in other units: boxes"
    assert "power=0" not in found.example
