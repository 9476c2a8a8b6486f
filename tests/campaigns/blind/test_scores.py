"""A blind benchmark that was run and scored before, scored again from its answers."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import pytest

from meso_robust.campaigns.blind.asking import essence
from meso_robust.campaigns.blind.kind import BLIND
from meso_robust.campaigns.blind.sealing import (
    COMMITMENT,
    SEALED,
    read_results,
    read_sealed,
    sha256,
)
from meso_robust.campaigns.blind.section import BlindSection
from meso_robust.campaigns.encoding import canonical
from meso_robust.campaigns.kind import Part, Result, Table

TRIAL = Path(__file__).resolve().parents[3] / "reports" / "blind" / "second_trial"
SCORED = json.loads((TRIAL / "results.json").read_text(encoding="utf-8"))
"""What was published, before there were campaigns."""


def part_of(corpus: Path = TRIAL) -> Part:
    """The campaign that the trial would have been; its recordings are not kept, their digests are."""
    _, cases = read_sealed(TRIAL)
    section = BlindSection(name="trial", kind="blind", corpus=str(corpus), quick=True)
    given = {
        "corpus": str(corpus),
        "sets": {f"{case.index:04d}": case.recordings for case in cases},
        "labels": sha256((corpus / COMMITMENT).read_bytes()),
    }
    return Part(
        name="trial", kind="blind", seed=1, confidence=0.95, asked=section.model_dump(), given=given
    )


def results() -> Iterator[Result]:
    """The answers of the trial as results of chunks, through JSON as a store keeps them."""
    for index, told in sorted(read_results(TRIAL).items()):
        answer = {"document": essence(told["document"])}
        found = Result(
            runs=1, failed=0, failures=(), values={"set": f"{index:04d}", "answer": answer}
        )
        yield Result(**json.loads(canonical(asdict(found))))


@pytest.fixture(scope="module")
def values() -> Any:
    return BLIND.total(part_of(), results())


def rates(value: Any) -> Any:
    """All shares of a table of scores, without their intervals."""
    if isinstance(value, dict):
        return {key: rates(item) for key, item in value.items()}
    return [rates(item) for item in value] if isinstance(value, list) else value


def test_the_scores_are_those_that_were_published(values: Any) -> None:
    assert values["labels"]["state"] == "committed"
    assert values["planned"] == sum(values["verdicts"].values()) == 360
    for key in SCORED.keys() - {"seconds"}:
        assert json.loads(canonical(values["scores"][key])) == SCORED[key], key
    assert values["scores"]["seconds"] == {"count": 0}


def test_the_report_tells_what_was_published(values: Any) -> None:
    told = BLIND.tell(part_of(), json.loads(canonical(values)))
    assert told.verdict == "measured"
    assert "every one opened matches" in told.answer
    figures = dict(told.figures)
    assert figures["false alarms where nothing is concealed"] == "1.0 % (1/100; 0 … 6 %)"
    assert figures["right name, one effect of ≥ 4×"].startswith("87.5 % (70/80;")
    wrong = next(view for view in told.views if view.title == "Wrong and confident")
    assert isinstance(wrong, Table)
    assert len(wrong.rows) == 10


def test_intervals_are_those_of_the_campaign(values: Any) -> None:
    """No hit of 100 at 99 %: the upper end solves (1 - p)^100 = 0.005."""
    share = {"hits": 0, "count": 100}
    scores = {**values["scores"], "nulls": {"alarms": share, "named": share}}
    told = BLIND.tell(replace(part_of(), confidence=0.99), {**values, "scores": scores})
    upper = 100 * (1 - 0.005 ** (1 / 100))
    assert dict(told.figures)["false alarms where nothing is concealed"].endswith(
        f"0 … {math.ceil(upper)} %)"  # outward
    )


def test_chunks_that_are_missing_are_missed_in_the_counts() -> None:
    found = BLIND.total(part_of(), list(results())[:90])
    assert sum(found["scores"]["cases"]["run"].values()) == 90
    assert sum(found["scores"]["cases"]["planned"].values()) == 360
    assert "90 of 360 sets" in BLIND.tell(part_of(), found).answer


@pytest.mark.parametrize(
    ("file", "change", "state", "why"),
    [
        (
            SEALED,
            lambda text: text.replace('"names":["backlash"]', '"names":["tip_radius"]', 1),
            "broken",
            "label",
        ),
        (SEALED, None, "withheld", "not there"),
        (COMMITMENT, lambda text: text + "\n", "broken", "changed since"),
        (COMMITMENT, None, "broken", "neither"),
    ],
)
def test_labels_that_are_not_those_committed_to_score_nothing(
    tmp_path: Path, file: str, change: Any, state: str, why: str
) -> None:
    for name in (SEALED, COMMITMENT):
        (tmp_path / name).write_bytes((TRIAL / name).read_bytes())
    part = part_of(tmp_path)
    path = tmp_path / file
    if change is None:
        path.unlink()
    else:
        path.write_text(change(path.read_text(encoding="utf-8")), encoding="utf-8")
    found = BLIND.total(part, results())
    assert found["labels"]["state"] == state
    assert why in found["labels"]["why"]
    assert "scores" not in found
    told = BLIND.tell(part, found)
    assert told.verdict == ("broken" if state == "broken" else "measured")
    assert "360 of 360 sets were diagnosed" in told.answer


def test_recordings_other_than_those_sealed_score_nothing() -> None:
    part = part_of()
    sets = {**part.given["sets"], "0003": 64 * "0"}
    found = BLIND.total(replace(part, given={**part.given, "sets": sets}), results())
    assert found["labels"]["why"].endswith(
        "set 0003: its recordings are not the ones that were sealed"
    )
