"""Small recording sets of the independent generator, diagnosed chunk by chunk."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from meso_robust.campaigns.blind import asking
from meso_robust.campaigns.blind.kind import BLIND
from meso_robust.campaigns.blind.section import BlindSection
from meso_robust.campaigns.encoding import part_text, result_text
from meso_robust.campaigns.kind import Part, Result
from meso_robust.errors import InputError
from reports.blind.generator import Case, make, write
from tests.nightly import at_night

CASES = {
    "00": Case(kind="null", seed=31),
    "01": Case(kind="effect", names=("camera_latency",), multiples=(16.0,), seed=33),
}
BAD = "02"
"""A set without recordings."""
FRESH = """
import sys
from meso_robust.campaigns.blind.kind import BLIND
from meso_robust.campaigns.encoding import part_of, result_text
part = part_of(sys.stdin.read())
print(result_text(BLIND.execute(BLIND.prepare(part), part, 0)))
"""


def shortened(folder: Path, count: int) -> None:
    """Keep the first recordings of a set: enough to diagnose, in a fraction of the time."""
    head, *listed = (folder / "set.toml").read_text(encoding="utf-8").split("[[recording]]\n")
    kept = "".join(f"[[recording]]\n{one}" for one in listed[:count])
    (folder / "set.toml").write_text(head + kept, encoding="utf-8")
    for path in sorted(folder.glob("*.csv"))[count:]:
        path.unlink()


@pytest.fixture(scope="module")
def part(tmp_path_factory: pytest.TempPathFactory) -> Part:
    """A corpus of two sets that can be used and one that cannot."""
    corpus = tmp_path_factory.mktemp("corpus")
    lines: list[dict[str, Any]] = []
    for name, case in CASES.items():
        made = make(case)
        write(made, corpus / "sets" / name)
        shortened(corpus / "sets" / name, 2)
        label = {"kind": case.kind, "names": case.names, "truth": made.label}
        lines.append({"set": name, "label": label})
    (corpus / "sets" / BAD).mkdir()
    (corpus / "sets" / BAD / "set.toml").write_text("schema = 1\n", encoding="utf-8")
    lines.append({"set": BAD, "label": lines[0]["label"]})
    text = "".join(json.dumps(line) + "\n" for line in lines)
    (corpus / "labels.jsonl").write_text(text, encoding="utf-8")
    section = BlindSection(name="small", kind="blind", corpus=corpus.name, quick=True)
    given = BLIND.given(section, corpus.parent)
    assert given["corpus"] == str(corpus)
    return Part(
        name="small", kind="blind", seed=1, confidence=0.95, asked=section.model_dump(), given=given
    )


@pytest.fixture(scope="module")
def results(part: Part) -> list[Result]:
    assert BLIND.count(part) == 3
    return [BLIND.execute(BLIND.prepare(part), part, chunk) for chunk in range(3)]


def test_each_set_is_answered_and_scored(part: Part, results: list[Result]) -> None:
    verdicts = [one.values["answer"].get("document", {}).get("verdict") for one in results]
    assert verdicts[0] == "consistent"
    assert verdicts[1] in {"named", "ambiguous"}
    found = BLIND.total(part, results)
    assert found["labels"]["state"] == "stated"
    assert found["scores"]["nulls"]["alarms"]["hits"] == 0
    assert found["scores"]["naming"]["plain"]["in_set"]["hits"] == 1
    assert found["scores"]["cases"]["unanswered"]["hits"] == 1
    assert "there is no commitment" in BLIND.tell(part, found).answer


def test_a_set_that_cannot_be_diagnosed_is_counted(results: list[Result]) -> None:
    assert [one.failed for one in results] == [0, 0, 1]
    (failure,) = results[2].failures
    assert failure.what == "no answer"
    assert failure.detail.startswith(f"set {BAD}: InputError: {BAD}/set.toml")


@at_night
def test_a_fresh_process_gives_the_same_to_the_last_bit(part: Part, results: list[Result]) -> None:
    environment = {**os.environ, "PYTHONHASHSEED": "77"}
    told = subprocess.run(
        [sys.executable, "-c", FRESH],
        input=part_text(part), capture_output=True, text=True, env=environment, check=True,
    )  # fmt: skip
    assert told.stdout == result_text(results[0]) + "\n"
    assert result_text(BLIND.execute(None, part, 0)) + "\n" == told.stdout


def test_the_diagnosis_is_given_a_copy_whose_path_tells_nothing(
    part: Part, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[tuple[Path, list[str], bool, int]] = []

    def looking(folder: Path, *, quick: bool, seed: int) -> Any:
        seen.append((folder, sorted(os.listdir(folder.parent)), quick, seed))
        raise ValueError(f"{folder}/x")

    monkeypatch.setattr(asking, "diagnosed", looking)
    (failure,) = BLIND.execute(None, part, 1).failures
    ((folder, beside, quick, seed),) = seen
    assert (folder.name, beside, quick, seed) == ("recordings", ["recordings"], True, 0)
    assert not folder.is_relative_to(part.given["corpus"])
    assert not folder.exists()
    assert failure.detail == "set 01: ValueError: 01/x"


@pytest.mark.parametrize("error", [MemoryError, OSError, KeyboardInterrupt])
def test_a_machine_that_fails_is_no_answer_of_the_diagnosis(
    part: Part, monkeypatch: pytest.MonkeyPatch, error: type[BaseException]
) -> None:
    def failing(folder: Path, *, quick: bool, seed: int) -> Any:
        raise error

    monkeypatch.setattr(asking, "diagnosed", failing)
    with pytest.raises(error):
        BLIND.execute(None, part, 0)


@pytest.mark.parametrize("name", ["00", "gone"])
def test_recordings_that_have_changed_are_refused(part: Part, name: str) -> None:
    other = {**part.given, "sets": {name: 64 * "0"}}
    with pytest.raises(InputError, match=f"{name}: differs from the recording set"):
        BLIND.execute(None, replace(part, given=other), 0)
