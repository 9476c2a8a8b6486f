"""Wrongs concealed in public recordings, where they are at hand, are seen on top of the set's own."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from meso_robust.errors import InputError
from meso_robust.recordings.direct.run import direct_tests
from meso_robust.recordings.usable import usable_set
from reports.concealed_wrongs.__main__ import BLOCK, read
from reports.concealed_wrongs.wrongs import WRONGS

FOLDER = Path(__file__).parents[3] / "shared" / "recordings"
pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason="the public recordings are not here")
NAME = f"cmu_two_finger/{BLOCK}"


@cache
def told(name: str, wrong: str) -> dict[str, float]:
    """Numbers that tests without a simulation find, by effect and key."""
    left = usable_set(WRONGS[wrong].change(read(FOLDER, name, 1))).recordings
    return {
        f"{one.effect}.{of.key}": of.value
        for one in direct_tests(left).findings
        for of in one.estimates
    }


def test_a_delay_comes_on_top_of_the_rigs_own() -> None:
    change = (
        told(NAME, "late")["camera_latency.time_ms"]
        - told(NAME, "nothing")["camera_latency.time_ms"]
    )
    assert change == pytest.approx(60.0, abs=5.0)


def test_a_stretch_of_one_axis_comes_on_top() -> None:
    found = told("mit_plywood", "longer")["camera_anisotropy.x_percent"]
    own = told("mit_plywood", "nothing").get("camera_anisotropy.x_percent", 0.0)
    assert found - own == pytest.approx(100.0 * (1.0 / 1.02 - 1.0), abs=0.1)


def test_a_turn_of_the_camera_comes_on_top() -> None:
    found = told("mit_plywood", "turned")["camera_rotation.angle_deg"]
    own = told("mit_plywood", "nothing").get("camera_rotation.angle_deg", 0.0)
    assert found - own == pytest.approx(0.5, abs=0.05)


@pytest.mark.parametrize("name", [NAME, "mit_plywood"])
def test_an_axis_with_the_other_sign_is_the_cause_that_is_told(name: str) -> None:
    with pytest.raises(InputError, match="likely cause: y of the tips has the other sign"):
        usable_set(WRONGS["mirrored"].change(read(FOLDER, name, 1)))


@pytest.mark.parametrize("wrong", ["longer", "drift"])
def test_what_a_fit_can_find_is_no_wrong_unit(wrong: str) -> None:
    """In rad these tips would be near by chance; the delay of the rig alone brings them nearer."""
    name = "cmu_two_finger/bigrect_3pts_20_neg30_90"
    left = usable_set(WRONGS[wrong].change(read(FOLDER, name)))
    assert len(left.recordings.recordings) == 5
    (frames,) = (one for one in left.remaining if one.kind == "frames")
    assert frames.severity == "warning"
    assert "the camera lags behind" in frames.rule
