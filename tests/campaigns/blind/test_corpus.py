"""A corpus on the disk: what is accepted, and how what is wrong is named."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from meso_robust.campaigns.blind.corpus import labels_hash, opened_labels, sets_of
from meso_robust.campaigns.blind.labels import KINDS, STAGE, TITLES
from meso_robust.campaigns.blind.sealing import (
    COMMITMENT,
    SEALED,
    Commitment,
    Sealed,
    append,
    digest,
    merkle_root,
    sha256,
)
from meso_robust.errors import InputError
from reports.blind.corpus import STAGE as PUBLISHED

NULL: dict[str, Any] = {
    "kind": "null",
    "names": [],
    "truth": {"stages": [], "multiples": [], "parameters": []},
}
BACKLASH: dict[str, Any] = {
    "kind": "effect",
    "names": ["backlash"],
    "truth": {"stages": ["actuation"], "multiples": [4.0], "parameters": [{"width_um": 3.0}]},
}


def sets(folder: Path, *names: str) -> None:
    """Sets that hold nothing but their name."""
    for name in names:
        (folder / "sets" / name).mkdir(parents=True)
        (folder / "sets" / name / "set.toml").write_text(name, encoding="utf-8")


def labelled(folder: Path, *lines: Any) -> None:
    text = "".join(json.dumps(line) + "\n" for line in lines)
    (folder / "labels.jsonl").write_text(text, encoding="utf-8")


def committed(folder: Path) -> None:
    """A corpus of one's own, sealed with what the package offers; its labels state no seeds."""
    sets(folder, "one", "two")
    append(folder / SEALED, {"master": 64 * "5"})
    cases = [
        Sealed(k, label, digest(folder / "sets" / name), f"{k:064x}")
        for k, (name, label) in enumerate((("one", NULL), ("two", BACKLASH)))
    ]
    for case in cases:
        append(folder / SEALED, {"index": case.index, "label": case.label,
                                 "recordings": case.recordings, "salt": case.salt})  # fmt: skip
    hashes = tuple(case.hash for case in cases)
    told = Commitment(
        date="2026-01-01", diagnoser=64 * "d", generator="", master=sha256(bytes.fromhex(64 * "5")),
        corpus={}, quick=True, cases=hashes, root=merkle_root(hashes),
    )  # fmt: skip
    (folder / COMMITMENT).write_text(told.text(), encoding="utf-8")


def test_stated_labels_are_found_by_the_names_of_the_sets(tmp_path: Path) -> None:
    sets(tmp_path, "b", "a")
    labelled(tmp_path, {"set": "b", "label": BACKLASH}, {"set": "a", "label": NULL})
    known = sets_of(tmp_path)
    assert list(known) == ["a", "b"]
    found = opened_labels(tmp_path, known, labels_hash(tmp_path))
    assert found.state == "stated"
    assert {name: label["kind"] for name, label in found.labels.items()} == {
        "a": "null",
        "b": "effect",
    }


def test_a_commitment_of_ones_own_is_checked(tmp_path: Path) -> None:
    committed(tmp_path)
    found = opened_labels(tmp_path, sets_of(tmp_path), labels_hash(tmp_path))
    assert (found.state, found.labels["two"]["names"]) == ("committed", ["backlash"])
    text = (tmp_path / SEALED).read_text(encoding="utf-8")
    (tmp_path / SEALED).write_text(text.replace("3.0", "4.0"), encoding="utf-8")
    found = opened_labels(tmp_path, sets_of(tmp_path), labels_hash(tmp_path))
    assert (found.state, found.labels) == ("broken", {})
    assert "case 1: the label opened is not the label committed to" in found.why


def test_a_set_that_is_added_is_found(tmp_path: Path) -> None:
    committed(tmp_path)
    sets(tmp_path, "three")
    found = opened_labels(tmp_path, sets_of(tmp_path), labels_hash(tmp_path))
    assert found.why.endswith("3 recording sets, but 2 labels were committed to")


def test_a_changed_set_has_another_digest(tmp_path: Path) -> None:
    sets(tmp_path, "a", "b")
    before = sets_of(tmp_path)
    (tmp_path / "sets" / "b" / "set.toml").write_text("c", encoding="utf-8")
    after = sets_of(tmp_path)
    assert (after["a"] == before["a"], after["b"] == before["b"]) == (True, False)


def test_a_folder_without_sets_or_labels_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no recording sets"):
        sets_of(tmp_path)
    with pytest.raises(InputError, match=r"neither commitment.json nor labels.jsonl"):
        labels_hash(tmp_path)


@pytest.mark.parametrize(
    ("lines", "why"),
    [
        ([{"set": "a", "label": NULL}], "no line for set 'b'"),
        ([{"set": "a", "label": NULL}] * 2, "line 2: set = 'a': twice"),
        ([{"set": "c", "label": NULL}], "line 1: set = 'c': no folder"),
        ([{"label": NULL}], "line 1: must be"),
        ([{"set": "a", "label": {**NULL, "kind": "nothing"}}], "line 1: label.kind"),
        ([{"set": "a", "label": {**BACKLASH, "names": ["x", "y"]}}], "truth.stages has 1 entries"),
        ([{"set": "a", "label": {**BACKLASH, "kind": "null"}}], "kind 'null' has none"),
        ([{"set": "a", "label": {**NULL, "kind": "pair"}}], "has at least one"),
    ],
)
def test_labels_that_break_a_rule_are_named(tmp_path: Path, lines: list[Any], why: str) -> None:
    sets(tmp_path, "a", "b")
    labelled(tmp_path, *lines)
    found = opened_labels(tmp_path, sets_of(tmp_path), labels_hash(tmp_path))
    assert (found.state, found.labels) == ("broken", {})
    assert why in found.why


def test_the_stages_are_those_that_the_generator_publishes() -> None:
    assert {name: STAGE[name] for name in PUBLISHED} == PUBLISHED
    assert set(TITLES) == set(KINDS)
