"""The certificate of the paper's task is verified, and false ones are rejected."""

from __future__ import annotations

import copy
import json
import tomllib
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from meso_robust.campaigns.mutation.forging import ends_of, put_post
from meso_robust.campaigns.mutation.memory import Remembered
from meso_robust.certificates.chain import certify
from meso_robust.certificates.document import claim_document
from meso_robust.checker.ids import Objection, premises
from meso_robust.checker.reading import digest, parse_certificate
from meso_robust.checker.verdict import Answer, check
from meso_robust.cli import app
from meso_robust.pipeline import Planned
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task, parse_task
from meso_robust.tasks import PAPER
from tests.conftest import paper_task
from tests.strategies import paper_chain

Document = dict[str, Any]


PROVER = Remembered().prover
"""What was proved in one test is not proved again in the next."""


def checked(document: Document, task: Task) -> Answer:
    """The answer to a certificate whose digest is made to fit."""
    sealed = {**document, "task_hash": task.hash, "task": task.name}
    sealed["digest"] = digest(sealed)
    found, own = parse_certificate(json.dumps(sealed), "test", task)
    return check(found, own, task, prover=PROVER)


def objection(document: Document, task: Task | None = None) -> str:
    """What a false certificate is rejected for."""
    answer = checked(document, task or paper_task())
    assert answer.verdict == "REJECTED"
    assert answer.refused is not None
    assert answer.refused.stated
    assert answer.refused.found
    return answer.refused.name.key


def aimed(document: Document, move: int, aim: str, by_um: float) -> Document:
    """The certificate with one commanded coordinate moved."""
    found = copy.deepcopy(document)
    found["policy"][move][aim]["offset_um"] += by_um
    return found


def relisted(document: Document) -> None:
    """Make the list of inequalities fit the steps."""
    known = document["claim"]["inequalities"]
    listed = (one["inequality"] for step in document["steps"] for one in step["obligations"])
    document["claim"]["inequalities"] = {id_: known[id_] for id_ in listed}


def test_the_paper_tasks_certificate_is_verified(document: Document) -> None:
    answer = checked(document, paper_task())
    assert answer.verdict == "VERIFIED"
    assert answer.claims == document["reading"]["claim"]
    assert list(answer.premises) == document["claim"]["premises"] == list(premises(paper_task()))
    assert any("simulation" in one for one in answer.not_checked)


def test_any_change_breaks_the_digest(document: Document) -> None:
    changed = copy.deepcopy(document)
    changed["simulation"]["in_goal"] -= 1
    found, own = parse_certificate(json.dumps(changed), "test", paper_task())
    answer = check(found, own, paper_task())
    assert answer.refused is not None
    assert answer.refused.name.id is Objection.DIGEST


@pytest.mark.parametrize(
    ("change", "about"),
    [
        ({"uncertainty__friction": [0.05, 0.9]}, "claim.uncertainties.friction"),
        ({"goal__position_tolerance_um": 20.0}, "goal_exact"),
    ],
)
def test_boxes_of_another_task_are_rejected(
    document: Document, change: dict[str, Any], about: str
) -> None:
    assert about in objection(document, paper_task(**change))


def reclaimed(document: Document, task: Task) -> Document:
    """The certificate with the claim of another task."""
    found = copy.deepcopy(document)
    chain = certify([step.rule for step in paper_chain().steps], setup_of(task), whole=False)
    claim = json.loads(claim_document(task, chain, len(document["policy"])).model_dump_json())
    found["claim"] |= {key: claim[key] for key in ("id", "uncertainties")}
    return found


@pytest.mark.parametrize("friction", [[0.2, 0.36], [0.3, 0.75]])
def test_wider_friction_than_was_proved_is_rejected(
    document: Document, friction: list[float]
) -> None:
    task = paper_task(uncertainty__friction=friction)
    found = objection(reclaimed(document, task), task)
    assert found.split("/")[0] in {"tip_sticks", "pair_sticks", "no_jam"}


def test_a_goal_that_is_missed_is_rejected(document: Document) -> None:
    from meso_robust.certificates.document import exact_box
    from meso_robust.planning.document import goal_document

    task = paper_task(goal__position_tolerance_um=30.0)
    goal = setup_of(task).goal
    found = reclaimed(document, task)
    found["goal_exact"] = json.loads(exact_box(goal).model_dump_json())
    found["goal"] = json.loads(goal_document(goal).model_dump_json())
    assert objection(found, task) == "goal_reached"


@pytest.mark.parametrize(
    ("move", "aim", "by_um", "about"),
    [
        (0, "dual_y", 80.0, "tip_sticks"),  # pushes too far off the middle
        (0, "dual_x", -30.0, "tip_free_at_start"),  # starts inside the part
        (0, "dual_end_x", -60.0, "post_exact"),  # turns too far
        (0, "dual_end_x", 40.0, "post_exact"),  # turns less than it says
        (1, "dual_end_x", 150.0, "second_tip_touches"),
        (1, "dual_y", 330.0, "tip_turns_part"),
        (2, "single_y", 60.0, "no_jam"),  # the tips close on the part
        (2, "dual_end_x", 300.0, "post_exact"),  # ends early
        (2, "dual_end_x", -150.0, "both_tips_on_edges"),  # a tip leaves its edge
        (3, "dual_end_x", 20.0, "post_exact"),
    ],
)
def test_another_policy_is_rejected(
    document: Document, move: int, aim: str, by_um: float, about: str
) -> None:
    assert about in objection(aimed(document, move, aim, by_um))


def test_a_section_of_the_task_that_the_checker_does_not_know_is_rejected(
    document: Document, monkeypatch: pytest.MonkeyPatch
) -> None:
    from meso_robust.checker import verdict

    monkeypatch.setattr(verdict, "SECTIONS", verdict.SECTIONS - {"probe"})
    assert objection(document) == "task_sections"


def test_a_certificate_that_says_nothing_of_the_tasks_walls_is_rejected(document: Document) -> None:
    values = tomllib.loads(PAPER.read_text(encoding="utf-8"))
    values["slot"] = tomllib.loads(PAPER.with_name("slot.toml").read_text(encoding="utf-8"))["slot"]
    task = parse_task(values, "test")
    assert objection(document, task) == "value: claim.id"
    assert objection(reclaimed(document, task), task) == "obligations_listed"


def test_swapped_moves_are_rejected(document: Document) -> None:
    found = copy.deepcopy(document)
    for part in ("policy", "steps"):
        found[part][0], found[part][1] = found[part][1], found[part][0]
    relisted(found)
    assert objection(found).startswith("move_value/1: pre")


def test_a_narrower_box_of_the_start_is_rejected(document: Document) -> None:
    found = copy.deepcopy(document)
    ends = found["steps"][0]["pre_exact"]["x_m"]
    ends[0] = (float.fromhex(ends[0]) + 1e-6).hex()
    assert objection(found).startswith("move_value/1: pre")


@pytest.mark.parametrize("axis", [0, 2])
def test_a_narrower_box_after_a_move_is_rejected(document: Document, axis: int) -> None:
    """Exactly and as people read it, and before the next move as well."""
    found = copy.deepcopy(document)
    ends = ends_of(found["steps"][1]["post_exact"])
    low, high = ends[axis]
    ends[axis][0] += 0.1 * (high - low)
    put_post(found, 1, ends)
    assert objection(found).startswith("post_holds/2")


def test_a_push_where_the_task_has_no_probe_is_rejected(document: Document) -> None:
    assert {rule["heading"] for rule in document["policy"]} == {"-x"}
    for headings, says in ((["+x", "+y"], "move_value/1: heading"), (["-x", "+y"], "")):
        answer = checked(document, paper_task(probe__headings=headings))
        assert (answer.refused.name.key if answer.refused else "") == says


def test_an_exaggerated_margin_is_not_verified(document: Document) -> None:
    """The plan itself is; the checker's bounds are too wide for more, or it is untrue."""
    found = copy.deepcopy(document)
    margin = found["margin"]
    margin["factor"], margin["refused_at"] = 1.9, 1.95
    margin["each_alone"] = dict.fromkeys(margin["each_alone"], 2.0)
    answer = checked(found, paper_task())
    assert (answer.verdict, answer.positive) == ("MARGIN UNDECIDED", False)
    assert "margin.factor is stated as 1.9, not shown: " in answer.claims


def test_evidence_that_cannot_be_is_rejected(document: Document) -> None:
    """No proof rests on it, but a reader would."""
    found = copy.deepcopy(document)
    found["simulation"]["in_goal"] = 0
    assert objection(found) == "value: simulation.in_certified_box"
    found = copy.deepcopy(document)
    found["margin"]["limit"]["action"] = "DROP TABLE"
    assert objection(found) == "value: margin.limit.action"


def test_a_dropped_inequality_is_rejected(document: Document) -> None:
    found = copy.deepcopy(document)
    del found["steps"][2]["obligations"][3]
    relisted(found)
    assert objection(found) == "obligations_listed"


@pytest.mark.parametrize("bound", [0.0, -1e-6])
def test_a_bound_that_proves_nothing_is_rejected(document: Document, bound: float) -> None:
    """Where another inequality is enough, this one need not hold: it must not be listed as proved."""
    changed = copy.deepcopy(document)
    changed["steps"][0]["obligations"][0]["lower_bound"] = bound.hex()

    found = checked(changed, paper_task())

    assert found.refused is not None
    assert found.refused.name.key.endswith("lower_bound")
    assert found.refused.found == "more than 0"


def test_a_refuted_certificate_must_keep_within_the_bounds(wide_friction_plan: Planned) -> None:
    task = paper_task(uncertainty__friction=[0.05, 0.9])
    text = wide_friction_plan.certificate.model_dump_json(by_alias=True)
    document = json.loads(text)
    assert checked(document, task).verdict == "WITNESS UNDECIDED"
    document["witness"]["friction"] = (0.91).hex()
    assert objection(document, task) == "value: witness.friction"


def test_unknown_claims_nothing(document: Document) -> None:
    found = copy.deepcopy(document)
    found["verdict"] = "UNKNOWN"
    assert objection(found) == "value: undecided"
    found["undecided"] = {
        "move": 1, "step": 1, "action": "tilt", "reason": {"id": "x", "about": {}},
        "inequality": "x", "fails": False, "over": {}, "settled_by": {"id": "x", "about": {}},
    }  # fmt: skip
    answer = checked(found, paper_task())
    assert (answer.verdict, answer.positive) == ("NOTHING CLAIMED", False)


def test_the_command(document: Document, tmp_path: Path) -> None:
    file = tmp_path / "certificate.json"
    file.write_text(json.dumps(document), encoding="utf-8")
    run = CliRunner().invoke(app, ["check", str(file), "--json"])
    assert run.exit_code == 0
    assert json.loads(run.stdout)["verdict"] == "VERIFIED"
    document = {**document, "verdict": "UNKNOWN"}
    file.write_text(json.dumps(document), encoding="utf-8")
    run = CliRunner().invoke(app, ["check", str(file)])
    assert run.exit_code == 1
    assert run.stdout.startswith("REJECTED (point tips): digest")


@pytest.mark.parametrize(
    "text", ["", "{", "[]", '{"schema": "meso-robust/certificate/3"}', '{"a": NaN}']
)
def test_what_is_no_certificate_is_bad_input(text: str, tmp_path: Path) -> None:
    file = tmp_path / "certificate.json"
    file.write_text(text, encoding="utf-8")
    run = CliRunner().invoke(app, ["check", str(file)])
    assert run.exit_code == 2
    assert run.stderr.count("\n") == 1


def test_the_certificate_of_another_task_is_bad_input(document: Document, tmp_path: Path) -> None:
    file = tmp_path / "certificate.json"
    file.write_text(json.dumps({**document, "task_hash": "0" * 64}), encoding="utf-8")
    run = CliRunner().invoke(app, ["check", str(file)])
    assert run.exit_code == 2
    assert "task_hash" in run.stderr
