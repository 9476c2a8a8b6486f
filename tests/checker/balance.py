"""A part between two round tips, by elimination: geometry by iteration, motion by trying every mode."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from meso_robust.types import Floats

Numbers = dict[str, float]


def turned(vector: Floats) -> Floats:
    """By a right angle, counter-clockwise."""
    return np.array([-vector[1], vector[0]])


def cross(arm: Floats, force: Floats) -> float:
    """Moment of a force."""
    return float(arm[0] * force[1] - arm[1] * force[0])


@dataclass(frozen=True)
class Held:
    """The part at one instant, from its reference point; axes of the travel."""

    edges: tuple[Floats, Floats]
    """Directions of the pushed and of the far edge, both roughly upwards."""
    normals: tuple[Floats, Floats]
    """Towards the part: of D's push, and of S's."""
    centres: tuple[Floats, Floats]
    """Of the tips."""
    contacts: tuple[Floats, Floats]
    numbers: Numbers

    @classmethod
    def at(cls, numbers: Numbers, h: float, ahead: float) -> Held:
        """From the tips' distance (h, V) and how far the part is ahead of S along the pushed edge."""
        V, tilt = numbers["V"] + numbers.get("stray", 0.0), np.arctan(numbers.get("tilt", 0.0))
        out = numbers["depth_far"] + numbers["radius_far"]
        across = numbers["depth"] + numbers["radius"] + (out - ahead * np.sin(tilt)) / np.cos(tilt)
        angle = np.arctan2(V, h) + np.arcsin(across / np.hypot(h, V))
        a = np.array([np.cos(angle), np.sin(angle)])
        b = np.array([np.cos(angle + tilt), np.sin(angle + tilt)])
        inward, outward = turned(a), -turned(b)  # the part is left of its pushed edge
        resting = -ahead * a + inward * (across - numbers["depth"] - numbers["radius"])
        moving = resting + np.array([h, V])
        return cls(
            edges=(a, b),
            normals=(inward, outward),
            centres=(moving, resting),
            contacts=(
                moving + numbers["radius"] * inward,
                resting + numbers["radius_far"] * outward,
            ),
            numbers=numbers,
        )

    def motion(self, ways: tuple[int, int], friction: tuple[float, float]) -> Floats | None:
        """Velocity of the centre of drag, turn, and both contacts' forces, normal and along.

        A way is 0 (sticks), or the sign of the friction force along the edge.
        """
        n = self.numbers
        a = self.edges[0]
        frame = np.column_stack([a, -turned(a)])
        stretch, shear = n.get("stretch", 0.0), n.get("shear", 0.0)
        drag = frame @ [[1 + stretch, shear], [shear, 1 - stretch]] @ frame.T
        centre = frame @ [n.get("drag_a", 0.0), n.get("drag_n", 0.0)]
        rows, right = np.zeros((7, 7)), np.zeros(7)
        rows[:2, :2], rows[2, 2] = drag, n["rho"]
        for k, way in enumerate(ways):
            arm = self.contacts[k] - centre
            for j, force in enumerate((self.normals[k], self.edges[k])):
                rows[:2, 3 + 2 * k + j] = -force
                rows[2, 3 + 2 * k + j] = -cross(arm, force)
            given = -np.array([1.0, n.get("bend", 0.0)]) if k == 0 else np.zeros(2)
            conditions = [self.normals[k]] if way else [self.normals[k], self.edges[k]]
            for j, axis in enumerate(conditions):
                rows[3 + 2 * k + j, :2], rows[3 + 2 * k + j, 2] = axis, axis @ turned(arm)
                right[3 + 2 * k + j] = axis @ given
            if way:
                rows[4 + 2 * k, 3 + 2 * k : 5 + 2 * k] = way * friction[k], -1.0
        if abs(np.linalg.det(rows / np.abs(rows).max(axis=1, keepdims=True))) < 1e-14:
            return None
        return np.asarray(np.linalg.solve(rows, right))

    def rate(self, motion: Floats, tip: int) -> float:
        """How fast the part gets ahead of the centre of a tip along the pushed edge."""
        n, a = self.numbers, self.edges[0]
        centre = n.get("drag_a", 0.0) * a - n.get("drag_n", 0.0) * turned(a)
        velocity = motion[:2] - motion[2] * turned(centre)
        given = -np.array([1.0, n.get("bend", 0.0)]) if tip == 0 else np.zeros(2)
        return float(-(a @ (given - velocity) + motion[2] * turned(a) @ self.centres[tip]))

    def slip(self, motion: Floats, k: int) -> float:
        """Of the part over a tip, along its edge."""
        n, a = self.numbers, self.edges[0]
        centre = n.get("drag_a", 0.0) * a - n.get("drag_n", 0.0) * turned(a)
        given = -np.array([1.0, n.get("bend", 0.0)]) if k == 0 else np.zeros(2)
        there = motion[:2] + motion[2] * turned(self.contacts[k] - centre)
        return float(self.edges[k] @ (there - given))

    def motions(self, friction: tuple[float, float]) -> list[Floats]:
        """Every motion that balance and Coulomb's law allow."""
        found = []
        for ways in itertools.product((-1, 0, 1), (-1, 0, 1)):
            motion = self.motion(ways, friction)
            if motion is None:
                continue
            allowed = True
            for k, way in enumerate(ways):
                normal, along = motion[3 + 2 * k : 5 + 2 * k]
                slides = abs(along) <= friction[k] * normal if way == 0 else True
                against = self.slip(motion, k) * way <= 0
                allowed = allowed and normal > 0 and slides and against
            if allowed:
                found.append(motion)
        return found
