"""Certificates as they were written once: still verified, and false ones of schema 1 rejected."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from meso_robust.campaigns.mutation.memory import Remembered
from meso_robust.checker.ids import Objection
from meso_robust.checker.reading import digest, parse_certificate, read_certificate
from meso_robust.checker.verdict import Answer, check
from meso_robust.checker.words import claim
from meso_robust.errors import InputError
from meso_robust.task import Task, load_task

Document = dict[str, Any]
HERE = Path(__file__).parent / "schema_one"
NAMES = ("paper", "hexagon")
PROVER = Remembered().prover


@cache
def task_of(name: str) -> Task:
    return load_task(HERE / f"{name}.toml")


def document_of(name: str) -> Document:
    found: Document = json.loads((HERE / f"{name}.json").read_text(encoding="utf-8"))
    return found


def answered(document: Document, name: str) -> Answer:
    """The answer to a certificate whose digest is made to fit."""
    sealed = {**document, "digest": digest(document)}
    task = task_of(name)
    return check(*parse_certificate(json.dumps(sealed), "test", task), task, prover=PROVER)


@pytest.mark.parametrize("name", NAMES)
def test_a_certificate_as_it_was_written_is_verified(name: str) -> None:
    task = task_of(name)
    found = check(*read_certificate(HERE / f"{name}.json", task), task, prover=PROVER)
    assert found.verdict == "VERIFIED", found.refused
    assert found.claims == claim(task, len(document_of(name)["policy"]))


def test_a_certificate_of_schema_2_that_names_the_bound_of_point_tips_is_verified() -> None:
    """Since tips may be round, another bound says that a grasp cannot close; the older one holds too."""
    path, task = HERE.parent / "schema_two" / "paper.json", task_of("paper")
    assert "two_sided_rotation.no_jam" in path.read_text(encoding="utf-8")
    found = check(*read_certificate(path, task), task, prover=PROVER)
    assert found.verdict == "VERIFIED", found.refused


def test_a_changed_value_breaks_the_digest() -> None:
    document, task = document_of("paper"), task_of("paper")
    document["simulation"]["in_goal"] -= 1
    found = check(*parse_certificate(json.dumps(document), "test", task), task, prover=PROVER)
    assert found.refused is not None
    assert found.refused.name.id is Objection.DIGEST


def put(*where: Any, value: Any) -> Callable[[Document], None]:
    def change(document: Document) -> None:
        found: Any = document
        for key in where[:-1]:
            found = found[key]
        found[where[-1]] = value

    return change


def replaced(*where: Any, old: str, new: str) -> Callable[[Document], None]:
    def change(document: Document) -> None:
        found: Any = document
        for key in where[:-1]:
            found = found[key]
        assert old in found[where[-1]]
        found[where[-1]] = found[where[-1]].replace(old, new)

    return change


def twice_listed(document: Document) -> None:
    document["claim"]["inequalities"].append(document["claim"]["inequalities"][0])


def left_out(document: Document) -> None:
    del document["steps"][0]["obligations"][1]


def raised(document: Document) -> None:
    one = document["steps"][0]["obligations"][3]
    one["lower_bound"] = (float.fromhex(one["lower_bound"]) * 1.5).hex()


def shrunk(document: Document) -> None:
    """The box after the last move, for reading as well as exactly: half as wide in x."""
    step = document["steps"][-1]
    low, high = (float.fromhex(end) for end in step["post_exact"]["x_m"])
    step["post_exact"]["x_m"] = [low.hex(), (0.5 * (low + high)).hex()]


FALSE: dict[str, tuple[Callable[[Document], None], str]] = {
    "another claim": (
        replaced("claim", "words", old="every motion", new="some motion"),
        "value: claim.id",
    ),
    "fewer uncertainties in words": (
        replaced("claim", "words", old="[0.3, 0.36]", new="[0.2, 0.46]"),
        "value: claim.id",
    ),
    "another premise": (put("claim", "assumptions", 0, value="none"), "value: claim.premises"),
    "another property": (
        replaced("steps", 0, "property", old="unique", new="quick"),
        "move_value/1: property",
    ),
    "another obligation": (
        replaced("steps", 0, "obligations", 0, "claim", old="free", new="short"),
        "obligations_listed",
    ),
    "an obligation left out": (left_out, "obligations_listed"),
    "another inequality": (
        put("steps", 0, "obligations", 3, "inequality", value="1 > 0"),
        "value: claim.inequalities",
    ),
    "another derivation": (
        put("steps", 0, "obligations", 0, "derivation", value="derivations/nowhere.py"),
        "value: claim.inequalities",
    ),
    "an inequality listed twice": (twice_listed, "value: claim.inequalities"),
    "a raised bound": (raised, "tip_on_edge/pushing: lower_bound"),
    "a narrower box": (shrunk, ""),
}


@pytest.mark.parametrize("name", FALSE)
def test_a_false_one_is_rejected(name: str) -> None:
    change, about = FALSE[name]
    document = copy.deepcopy(document_of("paper"))
    change(document)
    found = answered(document, "paper")
    assert found.verdict == "REJECTED"
    assert found.refused is not None
    assert about in found.refused.name.key


def test_a_larger_margin_is_not_verified() -> None:
    document = copy.deepcopy(document_of("paper"))
    put("margin", "factor", value=1.2180)(document)
    assert answered(document, "paper").verdict == "MARGIN UNDECIDED"


def test_the_outline_in_its_premise_is_compared() -> None:
    document = document_of("hexagon")
    index = next(
        k for k, one in enumerate(document["claim"]["assumptions"]) if "stated polygon" in one
    )
    replaced("claim", "assumptions", index, old="stated polygon", new="stated rectangle")(document)
    found = answered(document, "hexagon")
    assert found.refused is not None
    assert found.refused.name.key == "value: claim.premises"


def test_what_a_certificate_of_this_schema_cannot_hold_is_bad_input() -> None:
    document = {**document_of("paper"), "reading": {}}
    with pytest.raises(InputError, match="key reading is unknown"):
        parse_certificate(json.dumps(document), "test", task_of("paper"))
