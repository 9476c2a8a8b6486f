"""One push of a real probe on a real part, in floating point: nothing but geometry and balance.

A tip is a disc that the probe holds. While one touches the pushed edge it sticks: the part's point
under it moves as the tip does, and the film's drag on the part balances the one force there. Where
the contact is follows from where tip and edge are at each instant; nothing here knows that it rolls.
All in the axes of the move, m and rad.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

Vector = np.ndarray[Any, np.dtype[np.float64]]
Values = dict[str, float]
SIDES = {1: "upper", -1: "lower"}


@dataclass
class Instant:
    """What acts at an instant while one tip pushes."""

    theta: float
    """Direction of the edge, axes of the move."""
    path: Vector
    """Of the tip, per unit of commanded travel."""
    d2: float
    press: float
    shear: float
    turn: float
    film: Vector


@dataclass
class Push:
    """A push with one value of everything, some of it changing on the way."""

    values: Values
    start: Vector
    """Middle of the two tips as commanded."""
    travel: float
    """As commanded, along -x."""
    stray: Callable[[float], Vector] = lambda _: np.zeros(2)
    film: Callable[[float], Vector] | None = None
    """``(stretch, shear, rho)`` and where the centre of drag is from its fixed place, along and out of the
    edge, at a share of the travel."""
    instants: list[Instant] = field(default_factory=list)

    @property
    def length(self) -> float:
        return self.travel * (1.0 + self.values["scale"])

    def tip(self, side: int, way: float) -> Vector:
        """Centre of a tip after a way along the straight line."""
        v = self.values
        lean = np.array([-math.tan(v["beta"]), 1.0]) * side * v["spacing"] / 2
        line = np.array([math.cos(v["direction"]), math.sin(v["direction"])])
        error = np.array([v["probe_x"], v["probe_y"]])
        return self.start + error + lean - way * line + self.stray(way / self.length)

    def normal(self, pose: Vector) -> tuple[Vector, Vector]:
        angle = pose[2] + self.values["kappa"]
        a = np.array([math.cos(angle), math.sin(angle)])
        return a, np.array([a[1], -a[0]])

    def off(self, side: int, way: float, pose: Vector) -> float:
        """Distance of a tip's disc from the edge's line."""
        _, n = self.normal(pose)
        out = self.values["depth"] + self.values[f"radius_{SIDES[side]}"]
        return float((self.tip(side, way) - pose[:2]) @ n - out)

    def drag(self, way: float, pose: Vector) -> tuple[Vector, Vector]:
        """Drag as a matrix of world axes and turn about its centre, and that centre."""
        v = self.values
        film = (
            np.array([v[name] for name in ("stretch", "shear", "rho", "centre_a", "centre_n")])
            if self.film is None
            else self.film(way / self.length)
        )
        a, n = self.normal(pose)
        axes = np.column_stack([a, n])
        even = np.array([[1 + film[0], film[1]], [film[1], 1 - film[0]]])
        matrix = np.zeros((3, 3))
        matrix[:2, :2] = axes @ even @ axes.T
        matrix[2, 2] = film[2]
        along, out = v["drag_a"] + film[3], v["drag_n"] + film[4]
        return matrix, pose[:2] + along * a + out * n

    def stuck(self, side: int, way: float, pose: Vector) -> Vector:
        """Rate of the pose while one tip sticks."""
        a, n = self.normal(pose)
        contact = self.tip(side, way) - self.values[f"radius_{SIDES[side]}"] * n
        ahead, back = min(way + 1e-9, self.length), max(way - 1e-9, 0.0)
        path = (self.tip(side, ahead) - self.tip(side, back)) / (ahead - back)
        drag, centre = self.drag(way, pose)
        arm = contact - centre
        wrench = np.array([[1.0, 0.0], [0.0, 1.0], [-arm[1], arm[0]]])
        # velocity of the part's point under the tip from the force there
        moves = np.linalg.solve(drag, wrench)
        at_tip = wrench.T @ moves
        force = np.linalg.solve(at_tip, path)
        twist = moves @ force
        self.instants.append(
            Instant(
                float(pose[2] + self.values["kappa"]),
                path,
                float((contact - pose[:2]) @ a),
                float(-force @ n),
                float(force @ a),
                float(twist[2]),
                np.array([drag[2, 2]]),
            )
        )
        from_centre = pose[:2] - centre
        velocity = twist[:2] + twist[2] * np.array([-from_centre[1], from_centre[0]])
        return np.array([velocity[0], velocity[1], twist[2]])

    def touches(self, side: int, pose: Vector) -> float:
        """Way at which a tip touches the part at rest."""
        low, high = 0.0, self.length
        if self.off(side, high, pose) > 0:
            return math.inf
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if self.off(side, middle, pose) > 0 else (low, middle)
        return high

    def run(self, side: int, *, second: bool) -> Vector:
        """Pose at the end; if ``second``, from the touch of the other tip on the part moves with both."""
        pose = np.array([self.values["x"], self.values["y"], self.values["theta"]])
        first = self.touches(side, pose)

        def meets(way: float, pose: Vector) -> float:
            return self.off(-side, way, pose)

        meets.terminal, meets.direction = True, -1  # type: ignore[attr-defined]
        run = solve_ivp(
            lambda way, pose: self.stuck(side, way, pose), (first, self.length), pose,
            rtol=1e-10, atol=1e-13, max_step=self.length / 40, events=meets if second else None,
        )  # fmt: skip
        end = run.y[:, -1]
        if second:
            if not len(run.t_events[0]):
                raise AssertionError("the second tip does not touch")
            moved = self.tip(side, self.length) - self.tip(side, run.t[-1])
            end = end + np.array([moved[0], moved[1], 0.0])
        return np.asarray(end)
