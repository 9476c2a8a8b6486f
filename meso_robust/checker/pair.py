"""The two tips that take part in a two-sided rotation: the active one pushes, the passive one rests."""

from __future__ import annotations

import dataclasses

from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.scene import Scene

ACTIVE = -1
"""The lower tip of the active probe pushes."""


@dataclasses.dataclass(frozen=True, slots=True)
class Pair:
    """The active and the passive tip as functions of the variables of the move."""

    scene: Scene

    def V(self, at: Point) -> Dual:
        """Active minus passive tip, y."""
        return self.scene.apart(self.scene.rule.dual_y, at, "y") - at["spacing"] / 2

    def middle(self, at: Point) -> Dual:
        """Middle of both minus the part before the move, y."""
        return self.scene.passive_rise(at) + self.V(at) / 2

    def h_end(self, at: Point) -> Dual:
        """Active tip at the end of its travel minus the passive one, x."""
        between = self.scene.apart(self.scene.rule.dual_end_x, at, "x")
        return between - self.scene.lag(at, ACTIVE)
