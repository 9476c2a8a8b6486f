"""One tip on one edge: where it touches and how the part turns about it.

The part's edge has direction ``a = (c, s)`` and outward normal ``n = (s, -c)``; the contact is at
``d2 a + d1 n`` from the reference point, the tip's centre its radius farther out.

A point tip that sticks on an even film: the part's point under the tip, at ``r`` from its centre, moves
with it, ``v + omega z x r = (-1, 0)`` for one unit of travel, so that ``r`` keeps its length
and turns by ``omega = r_y/(rho + r^2)``. Written as ``r = R (tanh u, +-sech u)`` this is ``du/d(travel) =
-R/(rho + R^2)``: the motion is uniform in ``u``, and the angle of ``r`` is known from ``u`` (the
Gudermannian). Any other tip and film: ``roll.py``, also one whose centre of drag is known no better than
within some micrometres: there the closed form's ranges lose what its terms have in common.
"""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb

from meso_robust.checker.dual import Dual, Number
from meso_robust.checker.film import EVEN, Film
from meso_robust.checker.roll import travel_of, turn_of


@dataclass(frozen=True, slots=True)
class Contact:
    """A tip on the edge of a part; all in m, directions as cosine and sine of the edge."""

    c: Dual
    s: Dual
    d1: Dual | arb
    d2: Dual
    radius: Number = EVEN

    @property
    def arm_x(self) -> Dual:
        """Tip minus part, x."""
        return self.c * self.d2 + self.s * self.out

    @property
    def arm_y(self) -> Dual:
        """Tip minus part, y."""
        return self.s * self.d2 - self.c * self.out

    @property
    def out(self) -> Dual | arb:
        """How far the tip's centre is out along the normal."""
        return self.d1 if self.radius is EVEN else self.d1 + self.radius


def place_on_edge(c: Dual, s: Dual, d1: Number, rise: Number) -> Dual:
    """``d2`` of a tip on the edge that is ``rise`` above the centre."""
    return (c * d1 + rise) / s


def off_line(c: Dual, s: Dual, dx: Number, dy: Number) -> Dual:
    """How far ``(dx, dy)`` reaches along the outward normal."""
    return s * dx - c * dy


def along(c: Dual, s: Dual, dx: Number, dy: Number) -> Dual:
    """How far ``(dx, dy)`` reaches along the edge."""
    return c * dx + s * dy


@dataclass(frozen=True, slots=True)
class Turning:
    """Sticking motion that starts at a contact and turns the part to ``side``."""

    start: Contact
    angle: Dual
    """Direction of the edge at the start."""
    side: int
    film: Film

    @property
    def uniform(self) -> bool:
        """Whether there is a closed form."""
        film = self.film
        exact = (film.stretch, film.shear, film.bend, film.drag_a, film.drag_n)
        return all(one is EVEN for one in (self.start.radius, *exact))

    def after(self, travel: Number) -> Dual:
        """Turn after ``travel``, counter-clockwise."""
        if self.uniform:
            about = _Uniform.of(self.start, self.film, self.side)
            return (about.first.gudermannian() - about.last(travel).gudermannian()) * self.side
        whole = travel if isinstance(travel, Dual) else Dual(arb(travel))
        return turn_of(self._state, whole, self.side)

    def contact(self, turned: Dual) -> Contact:
        """Where the tip touches when the part has turned so far; a round one rolls."""
        s, c = (self.angle + turned).sin_cos()
        start = self.start
        rolled = start.d2 if start.radius is EVEN else start.d2 - turned * start.radius
        return Contact(c, s, start.d1, rolled, start.radius)

    def contact_after(self, travel: Number) -> tuple[Dual, Dual, Dual]:
        """Turn, and arm of the tip, after ``travel``."""
        if self.uniform:
            about = _Uniform.of(self.start, self.film, self.side)
            tanh, sech = about.last(travel).tanh_sech()
            return self.after(travel), about.R * tanh, about.R * sech * self.side
        turned = self.after(travel)
        contact = self.contact(turned)
        return turned, contact.arm_x, contact.arm_y

    def needed(self, turned: Dual) -> Dual:
        """Travel until the part has turned so far."""
        if self.uniform:
            about = _Uniform.of(self.start, self.film, self.side)
            return about.needed(_Uniform.of(self.contact(turned), self.film, self.side))
        return travel_of(self._state, turned)

    @property
    def _state(self) -> tuple[Number, ...]:
        start, film = self.start, self.film
        centre: tuple[Number, Number] = (film.drag_a, film.drag_n)
        fixed, moving = ((EVEN, EVEN), centre) if film.moves else (centre, (EVEN, EVEN))
        return (
            self.angle,
            start.d1 - fixed[1],
            start.d2 - fixed[0],
            start.radius,
            film.rho,
            film.stretch,
            film.shear,
            film.bend,
            *moving,
        )


@dataclass(frozen=True, slots=True)
class _Uniform:
    """The arm of a point tip from the part, which turns uniformly in ``first``."""

    R: Dual
    first: Dual
    speed: Dual
    """By how much ``u`` falls per travel."""

    @classmethod
    def of(cls, arm: Contact, film: Film, side: int) -> _Uniform:
        square = arm.d2.squared() + (
            arm.d1.squared() if isinstance(arm.d1, Dual) else arm.d1 * arm.d1
        )
        R = square.sqrt()
        return cls(R, (arm.arm_x / (arm.arm_y * side)).asinh(), R / (R.squared() + film.rho))

    def last(self, travel: Number) -> Dual:
        return self.first - self.speed * travel

    def needed(self, end: _Uniform) -> Dual:
        return (self.first - end.first) / self.speed
