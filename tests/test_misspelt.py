"""A misspelt key is named together with the key that it resembles, in whatever file it stands."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from meso_robust.campaigns.document import read_campaign
from meso_robust.checker.reading import read_certificate
from meso_robust.errors import InputError
from meso_robust.identification.document import read_model
from meso_robust.planning.reading import read_plan
from meso_robust.policy.document import read_policy
from meso_robust.policy.policy_file import PolicyDocument
from meso_robust.policy.pose import PoseError, parse
from meso_robust.reading import like
from meso_robust.recordings import read_set
from meso_robust.task import Task, load_task
from meso_robust.tasks import PAPER
from meso_robust.tracking.calibration_document import load_calibration
from tests.laboratory import test_witness_file
from tests.recordings.examples import SET, TABLE, folder_of

ROOT = Path(__file__).parents[1]
MODEL = ROOT / "tests/example/model.toml"
HEXAGON = PAPER.with_name("hexagon.toml")
OWN = ROOT / "reports/paper_task"
CAMPAIGN = """\
schema = "meso-robust/campaign/1"
name = "x"
[[part]]
name = "p"
kind = "property"
properties = ["formula-values"]
examples = 1
"""
CALIBRATION = """\
schema = "meso-robust/calibration/1"
width_px = 640
height_px = 480
pixel_um = 5.26
"""


def of_the_paper_task(read: Callable[[Path, Task], object]) -> Callable[[Path], object]:
    return lambda path: read(path, load_task(PAPER))


def policy() -> str:
    """A policy of no cells: enough for its keys to be read."""
    rule = json.loads((OWN / "plan.json").read_text(encoding="utf-8"))["policy"][0]
    known = dict.fromkeys(PolicyDocument.model_json_schema(by_alias=True)["properties"], 0)
    return json.dumps({**known, "rules": [rule]})


TOLD: dict[str, tuple[Any, str, str, str, Callable[[Path], object]]] = {
    "task": (PAPER, "friction", "frction", "uncertainty.frction", load_task),
    "section of a task": (PAPER, "[uncertainty]", "[uncertanty]", "uncertanty", load_task),
    "part of a task": (PAPER, "length_um", "lenght_um", "part.lenght_um", load_task),
    "polygon of a task": (HEXAGON, "position_tolerance_um", "position_tolerance", "goal.position_tolerance", load_task),
    "model": (MODEL, "confidence", "confidense", "confidense", read_model),
    "kind of a campaign": (CAMPAIGN, "kind", "kinnd", "part[0].kinnd", read_campaign),
    "part of a campaign": (CAMPAIGN, "examples", "exmples", "part[0].exmples", read_campaign),
    "plan": (OWN / "plan.json", '"dual_x"', '"daul_x"', "policy.0.daul_x", of_the_paper_task(read_plan)),
    "schema of a plan": (OWN / "plan.json", '"schema"', '"shema"', "shema", of_the_paper_task(read_plan)),
    "policy": (policy, '"heading"', '"headng"', "rules.0.headng", of_the_paper_task(read_policy)),
    "certificate": (OWN / "certificate.json", '"premises": [', '"premisses": [', "claim.premisses", of_the_paper_task(read_certificate)),
    "calibration": (CALIBRATION, "pixel_um", "pixel_mu", "pixel_mu", load_calibration),
}  # fmt: skip


@pytest.mark.parametrize("what", TOLD)
def test_the_key_that_was_meant_is_told(what: str, tmp_path: Path) -> None:
    source, right, wrong, key, read = TOLD[what]
    text = source if isinstance(source, str) else source() if callable(source) else source.read_text(encoding="utf-8")  # fmt: skip
    path = tmp_path / "file"
    assert right in text
    path.write_text(text.replace(right, wrong, 1), encoding="utf-8")

    with pytest.raises(InputError) as refused:
        read(path)

    meant = right.strip('"[]: ')
    assert f"key {key} is unknown; did you mean {meant!r}?" in str(refused.value)


@pytest.mark.parametrize(
    ("kind", "advice"),
    [
        ('"proprty"', "did you mean 'property'? "),
        ('"search"', "correct it; "),
        ("5", "correct it; "),
    ],
)
def test_a_kind_of_campaign_that_there_is_none_of(kind: str, advice: str, tmp_path: Path) -> None:
    path = tmp_path / "campaign.toml"
    path.write_text(CAMPAIGN.replace('"property"', kind), encoding="utf-8")

    with pytest.raises(InputError) as refused:
        read_campaign(path)

    value = kind.replace('"', "'")
    kinds = "'blind', 'falsify', 'monte-carlo', 'mutation', 'property'"
    assert str(refused.value) == (
        f"{path}: key part[0].kind = {value}: must be one of {kinds}; {advice}"
        "`meso-robust schema campaign` lists the allowed values"
    )


@pytest.mark.parametrize(
    ("right", "wrong", "key"),
    [("width_um", "widht_um", "part.widht_um"), ("file =", "flie =", "recording[0].flie")],
)
def test_in_a_recording_set(right: str, wrong: str, key: str, tmp_path: Path) -> None:
    folder_of(tmp_path, SET.replace(right, wrong))
    with pytest.raises(InputError, match="did you mean") as refused:
        read_set(tmp_path)
    assert f"key {key} is unknown; did you mean {right.strip(' =')!r}?" in str(refused.value)


def test_in_the_header_of_a_table(tmp_path: Path) -> None:
    folder_of(tmp_path, SET, TABLE.replace("part_theta_deg", "part_theta"))
    with pytest.raises(InputError, match=r"'part_theta' is unknown.*mean 'part_theta_deg'"):
        read_set(tmp_path)


def test_in_a_witness(tmp_path: Path) -> None:
    path = test_witness_file.written(tmp_path)
    values = json.loads(path.read_text(encoding="utf-8"))
    values["factr"] = values.pop("factor")
    path.write_text(json.dumps(values), encoding="utf-8")
    with pytest.raises(InputError, match="key factr is unknown; did you mean 'factor'"):
        test_witness_file.read(path)


def test_in_a_sensed_pose() -> None:
    with pytest.raises(PoseError, match="key theta is unknown; did you mean 'theta_deg'"):
        parse('{"x_um": 0.0, "y_um": 0.0, "theta": 0.0}')


def test_a_key_like_no_other_asks_nothing() -> None:
    assert like("colour", ("friction", "film_ratio_um2")) == ""
