"""A campaign of tampered certificates: pure chunks, a checker that overlooks something, totals."""

from __future__ import annotations

import copy
import json
import os
import random
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from meso_robust.campaigns.encoding import canonical, part_text, result_text
from meso_robust.campaigns.kind import Bars, Part, Result, Table
from meso_robust.campaigns.mutation.answer import answered
from meso_robust.campaigns.mutation.kind import (
    MUTATION,
    Mutant,
    Prepared,
    Trial,
    added,
    counted,
    execute,
    judged,
    mutate,
    prepare,
    total,
)
from meso_robust.campaigns.mutation.places import sealed
from meso_robust.campaigns.mutation.section import MutationSection
from meso_robust.campaigns.mutation.summary import UNTRUE, tell
from meso_robust.checker import verdict
from meso_robust.errors import InputError
from meso_robust.task import load_task
from tests.conftest import paper_task
from tests.nightly import at_night

Document = dict[str, Any]
PAPER_PLAN = Path(__file__).resolve().parents[3] / "reports" / "paper_task" / "plan.json"
FRESH = """
import sys
from meso_robust.campaigns.encoding import part_of, result_text
from meso_robust.campaigns.mutation.kind import MUTATION
part = part_of(sys.stdin.read())
print(result_text(MUTATION.execute(MUTATION.prepare(part), part, 2)))
"""


@pytest.fixture(scope="module")
def results(prepared: Prepared, part: Part) -> list[Result]:
    assert MUTATION.count(part) == 3
    return [execute(prepared, part, chunk) for chunk in range(3)]


# ------------------------------------------------------------------------------------- chunks


def test_nothing_untrue_is_accepted(part: Part, results: list[Result]) -> None:
    assert [one.runs for one in results] == [6, 6, 3]
    assert [one.failed for one in results] == [0, 0, 0]
    assert total(part, results)["answers"]["REJECTED"] > 3


def test_what_is_accepted_is_told_with_why_it_is_true(prepared: Prepared) -> None:
    """A checker that rejects everything would never be found wrong."""
    document = copy.deepcopy(prepared.original.document)
    one = document["steps"][0]["obligations"][0]
    one["lower_bound"] = (0.5 * float.fromhex(one["lower_bound"])).hex()
    found = judged(
        Mutant(("halved",), sealed(document)), prepared.original, prepared.known.copy().prover
    )
    assert (found.word, found.reason, found.missed) == ("VERIFIED", "a weaker bound", False)


def test_a_chunk_is_the_same_whatever_was_done_before(
    prepared: Prepared, part: Part, results: list[Result]
) -> None:
    before = len(prepared.known.moves), len(prepared.known.lists)
    execute(prepared, replace(part, seed=part.seed + 1), 2)
    assert (len(prepared.known.moves), len(prepared.known.lists)) == before
    assert result_text(execute(prepared, part, 2)) == result_text(results[2])
    assert results[0].values != results[1].values


@at_night
def test_a_fresh_process_gives_the_same_to_the_last_bit(part: Part, results: list[Result]) -> None:
    told = subprocess.run(
        [sys.executable, "-c", FRESH], input=part_text(part), capture_output=True, text=True,
        env={**os.environ, "PYTHONHASHSEED": "77"}, check=True,
    )  # fmt: skip
    assert told.stdout == result_text(results[2]) + "\n"


def test_memory_does_not_change_an_answer(prepared: Prepared) -> None:
    """An objection from the middle of the moves: asked for once, again, and without memory."""
    original = prepared.original
    mutant = copy.deepcopy(original.document)
    one = mutant["steps"][2]["obligations"][4]
    one["lower_bound"] = (2.0 * float.fromhex(one["lower_bound"])).hex()
    plain = answered(sealed(mutant), original.task)
    assert plain.why == "pushes_until_rest: lower_bound"
    remembering = prepared.known.copy().prover
    for _ in range(2):
        assert answered(sealed(mutant), original.task, remembering) == plain


@pytest.mark.parametrize("changes", [1, 3])
def test_as_many_things_are_changed_as_asked(prepared: Prepared, changes: int) -> None:
    rng = random.Random(4)
    for _ in range(8):
        mutant = mutate(prepared.original, changes, rng)
        assert len(mutant.names) == changes
        whole = sealed(mutant.document)["digest"] == mutant.document["digest"]
        assert whole == (mutant.document["digest"] != prepared.original.document["digest"])


# ------------------------------------------------------- a checker that overlooks something


def test_a_checker_that_overlooks_something_is_found_out(
    prepared: Prepared, part: Part, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """It believes any claim; the files of the failure show that to anybody."""
    monkeypatch.setattr(verdict, "_check_claim", lambda *_: None)
    changed = {**prepared.original.document["claim"], "moves": 7}
    mutant = Mutant(("added",), sealed({**prepared.original.document, "claim": changed}))
    monkeypatch.setattr("meso_robust.campaigns.mutation.kind.mutate", lambda *_: mutant)
    found = execute(prepared, replace(part, asked={**part.asked, "chunk": 2}), 0)
    assert (found.runs, found.failed) == (2, 2)
    failure = found.failures[0]
    assert failure.what == UNTRUE
    assert "claim.moves: 4 -> 7" in failure.detail
    for name, text in failure.files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    task = load_task(tmp_path / "task.toml")
    assert task.hash == paper_task().hash
    read = json.loads((tmp_path / "certificate.json").read_text(encoding="utf-8"))
    assert answered(read, task, prepared.known.copy().prover).word == "VERIFIED"
    monkeypatch.undo()
    assert judged(mutant, prepared.original, prepared.known.copy().prover).reason == (
        "value: claim.moves"
    )
    values = total(part, [found])
    assert values["missed"] == 2
    assert tell(part, values).verdict == "broken"


# ------------------------------------------------------------------------------------- totals


def trial(word: str, reason: str | None, *names: str) -> Trial:
    return Trial(Mutant(names, {}), word, reason)


def test_trials_are_counted() -> None:
    found = counted(
        [
            trial("VERIFIED", "a weaker bound", "scaled"),
            trial("VERIFIED", None, "scaled", "zero"),
            trial("REJECTED", "digest", "zero"),
            trial("malformed", "key x", "zero"),
        ]
    )
    assert found == {
        "answers": {"REJECTED": 1, "VERIFIED": 2, "malformed": 1},
        "excuses": {"a weaker bound": 1},
        "objections": {"digest": 1},
        "changes": {
            "scaled": {"VERIFIED": 2},
            "zero": {"REJECTED": 1, "VERIFIED": 1, "malformed": 1},
        },
    }


def test_nothing_done_is_not_held(part: Part) -> None:
    assert MUTATION.tell(part, MUTATION.total(part, [])).verdict == "measured"


def test_counts_are_added_key_by_key() -> None:
    assert added({"a": {"x": 1, "y": {"z": 2}}, "b": 1}, {"a": {"x": 3, "w": 1}, "b": 2}) == {
        "a": {"x": 4, "y": {"z": 2}, "w": 1},
        "b": 3,
    }


def test_the_totals_do_not_depend_on_the_order_of_chunks(part: Part, results: list[Result]) -> None:
    values = total(part, results)
    assert canonical(values) == canonical(total(part, results[::-1]))
    assert values["runs"] == sum(values["answers"].values()) == 15
    assert total(part, results[:1])["runs"] == 6
    assert total(part, [])["runs"] == 0


def test_the_report_holds_what_was_counted(part: Part, results: list[Result]) -> None:
    values = json.loads(canonical(total(part, results)))
    told = tell(part, values)
    assert told.verdict == "held"
    assert dict(told.figures)[UNTRUE] == "0 of 15"
    # no hit of 15 at 95 %: the upper end solves (1 - p)^15 = 0.025
    high = float(told.figures[1][1].removeprefix("0 % … ").removesuffix(" %"))
    assert 0.0 <= high - 100 * (1 - 0.025 ** (1 / 15)) < 1e-4
    answers, changes, excuses, objections = told.views
    assert isinstance(answers, Table)
    assert sum(int(number) for _, number in answers.rows) == 15
    assert isinstance(changes, Table)
    assert sum(int(cell) for row in changes.rows for cell in row[1:]) == 15
    assert isinstance(excuses, Table)
    assert isinstance(objections, Bars)
    assert sum(objections.values) == values["answers"]["REJECTED"]
    assert list(objections.values) == sorted(objections.values, reverse=True)


# -------------------------------------------------------------------------------------- input


def section(**keys: Any) -> MutationSection:
    return MutationSection(name="tampered", kind="mutation", **keys)


def test_a_plan_gets_a_certificate_without_the_names_of_the_machine() -> None:
    given = MUTATION.given(section(plan=str(PAPER_PLAN)), Path())
    assert set(given["certificate"]["made_with"]) == {"meso-robust"}
    assert given["certificate"]["policy"] == json.loads(PAPER_PLAN.read_text("utf-8"))["policy"]
    assert given == json.loads(canonical(given))


@pytest.mark.parametrize(
    ("key", "value", "why"),
    [("verdict", "UNKNOWN", "must be PROVED"), ("digest", 64 * "0", "key digest")],
)
def test_a_certificate_that_proves_nothing_is_refused(
    document: Document, tmp_path: Path, key: str, value: str, why: str
) -> None:
    changed = {**document, key: value}
    changed = changed if key == "digest" else sealed(changed)
    (tmp_path / "c.json").write_text(json.dumps(changed), encoding="utf-8")
    with pytest.raises(InputError, match=why):
        MUTATION.given(section(certificate="c.json"), tmp_path)


@pytest.mark.parametrize(
    "keys",
    [
        {"plan": "p", "certificate": "c"},
        {"factor": 1.1},
        {"changes": 6},
        {"changes": 0},
        {"certificates": 0},
        {"more": 1},
    ],
)
def test_keys_that_break_a_rule_are_refused(keys: Document) -> None:
    with pytest.raises(ValidationError):
        section(**keys)


def test_the_order_of_keys_does_not_matter(part: Part, prepared: Prepared) -> None:
    def reversed_(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: reversed_(item) for key, item in reversed(value.items())}
        return [reversed_(item) for item in value] if isinstance(value, list) else value

    other = prepare(replace(part, given=reversed_(part.given)))
    one, two = random.Random(3), random.Random(3)
    for _ in range(60):
        assert mutate(other.original, 1, one) == mutate(prepared.original, 1, two)
