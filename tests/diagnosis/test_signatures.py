"""Signatures of effects whose changes can be written down, and sizes by least squares."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.signatures import (
    estimate,
    extended,
    signatures,
    start_of,
    within,
)
from meso_robust.diagnosis.trials import Trial
from meso_robust.simulator.catalogue import values_in_si
from tests.diagnosis.conftest import coloured
from tests.identification.sets import PART, UM

DRIFT = Trial(effect="camera_drift", sizes={"x_um_s": 0.3, "y_um_s": 0.5})
POST = Trial(
    effect="unmodelled_wall",
    sizes={},
    shape={"radius_um": 50.0, "x_um": 0.0, "y_um": 0.0},
    free={"x_um": 5.0, "y_um": 5.0},
)
LAY = Trial(
    effect="anisotropic_drag",
    sizes={"fraction": 0.05},
    shape={"direction_deg": 45.0},
    free={"direction_deg": 20.0},
)


def test_a_start_is_in_si_and_in_the_order_of_the_model(null: Diagnosis) -> None:
    np.testing.assert_allclose(start_of(DRIFT, np.array([2.0, -1.0])), [0.6e-6, -0.5e-6])
    np.testing.assert_allclose(start_of(LAY, np.array([3.0])), [0.15, np.pi / 4.0])
    np.testing.assert_allclose(start_of(POST, np.zeros(0)), [0.0, 0.0])
    model = extended(null.baseline.model, (LAY, POST), null.baseline.prepared)
    assert model.name == "viscous+anisotropic_drag+unmodelled_wall"
    assert model.keys[2:] == (
        "anisotropic_drag.fraction",
        "anisotropic_drag.direction_deg",
        "unmodelled_wall.x_um",
        "unmodelled_wall.y_um",
    )
    table = model.physics(np.array([[0.3e-6, 0.3, 0.0, 0.0, UM, UM]])).effects.table
    assert np.any(np.isclose(table, 50 * UM))  # the radius is held


def test_values_are_moved_into_their_ranges(null: Diagnosis) -> None:
    model = extended(null.baseline.model, (LAY,), null.baseline.prepared)
    moved = within(model, np.array([[0.3e-6, 1.4, -3.0, 7.0], [0.3e-6, 0.2, 0.1, -7.0]]))
    np.testing.assert_allclose(moved[0], [0.3e-6, 1.0, -0.8, 7.0], rtol=1e-6)
    np.testing.assert_array_equal(moved[1], [0.3e-6, 0.2, 0.1, -7.0])


def test_an_image_of_a_bench_is_turned_about_a_place_that_it_shows(null: Diagnosis) -> None:
    """The place may be as far from the world's origin as the arm of a robot reaches, and a drift as fast as its."""
    prepared = null.baseline.prepared
    prepared = replace(prepared, seen=prepared.seen + np.array([0.3, -0.25, 0.0]))
    places = prepared.seen[..., :2].reshape(-1, 2)
    middle = 0.5 * (np.nanmin(places, axis=0) + np.nanmax(places, axis=0))
    about = {"about_x_um": 1e6 * middle[0], "about_y_um": 1e6 * middle[1]}
    turned = Trial(
        effect="camera_rotation",
        sizes={"angle_deg": 0.2},
        shape=about,
        free=dict.fromkeys(about, 100.0),
    )
    model = extended(null.baseline.model, (turned, DRIFT), prepared)
    values = np.array([[0.3e-6, 0.3, 0.01, *middle, 200.0 * UM, -200.0 * UM]])
    np.testing.assert_array_equal(within(model, values), values)
    assert np.all(np.isin(values[0, 3:], model.physics(values).effects.table))


def test_drift_of_the_camera_grows_with_time(null: Diagnosis) -> None:
    at = coloured(null.baseline, 0.0)
    (one,) = signatures(at, [DRIFT])
    assert one.trial is DRIFT
    assert not one.one_sided
    columns = one.columns.reshape(2, *at.seen.shape)
    clock = at.prepared.instants - at.prepared.instants[:, :1]
    for k, rate in enumerate((0.3 * UM, 0.5 * UM)):
        expected = np.zeros(at.seen.shape)
        expected[..., k] = rate * clock / at.settings.sigma[k]
        np.testing.assert_allclose(columns[k], np.where(at.seen, expected, 0.0), atol=1e-6)


def test_turn_of_the_camera_is_all_taken_by_the_starts_where_the_part_rests(
    null: Diagnosis,
) -> None:
    at = null.baseline
    turn = Trial(effect="camera_rotation", sizes={"angle_deg": 0.2})
    (one,) = signatures(at, [turn])
    left = one.left(at.tangent).reshape(at.seen.shape)
    whole = one.columns.reshape(at.seen.shape)
    rests = at.prepared.instants < 0.4
    assert np.abs(whole[rests & at.seen[..., 0]][:, 2]).min() > 2.0  # 0.2° over 0.08°
    assert np.abs(left[rests & at.seen[..., 0]][:, 2]).max() < 1.0
    assert np.linalg.norm(left) < 0.9 * np.linalg.norm(whole)


def test_effects_that_cannot_be_simulated_are_left_out(null: Diagnosis) -> None:
    at = null.baseline
    x, y = 1e6 * at.fits.starts[0, 0, :2]
    shape = {"radius_um": 50.0, "x_um": float(x), "y_um": float(y)}
    within_the_part = Trial(effect="unmodelled_wall", sizes={}, shape=shape, free=POST.free)
    found = signatures(at, [within_the_part, DRIFT])
    assert [one.trial.effect for one in found] == ["camera_drift"]


def test_effects_that_cannot_be_negative_are_known(null: Diagnosis) -> None:
    tried = [
        Trial(effect="dry_friction", sizes={"ratio": 0.1}),
        Trial(effect="camera_latency", sizes={"time_ms": 20.0}),  # no camera sees ahead
        Trial(effect="camera_rotation", sizes={"angle_deg": 0.3}),
        Trial(
            effect="unmodelled_wall",
            sizes={},
            shape={"radius_um": 50.0, "x_um": 9e3, "y_um": 9e3},
            free=POST.free,
        ),
    ]
    found = signatures(null.baseline, tried)
    assert [one.one_sided for one in found] == [True, True, False, True]
    assert not np.any(found[3].columns)  # nothing ever comes near it


def test_sizes_are_those_of_least_squares() -> None:
    rng = np.random.default_rng(0)
    left, evidence = rng.standard_normal((3, 40)), rng.standard_normal(40)
    expected, squares, *_ = np.linalg.lstsq(left.T, evidence, rcond=None)
    sizes, gain = estimate(evidence, left, one_sided=False)
    np.testing.assert_allclose(sizes, expected, rtol=1e-9)
    assert gain == pytest.approx(float(evidence @ evidence - squares[0]))


def test_sizes_that_cannot_be_negative_gain_nothing_where_they_would_be() -> None:
    left = np.random.default_rng(1).standard_normal((1, 40))
    sizes, gain = estimate(-2.0 * left[0], left, one_sided=True)
    assert (sizes[0], gain) == (0.0, 0.0)
    sizes, gain = estimate(2.0 * left[0], left, one_sided=True)
    assert sizes == pytest.approx([2.0])
    assert gain == pytest.approx(4.0 * float(left[0] @ left[0]))
    assert estimate(-2.0 * left[0], left, one_sided=False)[0] == pytest.approx([-2.0])


def test_nothing_is_searched_for_outside_of_what_it_can_be(null: Diagnosis) -> None:
    given = (
        Trial(effect="camera_latency", sizes={"time_ms": 20.0}),
        Trial(effect="reference_offset", sizes={"x_um": 5.0, "y_um": 5.0}),
        Trial(effect="dry_friction", sizes={"ratio": 0.1}),
        Trial(effect="tip_radius", sizes={"excess_um": 1.0}),
    )
    prepared = null.baseline.prepared
    ranges = {
        one.key: (one.low, one.high)
        for one in extended(null.baseline.model, given, prepared).parameters
    }
    half = np.hypot(0.5 * PART.length, 0.5 * PART.width)
    assert ranges["camera_latency.time_ms"][0] == 0.0
    assert ranges["reference_offset.x_um"] == pytest.approx((-half, half))
    low, high = ranges["dry_friction.ratio"]
    assert low == 0.0
    assert high == pytest.approx(
        values_in_si({"dry_friction": {"ratio": 100.0}})["dry_friction"]["ratio"]
    )
    assert ranges["tip_radius.excess_um"][0] == -prepared.tip_radius
