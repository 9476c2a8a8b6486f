"""Forms of a law: each is the same near its scale and another one away from it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from meso_robust.simulator import Effects, Film, Outcome, Push, PushResult, Round, simulate
from meso_robust.simulator.catalogue import CATALOGUE
from meso_robust.simulator.geometry import outlines, radii
from meso_robust.simulator.observation import observe, unseen
from tests.simulator.problems import HALF_SHORT, RHO, UM, rectangle
from tests.simulator.test_effects import ON, lifted
from tests.simulator.test_residual import end

WITH_FORMS = [name for name, effect in CATALOGUE.items() if effect.forms]
SIZES = {
    **ON,
    "camera_drift": {"x_um_s": 2.0, "y_um_s": 0.0},
    "angle_error": {"sine_deg": 0.5},
}
TWO_TIPS = {"tip_radius", "leadscrew_error"}
"""Effects of which another form is another motion with two tips only."""
OTHERS = [
    (name, float(law))
    for name in WITH_FORMS
    if name in ON and name not in TWO_TIPS
    for law in range(1, len(CATALOGUE[name].forms))
]


def test_every_form_has_words_and_a_number() -> None:
    assert len(WITH_FORMS) >= 15
    for name in WITH_FORMS:
        forms, number = CATALOGUE[name].forms, CATALOGUE[name].parameters[-1]
        assert (number.key, number.low, number.high) == ("form", 0.0, len(forms) - 1.0)
        assert all(words in number.meaning for words in forms)
        with pytest.raises(ValueError, match=rf"{name}.form: {len(forms)}.0; must be"):
            Effects({name: {**SIZES[name], "form": float(len(forms))}})


SHAPES = {"body_force": {"growth_um_s_per_mm": 3.0}}
"""Numbers that only another form has and that are nought by default."""
SLANTED = np.array([[[[100 * UM, -458 * UM]], [[180 * UM, -328 * UM]], [[170 * UM, -368 * UM]]]])
"""A way that is along no axis, below the lower edge and up."""


@pytest.mark.parametrize(("name", "law"), OTHERS)
def test_another_form_is_another_motion_and_no_size_is_none(name: str, law: float) -> None:
    def run(**form: float) -> PushResult:
        given = {name: {**ON[name], **SHAPES.get(name, {}), **form}}
        return simulate(lifted(given, waypoints=SLANTED))

    plain = run().poses
    np.testing.assert_array_equal(run(form=0.0).poses, plain)
    other = run(form=law)
    assert (other.outcomes == Outcome.COMPLETED).all()
    assert np.abs((other.poses - plain) * [1, 1, 1e-3]).max() > 1e-9


@pytest.mark.parametrize(("form", "worn"), [(0.0, (1, 1)), (1.0, (1, 0)), (2.0, (0, 1))])
def test_one_tip_alone_is_worn(form: float, worn: tuple[int, int]) -> None:
    table = Effects({"tip_radius": {"excess_um": np.array([2.0, -1.0]), "form": form}}).table
    found = radii(np.array([10e-6, 12e-6]), table)
    by = np.array([[2e-6], [-1e-6]]) * np.array(worn)
    np.testing.assert_allclose(found, np.array([10e-6, 12e-6]) + by, rtol=1e-12)


def test_a_wall_by_a_power_pulls_as_stated() -> None:
    """x' = p / (1 + (s − x)/l)²: with z = 1 + (s − x)/l, z³ falls by 3 p t / l."""
    pull, place, reach = 8.0, 400.0, 150.0
    given = {"pull_um_s": pull, "direction_deg": 0.0, "position_um": place, "range_um": reach}
    x, _, _ = end({"wall_capillarity": {**given, "form": 1.0}})
    z = np.cbrt((1.0 + place / reach) ** 3 - 3.0 * pull * 4.0 / reach)
    assert x == pytest.approx(place - reach * (z - 1.0), rel=1e-3)


def dragged(values: dict[str, Any], force: float) -> float:
    """Speed in µm/s at which a force, over the film's drag, moves a free part."""
    return end({"body_force": {"x_um_s": force}, **values})[0] / 4.0


def test_friction_of_slow_sliding_falls_by_the_first_or_second_power() -> None:
    ratio, scale, force = 0.2, 60.0, 80.0  # of the film's drag at 75 µm/s: 15 µm/s
    for form, power in ((0.0, 2), (1.0, 1)):
        v = dragged(
            {"stribeck_friction": {"ratio": ratio, "speed_um_s": scale, "form": form}}, force
        )
        assert force - v == pytest.approx(15.0 * np.exp(-((v / scale) ** power)), rel=1e-3)


def test_drag_by_place_grows_along_a_line() -> None:
    """x' = f / k(x) of a point-like support: the mean of k over the part is k at its centre."""
    f, slope = 50.0, 1.0
    x = end({"body_force": {"x_um_s": f}, "drag_gradient": {"x_per_mm": slope, "form": 1.0}})[0]
    # x + g x² / 2 = f t; a line has no curvature over the area
    exact = (np.sqrt(1.0 + 2.0 * 1e-3 * slope * f * 4.0) - 1.0) / (1e-3 * slope)
    assert x == pytest.approx(exact, rel=2e-3)


@pytest.mark.parametrize("form", [0.0, 1.0])
def test_a_tip_draws_the_part_by_its_form(form: float) -> None:
    """Attraction at a gap g: F/(1 + g/r), or F/2^(g/r)."""
    gap, reach, pull = 20.0, 10.0, 3.0
    tip = np.array([[[[-808.0 - 15.0 - gap, 0.0]], [[-808.0 - 15.0 - gap, 0.0]]]]) * UM
    push = Push(
        vertices=rectangle(),
        poses=np.zeros((1, 3)),
        waypoints=tip,
        times=np.array([[0.0, 0.01]]),
        friction=np.array([[0.3]]),
        support=Film.ratio(RHO),
        shapes=(Round(15 * UM),),
        effects=Effects({"tip_attraction": {"pull_um_s": pull, "range_um": reach, "form": form}}),
        step=1 * UM,
        time_step=1e-3,
    )
    moved = -simulate(push).poses[0, 0] / UM / 0.01
    far = 1.0 / (1.0 + gap / reach) if form == 0.0 else 0.5 ** (gap / reach)
    assert moved == pytest.approx(pull * far, rel=0.01)


@pytest.mark.parametrize(
    ("name", "angle"), [("anisotropic_drag", 0.0), ("part_anisotropic_drag", 0.7)]
)
def test_drag_against_the_slip_is_of_an_ellipse_and_deflects_nothing(
    name: str, angle: float
) -> None:
    """A force at ψ to the lay moves the part its own way, by f / √((1 + a)² cos² ψ + (1 − a)² sin² ψ)."""
    a, lay, force, way = 0.6, 25.0, 20.0, 1.1
    psi = way - np.radians(lay) - angle
    got = end(
        {
            "body_force": {"x_um_s": force * np.cos(way), "y_um_s": force * np.sin(way)},
            name: {"fraction": a, "direction_deg": lay, "form": 1.0},
        },
        (0.0, 0.0, 0.7),
    )
    far = 4.0 * force / np.sqrt(((1 + a) * np.cos(psi)) ** 2 + ((1 - a) * np.sin(psi)) ** 2)
    assert got == pytest.approx([far * np.cos(way), far * np.sin(way), 0.7], rel=1e-6)


def test_dry_pressure_at_the_rim_is_the_same_force_and_turns_less() -> None:
    """A translation feels the whole pressure; an arm r carries the pressure r², which a turn feels."""
    ratio, force = 0.2, 60.0
    for form in (0.0, 1.0):
        v = dragged({"dry_friction": {"ratio": ratio, "form": form}}, force)
        assert force - v == pytest.approx(75.0 * ratio, rel=1e-6)
    torque = 4e4
    turned = [
        end({"residual": {"torque_um2_s": torque}, "dry_friction": {"ratio": 0.05, "form": form}})
        for form in (0.0, 1.0)
    ]
    x, y = (side.ravel() for side in np.meshgrid(*2 * [np.linspace(-1, 1, 401)]))
    arm = np.hypot(808.0 * x, 418.5 * y)
    arm *= np.sqrt(RHO) / UM / np.sqrt(np.mean(arm**2))  # the area has the film's second moment
    for (_, _, theta), power in zip(turned, (1, 3), strict=True):
        dry = 75.0 * 0.05 * np.mean(arm**power) / np.mean(arm ** (power - 1))
        assert theta == pytest.approx(4.0 * (torque - dry) * UM**2 / RHO, rel=2e-3)


def test_age_that_counts_by_its_root() -> None:
    """At a steady speed the age is D / v."""
    ratio, distance, force = 0.2, 1.0, 60.0
    given = {"ratio": ratio, "distance_um": distance, "form": 2.0}
    v = dragged({"breakaway_friction": given}, force)
    assert force - v == pytest.approx(75.0 * ratio * np.sqrt(distance / v), rel=5e-3)


@pytest.mark.parametrize("level", [(6.0, -2.0), (0.0, 0.0)])
def test_a_curved_stage_pulls_by_the_place(level: tuple[float, float]) -> None:
    """s' = b·n + k s along n, and b alone across it; one that is level in its middle pulls as well."""
    k, way, b = 200.0, 0.4, np.array(level)
    given = {"x_um_s": b[0], "y_um_s": b[1], "growth_um_s_per_mm": k, "form": 1.0}
    got = end({"body_force": {**given, "direction_deg": np.degrees(way)}}, (300 * UM, 0.0, 0.0))
    along, across = np.array([np.cos(way), np.sin(way)]), np.array([-np.sin(way), np.cos(way)])
    rate, start = 1e-3 * k, np.array([300.0, 0.0])
    s = (start @ along + b @ along / rate) * np.exp(4.0 * rate) - b @ along / rate
    wanted = s * along + (start @ across + 4.0 * b @ across) * across
    assert got[:2] == pytest.approx(wanted, rel=1e-3)


@pytest.mark.parametrize(
    ("form", "wanted"),
    [
        (1, [[-800, -419], [818, -419], [818, 421], [-800, 421]]),
        (4, [[-818, -421], [800, -421], [800, 419], [-818, 419]]),
        (0, [[-809, -420], [809, -420], [809, 420], [-809, 420]]),
    ],
)
def test_one_edge_of_two_is_out_of_place_by_the_whole(form: int, wanted: list[list[float]]) -> None:
    out = {"x_um": 9.0, "y_um": 1.0, "form": float(form)}
    made = outlines(
        np.array([[-800.0, -419.0], [800, -419], [800, 419], [-800, 419]]) * UM,
        Effects({"part_geometry": out}).table,
    )
    np.testing.assert_allclose(made[0] / UM, wanted, atol=1e-9)


def tips(
    values: dict[str, Any], way: list[list[float]], at: list[float], **rest: Any
) -> np.ndarray:
    """(T, 2) where the tip is, µm from its start, which is clear of the part unless told."""
    start = rest.pop("start", (-3000.0, 0.0))
    run = np.array([[[np.add(start, point)] for point in [[0.0, 0.0], *way]]]) * UM
    push = lifted(values, waypoints=run, times=np.arange(1.0 + len(way))[None], **rest)
    return np.asarray(simulate(push, instants=np.array([at])).tips[0, :, 0] / UM - start)


def test_play_within_a_circle_follows_at_half_its_width() -> None:
    """Along a line the tip is b/2 behind, whatever the heading; on a turn it is drawn, and comes about."""
    play = {"backlash": {"width_um": 8.0, "form": 1.0}}
    found = tips(play, [[30.0, 40.0], [60.0, 80.0]], [0.01, 1.0, 2.0])
    np.testing.assert_allclose(found[0], [0.0, 0.0])
    np.testing.assert_allclose(np.hypot(*found[1:].T), [46.0, 96.0], atol=1e-9)
    np.testing.assert_allclose(found[1:, 1] / found[1:, 0], 4.0 / 3.0)
    # a tractrix: the distance to the line of travel decays by the way over the length
    turned = tips(play, [[40.0, 0.0], [40.0, 12.0]], [2.0], step=0.01 * UM)
    u = 12.0 / 4.0
    np.testing.assert_allclose(
        turned[0], [40.0 - 4.0 / np.cosh(u), 12.0 - 4.0 * np.tanh(u)], atol=0.02
    )


def test_a_drift_that_slows_down() -> None:
    drift = {"x_um_s": 3.0, "y_um_s": -1.0, "time_s": 0.5, "form": 1.0}
    far = 0.5 * np.log(1.0 + np.array([1.0, 2.0]) / 0.5)
    found = tips({"probe_drift": drift}, [[0.0, 0.0], [0.0, 0.0]], [1.0, 2.0])
    np.testing.assert_allclose(found, far[:, None] * [3.0, -1.0], rtol=1e-9)
    table = Effects({"camera_drift": drift}).table
    still = np.zeros((1, 2, 3))
    instants = np.array([1.0, 2.0])
    seen, _ = observe(instants, still, np.zeros((1, 2, 0, 2)), table, probes_seen_by_camera=True)
    np.testing.assert_allclose(seen[0, :, :2] / UM, far[:, None] * [3.0, -1.0], rtol=1e-12)
    back = unseen(instants[None], seen[:, :, None, :2], table)
    np.testing.assert_allclose(back, 0.0, atol=1e-18)


@pytest.mark.parametrize("way", [0.0, 35.0, 90.0])
def test_a_blade_bends_along_its_one_direction(way: float) -> None:
    """A tip without friction feels the force v e_y of the drag only, and gives way by τ v cos φ."""
    tau, v = 0.04, 50.0
    found = tips(
        {"probe_compliance": {"time_ms": 1e3 * tau, "direction_deg": 90.0 - way, "form": 1.0}},
        [[0.0, v], [0.0, 2.0 * v]],
        [2.0],
        start=(0.0, -HALF_SHORT / UM - 15.0),
        friction=np.array([[0.0]]),
        time_step=1e-3,
    )
    give = tau * v * np.cos(np.radians(way))
    wanted = [-give * np.sin(np.radians(way)), 2.0 * v - give * np.cos(np.radians(way))]
    np.testing.assert_allclose(found[0], wanted, atol=0.02)
