"""Each forgery is consistent where a reader compares, and is not believed."""

from __future__ import annotations

import copy
import itertools
import json
import random
from pathlib import Path
from typing import Any

import pytest

from meso_robust.campaigns.mutation.answer import answered
from meso_robust.campaigns.mutation.excuses import excuse
from meso_robust.campaigns.mutation.forgeries import FORGERIES, forge
from meso_robust.campaigns.mutation.forging import reclaimed
from meso_robust.campaigns.mutation.kind import Prepared
from meso_robust.campaigns.mutation.original import Original
from meso_robust.campaigns.mutation.places import Document, sealed
from meso_robust.checker.prover import Prover
from meso_robust.task import load_task

OBJECTIONS = {
    "a move left out": "",
    "two moves swapped": "",
    "the box of another move": "",
    "all boxes shrunk": "post_holds",
    "an inequality left out": "obligations_listed",
    "an inequality about less": ":",
    "all bounds raised": "lower_bound",
    "proofs of an easier task": "",
    "an unproved policy called PROVED": "",
    "an invented witness": "witness",
    "a claim of less": "claim.uncertainties",
}
"""What the checker's objection must be about, if it is always the same, of those that are never true."""
TRUE_AT_TIMES = {
    "a box narrowed": "holds 500 runs",
    "the margin raised": "a factor",
    "a move called by another name": "name",
    "an inequality of another move": "",
}
"""And of the others: why one that is accepted is true."""


@pytest.fixture(scope="module")
def prover(prepared: Prepared) -> Prover:
    return prepared.known.copy().prover


def forgery(name: str, original: Original, seed: int) -> Document | None:
    """A forged certificate, whole."""
    rng = random.Random(f"{name}:{seed}")
    found = FORGERIES[name](copy.deepcopy(original.document), original, rng)
    if found is None:
        return None
    reclaimed(found)
    return sealed(found)


def test_there_is_an_expectation_of_each() -> None:
    assert OBJECTIONS.keys() | TRUE_AT_TIMES.keys() | {"about another task"} == FORGERIES.keys()


@pytest.mark.parametrize("name", OBJECTIONS)
def test_what_is_never_true_is_rejected(name: str, original: Original, prover: Prover) -> None:
    made = forgery(name, original, 1)
    assert made is not None
    reply = answered(made, original.task, prover)
    assert reply.word == "REJECTED"
    assert OBJECTIONS[name] in reply.why


@pytest.mark.parametrize("name", TRUE_AT_TIMES)
def test_what_is_true_at_times_is_rejected_or_excused(
    name: str, original: Original, prover: Prover
) -> None:
    for seed in range(2):
        one = forgery(name, original, seed)
        if one is None:
            continue
        reply = answered(one, original.task, prover)
        assert reply.word in {"REJECTED", "MARGIN UNDECIDED", "VERIFIED"}
        if reply.word == "VERIFIED":
            because = excuse(original, one)
            assert because is not None
            assert TRUE_AT_TIMES[name] in because


def test_a_certificate_of_another_task_is_not_read(original: Original) -> None:
    made = forgery("about another task", original, 0)
    assert made is not None
    reply = answered(made, original.task)
    assert reply.word == "malformed"
    assert "task_hash" in reply.why


def test_the_moves_fit_together_in_a_forged_chain(original: Original) -> None:
    """The checker must object to the physics, not to a box that was told twice differently."""
    for name in (
        "a move left out",
        "two moves swapped",
        "all boxes shrunk",
        "proofs of an easier task",
    ):
        made = forgery(name, original, 1)
        assert made is not None
        steps: list[Any] = made["steps"]
        assert len(steps) == len(made["policy"])
        assert made["claim"]["moves"] == len(steps)
        for before, step in itertools.pairwise(steps):
            assert (step["pre"], step["pre_exact"]) == (before["post"], before["post_exact"])


def test_a_draw_names_its_forgery(original: Original) -> None:
    names = {forge(original, random.Random(seed)).name for seed in range(60)}
    assert len(names) > 10


REAL = Path(__file__).parents[2] / "checker" / "real_parts"


def test_every_quantity_of_real_parts_is_held_to_the_task() -> None:
    """The claim may say less of none of them, and the task may be no other one."""
    task = load_task(REAL / "hexagon.toml")
    text = (REAL / "hexagon.json").read_text(encoding="utf-8")
    stated = json.loads(text)["claim"]["uncertainties"]
    assert {"tip_radius", "size", "squareness", "drag_centre", "travel_direction"} <= stated.keys()
    for key, (low, high) in stated.items():
        document = json.loads(text)
        wide = float.fromhex(high) - float.fromhex(low)
        for end, by in ((0, 0.1), (1, -0.1)):
            moved = float.fromhex((low, high)[end]) + by * wide
            document["claim"]["uncertainties"][key][end] = moved.hex()
            reply = answered(sealed(document), task)
            assert reply.word == "REJECTED"
            assert f"claim.uncertainties.{key}" in reply.why
    every = Original(task, json.loads(text))
    rng = random.Random(0)
    for _ in range(40):
        made = sealed(FORGERIES["about another task"](json.loads(text), every, rng) or {})
        assert answered(made, task).word == "malformed"
