"""The table of premises: complete, and every line points at something that is really there."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from meso_robust.certificates.premise import Premise
from meso_robust.identification.models import MODELS
from meso_robust.simulator.catalogue import CATALOGUE
from meso_robust.transfer import assumption_check as standing_module
from meso_robust.transfer.assumption_check import standings
from meso_robust.transfer.lines import BASE, BASES, LINES, Ground
from tests.transfer.models import budget, model

ROOT = Path(__file__).parents[2]
REGISTER = {
    claim["key"]: claim
    for claim in json.loads((ROOT / "reports/derivations/register.json").read_text())["claims"]
}
BUDGET = budget(radius_um=2000.0, seconds=100.0)


def test_every_effect_of_the_catalogue_has_its_line() -> None:
    # a residual law is no physics that a premise could be known to survive
    assert set(LINES) == set(CATALOGUE) - {"residual"}
    assert {BASE, *BASES} == set(MODELS)


@pytest.mark.parametrize("name", [*LINES, *BASES])
def test_a_line_names_a_premise_of_certificates_and_a_claim_that_stands(name: str) -> None:
    line = {**LINES, **BASES}[name]
    claim = REGISTER[line.claim]

    assert line.premise in Premise
    assert claim["derivation"] == line.derivation
    assert (ROOT / line.derivation).is_file()
    assert claim["verdict"] not in {"REFUTED", "INCONSISTENT"}
    assert line.why


@pytest.mark.parametrize("name", ["backlash", "drag_drift", "tip_adhesion"])
def test_an_effect_without_a_line_breaks_a_premise_whatever_it_is(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As one would be that is new in the catalogue: also where it could have been absorbed."""
    monkeypatch.setattr(
        standing_module, "LINES", {key: line for key, line in LINES.items() if key != name}
    )
    sizes = {f"{name}.{one.key}": (0.1, 0.2) for one in CATALOGUE[name].parameters if one.size}

    found = standings(model(sizes), BUDGET)[-1]

    assert (found.name, found.word, found.premise) == (name, "breaks a premise", Ground.A_LINE)
    assert not found.survives


def test_which_effects_are_absorbed_is_said_here_once_more() -> None:
    """A second list by hand: a line that becomes an absorption by accident is found out."""
    absorbed = {name for name, line in LINES.items() if line.absorb is not None}

    assert absorbed == {
        "drag_drift",
        "unmodelled_wall",
        "part_geometry",
        "part_skew",
        "reference_offset",
        "part_yaw",
        "camera_anisotropy",
        "registration_shift",
        "angle_error",
        "pixel_locking",
        "leadscrew_error",
        "backlash",
        "camera_latency",
        "log_latency",
        "clock_rate",
        "friction_speed",
        "camera_scale",
        "camera_rotation",
        "camera_drift",
        "lens_distortion",
        "tip_radius",
        "anisotropic_drag",
        "part_anisotropic_drag",
        "drag_centre_offset",
        "drag_gradient",
        "shear_thinning",
        "dry_friction",
        "stribeck_friction",
        "uneven_support",
        "edge_dependent_friction",
        "friction_spread",
        "probe_drift",
    }
