"""``diagnosis.json``: its keys, its sentences, and the numbers behind it."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from meso_robust.diagnosis.answer import document
from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.document import DiagnosisDocument
from meso_robust.simulator.catalogue import CATALOGUE
from tests.diagnosis.conftest import regraded

PROMISED: dict[str, Any] = {
    "schema": "",
    "baseline": {"model": "", "parameters": {"rho_um2": {"value": 0, "low": 0, "high": 0}}},
    "mismatch": {"detected": True, "p_value": 0.0, "where": []},
    "verdict": "",
    "effects": [],
    "ambiguous_with": [],
    "not_identifiable": [],
    "held_out": dict.fromkeys(
        (
            "recordings",
            "baseline_sigma",
            "extended_sigma",
            "noise_floor_sigma",
            "baseline_um",
            "extended_um",
            "improvement_low",
            "improvement_high",
        )
    ),
    "next_experiment": {"why": "", "push": {}},
    "remainder": dict.fromkeys(
        (
            "um",
            "deg",
            "sigma",
            "stage",
            "component",
            "phase",
            "grows_with",
            "spread_between_pushes",
        )
    ),
}
"""Keys that outside programs rely on."""
WHERE = {
    "recording",
    "start_s",
    "end_s",
    "phase",
    "channel",
    "component",
    "sigma",
    "grows_with",
}
CHANNELS = {"support", "contact", "actuation", "observation", "environment", "geometry"}


def refuse(constant: str) -> None:
    raise ValueError(f"{constant} in JSON")


def written(found: Diagnosis) -> dict[str, Any]:
    """The file as an outside program reads it."""
    text = document(found, "1.2.3", ("a remark",)).model_dump_json(by_alias=True)
    again = DiagnosisDocument.model_validate_json(text)
    assert again.model_dump_json(by_alias=True) == text
    values: dict[str, Any] = json.loads(text, parse_constant=refuse)
    return values


@pytest.fixture(scope="module")
def nothing(null: Diagnosis) -> dict[str, Any]:
    return written(null)


@pytest.fixture(scope="module")
def named(late: Diagnosis) -> dict[str, Any]:
    return written(late)


def missing(promised: object, found: object) -> list[str]:
    if not isinstance(promised, dict):
        return []
    assert isinstance(found, dict)
    absent = [key for key in promised if key not in found]
    kept = [key for key in promised if key in found]
    return absent + [one for key in kept for one in missing(promised[key], found[key])]


def test_all_promised_keys_are_there(nothing: dict[str, Any], named: dict[str, Any]) -> None:
    for values in (nothing, named):
        assert missing(PROMISED, values) == []
        assert values["schema"] == "meso-robust/diagnosis/2"
    assert named["mismatch"]["where"]
    for place in named["mismatch"]["where"]:
        assert set(place) == WHERE
        assert place["channel"] in CHANNELS
        assert place["component"] in ("x", "y", "theta")
        assert place["phase"] in ("approach", "one_point", "two_point", "retract", "rest")
        assert place["start_s"] < place["end_s"]


def test_of_a_null_set_nothing_is_claimed(nothing: dict[str, Any], null: Diagnosis) -> None:
    assert nothing["verdict"] == "consistent"
    assert nothing["effects"] == nothing["ambiguous_with"] == []
    assert nothing["mismatch"]["detected"] is False
    assert nothing["mismatch"]["where"] == []
    assert nothing["mismatch"]["p_value"] > nothing["mismatch"]["threshold"] == 0.005
    assert "nothing beyond the refitted model is supported" in nothing["why"]
    rho = nothing["baseline"]["parameters"]["rho_um2"]
    assert rho["low"] < rho["value"] < rho["high"]
    assert rho["value"] == pytest.approx(0.276e6, rel=0.02)
    held_out = nothing["held_out"]
    assert held_out["baseline_sigma"] == held_out["extended_sigma"]
    assert held_out["improvement_low"] == held_out["improvement_high"] == 0.0
    assert null.split.held_out is not None
    assert held_out["recordings"] == list(null.grade.bench.prepared.files)  # each without itself


def test_what_cannot_be_known_is_said(nothing: dict[str, Any]) -> None:
    assert nothing["not_identifiable"][0] == "film_viscosity"
    assert "drag_drift" in nothing["not_identifiable"]
    assert set(nothing["not_identifiable"][1:]) <= set(CATALOGUE)
    why = nothing["not_identifiable_why"]
    assert [one["effect"] for one in why] == nothing["not_identifiable"][1:]
    assert all(one["push"] and one["detectability"] < 5.0 for one in why)


def test_a_named_effect_has_its_number(named: dict[str, Any]) -> None:
    assert named["verdict"] == "named"
    (effect,) = named["effects"]
    assert effect["name"] == "camera_latency"
    assert effect["stage"] == "observation"
    assert effect["equation"] == CATALOGUE["camera_latency"].equation
    assert effect["probability"] == 1.0
    time = effect["parameters"]["time_ms"]
    assert time["unit"] == "ms"
    assert time["value"] == pytest.approx(60.0, abs=1.0)
    assert time["low"] < time["value"] < time["high"]
    assert time["high"] - time["low"] < 2.2
    assert named["mismatch"]["p_value"] == 0.005  # the least of 199 simulated sets
    assert named["mismatch"]["nulls"] == 199
    assert "camera_latency explains" in named["why"]
    assert "leaves nothing that the detector sees" in named["why"]
    assert set(named["explained"]) == {"share", "low", "high", "folds"}
    assert effect["share"] == pytest.approx(named["explained"]["share"])
    assert 0.9 < named["explained"]["low"] <= named["explained"]["share"] <= 1.0
    assert named["explained"]["folds"] == 6
    first = named["candidates"][0]
    assert (first["effects"], first["adequate"]) == (["camera_latency"], True)
    assert (first["rejected"], first["ground"]) == ("", None)


def test_held_out_errors_are_those_of_the_recordings(
    named: dict[str, Any], late: Diagnosis
) -> None:
    """Of roll-outs from where the part was seen at rest, in which no start takes up a delay."""
    assert late.extended is not None
    assert late.plain.held_out is not None
    assert late.grade.extended is not None
    held_out, bench = named["held_out"], late.grade.bench
    rows = [bench.prepared.files.index(file) for file in held_out["recordings"]]
    for rolled, key in ((late.grade.plain, "baseline"), (late.grade.extended, "extended")):
        away = (bench.prepared.seen - rolled.poses)[rows][..., :2]
        rms = 1e6 * np.sqrt(np.nanmean(np.sum(away**2, axis=-1)))
        assert held_out[f"{key}_um"] == pytest.approx(rms, rel=1e-6)
    # with starts fitted to the same recordings it would be another number
    fitted = 1e6 * late.plain.held_out.whole_metres
    assert held_out["baseline_um"] != pytest.approx(fitted, rel=1e-4)
    assert held_out["extended_sigma"] == pytest.approx(1.0, abs=0.1)
    fall = 1.0 - held_out["extended_sigma"] / held_out["baseline_sigma"]
    assert 0.3 < held_out["improvement_low"] <= fall <= held_out["improvement_high"] < 1.0
    assert held_out["noise_floor_sigma"] == 1.0
    each = [one for one in held_out["each"] if one["split"] == "held_out"]
    assert [one["recording"] for one in each] == held_out["recordings"]


def test_where_the_diagnosis_is_from_is_said(named: dict[str, Any], late: Diagnosis) -> None:
    given = named["provenance"]
    assert given["meso_robust"] == "1.2.3"
    assert given["quick"] is True
    assert given["seed"] == 0
    assert given["recordings_sha256"] == late.sha256
    assert given["notes"][-1] == "a remark"
    assert len(named["held_out"]["recordings"]) == 8
    assert set(named["training"]) < set(named["held_out"]["recordings"])


def test_several_answers_are_all_given(late: Diagnosis) -> None:
    assert late.naming is not None
    one, two = late.naming.candidates[:2]
    one, two = replace(one, probability=0.6), replace(two, probability=0.2, adequate=True)
    values = written(regraded(late, verdict="ambiguous", chosen=one, rivals=(two,)))
    assert values["verdict"] == "ambiguous"
    assert [effect["name"] for effect in values["effects"]] == ["camera_latency"]
    assert values["effects"][0]["probability"] == pytest.approx(0.75)
    assert values["ambiguous_with"] == [list(two.effects)]
    assert f"and so does {two.effects[0]}" in values["why"]
    assert values["next_experiment"]["why"]


def test_without_an_answer_nothing_is_claimed_of_the_best(late: Diagnosis) -> None:
    assert late.naming is not None
    assert late.grade.explained is not None
    little = replace(late.grade.explained, share=0.1)
    values = written(regraded(late, verdict="unknown", explained=little))
    assert values["verdict"] == "unknown"
    assert values["effects"][0]["probability"] == 0.0
    assert "camera_latency explains 10 %" in values["why"]
    assert "too little for a name" in values["why"]
    assert values["mismatch"]["where"]
    assert values["next_experiment"]["push"]["what"]


def test_a_mismatch_of_no_account_is_compared_with_what_it_falls_short_of(late: Diagnosis) -> None:
    for size, said in ((1e-7, "below the 0.2 um that matter"), (3e-7, "by chance")):
        small = regraded(late, verdict="consistent", size=size, relevant=2e-7)
        why = written(small)["why"]
        assert f"{1e6 * size:.2g} um" in why
        assert why.endswith(said)


def test_unknown_keys_are_no_document(nothing: dict[str, Any]) -> None:
    for broken in ({**nothing, "more": 1}, {k: v for k, v in nothing.items() if k != "verdict"}):
        with pytest.raises(ValueError, match="1 validation error"):
            DiagnosisDocument.model_validate_json(json.dumps(broken))


def test_the_first_version_is_still_read(named: dict[str, Any]) -> None:
    later = ("explained", "remainder", "budget", "relevant_um", "explainable_um")
    old = {key: value for key, value in named.items() if key not in later}
    old["schema"] = "meso-robust/diagnosis/1"
    old["effects"] = [
        {key: value for key, value in effect.items() if key not in ("share", "form")}
        for effect in named["effects"]
    ]
    found = DiagnosisDocument.model_validate_json(json.dumps(old))
    assert found.explained is None
    assert found.effects[0].share is None
    assert found.verdict == "named"


def test_the_budget_adds_up(named: dict[str, Any]) -> None:
    shares = [part["share"] for part in named["budget"]]
    assert sum(shares) == pytest.approx(1.0)
    known = sum(part["share"] for part in named["budget"] if part["effect"])
    assert known == pytest.approx(named["explained"]["share"])
    assert {part["stage"] for part in named["budget"] if part["effect"]} == {"observation"}
