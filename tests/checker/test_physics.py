"""The checker's formulas against first principles: balances solved as linear systems, integrals."""

from __future__ import annotations

import math

import numpy as np
import pytest
from flint import acb, arb, ctx
from scipy.integrate import solve_ivp

from meso_robust.checker.contact import Contact, Turning
from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.film import Arm, Film
from meso_robust.checker.ranges import least, positive, span

D1, RHO = 0.4185, 0.3769  # mm, mm^2


def contact(theta: float, d2: float) -> Contact:
    return Contact(Dual(arb(math.cos(theta))), Dual(arb(math.sin(theta))), arb(D1), Dual(arb(d2)))


def frame(theta: float) -> tuple[np.ndarray, np.ndarray]:
    c, s = math.cos(theta), math.sin(theta)
    return np.array([c, s]), np.array([s, -c])


def column(force: np.ndarray, arm: np.ndarray) -> np.ndarray:
    """Twist of the film (drag 1, 1, rho) under a force at an arm."""
    return np.array([force[0], force[1], (arm[0] * force[1] - arm[1] * force[0]) / RHO])


def speed(twist: np.ndarray, arm: np.ndarray) -> np.ndarray:
    return np.array([twist[0] - twist[2] * arm[1], twist[1] + twist[2] * arm[0]])


@pytest.mark.parametrize(("theta", "d2"), [(1.6, 0.33), (1.3, -0.2), (1.9, 0.1)])
def test_sticking_forces_solve_the_balance(theta: float, d2: float) -> None:
    a, n = frame(theta)
    arm = d2 * a + D1 * n
    columns = np.array([column(-n, arm), column(a, arm)]).T
    speeds = np.array([speed(columns[:, k], arm) for k in (0, 1)]).T
    press, shear = np.linalg.solve(speeds, [-1.0, 0.0]) * (RHO + arm @ arm)
    at, found = contact(theta, d2), Arm.of(arb(D1), Dual(arb(d2)), Film(arb(RHO)))
    assert float(found.press(at.c, at.s).value) == pytest.approx(press, rel=1e-12)
    assert float(found.shear(at.c, at.s).value) == pytest.approx(shear, rel=1e-12)


@pytest.mark.parametrize("side", [1, -1])
def test_the_travel_of_a_turn_is_the_integral_of_its_rate(side: int) -> None:
    d2, start, turn = side * 0.33, 1.55, side * 0.1
    turning = Turning(contact(start, d2), Dual(arb(start)), side, Film(arb(RHO)))
    needed = turning.needed(Dual(arb(turn))).value
    factor = arb(RHO) + arb(d2) ** 2 + arb(D1) ** 2
    with ctx.workprec(80):
        integral = acb.integral(
            lambda t, _: 1 / (acb(d2) * t.sin() - acb(D1) * t.cos()), acb(start), acb(start + turn)
        ).real
    assert float(needed) == pytest.approx(float(factor * integral), rel=1e-10)
    turned, arm_x, arm_y = turning.contact_after(needed)
    assert float(turned.value) == pytest.approx(turn, abs=1e-12)
    last = contact(start + turn, d2)
    assert float(arm_x.value) == pytest.approx(float(last.arm_x.value), abs=1e-12)
    assert float(arm_y.value) == pytest.approx(float(last.arm_y.value), abs=1e-12)


def test_bounds_of_a_formula_hold_what_it_takes() -> None:
    box = {"x": (arb(-1), arb(2)), "y": (arb("0.1"), arb(1))}

    def of(at: Point) -> Dual:
        s, c = at["x"].sin_cos()
        return s * at["y"] + (at["x"].squared() - c) / at["y"]

    low, high = (float(end) for end in span(of, box, within=1e-6))
    x, y = np.meshgrid(np.linspace(-1, 2, 400), np.linspace(0.1, 1, 400))
    values = np.sin(x) * y + (x**2 - np.cos(x)) / y
    assert low <= values.min() <= low + 1e-3
    assert high - 1e-3 <= values.max() <= high
    assert not positive(of, box)


def test_a_division_by_zero_proves_nothing() -> None:
    box = {"x": (arb(-1), arb(1))}
    assert not positive(lambda at: 1 / at["x"].squared() + 1 / at["x"], box)
    assert not least(lambda at: 1 / at["x"], box).is_finite()


def test_the_touch_of_a_slipping_part_lies_in_its_enclosure() -> None:
    """A slipping push until a gap is closed, integrated in time, against rates per closed gap."""
    d2, theta, gap, place, k = 0.64, 1.57, 0.02, -0.27, -0.33

    def rates(_: float, y: np.ndarray) -> list[float]:
        angle, at, left, p = y
        a, n = frame(angle)
        lever = at + D1 * k
        force = RHO * math.sin(angle) / (RHO + at * lever)
        omega = force * lever / RHO
        centre = force * (k * a - n)
        closing = -(speed(np.array([*centre, omega]), p * a - (D1 + left) * n) @ n)
        own = np.array([-1.0, 0.0]) - centre - omega * np.array([-D1 * n[1], D1 * n[0]])
        return [omega, own @ a, -closing, -(centre @ a) - omega * -(D1 + left)]

    run = solve_ivp(
        rates, (0, 0.2), [theta, d2, gap, place], rtol=1e-10, atol=1e-12, dense_output=True,
        events=lambda _, y: y[2],
    )  # fmt: skip
    end = run.y_events[0][0]
    lever = np.array([d2, end[1]]) + D1 * k
    per_gap = lever / (RHO + np.array([place, end[3]]) * lever)
    turned = end[0] - theta
    assert min(per_gap) * gap - 1e-4 <= turned <= max(per_gap) * gap + 1e-4
