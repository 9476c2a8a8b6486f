"""Inertia: limits, closed forms and orders of convergence."""

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from scipy.integrate import solve_ivp

from meso_robust.simulator import (
    Dynamic,
    Effects,
    Film,
    FirstOrder,
    Outcome,
    Push,
    PushResult,
    QuasiStatic,
    simulate,
)
from reports.simulator import inertia
from tests.simulator.problems import HALF_LONG, HALF_SHORT, MU, RHO, UM, rectangle

F = npt.NDArray[np.float64]

GYRATION = (HALF_LONG**2 + HALF_SHORT**2) / 3  # m², moment of inertia over mass
SPEED = 75 * UM


def pushed(x: float, way: list[float], times: list[float], motion: Any, **rest: Any) -> Push:
    """A sharp tip at x on the lower edge, its y given in m from the edge; θ from 0."""
    points = np.array([[[x, -HALF_SHORT + y]] for y in way])[None]
    given: dict[str, Any] = {
        "poses": np.zeros((1, 3)),
        "friction": np.array([[MU]]),
        "support": Film.ratio(RHO),
        "step": 1 * UM,
    } | rest
    return Push(
        vertices=rectangle(),
        waypoints=points,
        times=np.array([times]),
        motion=motion,
        **given,
    )


def run(push: Push, instants: list[float] | None = None) -> PushResult:
    at = None if instants is None else np.array([instants])
    result = simulate(push, instants=at)
    assert (result.outcomes == Outcome.COMPLETED).all()
    return result


def away(one: F, other: F) -> float:
    return float(np.abs((one - other) * [1, 1, 1e-3]).max())


def eccentric(motion: Any, **rest: Any) -> Push:
    return pushed(250 * UM, [0.0, 300 * UM], [0.0, 4.0], motion, **rest)


def test_tiny_mass_is_quasi_static() -> None:
    still = run(eccentric(QuasiStatic(), time_step=1e3)).poses
    distances = [
        away(run(eccentric(Dynamic(mass=m, inertia=m * GYRATION), time_step=1e3)).poses, still)
        for m in (1e-3, 1e-4, 1e-9)
    ]
    assert distances[2] < 1e-12
    # The difference goes with the mass.
    assert distances[1] == pytest.approx(0.1 * distances[0], rel=0.05)


@pytest.mark.parametrize("dt", [0.2, 0.02])
def test_part_coasts_by_speed_times_time_constant(dt: float) -> None:
    # After the tip stops x = v m (1 − exp(−t/m)); of implicit steps the sum is v m for any length.
    m = 0.7
    push = pushed(
        0.0, [0.0, 150 * UM, 150 * UM], [0.0, 2.0, 30.0], Dynamic(mass=m, inertia=m * GYRATION),
        time_step=dt,
    )  # fmt: skip
    end = run(push).poses[0]
    np.testing.assert_allclose(end, [0.0, 150 * UM + SPEED * m, 0.0], atol=1e-13)


def test_coasting_decays_exponentially_at_first_order() -> None:
    m, t = 0.7, np.array([2.3, 2.7, 3.4])
    exact = 150 * UM + SPEED * m * (1 - np.exp(-(t - 2.0) / m))
    errors = []
    for dt in (0.02, 0.01, 0.005):
        push = pushed(
            0.0, [0.0, 150 * UM, 150 * UM], [0.0, 2.0, 6.0], Dynamic(mass=m, inertia=m * GYRATION),
            time_step=dt,
        )  # fmt: skip
        errors.append(np.abs(run(push, [*t]).path[0, :, 1] - exact).max())
    assert errors[0] < 0.5 * UM
    assert errors[0] / errors[1] == pytest.approx(2.0, abs=0.1)
    assert errors[1] / errors[2] == pytest.approx(2.0, abs=0.1)


def test_spinning_part_slows_down_by_its_own_time_constant() -> None:
    # A push far off the centre leaves a turn, which decays with I / e_θ, and a slide, with m.
    m, inertia_of_part = 0.5, 0.8 * RHO
    motion = Dynamic(mass=m, inertia=inertia_of_part)
    push = pushed(
        600 * UM, [0.0, 60 * UM, -400 * UM], [0.0, 0.8, 0.81], motion,
        time_step=1e-3, friction=np.array([[0.0]]), step=20 * UM,
    )  # fmt: skip
    result = simulate(
        replace(push, waypoints=np.concatenate([push.waypoints, push.waypoints[:, -1:]], axis=1),
                times=np.array([[0.0, 0.8, 0.81, 3.0]])),
        instants=np.array([[0.9, 1.3, 1.7, 2.1]]),
    )  # fmt: skip
    turn, way = np.diff(result.path[0, :, 2]), np.diff(result.path[0, :, :2], axis=0)
    np.testing.assert_allclose(turn[1:] / turn[:-1], np.exp(-0.4 / 0.8), rtol=2e-3)
    slide = np.hypot(way[:, 0], way[:, 1])
    np.testing.assert_allclose(slide[1:] / slide[:-1], np.exp(-0.4 / m), rtol=2e-3)
    assert abs(turn[0]) > 1e-3


def accelerated(m: float, moment: float, x: float, travel: float, time: float) -> F:
    """Pose by `solve_ivp` of a part under a frictionless tip at x that goes up at a constant speed."""
    v = travel / time

    def law(t: float, z: F) -> F:
        px, vx, py, vy, theta, w = z
        # Normal inward n = (−sin, cos); the tip at (x, −h + v t) on the edge: gap rate zero.
        n = np.array([-np.sin(theta), np.cos(theta)])
        nd = -w * np.array([np.cos(theta), np.sin(theta)])
        arm = np.array([x - px, -HALF_SHORT + v * t - py])
        rate = np.array([-vx, v - vy])
        # The tip stays on the edge, n · arm = −h; its second derivative gives the force.
        lever = arm[0] * n[1] - arm[1] * n[0]
        ndd = -w * w * n
        free = np.array([-vx / m, -vy / m])
        alpha0 = -RHO * w / moment
        # d²/dt² (n · arm) = n̈·arm + 2 ṅ·rate − n·a, with n̈ = ndd + alpha (−cos, −sin).
        t_dir = np.array([-np.cos(theta), -np.sin(theta)])
        known = ndd @ arm + 2 * nd @ rate - n @ free + alpha0 * (t_dir @ arm)
        per_force = -1.0 / m + lever / moment * (t_dir @ arm)
        force = max(-known / per_force, 0.0)
        ax, ay = free + force * n / m
        return np.array([vx, ax, vy, ay, w, alpha0 + force * lever / moment])

    # The impact: the tip's speed is imposed at once, by an impulse along the normal.
    gain = 1.0 / m + x * x / moment
    impulse = v / gain
    start = [0.0, 0.0, 0.0, impulse / m, 0.0, impulse * x / moment]
    end = solve_ivp(law, (0, time), start, rtol=1e-10, atol=1e-13).y[:, -1]
    return np.array([end[0], end[2], end[4]])


def test_frictionless_push_converges_to_newton_and_euler_at_first_order() -> None:
    m, x = 0.4, 200 * UM
    moment = m * GYRATION
    exact = accelerated(m, moment, x, 200 * UM, 2.0)
    errors = []
    for step in (1 * UM, 0.5 * UM, 0.25 * UM):
        push = pushed(
            x, [0.0, 200 * UM], [0.0, 2.0], Dynamic(mass=m, inertia=moment),
            step=step, time_step=1e3, friction=np.array([[0.0]]),
        )  # fmt: skip
        errors.append(away(run(push).poses[0], exact))
    assert errors[0] < 0.5 * UM
    assert errors[0] / errors[1] == pytest.approx(2.0, abs=0.25)
    assert errors[1] / errors[2] == pytest.approx(2.0, abs=0.25)
    # And inertia is felt: a massless part ends elsewhere.
    massless = replace(push, motion=QuasiStatic())
    assert away(run(massless).poses[0], exact) > 20 * errors[2]


def test_first_order_motion_is_that_of_a_film_with_the_part_s_gyration() -> None:
    # Least kinetic energy and least dissipation are one problem, with ρ = I / m.
    push = eccentric(FirstOrder(mass=3.0, inertia=3.0 * GYRATION))
    other = eccentric(QuasiStatic(), support=Film.ratio(GYRATION), time_step=push.time_step)
    assert away(run(push).poses, run(other).poses) < 1e-12
    assert away(run(push).poses, run(eccentric(QuasiStatic())).poses) > 1 * UM


def test_first_order_motion_by_closed_form() -> None:
    # One short step of a sticking tip: ω = v a / (k² + |p|²) for a tip at p = (a, −h), v upwards.
    a, h = 350 * UM, 1e-9
    motion = FirstOrder(mass=1.0, inertia=GYRATION)
    push = pushed(a, [0.0, h], [0.0, 1.0], motion, friction=np.array([[50.0]]), step=h, time_step=9)
    omega = a / (GYRATION + a * a + HALF_SHORT**2)
    wanted = np.array([-omega * HALF_SHORT, 1.0 - omega * a, omega])
    np.testing.assert_allclose(run(push).poses[0] / h, wanted, rtol=1e-6)


def test_first_order_motion_has_no_scale_and_no_memory() -> None:
    light, heavy = (
        run(eccentric(FirstOrder(mass=m, inertia=m * GYRATION))).poses for m in (1e-3, 7.0)
    )
    assert away(light, heavy) < 1e-12
    stopped = pushed(
        0.0, [0.0, 50 * UM, 50 * UM], [0.0, 1.0, 3.0], FirstOrder(mass=1.0, inertia=GYRATION)
    )
    np.testing.assert_allclose(run(stopped).poses[0], [0.0, 50 * UM, 0.0], atol=1e-14)


def test_force_accelerates_a_free_part() -> None:
    # v = b (1 − exp(−t/m)), so x = b (t − m (1 − exp(−t/m))).
    m = 0.9
    far = np.full((1, 2, 1, 2), 0.05)
    push = replace(
        eccentric(Dynamic(mass=m, inertia=m * GYRATION), time_step=5e-4),
        waypoints=far,
        effects=Effects({"body_force": {"x_um_s": 6.0, "y_um_s": 8.0}}),
    )
    end = run(push).poses[0]
    way = 10 * UM * (4.0 - m * (1 - np.exp(-4.0 / m)))
    np.testing.assert_allclose(end, [0.6 * way, 0.8 * way, 0.0], rtol=3e-4, atol=1e-15)


@pytest.mark.parametrize("model", [Dynamic, FirstOrder])
@pytest.mark.parametrize(
    ("mass", "moment", "message"),
    [
        (0.0, 1.0, r"mass: 0.0; must be positive and finite; divide"),
        (1.0, -1.0, r"inertia: -1.0; must be positive"),
        (np.nan, 1.0, r"mass: nan"),
        (1.0, np.inf, r"inertia: inf"),
    ],
)
def test_bad_inertia_is_refused(model: Any, mass: float, moment: float, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        model(mass=mass, inertia=moment)


def test_paper_s_part_has_no_inertia_to_speak_of() -> None:
    # 1616 × 837 × 40 µm of 8250 kg/m³ over 12.8 µN s/mm: 0.446 mg / 0.0128 kg/s.
    assert inertia.time_constant() == pytest.approx(0.44634e-6 / 12.8e-3, rel=1e-4)
    data = inertia.differences(np.array([inertia.time_constant(), 1e-2]), step=2e-6)
    assert data[0] < 0.01 * UM
    assert 1e2 < data[1] / data[0] < 1e3
