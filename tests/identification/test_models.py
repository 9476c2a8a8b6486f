"""Models: their ranges, their constraint, and the physics that values stand for."""

import numpy as np
import pytest

from meso_robust.identification.forward import predicted
from meso_robust.identification.models import MODELS, three_point, viscous, with_effects
from meso_robust.identification.models.model import about_reference, centroid
from meso_robust.identification.prepared import prepare
from meso_robust.recordings import RecordingSet
from meso_robust.simulator import ThreePoints
from tests.identification.conftest import MU, RHO
from tests.identification.sets import FIRST_TABLE_POINTS, PART

OUTLINE = PART.outline


@pytest.mark.parametrize("name", MODELS)
def test_random_vectors_are_valid_and_coordinates_lead_back_to_them(name: str) -> None:
    model = MODELS[name](OUTLINE)
    values = model.draw(np.random.default_rng(0), 50)
    assert values.shape == (50, len(model.keys))
    assert np.all(model.valid(values))
    np.testing.assert_allclose(model.values(model.coordinates(values)), values, rtol=1e-12)


def test_the_paper_has_eight_parameters_and_its_first_table_column_is_valid() -> None:
    model = three_point(OUTLINE)
    values = np.array([[0.666, 0.757, *FIRST_TABLE_POINTS.ravel()]])
    assert len(model.keys) == 8
    assert model.valid(values)[0]
    loads = ThreePoints(points=FIRST_TABLE_POINTS).loads[0]
    rows = model.physics(values).support.tables().points[0]
    np.testing.assert_allclose(rows[:, 2] / rows[:, 2].sum(), loads, rtol=1e-12)


@pytest.mark.parametrize(
    ("column", "value"),
    [
        (0, 1.01),  # friction beyond 1
        (1, 0.0),  # no friction at the support: nothing resists
        (2, 810e-6),  # a point beyond the end of the part
        (4, -500e-6),  # all points on one side of the centre of mass
        (0, np.nan),
    ],
)
def test_vectors_outside_the_constraints_are_not_valid(column: int, value: float) -> None:
    values = np.array([[0.666, 0.757, *FIRST_TABLE_POINTS.ravel()]])
    values[0, column] = value
    assert not three_point(OUTLINE).valid(values)[0]


def test_the_order_of_support_points_does_not_matter() -> None:
    model = three_point(OUTLINE)
    one = np.array([0.5, 0.5, *FIRST_TABLE_POINTS.ravel()])
    other = np.array([0.5, 0.5, *FIRST_TABLE_POINTS[[2, 0, 1]].ravel()])
    same = model.alike(np.stack([one, other]))
    np.testing.assert_array_equal(same[0], same[1])


def test_drag_of_a_film_about_a_point_beside_its_centre() -> None:
    """Force and torque of two motions by hand: a shift, and a turn about the reference point."""
    matrix = about_reference(np.array([0.2, -0.1]), np.array([3.0]))[0]
    # moving along x, each unit of drag acts at (0.2, -0.1): torque about the origin is +0.1
    np.testing.assert_allclose(matrix @ [1.0, 0.0, 0.0], [1.0, 0.0, 0.1])
    # turning, the centre moves with (0.1, 0.2)
    np.testing.assert_allclose(matrix @ [0.0, 0.0, 1.0], [0.1, 0.2, 3.0 + 0.05])


def test_the_centroid_of_an_l_shape() -> None:
    corners = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], dtype=float)
    np.testing.assert_allclose(centroid(corners), [5 / 6, 5 / 6])


def test_an_effect_that_is_off_changes_nothing_and_one_that_is_on_does(
    film_set: RecordingSet,
) -> None:
    model = viscous(OUTLINE)
    prepared = prepare(film_set, step=4 * model.step)
    values = np.array([[RHO, MU]])
    extended = with_effects(model, {"dry_friction": {"ratio": 0.3}, "camera_scale": {"percent": 1}})
    assert extended.keys[2:] == ("dry_friction.ratio", "camera_scale.percent")
    plain = predicted(prepared, model, values).poses
    same = predicted(prepared, extended, np.hstack([values, np.zeros((1, 2))])).poses
    np.testing.assert_array_equal(same, plain)
    seen = predicted(prepared, extended, np.array([[RHO, MU, 0.0, 0.01]])).poses
    np.testing.assert_allclose(seen[..., :2], 1.01 * plain[..., :2], rtol=1e-9)
    rubbed = predicted(prepared, extended, np.array([[RHO, MU, 2.0, 0.0]])).poses
    assert np.abs(rubbed - plain)[..., :2].max() > 1e-6


def test_an_unknown_effect_is_refused() -> None:
    with pytest.raises(ValueError, match="not in the catalogue"):
        with_effects(viscous(OUTLINE), {"magic": {"size": 1.0}})
    with pytest.raises(ValueError, match="positive"):
        with_effects(viscous(OUTLINE), {"dry_friction": {"ratio": 0.0}})


def test_a_fit_may_end_at_the_end_of_a_range() -> None:
    for effect, key in (("camera_rotation", "angle_deg"), ("tip_attraction", "range_um")):
        model = with_effects(viscous(OUTLINE), {effect: {key: 1.0}})
        parameter = model.parameters[-1]
        for end in (parameter.low, parameter.high):
            if np.isfinite(end):
                values = np.array([[RHO, MU, end]])
                assert model.valid(values)[0]
                assert model.physics(values).effects.values[effect][key] == end


def test_a_tip_can_lack_no_more_than_its_radius() -> None:
    model = with_effects(viscous(OUTLINE), {"tip_radius": {"excess_um": 1.0}}, tip_radius=2e-6)
    plain = np.array([[RHO, MU, excess] for excess in (-2e-6, -2.1e-6, 5e-6)])
    assert model.valid(plain).tolist() == [True, False, True]
