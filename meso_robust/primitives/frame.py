"""Axes in which a move is stated and certified: the push goes along -x, a turn to its ``side``.

The primitives are derived for an edge that faces +x (paper, Fig. 10). The other three sides of a
part and the other direction of a rotation are the same motion seen from axes that are turned by
quarter turns or mirrored: the film's drag, Coulomb's law and boxes of errors look the same there
(they would not for an anisotropic film), and so does a rectangle; a polygon is mirrored with the
axes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from meso_robust.bounds import HALF_PI, Interval
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.types import Floats

Heading = Literal["-x", "-y", "+x", "+y"]

HEADINGS: tuple[Heading, ...] = ("-x", "-y", "+x", "+y")
"""Where the push goes after 0, 1, 2, 3 quarter turns counter-clockwise of the axes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Frame:
    """Axes of a move, same origin as the world's: world = R(quarter turns) diag(1, +-1) own."""

    heading: Heading = "-x"
    """Direction of the push in the world."""
    mirrored: bool = False
    """Whether the own y axis is mirrored first, so that a turn changes its direction."""

    @property
    def quarters(self) -> int:
        """Quarter turns counter-clockwise from the world's axes."""
        return HEADINGS.index(self.heading)

    @property
    def matrix(self) -> Floats:
        """(2, 2) turns own coordinates into the world's; of 0, 1 and -1 only."""
        turn = ((1, 0, 0, 1), (0, -1, 1, 0), (-1, 0, 0, -1), (0, 1, -1, 0))[self.quarters]
        sign = -1.0 if self.mirrored else 1.0
        return np.array(turn, dtype=np.float64).reshape(2, 2) * [1.0, sign] + 0.0

    def to_world(self, points: Floats) -> Floats:
        """(..., 2) points or vectors from own axes to the world's."""
        (a, b), (c, d) = self.matrix
        x, y = points[..., 0], points[..., 1]
        return np.stack([a * x + b * y, c * x + d * y], axis=-1)

    def sensed(self, poses: Floats) -> Floats:
        """(..., 3) poses (m, m, rad) from the world's axes to own ones, in plain numbers."""
        turned = poses[..., 2] - 0.5 * np.pi * self.quarters
        angle = -turned if self.mirrored else turned
        return np.concatenate([poses[..., :2] @ self.matrix, angle[..., None]], axis=-1)

    def from_world(self, box: PoseBox) -> PoseBox:
        """A box of poses from the world's axes to own ones, rounded outward if it is turned."""
        x, y = self._turned(box.x, box.y, self.matrix.T)
        theta = box.theta - self._angle if self.quarters else box.theta
        return PoseBox(x=x, y=y, theta=-theta if self.mirrored else theta)

    def box_to_world(self, box: PoseBox) -> PoseBox:
        """A box of poses from own axes to the world's, rounded outward if it is turned."""
        x, y = self._turned(box.x, box.y, self.matrix)
        theta = -box.theta if self.mirrored else box.theta
        return PoseBox(x=x, y=y, theta=theta + self._angle if self.quarters else theta)

    def setup(self, setup: Setup) -> Setup:
        """A task seen from own axes: the start rounded outward, the goal inward."""
        if self == WORLD:
            return setup
        u, goal = setup.uncertainty, setup.goal
        x, y = self._turned(goal.x, goal.y, self.matrix.T)
        low, high = Interval.point(goal.theta.lo), Interval.point(goal.theta.hi)
        inner = goal.theta
        if self.quarters:
            inner = Interval((low - self._angle).hi, (high - self._angle).lo)
        return replace(
            setup,
            outline=setup.outline.mirrored() if self.mirrored else setup.outline,
            uncertainty=u.mirrored() if self.mirrored else u,
            start=self.from_world(setup.start),
            goal=PoseBox(x=x, y=y, theta=-inner if self.mirrored else inner),
        )

    @property
    def _angle(self) -> Interval:
        return HALF_PI * Interval.point(self.quarters)

    def point_to_world(self, x: Interval, y: Interval) -> tuple[Interval, Interval]:
        """A box of points from own axes to the world's, exactly."""
        return self._turned(x, y, self.matrix)

    @staticmethod
    def _turned(x: Interval, y: Interval, matrix: Floats) -> tuple[Interval, Interval]:
        """Coordinates by a matrix whose rows hold one 1 or -1 each: exact, nothing is rounded."""
        found = []
        for row in matrix:
            side = x if row[0] else y
            found.append(-side if row.sum() < 0.0 else side)
        return found[0], found[1]


WORLD = Frame()
