"""What is compared are names; no sentence of a certificate is believed, shown or needed."""

from __future__ import annotations

import copy
import json
import re
from dataclasses import fields
from itertools import chain
from pathlib import Path
from typing import Any

import pytest
from flint import ctx
from typer.testing import CliRunner

from meso_robust.certificates import words as told
from meso_robust.certificates.premise import SCHEMA_1, Premise, premises
from meso_robust.certificates.words import words
from meso_robust.checker import ids, words as own
from meso_robust.checker.inputs import ALWAYS_STATED, given, uncertainties
from meso_robust.checker.reading import digest
from meso_robust.checker.statement import STATEMENTS
from meso_robust.checker.verdict import BITS
from meso_robust.cli import app
from meso_robust.planning.remedy import Remedy
from meso_robust.primitives.names import (
    DATA,
    Inequality,
    ObligationId,
    Property,
    Reason,
    every_obligation,
)
from meso_robust.primitives.setup import Uncertainty
from meso_robust.task import parse_task
from tests.checker.test_check import checked, objection
from tests.conftest import paper_task
from tests.test_task_real import ROUND, values as task_values

Document = dict[str, Any]
UNDECIDED = {
    ObligationId.EDGES_OPPOSITE,
    ObligationId.ACTIVE_ABOVE_PASSIVE,
    ObligationId.COMES_TO_REST,
    ObligationId.END_ENCLOSED,
}
"""Never proved, so no certificate that can be verified lists them."""
UNLISTED = {ids.Must.ACTIVE_PRESSES, ids.Must.ACTIVE_PRESSES_ALONE}
LIE = "Every part reaches every goal, whatever the errors."


def test_both_sides_name_the_same() -> None:
    """Two lists, written apart, as neither side may read the other's."""
    assert {one.value for one in ObligationId} - UNDECIDED == {
        one.value for one in ids.Must
    } - UNLISTED
    assert [one.value for one in Premise] == [one.value for one in ids.Premise]
    assert {one.value for one in Property} == {one.value for one in ids.Property}
    assert {one.value for one in Inequality} ^ set(STATEMENTS) == {Inequality.NONE}
    for one in set(Inequality) - {Inequality.NONE}:
        assert one.derivation == STATEMENTS[one].derivation
        assert one.any_value == STATEMENTS[one].any_value
    assert set(ALWAYS_STATED) <= {field.name for field in fields(Uncertainty)}


def test_names_are_no_sentences_and_each_means_one_thing() -> None:
    every = list(chain(ObligationId, Property, Reason, Remedy))
    assert len({one.value for one in every}) == len(every)
    own_names = list(chain(ids.Must, ids.Property, ids.Objection))
    assert len({one.value for one in own_names} | {one.value for one in ids.Property}) == len(
        own_names
    )
    for one in chain(every, own_names, Premise, Inequality):
        assert re.fullmatch(r"[a-z_]+(\.[a-z_]+)?", one.value), one
    assert set(DATA) < set(ObligationId)


def test_every_name_has_words_and_no_two_the_same() -> None:
    names = list(every_obligation())
    assert len({words(name) for name in names}) == len(names) == len({name.key for name in names})
    assert set(told.PREMISES) == set(Premise)
    assert set(own.PREMISES) == set(ids.Premise)
    for id_ in chain(ids.Must, ids.Objection):
        data = {"tip": "upper", "turn": "clockwise", "when": "before_touch", "tips": "pair"}
        said = own.sentence(ids.Named(id_, {**data, "move": "1", "action": "tilt"}, "key"))
        assert said.endswith("key")
        assert "_" not in said.removesuffix(": key")


# ------------------------------------------------------------------------------ prose


def forged(document: Document) -> Document:
    """Every sentence of a certificate replaced, however deep."""

    def lied(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: lied(one) for key, one in value.items()}
        return LIE if isinstance(value, str) else value

    found = copy.deepcopy(document)
    found["reading"] = lied(found["reading"])
    return found


def test_a_forged_sentence_changes_nothing_that_is_told(document: Document, tmp_path: Path) -> None:
    sealed = forged(document)
    answer = checked(sealed, paper_task())
    assert answer.verdict == "VERIFIED"
    assert answer == checked(document, paper_task())
    sealed["digest"] = digest(sealed)
    file = tmp_path / "certificate.json"
    file.write_text(json.dumps(sealed), encoding="utf-8")
    for flags in ([], ["--json"]):
        run = CliRunner().invoke(app, ["check", str(file), *flags])
        assert run.exit_code == 0
        assert LIE not in run.stdout
        assert own.claim(paper_task(), 4) in run.stdout


def test_a_certificate_without_any_sentence_is_verified(document: Document) -> None:
    assert checked({**document, "reading": {}}, paper_task()).verdict == "VERIFIED"


def test_outside_of_the_reading_there_is_no_sentence(document: Document) -> None:
    def texts(value: Any) -> list[str]:
        if isinstance(value, dict):
            return [text for one in value.values() for text in texts(one)]
        if isinstance(value, list):
            return [text for one in value for text in texts(one)]
        return [value] if isinstance(value, str) else []

    compared = {
        key: copy.deepcopy(value)
        for key, value in document.items()
        if key not in {"reading", "task", "made_with"}
    }
    for move in compared["policy"]:
        for aim in move.values():
            if isinstance(aim, dict):
                del aim["relative_to"]  # "sensed part": a value of plan.json, which has it first
    assert [text for text in texts(compared) if " " in text] == []


# ----------------------------------------------------------------- the ground of a claim


@pytest.mark.parametrize(
    ("changes", "swapped"),
    [
        ({}, set()),
        (ROUND, {"coulomb_each_tip"}),
        ({**ROUND, "uncertainty.friction_common": True}, {"coulomb_friction"}),
        (
            {**ROUND, "uncertainty.drag_centre_um": 5.0, "uncertainty.drag_centre_moves": True},
            {"film_at_each_instant", "coulomb_each_tip"},
        ),
        (
            {**ROUND, "probe.max_force_un": 20.0, "film.drag_un_s_per_um": 0.2},
            {"coulomb_each_tip", "probes_rigid_below_cap"},
        ),
    ],
)
def test_both_sides_grant_the_same_for_a_task(changes: dict[str, Any], swapped: set[str]) -> None:
    task = parse_task(task_values(changes), "real")
    found = [one.value for one in premises(task)]

    assert found == [one.value for one in ids.premises(task)]
    assert ("point_tips" in found) == (not changes)
    assert ("tips_are_discs" in found) == bool(changes)
    assert swapped <= set(found)
    assert len(found) == (10 if changes else 12)


@pytest.mark.parametrize("name", SCHEMA_1)
def test_a_premise_may_not_be_left_out(document: Document, name: Premise) -> None:
    found = copy.deepcopy(document)
    found["claim"]["premises"].remove(name)
    assert objection(found) == "value: claim.premises"


def test_a_premise_that_the_checker_does_not_know_is_rejected(document: Document) -> None:
    found = copy.deepcopy(document)
    found["claim"]["premises"].append("no_wind")
    assert objection(found) == "value: claim.premises"


def test_what_is_rejected_is_told_as_the_file_writes_it(document: Document) -> None:
    premises, move = copy.deepcopy(document), copy.deepcopy(document)
    premises["claim"]["premises"].remove("point_tips")
    move["steps"][0]["property"] = {"id": "part_rests", "about": {}}
    for found, missing in ((premises, "point_tips"), (move, "turns_part")):
        refused = checked(found, paper_task()).refused
        assert refused is not None
        assert f"'{missing}'" in refused.found
        assert "<" not in refused.stated + refused.found  # as Python shows a value of a class


def test_an_uncertainty_that_the_checker_does_not_know_is_rejected(document: Document) -> None:
    """There is room for more of them, and none is believed before there is a proof of it."""
    found = copy.deepcopy(document)
    found["claim"]["uncertainties"]["tip_radius"] = [(0.0).hex(), (1e-5).hex()]
    assert objection(found) == "value: claim.uncertainties"
    del found["claim"]["uncertainties"]["tip_radius"], found["claim"]["uncertainties"]["friction"]
    assert objection(found) == "value: claim.uncertainties"


@pytest.mark.parametrize("name", ALWAYS_STATED)
@pytest.mark.parametrize("by", [-1e-9, 1e-9])
def test_a_claim_for_another_range_is_rejected(document: Document, name: str, by: float) -> None:
    found = copy.deepcopy(document)
    ends = found["claim"]["uncertainties"][name]
    ends[1] = (float.fromhex(ends[1]) * (1.0 + by)).hex()
    assert objection(found) == f"value: claim.uncertainties.{name}"


def test_stated_ranges_hold_those_of_the_task(document: Document) -> None:
    """By the task's decimals; 0.25 deg are pi/720 rad."""
    stated = {
        name: [float.fromhex(end) for end in ends]
        for name, ends in document["claim"]["uncertainties"].items()
    }
    assert stated["friction"][0] <= 0.3
    assert stated["friction"][1] >= 0.36
    assert stated["misalignment"][1] == pytest.approx(3.141592653589793 / 720, rel=1e-15)
    assert stated["film_ratio"] == pytest.approx([0.95 * 376900e-12, 1.05 * 376900e-12], rel=1e-14)
    with ctx.workprec(BITS):
        for name, (low, high) in uncertainties(given(paper_task())).items():
            assert stated[name][0] <= low
            assert stated[name][1] >= high


@pytest.mark.parametrize(
    ("where", "value"),
    [
        (("property", "id"), "turns_between_tips"),
        (("property", "about"), {"turn": "clockwise"}),
        (("obligations", 0, "about"), {"tip": "upper"}),
        (("obligations", 0, "about"), {}),
        (("obligations", 4, "id"), "tip_sticks"),
        (("obligations", 4, "inequality"), "one_point_sticking.friction_margin"),
    ],
)
def test_a_name_put_for_another_is_rejected(document: Document, where: Any, value: Any) -> None:
    found: Any = copy.deepcopy(document)
    place = found["steps"][0]
    for key in where[:-1]:
        place = place[key]
    assert place[where[-1]] != value
    place[where[-1]] = value
    objection(found)


def test_a_derivation_that_is_not_the_inequality_s_is_rejected(document: Document) -> None:
    found = copy.deepcopy(document)
    found["claim"]["inequalities"]["travel"] = "derivations/two_sided_rotation.py"
    assert objection(found) == "value: claim.inequalities.travel"


def test_rewording_makes_no_certificate_invalid(
    document: Document, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With all words of both sides replaced the same answer comes from the same names."""
    monkeypatch.setattr(own, "_SENTENCES", dict.fromkeys(own._SENTENCES, "so"))
    monkeypatch.setattr(own, "PREMISES", dict.fromkeys(own.PREMISES, "so"))
    assert checked(document, paper_task()).verdict == "VERIFIED"
    found = copy.deepcopy(document)
    del found["steps"][2]["obligations"][3]
    assert objection(found) == "value: claim.inequalities"
