"""The view's runs against the event-driven engine, which shares no code with the derivations."""

from __future__ import annotations

import math
import re
from collections import Counter
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.bounds import Verdict
from meso_robust.certificates.chain import certify
from meso_robust.laboratory.draws import Draws, draw, nominal
from meso_robust.laboratory.running import STARTS_INSIDE, PlanRun, run
from meso_robust.laboratory.simulation import player_of
from meso_robust.planning.document import PlanDocument, RuleDocument, plan_document
from meso_robust.primitives.frame import HEADINGS, Frame, Heading
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.names import ObligationId
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.reporting.view import FORMULAS, engine, task as told_task
from meso_robust.simulator import Outcome
from meso_robust.task import Task, load_task, parse_task
from meso_robust.tasks import PAPER
from tests.conftest import paper_task
from tests.guided import guided_rules, guided_task
from tests.reporting.javascript import Script, draw_of, runs_script
from tests.slot import point_slot
from tests.test_task_real import values

PLAN = Path(__file__).parents[2] / "reports" / "paper_task" / "plan.json"
AGREES_UM = 1e-5  # measured: 8e-7 um and 2e-10 rad
AGREES_RAD = 1e-8
UNITS = {"um": 1e6, "um²": 1e12, "": 1.0}
Json = dict[str, Any]


@pytest.fixture(scope="module")
def script() -> Script:
    return runs_script()


@pytest.fixture(scope="module")
def plan() -> PlanDocument:
    return PlanDocument.model_validate_json(PLAN.read_text(encoding="utf-8"))


def rules_of(plan: PlanDocument, setup: Setup) -> tuple[MoveRule, ...]:
    player = player_of(plan, setup)
    assert hasattr(player, "rules")
    return tuple(player.rules)


def told(
    script: Script, setup: Setup, policy: tuple[RuleDocument, ...], draws: Draws
) -> list[Json]:
    rules = [rule.model_dump(mode="json") for rule in policy]
    task = told_task(setup)
    spacing, edges = setup.stated_spacing.mid, len(task["corners"])
    return [
        script.call("told", task, rules, draw_of(draws, row, spacing, edges))
        for row in range(len(draws.start))
    ]


def largest(shown: Json, runs: PlanRun, row: int) -> tuple[float, float]:
    """Largest difference of any pose after a move, um and rad."""
    ours = np.array([move["after"] for move in shown["moves"]])
    theirs = np.array([move.after[row] for move in runs.moves[: len(ours)]])
    return (
        float(np.abs(ours[:, :2] - theirs[:, :2] * 1e6).max()),
        float(np.abs(ours[:, 2] - theirs[:, 2]).max()),
    )


def how(shown: Json) -> str:
    last = shown["moves"][-1]
    if last["end"] is None:
        return "completed"
    return "jam" if last["jam"] else "inside" if last["inside"] else "declined"


def how_simulated(runs: PlanRun, row: int) -> str:
    codes = {Outcome.COMPLETED: "completed", Outcome.JAM: "jam", STARTS_INSIDE: "inside"}
    return codes[int(runs.outcomes[row])]


# -- the formulas ----------------------------------------------------------------------------------

LENGTHS = {
    "d1": (250.0, 900.0),
    "d2": (-500.0, 500.0),
    "d2_back": (-500.0, 500.0),
    "d4": (300.0, 900.0),
    "V": (1850.0, 2500.0),  # above 2 d1: the two tips can touch
    "rho": (1e5, 6e5),
    "half": (300.0, 900.0),
    "mu": (0.05, 0.9),
    "tau": (-0.9, 0.9),
    "tau_D": (-0.9, 0.9),
    "tau_S": (-0.9, 0.9),
    "side": (-1.0, 1.0),
    "beta": (-0.5, 0.5),
    "stretch": (-0.3, 0.3),
    "shear": (-0.3, 0.3),
}


def value_of(name: str, rng: np.random.Generator) -> float:
    low, high = (1.2, 2.9) if name.startswith("theta") else LENGTHS.get(name, (-700.0, 700.0))
    return float(rng.uniform(low, high))


@pytest.mark.parametrize(
    "module",
    [
        "contact_response",
        "one_point_sticking",
        "polygon_edge",
        "sticking_motion",
        "two_point_sticking",
        "two_sided_rotation",
        "y_translation",
    ],
)
def test_formulas_are_those_of_the_package(module: str) -> None:
    script = Script(FORMULAS.read_text(encoding="utf-8"))
    rng = np.random.default_rng(1)
    functions = vars(import_module(f"meso_robust._generated.{module}"))
    compared = 0
    for name, function in functions.items():
        if not callable(function) or name == "Any":
            continue
        inputs = function.__code__.co_varnames[1 : function.__code__.co_argcount]
        for _ in range(25):
            values = [value_of(argument, rng) for argument in inputs]
            try:
                expected = function(math, *values)
            except ValueError:  # the turn would pass the angle that is pushed through the centre
                assert name == "travel"
                continue
            found = script.call(f"formulas.{module}.{name}", *values)
            scale = max(1.0, *map(abs, expected))
            assert found == pytest.approx(expected, rel=1e-9, abs=1e-11 * scale), name
            compared += 1
    assert compared >= 20 * (len([f for f in functions.values() if callable(f)]) - 1)


def test_a_page_carries_the_formulas_that_it_calls_and_no_others() -> None:
    whole, carried = FORMULAS.read_text(encoding="utf-8"), str(engine())
    names = set(re.findall(r"^ {4}(\w+)\(", whole, re.M))
    script = carried[carried.index("\n};\n") :]
    called = {name for name in names if f".{name}(" in script}
    assert called == set(re.findall(r"^ {4}(\w+)\(", carried[: -len(script)], re.M))
    assert 5 < len(called) < len(names)


# -- the runs --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("task", "count"), [(load_task(PAPER), 50), (point_slot(), 20)], ids=["paper", "slot"]
)
def test_runs_within_the_box_are_those_of_the_simulator(
    script: Script, plan: PlanDocument, task: Task, count: int
) -> None:
    setup = setup_of(task)
    rules = rules_of(plan, setup)
    for draws in (nominal(setup, 4), draw(setup, 4, count, np.random.default_rng(2))):
        runs = run(rules, setup, draws, engine="events")
        for row, shown in enumerate(told(script, setup, plan.policy, draws)):
            assert (how(shown), how_simulated(runs, row)) == ("completed", "completed")
            away, turned = largest(shown, runs, row)
            assert away < AGREES_UM
            assert turned < AGREES_RAD


def test_runs_outside_the_box_end_as_in_the_simulator(script: Script, plan: PlanDocument) -> None:
    setup, wide = setup_of(paper_task()), setup_of(paper_task(), 2.5)
    draws = draw(wide, 4, 80, np.random.default_rng(3))
    runs = run(rules_of(plan, setup), setup, draws, engine="events")
    seen: Counter[str] = Counter()
    for row, shown in enumerate(told(script, setup, plan.policy, draws)):
        end = how(shown)
        seen[end] += 1
        assert end == how_simulated(runs, row)
        away, turned = largest(shown, runs, row)
        assert away < (AGREES_UM if end != "jam" else 0.05)  # a jam is met by a step of either
        assert turned < (AGREES_RAD if end != "jam" else 1e-4)
    assert min(seen[end] for end in ("completed", "jam", "inside")) >= 3


def test_what_the_closed_forms_leave_out_is_said_and_not_guessed(
    script: Script, plan: PlanDocument
) -> None:
    """Far outside a run is declined in words, or it is the simulator's."""
    task = paper_task(uncertainty__friction=[0.02, 0.6], uncertainty__probe_position_um=15.0)
    setup = setup_of(task)
    draws = draw(setup, 4, 80, np.random.default_rng(4))
    runs = run(rules_of(plan, setup), setup, draws, engine="events")
    seen: Counter[str] = Counter()
    for row, shown in enumerate(told(script, setup, plan.policy, draws)):
        end = how(shown)
        seen[end if end != "declined" else shown["moves"][-1]["end"]] += 1
        if end != "declined":
            assert end == how_simulated(runs, row)
        if end == "completed":
            assert largest(shown, runs, row)[0] < AGREES_UM
    assert seen["completed"] >= 10
    assert seen["a tip passes the end of an edge"] >= 5


def test_a_wall_ends_the_run(script: Script, plan: PlanDocument) -> None:
    """From the paper's own start the peg still leans in the mouth of the slot and jams there."""
    near = point_slot()
    task = near.model_copy(update={"start": near.start.model_copy(update={"x_um": 2060.4})})
    setup = setup_of(task)
    draws = nominal(setup, 4)
    runs = run(rules_of(plan, setup), setup, draws, engine="events")
    (shown,) = told(script, setup, plan.policy, draws)

    assert how_simulated(runs, 0) == "jam"
    assert shown["moves"][-1]["end"].startswith("touches a wall of the slot")
    assert len(shown["moves"]) == int(runs.failed_in[0]) + 1


@pytest.mark.parametrize(("width_um", "touching"), [(976.0, False), (845.0, True)])
def test_a_guided_push_is_shown_until_it_touches_a_wall(
    script: Script, width_um: float, touching: bool
) -> None:
    """Clear of the walls it ends as in the simulator; else the view says what it leaves out."""
    task = guided_task(uncertainty__friction_common=True, slot__width_um=width_um)
    rules, setup = guided_rules(), setup_of(task)
    draws = draw(setup, len(rules), 20, np.random.default_rng(8))
    runs = run(rules, setup, draws, engine="events")
    sensed = [np.zeros(3)] * len(rules)
    policy = plan_document(task, rules, sensed, [None] * len(rules)).policy
    touched = 0
    for row, shown in enumerate(told(script, setup, policy, draws)):
        end = shown["moves"][-1]["end"]
        if end is None:
            assert largest(shown, runs, row)[0] < AGREES_UM
        else:
            assert end.startswith("touches a wall of the slot")
            touched += 1
    assert (touched > 5) is touching


@pytest.mark.parametrize("heading", HEADINGS)
@pytest.mark.parametrize("mirrored", [False, True])
def test_every_heading_and_mirror(
    script: Script, plan: PlanDocument, heading: Heading, mirrored: bool
) -> None:
    """The plan stated in other axes, against the simulator in the world's; contact modes as well."""
    frame = Frame(heading=heading, mirrored=mirrored)
    (x, y), (u, v) = frame.to_world(np.array([[2060.4, -9.2], [0.0, 0.0]])).tolist()
    sign, turned = -1.0 if mirrored else 1.0, 90.0 * frame.quarters
    turned -= 360.0 if turned + sign * 180.0 > 360.0 else 0.0  # a task's angles end there
    task = paper_task(
        **{"start__x_um": x, "start__y_um": y, "goal__x_um": u, "goal__y_um": v},
        start__theta_deg=sign * 90.0 + turned,
        goal__theta_deg=sign * 180.0 + turned,
    )
    setup = setup_of(task)
    policy = tuple(
        rule.model_copy(update={"heading": heading, "mirrored": mirrored}) for rule in plan.policy
    )
    rules = rules_of(plan.model_copy(update={"policy": policy}), setup)
    draws = draw(setup, 4, 3, np.random.default_rng(5))
    runs = run(rules, setup, draws, engine="events")
    stepped = run(rules, setup, draws, record=60)
    for row, shown in enumerate(told(script, setup, policy, draws)):
        assert how(shown) == how_simulated(runs, row) == "completed"
        assert largest(shown, runs, row)[0] < AGREES_UM
        for move, recorded in zip(shown["moves"], stepped.moves, strict=True):
            agree_on_modes(move, recorded.modes[row])


def agree_on_modes(move: Json, modes: npt.NDArray[np.int8]) -> None:
    """Away from their changes both have the same contact modes."""
    shares = np.array([now["s"] for now in move["path"]])
    codes = np.array([now["codes"] for now in move["path"]])
    compared = 0
    for i, recorded in enumerate(modes):
        share = i / (len(modes) - 1)
        first = max(int(np.searchsorted(shares, share - 0.02, side="right")) - 1, 0)
        near = codes[first : int(np.searchsorted(shares, share + 0.02)) + 1]
        if i in (0, len(modes) - 1) or len(np.unique(near, axis=0)) != 1:
            continue
        assert near[0].tolist() == recorded.tolist(), i
        compared += 1
    assert compared > 0.6 * len(modes)


REAL: dict[str, Any] = {
    "schema": "meso-robust/task/2",
    "part.size_tolerance_um": 4.0,
    "part.squareness_deg": 0.1,
    "probe.tip_spacing_tolerance_um": 1.0,
    "probe.tip_radius_um": [2.5, 12.5],
    "uncertainty.travel_direction_deg": [-0.1, 0.1],
    "uncertainty.travel_scale_percent": 0.1,
    "uncertainty.drag_centre_um": 20.0,
    "uncertainty.drag_anisotropy_percent": 5.0,
}
STRAIGHT = 1e-4  # um: a picture's Runge and Kutta against the engine's own


def steady(draws: Draws) -> Draws:
    """Friction of each tip its own but the same all the time, and a film fixed in the part."""
    assert draws.tip_friction is not None
    assert draws.lay is not None
    assert draws.drag_centre is not None
    draws.tip_friction[:] = draws.tip_friction[:, :1, :1]
    draws.lay[:, 2] = 0.0
    draws.lay[:, :2] /= 1.5  # within the circle of the bound
    draws.drag_centre[:] /= 1.5
    return draws


@pytest.mark.parametrize(("heading", "mirrored"), [("-x", False), ("+y", False), ("-y", True)])
def test_real_probes_and_parts_move_as_in_the_simulator(
    script: Script, plan: PlanDocument, heading: Heading, mirrored: bool
) -> None:
    """Every slider of schema 2 at once, at corners of the box and inside it."""
    frame = Frame(heading=heading, mirrored=mirrored)
    (x, y), (u, v) = frame.to_world(np.array([[2060.4, -9.2], [0.0, 0.0]])).tolist()
    sign, turned = -1.0 if mirrored else 1.0, 90.0 * frame.quarters
    turned -= 360.0 if turned + sign * 180.0 > 360.0 else 0.0
    poses = {
        **{"start.x_um": x, "start.y_um": y, "goal.x_um": u, "goal.y_um": v},
        "start.theta_deg": sign * 90.0 + turned,
        "goal.theta_deg": sign * 180.0 + turned,
    }
    setup = setup_of(parse_task(values({**REAL, **poses}), "real"))
    policy = tuple(
        rule.model_copy(update={"heading": heading, "mirrored": mirrored}) for rule in plan.policy
    )
    rules = rules_of(plan.model_copy(update={"policy": policy}), setup)
    draws = steady(draw(setup, 4, 40, np.random.default_rng(7)))
    runs = run(rules, setup, draws, engine="events")
    seen: Counter[str] = Counter()
    for row, shown in enumerate(told(script, setup, policy, draws)):
        end = how(shown)
        seen[end] += 1
        if end == "declined":
            continue
        assert end == how_simulated(runs, row)
        away, off = largest(shown, runs, row)
        assert away < (STRAIGHT if end != "jam" else 3.0)  # close to a jam the part slides fast
        assert off < (1e-7 if end != "jam" else 1e-4)
    assert seen["completed"] >= 20, seen


# -- the margins -----------------------------------------------------------------------------------


@pytest.mark.parametrize("task", [load_task(PAPER), point_slot()], ids=["paper", "slot"])
def test_margins_are_above_what_the_certificate_proves(
    script: Script, plan: PlanDocument, task: Task
) -> None:
    """Each obligation has a live value, and no run inside the box falls below its proved bound."""
    setup = setup_of(task)
    chain = certify(rules_of(plan, setup), setup)
    assert chain.verdict is Verdict.PROVED
    draws = draw(setup, 4, 16, np.random.default_rng(6))
    closest = math.inf
    for shown in told(script, setup, plan.policy, draws):
        for move, step in zip(shown["moves"], chain.steps, strict=True):
            for item in step.obligations:
                live = move["conditions"][item.name.key]
                proved = item.proof.lower * UNITS[live["unit"]]
                if not math.isfinite(proved):
                    continue
                assert live["value"] >= proved - 1e-9 * max(1.0, abs(proved)), item.name.key
                closest = min(closest, live["value"] / max(proved, 1e-12))
    assert closest < 1.5  # some run comes near a bound: the values are of the same thing


def test_margins_of_the_nominal_run_are_those_that_are_proved_of_it_alone(
    script: Script, plan: PlanDocument
) -> None:
    """With next to no uncertainty the certificate's bounds close on the values from below."""
    setup = setup_of(paper_task())
    chain = certify(rules_of(plan, setup), setup_of(paper_task(), 1e-3))
    (shown,) = told(script, setup, plan.policy, nominal(setup, 4))
    for move, step in zip(shown["moves"], chain.steps, strict=True):
        for item in step.obligations:
            live = move["conditions"][item.name.key]
            ratio = live["value"] / (item.proof.lower * UNITS[live["unit"]])
            # loose: a bound over a whole slide, and that of a tip off one line that is not told
            loose = item.name.id == ObligationId.IDLE_TIP_PASSES
            assert 1 - 1e-9 < ratio < (2.5 if loose else 1.3), item


def test_margins_turn_negative_where_a_run_fails(script: Script, plan: PlanDocument) -> None:
    setup, wide = setup_of(paper_task()), setup_of(paper_task(), 2.5)
    draws = draw(wide, 4, 40, np.random.default_rng(3))
    shown = told(script, setup, plan.policy, draws)
    jams = [one["moves"][-1]["conditions"] for one in shown if how(one) == "jam"]
    inside = [one["moves"][-1]["conditions"] for one in shown if how(one) == "inside"]

    assert jams
    assert inside
    for conditions in jams:
        assert conditions["no_jam"]["value"] <= 0
    for conditions in inside:
        free = [c["value"] for key, c in conditions.items() if key.startswith("tip_free_at_start/")]
        assert min(free) < 0


def test_no_jam_is_the_condition_on_the_distance_of_the_tips(
    script: Script, plan: PlanDocument
) -> None:
    """By hand: V √(1 + µ²) − w (1 + µ²), V from the plan's own numbers."""
    setup = setup_of(paper_task())
    (shown,) = told(script, setup, plan.policy, nominal(setup, 4))
    rotation = plan.policy[2]
    assert rotation.single_y is not None
    separation = rotation.dual_y.offset_um - 580.0 / 2 - rotation.single_y.offset_um
    by_hand = separation * math.sqrt(1 + 0.33**2) - 837.0 * (1 + 0.33**2)

    live = shown["moves"][2]["conditions"]["no_jam"]
    assert live == {"value": pytest.approx(by_hand, rel=1e-9), "unit": "um"}
