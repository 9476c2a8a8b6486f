"""The push that all simulators are given, and its converged solution by SciPy.

A box of 3 × 1.5 × 0.3 mm lies in the plane with its long side along x and is pushed 1 mm along +y by a
round tip of 50 µm, 0.3 mm beside the centre, μ = 0.3. Units at the edge are mm and degrees.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from meso_robust.simulator import Film, PressurePoints, Push, Round, ThreePoints
from meso_robust.simulator.support_models import Support

F = npt.NDArray[np.float64]

MM = 1e-3
HALF_LONG, HALF_SHORT, HALF_HIGH = 1.5, 0.75, 0.15
OFFSET, RADIUS, TRAVEL, MU = 0.3, 0.05, 1.0, 0.3
"""mm, and the friction between tip and box."""
OUTPUTS = 200
BOX = np.array(
    [[-HALF_LONG, -HALF_SHORT], [HALF_LONG, -HALF_SHORT], [HALF_LONG, HALF_SHORT],
     [-HALF_LONG, HALF_SHORT]]
)  # fmt: skip
FEET = np.array([[-1.2, -0.6], [1.2, -0.6], [0.0, 0.6]])
"""mm; a quarter, a quarter and half of the weight."""
TIP = np.array([OFFSET, -HALF_SHORT - RADIUS])
"""Centre of the tip at the start, mm."""
FILM_RATIO = ((2 * HALF_LONG) ** 2 + (2 * HALF_SHORT) ** 2) / 12
"""mm²; of a uniform film under the box."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ground:
    """What the box stands on."""

    name: str
    support: Support
    points: F
    """(K, 2) in mm; none for a film."""
    shares: F
    """(K,) of the weight."""

    def resistance(self, v: F) -> F:
        """Wrench (N or any unit, mm) that a twist (mm/s, mm/s, rad/s) needs, body axes."""
        if not len(self.points):
            return v * [1.0, 1.0, FILM_RATIO]
        x, y = self.points.T
        u = np.stack([v[0] - v[2] * y, v[1] + v[2] * x])
        fx, fy = self.shares * u / np.hypot(*u)
        return np.array([fx.sum(), fy.sum(), (x * fy - y * fx).sum()])


def grounds() -> tuple[Ground, Ground, Ground]:
    """Uniform load on four corners, three supports, and a uniform film."""
    even = np.full(4, 0.25)
    four = PressurePoints(points=BOX * MM, shares=even)
    three = ThreePoints(points=FEET * MM)
    film = Film.ratio(FILM_RATIO * MM**2)
    none = np.zeros((0, 2))
    return (
        Ground(name="four corners", support=four, points=BOX, shares=even),
        Ground(name="three points", support=three, points=FEET, shares=np.array([0.25, 0.25, 0.5])),
        Ground(name="film", support=film, points=none, shares=np.zeros(0)),
    )


def push(ground: Ground, steps: int, runs: int = 1) -> Push:
    """The push for the time stepper."""
    return Push.straight(
        vertices=BOX * MM,
        poses=np.zeros((runs, 3)),
        tips=np.tile(TIP * MM, (runs, 1, 1)),
        travel=np.tile([0.0, TRAVEL * MM], (runs, 1, 1)),
        friction=np.full(runs, MU),
        shapes=(Round(RADIUS * MM),),
        support=ground.support,
        step=TRAVEL * MM / steps,
        speed=TRAVEL * MM,
    )


def converged(ground: Ground) -> F:
    """Pose (x, y in mm, θ in deg) at the end, by root finding and Runge-Kutta steps of high order.

    The tip sticks. Of all twists that carry the point of contact along with the tip, the one that
    happens dissipates least: the turning rate at which the resistance has no moment about the point
    of contact. That the force stays inside the cone of friction is checked at every instant.

    Raises
    ------
    RuntimeError
        If the tip slips.
    """
    from scipy.integrate import solve_ivp

    resist = ground.resistance

    def rate(travel: float, pose: F) -> F:
        turn = np.array([[np.cos(pose[2]), -np.sin(pose[2])], [np.sin(pose[2]), np.cos(pose[2])]])
        along = float((turn.T @ (TIP + np.array([0.0, travel]) - pose[:2]))[0])
        twist = _sticking(resist, np.array([along, -HALF_SHORT]), turn.T @ [0.0, 1.0])
        force = resist(twist)
        if not abs(force[0]) <= MU * force[1]:
            raise RuntimeError(f"the tip slips after {travel} mm; the solution is for sticking")
        return np.append(turn @ twist[:2], twist[2])

    solution = solve_ivp(rate, (0.0, TRAVEL), np.zeros(3), method="DOP853", rtol=1e-11, atol=1e-12)
    x, y, theta = solution.y[:, -1]
    return np.array([x, y, np.degrees(theta)])


def _sticking(resist: Callable[[F], F], at: F, velocity: F) -> F:
    """Twist in body axes with the least dissipation, given the velocity of one point."""
    from scipy.optimize import brentq

    def twist(turning: float) -> F:
        vx, vy = velocity[0] + turning * at[1], velocity[1] - turning * at[0]
        return np.array([vx, vy, turning])

    def moment(turning: float) -> float:
        wrench = resist(twist(turning))
        return float(wrench[2] - at[0] * wrench[1] + at[1] * wrench[0])

    return twist(brentq(moment, -10.0, 10.0, xtol=1e-13, rtol=1e-14))


def errors(pose: F, exact: F) -> tuple[float, float]:
    """Errors of position (over the way of the centre) and of rotation (over the rotation), %."""
    way = np.hypot(exact[0], exact[1])
    position = np.hypot(pose[0] - exact[0], pose[1] - exact[1]) / way
    return float(100 * position), float(100 * abs(pose[2] / exact[2] - 1.0))
