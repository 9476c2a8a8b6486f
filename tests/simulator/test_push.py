"""Inputs of a push, good and bad."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.simulator import (
    Effects,
    Film,
    FirstOrder,
    Fixture,
    Flat,
    Outcome,
    Point,
    Push,
    Round,
    simulate,
)
from meso_robust.simulator.fixture import slot
from tests.simulator.problems import HALF_SHORT, RHO, UM, one_point, rectangle

F = npt.NDArray[np.float64]


def fields(**changes: Any) -> dict[str, Any]:
    good: dict[str, Any] = {
        "vertices": rectangle(),
        "poses": np.array([[0.0, 0.0, np.pi / 2]] * 2),
        "tips": np.array([[[HALF_SHORT, 0.0]]] * 2),
        "travel": np.array([[[-100 * UM, 0.0]]] * 2),
        "friction": np.array([0.3, 0.3]),
        "film_ratio": np.array([RHO, RHO]),
        "step": 1 * UM,
    }
    return good | changes


def whole(**changes: Any) -> dict[str, Any]:
    """Fields of a push with waypoints."""
    good: dict[str, Any] = {
        "vertices": rectangle(),
        "poses": np.array([[0.0, 0.0, np.pi / 2]] * 2),
        "waypoints": np.array([[[[500, 0]], [[400, 0]], [[400, 200]]]]) * UM,
        "times": np.array([[0.0, 1.0, 3.0]]),
        "friction": np.array([[0.3]]),
        "support": Film.ratio(RHO),
        "step": 1 * UM,
    }
    return good | changes


def test_arrays_are_copied_and_read_only() -> None:
    given = fields(friction=[0, 1])
    push = Push.straight(**given)
    given["vertices"][0, 0] = 7.0
    assert push.vertices[0, 0] == -808 * UM
    assert push.friction.dtype == np.float64
    with pytest.raises(ValueError, match="read-only"):
        push.waypoints[0, 0, 0, 0] = 1.0


@pytest.mark.parametrize(("step", "steps"), [(1 * UM, 100), (0.3 * UM, 334), (100 * UM, 1)])
def test_steps_round_up(step: float, steps: int) -> None:
    assert Push.straight(**fields(step=step)).steps == steps


def test_steps_are_those_of_the_longest_run_and_probe_in_each_leg() -> None:
    waypoints = np.zeros((2, 3, 2, 2))
    waypoints[..., 0] = 1e-3
    waypoints[0, 1, 0] += np.array([30, 40]) * UM  # 50 µm, and back
    waypoints[1, 2, 1] += np.array([0, 120.5]) * UM
    push = Push(**whole(waypoints=waypoints, friction=np.array([[0.1, 0.2]])))
    np.testing.assert_array_equal(push.steps_of_legs, [[50, 121]])
    assert push.steps == 171


def test_steps_in_time_are_those_of_each_run() -> None:
    times = np.array([[0.0, 1.0, 3.0], [0.0, 4.0, 4.5]])
    effects = Effects({"body_force": {"x_um_s": 1.0}})
    rest = {"times": times, "effects": effects, "step": 100 * UM, "time_step": 0.5}
    push = Push(**whole(**rest))
    np.testing.assert_array_equal(push.steps_of_legs, [[2, 4], [8, 2]])
    assert push.steps == 10
    # a run is the same whatever it is run with
    alone = replace(push, poses=push.poses[1:], times=times[1:])
    np.testing.assert_array_equal(simulate(push).poses[1], simulate(alone).poses[0])


def test_a_run_ends_after_its_legs() -> None:
    way = {"waypoints": np.array([[[[500, 0]], [[400, 0]], [[350, 0]]]]) * UM}
    push = Push(**whole(**way, legs=np.array([1, 2])))
    np.testing.assert_array_equal(push.steps_of_legs, [[100, 0], [100, 50]])
    found = simulate(push, instants=np.array([[0.5, 1.0, 2.0]]))
    short = Push(**whole(waypoints=push.waypoints[:, :2], times=push.times[:, :2]))
    np.testing.assert_array_equal(found.poses[0], simulate(short).poses[0])
    np.testing.assert_array_equal(found.path[0, 1:], found.poses[[0, 0]])
    np.testing.assert_array_equal(found.poses[1], simulate(Push(**whole(**way))).poses[1])
    assert not np.array_equal(found.poses[0], found.poses[1])
    np.testing.assert_array_equal(found.outcomes, Outcome.COMPLETED)


def test_times_of_a_straight_push_are_those_of_its_fastest_probe() -> None:
    travel = np.array([[[30, 40]], [[0, 0]]]) * UM
    push = Push.straight(**fields(travel=travel, speed=20 * UM))
    np.testing.assert_allclose(push.times, [[0.0, 2.5], [0.0, 1.0]])
    way = push.waypoints[:, 1] - push.waypoints[:, 0]
    np.testing.assert_allclose(way, travel, atol=1e-18)


def test_no_travel_takes_one_step() -> None:
    assert Push.straight(**fields(travel=np.zeros((2, 1, 2)))).steps == 1


def test_friction_of_a_run_holds_for_all_its_probes() -> None:
    tips, travel = np.full((2, 3, 2), 5e-3), np.zeros((2, 3, 2))
    push = Push.straight(**fields(tips=tips, travel=travel, friction=[0.1, 0.2]))
    np.testing.assert_array_equal(push.friction, [[0.1] * 3, [0.2] * 3])


STAR = np.array([[np.cos(4 * np.pi * k / 5), np.sin(4 * np.pi * k / 5)] for k in range(5)])
INSIDE = np.array([[[HALF_SHORT, 0.0]], [[HALF_SHORT - 3 * UM, 0.0]]])
BAD: list[tuple[dict[str, Any], str]] = [
    ({"vertices": rectangle()[:2]}, r"vertices: 2 corners; must be at least 3; give"),
    ({"vertices": rectangle()[::-1]}, r"vertices: area -.* must be counter-clockwise; reverse"),
    ({"vertices": rectangle()[[0, 1, 1, 2, 3]]}, r"vertices: corner 1 and the next coincide"),
    (
        {"vertices": np.insert(rectangle(), 1, [0.0, -HALF_SHORT], axis=0)},
        r"vertices: corner 1 lies on the line through its neighbours; must bend",
    ),
    ({"vertices": STAR}, r"vertices: edges 0 and 2 meet; must not touch or cross"),
    ({"vertices": rectangle() + 1e-3}, r"vertices: all corners lie within .* subtract"),
    ({"vertices": np.zeros((4, 3))}, r"vertices: shape \(4, 3\); must be \(V, 2\).*reshape"),
    ({"vertices": np.array(1.0)}, r"vertices: shape \(\); must be \(V, 2\)"),
    ({"poses": np.zeros((2, 2))}, r"poses: shape \(2, 2\); must be \(N, 3\)"),
    ({"tips": np.zeros((3, 1, 2))}, r"travel: shape \(2, 1, 2\) for tips of \(3, 1, 2\)"),
    ({"tips": np.zeros((2, 0, 2)), "travel": np.zeros((2, 0, 2))}, r"waypoints: 0 probes; must"),
    ({"tips": np.ones((2, 7, 2)), "travel": np.zeros((2, 7, 2))}, r"waypoints: 7 probes; .* to 6"),
    ({"travel": np.zeros((2, 2, 2))}, r"travel: shape .* must be \(N, P, 2\)"),
    ({"friction": np.zeros(3)}, r"friction: shape \(3, 1\); must be \(N,\)"),
    ({"film_ratio": np.full(3, RHO)}, r"film: 3 runs; must be 1 or 2, as in poses; repeat"),
    ({"poses": [[0, 0, np.nan]] * 2}, r"poses: nan at \(0, 2\); must be finite; remove"),
    ({"travel": [[[0, 0]], [[0, np.inf]]]}, r"waypoints: inf at \(1, 1, 0, 1\); must be finite"),
    ({"friction": [0.1, -0.2]}, r"friction: run 1 has -0.2; must not be negative; give μ"),
    ({"film_ratio": [RHO, 0.0]}, r"film_ratio: .*0.*; .*must be positive"),
    (
        {"legs": np.array([1, 1, 1])},
        r"legs: int64 of shape \(3,\); must be 2 whole numbers, or one",
    ),
    ({"legs": np.array([0.5])}, r"legs: float64 of shape \(1,\); must be 2 whole numbers, or one"),
    ({"legs": np.array([1, 2])}, r"legs: run 1 has 2; must be 1 to 1, the legs of the move; leave"),
    ({"step": 0.0}, r"step: 0.0 m; must be positive and finite; try"),
    ({"step": np.nan}, r"step: nan m; must be positive"),
    ({"step": 1.0}, r"step: 1 m where vertices is 0.000837 m thick; must be at most .* give"),
    ({"frame": "end"}, r"frame: 'end'; must be \"middle\" or \"start\""),
    ({"step": 1e-20}, r"step: 1e-20 m for a travel of 0.0001 m; must give at most 1e\+08 steps"),
    ({"tips": INSIDE}, r"waypoints: probe 0 of run 1 starts 3 µm inside the part; must start"),
    ({"speed": 0.0}, r"speed: 0.0 m/s; must be positive and finite; try"),
    ({"shapes": (Point(), Point())}, r"shapes: 2 shapes; must be 1, one for each probe"),
    (
        {"shapes": (Round(30 * UM),), "tips": INSIDE + np.array([20 * UM, 0])},
        r"waypoints: probe 0 of run 0 starts 10 µm inside the part",
    ),
    ({"shapes": (Flat(0.0),)}, r"waypoints: probe 0 of run 0 starts .*inside the part"),
    ({"time_step": -1.0}, r"time_step: -1.0 s; must be positive and finite; try"),
    (
        {"fixture": Fixture((rectangle() + np.array([400 * UM + HALF_SHORT, 0]),))},
        r"poses: the part of run 0 starts .* µm inside fixture.outlines\[0\]; must start",
    ),
    (
        {
            "fixture": Fixture(
                (np.array([[-2e-3, -1e-4], [2e-3, -1e-4], [2e-3, 1e-4], [-2e-3, 1e-4]]),)
            )
        },
        r"poses: the part of run 0 starts inf µm inside fixture.outlines\[0\]",
    ),
]


@pytest.mark.parametrize(("changes", "message"), BAD, ids=[b[1][:24] for b in BAD])
def test_bad_input_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Push.straight(**fields(**changes))


BAD_WAYS: list[tuple[dict[str, Any], str]] = [
    ({"waypoints": np.zeros((1, 1, 1, 2)), "times": np.zeros((1, 1))}, r"waypoints: 1 instants"),
    ({"waypoints": np.zeros((3, 3, 1, 2))}, r"waypoints: shape \(3, 3, 1, 2\); must be \(1\|N, T"),
    ({"times": np.array([[0.0, 1.0]])}, r"times: shape \(1, 2\); must be \(1\|N, T\)"),
    ({"times": np.array([[0.0, 1.0, 1.0]])}, r"times: run 0 goes from 1 to 1 s; must increase"),
    ({"times": np.array([[0.0, np.nan, 1.0]])}, r"times: nan at \(0, 1\); must be finite"),
]


@pytest.mark.parametrize(("changes", "message"), BAD_WAYS, ids=[b[1][:24] for b in BAD_WAYS])
def test_bad_way_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Push(**whole(**changes))


SQUARE = rectangle(1e-3, 1e-3)
BAD_SOLIDS: list[tuple[Callable[[], object], str]] = [
    (lambda: Round(0.0), r"radius: 0.0 m; must be positive and finite; use Point"),
    (lambda: Round(np.inf), r"radius: inf m; must be positive"),
    (lambda: Flat(np.nan), r"facing: nan rad; must be finite"),
    (lambda: Flat(0.0, -1.0), r"side: -1.0 m; must be positive and finite"),
    (lambda: Fixture((SQUARE,), -0.1), r"fixture.friction: -0.1; must not be negative"),
    (lambda: Fixture((SQUARE,), np.inf), r"fixture.friction: inf"),
    (lambda: Fixture((SQUARE, SQUARE[:2])), r"fixture.outlines\[1\]: 2 corners; must be at least"),
    (lambda: Fixture((STAR,)), r"fixture.outlines\[0\]: edges 0 and 2 meet"),
    (lambda: Fixture((SQUARE * np.nan,)), r"fixture.outlines\[0\]: corner 0 is .* must be finite"),
    (lambda: Fixture((np.ones(3),)), r"fixture.outlines\[0\]: shape \(3,\); must be \(V, 2\)"),
    (lambda: slot((0, 0), 1e-3, 2e-3, friction=0.1), r"width: 0.002 m; must be less than"),
    (lambda: Film(np.eye(2)), r"drag: shape \(.*2, 2\); must be \(3, 3\)"),
    (lambda: Film(np.diag([1.0, 1.0, -1.0])), r"drag: run 0 has .* must be positive definite"),
    (lambda: Film(np.eye(3) + np.eye(3, k=1)), r"drag: not symmetric; must equal its transpose"),
]


@pytest.mark.parametrize(("make", "message"), BAD_SOLIDS, ids=[b[1][:24] for b in BAD_SOLIDS])
def test_bad_solid_or_film_is_refused(make: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()


def test_depth_left_by_an_earlier_move_is_taken() -> None:
    touching = np.array([[[HALF_SHORT - 0.04 * UM, 0.0]]] * 2)
    assert Push.straight(**fields(tips=touching)).waypoints.shape == (2, 2, 1, 2)


def test_solids_of_a_fixture_are_copied_and_read_only() -> None:
    given = SQUARE.copy()
    fixture = Fixture((given,))
    given[0, 0] = 7.0
    assert fixture.outlines[0][0, 0] == -1e-3
    with pytest.raises(ValueError, match="read-only"):
        fixture.outlines[0][0, 0] = 1.0


@pytest.mark.parametrize(
    ("effects", "message"),
    [
        ({"edge_dependent_friction": {"change": 0.2, "edge": 4}}, "whole number below 4"),
        ({"edge_dependent_friction": {"change": 0.2, "edge": 0.5}}, "whole number below 4"),
        ({"friction_spread": {"change": 0.2, "tip": 0.5}}, "whole number"),
        (
            {"anisotropic_drag": {"fraction": 0.6}, "part_anisotropic_drag": {"fraction": -0.5}},
            "must leave a positive drag",
        ),
    ],
)
def test_effects_without_a_meaning_are_refused(
    effects: dict[str, dict[str, float]], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        replace(one_point(0.0, 1e-4, 1e-6), effects=Effects(effects))


def test_first_order_motion_has_no_film_to_be_changed() -> None:
    flow = Effects({"film_flow": {"x_um_s": 3.0}})
    push = replace(one_point(0.0, 1e-4, 1e-6), motion=FirstOrder(mass=1e-5, inertia=1e-12))
    with pytest.raises(ValueError, match="FirstOrder has none"):
        replace(push, effects=flow)


@pytest.mark.parametrize("value", [[[1.0]], "wide", []])
def test_values_of_effects_are_numbers_or_one_a_run(value: object) -> None:
    with pytest.raises(ValueError, match=r"effects.backlash.width_um: .*must be a number"):
        Effects({"backlash": {"width_um": value}})  # type: ignore[dict-item]


def test_a_large_tip_may_touch_a_part_that_is_longer_than_stated() -> None:
    # 4.75 mm of tip beside a part that stands out by 0.21 mm: the gap is what the drawing says,
    # not what a drawing stretched together with the tip would say
    square = np.array([[-45.0, -45.0], [45.0, -45.0], [45.0, 45.0], [-45.0, 45.0]]) * 1e-3
    touching = 45e-3 + 0.21e-3 + 4.75e-3

    def push(x: float) -> Push:
        return Push(
            vertices=square,
            poses=np.zeros((1, 3)),
            waypoints=np.array([[[[x, 0.0]], [[x - 1e-3, 0.0]]]]),
            times=np.array([[0.0, 1.0]]),
            friction=np.array([[0.3]]),
            support=Film.ratio(1e-3),
            shapes=(Round(4.75e-3),),
            effects=Effects({"part_geometry": {"x_um": 210.0}}),
            step=100 * UM,
        )

    push(touching)
    with pytest.raises(ValueError, match="inside the part"):
        push(touching - 20 * UM)
