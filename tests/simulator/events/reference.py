"""Pushes for the tests, and their motion by another route: SciPy on the equations of balance.

The equations are in the world frame and solved as one linear system for velocity and forces, with
a general quadrature; the engine works in the body frame with bases of wrenches.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.integrate import solve_ivp

from meso_robust.simulator.events import EventResult, integrate

F = npt.NDArray[np.float64]
Contact = tuple[F, F, F, float]
"""Normal of the force on the part, point, velocity of the obstacle (world frame), and the ratio of
tangential (normal turned by −90°) to normal force; NaN for a contact that sticks."""

UM = 1e-6
RHO = 0.3769e-6
MU = 0.33
HALF_LONG = 808 * UM
HALF_SHORT = 418.5 * UM
PLATE = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1.0]]) * [HALF_LONG, HALF_SHORT]
PLAIN = np.diag([1, 1, RHO])
TILTED = np.array([[1.3, 0.2, 0], [0.2, 0.9, 0], [0, 0, RHO]]) + 1e-6 * np.array(
    [[0, 0, 90], [0, 0, -60], [90, -60, 0]]
)
"""A drag whose centre is not the reference point and which is not the same in all directions."""


def push(
    tips: object, travel: object, pose: object = (0, 0, np.pi / 2), mu: float | F = MU, **more: Any
) -> EventResult:
    """Push the plate (if there are no other vertices), once, with tips and travel in um."""
    tips_m = UM * np.array(tips, dtype=np.float64)[None]
    arguments = {"vertices": PLATE, "drag": PLAIN, **more}
    return integrate(
        poses=np.array(pose, dtype=np.float64)[None],
        tips=tips_m,
        travel=UM * np.array(travel, dtype=np.float64)[None],
        friction=np.full(tips_m.shape[:2], mu),
        **arguments,
    )


def turn(angle: float) -> F:
    """Rotation from the body to the world."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def cross(a: F, b: F) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def velocity(pose: F, drag: F, contacts: list[Contact]) -> tuple[F, F]:
    """Velocity of the part and normal and tangential force of each contact, world frame."""
    stretch = np.diag([1, 1, 1e-3])  # millimetres, for the conditioning
    spin = np.eye(3)
    spin[:2, :2] = turn(pose[2])
    world = spin @ drag @ spin.T
    count = len(contacts)
    system = np.zeros((3 + 2 * count, 3 + 2 * count))
    right = np.zeros(3 + 2 * count)
    system[:3, :3] = stretch @ world @ stretch
    for k, (normal, point, speed, ratio) in enumerate(contacts):
        tangent = np.array([normal[1], -normal[0]])
        arm = point - pose[:2]
        rows = np.array([[*axis, cross(arm, axis)] for axis in (normal, tangent)]) @ stretch
        at = 3 + 2 * k
        system[:3, at : at + 2] = -rows.T
        system[at, :3] = rows[0]
        right[at] = normal @ speed
        if np.isnan(ratio):
            system[at + 1, :3] = rows[1]
            right[at + 1] = tangent @ speed
        else:
            system[at + 1, at : at + 2] = [-ratio, 1]
    found = np.linalg.solve(system, right)
    return np.asarray(stretch @ found[:3]), np.asarray(found[3:].reshape(count, 2))


def follow(
    pose: object, drag: F, contacts: Callable[[F, float], list[Contact]], until: float = 1.0
) -> Any:
    """Solution of SciPy for given contacts, in millimetres and radians."""
    unit = np.array([1e-3, 1e-3, 1.0])

    def rate(s: float, y: F) -> F:
        return velocity(y * unit, drag, contacts(y * unit, s))[0] / unit

    start = np.array(pose, dtype=np.float64) / unit
    return solve_ivp(
        rate, (0, until), start, "DOP853", rtol=1e-12, atol=1e-13, dense_output=True
    ).sol


def end_of(solution: Any, s: float = 1.0) -> F:
    """Pose in m and rad."""
    return np.asarray(solution(s) * [1e-3, 1e-3, 1.0])


def assert_same(pose: F, expected: F, travel: float, part: float = 1e-9) -> None:
    """Agree to a part of the travel, and the angle to that."""
    np.testing.assert_allclose(pose[..., :2], expected[..., :2], rtol=0, atol=part * travel)
    np.testing.assert_allclose(pose[..., 2], expected[..., 2], rtol=0, atol=part)
