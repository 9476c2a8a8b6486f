"""The film's drag under one contact, and what a contact that sticks does to the part.

Drag, over that of a translation in the mean direction, is ``E = ((1 + stretch, shear), (shear, 1 -
stretch))`` in the axes ``(a, n)`` of the pushed edge for translations and ``rho`` for turns, both about
the centre of drag, which is ``(drag_a, drag_n)`` from the reference point. With the contact at
``r = d2 a + d1 n`` from the *centre of drag* (``a x n`` is -1), one unit of travel and the velocity
``-(c, s)`` of the tip in ``(a, n)`` the part's twist is that velocity plus ``omega (d1, -d2)``; its force
is ``f = E v`` and its moment ``d1 f_a - d2 f_n`` is ``rho omega``. Eliminating ``f``:

    omega F = p s - q c,   p = (1 - stretch) d2 - shear d1,   q = (1 + stretch) d1 - shear d2
    F = rho + p d2 + q d1

Put into ``f``, with ``D = 1 - stretch^2 - shear^2`` the determinant of ``E``:

    -f_n F = A c + B s,    f_a F = -(C c + A s)
    A = shear rho + D d1 d2,  B = (1 - stretch) rho + D d1^2,  C = (1 + stretch) rho + D d2^2

A contact that slips with the friction ratio ``k`` and presses with the force N gives way, along
``-n``, with ``N (C + k A)/(rho D)`` (the inverse of ``E`` and the lever ``d2 + k d1`` at the arm ``d2``): as
fast as the tip comes. So it does not press where ``C + k A`` is not positive; where it is, the part's
point slides along the tip by a speed that grows with k (the derivative is the determinant of the
contact's mobility over a square) and vanishes at the ratio of sticking. With that ratio strictly
inside the cone a k at its end slides the way that it pulls, which friction does not: **a contact that
presses and sticks strictly inside the cone has no other motion**.

A path that strays from its straight line by the tangent ``bend`` changes ``(c, s)`` to ``(c - bend s,
s + bend c)``.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from flint import arb

from meso_robust.checker.dual import Dual, Number, Point

EVEN = arb(0)
"""What is exactly zero and left out of a formula."""
FILM = ("rho", "stretch", "shear", "bend", "drag_a", "drag_n")
MOVING = {"drag_a": "centre_a", "drag_n": "centre_n"}
"""What a coordinate of the centre of drag is called where it may be another at every instant."""


@dataclass(frozen=True, slots=True)
class Film:
    """The drag and the slope of the path at an instant, and where the centre of drag is."""

    rho: Number
    stretch: Number = EVEN
    shear: Number = EVEN
    bend: Number = EVEN
    drag_a: Number = EVEN
    drag_n: Number = EVEN
    moves: bool = field(default=False, kw_only=True)
    """Whether the centre may be elsewhere at every instant."""

    @classmethod
    def at(cls, at: Point) -> Film:
        """From the variables of an inequality, those that are left out being zero."""
        moves = any(name in at for name in MOVING.values())
        names = [MOVING.get(name, name) for name in FILM] if moves else FILM
        return cls(*(at.get(name, EVEN) for name in names), moves=moves)

    def along(self, c: Dual, s: Dual) -> tuple[Dual, Dual]:
        """Minus the tip's velocity in ``(a, n)`` for an edge of direction ``(c, s)``."""
        if self.bend is EVEN:
            return c, s
        return c - s * self.bend, s + c * self.bend

    @property
    def even(self) -> bool:
        """Whether the drag is the same in all directions."""
        return self.stretch is EVEN and self.shear is EVEN

    def force_of_slide(self, c: Dual, s: Dual) -> tuple[Dual, Dual]:
        """Force along the edge and normal force on a part that moves with the probe, unturned."""
        c, s = self.along(c, s)
        if self.even:
            return -c, s
        return -(c * (self.stretch + 1) + s * self.shear), c * self.shear + s * (1 - self.stretch)


@dataclass(frozen=True, slots=True)
class Arm:
    """Where a tip touches, from the centre of drag; if it sticks, forces and turn are over ``F > 0``."""

    d1: Number
    d2: Dual
    film: Film

    @classmethod
    def of(cls, d1: Number, d2: Dual, film: Film) -> Arm:
        """The contact at ``d2 a + d1 n`` from the reference point."""
        return cls(d1 - film.drag_n, d2 - film.drag_a, film)

    def press(self, c: Dual, s: Dual) -> Dual:
        """Normal force times F, the edge's direction being ``(c, s)``."""
        c, s = self.film.along(c, s)
        if self.film.even:
            return s * self.film.rho + (c * self.d2 + s * self.d1) * self.d1
        return self.mixed * c + s * self.across

    def shear(self, c: Dual, s: Dual) -> Dual:
        """Force along the edge times F."""
        c, s = self.film.along(c, s)
        if self.film.even:
            return -(c * self.film.rho + (c * self.d2 + s * self.d1) * self.d2)
        return -(self.straight * c + self.mixed * s)

    def turn(self, c: Dual, s: Dual) -> Dual:
        """Turn for one unit of travel, counter-clockwise, times F."""
        c, s = self.film.along(c, s)
        if self.film.even:
            return s * self.d2 - c * self.d1
        p = self.d2 * (1 - self.film.stretch) - self.film.shear * self.d1
        q = self.d1 * (self.film.stretch + 1) - self.film.shear * self.d2
        return p * s - q * c

    @property
    def stiffness(self) -> Dual:
        """F."""
        p = self.d2 * (1 - self.film.stretch) - self.film.shear * self.d1
        q = self.d1 * (self.film.stretch + 1) - self.film.shear * self.d2
        found: Dual = p * self.d2 + q * self.d1 + self.film.rho
        return found

    @property
    def room(self) -> Number:
        """Determinant of the drag of translations."""
        if self.film.even:
            return 1
        return 1 - _squared(self.film.stretch) - _squared(self.film.shear)

    @property
    def mixed(self) -> Dual:
        """A of the sticking contact."""
        found: Dual = self.d2 * self.d1 * self.room
        return found if self.film.even else found + self.film.rho * self.film.shear

    @property
    def across(self) -> Number:
        """B of the sticking contact."""
        return (1 - self.film.stretch) * self.film.rho + _squared(self.d1) * self.room

    @property
    def straight(self) -> Dual:
        """C of the sticking contact."""
        found = self.d2.squared() * self.room
        return found + (
            self.film.rho if self.film.even else (self.film.stretch + 1) * self.film.rho
        )


def _squared(value: Number) -> Number:
    return value * value if isinstance(value, arb | int) else value.squared()
