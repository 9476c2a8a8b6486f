"""A part between a moving tip D and a resting tip S on opposite edges.

``(h, V)`` is the vector from S to D, ``T`` its part along the edges, ``w = 2 d1`` that across them,
so ``(h, V) = T a + w n`` with ``a = (c, s)``, ``n = (s, -c)``. One unit of travel takes D by
``(-1, 0)``: both contacts hold only if the part turns by ``omega = s/T``.

With ``p_D = T/2 - sigma`` and ``p_S = -T/2 - sigma`` the places of the tips along the edges (from
the centre's foot), and friction ratios ``k_D``, ``k_S`` (force along ``a`` over normal force):

    normal speed at S is none         L_S - L_D = omega p_S
    moment of the film                L_D m_D - L_S m_S = rho omega,   m = p + d1 k

and the drag along the edges gives the speed ``k_D L_D + k_S L_S`` of the centre along ``a``.
"""

from __future__ import annotations

from dataclasses import dataclass

from meso_robust.checker.dual import Dual, Number


@dataclass(frozen=True, slots=True)
class Forces:
    """Normal forces as quotients; the divisor is positive where the grasp cannot close."""

    D: Dual
    S: Dual
    divisor: Dual


@dataclass(frozen=True, slots=True)
class Grip:
    """The grip at one instant."""

    c: Dual
    s: Dual
    T: Dual
    d1: Number
    h: Dual

    @classmethod
    def at(cls, h: Dual, V: Dual, d1: Number) -> Grip:
        """The grip with D at ``(h, V)`` from S."""
        w = d1 * 2
        square = h.squared() + V.squared()
        T = (square - w * w).sqrt()
        return cls((T * h - V * w) / square, (T * V + h * w) / square, T, d1, h)

    @classmethod
    def of_angle(cls, c: Dual, s: Dual, V: Dual, d1: Number) -> Grip:
        """The grip of a part whose edges have the direction ``(c, s)``."""
        w = d1 * 2
        T = (c * w + V) / s
        return cls(c, s, T, d1, T * c + s * w)

    @property
    def slip_D(self) -> Dual:
        """d(sigma)/d(travel) at which D sticks: half of T's rate. S sticks at minus this."""
        return -self.h / (self.T * 2)

    def forces(self, sigma: Dual, rho: Number, k_D: Number, k_S: Number) -> Forces:
        """Normal forces at D and S, for drag 1 and one unit of travel per time."""
        p_S = -(self.T / 2) - sigma
        m_D, m_S = p_S + self.T + k_D * self.d1, p_S + k_S * self.d1
        omega = self.s / self.T
        return Forces(
            omega * (p_S * m_S + rho), omega * (p_S * m_D + rho), self.T + (k_D - k_S) * self.d1
        )

    def slide(self, sigma: Dual, rho: Number, mu: Number, D: int, S: int) -> Dual:
        """d(sigma)/d(travel) while both tips slip, with the ratios ``D mu`` and ``S mu``.

        The speed of the centre along ``a``, less that of the middle of the tips, which moves by
        (-1/2, 0). With the two forces put in, ``T`` (if D = S) or the whole denominator cancels.
        """
        p_S = -(self.T / 2) - sigma
        if D == S:
            lever = p_S * 2 + self.T + mu * self.d1 * (2 * D)
            friction = mu * D * (p_S * lever + rho * 2) / self.T
        else:
            friction = mu * S * p_S
        return self.s / self.T * friction + self.c / 2
