"""``meso-robust recordings`` as a user meets it: exit status, messages, files."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from meso_robust.cli import app
from meso_robust.recordings import read_set, write_set
from tests.recordings.importers import written
from tests.recordings.planted import MIDDLE, UM, clean, planted, poses

RUNNER = CliRunner()
FILES = ["report.html", "summary.json"]


def recordings(*words: object) -> Any:
    return RUNNER.invoke(app, ["recordings", *map(str, words)])


@pytest.fixture
def spoilt(tmp_path: Path) -> Path:
    """A set with a pose of zeros and a clock that repeats."""
    changed = poses()
    changed[20] = 0.0
    folder = tmp_path / "spoilt"
    write_set(folder, planted(poses=changed))
    rows = (folder / MIDDLE).read_text().splitlines()
    rows.insert(100, rows[99])
    (folder / MIDDLE).write_text("\n".join(rows) + "\n")
    return folder


def test_a_clean_set_is_said_to_be_clean(tmp_path: Path) -> None:
    write_set(tmp_path / "set", clean())
    result = recordings(tmp_path / "set", "--out", tmp_path / "out")
    assert result.exit_code == 0
    assert result.stdout.splitlines() == [
        "CLEAN: 3 recordings, 720 rows",
        f"report: {tmp_path / 'out' / 'report.html'}",
    ]
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == FILES
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["verdict"] == "CLEAN"


def test_problems_are_listed_with_file_and_lines(spoilt: Path, tmp_path: Path) -> None:
    result = recordings(spoilt, "--out", tmp_path / "out")
    assert result.exit_code == 1
    assert f"error: {MIDDLE}, line 101: clock that repeats or runs backwards:" in result.stdout
    assert f"error: {MIDDLE}, line 22: pose of zeros: not found:" in result.stdout
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == FILES


def test_repair_writes_a_set_that_is_clean_and_leaves_the_old_one(
    spoilt: Path, tmp_path: Path
) -> None:
    before = {path.name: path.read_bytes() for path in spoilt.iterdir()}
    result = recordings(spoilt, "--repair", "--out", tmp_path / "out")
    assert result.exit_code == 0, result.stdout
    assert result.stdout.startswith("CLEAN: 3 recordings")
    assert f"repaired: {MIDDLE}, line 101: clock that repeats or runs backwards:" in result.stdout
    assert {path.name: path.read_bytes() for path in spoilt.iterdir()} == before
    mended = read_set(tmp_path / "out" / "recordings").recordings[1]
    assert np.flatnonzero(np.isnan(mended.poses[:, 0])).tolist() == [20]
    again = recordings(tmp_path / "out" / "recordings", "--out", tmp_path / "again", "--quiet")
    assert (again.exit_code, again.stdout.partition(":")[0]) == (0, "CLEAN")


def test_what_repair_cannot_mend_remains(tmp_path: Path) -> None:
    part = replace(clean().part, length=1600 * UM, width=800 * UM)  # type: ignore[arg-type]
    tiny = tuple(
        replace(one, poses=one.poses * [1e-3, 1e-3, 1.0], probes=one.probes * 1e-3)
        for one in clean().recordings
    )
    write_set(tmp_path / "set", clean(part=part, recordings=tiny))
    result = recordings(tmp_path / "set", "--repair", "--out", tmp_path / "out")
    assert result.exit_code == 1
    assert result.stdout.startswith("NOT USABLE AS IT IS")
    assert "part and probes in mm: factor 1000" in result.stdout


def test_json_prints_the_document_and_nothing_else(spoilt: Path, tmp_path: Path) -> None:
    result = recordings(spoilt, "--json", "--out", tmp_path / "out")
    assert result.exit_code == 1
    assert result.stdout == (tmp_path / "out" / "summary.json").read_text()
    assert len(json.loads(result.stdout)["found"]) >= 2


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["{}/none"], "does not exist; give the folder of a recording set"),
        (["{}"], "no set.toml in it and no known format"),
        (["{}/spoilt", "--format", "avi"], "--format avi: must be one of set, "),
        (
            ["{}/spoilt/push_00.csv", "--format", "set"],
            "set.toml: cannot be read (Not a directory)",
        ),
    ],
)
def test_bad_input_is_refused_in_one_line(
    spoilt: Path, tmp_path: Path, words: list[str], message: str
) -> None:
    result = recordings(
        *(word.replace("{}", str(tmp_path)) for word in words), "--out", tmp_path / "out"
    )
    assert result.exit_code == 2
    assert message in result.stderr.splitlines()[-1]
    assert "Traceback" not in result.stderr
    assert not (tmp_path / "out").exists()


def test_the_recordings_that_were_read_are_never_written_over(tmp_path: Path) -> None:
    write_set(tmp_path / "recordings", clean())
    before = (tmp_path / "recordings" / MIDDLE).read_bytes()
    result = recordings(tmp_path / "recordings", "--repair", "--out", tmp_path)
    assert result.exit_code == 2
    assert "would overwrite the recordings" in result.stderr
    assert (tmp_path / "recordings" / MIDDLE).read_bytes() == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["recordings"]


BUTTERFLY = "[part]\npolygon_um = [[-30000, -18000], [0, -9000], [30000, -18000], [30000, 18000], [0, 9000], [-30000, 18000]]\n"


def test_a_part_that_no_importer_knows_is_given_its_outline(tmp_path: Path) -> None:
    rows = [(1.5e9 + 0.03 * k, 10.0, 20.0, 1.5, 60.0 + k, 50.0, 0.0, 1) for k in range(12)]
    log = written.two_finger(tmp_path / "butter_60_20_135", rows)
    stated = tmp_path / "butterfly.toml"
    stated.write_text(BUTTERFLY)

    without = recordings(log.parent, "--out", tmp_path / "a")
    given = recordings(log.parent, "--outline", stated, "--out", tmp_path / "b")

    assert without.exit_code == 2
    assert "--outline" in without.stderr
    assert given.exit_code in (0, 1), given.output
    outline = read_set(tmp_path / "b" / "recordings").part.outline
    assert outline[1] == pytest.approx([0.0, -9e-3])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[probe]\ntip_radius_um = 1.0\n", "key part is missing"),
        ("[part]\nlength_um = 10.0\n", "no outline"),
        ("[part]\nlength_um = 10.0\nwidth_um = 5.0\nheight = 2\n", "height"),
    ],
)
def test_a_wrong_outline_is_refused_by_name(tmp_path: Path, text: str, words: str) -> None:
    log = written.two_finger(
        tmp_path / "butter_1", [(1.5e9 + k, 1, 2, 3, 4, 5, 6, 1) for k in (0, 1)]
    )
    (tmp_path / "part.toml").write_text(text)

    result = recordings(log, "--outline", tmp_path / "part.toml", "--out", tmp_path / "out")

    assert result.exit_code == 2
    assert "part.toml" in result.stderr
    assert words in result.stderr


def test_an_outline_beside_a_set_that_states_it_is_refused(tmp_path: Path) -> None:
    write_set(tmp_path / "set", clean())
    (tmp_path / "part.toml").write_text(BUTTERFLY)

    result = recordings(tmp_path / "set", "--outline", tmp_path / "part.toml", "--out", tmp_path)

    assert result.exit_code == 2
    assert "states its part in set.toml" in result.stderr
