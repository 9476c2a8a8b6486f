"""Probes on stated sides: plans whose moves have headings of their own."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meso_robust.bounds import Interval, Verdict
from meso_robust.campaigns.property.laws.variants import mirrored_rules
from meso_robust.certificates.chain import Chain, certify
from meso_robust.checker.reading import parse_certificate
from meso_robust.checker.verdict import check
from meso_robust.errors import InputError, NotApplicableError
from meso_robust.laboratory.draws import Draws, draw
from meso_robust.laboratory.engines import Engine
from meso_robust.laboratory.running import run
from meso_robust.pipeline import Planned, make
from meso_robust.planning import compose as composing
from meso_robust.planning.arrival import arrive
from meso_robust.planning.compose import compose
from meso_robust.planning.document import PlanDocument
from meso_robust.planning.inference import inferred
from meso_robust.planning.reading import read_plan
from meso_robust.policy.build import make_policy
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import PoseBox, setup_of
from meso_robust.task import Heading, Task, load_task
from meso_robust.tasks import TWO_PROBES
from reports.tasks import start_sweep
from reports.tasks.start_sweep import table, task_at
from tests.conftest import paper_task
from tests.nightly import at_night
from tests.planning.test_compose import near

SHIPPED = Path(__file__).parents[2] / "reports" / "paper_task"
BOTH: tuple[Heading, ...] = ("-x", "+x")
FOUR: tuple[Heading, ...] = ("-x", "+x", "-y", "+y")


@cache
def task() -> Task:
    return load_task(TWO_PROBES)


@cache
def rules() -> tuple[MoveRule, ...]:
    return compose(task()).rules


@cache
def chain() -> Chain:
    return certify(rules(), setup_of(task()))


@pytest.fixture(scope="module")
def planned() -> Planned:
    return make(task(), 1000, 0)


def headings(plan: tuple[MoveRule, ...]) -> list[str]:
    return [rule.frame.heading for rule in plan]


@at_night
def test_two_probes_are_proved_simulated_and_checked_where_one_has_no_plan(
    planned: Planned,
) -> None:
    assert planned.certificate.verdict == "PROVED"
    assert len(set(headings(planned.found.rules))) == 2
    # the goal of Section IX-E by hand: 76 um and 5 deg around (0, 0, pi)
    final = planned.check.sampled.final
    assert final.shape == (1000, 3)
    assert planned.check.sampled.completed.all()
    assert np.all(np.abs(final[:, :2]) <= 76e-6)
    assert np.all(np.abs(final[:, 2] - math.pi) <= math.radians(5.0))
    text = planned.certificate.model_dump_json(by_alias=True)
    found, digest = parse_certificate(text, "a certificate", task())
    assert check(found, digest, task()).verdict == "VERIFIED"


def test_one_probe_is_refused_with_what_would_help(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(composing, "_with_most_in_hand", lambda *_, **__: None)  # no easier
    start = task().start

    with pytest.raises(NotApplicableError, match="probes on more sides"):
        compose(task_at(start.x_um, start.y_um, ("-x",)))


def test_a_task_without_headings_is_the_task_that_it_was() -> None:
    """Hash and plan of the shipped report, which was written before headings could be stated."""
    shipped = json.loads((SHIPPED / "plan.json").read_text(encoding="utf-8"))
    plan = PlanDocument.model_validate_json((SHIPPED / "plan.json").read_text(encoding="utf-8"))

    assert paper_task().hash == shipped["task_hash"]
    same = compose(paper_task()).rules
    assert [r.dual_end.offset_um for r in same] == [p.dual_end_x.offset_um for p in plan.policy]
    assert [r.dual.x.offset_um for r in same] == [p.dual_x.offset_um for p in plan.policy]
    assert [r.dual.y.offset_um for r in same] == [p.dual_y.offset_um for p in plan.policy]
    assert compose(paper_task(probe__headings=["-x"])).rules == same


@at_night
def test_headings_left_out_are_never_weaker_than_all_four() -> None:
    """From this start one probe has no plan, and two on opposite sides have one."""
    start = task().start
    four = task_at(start.x_um, start.y_um, FOUR)
    any_ = four.model_copy(update={"probe": four.probe.model_copy(update={"headings": None})})

    found = compose(any_)

    assert compose(four).scale >= 1.0
    assert found.scale >= 1.0
    assert certify(found.rules, setup_of(any_)).verdict is Verdict.PROVED


@pytest.mark.parametrize("stated", [None, FOUR])
def test_a_half_turn_is_refused_with_the_two_tasks_that_make_it(stated: Any) -> None:
    half = paper_task(start__theta_deg=0.0, probe__headings=stated)

    with pytest.raises(NotApplicableError) as refused:
        compose(half)

    assert "the goal is 180.0 deg from the start" in str(refused.value)
    assert "make it two tasks of a quarter turn each" in str(refused.value)


def test_a_plan_keeps_to_the_stated_headings() -> None:
    """The paper's task turned by half a turn, for a probe on the other side."""
    other = paper_task(probe__headings=["+x"], start__x_um=-2060.4, start__theta_deg=-90.0,
                       goal__theta_deg=0.0, start__y_um=9.2)  # fmt: skip

    assert set(headings(compose(other).rules)) == {"+x"}


@at_night
def test_the_mirrored_task_has_the_mirrored_plan() -> None:
    values = task()
    mirrored = values.model_copy(
        update={
            "start": values.start.model_copy(
                update={"y_um": -values.start.y_um, "theta_deg": -values.start.theta_deg}
            ),
            "goal": values.goal.model_copy(update={"theta_deg": -values.goal.theta_deg}),
        }
    )

    assert compose(mirrored).rules == mirrored_rules(rules())
    assert certify(compose(mirrored).rules, setup_of(mirrored)).verdict is Verdict.PROVED


def test_the_task_turned_by_half_a_turn_has_the_plan_from_the_other_sides() -> None:
    start, goal = task().start, task().goal
    turned = task_at(-start.x_um, -start.y_um, ("+x", "-x")).model_copy(
        update={"goal": goal.model_copy(update={"theta_deg": 0.0})}
    )
    turned = turned.model_copy(
        update={"start": turned.start.model_copy(update={"theta_deg": -90.0})}
    )
    opposite = {"-x": "+x", "+x": "-x"}

    found = compose(turned).rules

    assert headings(found) == [opposite[heading] for heading in headings(rules())]
    for one, other in zip(found, rules(), strict=True):
        assert (one.action, one.side) == (other.action, other.side)
        assert near(one.dual, other.dual)
        assert near(one.single, other.single)
        assert near(one.dual_end, other.dual_end)


@pytest.mark.parametrize("engine", ["events", "stepper"])
def test_every_box_holds_runs_whose_probes_lean_apart(engine: Engine) -> None:
    """At corners of all errors, each probe with a tip misalignment of its own (ends or middle)."""
    setup, runs = setup_of(task()), 60
    draws = draw(setup, len(rules()), runs, np.random.default_rng(4))
    lean = setup.uncertainty.misalignment
    own = np.random.default_rng(5).choice([lean.lo, lean.mid, lean.hi], (2, runs))
    # of one step of 2 um; the other engine takes none
    slack = np.array([0.3e-6, 0.3e-6, 2e-4]) if engine == "stepper" else np.full(3, 1e-11)
    poses = draws.start
    for k, (rule, step) in enumerate(zip(rules(), chain().steps, strict=True)):
        misalignment = own[BOTH.index(rule.frame.heading)]
        done = run((rule,), setup, _one_move(draws, k, poses, misalignment), engine=engine)
        assert done.completed.all()
        poses = done.final
        assert step.post is not None
        assert np.all(_outside(poses, step.post) <= slack)
    assert np.all(_outside(poses, setup.goal) == 0.0)


def _one_move(draws: Draws, k: int, poses: np.ndarray, misalignment: np.ndarray) -> Draws:
    return replace(
        draws,
        start=poses,
        misalignment=misalignment,
        sensing=draws.sensing[:, [k]],
        dual=draws.dual[:, [k]],
        single=draws.single[:, [k]],
    )


def _outside(poses: np.ndarray, box: PoseBox) -> np.ndarray:
    ends = [(side.lo, side.hi) for side in (box.x, box.y, box.theta)]
    low, high = np.array(ends).T
    return np.maximum(np.maximum(low - poses, poses - high), 0.0)


def test_a_straight_part_at_the_goal_is_pushed_past_it_and_brought_back() -> None:
    setup = setup_of(task_at(10.0, 5.0, BOTH))
    beside = replace(setup.start, theta=Interval(math.pi - 0.005, math.pi + 0.005))

    found = arrive(beside, setup, BOTH)

    assert found is not None
    assert headings(found.rules) == ["-x", "+x"]
    done = certify(found.rules, replace(setup, start=beside))
    assert done.verdict is Verdict.PROVED
    assert done.steps[0].post is not None
    assert done.steps[0].post.x.hi < -50e-6  # past the goal


@at_night
def test_with_probes_on_four_sides_a_start_far_out_of_line_is_brought_in_line_first() -> None:
    far = task_at(0.0, 1000.0, FOUR)
    found = compose(far).rules

    assert headings(found)[0] == "-y"
    assert set(headings(found)) > {"-y"}
    assert certify(found, setup_of(far)).verdict is Verdict.PROVED


def _edited(
    folder: Path, planned: Planned, allowed: list[str], *, policy: bool
) -> tuple[Path, Task]:
    probe = task().probe.model_copy(update={"headings": tuple(allowed)})
    other = task().model_copy(update={"probe": probe})
    values = json.loads(planned.plan.model_dump_json(by_alias=True)) | {"task_hash": other.hash}
    if not policy:
        values["policy"] = []
    path = folder / "plan.json"
    path.write_text(json.dumps(values), encoding="utf-8")
    return path, other


def test_a_plan_with_a_heading_that_the_task_has_no_probe_for_is_refused(
    planned: Planned, tmp_path: Path
) -> None:
    path, other = _edited(tmp_path, planned, ["-x"], policy=True)
    with pytest.raises(InputError, match=r"policy\.0\.heading = '\+x': must be one of \['-x'\]"):
        read_plan(path, other)

    path, other = _edited(tmp_path, planned, ["-x"], policy=False)
    with pytest.raises(NotApplicableError, match=r"move 1 pushes along \+x"):
        inferred(read_plan(path, other), other, setup_of(other))


def test_the_checker_rejects_a_heading_that_the_task_has_no_probe_for(planned: Planned) -> None:
    from tests.checker.test_check import objection

    document = json.loads(planned.certificate.model_dump_json(by_alias=True))
    probe = task().probe.model_copy(update={"headings": ("-x", "-y")})

    assert (
        objection(document, task().model_copy(update={"probe": probe})) == "move_value/1: heading"
    )


def test_a_policy_keeps_to_the_stated_headings() -> None:
    near_goal = task_at(0.0, 0.0, ("-y", "+x"))

    policy = make_policy(near_goal, quarters=(0,), most_moves=1)

    assert {cell.rule.frame.heading for cell in policy.cells} == {"-y", "+x"}


@pytest.mark.parametrize(
    ("stated", "rule"),
    [
        ([], "at least 1"),
        (["-x", "-x"], "give each direction once"),
        (["left"], "'-x', '-y', '\\+x' or '\\+y'"),
        ("-x", "array|tuple"),
    ],
)
def test_headings_that_make_no_sense_are_refused(stated: object, rule: str) -> None:
    with pytest.raises(InputError, match=rf"key probe(\.headings)?.*{rule}"):
        paper_task(probe__headings=stated)


def test_the_sweep_tells_what_one_start_needs(monkeypatch: pytest.MonkeyPatch) -> None:
    *_, row = table((-500,), (0,), BOTH)
    monkeypatch.setattr(start_sweep, "robust_at", lambda *_: None)
    *_, none = table((-500,), (0,), BOTH)

    assert set(row.split()) - {"|", "0"} == {"-x", "+x"}
    assert none == "| 0 | UNKNOWN |"
