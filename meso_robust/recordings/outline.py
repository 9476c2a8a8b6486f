"""Outline of the part: a rectangle or a simple polygon."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from meso_robust.types import Floats
from meso_robust.wording import counted


@dataclass(frozen=True, slots=True, kw_only=True)
class Rectangle:
    """A rectangle about its centre, the reference point.

    Attributes
    ----------
    length
        Side along the part's x axis at θ = 0, the long one, in m.
    width
        Side across it in m.

    Raises
    ------
    ValueError
        If a side is not positive and finite, or the width exceeds the length.
    """

    length: float
    width: float

    def __post_init__(self) -> None:
        """Check the sides."""
        if not (0.0 < self.width <= self.length < math.inf):
            raise ValueError(
                f"rectangle: {self.length} m by {self.width} m; must be positive, finite, the long "
                "side first; change the sides"
            )

    @property
    def outline(self) -> Floats:
        """(4, 2) corners in m, body frame, counter-clockwise."""
        x, y = 0.5 * self.length, 0.5 * self.width
        return np.array([[-x, -y], [x, -y], [x, y], [-x, y]])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Polygon:
    """A simple polygon, convex or not, with the reference point as origin.

    Attributes
    ----------
    corners
        (V, 2) in m, body frame, counter-clockwise; copied and made read-only.

    Raises
    ------
    ValueError
        If the corners break a rule of `outline_fault`.
    """

    corners: Floats

    def __post_init__(self) -> None:
        """Copy, freeze and check the corners."""
        corners = np.array(self.corners, dtype=np.float64)
        if corners.ndim != 2 or corners.shape[1] != 2 or not np.all(np.isfinite(corners)):
            raise ValueError(
                f"corners: shape {corners.shape}; must be (V, 2) and finite; give x and y a corner"
            )
        fault = outline_fault(corners)
        if fault:
            raise ValueError(f"corners: {fault}")
        corners.flags.writeable = False
        object.__setattr__(self, "corners", corners)

    @property
    def outline(self) -> Floats:
        """(V, 2) corners in m, body frame, counter-clockwise."""
        return self.corners


def outline_fault(corners: Floats) -> str | None:
    """What forbids corners as an outline, or None.

    Parameters
    ----------
    corners
        (V, 2) finite coordinates in any unit.

    Returns
    -------
    str or None
        The first fault as "value; rule; advice": fewer than three corners, coinciding neighbours,
        sides that touch or cross, or clockwise order.
    """
    count = len(corners)
    if count < 3:
        return f"{counted(count, 'corner')}; must be at least 3; give the whole outline"
    sides = np.roll(corners, -1, axis=0) - corners
    short = np.flatnonzero(~np.any(sides != 0.0, axis=1))
    if short.size:
        first = int(short[0])
        return f"corners {first} and {(first + 1) % count} coincide; must differ; leave one out"
    crossing = _first_crossing(corners, sides)
    if crossing is not None:
        first, second = crossing
        return (
            f"the sides after corners {first} and {second} touch or cross; must meet only at their "
            "common corner; give the corners in their order along the outline"
        )
    x, y = corners.T
    if np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) <= 0.0:
        return "the corners run clockwise; must run counter-clockwise; reverse their order"
    return None


def gyration(corners: Floats) -> float:
    """Radius of gyration of the evenly filled outline.

    Parameters
    ----------
    corners
        (V, 2) of the outline, counter-clockwise, m.

    Returns
    -------
    float
        About the origin of the axes, m.
    """
    x, y = corners.T
    across = x * np.roll(y, -1) - np.roll(x, -1) * y
    squares = sum(c * c + c * np.roll(c, -1) + np.roll(c, -1) ** 2 for c in (x, y))
    return float(np.sqrt(across @ squares / (6.0 * across.sum())))


def _first_crossing(corners: Floats, sides: Floats) -> tuple[int, int] | None:
    """First two sides that share more than the corner between neighbours."""
    ends = corners + sides
    # side i against the two ends of side j: on which side of its line they are
    start = _cross(sides[:, None], corners[None] - corners[:, None])
    stop = _cross(sides[:, None], ends[None] - corners[:, None])
    apart = np.sign(start) * np.sign(stop) > 0.0
    low, high = np.minimum(corners, ends), np.maximum(corners, ends)
    away = np.any((low[:, None] > high[None]) | (low[None] > high[:, None]), axis=-1)
    meet = ~(apart | apart.T | away)
    i = np.arange(len(corners))
    after = (i + 1) % len(corners)
    meet[i, i] = False
    # neighbours always meet; they overlap only if the outline turns straight back
    back = (_cross(sides, sides[after]) == 0.0) & (np.sum(sides * sides[after], axis=1) < 0.0)
    meet[i, after] = meet[after, i] = back
    found = np.argwhere(meet)
    return (int(found[0, 0]), int(found[0, 1])) if found.size else None


def _cross(a: Floats, b: Floats) -> Floats:
    """The z component of the cross product along the last axis."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
