"""The part, what touches it, and the contact modes.

A contact is a point of an obstacle on an edge of the part (:class:`Tip`) or a corner of the part on
an edge of an obstacle (:class:`Corner`). Obstacles translate; those that are one solid share one
:class:`Mover`. Body frame: the part's reference point and axes, turned by ``theta`` against the
world's. At a contact ``n`` is the normal into the part and ``t`` is ``n`` turned by +90 degrees.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import TypeAlias

import casadi as ca

from meso_robust.bounds import Interval
from meso_robust.errors import InputError

Quantity: TypeAlias = "float | str | Interval | ca.SX"
"""A double that is meant exactly, a name of the box, an interval of its own, or an expression of
names of the box (CasADi, built with :func:`symbol`)."""


def symbol(name: str) -> ca.SX:
    """A named parameter for use in expressions; symbols of one name are the same parameter."""
    return ca.SX.sym(name)


class Mode(IntEnum):
    """What one contact does; the numbers and signs are those of the simulator's records."""

    OPEN = 0
    """No force; the gap opens."""
    STICK = 1
    """No relative motion; the force lies inside Coulomb's cone."""
    SLIP_PLUS = 2
    """Friction on the part along +t; the part slides along -t past the obstacle."""
    SLIP_MINUS = 3
    """Friction on the part along -t; the part slides along +t past the obstacle."""


@dataclass(frozen=True, slots=True, eq=False)
class Mover:
    """A solid that translates; two contacts with the same object touch one solid.

    Attributes
    ----------
    velocity
        Along the world's x and y; any unit, the same for all movers. In m/s the time of a motion is
        in s; a unit speed makes it the travel in m.
    """

    velocity: tuple[Quantity, Quantity]


FIXTURE = Mover((0.0, 0.0))
"""All solids at rest."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Tip:
    """A point of an obstacle on an edge of the part.

    Attributes
    ----------
    edge
        Edge from corner ``edge`` to the next.
    at
        Where on the edge, m: from the foot of the perpendicular from the reference point, positive
        along the edge's own (counter-clockwise) direction. On the long edge of the paper's part
        this is d2.
    friction
        Coulomb's coefficient, positive.
    mover
        What the tip belongs to.
    """

    edge: int
    at: Quantity
    friction: Quantity
    mover: Mover


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Corner:
    """A corner of the part on a straight edge of an obstacle.

    Attributes
    ----------
    corner
        Which corner of the part.
    normal
        Normal of the obstacle's edge towards the part, world axes, of any length but zero.
    friction
        Coulomb's coefficient, positive.
    mover
        What the edge belongs to.
    """

    corner: int
    normal: tuple[Quantity, Quantity]
    friction: Quantity
    mover: Mover = FIXTURE


Contact = Tip | Corner


@dataclass(frozen=True, slots=True)
class Part:
    """A simple polygon.

    Attributes
    ----------
    vertices
        Corners in m, counter-clockwise, convex or not; the reference point is the origin. The
        doubles are meant exactly.

    Raises
    ------
    InputError
        If there are fewer than three corners, an edge has no length, or they go clockwise.
    """

    vertices: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        """Refuse what is no outline."""
        after = (*self.vertices[1:], *self.vertices[:1])
        pairs = list(zip(self.vertices, after, strict=True))
        if len(pairs) < 3 or any(one == two for one, two in pairs):
            raise InputError(
                f"vertices: {len(pairs)} corners, or an edge without length; must be a polygon; "
                "leave out repeated corners"
            )
        area = sum(a[0] * b[1] - a[1] * b[0] for a, b in pairs)
        if not area > 0.0:
            raise InputError(
                f"vertices: signed area {0.5 * area:g} m²; must go counter-clockwise; reverse them"
            )

    @classmethod
    def rectangle(cls, length: float, width: float) -> Part:
        """Centred rectangle; edge 0 is the long edge below, whose outward normal is -y."""
        a, b = 0.5 * length, 0.5 * width
        return cls(((-a, -b), (a, -b), (a, b), (-a, b)))
