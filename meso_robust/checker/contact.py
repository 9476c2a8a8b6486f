"""One tip on one edge: where it touches, what it presses, how the part turns.

The part's edge has direction ``a = (c, s)`` and outward normal ``n = (s, -c)``; the contact is at
``r = d2 a + d1 n`` from the centre. The film (drag 1 for translation, ``rho`` for rotation) makes
the part move with the force ``f`` on it, ``v = f``, and turn with ``rho omega = r x f``.

Sticking. The part's point at ``r`` moves with the tip, ``v + omega z x r = (-1, 0)`` for one unit
of travel; eliminating ``f`` leaves ``omega (rho + r^2) = r_y`` and

    f (rho + r^2) = -(rho (1, 0) + r_x r),

whose parts along ``-n`` and ``a`` are ``press`` and ``shear`` below. ``r`` keeps its length and
turns by ``omega = r_y/(rho + r^2)``. Written as ``r = R (tanh u, +-sech u)`` this is
``du/d(travel) = -R/(rho + R^2)``: the motion is uniform in ``u``, and the angle of ``r`` is known
from ``u`` (the Gudermannian).
"""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb

from meso_robust.checker.dual import Dual, Number


@dataclass(frozen=True, slots=True)
class Contact:
    """A tip on the edge of a part; all in m, directions as cosine and sine of the edge."""

    c: Dual
    s: Dual
    d1: Dual | arb
    d2: Dual

    @property
    def arm_x(self) -> Dual:
        """Contact minus centre, x."""
        return self.c * self.d2 + self.s * self.d1

    @property
    def arm_y(self) -> Dual:
        """Contact minus centre, y."""
        return self.s * self.d2 - self.c * self.d1

    def press(self, rho: Number) -> Dual:
        """Normal force times ``rho + r^2``, sticking."""
        return self.s * rho + self.arm_x * self.d1

    def shear(self, rho: Number) -> Dual:
        """Force along the edge times ``rho + r^2``, sticking."""
        return -(self.c * rho + self.arm_x * self.d2)


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
    side: int

    @property
    def radius(self) -> Dual:
        """Length of ``r``."""
        return (self.start.d2.squared() + self.start.d1 * self.start.d1).sqrt()

    def u(self, at: Contact) -> Dual:
        """The variable that falls uniformly with the travel."""
        return (at.arm_x / (at.arm_y * self.side)).asinh()

    def needed(self, end: Contact, rho: Number) -> Dual:
        """Travel until the edge has the direction that it has in ``end``."""
        R = self.radius
        return (R.squared() + rho) / R * (self.u(self.start) - self.u(end))

    def after(self, travel: Number, rho: Number) -> tuple[Dual, Dual, Dual]:
        """Turn, and arm of the contact, after ``travel``."""
        R, first = self.radius, self.u(self.start)
        last = first - R * travel / (R.squared() + rho)
        tanh, sech = last.tanh_sech()
        turned = (first.gudermannian() - last.gudermannian()) * self.side
        return turned, R * tanh, R * sech * self.side
