"""What is tried of each effect, and how it scales with the experiment."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.signatures import extended, signatures, start_of, within
from meso_robust.diagnosis.trials import (
    BESIDE,
    NOT_SEARCHED,
    TRIALS,
    Trial,
    trials,
    tried,
    typical_speed,
)
from meso_robust.identification.prepared import Prepared
from meso_robust.simulator.catalogue import CATALOGUE
from tests.identification.sets import PART, UM


@pytest.fixture(scope="module")
def prepared(null: Diagnosis) -> Prepared:
    return null.baseline.prepared


@pytest.fixture(scope="module")
def grown(prepared: Prepared) -> tuple[dict[str, Trial], ...]:
    """First trials by effect: as recorded, of a part twice as large, of tips thrice as fast."""
    large = replace(prepared, length=2.0 * prepared.length)
    fast = replace(prepared, times=prepared.times / 3.0, instants=prepared.instants / 3.0)
    return tuple(
        {one.effect: one for one in reversed(trials(each))} for each in (prepared, large, fast)
    )


def test_every_effect_of_the_catalogue_is_tried(prepared: Prepared) -> None:
    assert set(TRIALS) == set(CATALOGUE) - {"residual"}
    lying = replace(prepared, starts=prepared.starts * [1.0, 1.0, 0.0])
    for lie, others in ((prepared, frozenset()), (lying, BESIDE)):
        alone, beside = ({one.effect for one in trials(lie, beside=of)} for of in (False, True))
        # one tip has the friction of the plain model, and is late as the camera is
        assert alone | beside == set(CATALOGUE) - NOT_SEARCHED - {"friction_spread", "tip_latency"}
        # a shift of the tips and an offset in the part are one where all parts lie alike
        assert beside == others
        assert not alone & beside
    assert all(tried(effect).shown_by for effect in CATALOGUE)


def test_friction_is_compared_with_that_of_the_first_tip(prepared: Prepared) -> None:
    three = replace(prepared, waypoints=np.repeat(prepared.waypoints[:, :, :1], 3, axis=2))
    assert [one.held["tip"] for one in trials(three) if one.effect == "friction_spread"] == [
        1.0,
        2.0,
    ]


def test_trials_start_within_the_ranges_of_the_catalogue(null: Diagnosis) -> None:
    used: dict[str, set[str]] = {}  # some numbers are of one form of a law only
    for one in trials(null.baseline.prepared):
        known = {p.key: p for p in CATALOGUE[one.effect].parameters}
        used.setdefault(one.effect, set()).update(one.sizes, one.shape)
        assert {key for key in one.sizes if not known[key].size} == set()
        assert set(one.free) <= set(one.shape) <= set(known)
        assert set(one.scales) & set(one.held) == set()
        model = extended(null.baseline.model, (one,), null.baseline.prepared)
        start = start_of(one, np.ones(len(one.sizes)))
        values = np.append(null.baseline.fits.values[0], start)[None]
        np.testing.assert_array_equal(within(model, values), values)
        assert model.valid(values)[0]
    for effect, keys in used.items():
        assert keys == {p.key for p in CATALOGUE[effect].parameters}


@pytest.mark.parametrize(
    ("effect", "key", "by_length", "by_speed"),
    [
        ("drag_centre_offset", "x_um", 2.0, 1.0),
        ("drag_gradient", "x_per_mm", 0.5, 1.0),
        ("lens_distortion", "k1_per_mm2", 0.25, 1.0),
        ("body_force", "x_um_s", 1.0, 3.0),
        ("drag_drift", "rate_percent_s", 0.5, 3.0),
        ("camera_latency", "time_ms", 2.0, 1.0 / 3.0),
        ("dry_friction", "ratio", 1.0, 3.0),  # in forces at 75 µm/s
        ("camera_scale", "percent", 1.0, 1.0),
        ("camera_rotation", "angle_deg", 1.0, 1.0),
        ("shear_thinning", "exponent_drop", 1.0, 1.0),
    ],
)
def test_sizes_grow_with_the_part_and_the_speed(
    grown: tuple[dict[str, Trial], ...], effect: str, key: str, by_length: float, by_speed: float
) -> None:
    was, large, fast = (one[effect].sizes[key] for one in grown)
    assert large == pytest.approx(by_length * was)
    assert fast == pytest.approx(by_speed * was)


def test_the_typical_speed_is_that_of_moving_tips(prepared: Prepared) -> None:
    # two tips: 1 s of rest, 1 s at 20 µm/s of the faster one, 1 s at 40, 0.5 s at 80
    path = np.array([[0, 0], [0, 0], [20, 5], [60, 10], [60, 50]]) * UM
    waypoints = np.stack([path, np.zeros_like(path)], axis=-1)[None]
    times = np.array([[0.0, 1.0, 2.0, 3.0, 3.5]])
    hand_made = replace(prepared, waypoints=waypoints, times=times)
    assert typical_speed(hand_made) == pytest.approx(40 * UM)
    still = replace(prepared, waypoints=0.0 * waypoints, times=times)
    assert typical_speed(still) == pytest.approx(75 * UM)


@pytest.mark.parametrize("effect", ["camera_scale", "camera_rotation"])
def test_an_image_is_tried_about_the_origin_and_about_places_that_it_shows(
    effect: str, prepared: Prepared
) -> None:
    """An image is turned about its middle, not about the place that a stage counts from."""
    plain, *own = [one for one in trials(prepared) if one.effect == effect]
    assert not plain.shape
    places = {(one.shape["about_x_um"], one.shape["about_y_um"]) for one in own}
    assert len(places) == len(own) == 5
    assert (0.0, 0.0) in places
    assert all(set(one.free) == {"about_x_um", "about_y_um"} for one in own)
    corners = UM * np.array([place for place in places if place != (0.0, 0.0)])
    seen = prepared.seen[..., :2].reshape(-1, 2)
    reach = np.hypot(*np.abs(prepared.outline).max(axis=0))
    low, high = np.nanmin(seen, axis=0) - reach, np.nanmax(seen, axis=0) + reach
    # in the middle of each quarter of what the images show of the part
    assert sorted(set(corners[:, 0])) == pytest.approx(
        [low[0] + k * (high - low)[0] for k in (0.25, 0.75)]
    )
    assert sorted(set(corners[:, 1])) == pytest.approx(
        [low[1] + k * (high - low)[1] for k in (0.25, 0.75)]
    )


@pytest.mark.parametrize("effect", ["camera_scale", "camera_rotation"])
def test_the_middle_of_an_image_lies_within_what_it_shows(effect: str, null: Diagnosis) -> None:
    """A slight scale about a place far out would be a shift, which is another effect."""
    prepared = null.baseline.prepared
    about = next(one for one in trials(prepared) if one.effect == effect and one.free)
    made = extended(null.baseline.model, (about,), prepared)
    ends = {one.key: (one.low, one.high) for one in made.parameters}
    seen = prepared.seen[..., :2].reshape(-1, 2)
    reach = np.hypot(*np.abs(prepared.outline).max(axis=0))
    for axis, name in enumerate("xy"):
        low, high = np.nanmin(seen[:, axis]) - reach, np.nanmax(seen[:, axis]) + reach
        assert ends[f"{effect}.about_{name}_um"] == pytest.approx((low, high))


def test_every_edge_is_tried(prepared: Prepared) -> None:
    edges = [t.held["edge"] for t in trials(prepared) if t.effect == "edge_dependent_friction"]
    assert edges == [0.0, 1.0, 2.0, 3.0]


def test_walls_stand_as_near_as_the_part_ever_came(prepared: Prepared) -> None:
    walls = [one for one in trials(prepared) if one.effect == "wall_capillarity"]
    assert len(walls) == 8 * 2 * len(CATALOGUE["wall_capillarity"].forms)
    places = prepared.seen[..., :2][np.isfinite(prepared.seen).all(axis=-1)] / UM
    for one in walls:
        angle = np.radians(one.shape["direction_deg"])
        ahead = places @ [np.cos(angle), np.sin(angle)]
        assert ahead.max() == pytest.approx(one.shape["position_um"], abs=0.01)


def test_posts_stand_beside_the_part_and_never_within_it(prepared: Prepared) -> None:
    posts = [one for one in trials(prepared) if one.effect == "unmodelled_wall"]
    assert len(posts) > 10
    half = 0.5 * np.array([PART.length, PART.width]) / UM
    gaps: list[Any] = []
    for one in posts:
        scale = one.shape["radius_um"] / 50.0
        centre = np.array([one.shape["x_um"], one.shape["y_um"]])
        away = centre - prepared.seen[..., :2] / UM
        theta = prepared.seen[..., 2]
        own = np.stack(
            [
                np.cos(theta) * away[..., 0] + np.sin(theta) * away[..., 1],
                np.cos(theta) * away[..., 1] - np.sin(theta) * away[..., 0],
            ],
            axis=-1,
        )
        outside = np.hypot(*np.moveaxis(np.maximum(np.abs(own) - half, 0.0), -1, 0))
        gaps.append(np.nanmin(outside) - 50.0 * scale)
    assert min(gaps) > -6.0 - 3.0  # between frames that are looked at it moves a little
    assert np.median(gaps) < 5.0  # and they are where a part could have been stopped


def test_an_effect_without_a_line_has_its_sizes_tried(
    monkeypatch: pytest.MonkeyPatch, prepared: Prepared
) -> None:
    monkeypatch.delitem(TRIALS, "stribeck_friction")
    (only,) = tried("stribeck_friction").forms("stribeck_friction", prepared)
    assert only.sizes == {"ratio": 1.0}
    assert "pushes on all edges" in tried("stribeck_friction").shown_by


def test_a_drift_that_slows_down_still_goes_on_in_the_shortest_recording(null: Diagnosis) -> None:
    """What has settled before is an offset, which has a name of its own."""
    prepared = null.baseline.prepared
    shortest = (prepared.times[:, -1] - prepared.times[:, 0]).min()
    slow = [one for one in trials(prepared) if "time_s" in one.free]
    assert {one.effect for one in slow} == {"probe_drift", "camera_drift", "friction_drift"}
    for one in slow:
        model = extended(null.baseline.model, (one,), prepared)
        assert model.parameters[-1].key == f"{one.effect}.time_s"
        assert model.parameters[-1].low == pytest.approx(0.5 * shortest)


def test_a_curved_stage_is_searched_from_what_a_linear_estimate_makes_of_its_curvature(
    null: Diagnosis,
) -> None:
    """A force that grows along the stage is linear in its growth, and shows without a force at the origin."""
    laws = [one for one in trials(null.baseline.prepared) if one.effect == "body_force"]
    curved = [one for one in laws if one.law == 1.0]
    assert len(curved) == 4
    for one in signatures(null.baseline, curved):
        sizes = np.linalg.norm(one.columns, axis=(1, 2))
        assert dict(zip(one.trial.sizes, sizes > 0.0, strict=True))["growth_um_s_per_mm"]
