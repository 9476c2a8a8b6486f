"""The wrench of the bases, against closed forms of a part that nothing touches."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from meso_robust.simulator import Effects, Film, Outcome, Push, Round, simulate
from meso_robust.simulator.residual import BASES, RESIDUAL, RESIDUAL_SLOTS
from tests.simulator.problems import RHO, UM, rectangle

TIME = 4.0


def end(values: dict[str, Any], pose: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> np.ndarray:
    """Where a free part is after `TIME` (µm and rad)."""
    far = np.full((1, 2, 1, 2), 0.05)
    push = Push(
        vertices=rectangle(),
        poses=np.array([pose]),
        waypoints=far,
        times=np.array([[0.0, TIME]]),
        friction=np.array([[0.3]]),
        support=Film.ratio(RHO),
        shapes=(Round(15 * UM),),
        effects=Effects(values),
        step=1e-6,
        time_step=TIME / 2000,
    )
    found = simulate(push)
    assert found.outcomes[0] == Outcome.COMPLETED
    return np.asarray(found.poses[0]) / [UM, UM, 1.0]


def test_every_base_has_a_column_and_moves_the_part() -> None:
    assert len(BASES) == len(RESIDUAL_SLOTS) == 30
    # moving and turning; the heading is none at which a harmonic has a zero
    push = {"body_force": {"x_um_s": 9.0, "y_um_s": 3.0}}
    turn = {"torque_um2_s": 0.3e5}
    plain = end({**push, "residual": turn}, (300 * UM, 200 * UM, 0.4))
    for key in BASES:
        parameter = next(one for one in RESIDUAL.effects[0].parameters if one.key == key)
        size = {"": 0.1, "µm": 40.0, "µm/s": 1.0, "1/s": 0.01, "µm/s²": 0.5, "µm²/s": 1e4}
        more = turn.get(key, 0.0) + size[parameter.unit]
        moved = end({**push, "residual": {**turn, key: more}}, (300 * UM, 200 * UM, 0.4))
        assert np.abs((moved - plain) * [1, 1, 500]).max() > 0.05, key


def test_constant_forces_are_those_of_a_tilted_stage_or_go_with_the_part() -> None:
    got = end({"residual": {"force_x_um_s": 4.0, "force_y_um_s": -3.0}}, (0.0, 0.0, 0.7))
    assert got == pytest.approx([16.0, -12.0, 0.7], abs=1e-9)
    got = end({"residual": {"part_force_x_um_s": 5.0}}, (0.0, 0.0, 0.7))
    assert got == pytest.approx([20 * np.cos(0.7), 20 * np.sin(0.7), 0.7], abs=1e-9)
    torque = 3e4
    assert end({"residual": {"torque_um2_s": torque}})[2] == pytest.approx(
        torque * UM**2 * TIME / RHO, rel=1e-9
    )


def test_forces_by_place_and_time_integrate_to_their_closed_forms() -> None:
    got = end({"residual": {"force_x_along_x_per_s": 0.1}}, (100 * UM, 50 * UM, 0.0))
    assert got == pytest.approx([100 * np.exp(0.1 * TIME), 50.0, 0.0], rel=1e-3)
    got = end({"residual": {"force_x_along_y_per_s": 0.1}}, (100 * UM, 50 * UM, 0.0))
    assert got == pytest.approx([100 + 0.1 * TIME * 50, 50.0, 0.0], rel=1e-9)
    got = end({"residual": {"force_y_along_x_per_s": -0.1}}, (100 * UM, 50 * UM, 0.0))
    assert got == pytest.approx([100.0, 50 - 0.1 * TIME * 100, 0.0], rel=1e-9)
    got = end({"residual": {"force_y_um_s2": 2.0}})
    assert got == pytest.approx([0.0, 0.5 * 2.0 * TIME**2, 0.0], rel=1e-3)


@pytest.mark.parametrize("heading", [0.3, 1.9, -2.4])
def test_forces_across_the_motion_turn_it_by_their_share(heading: float) -> None:
    """With a force f: v = f + c J v, so that v leads f by atan c; c is that at the heading of v."""
    f = 5.0
    for key, wave in (
        ("across", lambda a: 1.0),
        ("across_cos1", np.cos),
        ("across_sin2", lambda a: np.sin(2 * a)),
        ("across_cos4", lambda a: np.cos(4 * a)),
        ("across_sin4", lambda a: np.sin(4 * a)),
    ):
        x, y, _ = end(
            {
                "body_force": {"x_um_s": f * np.cos(heading), "y_um_s": f * np.sin(heading)},
                "residual": {key: 0.2},
            }
        )
        # the rest of the way after the first steps, which have no motion to follow, is straight
        way = np.arctan2(y, x)
        assert np.tan(way - heading) == pytest.approx(0.2 * wave(way), abs=1e-3), key
        own = end(
            {
                "body_force": {"x_um_s": f * np.cos(heading), "y_um_s": f * np.sin(heading)},
                "residual": {f"part_{key}": 0.2},
            },
            (0.0, 0.0, 0.5),
        ) if key != "across" else None  # fmt: skip
        if own is not None:
            way = np.arctan2(own[1], own[0])
            assert np.tan(way - heading) == pytest.approx(0.2 * wave(way - 0.5), abs=1e-3), key


def test_torques_follow_speed_and_heading_and_turning_has_a_drag_of_its_own() -> None:
    lever, ratio = 30.0, RHO / UM**2
    got = end({"body_force": {"y_um_s": 5.0}, "residual": {"torque_um": lever}})
    assert got[2] == pytest.approx(5.0 * lever / ratio * TIME, rel=2e-3)
    # the heading in the part falls as it turns: θ' = a sin(90° − θ) = a cos θ
    got = end({"body_force": {"y_um_s": 5.0}, "residual": {"torque_sin1_um": lever}})
    gd = 2.0 * np.arctan(np.tanh(0.5 * 5.0 * lever / ratio * TIME))
    assert got[2] == pytest.approx(gd, rel=2e-3)
    # pure turning: ω (1 + s) = τ / ρ
    got = end({"residual": {"torque_um2_s": 3e4, "spin": 0.25}})
    assert got[2] == pytest.approx(3e4 / ratio / 1.25 * TIME, rel=1e-3)
    # far more sliding than turning: no part in it
    got = end({"body_force": {"x_um_s": 500.0}, "residual": {"torque_um2_s": 300.0, "spin": 0.25}})
    assert got[2] == pytest.approx(300.0 / ratio * TIME, rel=1e-3)


def test_a_part_at_rest_is_left_alone_by_what_follows_the_motion() -> None:
    following = {key: 0.3 for key in BASES if key.startswith(("across", "part_across", "spin"))}
    assert end({"residual": following | {"torque_um": 50.0}}) == pytest.approx([0, 0, 0], abs=0)


def test_every_base_acts_in_time_by_itself() -> None:
    """A step is then as short as `time_step` asks, though no tip moves."""
    far = np.full((1, 2, 1, 2), 0.05)
    for key in BASES:
        push = Push(
            vertices=rectangle(),
            poses=np.zeros((1, 3)),
            waypoints=far,
            times=np.array([[0.0, TIME]]),
            friction=np.array([[0.3]]),
            support=Film.ratio(RHO),
            shapes=(Round(15 * UM),),
            effects=Effects({"residual": {key: 1e-3}}),
            step=1e-6,
            time_step=TIME / 20,
        )
        assert push.steps == 20, key
