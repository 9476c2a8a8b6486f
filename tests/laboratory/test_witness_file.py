"""``witness.json``: replayed number for number, or refused with the key that is wrong."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meso_robust.errors import InputError
from meso_robust.laboratory.replay import limits
from meso_robust.laboratory.witness import read_witness
from meso_robust.laboratory.witness_file import replay_files
from meso_robust.planning.reading import read_plan
from meso_robust.primitives.setup import setup_of
from meso_robust.task import load_task
from tests.conftest import paper_task
from tests.laboratory.paper import paper_plan_document, paper_player


def written(folder: Path, scale: float = 2.0, **changes: Any) -> Path:
    """Files of a run a quarter up the scaled ranges, with keys of the witness changed."""
    scaled = replace(paper_player(), setup=setup_of(paper_task(), scale))
    low, high = limits(scaled)
    row = np.clip(low + 0.25 * (high - low), low, high)
    files = replay_files(
        paper_task(),
        paper_plan_document(),
        paper_player(),
        row,
        factor=scale,
        engine="events",
        breaks=("it broke",),
    )
    values = json.loads(files["witness.json"])
    for key, value in changes.items():
        target, name = (values["row"], key[4:]) if key.startswith("row_") else (values, key)
        if value is None:
            del target[name]
        else:
            target[name] = value
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    (folder / "witness.json").write_text(json.dumps(values), encoding="utf-8")
    return folder / "witness.json"


def read(path: Path) -> Any:
    return read_witness(path, paper_task(), paper_plan_document(), paper_player())


@pytest.mark.parametrize("factor", [0.5, 1.0, 3.0])
def test_the_row_comes_back_to_the_last_bit(tmp_path: Path, factor: float) -> None:
    found = read(written(tmp_path, factor))
    low, high = limits(replace(paper_player(), setup=setup_of(paper_task(), factor)))
    assert np.array_equal(found.row[0], np.clip(low + 0.25 * (high - low), low, high))
    assert (found.engine, found.breaks) == ("events", ("it broke",))


def test_task_and_plan_beside_it_are_those_of_the_run(tmp_path: Path) -> None:
    written(tmp_path)
    task = load_task(tmp_path / "task.toml")
    assert task == paper_task()
    assert read_plan(tmp_path / "plan.json", task) == paper_plan_document()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"task_hash": "0" * 64}, "key task_hash"),
        ({"plan_hash": "0" * 64}, "key plan_hash"),
        ({"factor": -1.0}, "key factor"),
        ({"engine": "magic"}, "key engine"),
        ({"colour": "red"}, "key colour is unknown"),
        ({"factor": 0.1}, "must lie within"),
        ({"row_friction": "nan"}, "key row.friction = 'nan': must be a finite double"),
        ({"row_friction": "0x1p0"}, "key row.friction = 1: must lie within"),
        ({"row_friction": "word"}, "must be a finite double"),
        ({"row_friction": None}, "key row.friction is missing"),
        ({"row_magic": "0x0p0"}, "key row.magic is unknown"),
    ],
)
def test_bad_witnesses_are_refused(tmp_path: Path, changes: dict[str, Any], words: str) -> None:
    path = written(tmp_path, **changes)
    with pytest.raises(InputError) as caught:
        read(path)
    assert words in str(caught.value)
    assert str(path) in str(caught.value)
