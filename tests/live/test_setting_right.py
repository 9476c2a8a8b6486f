"""A camera's transform put right by a diagnosis, and what is left of its error."""

from __future__ import annotations

import cmath
import math
import tomllib
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from meso_robust.api import explore
from meso_robust.api.explore import RIGHTED, explored
from meso_robust.identification.document import ModelDocument, parse_model
from meso_robust.live.lab_file import CameraSection, Lab, VirtualSection, parse_lab
from meso_robust.live.setting_right import SetRight, set_right
from meso_robust.live.sight import calibration_of
from meso_robust.live.virtual import _seen_through
from meso_robust.live.virtual_bench import lab_of
from meso_robust.plant.world import World
from meso_robust.task import load_task
from meso_robust.tasks import MICROSCOPE
from meso_robust.toml_files import toml_of
from tests.transfer.models import model, values

UM = 1e-6
TURN = {
    "camera_rotation.angle_deg": (0.5, 0.7),
    "camera_rotation.about_x_um": (-80.0, 20.0),
    "camera_rotation.about_y_um": (100.0, 220.0),
}
SCALE = {
    "camera_scale.percent": (0.8, 1.1),
    "camera_scale.about_x_um": (-80.0, 20.0),
    "camera_scale.about_y_um": (100.0, 220.0),
}


@pytest.fixture(scope="module")
def lab() -> Lab:
    made = lab_of(load_task(MICROSCOPE), "-x", VirtualSection())
    camera = made.camera.model_copy(update={"rotation_deg": 3.0, "k1": 0.01})
    return made.model_copy(update={"camera": camera})


def named(effects: dict[str, tuple[float, float]], **more: Any) -> ModelDocument:
    return model(effects, diagnosis="named", **more)


def righted(lab: Lab, effects: dict[str, tuple[float, float]]) -> SetRight:
    found = set_right(lab, named(effects))
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("effects", "world"),
    [
        ({"camera_rotation.angle_deg": (0.6, 0.6)}, World(rotation=math.radians(0.6))),
        ({"camera_scale.percent": (1.0, 1.0)}, World(scale=0.01)),
    ],
)
def test_a_camera_put_right_by_the_truth_is_the_one_that_the_virtual_laboratory_looks_through(
    effects: dict[str, tuple[float, float]], world: World, lab: Lab
) -> None:
    true, found = _seen_through(lab.camera, world), righted(lab, effects)
    for key in ("pixel_size_um", "centre_um", "rotation_deg", "k1"):
        known = pytest.approx(getattr(true, key), rel=1e-12)
        assert getattr(found.lab.camera, key) == known, key
    assert "registration_shift" not in found.model.model


def seen(x: complex, values: list[float], effect: str) -> complex:
    """Where a place in um is seen, by complex numbers."""
    size, about = values[0], complex(*values[1:])
    if effect == "camera_rotation":
        return (x - about) * cmath.rect(1.0, math.radians(size)) + about
    return x + 0.01 * size * (x - about)


def through(camera: CameraSection, to: CameraSection, x: complex) -> complex:
    """What the second camera's transform makes of the pixel at which the first puts a place."""
    pixel = calibration_of(camera).to_pixels(UM * np.array([x.real, x.imag]))
    return complex(*(calibration_of(to).to_world(pixel) / UM))


@pytest.mark.parametrize("effects", [TURN, SCALE])
def test_what_is_left_is_a_smaller_error_about_the_same_place_and_a_shift(
    effects: dict[str, tuple[float, float]], lab: Lab
) -> None:
    """Whatever the truth within the intervals: the model says no less than what is left."""
    effect = next(iter(effects)).partition(".")[0]
    found, rng = righted(lab, effects), np.random.default_rng(0)
    left = {key: (one.low, one.high) for key, one in found.model.parameters.items()}
    assert found.model.model == f"viscous+{effect}+registration_shift"
    most = left["registration_shift.x_um"][1]
    largest = 0.0
    for corner in rng.random((200, 3)).round(rng.choice([0, 3])):
        truth = [
            low + k * (high - low) for k, (low, high) in zip(corner, effects.values(), strict=True)
        ]
        x = complex(*rng.uniform(-900.0, 900.0, 2))
        made = through(lab.camera, found.lab.camera, seen(x, truth, effect))
        size = "angle_deg" if effect == "camera_rotation" else "percent"
        low, high = left[f"{effect}.{size}"]
        middle = 0.5 * sum(effects[f"{effect}.{size}"])
        over = 1.0 if effect == "camera_rotation" else 1.0 + 0.01 * middle
        rest = (truth[0] - middle) / over
        assert low <= rest <= high
        shift = made - seen(x, [rest, *truth[1:]], effect)
        assert abs(shift.real) <= most
        assert abs(shift.imag) <= most
        largest = max(largest, abs(shift))
    assert 0.9 * most < largest <= most


@pytest.mark.parametrize(
    "given",
    [
        named({"tip_radius.excess_um": (1.0, 2.0)}),
        named(TURN | SCALE),
        named({**TURN, "camera_drift.x_um_s": (0.0, 0.1), "camera_drift.y_um_s": (0.0, 0.1)}),
        named(TURN, open_=("camera_rotation.about_x_um",)),
        model(TURN, diagnosis="partial"),
        named({"camera_scale.percent": (0.8, 1.1)}, held={"camera_scale.about_x_um": 300.0}),
    ],
)
def test_what_is_not_one_known_error_of_the_camera_is_left(given: ModelDocument, lab: Lab) -> None:
    assert set_right(lab, given) is None
    assert set_right(lab, named(TURN)) is not None
    assert set_right(lab.model_copy(update={"stage_label": "XY"}), named(TURN)) is None


def test_a_delay_beside_a_turn_does_not_keep_it_from_being_put_right(lab: Lab) -> None:
    found = righted(lab, {"camera_latency.time_ms": (50.0, 70.0), **TURN})
    delay = found.model.parameters["camera_latency.time_ms"]
    assert (delay.low, delay.high) == (50.0, 70.0)


@pytest.mark.parametrize("better", [True, False])
def test_an_experiment_plans_for_the_camera_put_right_where_that_is_proved(
    better: bool, lab: Lab, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = toml_of(parse_model(values(TURN, diagnosis="named"), "a model"))
    asked: list[str] = []

    def planned(task: object, text: str, *_: object) -> SimpleNamespace:
        asked.append(text)
        proved = better and "registration_shift" in text
        return SimpleNamespace(positive=proved, promise=None, files=lambda: {"plan.json": text})

    said = SimpleNamespace(model_toml=given, document=None, files=dict)
    monkeypatch.setattr(explore, "identify", lambda *_, **__: SimpleNamespace(files=dict))
    monkeypatch.setattr(explore, "diagnose", lambda *_, **__: said)
    monkeypatch.setattr(explore, "_planned", planned)
    ran = SimpleNamespace(
        recordings=lambda: object(),
        document=SimpleNamespace(outcome="done"),
        header=SimpleNamespace(lab=lab),
        files=dict,
    )
    found = explored(MICROSCOPE, cast("Any", ran), ".", 0)
    assert len(asked) == 2
    assert found.positive == better == (found.set_right is not None)
    files = found.files()
    assert (RIGHTED in files) == better
    assert files["plan/plan.json"] == asked[better]
    if better:
        assert parse_lab(tomllib.loads(files[RIGHTED]), "x").camera != lab.camera
        assert files["plan/model.toml"] == asked[1]
