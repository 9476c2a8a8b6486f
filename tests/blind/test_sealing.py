"""What is opened is what was committed to, or it is refused."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest

from meso_robust.campaigns.blind.sealing import (
    COMMITMENT,
    RESULTS,
    SEALED,
    Commitment,
    Sealed,
    SealError,
    append,
    canonical,
    digest,
    merkle_root,
    opened,
    read_results,
    seed_of,
    sha256,
)

DIAGNOSER, MASTER = 32 * "d1", 32 * "5a"


def committed(folder: Path) -> Path:
    """A folder with three sealed cases and their commitment."""
    seeds = [seed_of(DIAGNOSER, MASTER, k) for k in range(3)]
    cases = [
        Sealed(k, {"seed": seed, "names": ["backlash"]}, 64 * "0", f"{k:064x}")
        for k, seed in enumerate(seeds)
    ]
    append(folder / SEALED, {"master": MASTER})
    for case in reversed(cases):  # they are sealed in the order in which they are made
        append(folder / SEALED, asdict(case))
    hashes = tuple(case.hash for case in cases)
    commitment = Commitment(
        date="2026-01-01T00:00:00+00:00",
        diagnoser=DIAGNOSER,
        generator=64 * "0",
        master=sha256(bytes.fromhex(MASTER)),
        corpus={},
        quick=False,
        cases=hashes,
        root=merkle_root(hashes),
    )
    (folder / COMMITMENT).write_text(commitment.text(), encoding="utf-8")
    return folder


def changed(path: Path, change: Callable[[list[Any]], None]) -> None:
    """Rewrite a file of JSON lines, or of one JSON text."""
    lines = path.suffix == ".jsonl"
    text = path.read_text(encoding="utf-8")
    values = [json.loads(line) for line in text.splitlines()] if lines else [json.loads(text)]
    change(values)
    path.write_text("".join(json.dumps(value) + "\n" for value in values), encoding="utf-8")


def test_a_label_opens_to_what_was_sealed(tmp_path: Path) -> None:
    _, cases = opened(committed(tmp_path))
    assert [case.label["names"] for case in cases] == [["backlash"]] * 3


def test_a_hash_can_be_checked_by_hand(tmp_path: Path) -> None:
    """The text that is hashed, written out; only hashlib is used."""
    commitment, cases = opened(committed(tmp_path))
    seed = cases[1].label["seed"]
    text = f'{{"label":{{"names":["backlash"],"seed":{seed}}},"recordings":"{64 * "0"}"}}'
    assert commitment.cases[1] == hashlib.sha256(text.encode() + 31 * b"\0" + b"\1").hexdigest()


TAMPERED: dict[str, tuple[str, Callable[[list[Any]], None], str]] = {
    "label": (
        SEALED,
        lambda v: v[1]["label"].update(names=["camera_latency"]),
        "case 2: the label",
    ),
    "recordings": (SEALED, lambda v: v[3].update(recordings=64 * "1"), "case 0: the label"),
    "salt": (SEALED, lambda v: v[2].update(salt=64 * "1"), "case 1: the label"),
    "master salt": (SEALED, lambda v: v[0].update(master=64 * "1"), "master salt"),
    "case left out": (SEALED, lambda v: v.pop(), "missing"),
    "case doubled": (SEALED, lambda v: v.append(v[1]), "duplicated"),
    "diagnoser": (COMMITMENT, lambda v: v[0].update(diagnoser=64 * "1"), "seed"),
    "root": (COMMITMENT, lambda v: v[0].update(root=64 * "1"), "root"),
}


@pytest.mark.parametrize("what", TAMPERED)
def test_tampering_is_found(tmp_path: Path, what: str) -> None:
    file, change, message = TAMPERED[what]
    changed(committed(tmp_path) / file, change)
    with pytest.raises(SealError, match=message):
        opened(tmp_path)


def test_the_root_of_three_is_worked_out_by_hand() -> None:
    a, b, c = (hashlib.sha256(name).digest() for name in (b"a", b"b", b"c"))
    both = hashlib.sha256(b"\x01" + a + b).digest()
    assert (
        merkle_root([a.hex(), b.hex(), c.hex()]) == hashlib.sha256(b"\x01" + both + c).hexdigest()
    )


def test_seeds_depend_on_diagnoser_salt_and_case() -> None:
    first = seed_of(DIAGNOSER, MASTER, 0)
    content = bytes.fromhex(DIAGNOSER + MASTER) + bytes(4)
    assert first == int.from_bytes(hashlib.sha256(content).digest()[:6], "big")
    others = [(64 * "1", MASTER, 0), (DIAGNOSER, 64 * "1", 0), (DIAGNOSER, MASTER, 1)]
    assert first not in {seed_of(*other) for other in others}


def test_the_canonical_text_does_not_depend_on_order_and_refuses_nan() -> None:
    assert (
        canonical({"b": 1, "a": [0.5]}) == b'{"a":[0.5],"b":1}' == canonical({"a": [0.5], "b": 1})
    )
    with pytest.raises(ValueError, match="JSON"):
        canonical(float("nan"))


def test_a_digest_sees_names_and_contents_but_no_caches(tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text("1")
    before = digest(tmp_path, ("*.py",))
    (tmp_path / "__pycache__").mkdir()
    (tmp_path / "__pycache__" / "a.py").write_text("cache")
    (tmp_path / "notes.md").write_text("notes")
    assert digest(tmp_path, ("*.py",)) == before
    (tmp_path / "a.py").write_text("2")
    assert digest(tmp_path, ("*.py",)) != before
    (tmp_path / "a.py").write_text("1")
    (tmp_path / "a.py").rename(tmp_path / "b.py")
    assert digest(tmp_path, ("*.py",)) != before


def test_a_line_cut_short_is_written_anew_and_a_second_shot_refused(tmp_path: Path) -> None:
    path = tmp_path / RESULTS
    append(path, {"index": 0})
    path.write_bytes(path.read_bytes() + b'{"index": 1, "secon')
    assert set(read_results(tmp_path)) == {0}
    append(path, {"index": 1})
    assert set(read_results(tmp_path)) == {0, 1}
    append(path, {"index": 0})
    with pytest.raises(SealError, match="case 0 was diagnosed twice"):
        read_results(tmp_path)
