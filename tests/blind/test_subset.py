"""A few cases of the blind benchmark, diagnosed in its quick form."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from meso_robust.diagnosis.answer import diagnosed
from reports.blind.generator import Case, make, write
from tests.nightly import at_night

NULL = Case(kind="null", seed=31)
SUPPORT = Case(kind="effect", names=("drag_centre_offset",), multiples=(8.0,), seed=32)
CAMERA = Case(kind="effect", names=("camera_latency",), multiples=(8.0,), seed=33)
OUTSIDE = Case(kind="outside", names=("constant_moment",), multiples=(8.0,), seed=500)


def answer(case: Case, folder: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """The document of a case, and its label."""
    made = make(case)
    write(made, folder / "set")
    return diagnosed(folder / "set", quick=True), made.label


@at_night
def test_no_alarm_where_nothing_is_concealed(tmp_path: Path) -> None:
    found, label = answer(NULL, tmp_path)
    assert found["verdict"] == "consistent"
    assert found["effects"] == []
    ratio = found["baseline"]["parameters"]["rho_um2"]
    assert abs(ratio["value"] / label["rho_um2"] - 1.0) < 0.01


@at_night
@pytest.mark.parametrize("case", [SUPPORT, CAMERA], ids=["support", "camera"])
def test_a_concealed_effect_is_named_with_its_size(case: Case, tmp_path: Path) -> None:
    found, label = answer(case, tmp_path)
    assert found["verdict"] == "named"
    (effect,) = found["effects"]
    assert effect["name"] == case.names[0]
    assert effect["stage"] == label["stages"][0]
    for key, true in label["parameters"][0].items():
        one = effect["parameters"][key]
        width = one["high"] - one["low"]
        assert one["low"] - width < true < one["high"] + width
    held = found["held_out"]
    assert held["extended_sigma"] < min(1.2, held["baseline_sigma"])


@at_night
def test_what_is_not_in_the_catalogue_is_not_named(tmp_path: Path) -> None:
    found, _ = answer(OUTSIDE, tmp_path)
    assert found["mismatch"]["detected"]
    assert found["verdict"] in {"unknown", "partial"}
    explained = found["explained"]  # nothing, where no set carries over
    assert explained is None or explained["share"] < 0.5
