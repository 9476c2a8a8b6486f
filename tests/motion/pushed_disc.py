"""A part that a disc pushes, from Newton's third law and Coulomb's law: nothing of the package.

The drag is a matrix in the axes of the pushed edge about the centre of drag; the disc does not turn,
its contact is the point of the edge's line that is nearest to its centre.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from meso_robust.types import Floats

Values = Mapping[str, float]
DOWNHILL = 1e-13


def edge(v: Values, theta: float) -> tuple[Floats, Floats]:
    """Along the edge and out of the part, at this orientation of the part."""
    angle = theta - v["turn"] + v["kappa"]
    return np.array([np.cos(angle), np.sin(angle)]), np.array([np.sin(angle), -np.cos(angle)])


def tips(v: Values, wander: str = "") -> dict[int, Floats]:
    """Centres of both tips before they travel, in the world."""
    place = []
    for axis in "xy":
        base = v[axis] + v[f"sensed_{axis}"] if v[f"part_{axis}"] else 0.0
        place.append(base + v[f"offset_{axis}"] + v[f"probe_{axis}"] + v[f"wander_{axis}{wander}"])
    half = 0.5 * v["spacing"] * np.array([-np.tan(v["beta"]), 1.0])
    return {1: np.array(place) + half, -1: np.array(place) - half}


def travel(v: Values) -> tuple[float, Floats]:
    """Length and direction of the whole travel."""
    sensed = v["x"] + v["sensed_x"]
    start = v["offset_x"] + (sensed if v["part_x"] else 0.0)
    end = v["offset_end"] + (sensed if v["part_end"] else 0.0)
    phi = v["direction"]
    return (start - end) * (1.0 + v["scale"]), -np.array([np.cos(phi), np.sin(phi)])


def radius(v: Values, tip: int) -> float:
    return v["radius_upper" if tip > 0 else "radius_lower"]


def off_line(v: Values, pose: Floats, tip: int, place: Floats) -> float:
    """Distance of a disc from the line of the pushed edge."""
    _, out = edge(v, pose[2])
    return float(out @ (place - pose[:2]) - v["depth"] - radius(v, tip))


def touch(v: Values, tip: int) -> float:
    """Travel until the disc touches the line, found by its distance from it."""
    _, way = travel(v)
    start, pose = tips(v)[tip], np.array([v["x"], v["y"], v["theta"]])
    return brentq(lambda xi: off_line(v, pose, tip, start + xi * way), -1e-2, 1e-2, xtol=1e-16)


def contact(v: Values, pose: Floats, tip: int, place: Floats) -> tuple[Floats, float]:
    """Where the disc touches, and how far that is along the edge from the foot of the reference."""
    along, out = edge(v, pose[2])
    at = place - radius(v, tip) * out
    return at, float(along @ (at - pose[:2]))


def balance(
    v: Values, pose: Floats, tip: int, place: Floats, now: str = "", slip: float = 0.0
) -> tuple[Floats, Floats]:
    """Twist of the part per progress of the disc, and the force on it, (along, inward).

    The part's point under the disc moves by ``slip`` along the edge over it: 0 if it sticks.
    """
    along, out = edge(v, pose[2])
    at, _ = contact(v, pose, tip, place)
    centre = pose[:2] + v["drag_a"] * along + v["drag_n"] * out
    stretch, shear, rho, bend = (v[key + now] for key in ("stretch", "shear", "rho", "bend"))
    phi = v["direction"]
    speed = -np.array([np.cos(phi) - bend * np.sin(phi), np.sin(phi) + bend * np.cos(phi)])
    speed = speed + slip * along
    axes = np.stack([along, out], axis=1)
    drag = axes @ np.array([[1.0 + stretch, shear], [shear, 1.0 - stretch]]) @ axes.T

    def turned(omega: float, arm: Floats) -> Floats:
        return omega * np.array([-arm[1], arm[0]])

    # unknown: velocity of the centre of drag, turn, force at the contact
    matrix, known = np.zeros((5, 5)), np.zeros(5)
    arm = at - centre
    matrix[0:2, 0:2], matrix[0:2, 2], known[0:2] = np.eye(2), turned(1.0, arm), speed
    matrix[2:4, 0:2], matrix[2:4, 3:5] = drag, -np.eye(2)
    matrix[4, 2], matrix[4, 3:5] = rho, [arm[1], -arm[0]]
    u, w, omega, *force = np.linalg.solve(matrix, known)
    reference = np.array([u, w]) + turned(omega, pose[:2] - centre)
    return np.array([*reference, omega]), np.array([along @ force, -(out @ force)])


def turn(
    v: Values, tip: int, last: float, stop: Callable[[Floats, Floats], float] | None = None
) -> tuple[Floats, Floats, float]:
    """The part after the disc has progressed from the touch to ``last``: pose, disc, progress.

    With ``stop`` (of pose and disc) it ends earlier, where that vanishes.
    """
    _, way = travel(v)
    first, start = touch(v, tip), tips(v)[tip]
    phi = v["direction"]
    bent = way + v["bend"] * np.array([np.sin(phi), -np.cos(phi)])

    def disc(progress: float) -> Floats:
        return start + first * way + progress * bent

    def rate(progress: float, pose: Floats) -> Floats:
        return balance(v, pose, tip, disc(progress))[0]

    def event(progress: float, pose: Floats) -> float:
        return 1.0 if stop is None else stop(pose, disc(progress))

    event.terminal = True  # type: ignore[attr-defined]
    found = solve_ivp(
        rate,
        (0.0, last - first),
        np.array([v["x"], v["y"], v["theta"]]),
        method="DOP853",
        rtol=1e-12,
        atol=1e-15,
        events=event,
    )
    progress = float(found.t[-1])
    return found.y[:, -1], disc(progress), progress
