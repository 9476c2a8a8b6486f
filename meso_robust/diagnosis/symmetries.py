"""Symmetries of an outline: turns and reflections that take it to itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from meso_robust.identification.models.model import centroid
from meso_robust.types import Floats

_SAME = 1e-6  # of the size: how well corners must fall on corners


@dataclass(frozen=True, slots=True, eq=False)
class Symmetry:
    """``x → A x + t`` in the frame of the part, with an orthogonal A (2, 2) and t (2,) in m."""

    matrix: Floats
    offset: Floats
    kind: Literal["same", "turn", "mirror"]

    def of_points(self, points: Floats) -> Floats:
        """Images of points (…, 2)."""
        return np.asarray(points @ self.matrix.T + self.offset)

    def of_directions(self, directions: Floats) -> Floats:
        """Images of directions (…, 2)."""
        return np.asarray(directions @ self.matrix.T)

    def of_motion(self, motion: Floats) -> Floats:
        """Image of a motion (3,): displacement of the reference point, and angle.

        A mirrored part turns the other way; the reference point need not be the centre.
        """
        angle = motion[2] * np.linalg.det(self.matrix)
        cos, sin = np.cos(angle), np.sin(angle)
        turned = np.array([[cos, -sin], [sin, cos]]) @ self.offset
        moved = self.matrix @ motion[:2] + self.offset - turned
        return np.array([*moved, angle])


def symmetries(outline: Floats) -> tuple[Symmetry, ...]:
    """All symmetries of an outline (V, 2), the identity first."""
    centre, count = centroid(outline), len(outline)
    away = outline - centre
    size = float(np.hypot(*away.T).max())
    found = []
    for mirrored in (False, True):
        corners = away[::-1] * [1.0, -1.0] if mirrored else away
        for shift in range(count):
            image = np.roll(corners, -shift, axis=0)
            angle = _angle(image[0], away[0])
            cos, sin = np.cos(angle), np.sin(angle)
            matrix = np.array([[cos, -sin], [sin, cos]])
            if np.abs(image @ matrix.T - away).max() > _SAME * size:
                continue
            matrix = matrix @ np.diag([1.0, -1.0]) if mirrored else matrix
            same = not mirrored and abs(angle) < 1e-9
            kind: Literal["same", "turn", "mirror"] = "mirror" if mirrored else "turn"
            found.append(Symmetry(matrix, centre - matrix @ centre, "same" if same else kind))
    return tuple(sorted(found, key=lambda one: one.kind != "same"))


def gyration(outline: Floats) -> float:
    """Radius of gyration in m of the area of an outline (V, 2) about its centroid."""
    x, y = (outline - centroid(outline)).T
    across = x * np.roll(y, -1) - np.roll(x, -1) * y
    squares = sum(c * c + c * np.roll(c, -1) + np.roll(c, -1) ** 2 for c in (x, y))
    return float(np.sqrt(across @ squares / (6.0 * across.sum())))


def _angle(start: Floats, end: Floats) -> float:
    """Angle from a direction (2,) to another, −π … π."""
    cross = start[0] * end[1] - start[1] * end[0]
    return float(np.arctan2(cross, start @ end))
