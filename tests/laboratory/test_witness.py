"""The witness of a certificate: replayed number for number, or refused."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meso_robust.certificates.document import WitnessDocument
from meso_robust.errors import InputError
from meso_robust.laboratory.draws import draw
from meso_robust.laboratory.replay import Feedback
from meso_robust.laboratory.running import run
from meso_robust.laboratory.simulation import player_of
from meso_robust.laboratory.witness import more_of, read_witness, witness_row
from meso_robust.planning.plan_file import RuleDocument
from meso_robust.primitives.setup import setup_of
from tests.conftest import paper_task
from tests.laboratory.paper import REPORT, paper_plan_document, paper_player
from tests.laboratory.test_box import real_task

EARLIER = Path(__file__).parents[1] / "checker"
SOURCES = {
    "2": REPORT / "certificate.json",
    "2, of point tips alone": EARLIER / "schema_two" / "paper.json",
    "1": EARLIER / "schema_one" / "paper.json",
}
"""Certificates of plans of the paper's task, as each kind was written."""


def certificate(folder: Path, source: Path = REPORT / "certificate.json", **changes: Any) -> Path:
    """The paper's certificate made into one with a witness, with some of it changed."""
    values = json.loads(source.read_text(encoding="utf-8"))
    player = paper_player()
    draws = draw(player.setup, 4, 3, np.random.default_rng(9))

    def hexed(array: np.ndarray) -> Any:
        return float(array).hex() if array.ndim == 0 else [hexed(part) for part in array]

    witness = {
        "outcome": "made up",
        "start": hexed(draws.start[2]),
        "friction": hexed(draws.friction[2]),
        "film_ratio_m2": hexed(draws.film_ratio[2]),
        "misalignment_rad": hexed(draws.misalignment[2]),
        "sensing": hexed(draws.sensing[2]),
        "dual_probe": hexed(draws.dual[2]),
        "single_probe": hexed(draws.single[2]),
    }
    inner = {name: changes.pop(name) for name in list(changes) if name in witness}
    values |= {"verdict": "REFUTED", "witness": witness | inner} | changes
    path = folder / "certificate.json"
    path.write_text(json.dumps(values), encoding="utf-8")
    return path


@pytest.mark.parametrize("kind", SOURCES)
def test_witness_is_replayed_number_for_number(tmp_path: Path, kind: str) -> None:
    path = certificate(tmp_path, SOURCES[kind])
    policy = json.loads(path.read_text(encoding="utf-8"))["policy"]
    rules = [RuleDocument.model_validate_json(json.dumps(rule)) for rule in policy]
    plan = paper_plan_document().model_copy(update={"policy": tuple(rules)})
    player = player_of(plan, setup_of(paper_task()))
    assert isinstance(player, Feedback)

    row = read_witness(path, paper_task(), plan, player).row
    expected = draw(player.setup, 4, 3, np.random.default_rng(9))
    direct = run(player.rules, player.setup, expected)

    assert np.array_equal(row[0], player.rows_of(expected)[2])
    # the three runs share the longest travel's number of steps, one by itself has its own
    assert np.allclose(player.run(row).final[0], direct.final[2], atol=2e-7)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"verdict": "PROVED"}, "verdict = 'PROVED'"),
        ({"witness": None}, "verdict = 'REFUTED'"),
        ({"task_hash": "1" * 64}, "task_hash"),
        ({"policy": []}, "policy"),
        ({"more": 1}, "more is unknown"),
        ({"friction": "nan"}, r"witness\.friction = 'nan'"),
        ({"friction": "third"}, r"witness\.friction = 'third'"),
        ({"friction": "0x1p-1"}, r"friction = 0\.5; must lie within \[0\.3, 0\.36\]"),
        ({"dual_probe": [["0x0p+0", "0x0p+0"]]}, r"witness\.dual_probe: 1 entries; must be 4"),
        ({"sensing": [["0x0p+0"] * 3] * 4}, r"witness\.sensing\.0"),
    ],
)
def test_witness_that_is_none_is_refused(
    tmp_path: Path, changes: dict[str, Any], words: str
) -> None:
    path = certificate(tmp_path, **changes)

    with pytest.raises(InputError, match=words) as refused:
        read_witness(path, paper_task(), paper_plan_document(), paper_player())
    assert str(path) in str(refused.value)


def of_real_probes() -> tuple[Feedback, np.ndarray, WitnessDocument]:
    """A run with round tips, a friction of each tip and a real part, and what a certificate holds of it."""
    player = replace(paper_player(), setup=setup_of(real_task()))
    draws = draw(player.setup, 4, 3, np.random.default_rng(9))
    row = player.rows_of(draws)[2]

    def hexed(array: np.ndarray) -> Any:
        return float(array).hex() if array.ndim == 0 else tuple(hexed(part) for part in array)

    held = WitnessDocument(
        outcome="made up",
        start=hexed(draws.start[2]),
        friction=hexed(draws.friction[2]),
        film_ratio_m2=hexed(draws.film_ratio[2]),
        misalignment_rad=hexed(draws.misalignment[2]),
        sensing=hexed(draws.sensing[2]),
        dual_probe=hexed(draws.dual[2]),
        single_probe=hexed(draws.single[2]),
        more=more_of(player, row),
    )
    return player, row, held


def test_a_certificate_holds_all_of_a_run_with_real_probes() -> None:
    player, row, held = of_real_probes()
    assert np.array_equal(witness_row(held, player, "certificate.json")[0], row)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({}, r"witness\.more\.dtp_bottom radius_m is missing: the task leaves it open"),
        ({"colour": "0x1p-1"}, r"witness\.more\.colour is unknown"),
        ({"dtp_top radius_m": "0x1p-1"}, r"dtp_top radius_m = 0\.5; must lie within"),
    ],
)
def test_a_run_that_is_not_all_there_is_refused(change: dict[str, str], words: str) -> None:
    player, _, held = of_real_probes()
    left = {name: value for name, value in held.more.items() if change or "radius" not in name}
    with pytest.raises(InputError, match=words):
        witness_row(held.model_copy(update={"more": left | change}), player, "certificate.json")
