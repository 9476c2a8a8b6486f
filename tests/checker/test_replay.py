"""REFUTED certificates: their run is followed by the checker and compared with both engines."""

from __future__ import annotations

import copy
import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import ctx
from typer.testing import CliRunner

from meso_robust.api.check import check as mr_check
from meso_robust.checker import replay as replaying
from meso_robust.checker.document import RuleDocument
from meso_robust.checker.ids import Must, Named, Objection, named
from meso_robust.checker.inputs import given
from meso_robust.checker.reading import digest
from meso_robust.checker.refusal import Refused
from meso_robust.checker.replay import INSIDE, MISSES, Fate, replay
from meso_robust.checker.verdict import BITS
from meso_robust.checker.words import sentence
from meso_robust.cli import app
from meso_robust.laboratory.draws import Draws, draw, nominal
from meso_robust.laboratory.replay import Feedback, miss
from meso_robust.laboratory.running import STARTS_INSIDE
from meso_robust.laboratory.simulation import in_goal
from meso_robust.laboratory.witness import more_of
from meso_robust.pipeline import Planned
from meso_robust.planning.compose import compose
from meso_robust.planning.document import plan_document
from meso_robust.primitives.frame import Frame
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task, parse_task
from meso_robust.toml_files import toml_text
from tests.checker.test_check import checked, objection, reclaimed
from tests.checker.test_witness import witness
from tests.conftest import paper_task
from tests.laboratory.test_box import real_task
from tests.nightly import at_night, by_day
from tests.slot import point_slot
from tests.turned import HALF, turned_rules, turned_task

Document = dict[str, Any]
ZERO = (0.0).hex()
MISSED = Fate(fails=True, why=named(Objection.MISSES_GOAL), outcome=MISSES)


# ------------------------------------------------------------------------ an untrue refutation


def refuting(document: Document, task: Task, **changes: Any) -> Document:
    """The certificate as it would tell of a plan that one run breaks; the run has no error."""
    found, moves, setup = copy.deepcopy(document), len(document["policy"]), setup_of(task)
    last = found["steps"][-1]
    last.update(verdict="UNKNOWN", post=None, post_exact=None)
    one = last["obligations"][0]
    found["undecided"] = {
        "move": moves, "step": last["step"], "action": last["action"],
        "reason": {"id": one["id"], "about": one["about"]},
        "inequality": one["inequality"], "fails": False, "over": one["over"],
        "settled_by": {"id": "change_move", "about": {}},
    }  # fmt: skip
    found["margin"] |= {"factor": 0.0, "refused_at": 1.0, "binds_first": None, "limit": None}
    found["margin"]["each_alone"] = dict.fromkeys(found["margin"]["each_alone"], 0.0)
    u = setup.uncertainty
    found["verdict"] = "REFUTED"
    found["witness"] = {
        "outcome": MISSES, "move": None,
        "start": [float(v).hex() for v in setup.start.mid],
        "friction": u.friction.mid.hex(), "film_ratio_m2": u.film_ratio.mid.hex(),
        "misalignment_rad": ZERO, "sensing": [[ZERO] * 3] * moves,
        "dual_probe": [[ZERO] * 2] * moves, "single_probe": [[ZERO] * 2] * moves, **changes,
    }  # fmt: skip
    return found


def test_a_proved_plan_called_refuted_is_rejected(document: Document) -> None:
    lazy = {**refuting(document, paper_task(), outcome="jammed"), "steps": document["steps"]}
    for undecided in (None, lazy["undecided"]):
        assert objection({**lazy, "undecided": undecided}) == "value: verdict"
    careful = refuting(document, paper_task(), outcome="jammed")
    assert objection({**careful, "undecided": None}) == "value: undecided"
    assert objection(careful) == "witness_fails"
    assert objection({**careful, "margin": document["margin"]}) == "value: margin.factor"


def test_a_refutation_by_moves_that_are_none_is_rejected(document: Document) -> None:
    changed = refuting(document, paper_task())
    changed["policy"][0]["action"] = "fly"
    assert objection(changed) == "move_known"
    changed["policy"] = []
    changed["witness"] |= {"sensing": [], "dual_probe": [], "single_probe": []}
    assert objection(changed)  # nothing to follow is no failure


# ------------------------------------------------------------------- one that is true, or may be


def test_a_run_that_misses_is_confirmed_and_no_proof(document: Document) -> None:
    """The goal is put aside; the same run by the event-driven engine misses it as well."""
    task = paper_task(goal__x_um=200.0)
    found = of_another_goal(refuting(document, task), task)
    answer = checked(found, task)
    assert (answer.verdict, answer.positive) == ("WITNESS CONFIRMED", False)
    assert sentence(named(Objection.MISSES_GOAL)) in answer.claims
    assert any(one.startswith("steps") for one in answer.not_checked)
    found["witness"]["outcome"] = "jam"
    assert objection(found, task) == "value: witness.outcome"


def of_another_goal(document: Document, task: Task) -> Document:
    from meso_robust.certificates.document import exact_box
    from meso_robust.planning.document import goal_document

    goal = setup_of(task).goal
    found = reclaimed(document, task)
    found["goal_exact"] = json.loads(exact_box(goal).model_dump_json())
    found["goal"] = json.loads(goal_document(goal).model_dump_json())
    return found


@at_night
def test_a_run_that_slips_is_undecided_and_says_what_it_rests_on(
    wide_friction_plan: Planned,
) -> None:
    found = mr_check(wide_friction_plan.certificate, wide_friction_plan.task)
    assert (found.verdict, found.verified) == ("WITNESS UNDECIDED", False)
    slips = Named(Must.TIP_STICKS, {"tip": "pushing"})
    assert f"move 1: {sentence(slips)}" in str(found)
    assert "simulate" in str(found)
    assert any(one.startswith("witness.outcome") for one in found.document["not_checked"])
    assert "WITNESS UNDECIDED" in found._repr_html_()


@pytest.mark.parametrize(("goal_x_um", "word"), [(0.0, "REJECTED"), (200.0, "WITNESS CONFIRMED")])
def test_no_refutation_exits_as_a_proof_does(
    document: Document, tmp_path: Path, goal_x_um: float, word: str
) -> None:
    task = paper_task(goal__x_um=goal_x_um)
    found = of_another_goal(refuting(document, task), task)
    found |= {"task_hash": task.hash, "task": task.name}
    found["digest"] = digest(found)
    values = task.model_dump(mode="json", by_alias=True, exclude_none=True)
    (tmp_path / "task.toml").write_text(toml_text(values), encoding="utf-8")
    (tmp_path / "c.json").write_text(json.dumps(found), encoding="utf-8")
    told = ["check", str(tmp_path / "c.json"), str(tmp_path / "task.toml")]
    for options in ([], ["--quiet"], ["--json"]):
        run = CliRunner().invoke(app, [*told, *options])
        assert run.exit_code == 1
        shown = json.loads(run.stdout)["verdict"] if "--json" in options else run.stdout
        assert shown.startswith(word)


# -------------------------------------------------------------------- against the simulator


def fate(
    task: Task,
    rules: tuple[MoveRule, ...],
    draws: Draws,
    row: int,
    more: Mapping[str, str] | None = None,
) -> Fate | None:
    """What the checker says of a run; None: it ends in the goal."""
    sensed = [np.zeros(3)] * len(rules)
    told = plan_document(task, rules, sensed, [None] * len(rules)).policy
    policy = tuple(RuleDocument.model_validate_json(one.model_dump_json()) for one in told)
    stated = witness(draws, row).witness
    assert stated is not None
    stated = stated.model_copy(update={"more": dict(more or {})})
    with ctx.workprec(BITS):
        try:
            return replay(stated, policy, given(task))
        except Refused as refused:
            objected = refused.name.id
    assert objected is Objection.WITNESS_FAILS
    return None


@pytest.mark.parametrize("frame", by_day(2, HALF), ids=str)
def test_runs_end_where_the_event_driven_engine_takes_them(frame: Frame) -> None:
    """In a goal so small that some of the runs of a certified plan miss it."""
    task = turned_task(frame, goal__position_tolerance_um=15.0, goal__orientation_tolerance_deg=0.5)
    rules, setup = turned_rules(frame), setup_of(task)
    draws = draw(setup, len(rules), 5, np.random.default_rng(5))
    player = Feedback(rules=rules, setup=setup, engine="events")
    runs = player.run(player.rows_of(draws))
    hits, from_border = in_goal(runs, setup), np.abs(miss(runs, setup) - 1.0) * 15.0
    assert 0 < hits.sum() < len(hits)
    for row, hit in enumerate(hits):
        told = fate(task, rules, draws, row)
        if told is not None and not told.fails:
            # the slide of a rotation is known to a micrometre or two only, as it need not be unique
            assert from_border[row] < 2.0
        else:
            assert told == (None if hit else MISSED)


@pytest.mark.parametrize("frame", by_day(2, HALF), ids=str)
def test_a_probe_that_starts_inside_the_part_is_found(frame: Frame) -> None:
    """At distances on both sides of the edge, which the probe and sensing errors decide."""
    task, rules = turned_task(frame), turned_rules(frame)
    setup, first = setup_of(task), rules[0]
    near = replace(first.dual, x=replace(first.dual.x, offset_um=419.0))
    pushed = (replace(first, dual=near), *rules[1:])
    draws = draw(setup, len(rules), 12, np.random.default_rng(5))
    player = Feedback(rules=pushed, setup=setup, engine="events")
    found = player.run(player.rows_of(draws))
    inside = (found.outcomes == STARTS_INSIDE) & (found.failed_in == 0)
    assert 0 < inside.sum() < len(inside)
    for row, within in enumerate(inside):
        told = fate(task, pushed, draws, row)
        assert (told is not None and told.outcome == INSIDE) == within


@pytest.mark.parametrize("frame", by_day(2, HALF[1:]), ids=str)  # the second one is mirrored
def test_tips_and_edges_that_the_witness_states_decide_whether_a_probe_starts_inside(
    frame: Frame, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All but wandering, which takes 2 um, is put to numbers; what follows if it does not is left out."""

    def refused(*_: object) -> None:
        raise Refused(named(Must.NO_JAM), 0, 1)

    monkeypatch.setattr(replaying, "verify_scene", refused)
    values = real_task().to_dict()
    turned = turned_task(frame).to_dict()
    task = parse_task({**values, "start": turned["start"], "goal": turned["goal"]}, "turned")
    rules, setup = turned_rules(frame), setup_of(task)
    draws = draw(setup, len(rules), 40, np.random.default_rng(5))

    def inside(offset_um: float) -> tuple[Any, tuple[MoveRule, ...], Feedback]:
        first = rules[0]
        near = replace(first.dual, x=replace(first.dual.x, offset_um=offset_um))
        pushed = (replace(first, dual=near), *rules[1:])
        player = Feedback(rules=pushed, setup=setup, engine="events")
        found = player.run(player.rows_of(draws))
        return (found.outcomes == STARTS_INSIDE) & (found.failed_in == 0), pushed, player

    (surely, *_), (starts_inside, pushed, player) = inside(428.5), inside(426.0)
    rows, told = player.rows_of(draws), []
    for row in range(len(rows)):
        one = fate(task, pushed, draws, row, more_of(player, rows[row]))
        told.append(one is not None and one.outcome == INSIDE)
        assert surely[row] <= told[row] <= starts_inside[row]
    without = [fate(task, pushed, draws, row) for row in range(len(rows)) if told[row]]
    assert sum(one is not None and one.outcome == INSIDE for one in without) < sum(told)
    assert 0 < sum(told) < len(told)


@pytest.mark.parametrize(("depth", "meets"), [(1130.0, False), (1095.0, True)])
def test_a_part_that_runs_into_a_wall_is_found(depth: float, meets: bool) -> None:
    """The end of the slot is put 13 um before the place where the part's end comes to rest."""
    task = point_slot(depth_um=depth)
    rules, setup = compose(point_slot()).rules, setup_of(task)
    draws = nominal(setup, len(rules))
    told = fate(task, rules, draws, 0)
    player = Feedback(rules=rules, setup=setup)
    assert in_goal(player.run(player.rows_of(draws)), setup)[0] == (not meets)
    assert told == (
        Fate(fails=True, why=named(Objection.MEETS_WALL), move=len(rules)) if meets else None
    )


@pytest.mark.parametrize("meets", [False, True])
def test_a_wall_that_a_run_may_miss_is_no_failure(
    monkeypatch: pytest.MonkeyPatch, document: Document, meets: bool
) -> None:
    """Not being shown to keep clear of a wall is one thing, being shown to meet it another."""

    def not_shown(*_: object) -> None:
        raise Refused(named(Must.PART_CLEAR_OF_WALLS), "apart from each wall", "not shown")

    monkeypatch.setattr(replaying, "clear_of_walls", not_shown)
    monkeypatch.setattr(replaying, "meets_a_wall", lambda *_: meets)

    answer = checked(refuting(document, paper_task(), outcome="jam"), paper_task())

    assert answer.verdict == ("WITNESS CONFIRMED" if meets else "WITNESS UNDECIDED")
