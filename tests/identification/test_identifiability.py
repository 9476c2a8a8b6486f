"""What recordings cannot show is named, and only that."""

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.errors import InputError
from meso_robust.identification.identifiability import (
    check_enough,
    found_combined,
    found_unseen,
    least_pushes,
)
from meso_robust.identification.identify import Identification, identify
from meso_robust.identification.models import three_point, viscous
from meso_robust.identification.prepared import prepare
from meso_robust.recordings import RecordingSet
from meso_robust.simulator import Film
from tests.identification.conftest import RHO
from tests.identification.sets import FIRST_TABLE_POINTS, PART, first, random_pushes, recorded


def test_surface_friction_is_shown_by_the_simulator_not_to_matter(film_set: RecordingSet) -> None:
    model = three_point(PART.outline)
    prepared = prepare(first(film_set, 2), step=4 * model.step, most_frames=10)
    values = np.array([0.5, 0.7, *FIRST_TABLE_POINTS.ravel()])
    (found,) = found_unseen(prepared, model, values)
    assert found.name == "mu_s"
    assert "all 2 recordings agree" in found.why


def test_a_parameter_that_does_matter_is_not_called_unseen(film_set: RecordingSet) -> None:
    model = viscous(PART.outline)
    claimed = replace(
        model, parameters=(model.parameters[0], replace(model.parameters[1], unseen="so they say"))
    )
    prepared = prepare(first(film_set, 2), step=4 * model.step, most_frames=10)
    assert found_unseen(prepared, claimed, np.array([RHO, 0.3])) == []


def test_pushes_that_never_slip_give_only_a_lower_bound_of_friction() -> None:
    rng = np.random.default_rng(2)
    pushes = random_pushes(rng, 4, slant=0.05)
    sticking = recorded(pushes, Film.ratio(np.full(4, RHO)), 1.5, rng)
    found = identify(sticking, starts=3)
    friction = next(one for one in found.profiles if one.key == "mu")
    assert friction.open_high
    assert not friction.open_low
    assert found.determined == ("rho_um2",)
    named = {one.name: one.why for one in found.not_identifiable}
    assert "only a lower bound" in named["mu"]
    assert "no tip slips" in named["mu"]


def test_the_scale_of_forces_is_always_named(film_fit: Identification) -> None:
    assert [one.name for one in film_fit.not_identifiable] == ["force_scale"]


def test_a_flat_direction_is_named_by_its_parameters() -> None:
    model = viscous(PART.outline)
    along = np.array([1.0, -1.0]) / np.sqrt(2.0)
    information = 1e6 * (np.eye(2) - np.outer(along, along))
    (found,) = found_combined(model, information)
    assert found.name == "mu & rho_um2"
    assert "combination" in found.why
    assert found_combined(model, 1e6 * np.eye(2)) == []


def test_one_push_too_few_is_refused_with_how_many_are_missing(film_set: RecordingSet) -> None:
    model = three_point(PART.outline)
    assert least_pushes(model) == 4
    check_enough(prepare(first(film_set, 4)), model)
    with pytest.raises(InputError, match=r"3 recordings for 7 parameters.*record 1 more"):
        check_enough(prepare(first(film_set, 3)), model)


def test_a_part_that_never_moves_does_not_count(film_set: RecordingSet) -> None:
    one = film_set.recordings[0]
    still = replace(one, poses=np.tile(one.poses[0], (len(one.times), 1)))
    with pytest.raises(InputError, match="nothing moves"):
        check_enough(prepare(replace(film_set, recordings=(still,))), viscous(PART.outline))
