"""``model.toml`` of a model that effects extend: named ``base+effect+effect``, made again from its keys."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from meso_robust.errors import InputError
from meso_robust.identification.document import read_model
from meso_robust.simulator import Effects
from tests.transfer.models import model, values, written

EFFECTS = {
    "dry_friction.ratio": (0.2, 0.3),
    "edge_dependent_friction.change": (-0.2, 0.0),
    "body_force.y_um_s": (1.0, 3.0),
}
HELD = {"edge_dependent_friction.edge": 2.0}


def test_the_model_is_made_again_from_its_name_and_its_keys() -> None:
    document = model(EFFECTS, held=HELD)
    made = document.made()
    physics = made.physics(document.values[None])

    assert document.model == "viscous+dry_friction+edge_dependent_friction+body_force" == made.name
    assert made.keys == ("rho_um2", "mu", *EFFECTS)
    # ratio in forces at 75 um/s, um^2 and um/s in SI
    expected = [376_500e-12, 0.33, 0.25 * 75e-6, -0.1, 2e-6]
    np.testing.assert_allclose(document.values, expected, rtol=1e-12)
    np.testing.assert_allclose(
        physics.effects.table,
        Effects(
            {
                "dry_friction": {"ratio": 0.25},
                "edge_dependent_friction": {"change": -0.1, "edge": 2.0},
                "body_force": {"y_um_s": 2.0},
            }
        ).table,
        rtol=1e-12,
    )
    np.testing.assert_allclose(physics.friction, [0.33])


def test_a_held_size_is_part_of_the_physics_and_not_of_the_parameters() -> None:
    document = model({"body_force.y_um_s": (1.0, 3.0)}, held={"body_force.x_um_s": -4.0})
    physics = document.made().physics(document.values[None])

    assert document.made().keys == ("rho_um2", "mu", "body_force.y_um_s")
    one = Effects({"body_force": {"x_um_s": -4.0, "y_um_s": 2.0}})
    np.testing.assert_allclose(physics.effects.table, one.table, rtol=1e-12)


def test_an_extended_model_is_read_back_from_its_file(tmp_path: Path) -> None:
    assert read_model(written(tmp_path, EFFECTS, held=HELD)) == model(EFFECTS, held=HELD)


@pytest.mark.parametrize(
    ("name", "rule"),
    [
        ("viscous+body_force+body_force", "each once"),
        ("viscous", "body_force"),
        ("viscous+body_force+dry_friction", "must be the same"),
        ("viscous+body_forces", "'body_forces' is not in the catalogue"),
        ("uniform_pressure+body_force", "must be those of model uniform_pressure: mu"),
    ],
)
def test_a_name_that_the_keys_do_not_fit_is_refused(name: str, rule: str) -> None:
    with pytest.raises(InputError, match="a model: key model: ") as caught:
        model({"body_force.x_um_s": (1.0, 2.0)}, model=name)
    assert rule in str(caught.value)


def test_a_parameter_that_the_effect_does_not_have_is_refused() -> None:
    with pytest.raises(
        InputError, match=r"body_force\.z_um_s; must be one of .*body_force\.x_um_s"
    ):
        model({"body_force.z_um_s": (1.0, 2.0)})
    assert "body_force.z_um_s" in values({"body_force.z_um_s": (1.0, 2.0)})["parameters"]
