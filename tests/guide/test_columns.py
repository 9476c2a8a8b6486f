"""Columns and keys that the guide tells by hand are those of files that are read and written."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import meso_robust as mr
from meso_robust.errors import InputError
from meso_robust.example import EXAMPLE
from meso_robust.laboratory.trajectories import trajectories
from meso_robust.recordings.table import read_table, table_text
from meso_robust.tasks import PAPER
from meso_robust.tracking.commands import read_commands
from meso_robust.tracking.frames import Frames
from meso_robust.tracking.track import Track
from meso_robust.tracking.tracked_set import covariance_text
from reports.guide.columns import (
    CAMPAIGN,
    CHECK,
    COMMANDS,
    COVARIANCE,
    DRIVE,
    RECORDING,
    TRAJECTORIES,
)

REPORT = Path(mr.__file__).parents[1] / "reports" / "paper_task"
PROBES = ("left", "right")


def csv_of(folder: Path, header: list[str]) -> Path:
    """A file of two rows; every cell is a number."""
    rows = [",".join(str(row + k) for k in range(len(header))) for row in range(2)]
    path = folder / "table.csv"
    path.write_text("\n".join([",".join(header), *rows, ""]), encoding="utf-8")
    return path


def first_line(text: str) -> list[str]:
    return text.splitlines()[0].split(",")


def test_columns_of_a_recording_are_read_and_written(tmp_path: Path) -> None:
    header = RECORDING.header(PROBES)
    text = table_text(read_table(csv_of(tmp_path, header), PROBES))
    cells = dict(zip(first_line(text), text.splitlines()[1].split(","), strict=True))

    assert sorted(cells) == sorted(header)
    for at, name in enumerate(header):  # every number went where its column says
        assert float(cells[name]) == pytest.approx(at), name


def test_only_columns_that_may_be_left_out_may_be(tmp_path: Path) -> None:
    needed = RECORDING.header(PROBES, optional=False)

    assert read_table(csv_of(tmp_path, needed), PROBES).forces is None
    for name in needed:
        rest = [one for one in needed if one != name]
        with pytest.raises(InputError, match=f"column '{name}' is missing"):
            read_table(csv_of(tmp_path, rest), PROBES)
    half = [one for one in RECORDING.header(PROBES) if one != "left_fy_un"]
    with pytest.raises(InputError, match="column 'left_fy_un' is missing"):
        read_table(csv_of(tmp_path, half), PROBES)


def test_columns_of_a_controllers_log_are_read(tmp_path: Path) -> None:
    header = COMMANDS.header(PROBES)
    shipped = (EXAMPLE / "videos" / "push_0.csv").read_text(encoding="utf-8")

    assert read_commands(csv_of(tmp_path, header)).tips[0, :, 0] * 1e6 == pytest.approx([1, 3])
    assert first_line(shipped) == COMMANDS.header(("probe1",))
    for k in range(len(header)):
        with pytest.raises(InputError, match="must be time_s, then"):
            read_commands(csv_of(tmp_path, header[:k] + header[k + 1 :]))


def test_columns_of_covariances_are_written() -> None:
    text = covariance_text(seen())
    cells = dict(zip(first_line(text), text.splitlines()[1].split(","), strict=True))

    assert first_line(text) == COVARIANCE.header(PROBES)
    assert float(cells["part_xx_um2"]) == pytest.approx(4.0)
    assert float(cells["part_xt_um_deg"]) == pytest.approx(0.5)
    assert float(cells["part_tt_deg2"]) == pytest.approx(0.25)
    assert float(cells["right_x_um"]) == pytest.approx(7.0)
    assert float(cells["right_xy_um2"]) == pytest.approx(-1.0)


def seen() -> Track:
    """A frame of a part and two tips; 2 um in x, 0.5 deg in θ, correlated by a half."""
    deg, um = np.pi / 180.0, 1e-6
    part = np.diag([2.0 * um, 1.0 * um, 0.5 * deg]) ** 2
    part[0, 2] = part[2, 0] = 0.5 * um * deg
    tip = np.array([[4.0, -1.0], [-1.0, 9.0]]) * um**2
    return Track(
        frames=Frames(
            path=Path("x"),
            rate=30.0,
            size=(4, 3),
            promised=1,
            notes=(),
            allow_truncated=False,
            _read=lambda: iter(()),
        ),
        times=np.zeros(1),
        poses=np.zeros((1, 3)),
        covariances=part[None],
        names=PROBES,
        tips=np.array([[[5.0, 6.0], [7.0, 8.0]]]) * um,
        tip_covariances=np.stack([tip, tip])[None],
        states=("found",),
        reasons=("",),
        tip_reasons=(("", ""),),
        scores=np.ones(1),
        notes=(),
    )


def test_columns_of_trajectories_are_written() -> None:
    found = mr.simulate(mr.Task.paper(), REPORT / "plan.json", samples=1)

    names = ("dtp_top", "dtp_bottom", "stp")
    assert first_line(trajectories(found.runs)) == TRAJECTORIES.header(names)


def test_keys_of_the_checkers_answer_are_told() -> None:
    found = mr.check(REPORT / "certificate.json", mr.Task.paper())
    document = json.loads(json.dumps(found.document))

    assert list(document) == CHECK.header(())
    assert document["schema"] in CHECK.columns[0].meaning


def test_keys_of_a_campaigns_answer_are_told(tmp_path: Path) -> None:
    """With failures (three times the uncertainty), so that no list is empty but that of troubles."""
    file = tmp_path / "campaign.toml"
    file.write_text(
        'schema = "meso-robust/campaign/1"\nname = "x"\n[[part]]\nname = "rate"\nfactor = 3.0\n'
        f'kind = "monte-carlo"\nplan = "{REPORT / "plan.json"}"\nexecutions = 50\n',
        encoding="utf-8",
    )
    found = json.loads(mr.campaign(file, workers=1).text())
    (part,) = found["parts"]
    told = CAMPAIGN.header(())

    assert [one for one in told if "." not in one] == [one for one in found if one != "parts"]
    assert [one for one in told if "." in one] == [f"parts.{key}" for key in part]
    meanings = {one.name: one.meaning for one in CAMPAIGN.columns}
    assert list(part["failures"][0]) == quoted(meanings["parts.failures"])
    assert list(part["chunks"]) == quoted(meanings["parts.chunks"])
    assert list(found["sessions"][0]) == quoted(meanings["sessions"])


def quoted(text: str) -> list[str]:
    """Words in back quotes."""
    return text.split("`")[1::2]


def test_answers_of_drive_are_told_apart_by_the_keys_that_are_told() -> None:
    driver = mr.drive(PAPER, REPORT / "plan.json")
    told = [one.name for one in DRIVE.columns]
    lines = [
        '{"x_um": 2060.4, "y_um": -9.2, "theta_deg": 90}',
        '{"x_um": 9000, "y_um": 0, "theta_deg": 90}',
    ]
    answers = [driver.answer_line(line) for line in [*lines, "\n"]]

    assert [next(key for key in told if key in answer) for answer in answers] == [
        "probes",
        "refused",
        "error",
    ]
    assert sorted(told) == ["done", "error", "probes", "refused"]
