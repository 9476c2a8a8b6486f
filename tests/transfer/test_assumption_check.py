"""How parameters and effects stand, over their whole intervals."""

from __future__ import annotations

import pytest

from meso_robust.certificates.premise import Premise
from meso_robust.certificates.words import PREMISES
from meso_robust.simulator.catalogue import CATALOGUE
from meso_robust.transfer.assumption_check import by_name, standings
from tests.transfer.models import budget, model, values

BUDGET = budget(radius_um=2000.0, seconds=100.0)


def test_the_ranges_of_a_plain_model_survive() -> None:
    found = standings(model(), BUDGET)

    assert [(one.name, one.word) for one in found] == [("rho_um2", "absorbed"), ("mu", "absorbed")]


@pytest.mark.parametrize("key", ["rho_um2", "mu", "reference_offset.x_um"])
def test_an_open_interval_is_not_identified(key: str) -> None:
    offset = {"reference_offset.x_um": (1.0, 2.0), "reference_offset.y_um": (0.0, 0.5)}

    found = by_name(standings(model(offset, open_=(key,)), BUDGET))

    name = key.partition(".")[0]
    assert found[name].word == "not identified"
    assert key in found[name].said
    assert sum(not one.survives for one in found.values()) == 1


def test_what_is_named_as_not_identifiable_or_held_has_no_bounds() -> None:
    named = model(not_identifiable=[{"name": "rho_um2", "why": "no push turned the part"}])
    held = model({"reference_offset.x_um": (1.0, 2.0)}, held={"reference_offset.y_um": 3.0})

    assert "no push turned the part" in by_name(standings(named, BUDGET))["rho_um2"].said
    assert by_name(standings(held, BUDGET))["reference_offset"].word == "not identified"


def test_ends_of_a_simplex_bound_nothing() -> None:
    found = standings(model(interval="last simplex", objective="printed"), BUDGET)

    assert {one.word for one in found} == {"not identified"}


def test_what_survives_any_size_needs_no_bounds() -> None:
    """The drag as a whole does not matter, so neither does that it cannot be identified."""
    drift = {"drag_drift.rate_percent_s": (-5.0, 5.0)}

    assert standings(model(drift, open_=tuple(drift)), BUDGET)[-1].word == "absorbed"


def test_an_effect_of_no_size_is_off_and_one_whose_interval_only_holds_zero_is_not() -> None:
    off, on = (
        standings(model({"tip_adhesion.pull_um_s": (0.0, most)}), BUDGET)[-1]
        for most in (0.0, 1e-6)
    )

    assert (off.word, on.word) == ("off", "breaks a premise")


def test_a_base_on_dry_contact_breaks_the_premise_of_the_film() -> None:
    ranges = {"mu": (0.3, 0.35)}
    dry = model(base=ranges, model="uniform_pressure")

    found = standings(dry, BUDGET)

    assert [one.name for one in found if not one.survives] == ["uniform_pressure"]
    assert found[0].premise is Premise.FILM_DRAG
    assert found[0].premise_words == PREMISES[Premise.FILM_DRAG]


def test_a_part_of_an_effect_that_is_not_named_has_the_catalogue_s_default() -> None:
    one = standings(model({"reference_offset.x_um": (3.0, 4.0)}), BUDGET)[-1]

    assert one.absorbed is not None
    assert one.absorbed.sensed_um == pytest.approx(4.0, abs=0.011)
    assert values()["model"] == "viscous"


@pytest.mark.parametrize("verdict", ["unknown", "ambiguous"])
def test_nothing_is_promised_on_a_diagnosis_that_is_open(verdict: str) -> None:
    found = by_name(standings(model(diagnosis=verdict), BUDGET))
    assert not found["diagnosis"].survives
    assert found["mu"].survives


def test_a_radius_that_the_recordings_state_is_what_is_proved() -> None:
    points = by_name(standings(model(probe={"tip_radius_um": 0.0}), BUDGET))
    found = by_name(standings(model(probe={"tip_radius_um": 12.5}), BUDGET))["round tips"]

    assert "round tips" not in points
    assert found.word == "absorbed"
    assert found.premise is Premise.POINT_TIPS
    assert "12.5 um" in found.said


@pytest.mark.parametrize(("p_value", "rejected"), [(0.0, True), (0.0009, True), (0.002, False)])
def test_nothing_is_promised_on_a_model_that_its_recordings_reject(
    p_value: float, rejected: bool
) -> None:
    quality = {
        "chi2": 22086.4,
        "freedom": 2815,
        "p_value": p_value,
        "correlation": 0.9,
        "inflation": 780.0,
        "numerical": 0.0,
    }

    found = by_name(standings(model(quality=quality), BUDGET))

    assert ("fit" in found) is rejected
    if rejected:
        assert not found["fit"].survives
        assert "22,086 on 2,815" in found["fit"].said


@pytest.mark.parametrize("verdict", ["consistent", "named"])
def test_a_diagnosis_that_ended_with_one_model_is_no_premise_of_its_own(verdict: str) -> None:
    assert "diagnosis" not in by_name(standings(model(diagnosis=verdict), BUDGET))


@pytest.mark.parametrize(
    "effect", ["part_geometry", "backlash", "probe_drift", "camera_drift", "anisotropic_drag"]
)
def test_what_is_bounded_by_the_first_form_of_a_law_is_not_by_another(effect: str) -> None:
    sizes = {f"{effect}.{one.key}": (0.1, 0.2) for one in CATALOGUE[effect].parameters if one.size}
    standing = {
        form: standings(model(sizes, held={f"{effect}.form": form}), BUDGET)[-1]
        for form in (0.0, 1.0)
    }

    assert standing[0.0].word == "absorbed"
    assert standing[1.0].word == "breaks a premise"
    assert standing[1.0].absorbed is None
    assert CATALOGUE[effect].forms[1] in standing[1.0].said
