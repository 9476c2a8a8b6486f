"""Shapes of probe tips."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meso_robust.simulator.outline import EDGE, edge_table, refuse
from meso_robust.types import Floats

_CORNER = np.zeros((1, EDGE))  # a point or disc: one corner without edges
_CORNER[0, 8] = 1.0


@dataclass(frozen=True, slots=True)
class Point:
    """A sharp tip."""

    @property
    def radius(self) -> float:
        """Radius of the disc, m."""
        return 0.0

    def edges(self, first: int) -> Floats:
        """Table of edges; see `outline.edge_table`."""
        return _CORNER.copy()


@dataclass(frozen=True, slots=True)
class Round:
    """A round tip; its centre is what moves along the waypoints.

    Attributes
    ----------
    radius
        In m.

    Raises
    ------
    ValueError
        If the radius is not positive and finite.
    """

    radius: float

    def __post_init__(self) -> None:
        """Check the radius."""
        if not 0.0 < self.radius < np.inf:
            refuse(
                "radius", f"{self.radius} m", "must be positive and finite", "use Point for zero"
            )

    def edges(self, first: int) -> Floats:
        """Table of edges; see `outline.edge_table`."""
        return _CORNER.copy()


@dataclass(frozen=True, slots=True)
class Flat:
    """A tip with a flat side, as the probe of the paper's Section V-A: a square on that side.

    The middle of the side is what moves along the waypoints; the tip does not turn.

    Attributes
    ----------
    facing
        Direction in which the side looks, rad, world frame: along the push.
    side
        Length of the side, m; the paper's is 25 µm.

    Raises
    ------
    ValueError
        If the direction is not finite or the side is not positive.
    """

    facing: float
    side: float = 25e-6

    def __post_init__(self) -> None:
        """Check the values."""
        if not np.isfinite(self.facing):
            refuse("facing", f"{self.facing} rad", "must be finite", "give the push direction")
        if not 0.0 < self.side < np.inf:
            refuse("side", f"{self.side} m", "must be positive and finite", "try 25e-6 m")

    @property
    def radius(self) -> float:
        """Radius of the corners, m."""
        return 0.0

    @property
    def corners(self) -> Floats:
        """(4, 2) corners in m about the middle of the side."""
        ahead = np.array([np.cos(self.facing), np.sin(self.facing)])
        left = np.array([-ahead[1], ahead[0]])
        half = 0.5 * self.side
        return np.array(
            [
                -half * left,
                half * left,
                half * left - self.side * ahead,
                -half * left - self.side * ahead,
            ]
        )

    def edges(self, first: int) -> Floats:
        """Table of edges; see `outline.edge_table`."""
        return edge_table(self.corners, first)


Tip = Point | Round | Flat
