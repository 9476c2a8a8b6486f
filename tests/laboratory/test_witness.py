"""The witness of a certificate: replayed number for number, or refused."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meso_robust.errors import InputError
from meso_robust.laboratory.draws import draw
from meso_robust.laboratory.running import run
from meso_robust.laboratory.witness import read_witness
from tests.conftest import paper_task
from tests.laboratory.paper import REPORT, paper_plan_document, paper_player

FIRST = Path(__file__).parents[1] / "checker" / "schema_one" / "paper.json"
"""The same certificate as it was written in schema 1."""


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


@pytest.mark.parametrize("source", [REPORT / "certificate.json", FIRST], ids=["2", "1"])
def test_witness_is_replayed_number_for_number(tmp_path: Path, source: Path) -> None:
    player = paper_player()
    path = certificate(tmp_path, source)

    row = read_witness(path, paper_task(), paper_plan_document(), player).row
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
