"""Every effect against its first principles, and against leaving it out."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from scipy import signal
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from meso_robust.simulator import (
    Dynamic,
    Effects,
    Film,
    Mixture,
    Outcome,
    PressurePoints,
    Push,
    PushResult,
    Round,
    ThreePoints,
    simulate,
)
from meso_robust.simulator.catalogue import CATALOGUE, STAGES, stage_of
from meso_robust.simulator.geometry import outlines
from meso_robust.simulator.outline import quadrature
from meso_robust.simulator.stage import SLOTS
from meso_robust.simulator.tables import (
    CONTACT_COLUMNS,
    CONTACTS,
    MARK_COLUMNS,
    MARKS,
    OBSTACLE_COLUMNS,
    OBSTACLES,
)
from meso_robust.simulator.touch import friction_of_contacts
from reports.simulator.effects_report import page
from tests.entry import entry
from tests.simulator.problems import HALF_LONG, HALF_SHORT, MU, RHO, UM, rectangle

F = npt.NDArray[np.float64]
Values = dict[str, dict[str, Any]]

STICKY = 50.0
SPEED = 75e-6
FULL = Film.under(rectangle())

# What users and diagnosis.json rely on.
NAMES = {
    "support": "dry_friction stribeck_friction shear_thinning anisotropic_drag "
    "part_anisotropic_drag drag_centre_offset drag_gradient drag_drift breakaway_friction "
    "uneven_support sticky_spot inertia",
    "environment": "body_force film_flow wall_capillarity point_pull unmodelled_wall",
    "contact": "tip_adhesion tip_attraction edge_dependent_friction friction_spread friction_speed "
    "friction_drift",
    "geometry": "part_geometry part_skew tip_radius reference_offset part_yaw",
    "actuation": "probe_compliance backlash probe_drift tip_latency probe_creep leadscrew_error",
    "observation": "camera_latency log_latency clock_rate camera_scale camera_rotation camera_drift lens_distortion "
    "camera_anisotropy registration_shift angle_error pixel_locking",
    "residual": "residual",
}

# A size of every effect that acts on the poses, for a push of some 100 µm.
ON: Values = {
    "dry_friction": {"ratio": 0.4},
    "stribeck_friction": {"ratio": 0.4, "speed_um_s": 60.0},
    "shear_thinning": {"exponent_drop": 0.3},
    "anisotropic_drag": {"fraction": 0.3, "direction_deg": 25.0},
    "part_anisotropic_drag": {"fraction": -0.2, "direction_deg": 70.0},
    "drag_centre_offset": {"x_um": 60.0, "y_um": -30.0},
    "drag_gradient": {"x_per_mm": 0.3, "y_per_mm": -0.2},
    "drag_drift": {"rate_percent_s": 5.0},
    "breakaway_friction": {"ratio": 0.5},
    "uneven_support": {"ratio": 0.4, "x_um": 120.0, "y_um": -40.0},
    "body_force": {"x_um_s": 4.0, "y_um_s": -3.0},
    "film_flow": {"x_um_s": -2.0, "y_um_s": 5.0},
    "wall_capillarity": {"pull_um_s": 8.0, "direction_deg": 110.0, "position_um": 600.0},
    "unmodelled_wall": {"radius_um": 40.0, "x_um": -500.0, "y_um": 480.0},
    "tip_adhesion": {"pull_um_s": 20.0},
    "tip_attraction": {"pull_um_s": 20.0},
    "edge_dependent_friction": {"change": -0.8, "edge": 0.0},
    "friction_spread": {"change": -0.8, "tip": 0.0},
    "sticky_spot": {"ratio": 2.0, "x_um": 300.0, "y_um": -200.0},
    "point_pull": {"pull_um_s": 8.0, "x_um": 400.0, "y_um": 300.0},
    "friction_drift": {"rate_percent_s": -100.0},
    "friction_speed": {"change": -0.9, "speed_um_s": 30.0},
    "leadscrew_error": {"x_sine_um": 3.0, "y_cosine_um": -2.0, "period_um": 90.0},
    "inertia": {"time_ms": 40.0},
    "part_geometry": {"x_um": 15.0, "y_um": -6.0},
    "part_skew": {"angle_deg": 3.0},
    "tip_radius": {"excess_um": -4.0},
    "reference_offset": {"x_um": 20.0, "y_um": 9.0},
    "part_yaw": {"angle_deg": 0.8},
    "probe_compliance": {"time_ms": 80.0},
    "backlash": {"width_um": 6.0},
    "tip_latency": {"time_ms": 150.0},
    "probe_creep": {"percent": 20.0, "fade_s": 0.5},
    "probe_drift": {"x_um_s": 1.5, "y_um_s": -2.0},
}


def lifted(values: Values, **rest: Any) -> Push:
    """A round tip below the lower edge at 150 µm, going up by 130 µm and back by 40; θ from 0."""
    x, y = 150 * UM, -HALF_SHORT - 30 * UM
    given: dict[str, Any] = {
        "poses": np.zeros((1, 3)),
        "support": Film.ratio(RHO),
        "step": 1 * UM,
        "friction": np.array([[MU]]),
        "shapes": (Round(15 * UM),),
        "waypoints": np.array([[[[x, y]], [[x, y + 130 * UM]], [[x, y + 90 * UM]]]]),
        "times": np.array([[0.0, 1.6, 2.4]]),
    }
    return Push(vertices=rectangle(), effects=Effects(values), **(given | rest))


def free(values: Values, time: float, **rest: Any) -> PushResult:
    """A part that nothing touches."""
    far = np.full((1, 2, 1, 2), 0.05)
    given: dict[str, Any] = {"poses": np.zeros((1, 3)), "time_step": time / 400} | rest
    instants = given.pop("instants", np.array([[time]]))
    push = lifted(values, waypoints=far, times=np.array([[0.0, time]]), **({"step": 1e-6} | given))
    return simulate(push, instants=instants)


def close(got: F, exact: Any, limit: float) -> None:
    """Compare poses in m, with turns at an arm of 1 mm."""
    arms = np.array([1.0, 1.0, 1e-3])
    np.testing.assert_allclose(got * arms, np.asarray(exact) * arms, rtol=0, atol=limit)


# --- the catalogue ----------------------------------------------------------------------------


def test_catalogue_has_the_published_names_in_their_stages() -> None:
    assert {s.name: [e.name for e in s.effects] for s in STAGES} == {
        stage: names.split() for stage, names in NAMES.items()
    }
    assert stage_of("backlash").name == "actuation"


def test_every_parameter_has_a_column_of_its_own() -> None:
    columns = [
        stage.slot(effect.name, parameter.key)
        for stage in STAGES
        for effect in stage.effects
        for parameter in effect.parameters
    ]
    assert len(set(columns)) == len(columns)
    assert max(columns) < SLOTS
    for stage, after in zip(STAGES, (*(s.base for s in STAGES[1:]), SLOTS), strict=True):
        assert stage.base + stage.slots <= after, stage.name


def test_every_effect_states_law_and_source_and_has_a_size() -> None:
    for effect in CATALOGUE.values():
        assert effect.equation
        assert effect.source
        assert any(parameter.size for parameter in effect.parameters)
        for parameter in effect.parameters:
            assert parameter.low <= parameter.default <= parameter.high


@pytest.mark.parametrize(
    ("effect", "key", "given", "si"),
    [
        ("dry_friction", "ratio", 0.5, 37.5e-6),
        ("stribeck_friction", "speed_um_s", 20.0, 20e-6),
        ("anisotropic_drag", "direction_deg", 90.0, np.pi / 2),
        ("drag_gradient", "x_per_mm", 0.25, 250.0),
        ("drag_drift", "rate_percent_s", 3.0, 0.03),
        ("drag_centre_offset", "y_um", -7.0, -7e-6),
        ("wall_capillarity", "pull_um_s", 3.0, 3e-6),
        ("probe_compliance", "time_ms", 40.0, 0.04),
        ("edge_dependent_friction", "change", -0.5, -0.5),
    ],
)
def test_units_become_si(effect: str, key: str, given: float, si: float) -> None:
    column = stage_of(effect).slot(effect, key)
    values = {effect: ON[effect] | {key: given}}
    assert Effects(values).table[0, column] == pytest.approx(si, rel=1e-14)


def test_table_without_effects_is_zero() -> None:
    assert not Effects().table.any()


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"dri_friction": {"ratio": 1.0}}, r"effects: 'dri_friction'; is not in the cat.*use one"),
        ({"dry_friction": {"size": 1.0}}, r"effects.dry_friction: 'size'; is unknown; use ratio"),
        ({"dry_friction": {"ratio": -1.0}}, r"effects.dry_friction.ratio: -1.0; must be .* 0 …"),
        ({"dry_friction": {"ratio": np.nan}}, r"effects.dry_friction.ratio: nan; must be finite"),
        ({"backlash": {"width_um": np.inf}}, r"effects.backlash.width_um: inf; must be finite"),
        ({"anisotropic_drag": {"fraction": 1.0}}, r"anisotropic_drag.fraction: 1.0; .* 0.9"),
        ({"dry_friction": {"ratio": [1.0, np.nan]}}, r"dry_friction.ratio: nan"),
        (
            {"body_force": {"x_um_s": np.ones(2), "y_um_s": np.ones(3)}},
            r"effects: arrays of \[2, 3\] runs; must have one length",
        ),
    ],
)
def test_bad_values_are_refused(values: Values, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Effects(values)


def test_runs_have_their_own_values() -> None:
    ratios = np.array([0.0, 0.2, 0.9])
    values: Values = {"dry_friction": {"ratio": ratios}, "backlash": {"width_um": 3.0}}
    many = simulate(lifted(values, poses=np.zeros((3, 3)))).poses
    for run, ratio in enumerate(ratios):
        alone: Values = {"dry_friction": {"ratio": ratio}, "backlash": {"width_um": 3.0}}
        np.testing.assert_array_equal(many[run], simulate(lifted(alone)).poses[0])


def off(name: str) -> Values:
    """Values of an effect with every size at zero."""
    sizes = {p.key for p in CATALOGUE[name].parameters if p.size}
    return {name: {k: 0.0 if k in sizes else v for k, v in ON[name].items()}}


COMPANY: Values = {
    "uneven_support": {"ratio": 0.2, "x_um": 50.0},
    "drag_gradient": {"x_per_mm": 0.2},
    "tip_adhesion": {"pull_um_s": 9.0},
    "probe_compliance": {"time_ms": 30.0},
}


@pytest.mark.parametrize("name", ON)
@pytest.mark.parametrize("others", [{}, COMPANY], ids=["alone", "in company"])
def test_no_size_is_no_effect(name: str, others: Values) -> None:
    rest = {key: value for key, value in others.items() if key != name}
    # Long steps, so that a limit on their duration would show.
    without = simulate(lifted(rest, step=8 * UM), record=9)
    zero = simulate(lifted(rest | off(name), step=8 * UM), record=9)
    for one, other in zip(
        (without.path, without.forces, without.tips),
        (zero.path, zero.forces, zero.tips),
        strict=True,
    ):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("name", ON)
def test_every_effect_shows(name: str) -> None:
    plain, changed = simulate(lifted({})), simulate(lifted({name: ON[name]}))
    assert (changed.outcomes == Outcome.COMPLETED).all()
    if name == "drag_drift":  # the drag has no scale of its own
        close(changed.poses, plain.poses, 1e-13)
    else:
        assert np.abs((changed.poses - plain.poses) * [1, 1, 1e-3]).max() > 2e-8


# --- invariances --------------------------------------------------------------------------------

RATE = {
    "dry_friction", "stribeck_friction", "breakaway_friction", "uneven_support", "body_force",
    "film_flow", "wall_capillarity", "tip_adhesion", "tip_attraction", "probe_compliance",
    "probe_drift", "inertia", "point_pull", "friction_drift", "friction_speed", "tip_latency",
    "probe_creep",
}  # fmt: skip
# A gradient exp(g · x) of a film alone is the same at every place but for its scale.
PLACE = {
    "wall_capillarity", "unmodelled_wall", "point_pull", "sticky_spot", "leadscrew_error",
}  # fmt: skip
DIRECTION = {
    "anisotropic_drag", "drag_gradient", "body_force", "film_flow", "wall_capillarity",
    "unmodelled_wall", "probe_drift", "backlash", "point_pull", "sticky_spot", "leadscrew_error",
}  # fmt: skip


def difference(push: Push, other: Push, move: Callable[[F], F] = lambda poses: poses) -> float:
    ends = simulate(push).poses, simulate(other).poses
    return float(np.abs((move(ends[0]) - ends[1]) * [1, 1, 1e-3]).max())


@pytest.mark.parametrize("name", ["none", *ON])
def test_path_depends_on_speed_with_effects_of_rate_only(name: str) -> None:
    values = {name: ON[name]} if name in ON else {}
    push = lifted(values, time_step=1e3)
    away = difference(push, replace(push, times=push.times * 10))
    assert away > 1e-8 if name in RATE else away < 1e-12


@pytest.mark.parametrize("name", ["none", *ON])
def test_path_depends_on_the_place_with_effects_of_place_only(name: str) -> None:
    values = {name: ON[name]} if name in ON else {}
    push, way = lifted(values), np.array([300.0, 170.0]) * UM
    shift = np.append(way, 0.0)
    moved = replace(push, poses=push.poses + shift, waypoints=push.waypoints + way)
    away = difference(push, moved, lambda poses: poses + shift)
    assert away > 1e-8 if name in PLACE else away < 1e-11


@pytest.mark.parametrize("name", ["none", *ON])
def test_path_depends_on_direction_with_effects_of_the_stage_only(name: str) -> None:
    values = {name: ON[name]} if name in ON else {}
    push, angle = lifted(values), 0.7
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    turned = replace(
        push, poses=push.poses + np.array([0.0, 0.0, angle]), waypoints=push.waypoints @ turn.T
    )
    away = difference(push, turned, lambda p: np.column_stack([p[:, :2] @ turn.T, p[:, 2] + angle]))
    assert away > 1e-8 if name in DIRECTION else away < 1e-11


# --- forces of the stage --------------------------------------------------------------------------


def test_body_force_drags_a_free_part_at_its_speed() -> None:
    pose = np.array([[0.0, 0.0, 0.8]])
    end = free({"body_force": {"x_um_s": 3.0, "y_um_s": -2.0}}, 10.0, poses=pose).poses[0]
    close(end, [30 * UM, -20 * UM, 0.8], 1e-15)


def test_flow_is_a_force_on_a_plain_film() -> None:
    force, flow = (
        simulate(lifted({name: {"x_um_s": -2.0, "y_um_s": 5.0}})).poses
        for name in ("body_force", "film_flow")
    )
    close(force, flow, 1e-15)


def test_flow_carries_any_film_along_but_a_force_turns_it() -> None:
    drag = np.array([[1.0, 0.1, 1e-4], [0.1, 0.7, -2e-4], [1e-4, -2e-4, 4e-7]])
    values = {"x_um_s": 6.0, "y_um_s": -3.0}
    start = np.array([[0.0, 0.0, 0.5]])
    flow = free({"film_flow": values}, 8.0, support=Film(drag), poses=start).poses[0]
    close(flow, [48 * UM, -24 * UM, 0.5], 1e-13)
    force = free(
        {"body_force": values}, 8.0, support=Film(drag), poses=start, time_step=2e-4
    ).poses[0]

    def law(t: float, y: F) -> F:
        cos, sin = np.cos(y[2]), np.sin(y[2])
        turn = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
        return np.asarray(turn @ np.linalg.solve(drag, turn.T @ [6e-6, -3e-6, 0.0]))

    exact = solve_ivp(law, (0, 8), start[0], rtol=1e-10, atol=1e-14).y[:, -1]
    close(force, exact, 3e-9)
    assert abs(exact[2] - 0.5) > 0.01


def test_capillarity_pulls_to_the_wall_by_its_closed_form() -> None:
    # ġ = −p exp(−g/l), so exp(g/l) falls by p t / l; n at 30°, the wall at 500 µm.
    values = {"pull_um_s": 50.0, "direction_deg": 30.0, "position_um": 500.0, "range_um": 200.0}
    end = free({"wall_capillarity": values}, 20.0, time_step=2e-3).poses[0]
    gap = 200 * UM * np.log(np.exp(500 / 200) - 50 * 20 / 200)
    way = 500 * UM - gap
    close(end, [way * np.cos(np.pi / 6), way * np.sin(np.pi / 6), 0.0], 2e-3 * way)


@pytest.mark.parametrize("form", [0.0, 1.0])
def test_a_place_draws_the_part_by_its_law(form: float) -> None:
    """From 400 µm away; a force that falls as the distance has a closed form of the time."""
    p, reach, from_, way = 20.0, 150.0, 400.0, np.array([0.6, -0.8])
    values = {"pull_um_s": p, "x_um": 50.0, "y_um": 30.0, "range_um": reach, "form": form}
    pose = np.append(np.array([50.0, 30.0]) + from_ * way, 0.0) * [UM, UM, 1.0]
    end = free({"point_pull": values}, 12.0, poses=pose[None], time_step=2e-3).poses[0]
    if form == 0.0:
        law = solve_ivp(
            lambda _, a: -p * a / reach * np.exp(0.5 - a**2 / (2 * reach**2)),
            (0.0, 12.0),
            [from_],
            rtol=1e-10,
        )
        left = float(law.y[0, -1])
    else:
        whole = np.log(from_) + from_**2 / (2 * reach**2) - 2 * p * 12.0 / reach
        left = brentq(lambda a: np.log(a) + a**2 / (2 * reach**2) - whole, 1.0, from_)
    assert from_ - left > 20.0
    close(end, np.append((np.array([50.0, 30.0]) + left * way) * UM, 0.0), 0.2 * UM)


def test_post_is_a_disc_that_does_not_move() -> None:
    with_post = simulate(lifted({"unmodelled_wall": ON["unmodelled_wall"]}))
    push = lifted({})
    disc = np.broadcast_to(np.array([-500 * UM, 480 * UM]), (1, 3, 1, 2))
    as_probe = simulate(
        replace(
            push,
            waypoints=np.concatenate([push.waypoints, disc], axis=2),
            friction=np.full((1, 2), MU),
            shapes=(*push.shapes, Round(40 * UM)),
        )
    )
    close(with_post.poses, as_probe.poses, 1e-14)
    assert difference(push, lifted({"unmodelled_wall": ON["unmodelled_wall"]})) > 1 * UM


# --- tips -------------------------------------------------------------------------------------------


def central(values: Values, way: list[float], times: list[float], **rest: Any) -> Push:
    """A sharp tip at the middle of the lower edge, its y given in µm from the edge."""
    points = np.array([[[0.0, -HALF_SHORT + y * UM]] for y in way])[None]
    given: dict[str, Any] = {"shapes": (), "step": 0.05 * UM} | rest
    return lifted(values, waypoints=points, times=np.array([times]), **given)


def test_part_follows_a_tip_that_is_drawn_back_slower_than_adhesion_drags() -> None:
    values: Values = {"tip_adhesion": {"pull_um_s": 20.0}}
    result = simulate(central(values, [0.0, -30.0], [0.0, 2.0]), record=4)
    close(result.poses[0], [0.0, -30 * UM, 0.0], 1e-13)
    # The film's drag is all that the tip feels, pull and pressure together: 15 µm/s.
    np.testing.assert_allclose(result.forces[0, 2, 0], [0.0, -15 * UM], atol=1e-12)


def test_adhesion_ends_at_its_range() -> None:
    # Tip back at 60 µm/s, part after it at 20: 2.4 µm apart after 0.06 s, the part 1.2 µm on.
    values: Values = {"tip_adhesion": {"pull_um_s": 20.0, "range_um": 2.4}}
    end = simulate(central(values, [0.0, -60.0], [0.0, 1.0])).poses[0]
    close(end, [0.0, -1.2 * UM, 0.0], 0.03 * UM)


def test_adhesion_needs_a_touch() -> None:
    values: Values = {"tip_adhesion": {"pull_um_s": 20.0}}
    assert not simulate(central(values, [-1.0, -30.0], [0.0, 1.0])).poses.any()


def test_part_jumps_to_an_attracting_tip() -> None:
    # ġ = −F / (1 + g/r), so g + g²/2r falls by F t.
    values: Values = {"tip_attraction": {"pull_um_s": 4.0, "range_um": 5.0}}
    push = central(values, [-20.0, -20.0], [0.0, 20.0], time_step=2e-3)
    result = simulate(push, instants=np.array([[5.0, 14.5, 15.6, 20.0]]))

    def gap(t: float) -> float:
        left = 20 + 20**2 / 10 - 4 * t
        return float(5 * (np.sqrt(1 + 0.4 * left) - 1)) if left > 0 else 0.0

    wanted = [gap(t) - 20 for t in (5.0, 14.5, 15.6, 20.0)]
    np.testing.assert_allclose(result.path[0, :, 1] * 1e6, wanted, atol=0.02)
    assert result.forces[0, 0, 0, 1] == pytest.approx(-4 * UM / (1 + gap(5.0) / 5), rel=1e-3)


def test_friction_of_an_edge_is_that_of_its_edge_only() -> None:
    slippery = {"change": -0.8}
    push = lifted({"edge_dependent_friction": slippery | {"edge": 0.0}})
    want = lifted({}, friction=np.array([[0.2 * MU]]))
    close(simulate(push).poses, simulate(want).poses, 1e-14)
    assert difference(push, lifted({})) > 1e-8
    for edge in (1.0, 2.0, 3.0):
        other = lifted({"edge_dependent_friction": slippery | {"edge": edge}})
        np.testing.assert_array_equal(simulate(other).poses, simulate(lifted({})).poses)


def test_friction_of_a_tip_is_that_of_its_tip_only() -> None:
    """Two tips that leave the part at once with friction of their own, told by the push or by the effect."""
    x, y = np.array([-300.0, 250.0]) * UM, -HALF_SHORT - 30 * UM
    way = np.array([[[[a, y + up] for a in x] for up in (0.0, 30 * UM, 130 * UM)]])
    way[0, 2, :, 0] += 60 * UM
    given: dict[str, Any] = {
        "shapes": (Round(15 * UM), Round(15 * UM)),
        "waypoints": way,
        "support": Film.ratio(RHO),
    }

    def end(values: Values, *mu: float) -> F:
        return simulate(lifted(values, friction=np.array([mu]), **given)).poses

    for tip, mu in ((0.0, (0.1, 0.2)), (1.0, (0.2, 0.1))):
        own = end({"friction_spread": {"change": -0.5, "tip": tip}}, 0.2, 0.2)
        close(own, end({}, *mu), 1e-14)
        assert not np.allclose(own, end({}, 0.2, 0.2), rtol=0.0, atol=1e-8)
    absent = end({"friction_spread": {"change": -0.5, "tip": 2.0}}, 0.2, 0.2)
    close(absent, end({}, 0.2, 0.2), 1e-14)


@pytest.mark.parametrize(("form", "lasted"), [(0.0, 10.0), (1.0, 2.0 * np.log1p(5.0))])
def test_friction_that_drifts_is_what_has_become_of_it(form: float, lasted: float) -> None:
    """A short push after 10 s, in which 5 % are lost a second."""
    x, y = 500 * UM, -HALF_SHORT - 16 * UM
    way = np.array([[[[x, y]], [[x, y]], [[x + 80 * UM, y + 60 * UM]]]])
    given: dict[str, Any] = {"waypoints": way, "times": np.array([[0.0, 10.0, 10.001]])}
    drift = {"rate_percent_s": -5.0, "time_s": 2.0, "form": form}
    found = simulate(lifted({"friction_drift": drift}, **given)).poses
    close(
        found,
        simulate(lifted({}, friction=np.array([[MU * np.exp(-0.05 * lasted)]]), **given)).poses,
        2e-9,
    )
    assert np.abs(found - simulate(lifted({}, **given)).poses).max() > 1e-7


@pytest.mark.parametrize("form", [0.0, 1.0])
def test_a_tip_that_slips_has_the_friction_of_its_speed(form: float) -> None:
    """A short push that slips, against friction that agrees with the slip that it leads to."""
    x, y, seconds = 500 * UM, -HALF_SHORT - 0.1 * UM, 0.02
    way = np.array([[[[x, y]], [[x + 1.6 * UM, y + 1.2 * UM]]]])
    given: dict[str, Any] = {
        "waypoints": way,
        "times": np.array([[0.0, seconds]]),
        "shapes": (Round(0.1 * UM),),
        "step": 0.002 * UM,
    }

    def slip(mu: float) -> float:
        px, py, turn = simulate(lifted({}, friction=np.array([[mu]]), **given)).poses[0]
        along = (way[0, 1, 0] - [px, py]) @ [np.cos(turn), np.sin(turn)] - x
        return float(abs(along) / seconds)

    def left(mu: float) -> float:
        of = slip(mu) / 20e-6
        return float(np.exp(-of) if form == 0.0 else 1.0 / (1.0 + of))

    mu = brentq(lambda mu: 0.1 * (1.0 + 3.0 * left(mu)) - mu, 0.1, 0.4, xtol=1e-6)
    slow = {"change": 3.0, "speed_um_s": 20.0, "form": form}
    found = simulate(lifted({"friction_speed": slow}, friction=np.array([[0.1]]), **given)).poses
    assert 0.11 < mu < 0.3
    close(found, simulate(lifted({}, friction=np.array([[mu]]), **given)).poses, 2e-10)


@pytest.mark.parametrize(
    "effect",
    [
        {"friction_drift": {"rate_percent_s": -50.0}},
        {"friction_speed": {"change": 1.0 / np.e - 1.0}},
    ],
)
def test_friction_of_a_wall_does_not_change(effect: Values) -> None:
    """The contacts of two probes and of what is no probe, after 2 s."""
    effects = Effects(effect).table[0]
    obstacles = np.zeros((3, OBSTACLE_COLUMNS))
    obstacles[:, OBSTACLES.friction] = 0.2, 0.3, 0.4
    marks = np.zeros((4, MARK_COLUMNS), dtype=np.int64)
    marks[:3, MARKS.who] = 0, 1, 2
    contacts = np.zeros((3, CONTACT_COLUMNS))
    entry(friction_of_contacts)(effects, 2.0, 2, obstacles, contacts, marks, 3)
    np.testing.assert_allclose(contacts[:, CONTACTS.mu], [0.2 / np.e, 0.3 / np.e, 0.4], rtol=1e-14)


# --- inertia ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("time_ms", [40.0, 400.0])
def test_a_part_goes_on_when_the_tip_stops(time_ms: float) -> None:
    """By what the film takes to stop it: v tau (1 - exp(-t / tau)) after the stop."""
    push = central(
        {"inertia": {"time_ms": time_ms}}, [0.0, 100.0, 100.0], [0.0, 1.0, 2.0], time_step=5e-4
    )
    instants = np.array([[1.0, 1.0 + 1e-3 * time_ms, 2.0]])
    gone = simulate(push, instants=instants).path[0, :, 1] * 1e6 - 100.0
    tau = 1e-3 * time_ms
    exact = [100.0 * tau * -np.expm1(-(t - 1.0) / tau) for t in instants[0]]
    np.testing.assert_allclose(gone, exact, atol=0.06)


def test_the_mass_of_a_part_is_spread_evenly() -> None:
    values: Values = {"inertia": {"time_ms": 40.0}}
    long, short = np.ptp(rectangle(), axis=0)
    moment = (long**2 + short**2) / 12.0
    got = simulate(lifted(values, time_step=2e-3))
    model = Dynamic(mass=0.04, inertia=0.04 * moment)
    want = simulate(lifted({}, motion=model, time_step=2e-3))
    close(got.poses, want.poses, 1e-10)
    with pytest.raises(ValueError, match=r"effects\.inertia.*Dynamic"):
        lifted(values, motion=model)


def test_the_mass_is_about_the_middle_of_the_part_wherever_its_reference_point_is() -> None:
    """One part, one push, and two points that its outline and its film are described about."""
    off, values = np.array([80.0, 50.0]) * UM, {"inertia": {"time_ms": 200.0}}
    around = np.column_stack([np.eye(2), [-off[1], off[0]]])  # velocity of the middle
    drag = around.T @ around + np.diag([0.0, 0.0, RHO])
    middle = lifted(values, time_step=1e-3)
    shifted = replace(
        middle,
        vertices=rectangle() + off,
        poses=np.array([[-off[0], -off[1], 0.0]]),
        support=Film(drag),
    )
    x, y, theta = simulate(shifted).poses[0]
    turn = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
    got = np.append([x, y] + turn @ off, theta)
    close(got, simulate(middle).poses[0], 2e-8)


# --- actuation ----------------------------------------------------------------------------------------


def test_backlash_loses_half_its_width_at_first_and_all_of_it_on_reversal() -> None:
    values: Values = {"backlash": {"width_um": 8.0}}
    push = central(values, [0.0, 50.0, 20.0, 60.0], [0.0, 1.0, 2.0, 3.0])
    result = simulate(push, instants=np.array([[0.05, 1.0, 2.0, 3.0]]))
    np.testing.assert_allclose(
        (result.tips[0, :, 0, 1] + HALF_SHORT) * 1e6, [0.0, 46.0, 24.0, 56.0], atol=1e-9
    )
    np.testing.assert_allclose(result.path[0, :, 1] * 1e6, [0.0, 46.0, 46.0, 56.0], atol=1e-9)


def test_backlash_acts_on_each_axis() -> None:
    values: Values = {"backlash": {"width_um": 4.0}}
    way = np.array([[[[-2e-3, 0.0]], [[-2e-3 + 30e-6, 10e-6]], [[-2e-3 + 25e-6, 11e-6]]]])
    push = lifted(values, waypoints=way, times=np.array([[0.0, 1.0, 2.0]]))
    tips = simulate(push, instants=np.array([[1.0, 2.0]])).tips[0, :, 0]
    np.testing.assert_allclose((tips - [-2e-3, 0.0]) * 1e6, [[28.0, 8.0], [27.0, 9.0]], atol=1e-9)


@pytest.mark.parametrize(
    ("form", "wanted"), [(2.0, [[28.0, 10.0], [27.0, 11.0]]), (3.0, [[30.0, 8.0], [25.0, 9.0]])]
)
def test_backlash_of_one_axis_leaves_the_other_as_commanded(
    form: float, wanted: list[list[float]]
) -> None:
    values: Values = {"backlash": {"width_um": 4.0, "form": form}}
    way = np.array([[[[-2e-3, 0.0]], [[-2e-3 + 30e-6, 10e-6]], [[-2e-3 + 25e-6, 11e-6]]]])
    push = lifted(values, waypoints=way, times=np.array([[0.0, 1.0, 2.0]]))
    tips = simulate(push, instants=np.array([[1.0, 2.0]])).tips[0, :, 0]
    np.testing.assert_allclose((tips - [-2e-3, 0.0]) * 1e6, wanted, atol=1e-9)


@pytest.mark.parametrize(("along_deg", "tau"), [(90.0, 0.2), (0.0, 0.05), (180.0, 0.05)])
def test_a_probe_that_bends_less_across_lags_by_its_compliance_that_way(
    along_deg: float, tau: float
) -> None:
    """A push along y; most compliant along ``along_deg``, a quarter of that across."""
    v, stop = 75 * UM, 1.6
    given = {"time_ms": 200.0, "direction_deg": along_deg, "across": 0.25, "form": 2.0}
    values: Values = {"probe_compliance": given}
    push = central(values, [0.0, 120.0, 120.0], [0.0, stop, 3.0], time_step=1e-3, step=100 * UM)
    result = simulate(push, instants=np.array([[1.6]]))
    lag = v * tau * (1 - np.exp(-stop / tau))
    assert result.path[0, 0, 1] == pytest.approx(v * stop - lag, abs=0.08 * UM)


def test_a_screw_moves_the_tip_where_its_wave_takes_it() -> None:
    """The end is that of a push to where the wave is at the end of the command: paths do not depend on times."""
    wave = np.array([[2.5, 0.0], [1.5, -3.0]])  # x and y, sine and cosine; µm
    values = {
        f"{a}_{w}_um": wave[i, j]
        for i, a in enumerate("xy")
        for j, w in enumerate(("sine", "cosine"))
    }
    push = lifted({"leadscrew_error": {**values, "period_um": 70.0}})
    turned = 2.0 * np.pi * push.waypoints / (70.0 * UM)
    off = UM * (wave[:, 0] * np.sin(turned) + wave[:, 1] * np.cos(turned))
    want = simulate(replace(lifted({}), waypoints=push.waypoints + off)).poses
    close(simulate(push).poses, want, 0.05 * UM)
    assert np.abs(want - simulate(lifted({})).poses).max() > 1e-7


def test_tips_of_one_mount_are_moved_alike_and_a_resting_one_by_its_own_screw() -> None:
    """A pair that goes up and a third tip that rests: from the start on, wherever the wave is."""
    x, y = np.array([-300.0, 250.0, 2000.0]) * UM, -HALF_SHORT - 200 * UM
    way = np.array(
        [[[[a, y + (up if k < 2 else 0.0)] for k, a in enumerate(x)] for up in (0.0, 50 * UM)]]
    )
    off = {"x_sine_um": 3.0, "y_cosine_um": 5.0, "period_um": 70.0}
    push = lifted({"leadscrew_error": off}, waypoints=way, shapes=(Round(15 * UM),) * 3,
                  times=np.array([[0.0, 1.0]]), friction=np.array([[MU] * 3]))  # fmt: skip
    tips = simulate(push, record=10).tips[0]
    for k in (0, 1):  # the wave of the first one
        np.testing.assert_allclose(
            tips[:, k] - [x[k], y], tips[:, 0] - [x[0], y], rtol=0.0, atol=1e-15
        )

    def wave(place: list[float]) -> list[float]:
        turned = 2.0 * np.pi / (70 * UM) * np.array(place)
        return [3.0 * UM * np.sin(turned[0]), 5.0 * UM * np.cos(turned[1])]

    np.testing.assert_allclose(tips[0, 0] - [x[0], y], wave([x[0], y]), atol=1e-15)
    apart = replace(push, effects=Effects({"leadscrew_error": {**off, "form": 1.0}}))
    np.testing.assert_allclose(
        simulate(apart, record=10).tips[0, 0, 1] - [x[1], y], wave([x[1], y]), atol=1e-15
    )
    np.testing.assert_allclose(
        tips[:, 2] - [x[2], y], np.broadcast_to(wave([x[2], y]), (11, 2)), atol=1e-15
    )


def test_a_part_may_start_where_the_screw_takes_the_tip_away() -> None:
    """The command is 3 um inside the part, the tip is not; without the wave that is refused."""
    y = -HALF_SHORT + 3 * UM
    way = np.array([[[[0.0, y]], [[0.0, y]]]])
    given: dict[str, Any] = {"waypoints": way, "times": np.array([[0.0, 1.0]]), "shapes": ()}
    turned = 2.0 * np.pi * y / (200 * UM)
    off = {
        "y_sine_um": -4.0 * np.sin(turned),
        "y_cosine_um": -4.0 * np.cos(turned),
        "period_um": 200.0,
    }
    still = simulate(lifted({"leadscrew_error": off}, **given)).poses
    np.testing.assert_array_equal(still, np.zeros((1, 3)))
    with pytest.raises(ValueError, match="starts 3 µm inside"):
        lifted({}, **given)


def test_a_late_tip_of_two_is_where_it_was_commanded_before() -> None:
    """Against commands that say so: the second tip starts 0.4 s later."""
    way = np.zeros((1, 4, 2, 2))
    way[0, :, 0] = np.array([-300 * UM, -HALF_SHORT - 16 * UM])
    way[0, :, 1] = np.array([300 * UM, -HALF_SHORT - 16 * UM])
    way[0, 1:, 0, 1] += 60 * UM
    way[0, 2:, 1, 1] += 60 * UM
    way[0, 2:, 0, 1] += 20 * UM
    given: dict[str, Any] = {
        "shapes": (Round(15 * UM), Round(15 * UM)),
        "support": Film.ratio(RHO),
        "friction": np.array([[0.2, 0.2]]),
        "time_step": 1e-3,
        "step": 0.1 * UM,
    }
    times = np.array([[0.0, 1.0, 2.0, 3.0]])
    late = Effects({"tip_latency": {"time_ms": 400.0, "form": 1.0}})
    found = simulate(replace(lifted({}, waypoints=way, times=times, **given), effects=late))
    grid = np.unique(np.concatenate([times[0], np.minimum(times[0] + 0.4, 3.0)]))
    told = np.stack(
        [
            np.stack([np.interp(grid - back, times[0], way[0, :, p, a]) for a in range(2)], axis=-1)
            for p, back in ((0, 0.0), (1, 0.4))
        ],
        axis=1,
    )[None]
    want = simulate(lifted({}, waypoints=told, times=grid[None], **given))
    close(found.poses, want.poses, 5e-8)
    assert (
        np.abs(found.poses - simulate(lifted({}, waypoints=way, times=times, **given)).poses).max()
        > 1e-3
    )


@pytest.mark.parametrize("dt", [0.2, 0.01])
def test_a_drive_that_creeps_is_where_its_transfer_function_puts_it(dt: float) -> None:
    """Against SciPy's simulation of w(s) (1 − c s τ / (1 + s τ)), whatever the length of the steps."""
    share, tau, v, stop = 0.25, 0.6, 75 * UM, 1.6
    values: Values = {"probe_creep": {"percent": 100 * share, "fade_s": tau}}
    push = central(values, [0.0, 120.0, 120.0], [0.0, stop, 4.0], time_step=dt, step=100 * UM)
    at = np.array([[0.4, 1.6, 1.8, 2.4, 4.0]])
    t = np.linspace(0.0, 4.0, 4001)
    system = signal.lti([tau * (1 - share), 1.0], [tau, 1.0])
    _, way, _ = signal.lsim(system, v * np.minimum(t, stop), t)
    want = np.interp(at[0], t, way)
    found = simulate(push, instants=at).path[0, :, 1]
    np.testing.assert_allclose(found, want, rtol=0, atol=1e-9)
    assert np.ptp(want[1:]) > 10 * UM  # most of it after the stop


def test_drift_of_the_mount_moves_a_touching_part() -> None:
    values: Values = {"probe_drift": {"x_um_s": 0.0, "y_um_s": 2.0}}
    push = central(values, [0.0, 0.0], [5.0, 12.0])
    close(simulate(push).poses[0], [0.0, 14 * UM, 0.0], 1e-13)


@pytest.mark.parametrize(("dt", "limit"), [(4e-3, 0.3 * UM), (1e-3, 0.08 * UM)])
def test_bent_probe_lags_by_the_force_and_creeps_back(dt: float, limit: float) -> None:
    # Part, tip and drag: ẋ = (u − x) / τ; behind u = v t by v τ (1 − exp(−t/τ)), then it decays.
    tau, v, stop = 0.2, 75 * UM, 1.6
    values: Values = {"probe_compliance": {"time_ms": 200.0}}
    push = central(values, [0.0, 120.0, 120.0], [0.0, stop, 3.0], time_step=dt, step=100 * UM)
    at = np.array([[0.1, 0.4, 1.6, 1.8, 2.4]])
    result = simulate(push, instants=at)
    t = np.minimum(at[0], stop)
    lag = v * tau * (1 - np.exp(-t / tau)) * np.exp(-(at[0] - t) / tau)
    np.testing.assert_allclose(result.path[0, :, 1], v * t - lag, rtol=0, atol=limit)
    # The tip stands at the edge that it presses on, and the force is the lag over C.
    np.testing.assert_allclose(
        result.tips[0, :, 0, 1] + HALF_SHORT, result.path[0, :, 1], rtol=0, atol=1e-11
    )
    np.testing.assert_allclose(result.forces[0, :, 0, 1], lag / tau, rtol=0, atol=8 * limit)


def test_tip_of_a_bent_probe_lags_sideways_too() -> None:
    # A sticking tip that goes along the edge drags the part by the same law.
    tau, v = 0.2, 75 * UM
    start = np.array([0.0, -HALF_SHORT])
    first, then = np.array([[0.0, 30 * UM], [30 * UM, 30 * UM]]) + start
    push = lifted(
        {"probe_compliance": {"time_ms": 200.0}},
        waypoints=np.array([start, first, then])[None, :, None],
        times=np.array([[0.0, 0.4, 0.8]]),
        friction=np.array([[STICKY]]),
        support=Film.ratio(1.0),  # turns not
        shapes=(),
        time_step=5e-4,
    )
    end = simulate(push).poses[0]
    wanted = 30 * UM - v * tau * (1 - np.exp(-0.4 / tau))
    assert end[0] == pytest.approx(wanted, abs=0.05 * UM)
    fallen = v * tau * (1 - np.exp(-0.4 / tau)) * np.exp(-0.4 / tau)
    assert end[1] == pytest.approx(30 * UM - fallen, abs=0.05 * UM)


# --- laws of the area, against quadrature --------------------------------------------------------------

NODES = np.polynomial.legendre.leggauss(40)
X, Y = (g.ravel() for g in np.meshgrid(HALF_LONG * NODES[0], HALF_SHORT * NODES[0], indexing="ij"))
W = np.outer(NODES[1], NODES[1]).ravel() / 4
Law = Callable[[F, F, F, F], tuple[F, F]]
"""Force density (f_x, f_y) against the motion, of u_x, u_y and the place x, y; body frame."""


def turn_under(tip: F, tip_speed: F, law: Law) -> float:
    """ω of a part under a sticking tip: no moment of the resistance about the tip."""

    def moment(omega: float) -> float:
        ux = tip_speed[0] - omega * (Y - tip[1])
        uy = tip_speed[1] + omega * (X - tip[0])
        fx, fy = law(ux, uy, X, Y)
        return float(W @ ((X - tip[0]) * fy - (Y - tip[1]) * fx))

    return float(brentq(moment, -0.5, 0.5, xtol=1e-13))


def film_law(ux: F, uy: F, x: F, y: F) -> tuple[F, F]:
    return ux, uy


def coulomb(strength: Callable[[F, F, F], F | float]) -> Law:
    """Film and a dry force whose strength depends on speed and place."""

    def law(ux: F, uy: F, x: F, y: F) -> tuple[F, F]:
        speed = np.hypot(ux, uy)
        extra = strength(speed, x, y) / speed
        return ux * (1 + extra), uy * (1 + extra)

    return law


def lay(fraction: float, direction: float) -> Law:
    """Drag `1 + a` along a direction (body frame) and `1 − a` across it."""
    along = np.array([np.cos(direction), np.sin(direction)])

    def law(ux: F, uy: F, x: F, y: F) -> tuple[F, F]:
        u = along[0] * ux + along[1] * uy
        v = along[0] * uy - along[1] * ux
        u, v = (1 + fraction) * u, (1 - fraction) * v
        return along[0] * u - along[1] * v, along[1] * u + along[0] * v

    return law


START = np.array([0.3e-3, -0.2e-3, 0.4])
_COS, _SIN = np.cos(START[2]), np.sin(START[2])


def graded(ux: F, uy: F, x: F, y: F) -> tuple[F, F]:
    wx, wy = START[0] + _COS * x - _SIN * y, START[1] + _SIN * x + _COS * y
    k = np.exp(700.0 * wx - 400.0 * wy)
    return k * ux, k * uy


def thin(ux: F, uy: F, x: F, y: F) -> tuple[F, F]:
    k = (np.hypot(ux, uy) / SPEED) ** -0.4
    return k * ux, k * uy


def thin_above(ux: F, uy: F, x: F, y: F) -> tuple[F, F]:
    """P. J. Carreau's fluid of n = 0.3 about 40 µm/s."""
    k = np.sqrt((1.0 + (ux**2 + uy**2) / (40e-6) ** 2) ** -0.7)
    return k * ux, k * uy


def centred(speed: F, x: F, y: F) -> F:
    """Pressure with its centre at (120, −40) µm: slopes p / (second moment)."""
    slope = 120e-6 * x / (HALF_LONG**2 / 3) - 40e-6 * y / (HALF_SHORT**2 / 3)
    return np.asarray(0.6 * SPEED * (1 + slope))


def spotted(x: F, y: F) -> F:
    """Twice the film's drag more in the middle of a spot of the stage."""
    wx, wy = START[0] + _COS * x - _SIN * y, START[1] + _SIN * x + _COS * y
    return np.asarray(2.0 * np.exp(-((wx - 100e-6) ** 2 + (wy + 500e-6) ** 2) / 400e-6**2))


def held(ux: F, uy: F, x: F, y: F) -> tuple[F, F]:
    return (1 + spotted(x, y)) * ux, (1 + spotted(x, y)) * uy


SPOT = {"ratio": 2.0, "x_um": 100.0, "y_um": -500.0, "radius_um": 400.0}
LAWS: dict[str, tuple[Values, Law]] = {
    "plain": ({}, film_law),
    "dry": ({"dry_friction": {"ratio": 0.6}}, coulomb(lambda s, x, y: 0.6 * SPEED)),
    "stribeck": (
        {"stribeck_friction": {"ratio": 0.9, "speed_um_s": 60.0}},
        coulomb(lambda s, x, y: 0.9 * SPEED * np.exp(-((s / 60e-6) ** 2))),
    ),
    "uneven": ({"uneven_support": {"ratio": 0.6, "x_um": 120.0, "y_um": -40.0}}, coulomb(centred)),
    "thinning": ({"shear_thinning": {"exponent_drop": 0.4}}, thin),
    "thinning above a speed": (
        {"shear_thinning": {"exponent_drop": 0.7, "speed_um_s": 40.0, "form": 1.0}},
        thin_above,
    ),
    "stage lay": (
        {"anisotropic_drag": {"fraction": 0.4, "direction_deg": 50.0}},
        lay(0.4, np.deg2rad(50) - START[2]),
    ),
    "part lay": (
        {"part_anisotropic_drag": {"fraction": 0.4, "direction_deg": 50.0}},
        lay(0.4, np.deg2rad(50)),
    ),
    "spot": ({"sticky_spot": SPOT}, held),
    "dry spot": (
        {"sticky_spot": {**SPOT, "form": 1.0}},
        coulomb(lambda s, x, y: SPEED * spotted(x, y)),
    ),
    "gradient": ({"drag_gradient": {"x_per_mm": 0.7, "y_per_mm": -0.4}}, graded),
}

TIPS = np.array([[-600.0, -418.5], [-150.0, -418.5], [120.0, -418.5], [700.0, -418.5]]) * UM


def short_push(values: Values, wait: float = 0.0, support: Any = FULL, **rest: Any) -> F:
    """(4,) turning speeds under sticking tips that go across the lower edge at 75 µm/s."""
    turn = np.array([[_COS, -_SIN], [_SIN, _COS]])
    tips = START[:2] + TIPS @ turn.T
    h = 1e-9
    ends = tips + h * turn[:, 1]
    ways = [tips, tips, ends] if wait else [tips, ends]
    times = [0.0, wait, wait + h / SPEED] if wait else [0.0, h / SPEED]
    push = lifted(
        values,
        poses=np.tile(START, (4, 1)),
        waypoints=np.stack(ways, axis=1)[:, :, None],
        times=np.array([times]),
        friction=np.full((4, 1), STICKY),
        shapes=(),
        support=support,
        step=h,
        time_step=1e6,
        **rest,
    )
    result = simulate(push)
    assert (result.outcomes == Outcome.COMPLETED).all()
    return np.asarray((result.poses[:, 2] - START[2]) / (h / SPEED))


def exact_turns(law: Law) -> F:
    return np.array([turn_under(tip, np.array([0.0, SPEED]), law) for tip in TIPS])


@pytest.mark.parametrize("name", LAWS)
def test_law_of_the_area_agrees_with_quadrature(name: str) -> None:
    values, law = LAWS[name]
    exact = exact_turns(law)
    np.testing.assert_allclose(short_push(values), exact, rtol=0, atol=4e-3 * np.abs(exact).max())
    if name != "plain":
        assert np.abs(exact - exact_turns(film_law)).max() > 0.02 * np.abs(exact).max()


def test_nodes_that_are_kept_cannot_be_changed() -> None:
    corners = np.array([[-1.0, -1.0], [2.0, -1.0], [0.0, 1.0]])
    kept = quadrature(corners)
    with pytest.raises(ValueError, match="read-only"):
        kept[0] = 0.0
    np.testing.assert_array_equal(quadrature(2.0 * corners)[:, :2], 2.0 * kept[:, :2])
    assert len(quadrature(corners, 1)) < len(kept)


def test_friction_that_does_not_decay_and_even_pressure_are_dry_friction() -> None:
    dry = short_push({"dry_friction": {"ratio": 0.6}})
    slow = short_push({"stribeck_friction": {"ratio": 0.6, "speed_um_s": 1e9}})
    even = short_push({"uneven_support": {"ratio": 0.6}})
    np.testing.assert_allclose(slow, dry, rtol=1e-7)
    np.testing.assert_allclose(even, dry, rtol=1e-7)


def test_contact_grows_stronger_at_rest_and_loses_it_in_sliding() -> None:
    values: Values = {"breakaway_friction": {"ratio": 0.3, "distance_um": 2.0}}
    aged = exact_turns(coulomb(lambda s, x, y: 0.3 * SPEED * np.log1p(10.0)))
    fresh = short_push(values)
    np.testing.assert_allclose(fresh, short_push({}), rtol=1e-9)
    found = short_push(values, wait=10.0)
    np.testing.assert_allclose(found, aged, rtol=0, atol=4e-3 * np.abs(aged).max())


def test_age_tends_to_distance_over_speed() -> None:
    # Steady sliding at 75 µm/s over 2 mm: a = 2000 / 75 s, as if dry with ln(1 + a).
    values: Values = {"breakaway_friction": {"ratio": 0.2, "distance_um": 300.0}}
    push = central(values, [0.0, 6000.0], [0.0, 80.0], step=5 * UM)
    result = simulate(push, instants=np.array([[1.0, 80.0]]))
    age = 4.0 * (1 - np.exp(-np.array([1.0, 80.0]) / 4.0))
    wanted = 75 * UM + 0.2 * 75 * UM * np.log1p(age)
    np.testing.assert_allclose(result.forces[0, :, 0, 1], wanted, rtol=4e-3)


def test_drift_of_the_drag_changes_its_share_of_a_mixture() -> None:
    dry: Values = {"dry_friction": {"ratio": 0.5}}
    later = short_push(dry | {"drag_drift": {"rate_percent_s": 4.0}}, wait=20.0)
    less = short_push({"dry_friction": {"ratio": 0.5 * np.exp(-0.8)}})
    np.testing.assert_allclose(later, less, rtol=1e-7)
    assert np.abs(later / short_push(dry) - 1).max() > 0.01


def test_centre_of_drag_is_a_film_about_another_point() -> None:
    cx, cy = 60 * UM, -30 * UM
    at = np.array([[1, 0, -cy], [0, 1, cx], [0, 0, 1.0]])
    moved = Film(at.T @ np.diag([1.0, 1.0, RHO]) @ at)
    offset = simulate(lifted({"drag_centre_offset": {"x_um": 60.0, "y_um": -30.0}}))
    close(offset.poses, simulate(lifted({}, support=moved)).poses, 1e-13)


DRY = ThreePoints(points=np.array([[563.3, 411.3], [-605.9, -409.1], [102.1, -273.2]]) * UM)


@pytest.mark.parametrize(
    "name",
    [
        "shear_thinning", "anisotropic_drag", "part_anisotropic_drag", "drag_gradient",
        "drag_centre_offset", "drag_drift",
    ],
)  # fmt: skip
def test_effects_of_the_film_are_refused_without_a_film(name: str) -> None:
    with pytest.raises(ValueError, match=f"effects: {name}; need a film"):
        lifted({name: ON[name]}, support=DRY)
    lifted({name: ON[name]}, support=Mixture(film=FULL, dry=DRY, ratio=0.5))
    lifted(off(name), support=DRY)


def test_friction_under_the_area_and_a_mixture_are_one() -> None:
    pressed = Mixture(film=FULL, dry=PressurePoints.under(rectangle(), 6), ratio=0.4)
    as_effect = short_push({"dry_friction": {"ratio": 0.4}})
    np.testing.assert_allclose(short_push({}, support=pressed), as_effect, rtol=1e-9)


# --- geometry ---------------------------------------------------------------------------------------------


def test_part_geometry_is_another_outline() -> None:
    stretched = rectangle(HALF_LONG + 15 * UM, HALF_SHORT - 6 * UM)
    want = simulate(replace(lifted({}), vertices=stretched))
    got = simulate(lifted({"part_geometry": {"x_um": 15.0, "y_um": -6.0}}))
    close(got.poses, want.poses, 1e-14)


@pytest.mark.parametrize(
    ("form", "leans"),
    [
        (1.0, [3.0, 3.0, 0.0, 0.0]),
        (0.0, [0.0, 0.0, 3.0, 3.0]),
        (2.0, [1.5, 1.5, 1.5, 1.5]),
        (3.0, [0.0, 0.0, 3.0, -3.0]),
        (4.0, [3.0, -3.0, 0.0, 0.0]),
    ],
)
def test_a_part_out_of_square_has_edges_that_lean(form: float, leans: list[float]) -> None:
    """By the directions of its edges."""
    table = Effects({"part_skew": {"angle_deg": 3.0, "form": form}}).table
    found = outlines(rectangle(), table)[0]
    sides = np.roll(found, -1, axis=0) - found
    upright = np.abs(sides[:, 1]) > np.abs(sides[:, 0])
    slopes = np.where(upright, sides[:, 0], sides[:, 1]) / np.where(upright, *sides.T[::-1])
    told = np.degrees(np.arctan(slopes))
    assert sorted(told[upright]) == pytest.approx(sorted(leans[:2]))
    assert sorted(told[~upright]) == pytest.approx(sorted(leans[2:]))
    # about the middle of its sides
    assert np.mean(np.stack([found.min(axis=0), found.max(axis=0)]), axis=0) == pytest.approx(
        [0.0, 0.0], abs=1e-12
    )
    want = simulate(replace(lifted({}), vertices=found))
    got = simulate(lifted({"part_skew": {"angle_deg": 3.0, "form": form}}))
    close(got.poses, want.poses, 1e-14)


def test_a_part_whose_edges_would_meet_is_refused() -> None:
    slender = rectangle(1000 * UM, 100 * UM)
    with pytest.raises(ValueError, match=r"part_skew.*meet within the part"):
        outlines(slender, Effects({"part_skew": {"angle_deg": 8.0, "form": 3.0}}).table)


def test_tip_radius_is_another_tip() -> None:
    got = simulate(lifted({"tip_radius": {"excess_um": -4.0}}))
    close(got.poses, simulate(lifted({}, shapes=(Round(11 * UM),))).poses, 1e-14)
    with pytest.raises(ValueError, match=r"tip_radius.*must not be negative"):
        simulate(lifted({"tip_radius": {"excess_um": -16.0}}))


def test_tracked_point_goes_round_the_reference_point() -> None:
    c = np.array([20.0, 9.0]) * UM

    def tracked(poses: F) -> F:
        z = (c[0] + 1j * c[1]) * np.exp(1j * poses[..., 2])
        return poses + np.stack([z.real, z.imag, 0 * z.real], axis=-1)

    plain = simulate(lifted({}), record=7)
    start = tracked(np.zeros((1, 3)))
    got = simulate(lifted({"reference_offset": ON["reference_offset"]}, poses=start), record=7)
    close(got.path, tracked(plain.path), 1e-14)
    close(got.poses, tracked(plain.poses), 1e-14)


def test_tracked_axes_are_turned_against_the_outline_and_the_offset_with_them() -> None:
    c = np.array([20.0, 9.0]) * UM
    yaw = np.radians(0.8)

    def tracked(poses: F) -> F:
        z = (c[0] + 1j * c[1]) * np.exp(1j * poses[..., 2])
        return poses + np.stack([z.real, z.imag, 0 * z.real + yaw], axis=-1)

    plain = simulate(lifted({}), record=7)
    both = {"reference_offset": ON["reference_offset"], "part_yaw": ON["part_yaw"]}
    got = simulate(lifted(both, poses=tracked(np.zeros((1, 3)))), record=7)
    close(got.path, tracked(plain.path), 1e-14)
    close(got.poses, tracked(plain.poses), 1e-14)


def test_the_page_of_the_catalogue_is_up_to_date() -> None:
    written = Path(__file__).parents[2] / "reports" / "simulator" / "effects.md"
    assert written.read_text(encoding="utf-8") == page()


def test_an_end_of_a_range_is_accepted_in_its_unit_and_in_si() -> None:
    """Whoever reads the end in a document and states it again states the very same number."""
    for name, effect in CATALOGUE.items():
        for one in effect.parameters:
            for value in (one.low, one.high, one.default):
                if np.isfinite(value):
                    Effects({name: {one.key: one.shown(value)}})
                    Effects.in_si({name: {one.key: value}})
                    assert one.shown(value) * one.to_si == value, (name, one.key)


def test_a_value_is_shown_as_the_decimal_that_was_stated() -> None:
    for one in (p for effect in CATALOGUE.values() for p in effect.parameters):
        for tenth in range(-99, 100):
            assert one.shown(tenth / 10 * one.to_si) == tenth / 10


def test_values_in_si_are_taken_as_they_are() -> None:
    ratio = 0.1 + 1e-17
    effects = Effects.in_si({"dry_friction": {"ratio": ratio}, "backlash": {"width_um": 3e-6}})
    assert effects.table[0, stage_of("dry_friction").slot("dry_friction", "ratio")] == ratio
    assert not effects.without("backlash").is_on(stage_of("backlash").slot("backlash", "width_um"))
    assert effects.without("backlash").table[0].any()
    with pytest.raises(ValueError, match=r"backlash.width_um: -2.0; must be .* 0 …"):
        Effects.in_si({"backlash": {"width_um": -2e-6}})
